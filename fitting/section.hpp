// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <numbers>

namespace impactrig::fitting {

enum class SectionShape { circle, rectangle, tube, stated };

/// What bending and shear take of a section.
template <typename Scalar = double>
struct SectionNumbers {
  Scalar area{};               ///< [m^2]
  Scalar second_moment{};      ///< [m^4]
  Scalar shear_coefficient{};  ///< κ [-]; 0: the shape is not known
};

/// A section of the bar as the rig file states it.
template <typename Scalar = double>
struct Section {
  SectionShape shape = SectionShape::stated;
  Scalar radius{};  ///< of circle and tube, outside [m]
  Scalar wall{};    ///< of a tube [m]
  Scalar width{};   ///< of a rectangle [m]
  Scalar height{};  ///< likewise, in the direction of swing [m]

  bool shear_coefficient_stated = false;  ///< κ does not follow from the shape

  /// Of a shape; shear coefficients are those of [Cowper1966].
  SectionNumbers<Scalar> numbers(const Scalar& poisson_ratio) const {
    constexpr double pi = std::numbers::pi;
    if (shape == SectionShape::rectangle)
      return {width * height, width * height * height * height / 12.0,
              10.0 * (1.0 + poisson_ratio) / (12.0 + 11.0 * poisson_ratio)};
    const Scalar inner = shape == SectionShape::tube ? Scalar(radius - wall) : Scalar(0.0);
    const Scalar outer_square = radius * radius, inner_square = inner * inner;
    // m = (inner / outer)²: 0 a full circle, near 1 a thin tube
    const Scalar m = inner_square / outer_square, square = (1.0 + m) * (1.0 + m);
    return {pi * (outer_square - inner_square),
            pi / 4.0 * (outer_square * outer_square - inner_square * inner_square),
            6.0 * (1.0 + poisson_ratio) * square /
                ((7.0 + 6.0 * poisson_ratio) * square + (20.0 + 12.0 * poisson_ratio) * m)};
  }
};

}  // namespace impactrig::fitting
