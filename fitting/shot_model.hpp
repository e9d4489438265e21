// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/impact.hpp"
#include "datasets/sampled_curve.hpp"
#include "fitting/parameters.hpp"
#include "fitting/rig_file.hpp"
#include "models/modal/bar_cache.hpp"
#include "models/simulation.hpp"

namespace impactrig::fitting {

/// What the recorder would see of one simulated impact: each channel through its sensor's chain, on
/// a fine uniform grid.
struct Shown {
  /// One channel; first touch at 0, delay not applied.
  using Curve = datasets::SampledCurve;

  std::optional<Curve> force, velocity, displacement;
  models::Restitution restitution;
  /// Derivatives of all that by the parameters asked for; empty where the simulation has none.
  std::vector<Shown> slopes = {};
};

/// Where a force is no smooth course through its samples.
struct ForceBreaks {
  std::vector<datasets::CurveJump> jumps = {};
  std::vector<datasets::CurveSpike> spikes = {};
  std::vector<models::SampleImpulse> impulses = {};
};

/// The sensors of a recording, each with its chain.
struct SensorChains {
  std::optional<datasets::Sensor> force, velocity, displacement;

  std::optional<datasets::Sensor>& of(datasets::Quantity quantity);
  const std::optional<datasets::Sensor>& of(datasets::Quantity quantity) const;
};

/// By what a prediction is to be differentiated, besides first touch, gains and delays.
struct WantedSlopes {
  struct Chain {
    datasets::Quantity quantity;
    const ChainParameter* parameter;
  };

  std::vector<models::RigParameter> rig;
  std::vector<Chain> chain;  ///< their slopes come after those of the rig
};

/// The part of the measurement model that needs a simulation: from the rig's parameters to what a
/// recording shows.
class ShotModel {
 public:
  /// lead, end: seconds before and after first touch that the recording needs; step: its sample
  /// interval.
  ShotModel(const RigFile& rig, const datasets::Impact& impact, double lead, double end,
            double step);

  Shown predict(const models::Rig& rig, const SensorChains& chains,
                const WantedSlopes& wanted = {}) const;
  models::Simulation simulate(const models::Rig& rig, double interval,
                              const std::vector<models::RigParameter>& by = {}) const;

  double end() const { return end_; }

  void set_end(double end) { end_ = end; }

  /// Predictions from now on are good enough to search by from afar, no more: sampled like the
  /// recording or finer, solved to a thousandth of its usual noise.
  void set_rough(bool rough) { rough_ = rough; }

  bool rough() const { return rough_; }

  models::Motion motion() const { return motion_; }

  /// Which equations predict from now on.
  void set_motion(models::Motion motion) { motion_ = motion; }

  /// Learns what the full equations show beyond small motion at these values; predictions in small
  /// motion have that added from now on. It hardly depends on the values: a part of them, in
  /// square, that is small itself. False, and nothing is added, where a channel shows the force
  /// jump.
  bool learn_full_motion(const models::Rig& rig, const SensorChains& chains);

  /// Nothing is added any more.
  void forget_full_motion() { beyond_small_.reset(); }

  /// The same by the full equations, where what they show is added.
  ShotModel as_learned() const;

  /// The same in small motion, whose slopes a fit may take where those of the full equations are
  /// not known.
  ShotModel in_small_motion() const;

  ShotModel finer() const;  ///< the same with twice the elements or modes
  /// With half of them, where there is such a mesh (models::halved).
  std::optional<ShotModel> halved(const models::Rig& rig) const;
  ShotModel coarser(const models::Rig& rig) const;  ///< the same with few (models::coarsened)

  /// Sensors as the rig file describes them.
  const SensorChains& chains() const { return chains_; }

 private:
  Shown spot_slope(const models::History& history, const SensorChains& chains,
                   datasets::Quantity quantity) const;
  models::Simulation simulate(const models::Rig& rig, const SensorChains& chains,
                              models::SimulationOptions options) const;
  Shown show(const models::History& history, const SensorChains& chains, ForceBreaks breaks) const;
  Shown chain_slope(const models::History& history, SensorChains chains,
                    const WantedSlopes::Chain& by) const;

  SensorChains chains_;
  models::Solver solver_;
  bool force_, velocity_, displacement_;
  double lead_, end_, interval_;
  bool rough_ = false, for_slopes_ = false;
  models::Motion motion_ = models::Motion::full;
  std::shared_ptr<const Shown> beyond_small_;
  std::shared_ptr<models::BarCache> bars_ = std::make_shared<models::BarCache>();
};

}  // namespace impactrig::fitting
