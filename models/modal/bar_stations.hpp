// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "models/beams/bar_element.hpp"
#include "models/rig.hpp"

namespace impactrig::models {

/// A bar in its modes in short pieces that end where it changes and at the struck point, so that a
/// bending wave meets as many everywhere. What small motion leaves out is added up by them.
struct BarStations {
  struct Lump {
    Eigen::Index station;
    double part;  ///< of the station's length
    double mass;  ///< [kg]
  };

  /// Slopes w' and their rates (stations) [rad, rad/s].
  struct Slopes {
    Eigen::VectorXd slope, rate;
  };

  /// Displacement of a point, x from the hinge [m], under unit modal coordinates (m).
  using PointOf = std::function<Eigen::VectorXd(double)>;

  /// Faster axial modes hardly move, and the stations could not tell them apart.
  static constexpr int most_axial_modes = 8;

  /// Of so many modes. The bar stretches in `axial_modes`, up to the most.
  BarStations(const Rig& rig, int modes, const PointOf& point, int axial_modes);

  BarStations() = default;

  Eigen::VectorXd x, length;  ///< where each begins, and how long it is [m] (stations)
  Eigen::VectorXd mass;       ///< of the bar in each [kg] (stations)
  Eigen::MatrixXd slopes;     ///< of the modes, mean over each (stations, m)
  std::vector<Lump> lumps;    ///< further masses
  Eigen::VectorXd bending;    ///< EI over the way, to the next one's middle [N m] (stations - 1)
  Eigen::VectorXd weight;     ///< that pulls at each one's middle [N] (stations)
  Eigen::VectorXd stretch;    ///< of each one under a pull [m/N]; 0 where the bar does not
  /// Axial modes in which the bar stretches, of unit modal mass, at the stations' middles and at
  /// the lumps (stations + lumps, k), and their frequencies' squares [1/s²] (k).
  Eigen::MatrixXd axial;
  Eigen::VectorXd axial_squares;

  double middle(Eigen::Index i) const { return x[i] + 0.5 * length[i]; }

  double place(const Lump& lump) const {
    return x[lump.station] + lump.part * length[lump.station];
  }

  /// From each station's own values, those of all that is further out and half of its own.
  static void add_up_from_tip(Eigen::VectorXd& values);

  /// A bar with all its moduli and all its masses times these, under a weight a mass that grows
  /// with the moduli.
  void scale(double of_stiffness, double of_mass);

  void find_slopes(const Eigen::VectorXd& a, const Eigen::VectorXd& rate, Slopes& to) const;

  /// The bar's points move towards the hinge as it bends and turns, to the lowest order with
  /// u̇(x) = ∫₀ˣ w' ẇ' dξ: the momentum of each station, its lumps included [kg m/s] (stations);
  /// tells the kinetic energy ½ ∫ u̇² dm [J].
  double shorten(const Slopes& of, Eigen::VectorXd& momentum) const;

 private:
  void find_axial_modes(const std::vector<BarElement>& spans, int modes);
};

}  // namespace impactrig::models
