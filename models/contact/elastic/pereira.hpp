// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "models/contact/elastic/contact_numbers.hpp"
#include "models/contact/elastic/elastic_law_entry.hpp"
#include "models/contact/elastic/power_contact.hpp"

namespace impactrig::models {

/// The cylindrical contact of Pereira, Ramalho and Ambrósio, fitted to Johnson's law.
///
///   f = K δⁿ,   K = (a ΔR + b) L E* / ΔR,   n = Y ΔR^(−0.005)     in mm, MPa and N
///
/// internal: a = 0.965, b = 0.0965, Y = 1.51 ln(1000 ΔR)^(−0.151) for 0.005 <= ΔR <= 0.34954 mm and
/// 0.0151 ΔR + 1.151 up to 10 mm; external: a = 0.39, b = 0.85, Y = 1.094. δ [m] and f [N,
/// compression > 0] here. That ΔR^(−0.005) also belongs to the external form is an assumption of
/// ours: sources disagree; it is 2 % at ΔR = 30 mm.
///
/// Valid for an internal ΔR between 0.005 and 10 mm.
///
/// Source: [PereiraEtAl2015].
struct PereiraLaw {
  static constexpr ElasticLawText text{
      .name = "pereira",
      .description = "power law fitted to Johnson's, internal and external",
      .formula = "f = K d^n, K = (a dR + b) L E*/dR, n = Y dR^(-0.005), in mm, MPa, N",
      .validity = "internal: 0.005 mm <= dR <= 10 mm; half width < 0.15 R1; no plane",
      .source = "PereiraEtAl2015"};

  static constexpr double least_clearance = 5e-6, most_clearance = 1e-2;  // [m]

  template <typename T>
  static PowerContact<T> make(const ContactNumbers<T>& c) {
    using std::exp;
    using std::log;
    using std::pow;
    require_second_radius(text.name, c.counterface);
    const bool internal = c.counterface == Counterface::groove;
    const T gap = 1e3 * c.radii();  // [mm]
    const T factor = ((internal ? 0.965 : 0.39) * gap + (internal ? 0.0965 : 0.85)) *
                     (1e3 * c.length) * (1e-6 * c.effective_modulus()) / gap;
    T power = T(1.094);
    if (internal) {
      // the logarithm goes to 0 at a clearance of 1 um, far below the range
      const T least = gap > 1e3 * least_clearance ? gap : T(1e3 * least_clearance);
      power =
          least < 0.34954 ? T(1.51 * pow(T(log(1e3 * least)), -0.151)) : T(0.0151 * least + 1.151);
    }
    power *= T(pow(gap, -0.005));
    return {factor * T(exp(power * std::log(1e3))), power};
  }

  static void limits(const ContactNumbers<>& c, double, double, std::vector<std::string>& beyond) {
    if (c.counterface == Counterface::groove &&
        !(c.radii() >= least_clearance && c.radii() <= most_clearance))
      beyond.push_back(
          fmt::format("the law 'pereira' was fitted to clearances between 0.005 and 10 mm; here it "
                      "is {:.4g} mm",
                      1e3 * c.radii()));
  }
};

}  // namespace impactrig::models
