// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/bound_interval.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace impactrig::fitting {
namespace {

constexpr double normal95 = 1.959963984540054;

// Δχ² half-way to where it is 3.84: 0.96 from a minimum on, 1.92 along a slope; 1.7 where a
// parabola has its minimum 1.6 standard errors beyond the bound.
constexpr double steep = 1.7;

/// Δχ² at a value between those of the profile.
double between(const Profile& profile, double value) {
  const auto after = std::ranges::upper_bound(profile.value, value);
  if (after == profile.value.begin()) return profile.delta_chi2.front();
  if (after == profile.value.end()) return profile.delta_chi2.back();
  const auto k = static_cast<std::size_t>(after - profile.value.begin());
  const double part = (value - profile.value[k - 1]) / (profile.value[k] - profile.value[k - 1]);
  return std::lerp(profile.delta_chi2[k - 1], profile.delta_chi2[k], part);
}

/// Where the 95 % end on the side that is left; none where the data want the parameter beyond its
/// bound, or do not tell an end.
std::optional<double> end_of(const Profile& profile, const Parameter& p) {
  const bool at_lower = std::abs(p.value - p.lower) <= std::abs(p.value - p.upper);
  const std::optional<double>& limit = at_lower ? profile.upper : profile.lower;
  if (!limit || profile.found_better) return std::nullopt;
  if (between(profile, 0.5 * (p.value + *limit)) > steep) return std::nullopt;
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
