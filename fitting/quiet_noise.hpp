// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "datasets/impact.hpp"
#include "fitting/noise_model.hpp"

namespace impactrig::fitting {

/// The noise of a channel, from those of its samples before `until` [s] that are `sound`
/// (n_samples), one in `every`, less a line (a parabola for a
/// displacement) and mains hum of this frequency [Hz] where the stretch is long enough to tell it.
/// Of the standard deviation `least` at least; where fewer than 40 sound samples follow each other
/// there, white with `sigma`, which detection knows, and the signal's noise_correlation.
NoiseModel quiet_noise(const datasets::ImpactSignal& signal, std::span<const std::uint8_t> sound,
                       std::size_t every, double until, double mains_frequency, double sigma,
                       double least);

}  // namespace impactrig::fitting
