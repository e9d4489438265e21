// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "models/collocation/bar_motion.hpp"
#include "models/collocation/collocation.hpp"
#include "models/lanes/step_lanes.hpp"
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
    Eigen::MatrixXd velocity_of_a;  // (s, m); of the rate as the displacement of a
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

  /// Writes what the step does into a lane of steps of as many modes and nodes.
  void write_to(StepLanes& lanes, int lane) const;

 private:
  void respond_to_force(const Collocation& rule, const Eigen::MatrixX2d& kernels);

  double h_;
  Eigen::ArrayXd cosine_, sine_over_omega_, minus_omega_sine_;
  Eigen::MatrixXd a_of_force_, rate_of_force_;  // (s, m)
  Response response_;
};

/// The state after a time h under a force given by the coefficients of its Legendre series over h;
/// tells how the struck point then moves, its acceleration without what the force then does to it.
PointMotion advance(const ModalBeam& beam, double h, const NodeVector& series,
                    const ModalState& from, ModalState& to, double* acceleration = nullptr);

}  // namespace impactrig::models
