// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "acquisition/conditioning/trace.hpp"

namespace impactrig::acquisition {

/// Samples of a pulse that a recorder lost or made up: one to three side by side, up to 16 that
/// depart by much the same, or up to 300 us of one value, that leave the course of their neighbours
/// at once and are back at once, while these go on smoothly and well off the level of rest. In
/// increasing order.
///
/// A departure counts from a tenth of the highest such neighbour on, and from twelve times what the
/// neighbours' own bends (their largest second difference) and noise, or the digitiser's step
/// `quantum`, let expect; with fewer than six sound neighbours on a side nothing is said. Samples
/// about rest are left to the search for contacts: a few high ones there may be a contact.
std::vector<std::size_t> find_glitches(const Trace& trace, double quantum);

/// Marks them as not valid, and bridges them.
void bridge_glitches(Trace& trace, double quantum);

}  // namespace impactrig::acquisition
