// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/bound_interval.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace impactrig::fitting {
namespace {

constexpr double normal95 = 1.959963984540054;

// Δχ² half-way to where it is 3.84: 0.96 from a minimum on, 1.92 along a slope; 1.7 where a
// parabola has its minimum 1.6 standard errors beyond the bound.
constexpr double steep = 1.7;

/// Δχ² at a distance from the bound, where the profile of a parameter that ended there begins. The
/// slope from the bound, Δχ² / distance, is a straight line where Δχ² is a parabola: it is that
/// which goes between the profile's values.
double between(const Profile& profile, double bound, double distance) {
  std::vector<std::array<double, 2>> slopes;  // distance, slope
  for (std::size_t k = 0; k < profile.value.size(); ++k) {
    const double away = std::abs(profile.value[k] - bound);
    if (away > 0.0) slopes.push_back({away, profile.delta_chi2[k] / away});
  }
  std::ranges::sort(slopes);
  if (slopes.empty()) return 0.0;
  if (slopes.size() == 1) return distance * slopes[0][1];
  auto after = std::ranges::find_if(slopes, [&](const auto& s) { return s[0] >= distance; });
  if (after == slopes.begin()) ++after;
  if (after == slopes.end()) --after;
  const auto [near, low] = after[-1];
  const auto [far, high] = *after;
  return distance * std::lerp(low, high, (distance - near) / (far - near));
}

/// Where the 95 % end on the side that is left; none where the data want the parameter beyond its
/// bound, or do not tell an end.
std::optional<double> end_of(const Profile& profile, const Parameter& p) {
  const bool at_lower = std::abs(p.value - p.lower) <= std::abs(p.value - p.upper);
  const std::optional<double>& limit = at_lower ? profile.upper : profile.lower;
  if (!limit || profile.found_better) return std::nullopt;
  if (between(profile, p.value, 0.5 * std::abs(*limit - p.value)) > steep) return std::nullopt;
  return limit;
}

}  // namespace

void settle_bounds(Fit& fit) {
  for (Parameter& p : fit.parameters) {
    if (!p.at_bound) continue;
    const std::string unit = p.unit == "1" ? "" : " " + p.unit;
    const auto profile = std::ranges::find(fit.profiles, p.name, &Profile::name);
    const std::optional<double> limit =
        profile != fit.profiles.end() ? end_of(*profile, p) : std::nullopt;
    if (!limit) {
      fit.warnings.push_back(fmt::format(
          "{} ended at its bound {:g}{}; its interval means little. Widen what the model can do, "
          "or fix it.",
          p.name, p.value, unit));
      if (!(p.std_error < p.upper - p.lower)) {  // it knows less than the bounds do
        p.std_error = std::numeric_limits<double>::quiet_NaN();
        p.ci95 = {p.lower, p.upper};
      }
      continue;
    }
    p.ci95 = {std::min(p.value, *limit), std::max(p.value, *limit)};
    p.std_error = std::abs(*limit - p.value) / normal95;
    p.mesh_shift = 0.0;
    fit.warnings.push_back(fmt::format(
        "{} ended at its bound {:g}{}, from which the data do not tell it. Its interval, to "
        "{:.3g}{}, is of the one side that is left, by profile likelihood.",
        p.name, p.value, unit, *limit, unit));
    if (p.name == "contact.restitution" || p.name == "contact.restitution[1]")
      fit.restitution["law"] = {p.value, p.ci95};
  }
}

}  // namespace impactrig::fitting
