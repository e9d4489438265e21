// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "models/implicit/reissner_chain.hpp"

namespace impactrig::models {

/// What SlopeHold is to an AncfChain: holds the section at the hinge of a ReissnerChain at an angle
/// θ, closing > 0, that is given for each stage of a step, Θ₀ = −θ.
template <int S>
class SectionHold {
 public:
  using Lanes = Eigen::Array<double, S, 1>;

  explicit SectionHold(const ReissnerChain& chain)
      : masses_(chain.masses()),
        inertia_(chain.inertia()[section]) {
    free(masses_[0]);
    masses_[0](section, section) = inertia_;
  }

  static double angle_of(const Eigen::ArrayXd& q) { return -q[section]; }

  void stop(double) {
    rate_.setZero();
    acceleration_.setZero();
  }

  void turn(const Lanes&, const Lanes& rate, const Lanes& acceleration) {
    rate_ = rate;
    acceleration_ = acceleration;
  }

  static void place(double angle, double rate, Eigen::ArrayXd& q, Eigen::ArrayXd& v) {
    q[section] = -angle;
    v[section] = -rate;
  }

  void release(double, ReissnerChain::Tangent& tangent) { free(tangent[0]); }

  template <int K>
  void factor(const ReissnerChain::Tangent& tangent, SystemShares<K> share,
              ReissnerChain::Systems<K>& systems) const {
    share.first_node = {};
    systems.factor(masses_, tangent, section, share);
  }

  void constrain(const StageArray<S>&, const StageArray<S>&, const StageArray<S>& a,
                 StageArray<S>& r) const {
    r.col(section) = inertia_ * (a.col(section) + acceleration_);
  }

  const Lanes& rate() const { return rate_; }

  Lanes moment(const StageArray<S>&, const StageArray<S>& r) const { return -r.col(section); }

 private:
  static constexpr int section = ReissnerElement::turn0;

  static void free(ReissnerElement::Matrix& matrix) {
    matrix.row(section).setZero();
    matrix.col(section).setZero();
  }

  std::vector<ReissnerElement::Matrix> masses_;
  double inertia_;
  Lanes rate_ = Lanes::Zero(), acceleration_ = Lanes::Zero();
};

}  // namespace impactrig::models
