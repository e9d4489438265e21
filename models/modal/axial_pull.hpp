// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "models/modal/modal_beam.hpp"
#include "models/modal/modal_step.hpp"

namespace impactrig::models {

/// How far the pull along the bar, which small motion does not know, would have moved the struck
/// point: an error of small motion that need not show in the energy. A heavy tip that turns pulls
/// at the thin bar that carries it, and stiffens it, with next to nothing of its own energy.
///
/// In a frame that turns with the rigid rotation φ, v is the deflection and s = v' its slope:
///
///   u̇(x) = ∫₀ˣ s ṡ dξ,   N(x) = ∫ₓᴸ (φ̇² ξ + 2 φ̇ v̇ + φ̈ v + ü) dm,   Qⱼ = −∫ N s wⱼ' dx + φ̇² aⱼ
///
/// N [N] is the pull, u the foreshortening, Qⱼ what pull and turning frame do to a mode [N/√kg]. To
/// it comes what uneven bending stretches (ModalBeam::stretching_energy()), and what damping
/// couples modes by (ModalBeam::coupled_drag()). Q is taken as constant within a step, the contact
/// answers as a linear spring. To first order: what is missing does not change Q itself.
class AxialPull {
 public:
  explicit AxialPull(const ModalBeam& beam);

  /// The bar in this state meets its stop; its ModalBeam::find_slopes(). What uneven bending
  /// stretches is left out where it is a smaller part of the energy than `negligible`.
  void touch(const ModalState& state, const ModalBeam::StationSlopes& slopes, double negligible);

  /// A step, or the first part of one, has led to this state under this mean force.
  void follow(const ModalState& state, const ModalBeam::StationSlopes& slopes,
              const ModalStep& step, double part, double contact_force);

  /// Displacement of the struck point that is missing now [m].
  double missing() const { return beam_.struck().dot(missing_.a); }

  /// What is missing of the contact's peak force, or the most that ever was of its impulse [-].
  double of_force() const { return std::max(share_, of_peak_); }

  /// The most of the struck point's displacement that ever was missing, as a part of the deepest by
  /// then [-]: what comes and goes, and so hardly moves the impulse, counts as well.
  double of_depth() const { return of_depth_; }

 private:
  /// Of the stations in one state.
  struct Look {
    Eigen::VectorXd slope;   // s
    Eigen::VectorXd along;   // ∫ₓᴸ (φ̇ v + u̇) dm
    Eigen::VectorXd across;  // ∫ₓᴸ (φ̇ ξ + v̇) dm
    double rate = 0.0;       // φ̇
  };

  void look(const ModalState& state, const ModalBeam::StationSlopes& slopes, Look& at);
  void find_force(const ModalState& state, double h);
  void answer(const ModalStep& step, double part, double from, double contact_force);

  const ModalBeam& beam_;
  double inertia_;
  bool stretches_ = true;  // by uneven bending
  Look before_, after_;
  Eigen::VectorXd pull_, force_, held_, middle_, way_, drag_;
  ModalState last_, missing_, end_, answer_, rest_;
  double deepest_ = 0.0, stiffness_ = 0.0, largest_ = 0.0;
  double impulse_ = 0.0, missing_impulse_ = 0.0, share_ = 0.0, of_peak_ = 0.0, of_depth_ = 0.0;
};

}  // namespace impactrig::models
