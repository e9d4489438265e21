// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "fitting/diagnostics/channel_diagnostics.hpp"
#include "fitting/diagnostics/noise_colour.hpp"

namespace impactrig::fitting {

/// A channel after touch, samples at start + k interval; missing ones are not numbers.
struct AfterTouch {
  std::span<const double> residual;  ///< measured − model [unit] (n)
  std::span<const double> model;     ///< [unit] (n), nowhere missing
  double start = 0.0;                ///< [s] from first touch
  double interval = 0.0;             ///< [s]
  double contact_end = 0.0;          ///< of the first contact [s]
  std::string unit;
};

/// What the residuals r may look like: each regressed alone on
///
///   delay τ:  r = −τ ṁ     gain ε:  r = ε m     offset b:  r = b     drift c:  r = c t
///
/// m being the model and t the time after touch, both sides whitened by the noise's colour. The
/// p-value is that of Student's t with as many degrees of freedom as the noise before touch has
/// independent samples, n₀ / (2 τ₀): the spectral density of coloured noise is known no better.
std::vector<Structure> structures(const AfterTouch& after, const NoiseColour& noise);

/// The strongest spectral line of the whitened residuals after the first contact (after touch,
/// where less than 64 samples follow it), of three periods or more in the stretch looked at:
/// P = |Σ w e^{−iωt}|² / (n σ_e²), where noise exceeds P with probability (1 + 2 P / ν)^{−ν/2} at
/// each of n / 2 frequencies; twice as many are looked at and counted. Source: [Scargle1982]; with
/// a variance that is estimated as an F of 2 and ν.
Structure vibration(const AfterTouch& after, const NoiseColour& noise);

}  // namespace impactrig::fitting
