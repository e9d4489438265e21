// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "datasets/conditioning.hpp"
#include "datasets/impact.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// Tells the contacts of the impacts that are clipped as the record stands in its history, for
/// steps that round flat tops off, so that find_impacts gives them the flag afterwards too. Nothing
/// where there is none, or where impacts cannot be looked for.
void note_clipped(datasets::Record& record, const DetectionOptions& detection);

/// Those contacts, on the record's time axis.
std::vector<datasets::TimeSpan> noted_clipped(const datasets::Record& record);

/// Whether an impact's contact overlaps one of them: steps move its ends.
bool is_among(const std::vector<datasets::TimeSpan>& contacts, const datasets::Impact& impact);

}  // namespace impactrig::acquisition
