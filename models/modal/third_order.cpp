// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/third_order.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "models/lanes/station_lanes.hpp"
#include "models/modal/mode_kernel.hpp"

namespace impactrig::models {
namespace {

// A mode that turns by less than this in a step is moved as if nothing held it.
constexpr double hardly_held = 1e-3;

}  // namespace

ThirdOrder::ThirdOrder(const ModalBeam& beam) : beam_(beam) {
  const Eigen::VectorXd at_stations = Eigen::VectorXd::Zero(beam.stations().mass.size());
  const Eigen::VectorXd of_modes = Eigen::VectorXd::Zero(beam.modes());
  const Eigen::VectorXd of_axial = Eigen::VectorXd::Zero(beam.stations().axial_squares.size());
  before_ = after_ = {at_stations, at_stations, of_axial, of_axial};
  axial_ = axial_rate_ = elastic_rate_ = of_axial;
  slope_ = pull_ = strain_ = at_stations;
  force_ = held_ = middle_ = rate_ = drag_ = of_modes;
  last_ = missing_ = end_ = answer_ = rest_ = {of_modes, of_modes};
}

double ThirdOrder::energy_of(const ModalState& state) const {
  return 0.5 * (state.rate.squaredNorm() + beam_.omega().cwiseProduct(state.a).squaredNorm());
}

void ThirdOrder::touch(const ModalState& state, const BarStations::Slopes& slopes,
                       double negligible) {
  elastic_rate_.setZero();
  look(slopes, before_);
  last_ = state;
  energy_ = energy_of(state);
  negligible_ = negligible;
  stretches_ = beam_.most_stretching(energy_) > negligible_;
  missing_ = rest_;
  contact_ = {};
  shortening_ = largest_ = impulse_ = missing_impulse_ = of_peak_ = most_displacement_ = 0.0;
  const double rate = beam_.rigid_part(state.a, state.rate).rate;
  turn_steadily(rate);
  lengthen(rate);
}

/// The axial modes are stretched by the turning.
void ThirdOrder::turn_steadily(double rate) {
  const BarStations& stations = beam_.stations();
  axial_.setZero();
  const auto add = [&](Eigen::Index row, double mass, double x) {
    axial_ -= mass * rate * rate * x * stations.axial.row(row).transpose();
  };
  const Eigen::Index count = slope_.size();
  for (Eigen::Index i = 0; i < count; ++i) add(i, stations.mass[i], stations.middle(i));
  for (std::size_t l = 0; l < stations.lumps.size(); ++l) {
    const BarStations::Lump& lump = stations.lumps[l];
    add(count + static_cast<Eigen::Index>(l), lump.mass, stations.place(lump));
  }
  axial_ = before_.drawn + axial_.cwiseQuotient(stations.axial_squares);
  axial_rate_ = before_.drawn_rate;
}

/// A bar that hangs and turns is longer by what its weight and that turning pull; the struck point
/// has its speed.
void ThirdOrder::lengthen(double rate) {
  const BarStations& stations = beam_.stations();
  strain_.setZero();
  if (stations.stretch.isZero(0.0)) return;
  Eigen::VectorXd pull = stations.mass.cwiseProduct(stations.x + 0.5 * stations.length);
  for (const BarStations::Lump& lump : stations.lumps)
    pull[lump.station] += lump.mass * stations.place(lump);
  BarStations::add_up_from_tip(pull);
  pull = rate * rate * pull + stations.weight;
  strain_ = pull.cwiseProduct(stations.stretch).cwiseQuotient(stations.length);
  Eigen::VectorXd longer(pull.size());  // at the stations' middles
  double sum = 0.0, of_struck = 0.0;
  for (Eigen::Index i = 0; i < pull.size(); ++i) {
    const double step = pull[i] * stations.stretch[i];
    longer[i] = sum + 0.5 * step;
    const double left = beam_.struck_position() - stations.x[i];
    of_struck += step * std::clamp(left / stations.length[i], 0.0, 1.0);
    sum += step;
  }
  of_struck /= beam_.struck_position();
  const auto faster = [&](Eigen::Index i, double part) {
    return rate * (longer[i] + (part - 0.5) * pull[i] * stations.stretch[i] -
                   of_struck * (stations.x[i] + part * stations.length[i]));
  };
  for (Eigen::Index i = 0; i < pull.size(); ++i) pull_[i] = stations.mass[i] * faster(i, 0.5);
  for (const BarStations::Lump& lump : stations.lumps)
    pull_[lump.station] += lump.mass * faster(lump.station, lump.part);
  BarStations::add_up_from_tip(pull_);
  pull_.array() *= stations.length.array();
  missing_.rate.noalias() = stations.slopes.transpose() * pull_;
}

/// Tells the energy of shortening [J].
double ThirdOrder::look(const BarStations::Slopes& slopes, Look& at) {
  at.slope = slopes.slope;
  if (elastic_rate_.size() > 0) draw(slopes, at);
  return beam_.stations().shorten(slopes, at.momentum);
}

/// The axial modes, by what shortening draws the stations and lumps to.
void ThirdOrder::draw(const BarStations::Slopes& slopes, Look& at) {
  const BarStations& stations = beam_.stations();
  at.drawn.setZero();
  at.drawn_rate.setZero();
  double u = 0.0, u_rate = 0.0;
  const auto add = [&](Eigen::Index row, double mass, double drawn, double rate) {
    for (Eigen::Index k = 0; k < at.drawn.size(); ++k) {
      at.drawn[k] += stations.axial(row, k) * mass * drawn;
      at.drawn_rate[k] += stations.axial(row, k) * mass * rate;
    }
  };
  for (Eigen::Index i = 0; i < at.slope.size(); ++i) {
    const double s = slopes.slope[i];
    const double step = 0.5 * s * s * stations.length[i];
    const double rate = s * slopes.rate[i] * stations.length[i];
    add(i, stations.mass[i], u + 0.5 * step, u_rate + 0.5 * rate);
    for (std::size_t l = 0; l < stations.lumps.size(); ++l) {
      const BarStations::Lump& lump = stations.lumps[l];
      if (lump.station == i)
        add(at.slope.size() + static_cast<Eigen::Index>(l), lump.mass, u + lump.part * step,
            u_rate + lump.part * rate);
    }
    u += step;
    u_rate += rate;
  }
}

/// The axial modes over a step: ë + d ė + Ω² e = 0 of their elastic part e = y − b; b without it,
/// linear within the step.
void ThirdOrder::stretch(double h) {
  const BarStations& stations = beam_.stations();
  const ViscousDamping& viscous = beam_.viscous();
  for (Eigen::Index k = 0; k < axial_.size(); ++k) {
    const double square = stations.axial_squares[k];
    const double damping = viscous.mass + viscous.stiffness * square;
    const auto [answer, rate] = ModeKernel(std::sqrt(square), damping).at(h);
    const double slope = (after_.drawn[k] - before_.drawn[k]) / h;
    const double off = axial_[k] - before_.drawn[k], off_rate = axial_rate_[k] - slope;
    axial_[k] = after_.drawn[k] + off * (rate + damping * answer) + off_rate * answer;
    axial_rate_[k] = slope + off_rate * rate - square * off * answer;
    elastic_rate_[k] = after_.drawn_rate[k] - axial_rate_[k];
  }
}

/// Of the stations, what the mean pull over the step and the bending do to their slopes; tells what
/// they do to the frame.
double ThirdOrder::find_pull(double h, double frame) {
  const BarStations& stations = beam_.stations();
  // of the elastic part, by its momentum too
  if (elastic_rate_.size() > 0) {
    const Eigen::Index count = slope_.size();
    pull_.noalias() = stations.axial.topRows(count) * elastic_rate_;
    after_.momentum.array() -= stations.mass.array() * pull_.array();
    for (std::size_t l = 0; l < stations.lumps.size(); ++l) {
      const BarStations::Lump& lump = stations.lumps[l];
      const auto row = stations.axial.row(count + static_cast<Eigen::Index>(l));
      after_.momentum[lump.station] -= lump.mass * row.dot(elastic_rate_);
    }
  }
  BarStations::add_up_from_tip(after_.momentum);
  ThirdOrderPull pull{.stations = static_cast<int>(slope_.size()),
                      .length = stations.length.data(),
                      .weight = stations.weight.data(),
                      .strain = strain_.data(),
                      .bending = stations.bending.data(),
                      .slope_before = before_.slope.data(),
                      .slope_after = after_.slope.data(),
                      .momentum_before = before_.momentum.data(),
                      .momentum_after = after_.momentum.data(),
                      .h = h,
                      .floats = beam_.frame().size() > 0,
                      .frame = frame,
                      .slope = slope_.data(),
                      .pull = pull_.data()};
  find_third_order_pull(pull);
  return pull.of_frame;
}

/// What is left out does to the modes between the last state and this one.
void ThirdOrder::find_force(const ModalState& state, double h) {
  middle_ = 0.5 * (last_.a + state.a);
  stretch(h);
  const bool floats = beam_.frame().size() > 0;
  const double of_frame = find_pull(h, floats ? beam_.frame().dot(middle_) : 0.0);
  const Eigen::MatrixXd& slopes = beam_.stations().slopes;
  find_force_of_pull({.stations = static_cast<int>(slopes.rows()),
                      .modes = static_cast<int>(slopes.cols()),
                      .slopes = slopes.data(),
                      .pull = pull_.data(),
                      .force = force_.data()});
  if (floats) force_ += of_frame * beam_.frame();
  rate_ = (state.a - last_.a) / h;
  if (stretches_) beam_.add_stretching_force(middle_, rate_, force_);
  if (friction_ > 0.0) rub(state);
  if (!beam_.damped()) return;
  beam_.coupled_drag(rate_, drag_);
  force_ -= drag_;
}

/// A hinge that turns back within the step does so where its rates at the ends have it.
void ThirdOrder::rub(const ModalState& state) {
  const Eigen::VectorXd& hinge = beam_.hinge();
  const double before = hinge.dot(last_.rate), after = hinge.dot(state.rate);
  const double most = std::abs(before) + std::abs(after);
  if (most > 0.0) force_ -= friction_ * (before + after) / most * hinge;
}

void ThirdOrder::follow(const ModalState& state, const BarStations::Slopes& slopes,
                        const ModalStep& step, double part, double contact_force,
                        const BarMotion::ContactSlope& contact) {
  energy_ = std::max(energy_, energy_of(state));
  stretches_ = stretches_ || beam_.most_stretching(energy_) > negligible_;
  shortening_ = std::max(shortening_, look(slopes, after_) / energy_);
  find_force(state, part * step.h());
  move(step, part);
  answer(step, part, contact_force, contact);
  std::swap(missing_, end_);
  most_displacement_ = std::max(most_displacement_, std::abs(displacement()));
  std::swap(before_, after_);
  last_ = state;
}

/// Under that force the modes vibrate about where it would hold them, free of the contact.
void ThirdOrder::move(const ModalStep& step, double part) {
  const double h = part * step.h();
  for (Eigen::Index k = 0; k < force_.size(); ++k) {
    const double omega = beam_.omega()[k];
    held_[k] = omega * h > hardly_held ? force_[k] / (omega * omega) : 0.0;
  }
  missing_.a -= held_;
  if (part < 1.0)
    advance(beam_, h, NodeVector::Zero(1), missing_, end_);
  else
    step.coast(missing_, end_);
  missing_.a += held_;
  end_.a += held_;
  for (Eigen::Index k = 0; k < force_.size(); ++k) {
    if (beam_.omega()[k] * h > hardly_held) continue;
    end_.a[k] += 0.5 * force_[k] * h * h;
    end_.rate[k] += force_[k] * h;
  }
}

/// Of the contact, by its mean slopes.
void ThirdOrder::answer(const ModalStep& step, double part, double contact_force,
                        const BarMotion::ContactSlope& contact) {
  const double h = part * step.h();
  const double stiffness = 0.5 * (contact_.to_depth + contact.to_depth);
  const double damping = 0.5 * (contact_.to_rate + contact.to_rate);
  contact_ = contact;
  if (part < 1.0) advance(beam_, h, NodeVector::Ones(1), rest_, answer_);
  using Modes = Eigen::Map<const Eigen::VectorXd>;
  const bool whole = part >= 1.0;
  const Modes a = whole ? step.a_of_unit_force() : Modes(answer_.a.data(), answer_.a.size());
  const Modes rate = whole ? step.rate_of_unit_force() : Modes(answer_.rate.data(), a.size());
  const Eigen::VectorXd& row = beam_.struck();
  const double way = 0.5 * row.dot(missing_.a + end_.a),
               speed = 0.5 * row.dot(missing_.rate + end_.rate);
  const double gives = -0.5 * (stiffness * row.dot(a) + damping * row.dot(rate));
  const double force = (stiffness * way + damping * speed) / (1.0 + std::max(gives, 0.0));
  end_.a += force * a;
  end_.rate += force * rate;
  impulse_ += contact_force * h;
  missing_impulse_ += force * h;
  if (contact_force < largest_) return;
  largest_ = contact_force;
  if (largest_ > 0.0) of_peak_ = force / largest_;
}

}  // namespace impactrig::models
