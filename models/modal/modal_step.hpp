// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "models/collocation/bar_motion.hpp"
#include "models/collocation/collocation.hpp"
#include "models/modal/modal_beam.hpp"

namespace impactrig::models {

/// Modal coordinates and their rates (m).
struct ModalState {
  Eigen::VectorXd a, rate;
};

/// Exact response of a bar's modes to forces that are polynomials over a step, by Duhamel's
/// integral. The kernels sin ωτ and cos ωτ are expanded in Legendre polynomials; the coefficients
/// are spherical Bessel functions of ωh/2, so that nothing limits ωh but their number. Likewise
/// those of damped modes (ModeKernel), but for what of them dies out early in a step, whose
/// convolution with a polynomial is known as well.
class ModalStep {
 public:
  using Rows = Eigen::Map<const Eigen::MatrixXd>;

  /// Throws std::logic_error when the kernels' series cannot be held, which they can where h is
  /// longer than longest() by no more than a hundredth.
  ModalStep(const ModalBeam& beam, const Collocation& rule, double h);

  /// What a step becomes, free of damping and with a single stop, on a bar where everything takes
  /// `time` times as long, and that has `mass` times the mass.
  class Scale {
   public:
    Scale(int modes, int nodes, double time, double mass);

    double time() const { return time_; }

   private:
    friend class ModalStep;

    double time_;
    Eigen::VectorXd of_numbers_;                // of ModalStep's
    NodeMatrix of_displacement_, of_velocity_;  // of its response
  };

  /// Steps of as many modes, nodes and stops: what each does, weighted and summed, as a step of
  /// length h [s]; then scaled.
  static ModalStep sum(std::span<const ModalStep* const> steps, std::span<const double> weights,
                       double h, const Scale* scale = nullptr);

  /// The same into a step that is no longer needed, of as many modes, nodes and stops.
  void become_sum(std::span<const ModalStep* const> steps, std::span<const double> weights,
                  double h, const Scale* scale = nullptr);

  /// Modes that a step is about, by their numbers among all.
  struct Share {
    const ModalStep* step;
    const std::vector<Eigen::Index>* modes;
  };

  /// A step of all m modes made of steps of some each; the others stay where they are.
  static ModalStep joined(std::span<const Share> shares, Eigen::Index m);

  /// The longest step whose kernels' series can be held [s]; infinite without vibration.
  static double longest(const ModalBeam& beam);

  double h() const { return h_; }

  int nodes() const { return static_cast<int>(nodes_); }

  /// The struck point at the nodes under the state at the step's beginning: displacements, then
  /// velocities (2 s, m).
  Rows of_a() const { return {at(Part::of_a), 2 * nodes_, modes_}; }

  Rows of_rate() const { return {at(Part::of_rate), 2 * nodes_, modes_}; }

  /// Of the point before a stop to the force of a stop, by its values at the nodes.
  const BarMotion::Response& response(int point, int stop) const {
    return point == 0 && stop == 0 ? response_
                                   : of_force_[static_cast<std::size_t>(point * stops() + stop)];
  }

  /// The struck point, or that before another stop, under the state at the step's beginning.
  void coast(int stop, const ModalState& from, NodeVector& displacement,
             NodeVector& velocity) const;

  /// The state at the step's end, free of force or under that of the first stop.
  void coast(const ModalState& from, ModalState& to) const;
  void advance(const ModalState& from, const NodeVector& force, ModalState& to) const;

  /// Under the forces of all stops.
  void advance(const ModalState& from, std::span<const NodeVector> forces, ModalState& to) const;

  /// The state at the step's end after rest, under a force of 1 N of the first stop all the time.
  Eigen::Map<const Eigen::VectorXd> a_of_unit_force() const {
    return {at(Part::a_of_unit_force), modes_};
  }

  Eigen::Map<const Eigen::VectorXd> rate_of_unit_force() const {
    return {at(Part::rate_of_unit_force), modes_};
  }

  /// What the force of a further stop adds to it.
  void add(int stop, const NodeVector& force, ModalState& to) const;

  /// How far it is from another step of the same bar, as a part of what the modes' answers can be;
  /// with a single stop.
  double distance(const ModalStep& other, const ModalBeam& beam) const;

 private:
  /// Where among the numbers what belongs to the first stop begins.
  enum class Part {
    a_of_a,  // the state at the end (m)
    a_of_rate,
    rate_of_a,
    rate_of_rate,
    a_of_unit_force,
    rate_of_unit_force,
    a_of_force,  // by the force's values at the nodes (m, s)
    rate_of_force,
    of_a,  // (2 s, m)
    of_rate,
    end
  };

  /// What belongs to the point before a further stop.
  struct Further {
    Eigen::MatrixXd of_a, of_rate;              // as of the first
    Eigen::MatrixXd a_of_force, rate_of_force;  // (m, s)
  };

  ModalStep(double h, Eigen::Index modes, Eigen::Index nodes);

  static Eigen::Index place(Part part, Eigen::Index modes, Eigen::Index nodes);

  const double* at(Part part) const { return numbers_.data() + place(part, modes_, nodes_); }

  double* at(Part part) { return numbers_.data() + place(part, modes_, nodes_); }

  void move(const ModalState& from, const double* force, ModalState& to) const;

  int stops() const { return 1 + static_cast<int>(further_.size()); }

  void respond_further(const ModalBeam& beam, const Collocation& rule, int terms);
  void set_zero();
  void add(const Share& share);

  double h_;
  Eigen::Index modes_, nodes_;
  Eigen::VectorXd numbers_;  // Part by Part: a step is made in one piece
  BarMotion::Response response_;
  std::vector<Further> further_;
  std::vector<BarMotion::Response> of_force_;  // point by point; empty where there is one stop
};

/// The state after a time h under a force given by the coefficients of its Legendre series over h;
/// tells how the struck point then moves, its acceleration without what the force then does to it.
PointMotion advance(const ModalBeam& beam, double h, const NodeVector& series,
                    const ModalState& from, ModalState& to, double* acceleration = nullptr);

/// The state after a time h under the forces of all stops, each given like that.
void advance(const ModalBeam& beam, double h, std::span<const NodeVector> series,
             const ModalState& from, ModalState& to);

/// What the force of a further stop adds to the state.
void add_force(const ModalBeam& beam, int stop, double h, const NodeVector& series, ModalState& to);

}  // namespace impactrig::models
