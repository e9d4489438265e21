// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>

#include "acquisition/conditioning/baseline_search.hpp"
#include "acquisition/conditioning/contact_search.hpp"

namespace impactrig::acquisition {

inline constexpr double peak_fraction = 0.05;  ///< of the peak: below it nothing is a contact
inline constexpr double stands_out = 2.0;      ///< times what went before: a contact, no ringing

/// A signal measured from its baseline, positive in the pulse's direction.
struct Excursion {
  std::span<const double> y;
  const Baseline& baseline;
  double stop;        ///< at or below it the signal is on its baseline
  double noise;       ///< gate times sigma
  std::size_t floor;  ///< nothing before it belongs to the pulse
  double sign = 1.0;

  double at(std::size_t i) const { return sign * (y[i] - baseline.at(i)); }

  double threshold(double peak) const { return std::max(noise, peak_fraction * peak); }

  /// Above it a pulse goes on: half of what noise may reach, so that a foot which rises slowly
  /// through the noise does not end where one sample of it was above the threshold.
  double lasting(double peak) const { return std::max(0.5 * noise, peak_fraction * peak); }
};

/// Measures the pulse that is under way at `crossing`, in whichever direction; further hits are
/// looked for within `post` samples after first touch, which `touch` [samples] states where it is
/// known. None where the pulse does not rise above `threshold`.
std::optional<Contact> measure_pulse(Excursion z, std::size_t crossing, double threshold,
                                     double post, std::optional<double> touch);

}  // namespace impactrig::acquisition
