// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>

#include "acquisition/conditioning/condition.hpp"
#include "acquisition/conditioning/contact_search.hpp"
#include "acquisition/conditioning/trace.hpp"

namespace impactrig::acquisition {

struct Touch {
  std::size_t index;  ///< the last sample before it
  std::size_t top;    ///< of the pulse that it begins
};

/// First touch of a contact whose force vibrates before by more than 1 % of its peak: the trace
/// back from the pulse ends where the vibration lifts the force. Touch is where the course bends
/// more sharply than before (BendSearch), and leaves the line through what is just before.
/// `crossing`: a sample of the contact above the threshold; `grain`: grain_of() the force. None
/// where the force is quiet.
std::optional<Touch> touch_in_vibration(const Trace& force, const Contact& contact,
                                        std::size_t crossing, std::size_t floor, double grain,
                                        const DetectionOptions& options);

}  // namespace impactrig::acquisition
