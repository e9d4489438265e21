// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "models/collocation/bar_motion.hpp"
#include "models/collocation/collocation.hpp"
#include "models/modal/modal_beam.hpp"

namespace impactrig::models {

/// Modal coordinates and their rates (m).
struct ModalState {
  Eigen::VectorXd a, rate;
};

/// Exact response of a bar's modes to a force that is a polynomial over a step, by Duhamel's
/// integral. The kernels sin ωτ and cos ωτ are expanded in Legendre polynomials; the coefficients
/// are spherical Bessel functions of ωh/2, so that nothing limits ωh but their number.
class ModalStep {
 public:
  /// The struck point at the nodes, under the state at the step's beginning and under the force's
  /// values at the nodes.
  struct Response {
    Eigen::MatrixXd displacement_of_a, displacement_of_rate;  // (s, m)
    Eigen::MatrixXd velocity_of_a, velocity_of_rate;          // (s, m)
    BarMotion::Response of_force;
  };

  /// Throws std::logic_error when h is longer than longest().
  ModalStep(const ModalBeam& beam, const Collocation& rule, double h);

  /// The longest step whose kernels' series can be held [s]; infinite without vibration.
  static double longest(const ModalBeam& beam);

  double h() const { return h_; }

  const Response& response() const { return response_; }

  /// The state at the step's end, free of force or under one.
  void coast(const ModalState& from, ModalState& to) const;
  void advance(const ModalState& from, const NodeVector& force, ModalState& to) const;

 private:
  void respond_to_state(const ModalBeam& beam, const Collocation& rule);
  void respond_to_force(const ModalBeam& beam, const Collocation& rule);

  double h_;
  Eigen::ArrayXd cosine_, sine_over_omega_, minus_omega_sine_;
  Eigen::MatrixXd a_of_force_, rate_of_force_;  // (m, s)
  Response response_;
};

/// The same over a time of any length, for a force given by the coefficients of its Legendre series
/// over that time. Set anew for each length, without allocating once it has held as many terms.
class ModalJump {
 public:
  void set(const ModalBeam& beam, double h, int terms);

  /// `to` may not be `from`.
  void advance(const NodeVector& series, const ModalState& from, ModalState& to) const;

 private:
  Eigen::ArrayXd cosine_, sine_over_omega_, minus_omega_sine_;
  Eigen::MatrixXd a_of_series_, rate_of_series_;  // (m, terms)
};

}  // namespace impactrig::models
