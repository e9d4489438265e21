// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "datasets/impact.hpp"
#include "fitting/bootstrap.hpp"
#include "fitting/diagnostics/channel_diagnostics.hpp"
#include "fitting/direct_restitution.hpp"
#include "fitting/fit_options.hpp"
#include "fitting/identifiability.hpp"
#include "fitting/profile.hpp"
#include "fitting/rig_file.hpp"
#include "models/simulation.hpp"

namespace impactrig::fitting {

/// One fitted parameter, by its key in the rig file ("contact.restitution"); with several
/// recordings those of one recording end in its number from 1 ("start.velocity[2]").
struct Parameter {
  std::string name;
  std::string unit;  ///< SI, "1" when dimensionless
  double value = 0.0;
  double std_error =
      0.0;  ///< NaN, as ci95, mesh_shift and mesh_error, where it is not identifiable
  std::array<double, 2> ci95 = {0, 0};
  double initial = 0.0;
  double lower = 0.0, upper = 0.0;  ///< bounds
  bool at_bound = false;
  /// It ended far from what is stated of it, further than right calibrations let it.
  bool contradicts_prior = false;
  /// Whether the data determine it, not only combinations of it with others.
  bool identifiable = true;
  bool by_logarithm = false;  ///< searched, and its interval made, by its logarithm
  /// What a mesh twice as fine would add to the value, to first order, as far as the residuals have
  /// room for what it changes besides.
  double mesh_shift = 0.0;
  /// What the mesh's error is estimated at from that, 1.1 to 3 times as much, >= 0; ci95 is widened
  /// by it.
  double mesh_error = 0.0;
  bool nuisance = false;  ///< of the measuring chain or the timing, not of the physics
  /// Mean and standard uncertainty, from a calibration or the user.
  std::optional<std::array<double, 2>> prior;
  std::string tied_to;  ///< the parameter it goes with; empty where it is free itself
};

/// A fitted channel with everything a plot of it needs.
struct ChannelFit {
  std::string quantity;       ///< "force"
  std::string channel;        ///< name in the recording
  std::string unit;           ///< SI
  int recording = 0;          ///< index into Fit::impacts
  double residual_rms = 0.0;  ///< over the fitted samples
  /// Standard deviation before the trigger, at least what the digitiser's step makes; 0: not known.
  double noise = 0.0;
  std::vector<double> time;        ///< from fitted first touch [s] (n)
  std::vector<double> measured;    ///< (n)
  std::vector<double> model;       ///< as the sensor would show it (n)
  std::vector<std::uint8_t> used;  ///< 1 where the sample entered the fit (n)
  std::size_t every = 1;  ///< one sample in so many could: a filter of the record ties the others
  std::map<std::string, double> metrics;  ///< names: metrics.hpp
  /// Where the model fails; none of a fit stored before there were any.
  std::optional<ChannelDiagnostics> diagnostics = {};
};

struct Estimate {
  double value = 0.0;
  std::array<double, 2> ci95 = {0, 0};
};

struct Goodness {
  double chi2 = 0.0;
  long dof = 0;
  double aicc = 0.0;
  double bic = 0.0;
  int unknowns = 0;  ///< independent numbers that were determined
};

/// The answer: what explains the recordings, how sure that is, and where the model fails.
struct Fit {
  std::vector<Parameter> parameters;
  /// (n_parameters, n_parameters); NaN beside a parameter that is not identifiable.
  Eigen::MatrixXd correlations;
  /// A sentence each: which combination the data cannot tell.
  std::vector<std::string> not_identifiable;
  Identifiability identifiability;
  std::vector<ChannelFit> channels;
  Goodness goodness;
  Loss loss = Loss::squares;
  std::vector<Profile> profiles;                ///< where the options ask for them
  std::optional<Bootstrap> bootstrap;           ///< likewise
  std::map<std::string, Estimate> restitution;  ///< law, kinematic, kinetic, energetic
  std::vector<datasets::Impact> impacts;        ///< as measured, one a recording
  /// Read from the records without a model of the impact, one a recording.
  std::vector<DirectRestitution> direct;
  /// At the fitted values, with history, one a recording.
  std::vector<models::Simulation> predictions;
  RigFile rig;              ///< at the fitted values
  double window = 0.0;      ///< fitted after first touch, at most [s]
  std::string termination;  ///< "converged" or a sentence
  int iterations = 0;
  long simulations = 0;
  double seconds = 0.0;          ///< by the clock, without the next, profiles and bootstrap
  double judging_seconds = 0.0;  ///< of metrics, diagnostics and direct estimates
  std::vector<std::string> warnings;
};

/// Fits the free parameters to impacts, each compared through its sensors' chains, weighted by the
/// noise seen before the trigger and whitened by its colour. Unless the options say otherwise,
/// parameters of the physics are shared by all impacts; approach speed, first touch, offsets, gains
/// and delays are each recording's own. Throws
/// std::invalid_argument on an unknown parameter or when there is nothing to fit to.
Fit fit(const std::vector<datasets::Impact>& impacts, const RigFile& rig,
        const FitOptions& options);

/// As the rig file's [fit] states it.
Fit fit(const std::vector<datasets::Impact>& impacts, const RigFile& rig);

}  // namespace impactrig::fitting
