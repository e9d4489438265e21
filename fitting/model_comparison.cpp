// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/model_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "fitting/all_cores.hpp"
#include "fitting/fit.hpp"
#include "fitting/parameters.hpp"

namespace impactrig::fitting {
namespace {

constexpr double much_better = 10.0;  // Δ from which the worse one has next to no support
constexpr double no_better = 2.0;     // and below which there is no telling

std::string base_of(const std::string& name) {
  return name.substr(0, name.find('['));
}

/// Of what a model lets be fitted: a candidate without restitution has none to free.
FitOptions options_for(const RigFile& rig, FitOptions options) {
  if (!rig.rig.contact.takes_restitution())
    std::erase(options.free, std::string("contact.restitution"));
  return options;
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

ModelScore score(const std::vector<datasets::Impact>& impacts, const Candidate& candidate,
                 const FitOptions& asked) {
  ModelScore result{.label = candidate.label, .failure = {}, .sentence = {}, .held_out = {}};
  if (!candidate.failure.empty()) {
    result.failure = candidate.failure;
    return result;
  }
  try {
    FitOptions options = options_for(candidate.rig, asked);
    const Fit found = fit(impacts, candidate.rig, options);
    result.chi2 = found.goodness.chi2;
    result.dof = found.goodness.dof;
    result.unknowns = static_cast<int>(std::ranges::count_if(
        found.parameters, [](const Parameter& p) { return p.tied_to.empty(); }));
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

std::string verdict(const ModelComparison& comparison) {
  const std::vector<ModelScore>& scores = comparison.scores;
  const ModelScore& best = scores.front();
  if (!best.failure.empty()) return "None of the candidates could be fitted.";
  std::string as_good;
  for (std::size_t i = 1; i < scores.size(); ++i)
    if (scores[i].failure.empty() && scores[i].delta < no_better)
      as_good += fmt::format("{}{}", as_good.empty() ? "" : "; ", scores[i].label);
  std::string text;
  if (!as_good.empty())
    text = fmt::format("{} explains the data best, but these do as well as no difference: {}.",
                       best.label, as_good);
  else if (scores.size() < 2 || !scores[1].failure.empty() || scores[1].delta >= much_better)
    text =
        fmt::format("{} explains the data; no other candidate has noteworthy support.", best.label);
  else
    text = fmt::format("{} explains the data best; {} is not ruled out (weight {:.2g}).",
                       best.label, scores[1].label, scores[1].weight);
  if (!best.sound)
    text += fmt::format(
        " Even so it is wrong: its chi-square is {:.3g} a degree of freedom and the weights only "
        "rank these candidates. {}",
        reduced(best), best.sentence);
  return text;
}

}  // namespace

ModelComparison compare_models(const std::vector<datasets::Impact>& impacts,
                               const std::vector<Candidate>& candidates,
                               const FitOptions& options) {
  if (candidates.empty()) throw std::invalid_argument("there are no models to compare");
  ModelComparison result;
  result.scores.resize(candidates.size());
  run_on_all_cores(candidates.size(), [&](std::size_t i, std::size_t) {
    result.scores[i] = score(impacts, candidates[i], options);
  });
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
