// SPDX-License-Identifier: BSD-3-Clause
#include "models/sensitivities/add_sensitivity.hpp"

#include <array>
#include <vector>

namespace impactrig::models {
namespace {

void add(double weight, const std::vector<double>& part, std::vector<double>& sum) {
  sum.resize(part.size(), 0.0);
  for (std::size_t k = 0; k < part.size(); ++k) sum[k] += weight * part[k];
}

void add(double weight, const History& part, History& sum) {
  sum.start = part.start;
  sum.interval = part.interval;
  for (const auto channel :
       {&History::force, &History::penetration, &History::velocity, &History::displacement,
        &History::velocity_slope, &History::displacement_slope, &History::sensor_force,
        &History::deflection, &History::extension})
    add(weight, part.*channel, sum.*channel);
  sum.further.resize(part.further.size());
  for (std::size_t k = 0; k < part.further.size(); ++k) {
    add(weight, part.further[k].force, sum.further[k].force);
    add(weight, part.further[k].penetration, sum.further[k].penetration);
  }
  sum.jumps.resize(part.jumps.size());
  for (std::size_t k = 0; k < part.jumps.size(); ++k)
    for (const auto number : {&ForceJump::time, &ForceJump::before, &ForceJump::after})
      sum.jumps[k].*number += weight * (part.jumps[k].*number);
  sum.impulses.resize(part.impulses.size());
  for (std::size_t k = 0; k < part.impulses.size(); ++k) {
    sum.impulses[k].time = part.impulses[k].time;
    sum.impulses[k].sample = part.impulses[k].sample;
    sum.impulses[k].impulse += weight * part.impulses[k].impulse;
  }
}

}  // namespace

void add_sensitivity(double weight, const Sensitivity& part, Sensitivity& sum) {
  for (const auto number :
       {&Sensitivity::peak_force, &Sensitivity::max_penetration, &Sensitivity::duration,
        &Sensitivity::impulse, &Sensitivity::separation_velocity, &Sensitivity::sensor_peak_force})
    sum.*number += weight * (part.*number);
  for (const auto number :
       {&Restitution::law, &Restitution::kinematic, &Restitution::kinetic, &Restitution::energetic})
    sum.restitution.*number += weight * (part.restitution.*number);
  add(weight, part.history, sum.history);
}

}  // namespace impactrig::models
