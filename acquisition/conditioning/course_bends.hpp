// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace impactrig::acquisition {

/// Where a course bends: the mean of `width` samples from `index` on departs from the straight line
/// through those of the two such stretches before.
struct Bend {
  std::size_t index = 0;
  std::size_t width = 0;  ///< samples
};

/// Looks for the first bend that is sharper than all before it, at widths of 1, 2, 4 ... samples up
/// to about a contact's length. A touch makes one: the force sets in at once. What vibrates, hums
/// or drifts bends as sharply all the time, once half of a period is seen. Assumed: that the record
/// shows the undisturbed course for at least four widths before.
class BendSearch {
 public:
  /// `grain`: what two values must differ by to differ at all.
  BendSearch(std::span<const double> values, std::span<const std::uint8_t> valid, double interval,
             double grain);

  /// The first bend from `earliest` on, among what follows `floor`; none where there is none.
  std::optional<Bend> first(std::size_t floor, std::size_t earliest) const;

 private:
  struct Scale {
    std::size_t width, stride;
    double least;  ///< of noise, and of the sharpest bend of the whole record
  };

  double bend(std::size_t index, std::size_t width) const;
  std::optional<Bend> first_of(const Scale& scale, std::size_t floor, std::size_t earliest,
                               std::size_t end) const;

  std::size_t size_;
  std::vector<double> sums_;  ///< of the samples before each, less the first
  std::vector<Scale> scales_;
};

}  // namespace impactrig::acquisition
