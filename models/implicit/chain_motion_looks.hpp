// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "models/implicit/chain_motion_steps.hpp"
#include "models/implicit/radau_errors.hpp"

// How exact a step of a ChainMotion is, and what is seen within it. Included as the class is.
namespace impactrig::models {
namespace {

/// Norms of the terms of the accelerations' Legendre series, across the bar and along it. Motion
/// along the bar reaches the stop only where the bar is inclined or bent; rotations of sections do
/// not, but for what they move across.
template <int S, typename Chain, template <int> typename Hold>
double ChainMotion<S, Chain, Hold>::error() const {
  maps_.find_series(a_, series_);
  Lanes across = Lanes::Zero(), along = Lanes::Zero();
  double inclination = 0.0;  // its sine, 1 beyond a right angle
  double displaced = 0.0;    // nodes across the bar where they are, at most [m]
  BarDirection bar;
  chain_.for_each_pair([&](int k, int beside, int node) {
    if (k == node) {
      bar = Chain::direction(q_, node);
      inclination = std::max(inclination, bar.cosine > 0.0 ? std::abs(bar.sine) : 1.0);
      displaced = std::max({displaced, std::abs(q_[k]), std::abs(bar.sine * q_[beside])});
    }
    const Lanes x = series_.col(k), u = series_.col(beside);
    across += chain_.inertia()[k] * (bar.cosine * x + bar.sine * u).square();
    along += chain_.inertia()[k] * (bar.cosine * u - bar.sine * x).square();
  });
  const double left =
      end_remainder<S>(across, followed_) + inclination * end_remainder<S>(along, followed_);
  // a swing's vibration is what the damper of its first contact meets
  const bool damped = (in_contact_ || !touched_) && damping_ > 0.0;
  double weight = 1.0;
  if (touched_ && !damped && !followed_)
    weight = in_contact_ ? weight_without_damping : weight_of_flight();
  const double motion = weight * h_ * weight_of_step(h_ / contact_time_) * left / speed_scale_;
  double rate = 0.0;
  if (damped) {
    const Lanes struck = maps_.series_of(across_before(0).a).array().square();
    rate = error_of_rate<S>(struck, rounding_of_acceleration(displaced, h_), damping_,
                            contact_time_, h_);
  }
  const EnergyLoss loss{lost_in_step(), lost_, end_energy_, weight_energy_};
  return std::max({motion, rate, loss.error(0.5 * speed_scale_ * speed_scale_, accuracy_)});
}

template <int S, typename Chain, template <int> typename Hold>
void ChainMotion<S, Chain, Hold>::sample(double first, double spacing, std::span<Sample> samples) {
  const auto look = [&](const ChainPoints::Shares& spot, double part) {
    PointMotion sum;
    for (const ChainShare& share : spot) {
      const int k = share.coordinate;
      const PointMotion p =
          part > 0.0 ? maps_.motion_at(q_[k], v_[k], a_.col(k), part) : PointMotion{q_[k], v_[k]};
      sum.displacement -= share.shape * p.displacement;
      sum.velocity -= share.shape * p.velocity;
    }
    return sum;
  };
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double part = first + static_cast<double>(i) * spacing;
    samples[i] = {part > 0.0 ? struck_at(0, part, nullptr) : struck(0),
                  look(points_.velocity_spot, part).velocity,
                  look(points_.displacement_spot, part).displacement};
    samples[i].velocity_slope = look(points_.velocity_slope, part).velocity;
    samples[i].displacement_slope = look(points_.displacement_slope, part).displacement;
    if (rotation_) add_departure(part, samples[i]);
  }
}

/// Against the straight bar at the hinge's angle.
template <int S, typename Chain, template <int> typename Hold>
void ChainMotion<S, Chain, Hold>::add_departure(double part, Sample& sample) const {
  const auto sum = [&](const ChainPoints::Shares& shares) {
    double place = 0.0;
    for (const auto& [k, w] : shares)
      place +=
          w * (part > 0.0 ? maps_.motion_at(q_[k], v_[k], a_.col(k), part).displacement : q_[k]);
    return place;
  };
  const double angle = turned_at(t_ + std::max(part, 0.0) * h_);
  const double sine = std::sin(angle), cosine = std::cos(angle), half = std::sin(0.5 * angle);
  // of X and U, and where the straight bar's point is
  const auto deflection = [&](double across, double along, double straight) {
    return -cosine * across + sine * (along - straight);
  };
  const auto extension = [&](double across, double along, double straight) {
    return -sine * across - cosine * along - 2.0 * half * half * straight;
  };
  const double across = sum(points_.displacement_spot), along = sum(points_.along_spot);
  sample.deflection = deflection(across, along, points_.displacement_place);
  sample.extension = extension(across, along, points_.displacement_place);
  if (points_.along_slope.empty()) return;
  const double across_slope = sum(points_.displacement_slope),
               along_slope = sum(points_.along_slope);
  sample.deflection_slope = deflection(across_slope, along_slope, 1.0);
  sample.extension_slope = extension(across_slope, along_slope, 1.0);
}

}  // namespace
}  // namespace impactrig::models
