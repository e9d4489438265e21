// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "acquisition/conditioning/contact_search.hpp"
#include "acquisition/conditioning/samples.hpp"
#include "acquisition/conditioning/trace.hpp"

namespace impactrig::acquisition {

/// An electric spike that was taken for one of the contacts: one to three samples about its peak,
/// between two at the level before, or up to 16 that begin and end at once, as no contact ends.
std::optional<IndexRange> spike_among(const Trace& trace, const std::vector<Contact>& contacts);

/// The first spike of up to 16 samples after a contact, within what belongs to it: the force leaves
/// the level at which it rests and is back there, each within a sample.
std::optional<IndexRange> spike_after(const Trace& trace, const std::vector<Contact>& contacts,
                                      const DetectionOptions& options);

}  // namespace impactrig::acquisition
