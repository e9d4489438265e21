// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "datasets/conditioning.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// Takes mains hum off the whole channel: a fundamental and its multiples, fitted by least squares
/// to the sound samples of the quiet stretches together with a straight line for each stretch.
///
/// Where the stretches span 5 periods the fundamental is looked for within 2 % of the stated
/// frequency; in shorter ones it is the stated one, off by 0.1 % (standard deviation) as a grid is.
/// Multiples that are less than 4 standard errors from none, both parts together, are left out, so
/// that noise is not added; when all are, nothing is taken off and the edit says so. Standard
/// errors take the residuals' autocorrelation into account, and what the fit takes of it
/// (slow_variance). `decay`: the channel has one too, which stays; the hum is fitted to
/// what fit_decay() leaves.
///
/// The edit holds frequency, amplitudes and the largest standard error of what is taken off
/// anywhere in the record. Throws std::invalid_argument when fewer than 32 samples are quiet, the
/// highest multiple is not below a quarter of the sample rate, or that standard error is more than
/// half of the hum's amplitude: the quiet stretches are then too short (below about one period) to
/// tell hum from drift.
datasets::Edit remove_hum(datasets::Channel& channel, const datasets::RemoveHum& hum,
                          const datasets::RemoveDecay* decay = nullptr);

}  // namespace impactrig::acquisition
