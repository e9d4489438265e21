// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/axial_pull.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace impactrig::models {
namespace {

/// Free of force.
void coast(const ModalBeam& beam, const ModalStep& step, double part, const ModalState& from,
           ModalState& to) {
  if (part < 1.0)
    advance(beam, part * step.h(), NodeVector::Zero(1), from, to);
  else
    step.coast(from, to);
}

}  // namespace

AxialPull::AxialPull(const ModalBeam& beam) : beam_(beam), inertia_(beam.rigid().squaredNorm()) {
  const Eigen::VectorXd at_stations = Eigen::VectorXd::Zero(beam.stations().mass.size());
  const Eigen::VectorXd of_modes = Eigen::VectorXd::Zero(beam.modes());
  before_ = after_ = {at_stations, at_stations, at_stations};
  pull_ = at_stations;
  force_ = held_ = middle_ = way_ = drag_ = of_modes;
  last_ = missing_ = end_ = answer_ = rest_ = {of_modes, of_modes};
}

void AxialPull::touch(const ModalState& state, const ModalBeam::StationSlopes& slopes,
                      double negligible) {
  look(state, slopes, before_);
  last_ = state;
  const double energy =
      0.5 * (state.rate.squaredNorm() + beam_.omega().cwiseProduct(state.a).squaredNorm());
  stretches_ = beam_.most_stretching(energy) > negligible;
  missing_ = rest_;
  deepest_ = stiffness_ = largest_ = impulse_ = missing_impulse_ = share_ = of_peak_ = of_depth_ =
      0.0;
}

void AxialPull::look(const ModalState& state, const ModalBeam::StationSlopes& slopes, Look& at) {
  const ModalBeam::Stations& stations = beam_.stations();
  const RigidPart rigid = beam_.rigid_part(state.a, state.rate);
  at.rate = rigid.rate;
  at.slope = slopes.slope.array() - rigid.angle;
  double v = 0.0, v_rate = 0.0, u_rate = 0.0;
  for (Eigen::Index i = 0; i < at.slope.size(); ++i) {
    const double s = at.slope[i], s_rate = slopes.rate[i] - rigid.rate, dx = stations.length[i];
    const auto along = [&](double part) {
      return rigid.rate * (v + part * s * dx) + u_rate + part * s * s_rate * dx;
    };
    const auto across = [&](double part) {
      return rigid.rate * (stations.x[i] + part * dx) + v_rate + part * s_rate * dx;
    };
    at.along[i] = stations.mass[i] * along(0.5);
    at.across[i] = stations.mass[i] * across(0.5);
    for (const ModalBeam::Stations::Lump& lump : stations.lumps) {
      if (lump.station != i) continue;
      at.along[i] += lump.mass * along(lump.part);
      at.across[i] += lump.mass * across(lump.part);
    }
    v += s * dx;
    v_rate += s_rate * dx;
    u_rate += s * s_rate * dx;
  }
  // of all that is further out, and half of a station's own
  for (Eigen::VectorXd* momentum : {&at.along, &at.across}) {
    double beyond = 0.0;
    for (Eigen::Index i = momentum->size() - 1; i >= 0; --i) {
      const double own = (*momentum)[i];
      (*momentum)[i] = beyond + 0.5 * own;
      beyond += own;
    }
  }
}

/// What the pull does to the modes between the last state and this one.
void AxialPull::find_force(const ModalState& state, double h) {
  const ModalBeam::Stations& stations = beam_.stations();
  const double turning = 0.5 * (before_.rate + after_.rate);
  for (Eigen::Index i = 0; i < pull_.size(); ++i) {
    const double tension = (after_.along[i] - before_.along[i]) / h +
                           0.5 * turning * (before_.across[i] + after_.across[i]);
    pull_[i] = -0.5 * stations.length[i] * tension * (before_.slope[i] + after_.slope[i]);
  }
  middle_ = 0.5 * (last_.a + state.a);
  force_.noalias() = stations.slopes.transpose() * pull_;
  force_ += turning * turning * middle_;
  if (stretches_) beam_.add_stretching_force(middle_, force_);
  force_ -= beam_.rigid() * (beam_.rigid().dot(force_) / inertia_);
  if (!beam_.damped()) return;
  way_ = state.a - last_.a;
  beam_.coupled_drag(way_, drag_);
  force_ -= drag_ / h;
}

void AxialPull::follow(const ModalState& state, const ModalBeam::StationSlopes& slopes,
                       const ModalStep& step, double part, double contact_force) {
  look(state, slopes, after_);
  find_force(state, part * step.h());
  // about where the force would hold them the modes vibrate freely; the pendulum's turns the frame
  held_[0] = 0.0;
  for (Eigen::Index k = 1; k < force_.size(); ++k)
    held_[k] = force_[k] / std::pow(beam_.omega()[k], 2);
  const double from = missing();
  missing_.a -= held_;
  coast(beam_, step, part, missing_, end_);
  end_.a += held_;
  const double blow = beam_.damped() ? -drag_[0] : 0.0;
  end_.a[0] += 0.5 * blow * part * step.h();
  end_.rate[0] += blow;
  answer(step, part, from, contact_force);
  std::swap(missing_, end_);
  std::swap(before_, after_);
  last_ = state;
}

/// The contact answers as a spring as stiff as where it was deepest: on the way back damping hides
/// that. Adds what of its force is missing to what peak and impulse miss.
void AxialPull::answer(const ModalStep& step, double part, double from, double contact_force) {
  const double depth = beam_.struck().dot(middle_);
  if (depth > deepest_) {
    deepest_ = depth;
    stiffness_ = std::max(contact_force, 0.0) / depth;
  }
  if (!(deepest_ > 0.0)) return;
  if (part < 1.0) advance(beam_, part * step.h(), NodeVector::Ones(1), rest_, answer_);
  const ModalState& answer = part < 1.0 ? answer_ : step.of_unit_force();
  const double gives = -beam_.struck().dot(answer.a);
  const double force =
      0.5 * stiffness_ * (from + beam_.struck().dot(end_.a)) / (1.0 + 0.5 * stiffness_ * gives);
  end_.a += force * answer.a;
  end_.rate += force * answer.rate;
  of_depth_ = std::max(of_depth_, std::abs(beam_.struck().dot(end_.a)) / deepest_);
  const double h = part * step.h();
  impulse_ += contact_force * h;
  missing_impulse_ += force * h;
  if (impulse_ > 0.0) share_ = std::max(share_, std::abs(missing_impulse_) / impulse_);
  if (contact_force < largest_) return;
  largest_ = contact_force;
  if (largest_ > 0.0) of_peak_ = std::abs(force) / largest_;
}

}  // namespace impactrig::models
