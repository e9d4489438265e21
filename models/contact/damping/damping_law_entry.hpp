// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace impactrig::models {

/// How the damping enters the force: f of the elastic force f_0(δ), its energy U(δ) and the rate δ̇
/// [m/s, closing > 0]; s is the law's strength, m the effective mass [kg], v the approach speed.
enum class DampingForm {
  proportional,  ///< f_0 (1 + s δ̇),            s = d / v [s/m]
  implicit,      ///< f_0 / (1 − s δ̇),           s = d / v [s/m]
  constant,      ///< f_0 + s δ̇,                s = 2 ζ √(m k) [N s/m]
  natural,       ///< f_0 + s f_0 / √(2 U) δ̇,   s = 2 ζ √m [√kg]
  tangent,       ///< f_0 + s √f_0' δ̇,          s = 2 ζ √m [√kg]
  closing,       ///< f_0 + s √(f_0 / δ) δ̇ while closing, else f_0; s = 2 ζ √m [√kg]
  relaxing,      ///< f_0 + s f_0' δ̇,           s = τ [s]
  hertzian,      ///< f_0 + s δ^(3/2) δ̇,        s = d K / v, K of Hertz's sphere [N s / m^(5/2)]
};

/// Which speed v a law divides by.
enum class DampingSpeed {
  own,    ///< each contact's own approach speed: the restitution is the same at every speed
  first,  ///< that of the first contact, kept: the restitution depends on the speed
  none
};

/// What a law says of itself.
struct DampingLawText {
  std::string_view name;
  std::string_view description;
  std::string_view formula;
  std::string_view validity;
  std::string_view source;  ///< a key of docs/references.bib
  DampingForm form = DampingForm::proportional;
  DampingSpeed speed = DampingSpeed::own;
  double smallest_restitution = 0.0;  ///< below it the factor is not defined or too large to follow
};

}  // namespace impactrig::models
