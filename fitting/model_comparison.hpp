// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "datasets/impact.hpp"
#include "fitting/fit_options.hpp"
#include "fitting/rig_file.hpp"

namespace impactrig::fitting {

/// A model that may explain the recordings: a rig under a name of its own.
struct Candidate {
  std::string label;  ///< "contact.damping = viscous"
  RigFile rig;
  std::string failure = {};  ///< why there is no such rig; else empty
  std::string note = {};     ///< what else is changed for it; else empty
};

/// How well shots that were not fitted are foretold: each in turn by the parameters of the physics
/// that the others gave; what is its own (speed, touch, background, gains, delays) is still fitted.
struct HeldOut {
  double chi2 = 0.0;  ///< summed over the shots
  long dof = 0;
};

/// One candidate, fitted to all recordings.
struct ModelScore {
  std::string label;    ///< of candidates that are the same model those of all
  std::string note;     ///< the candidate's
  std::string failure;  ///< why it could not be fitted; else empty, and what follows is given
  double chi2 = 0.0;
  long dof = 0;
  int unknowns = 0;
  double aicc = 0.0, bic = 0.0;     ///< with the noise known, as Goodness has them
  double delta = 0.0;               ///< of quasi-AICc to the best candidate's
  double weight = 0.0;              ///< Akaike weight by that: evidence among these candidates
  bool sound = false;               ///< by the diagnostics of its channels
  std::string sentence;             ///< theirs, of the worst channel
  std::optional<HeldOut> held_out;  ///< with several recordings
};

/// Candidates, best first, with a word on what that is worth.
struct ModelComparison {
  std::vector<ModelScore> scores;
  double inflation = 1.0;  ///< ĉ: reduced chi-square of the best candidate, at least 1
  std::string sentence;
};

/// Fits every candidate to the impacts, all to the same samples, each model once however many
/// candidates are it, and weighs them by the quasi information criterion
///
///   QAICc = χ²/ĉ + 2 K + 2 K (K + 1) / (n − K − 1),   ĉ = max(1, best χ²/dof),
///
/// so that differences between models all of which are wrong do not count as if the noise were all
/// there is. Weights exp(−Δ/2) / Σ. Source: [BurnhamAnderson2002].
ModelComparison compare_models(const std::vector<datasets::Impact>& impacts,
                               const std::vector<Candidate>& candidates, const FitOptions& options);

/// Parts of "KEY=V1,V2,…": the key and its values. Throws std::invalid_argument.
struct Alternatives {
  std::string key;
  std::vector<std::string> values;
};

Alternatives read_alternatives(const std::string& text);

/// All combinations of values, as overrides of a rig file, with their labels.
std::vector<std::pair<std::string, std::vector<Override>>> combinations(
    const std::vector<Alternatives>& alternatives);

}  // namespace impactrig::fitting
