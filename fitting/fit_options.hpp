// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fitting/bootstrap_kind.hpp"
#include "fitting/loss.hpp"

namespace impactrig::fitting {

/// This parameter is a line of another one: value = factor · value of `to` + offset.
struct Tie {
  std::string to;       ///< a name as in FitOptions::free
  double factor = 1.0;  ///< [unit of this / unit of `to`]
  double offset = 0.0;  ///< [unit of this]

  bool operator==(const Tie&) const = default;
};

/// What a user states of one parameter of a fit; what is silent is as the fit has it by itself.
struct ParameterSetting {
  std::string name;                    ///< as in FitOptions::free
  std::optional<double> initial = {};  ///< where the search begins [SI]
  std::optional<double> lower = {}, upper = {};
  std::optional<std::array<double, 2>> prior = {};  ///< value, standard uncertainty
  std::optional<bool> shared = {};  ///< one value for all recordings, or one for each
  std::optional<Tie> tie = {};
  bool fixed = false;  ///< not fitted, whatever else says it is
  /// Searched, and its interval found, by its logarithm: greater than zero however unsure it is.
  bool by_logarithm = false;

  bool operator==(const ParameterSetting&) const = default;
};

/// What is fitted to what, and how. The [fit] table of a rig file (docs/fitting.md).
struct FitOptions {
  /// Rig-file keys; empty: restitution, stiffness factor, approach speed, as far as the rig has
  /// them. A parameter with a setting is free besides these, unless that is fixed.
  std::vector<std::string> free;
  std::vector<ParameterSetting> settings;
  /// Of the search for the best fit, by the clock [s]. One that is not over by then ends where it
  /// is and says so; profiles and bootstrap come on top of it.
  double time_limit = 600.0;
  /// Fitted after first touch [s]; 0: as long as rig and recording allow, or until before the
  /// second contact where what follows cannot be fitted.
  double window = 0.0;
  bool use_force = true, use_velocity = true, use_displacement = false;
  bool channels_stated = false;  ///< the three above are asked for, not the default
  Loss loss = Loss::squares;
  /// Metrics, diagnostics and direct estimates, which a report shows. Without, a fit is parameters,
  /// intervals and curves: for fits of which only those are looked at.
  bool for_report = true;
  bool profile = false;  ///< profile likelihood of the physics and the sensors
  int bootstrap = 0;     ///< draws
  BootstrapKind bootstrap_kind = BootstrapKind::parametric;
  std::uint64_t seed = 1;  ///< of the bootstrap

  const ParameterSetting* setting_of(std::string_view name) const;  ///< none: nullptr

  /// Where what is stated of a parameter goes; made when it is the first.
  ParameterSetting& setting(std::string_view name);
};

}  // namespace impactrig::fitting
