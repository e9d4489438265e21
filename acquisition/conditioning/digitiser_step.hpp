// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// Notes in a filter's edit the digitiser step [the channel's unit] of samples that it is applied
/// to, where their noise does not reach from one to the next: what the filter leaves of such noise
/// does not show by how much the samples are off.
void note_digitiser_step(std::span<const double> values, std::span<const std::uint8_t> valid,
                         const datasets::Channel& channel, datasets::Edit& edit);

/// The largest that was noted of the channel's filters, in its unit; 0: none.
double noted_digitiser_step(const datasets::Record& record, const datasets::Channel& channel);

}  // namespace impactrig::acquisition
