// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/modal_load.hpp"

#include <span>

namespace impactrig::models {

ModalLoad::ModalLoad(const ModalBeam& beam)
    : acts_(!beam.load().isZero(0.0)),
      held_(beam.load().cwiseQuotient(beam.omega().cwiseAbs2())),
      pull_(beam.load()[0]),
      pendulum_(beam.omega()[0], beam.damping()[0]) {
  held_[0] = 0.0;
}

ModalLoad::Fall ModalLoad::fall(double time) const {
  if (pull_ == 0.0) return {};
  double answer = 0.0, rate = 0.0;
  pendulum_.moments(time, {&answer, 1}, {&rate, 1});
  return {pull_ * time * answer, pull_ * time * rate};
}

void ModalLoad::advance_freely(const ModalBeam& beam, double time, const ModalState& from,
                               ModalState& to) const {
  advance(beam, time, NodeVector::Zero(1), from, to);
  fall(time).add_to(to);
}

}  // namespace impactrig::models
