// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "models/modal/modal_beam.hpp"
#include "models/modal/modal_step.hpp"
#include "models/modal/mode_kernel.hpp"

namespace impactrig::models {

/// What a steady load does to a bar in its modes: those that bend it vibrate about where the load
/// holds them, the pendulum's, which nothing may hold, follows it.
class ModalLoad {
 public:
  explicit ModalLoad(const ModalBeam& beam);

  bool acts() const { return acts_; }

  /// Where it holds the modes, 0 of the pendulum's (m).
  const Eigen::VectorXd& held() const { return held_; }

  /// Force on the pendulum's mode [N/√kg].
  double pull() const { return pull_; }

  /// The pendulum's mode.
  struct Fall {
    double a = 0.0, rate = 0.0;

    void add_to(ModalState& state) const {
      state.a[0] += a;
      state.rate[0] += rate;
    }
  };

  /// Where it takes the pendulum's mode from rest in a time [s], by Duhamel's integral.
  Fall fall(double time) const;

  /// A state after a time free of all other forces; both against held().
  void advance_freely(const ModalBeam& beam, double time, const ModalState& from,
                      ModalState& to) const;

 private:
  bool acts_;
  Eigen::VectorXd held_;
  double pull_;
  ModeKernel pendulum_;
};

}  // namespace impactrig::models
