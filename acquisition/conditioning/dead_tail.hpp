// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "acquisition/conditioning/trace.hpp"

namespace impactrig::acquisition {

/// Marks the end of a motion as not valid where it stays on one value to the record's end, for 64
/// samples at least, though it has noise before of more than a digitiser's step `quantum`: a laser
/// that holds what it saw last, or shows zero, or a recorder that fills up. Several such stretches
/// may follow each other. What ends at the largest value on its side is a rail's, and stays.
void mark_dead_tail(double quantum, Trace& trace);

}  // namespace impactrig::acquisition
