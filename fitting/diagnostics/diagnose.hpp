// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

#include "fitting/diagnostics/channel_diagnostics.hpp"

namespace impactrig::fitting {

/// Fewer samples before touch do not tell the noise.
inline constexpr long fewest_quiet_samples = 50;

/// When what happens, after first touch [s].
struct ImpactPhases {
  double deepest = 0.0;                      ///< the first contact turns from closing to opening
  double end = 0.0;                          ///< of the first contact
  std::vector<std::array<double, 2>> later;  ///< further contacts, from touch to separation
};

/// What a channel's diagnosis starts from, samples at start + k interval after first touch.
struct ChannelResiduals {
  std::string quantity;  ///< "force"
  std::string unit;      ///< SI
  double start = 0.0;    ///< [s]
  double interval = 0.0;
  std::vector<double> residual;  ///< measured − model [unit] (n), not a number where not fitted
  std::vector<double> model;     ///< [unit] (n)
  double quantum = 0.0;          ///< the digitiser's step [unit], 0 when not seen
  bool noise_known = true;       ///< it was seen before touch
  ImpactPhases phases;
};

/// Tests residuals against the noise seen before touch: level in each phase, whiteness, delay,
/// gain, offset, drift and vibration, each at `level` over their number (Bonferroni), so that a
/// right model is called unsound in at most that share of channels. Normality and runs of one sign
/// are told but do not count: they concern the noise as much as the model. All tests look at
/// residuals whitened by the colour of the noise before touch and take into account from how many
/// samples it is known.
///
/// Where the digitiser's step is above 1.5 standard deviations of that noise, rounding makes
/// residuals that follow each other whatever the model: then only the levels are tested, of what
/// exceeds half a step. Needs fewest_quiet_samples before touch.
ChannelDiagnostics diagnose(const ChannelResiduals& channel, double level);

/// Where the residuals are too large, what they look like and what to do about it, in a sentence.
std::string diagnosis_sentence(const ChannelResiduals& channel, const ChannelDiagnostics& found);

}  // namespace impactrig::fitting
