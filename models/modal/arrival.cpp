// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/arrival.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "models/modal/bar_cache.hpp"
#include "models/modal/modal_load.hpp"
#include "models/rigid_swing.hpp"
#include "models/spring_bending.hpp"

namespace impactrig::models {
namespace {

// A bar that vibrates with this part of its speed may come back before it touches.
constexpr double most_vibration = 0.5;

// Of the rate that a mode's frequency changes by in a bar that turns at Ω, Ω² / ω: a hinged blade's
// second flap has ω² + 6.4 Ω² in the plane it does not turn in, Ω² less in the other.
constexpr double of_centrifugal = 3.0;

// A moment in the hinge bends a bar's slowest mode so many times as much as its weight's of the
// same size: slope at the hinge over deflection in the middle, of a uniform bar.
constexpr double of_moment = 10.0;

// What a spring's moment, let go, does to a result, over spring_bending(): 5.6 at most of random
// scenes.
constexpr double most_of_spring = 6.0;

// What a damper's moment, that bends the bar as it arrives, does to a result, over
// bent_by_damper().
constexpr double most_of_damper = 2.0;

// What friction's moment, that bends the bar all the way, does to a result, over
// bent_by_friction().
constexpr double most_of_friction = 2.0;

// What a bar that swings slower than a rigid one does to a result, over slowed_by_bending(): 1.1 of
// a tube let go from 0.5 to 16 mrad.
constexpr double most_of_slowness = 2.0;

/// Of the vibration, what is left out: what the swing's centrifugal force does to its phase, terms
/// of fourth order, what friction in the hinge bends, and that a spring there goes by the angle,
/// not by its sine.
double left_out(const Rig& rig, const RigidSwing::Arrival& arrival, double slowest) {
  const double phase = of_centrifugal * arrival.rate * arrival.rate * arrival.time / slowest;
  const double apart = arrival.rate / slowest;
  const double angle = *rig.start.release_angle;
  const double moment = rig.beam.hinge_inertia() * RigidSwing(rig).acceleration(-angle, 0.0);
  const double bends = of_moment *
                       (rig.hinge.friction + rig.hinge.spring * std::abs(angle - std::sin(angle))) /
                       moment;
  return std::min(phase, 1.0) + apart * apart + bends;
}

/// How much slower the bar swings than a rigid one, which its weight bends on the way: of the
/// speed it arrives with. That is as much as its frequency, and more where a damper or friction
/// hardly lets it arrive; 1 where a slower one does not.
double slowed_by_bending(const Rig& rig, const ModalBeam& beam, double rate) {
  constexpr double small = 1e-4;  // [rad]
  const RigidSwing swing(rig);
  const double square =
      (swing.acceleration(-small, 0.0) - swing.acceleration(small, 0.0)) / (2.0 * small);
  if (!(square > 0.0)) return 0.0;
  const double slower = std::abs(beam.omega()[0] / std::sqrt(square) - 1.0);
  if (slower == 0.0) return 0.0;
  Rig other = rig;
  other.gravity *= (1.0 - slower) * (1.0 - slower);
  other.hinge.spring *= (1.0 - slower) * (1.0 - slower);
  const auto arrives = RigidSwing(other).rate_after_release(*rig.start.release_angle);
  if (!arrives) return 1.0;
  return std::max(slower, std::abs(*arrives / rate - 1.0));
}

/// How fast the struck point would vibrate if what a damper in the hinge bends the bar by were let
/// go [m/s].
double bent_by_damper(const ModalBeam& beam, double rate) {
  Eigen::VectorXd drag(beam.modes());
  beam.coupled_drag(beam.rigid() * rate, drag);
  const auto bending = beam.modes() - 1;
  return (drag.tail(bending).array() / beam.omega().tail(bending).array() *
          beam.struck().tail(bending).array())
      .matrix()
      .norm();
}

/// What friction in the hinge does to the speed of the struck point as the bar arrives: it bends
/// the bar, which then vibrates as if let go, and the hinge turns less than a rigid bar's does, by
/// which friction takes less of the little energy that it may have left. A part of the speed.
double bent_by_friction(const Rig& rig, const ModalBeam& beam, double rate) {
  const double friction = rig.hinge.friction;
  if (friction == 0.0) return 0.0;
  const auto bending = beam.modes() - 1;
  const Eigen::ArrayXd omega = beam.omega().tail(bending).array();
  const Eigen::ArrayXd turns = beam.hinge().tail(bending).array() / omega;
  const double vibration = friction * (turns * beam.struck().tail(bending).array()).matrix().norm();
  const double work = friction * friction * turns.square().sum();
  return vibration / (rig.contact.position * rate) +
         0.5 * work / (0.5 * rig.beam.hinge_inertia() * rate * rate);
}

/// The modes about touch.
class ArrivingModes {
 public:
  ArrivingModes(const Rig& rig, const ModalBeam& beam, double angle, RigidSwing::Arrival arrival)
      : beam_(beam),
        arrival_(arrival),
        rigid_(without_pendulum(beam.rigid())),
        held_(without_pendulum(ModalLoad(beam).held())),
        square_(beam.omega().cwiseAbs2()) {
    square_[0] = 1.0;
    const RigidSwing swing(rig);
    acceleration_ =
        swing.acceleration(0.0, arrival.rate) - rig.hinge.friction / rig.beam.hinge_inertia();
    const double first =
        swing.acceleration(-angle, 0.0) - rig.hinge.friction / rig.beam.hinge_inertia();
    const double sine = std::sin(-angle), cosine = std::cos(angle);
    lacked_.a = rigid_ * sine - held_ * cosine -
                (rigid_ * cosine + held_ * sine).cwiseQuotient(square_) * first;
    lacked_.rate = Eigen::VectorXd::Zero(beam.modes());
  }

  /// A time from that at which the rigid bar touches.
  Arrival at(double time) const {
    Arrival to;
    to.angle = (arrival_.rate + 0.5 * acceleration_ * time) * time;
    to.rate = arrival_.rate + acceleration_ * time;
    to.bending = lacked_;
    advance(beam_, arrival_.time + time, NodeVector::Zero(1), lacked_, to.bending);
    to.bending.a += held_ - rigid_ * to.angle +
                    (rigid_ * acceleration_ + held_ * (to.rate * to.rate) +
                     beam_.damping().cwiseProduct(rigid_) * to.rate)
                        .cwiseQuotient(square_);
    to.bending.rate -= rigid_ * to.rate;
    to.bending.a[0] = to.bending.rate[0] = 0.0;
    return to;
  }

  PointMotion struck(const Arrival& arrival) const {
    const Eigen::VectorXd& row = beam_.struck();
    const double lever = row.dot(beam_.rigid());
    return {lever * arrival.angle + row.dot(arrival.bending.a),
            lever * arrival.rate + row.dot(arrival.bending.rate)};
  }

 private:
  static Eigen::VectorXd without_pendulum(Eigen::VectorXd modes) {
    modes[0] = 0.0;
    return modes;
  }

  const ModalBeam& beam_;
  RigidSwing::Arrival arrival_;
  Eigen::VectorXd rigid_, held_, square_;  // square: ω²
  double acceleration_;                    // of the rigid bar as it touches [rad/s²]
  ModalState lacked_;                      // what the modes lacked as the bar was let go
};

}  // namespace

Arrival arrive(const Rig& rig, const ModalBeam& beam) {
  const double angle = *rig.start.release_angle;
  const auto rigid = RigidSwing(rig).arrive(angle);
  if (!rigid) {
    touch_velocity(rig);  // says why it does not arrive
    throw std::runtime_error("the swing to the stop takes too long to be followed");
  }
  const ArrivingModes modes(rig, beam, angle, *rigid);
  Arrival arrival = modes.at(0.0);
  const double speed = rig.contact.position * rigid->rate;
  const auto bending = beam.modes() - 1;
  if (bending == 0) return arrival;
  const Eigen::ArrayXd rate = arrival.bending.rate.tail(bending).array();
  const Eigen::ArrayXd bent = (beam.omega().cwiseProduct(arrival.bending.a)).tail(bending).array();
  const Eigen::VectorXd fastest = (rate.square() + bent.square()).sqrt();
  const double vibration = fastest.dot(beam.struck().tail(bending).cwiseAbs()) / speed;
  if (vibration < most_vibration) {
    double time = 0.0;
    for (int i = 0; i < 20; ++i) {
      const PointMotion point = modes.struck(arrival);
      if (std::abs(point.displacement) < 1e-16 * speed * rigid->time) break;
      time -= point.displacement / point.velocity;
      arrival = modes.at(time);
    }
  }
  // not followed
  const double held_back = most_of_spring * spring_bending(rig) +
                           most_of_damper * bent_by_damper(beam, rigid->rate) / speed +
                           most_of_friction * bent_by_friction(rig, beam, rigid->rate);
  arrival.slower = most_of_slowness * slowed_by_bending(rig, beam, rigid->rate);
  arrival.vibration = vibration + held_back;
  arrival.error =
      vibration < most_vibration
          ? held_back + arrival.slower +
                vibration *
                    (vibration + left_out(rig, *rigid, beam.omega().tail(bending).minCoeff()))
          : 1.0;
  return arrival;
}

namespace {

/// By the slowest modes.
std::optional<Arrival> arrive_roughly(const Rig& rig) {
  if (!beyond_small_motion(rig).empty() || spring_bends_bar(rig)) return std::nullopt;
  if (!RigidSwing(rig).arrive(*rig.start.release_angle)) return std::nullopt;
  Solver slowest;
  slowest.model = BeamModel::hybrid;
  slowest.basis = Basis::pinned_free;
  slowest.modes = 4;
  slowest.axial_modes = 0;
  return arrive(rig, BarCache().bar(rig, slowest)->modes());
}

}  // namespace

std::optional<double> release_vibration(const Rig& rig) {
  const std::optional<Arrival> arrival = arrive_roughly(rig);
  return arrival ? std::optional(arrival->vibration) : std::nullopt;
}

std::optional<double> missed_by_rigid_swing(const Rig& rig) {
  const std::optional<Arrival> arrival = arrive_roughly(rig);
  return arrival ? std::optional(arrival->vibration + arrival->slower) : std::nullopt;
}

}  // namespace impactrig::models
