// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "datasets/impact.hpp"
#include "fitting/contact_phases.hpp"
#include "fitting/rig_file.hpp"
#include "fitting/undo_chain.hpp"

namespace impactrig::fitting {

/// By how much a record is changed before it is read, to learn what an error of that size does.
struct Trial {
  double later = 0.0;                                 ///< of the motion against the force [s]
  double force_gain = 1.0;                            ///< [-]
  double motion_gain = 1.0;                           ///< [-]
  double force_offset = 0.0;                          ///< [N]
  double speed_offset = 0.0;                          ///< [m/s]
  double touch = 0.0;                                 ///< of the instant of first touch [s]
  double separation = 0.0;                            ///< of the instant of separation [s]
  const std::vector<double>* force_noise = nullptr;   ///< added, at force_samples() [N]
  const std::vector<double>* motion_noise = nullptr;  ///< added, at motion_samples()
  /// The speed by means over 4 % of the contact: an instant that moves then meets no other noise.
  bool smooth_speed = false;
  ChainUndo chain = ChainUndo::resolved;
};

/// One impact's force and motion about its first contact, ready to be read again and again.
class DirectReading {
 public:
  /// The impact must have a force, and a velocity or displacement.
  DirectReading(const datasets::Impact& impact, const RigFile& rig);

  /// Force and speed on the force's clock, freed of their sensors' chains.
  ContactRecord record(const Trial& trial) const;
  ContactPhases phases(const Trial& trial) const;

  std::size_t force_samples() const { return force_.size(); }

  std::size_t motion_samples() const { return motion_.size(); }

  const datasets::ImpactSignal& force() const { return *impact_.force; }

  const datasets::ImpactSignal& motion() const;

  /// By which the force before touch may have wandered at the contact [N].
  double force_wander() const { return wander_; }

  /// Whether the sampling resolves all of the force's chain.
  bool resolved() const { return plain_force_.complete; }

  /// Whether samples between two instants of the force's or motion's own clock are lost.
  bool force_lost(double from, double to) const;
  bool motion_lost(double from, double to) const;

 private:
  struct Window {
    std::size_t first, last;
  };

  Window window_of(const datasets::ImpactSignal& signal) const;
  std::vector<double> sound_samples(const datasets::ImpactSignal& signal, Window& window) const;
  void take_baseline();
  double level_before(const std::vector<double>& force) const;
  Undone force_of(const Trial& trial) const;
  Undone speed_of(const Trial& trial) const;

  const datasets::Impact& impact_;
  datasets::Sensor force_sensor_, motion_sensor_;
  Window force_window_{}, motion_window_{};
  std::vector<double> force_, motion_;  // as recorded, gaps closed
  double quiet_end_ = 0.0;              // before it nothing touches [s]
  double wander_ = 0.0;
  Undone plain_force_, plain_speed_;  // of a trial that changes neither
  Undone smooth_speed_;
};

/// Noise of that standard deviation σ [SI] and integrated autocorrelation time τ [samples]: of
/// first order, x_k = φ x_{k-1} + √(1 − φ²) ε, φ = (τ − 1)/(τ + 1), ε = ±σ with even chances. Means
/// and sums of many samples, which is all that it is for, do not tell it from normal noise.
class NoiseSource {
 public:
  NoiseSource(double sigma, double correlation, std::uint64_t seed);
  void fill(std::vector<double>& values);

 private:
  double sigma_, memory_;
  std::mt19937_64 generator_;
};

}  // namespace impactrig::fitting
