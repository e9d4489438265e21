// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/bootstrap.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <random>
#include <stdexcept>

#include "fitting/all_cores.hpp"

namespace impactrig::fitting {
namespace {

constexpr double near_enough = 0.01;  // standard errors, of all unknowns together
constexpr int most_chords = 8;
constexpr double block_times = 4.0;  // correlation times that belong together

/// The best fit's prediction and what is left of the data, at all samples.
struct Remainder {
  std::vector<double> model, residual;
};

std::vector<std::vector<Remainder>> remainders(const FitProblem& problem) {
  std::vector<std::vector<Remainder>> result;
  for (const Shot& shot : problem.shots()) {
    auto& of_shot = result.emplace_back();
    for (const FittedChannel& channel : shot.channels) {
      Remainder r{.model = shot.cost->model_values(channel), .residual = channel.measured};
      for (std::size_t k = 0; k < r.model.size(); ++k) r.residual[k] -= r.model[k];
      of_shot.push_back(std::move(r));
    }
  }
  return result;
}

/// One worker's problem, refitted again and again.
class Refit {
 public:
  Refit(const FitProblem& problem, const Eigen::MatrixXd& jacobian, double inflation,
        const std::vector<std::vector<Remainder>>& remainders)
      : problem_(problem.copy()),
        best_(problem.values()),
        jacobian_(jacobian),
        decomposition_(jacobian.colwise().norm().cwiseMax(1e-300).cwiseInverse()),
        inflation_(inflation),
        remainders_(remainders) {
    scaled_ = jacobian * decomposition_.asDiagonal();
    qr_.compute(scaled_);
  }

  /// Values of all variables; empty where the refit failed.
  std::vector<double> run(BootstrapKind kind, std::mt19937_64 random) {
    draw(kind, random);
    problem_.set_values(best_);
    try {
      if (problem_.loss() == Loss::squares && follow_chords()) return problem_.values();
      problem_.set_values(best_);
      if (!problem_.search(last_search).converged) return {};
    } catch (const std::exception&) {
      return {};  // a simulation that fails on drawn data: told by its count
    }
    return problem_.values();
  }

 private:
  void draw(BootstrapKind kind, std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    for (std::size_t s = 0; s < problem_.shots().size(); ++s)
      for (std::size_t c = 0; c < problem_.shots()[s].channels.size(); ++c) {
        FittedChannel& channel = problem_.shots()[s].channels[c];
        const Remainder& from = remainders_[s][c];
        std::vector<double> noise(from.model.size());
        if (kind == BootstrapKind::parametric) {
          std::vector<double> drawn((noise.size() + channel.every - 1) / channel.every);
          for (double& value : drawn) value = inflation_ * normal(random);
          channel.noise.colour(drawn);
          for (std::size_t i = 0; i < drawn.size(); ++i) noise[i * channel.every] = drawn[i];
        } else {
          const auto block = static_cast<std::size_t>(std::ceil(
                                 block_times * std::max(1.0, channel.noise.correlation_time()))) *
                             channel.every;
          double sign = 1.0;
          for (std::size_t k = 0; k < noise.size(); ++k) {
            if (k % block == 0) sign = random() & 1U ? 1.0 : -1.0;
            noise[k] = sign * from.residual[k];
          }
        }
        for (std::size_t k = 0; k < noise.size(); ++k)
          channel.measured[k] = from.model[k] + noise[k];
      }
    for (const std::size_t i : problem_.priors())
      problem_.set_prior_mean(i, best_[i] + (*problem_.variables()[i].prior)[1] * normal(random));
  }

  /// Gauss-Newton with the best fit's Jacobian; false where it does not converge within bounds.
  bool follow_chords() {
    Eigen::VectorXd residuals;
    for (int k = 0; k < most_chords; ++k) {
      problem_.linearise(residuals, nullptr);
      const Eigen::VectorXd step = -decomposition_.cwiseProduct(qr_.solve(residuals));
      std::vector<double> values = problem_.values();
      for (std::size_t u = 0; u < problem_.unknowns().size(); ++u) {
        const Variable& v = problem_.variables()[problem_.unknowns()[u]];
        double& value = values[problem_.unknowns()[u]];
        value += step[static_cast<Eigen::Index>(u)];
        if (!(value > v.lower && value < v.upper)) return false;
      }
      problem_.set_values(values);
      if ((jacobian_ * step).norm() < near_enough) return true;
    }
    return false;
  }

  FitProblem problem_;
  std::vector<double> best_;
  const Eigen::MatrixXd& jacobian_;
  Eigen::VectorXd decomposition_;  // scales of the unknowns
  Eigen::MatrixXd scaled_;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr_;
  double inflation_;
  const std::vector<std::vector<Remainder>>& remainders_;
};

// Share of the draws at a bound from which on no interval is made by mirroring them: what piles up
// there would become an end at the best fit itself.
constexpr double few_at_bounds = 0.025;

/// At place (n + 1) p, as if the draws parted where a further one falls into equal probabilities.
/// Source: [HyndmanFan1996], definition 6.
double quantile_of(const std::vector<double>& sorted, double p) {
  const double n = static_cast<double>(sorted.size());
  const double place = std::clamp(p * (n + 1.0) - 1.0, 0.0, n - 1.0);
  const auto below = static_cast<std::size_t>(place);
  const auto above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (place - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

/// Draws that ended at a bound of this variable.
std::size_t count_at_bounds(const Variable& v, const std::vector<double>& draws) {
  const double near = 1e-6 * v.scale;
  return static_cast<std::size_t>(std::ranges::count_if(
      draws, [&](double value) { return value - v.lower <= near || v.upper - value <= near; }));
}

Bootstrap::Parameter summary(const Variable& v, std::vector<double> draws, bool mirrored) {
  Bootstrap::Parameter result{.name = v.name, .draws = draws};
  if (draws.size() < 2) return result;
  const double n = static_cast<double>(draws.size());
  double mean = 0.0, squares = 0.0;
  for (const double value : draws) mean += value / n;
  for (const double value : draws) squares += (value - mean) * (value - mean);
  result.bias = mean - v.value;
  result.std_error = std::sqrt(squares / (n - 1.0));
  if (static_cast<int>(draws.size()) < Bootstrap::fewest_for_interval) return result;
  std::ranges::sort(draws);
  const double low = quantile_of(draws, 0.025), high = quantile_of(draws, 0.975);
  result.ci95 = {low, high};
  if (!mirrored) return result;
  result.ci95 = {2.0 * v.value - high, 2.0 * v.value - low};
  if (v.by_logarithm) result.ci95 = {v.value * v.value / high, v.value * v.value / low};
  result.ci95 = {std::max(result.ci95[0], v.lower), std::min(result.ci95[1], v.upper)};
  return result;
}

}  // namespace

std::string_view name(BootstrapKind kind) {
  return kind == BootstrapKind::parametric ? "parametric" : "residual";
}

BootstrapKind bootstrap_named(std::string_view name) {
  if (name == "parametric") return BootstrapKind::parametric;
  if (name == "residual") return BootstrapKind::residual;
  throw std::invalid_argument(
      fmt::format("there is no bootstrap '{}'; there are parametric and residual", name));
}

Bootstrap bootstrap(const FitProblem& problem, const Eigen::MatrixXd& jacobian, double inflation,
                    const BootstrapOptions& options) {
  const auto started = std::chrono::steady_clock::now();
  const auto count = static_cast<std::size_t>(options.draws);
  const std::vector<std::vector<Remainder>> rest = remainders(problem);
  std::vector<std::unique_ptr<Refit>> refits;
  for (std::size_t k = 0; k < workers_for(count); ++k)
    refits.push_back(std::make_unique<Refit>(problem, jacobian, inflation, rest));
  std::vector<std::vector<double>> ends(count);
  run_on_all_cores(count, [&](std::size_t i, std::size_t worker) {
    std::seed_seq seed{options.seed, options.seed >> 32U, static_cast<std::uint64_t>(i)};
    ends[i] = refits[worker]->run(options.kind, std::mt19937_64(seed));
  });
  Bootstrap result{.kind = options.kind, .seed = options.seed, .draws = options.draws};
  result.failed = static_cast<int>(
      std::ranges::count_if(ends, [](const std::vector<double>& end) { return end.empty(); }));
  std::vector<std::pair<const Variable*, std::vector<double>>> drawn;
  for (std::size_t i = 0; i < problem.variables().size(); ++i) {
    const Variable& v = problem.variables()[i];
    if (!v.of_interest()) continue;
    std::vector<double> draws;
    for (const std::vector<double>& end : ends)
      if (!end.empty()) draws.push_back(end[i]);
    const std::size_t at_bounds = v.tie ? 0 : count_at_bounds(v, draws);
    if (static_cast<double>(at_bounds) > few_at_bounds * static_cast<double>(draws.size()))
      result.at_bounds.push_back(v.name);
    drawn.emplace_back(&v, std::move(draws));
  }
  for (auto& [v, draws] : drawn)
    result.parameters.push_back(summary(*v, std::move(draws), result.at_bounds.empty()));
  result.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return result;
}

}  // namespace impactrig::fitting
