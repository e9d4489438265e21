// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <vector>

namespace impactrig::reports {

using Pixel = std::array<double, 2>;  ///< x, y [px]

/// Where a disc of `radius` [px] marks each line: on the line, where the others are far, no two
/// discs on each other unless there is no room. None for a line without points.
std::vector<std::optional<Pixel>> tag_places(const std::vector<std::vector<Pixel>>& lines,
                                             double radius);

}  // namespace impactrig::reports
