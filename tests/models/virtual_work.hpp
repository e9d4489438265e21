// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <random>

#include "models/beams/beam_dynamics.hpp"

namespace impactrig::tests {

using Vector = Eigen::VectorXd;

/// u' M(q) w, from the kinetic energy.
inline double mass_product(const models::BeamDynamics& beam, const Vector& q, const Vector& u,
                           const Vector& w) {
  return 0.5 * (beam.energy(q, u + w).kinetic - beam.energy(q, u - w).kinetic);
}

/// Power along w of the forces that one bar has and the other, of the same mass, has not.
inline double power_of_difference(models::BeamDynamics& with, models::BeamDynamics& without,
                                  const Vector& q, const Vector& v, const Vector& w) {
  Vector a(q.size()), b(q.size());
  with.acceleration(q, v, 0.0, a);
  without.acceleration(q, v, 0.0, b);
  return mass_product(with, q, a - b, w);
}

struct RandomState {
  Vector q, v, w;  ///< w: another velocity
};

/// A bar turned by an angle and deformed by coordinates up to `size`.
inline RandomState random_state(const models::BeamDynamics& beam, unsigned seed, double angle,
                                double size) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const int n = beam.size();
  RandomState state{Vector(n), Vector(n), Vector(n)};
  beam.set_rigid_motion(angle, 3.0, state.q, state.v);
  for (int i = 0; i < n; ++i) {
    state.q[i] += size * unit(random);
    state.v[i] += unit(random);
    state.w[i] = unit(random);
  }
  return state;
}

}  // namespace impactrig::tests
