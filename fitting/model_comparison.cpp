// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/model_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "fitting/all_cores.hpp"
#include "fitting/fit.hpp"
#include "fitting/parameters.hpp"
#include "fitting/wishes.hpp"
#include "models/mesh_error.hpp"

namespace impactrig::fitting {
namespace {

constexpr double much_better = 10.0;  // Δ from which the worse one has next to no support
constexpr double no_better = 2.0;     // and below which there is no telling

std::string base_of(const std::string& name) {
  return name.substr(0, name.find('['));
}

/// What is asked for, with the damping parameter that this model has in the place of another's.
FitOptions options_for(const RigFile& rig, FitOptions options) {
  const std::string_view own = damping_parameter(rig.rig.contact, options);
  const auto idle = [&](const std::string& name) {
    const std::string key = base_of(name);
    return key != own && std::ranges::find(damping_parameters, key) != damping_parameters.end();
  };
  std::erase_if(options.settings, [&](const ParameterSetting& s) { return idle(s.name); });
  if (std::erase_if(options.free, idle) == 0) return options;
  if (!own.empty() && std::ranges::find(options.free, own) == options.free.end())
    options.free.emplace_back(own);
  if (options.free.empty()) options.free = {"impact.time"};  // which is free always
  return options;
}

/// But for where a laser points.
bool same_chain(const std::optional<datasets::Sensor>& a,
                const std::optional<datasets::Sensor>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  const auto same_cut = [](const auto& one, const auto& other) {
    if (!one || !other) return one.has_value() == other.has_value();
    return one->frequency == other->frequency && one->order == other->order;
  };
  const bool same_resonance = a->resonance && b->resonance
                                  ? a->resonance->frequency == b->resonance->frequency &&
                                        a->resonance->quality == b->resonance->quality
                                  : a->resonance.has_value() == b->resonance.has_value();
  return same_resonance && same_cut(a->low_cut, b->low_cut) && same_cut(a->high_cut, b->high_cut);
}

bool same_spot(const RigFile& a, const RigFile& b, std::optional<datasets::Sensor> RigFile::*of) {
  const auto place = [of](const RigFile& rig) {
    const std::optional<datasets::Sensor>& sensor = rig.*of;
    return sensor && sensor->position > 0.0 ? sensor->position : rig.rig.contact.position;
  };
  return place(a) == place(b);
}

/// A rig with what is fitted where another one has it: a start makes no model.
models::Rig begun_as(const RigFile& other, const RigFile& rig, const FitOptions& options) {
  models::Rig from = other.rig, result = rig.rig;
  const FitOptions own = options_for(rig, options);
  const Wishes wishes(rig, own);
  for (const std::string& name : wishes.names()) {
    const PhysicalParameter* const parameter = find_physical_parameter(name);
    const ParameterSetting* const setting = options.setting_of(name);
    if (parameter && !(setting && setting->fixed)) parameter->of(result) = parameter->of(from);
  }
  return result;
}

/// Whether two rigs predict the same of the same parameters: by all that a fit reads of them.
bool same_model(const RigFile& a, const RigFile& b, const FitOptions& options) {
  return a.rig == begun_as(a, b, options) && a.solver == b.solver &&
         a.mains_frequency == b.mains_frequency && same_chain(a.force, b.force) &&
         same_chain(a.velocity, b.velocity) && same_chain(a.displacement, b.displacement) &&
         same_spot(a, b, &RigFile::velocity) && same_spot(a, b, &RigFile::displacement);
}

/// Each model once: under the first one's label, with those of its doubles in parentheses.
std::vector<Candidate> distinct(const std::vector<Candidate>& candidates,
                                const FitOptions& options) {
  std::vector<Candidate> models;
  std::vector<std::string> doubles;
  for (const Candidate& candidate : candidates) {
    const auto same = std::ranges::find_if(models, [&](const Candidate& model) {
      return candidate.failure.empty() && model.failure.empty() &&
             same_model(candidate.rig, model.rig, options);
    });
    if (same == models.end()) {
      models.push_back(candidate);
      doubles.emplace_back();
      continue;
    }
    std::string& names = doubles[static_cast<std::size_t>(same - models.begin())];
    names += (names.empty() ? "" : "; ") + candidate.label;
  }
  for (std::size_t i = 0; i < models.size(); ++i)
    if (!doubles[i].empty()) models[i].label += fmt::format(" ({})", doubles[i]);
  return models;
}

/// The shot by the physics of the others.
HeldOut held_out(const std::vector<datasets::Impact>& impacts, std::size_t left_out,
                 const RigFile& rig, const FitOptions& options) {
  std::vector<datasets::Impact> others = impacts;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(left_out));
  const Fit known = fit(others, rig, options);
  FitOptions own = options;
  for (const Parameter& p : known.parameters) {
    const PhysicalParameter* physics = find_physical_parameter(base_of(p.name));
    if (physics && !physics->of_shot) own.setting(base_of(p.name)).fixed = true;
  }
  const Fit foretold = fit({impacts[left_out]}, known.rig, own);
  return {foretold.goodness.chi2, foretold.goodness.dof};
}

/// `elements`: of the mesh that the fit took.
ModelScore score(const std::vector<datasets::Impact>& impacts, const Candidate& candidate,
                 const FitOptions& asked, std::array<int, 2>& elements) {
  ModelScore result{.label = candidate.label,
                    .note = candidate.note,
                    .failure = {},
                    .sentence = {},
                    .held_out = {}};
  if (!candidate.failure.empty()) {
    result.failure = candidate.failure;
    return result;
  }
  try {
    FitOptions options = options_for(candidate.rig, asked);
    const Fit found = fit(impacts, candidate.rig, options);
    elements = found.rig.solver.elements;
    result.chi2 = found.goodness.chi2;
    result.dof = found.goodness.dof;
    result.unknowns = found.goodness.unknowns;
    result.aicc = found.goodness.aicc;
    result.bic = found.goodness.bic;
    result.sound = true;
    double least = 2.0;
    for (const ChannelFit& channel : found.channels) {
      if (!channel.diagnostics) continue;
      result.sound = result.sound && channel.diagnostics->sound;
      if (channel.diagnostics->p_value >= least) continue;
      least = channel.diagnostics->p_value;
      result.sentence = channel.diagnostics->sentence;
    }
    if (impacts.size() < 2) return result;
    options.for_report = false;
    HeldOut sum;
    for (std::size_t i = 0; i < impacts.size(); ++i) {
      const HeldOut one = held_out(impacts, i, candidate.rig, options);
      sum.chi2 += one.chi2;
      sum.dof += one.dof;
    }
    result.held_out = sum;
  } catch (const std::exception& error) {
    result.failure = error.what();
  }
  return result;
}

double reduced(const ModelScore& s) {
  return s.chi2 / static_cast<double>(std::max(1L, s.dof));
}

/// "a", "a and b", "a; b and c": labels may have commas.
std::string listed(const std::vector<std::string>& labels) {
  std::string text;
  for (std::size_t i = 0; i < labels.size(); ++i)
    text += (i == 0 ? "" : i + 1 == labels.size() ? " and " : "; ") + labels[i];
  return text;
}

/// How the best of the candidates stands among those that could be fitted.
std::string ranking(const std::vector<ModelScore>& scores) {
  const ModelScore& best = scores.front();
  std::vector<std::string> as_good, possible;
  std::size_t failed = 0;
  for (std::size_t i = 1; i < scores.size(); ++i) {
    if (!scores[i].failure.empty())
      ++failed;
    else if (scores[i].delta < no_better)
      as_good.push_back(scores[i].label);
    else if (scores[i].delta < much_better)
      possible.push_back(fmt::format("{} (weight {:.2g})", scores[i].label, scores[i].weight));
  }
  if (scores.size() == 1)
    return fmt::format("There is no other model to compare {} with.", best.label);
  if (failed + 1 == scores.size())
    return fmt::format("{} could not be compared: {}.", best.label,
                       failed == 1 ? "the other candidate could not be fitted"
                                   : "none of the other candidates could be fitted");
  std::string text;
  if (!as_good.empty())
    text = fmt::format(
        "{} explains the data best, but {} {} as well within what the data can tell apart.",
        best.label, listed(as_good), as_good.size() == 1 ? "does" : "do");
  else if (!possible.empty())
    text = fmt::format("{} explains the data best; {} {} not ruled out.", best.label,
                       listed(possible), possible.size() == 1 ? "is" : "are");
  else
    text = fmt::format("{} explains the data best; no other candidate has noteworthy support.",
                       best.label);
  if (failed > 0)
    text += fmt::format(" {} could not be fitted, of which this says nothing.",
                        failed == 1 ? "One candidate" : fmt::format("{} candidates", failed));
  return text;
}

std::string verdict(const ModelComparison& comparison) {
  const std::vector<ModelScore>& scores = comparison.scores;
  const ModelScore& best = scores.front();
  if (!best.failure.empty())
    return "None of the candidates could be fitted, so that none could be compared.";
  std::string text = ranking(scores);
  const auto fitted = [](const ModelScore& s) { return s.failure.empty(); };
  if (!best.sound && std::ranges::count_if(scores, fitted) == 1)
    text += fmt::format(
        " It does not explain the data: its chi-square is {:.3g} a degree of freedom. {}",
        reduced(best), best.sentence);
  else if (!best.sound)
    text += fmt::format(
        " Even so it is wrong: its chi-square is {:.3g} a degree of freedom and the weights only "
        "rank these candidates. {}",
        reduced(best), best.sentence);
  return text;
}

/// Fits all models; where the mesh is open, on one mesh: the finest that one of them asked for.
/// What a coarser one lacks would be counted against the others.
std::vector<ModelScore> scores_on_one_mesh(const std::vector<datasets::Impact>& impacts,
                                           const std::vector<Candidate>& models,
                                           const FitOptions& options) {
  std::vector<ModelScore> scores(models.size());
  std::vector<std::array<int, 2>> meshes(models.size(), {0, 0});
  run_on_all_cores(models.size(), [&](std::size_t i, std::size_t) {
    scores[i] = score(impacts, models[i], options, meshes[i]);
  });
  const auto size = [](const std::array<int, 2>& mesh) { return mesh[0] + mesh[1]; };
  int finest = 0;
  for (std::size_t i = 0; i < models.size(); ++i)
    if (models[i].rig.mesh_chosen) finest = std::max(finest, size(meshes[i]));
  run_on_all_cores(models.size(), [&](std::size_t i, std::size_t) {
    if (!models[i].rig.mesh_chosen || !scores[i].failure.empty()) return;
    Candidate finer = models[i];
    finer.rig.solver.elements = models::split_elements(finest, finer.rig.rig);
    if (finer.rig.solver.elements == meshes[i]) return;
    finer.rig.mesh_chosen = false;
    scores[i] = score(impacts, finer, options, meshes[i]);
  });
  return scores;
}

}  // namespace

ModelComparison compare_models(const std::vector<datasets::Impact>& impacts,
                               const std::vector<Candidate>& candidates,
                               const FitOptions& options) {
  if (candidates.empty()) throw std::invalid_argument("there are no models to compare");
  const std::vector<Candidate> models = distinct(candidates, options);
  FitOptions same = options;
  if (!(same.window > 0.0)) same.window = std::numeric_limits<double>::infinity();
  ModelComparison result;
  result.scores = scores_on_one_mesh(impacts, models, same);
  double least = std::numeric_limits<double>::infinity();
  for (const ModelScore& s : result.scores)
    if (s.failure.empty()) least = std::min(least, reduced(s));
  result.inflation = std::isfinite(least) ? std::max(1.0, least) : 1.0;
  const auto criterion = [&](const ModelScore& s) {
    return s.failure.empty() ? s.aicc - s.chi2 + s.chi2 / result.inflation
                             : std::numeric_limits<double>::infinity();
  };
  std::ranges::stable_sort(result.scores, {}, criterion);
  const double best = criterion(result.scores.front());
  double sum = 0.0;
  for (ModelScore& s : result.scores) {
    if (!s.failure.empty()) continue;
    s.delta = criterion(s) - best;
    s.weight = std::exp(-0.5 * s.delta);
    sum += s.weight;
  }
  for (ModelScore& s : result.scores) s.weight = sum > 0.0 ? s.weight / sum : 0.0;
  result.sentence = verdict(result);
  return result;
}

Alternatives read_alternatives(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    throw std::invalid_argument(fmt::format("expected KEY=VALUE,VALUE, found \"{}\"", text));
  Alternatives result{.key = text.substr(0, equals), .values = {}};
  int depth = 0;  // a comma within brackets belongs to its value
  std::string value;
  for (const char c : text.substr(equals + 1)) {
    depth += (c == '[' || c == '{') ? 1 : (c == ']' || c == '}') ? -1 : 0;
    if (c == ',' && depth == 0) {
      result.values.push_back(value);
      value.clear();
    } else {
      value += c;
    }
  }
  result.values.push_back(value);
  if (std::ranges::find(result.values, "") != result.values.end())
    throw std::invalid_argument(fmt::format("a value is empty in \"{}\"", text));
  return result;
}

std::vector<std::pair<std::string, std::vector<Override>>> combinations(
    const std::vector<Alternatives>& alternatives) {
  std::vector<std::pair<std::string, std::vector<Override>>> result = {{"", {}}};
  for (const Alternatives& one : alternatives) {
    std::vector<std::pair<std::string, std::vector<Override>>> wider;
    for (const auto& [label, overrides] : result)
      for (const std::string& value : one.values) {
        auto next = overrides;
        next.emplace_back(one.key, value);
        wider.emplace_back(
            fmt::format("{}{}{} = {}", label, label.empty() ? "" : ", ", one.key, value), next);
      }
    result = std::move(wider);
  }
  return result;
}

}  // namespace impactrig::fitting
