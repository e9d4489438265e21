// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "datasets/impact.hpp"
#include "fitting/fit_options.hpp"
#include "fitting/parameters.hpp"
#include "fitting/rig_file.hpp"

namespace impactrig::fitting {

/// A course that a channel's background may follow, in terms of the time since the impact as found.
/// Together they follow baseline, amplifier drift and mains hum.
struct BackgroundShape {
  enum class Kind { constant, line, sine, cosine };

  Kind kind = Kind::constant;
  double angular_frequency = 0.0;  ///< of sine and cosine [rad/s]

  double at(double t) const;

  bool periodic() const { return kind == Kind::sine || kind == Kind::cosine; }
};

/// One number of a fit: a parameter of the physics, or of what stands between the impact and a
/// recording. It is an unknown, or tied to one.
struct Variable {
  enum class Role { physics, touch, background, gain, delay, chain };

  /// value = factor · that of variable number `to` + offset.
  struct Line {
    std::size_t to;
    double factor;
    double offset;
  };

  Role role = Role::physics;
  const PhysicalParameter* physics = nullptr;  ///< role physics
  const ChainParameter* chain = nullptr;       ///< role chain
  BackgroundShape background;                  ///< role background
  datasets::Quantity quantity =
      datasets::Quantity::unknown;  ///< channel of background, gain, delay, chain
  int recording = -1;               ///< -1: shared by all
  std::string name;
  std::string unit;
  double initial = 0.0;
  double value = 0.0;
  double lower = 0.0, upper = 0.0;
  double scale = 1.0;  ///< typical change
  bool by_logarithm = false;
  std::optional<std::array<double, 2>> prior;  ///< mean, standard uncertainty
  std::optional<Line> tie;

  /// What the solver works on: value / scale, or ln(value / scale).
  double coordinate(double at_value) const {
    return by_logarithm ? std::log(at_value / scale) : at_value / scale;
  }

  double value_at(double coordinate) const {
    return by_logarithm ? scale * std::exp(coordinate) : scale * coordinate;
  }

  /// d value / d coordinate there.
  double slope_at(double at_value) const { return by_logarithm ? at_value : scale; }

  /// Of the impact or of a sensor, not of a record's timing and background.
  bool of_interest() const { return role != Role::touch && role != Role::background; }

  /// A gain, a delay, or another number of a sensor's chain.
  bool is_of_sensor() const {
    return role == Role::gain || role == Role::delay || role == Role::chain;
  }

  bool concerns(int shot) const { return recording < 0 || recording == shot; }
};

/// Whether a channel of an impact enters the fit: asked for, recorded, and not constant. A
/// displacement also where there is neither force nor velocity.
bool is_fitted(const datasets::Impact& impact, const std::optional<datasets::ImpactSignal>& signal,
               const FitOptions& options);

/// The numbers of a fit: what the user frees (by default restitution, stiffness factor, approach
/// speed), and for every recording first touch, each channel's offset, drift and mains hum, and
/// gains and delays whose calibration states an uncertainty; each with what the options state of
/// it. Throws std::invalid_argument on a name that cannot be fitted or is named twice, on bounds
/// without room, and on a tie to what is not fitted.
std::vector<Variable> make_variables(const std::vector<datasets::Impact>& impacts,
                                     const RigFile& rig, const FitOptions& options);

}  // namespace impactrig::fitting
