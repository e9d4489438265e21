// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/nist_problems.hpp"

#include <ceres/dynamic_autodiff_cost_function.h>
#include <ceres/jet.h>
#include <ceres/problem.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>

#include "fitting/covariance.hpp"
#include "fitting/solver_options.hpp"
#include "tests/support/places.hpp"

namespace impactrig::tests {
namespace {

constexpr int most_parameters = 9;  // of ENSO

// Models of b (T: a Jet or a number) and x (R: its plain number, double or long double).

/// (b[0] + b[1] x + ... ) / (1 + b[top] x + ...)
template <typename T, typename R>
T rational(const T* b, R x, int top, int bottom) {
  T numerator(R(0)), denominator(R(0));
  for (int i = top - 1; i >= 0; --i) numerator = numerator * x + b[i];
  for (int i = top + bottom - 1; i >= top; --i) denominator = (denominator + b[i]) * x;
  return numerator / (denominator + R(1));
}

template <typename T, typename R>
T gauss(const T* b, R x) {
  using std::exp;
  const T first = (x - b[3]) / b[4], second = (x - b[6]) / b[7];
  return b[0] * exp(-b[1] * x) + b[2] * exp(-first * first) + b[5] * exp(-second * second);
}

template <typename T, typename R>
T enso(const T* b, R x) {
  using std::cos;
  using std::sin;
  const R turn = 2 * std::numbers::pi_v<R> * x, year = turn / 12;
  return b[0] + b[1] * std::cos(year) + b[2] * std::sin(year) + b[4] * cos(turn / b[3]) +
         b[5] * sin(turn / b[3]) + b[7] * cos(turn / b[6]) + b[8] * sin(turn / b[6]);
}

template <typename T, typename R>
T growth_or_decay(const std::string& name, const T* b, R x) {
  using std::exp;
  using std::log;
  using std::sqrt;
  const R one(1), two(2);
  if (name == "BoxBOD" || name == "Misra1a") return b[0] * (one - exp(-b[1] * x));
  if (name == "Misra1b") {
    const T u = one + b[1] * x / two;
    return b[0] * (one - one / (u * u));
  }
  if (name == "Misra1c") return b[0] * (one - one / sqrt(one + two * b[1] * x));
  if (name == "Misra1d") return b[0] * b[1] * x / (one + b[1] * x);
  if (name.starts_with("Chwirut")) return exp(-b[0] * x) / (b[1] + b[2] * x);
  if (name.starts_with("Lanczos"))
    return b[0] * exp(-b[1] * x) + b[2] * exp(-b[3] * x) + b[4] * exp(-b[5] * x);
  if (name == "MGH17") return b[0] + b[1] * exp(-b[3] * x) + b[2] * exp(-b[4] * x);
  if (name == "Rat42") return b[0] / (one + exp(b[1] - b[2] * x));
  if (name == "Rat43") return b[0] * exp(-log(one + exp(b[1] - b[2] * x)) / b[3]);
  if (name == "MGH10") return b[0] * exp(b[1] / (x + b[2]));
  throw std::invalid_argument("no model for " + name);
}

template <typename T, typename R>
T model_of(const std::string& name, const T* b, R x, R second) {
  using std::atan2;
  using std::exp;
  using std::log;
  if (name == "Bennett5") return b[0] * exp(-log(b[1] + x) / b[2]);
  if (name == "DanWood") return b[0] * exp(b[1] * std::log(x));
  if (name == "ENSO") return enso(b, x);
  if (name == "Eckerle4") {
    const T z = (x - b[2]) / b[1];
    return b[0] / b[1] * exp(-z * z / R(2));
  }
  if (name.starts_with("Gauss")) return gauss(b, x);
  if (name == "Hahn1" || name == "Thurber") return rational(b, x, 4, 3);
  if (name == "Kirby2") return rational(b, x, 3, 2);
  if (name == "MGH09") return b[0] * (x * x + x * b[1]) / (x * x + x * b[2] + b[3]);
  if (name == "Nelson") return b[0] - b[1] * x * exp(-b[2] * second);
  // atan2: the arctangent of the quotient would jump where x passes b₄.
  if (name == "Roszman1") return b[0] - b[1] * x - atan2(b[2], x - b[3]) / std::numbers::pi_v<R>;
  return growth_or_decay(name, b, x);
}

/// What the model is compared with: Nelson's problem fits the logarithm.
double observed(const NistProblem& problem, const std::vector<double>& row) {
  return problem.name == "Nelson" ? std::log(row[0]) : row[0];
}

struct Residuals {
  const NistProblem& problem;
  std::vector<double> scale;

  template <typename T>
  bool operator()(T const* const* scaled, T* out) const {
    using std::isfinite;
    std::vector<T> b(scale.size());
    for (std::size_t i = 0; i < b.size(); ++i) b[i] = scaled[0][i] * scale[i];
    for (const std::vector<double>& row : problem.data) {
      *out = model_of(problem.name, b.data(), row[1], row.back()) - observed(problem, row);
      if (!isfinite(*out++)) return false;  // a step too far: Ceres tries a shorter one
    }
    return true;
  }
};

using Wide = ceres::Jet<long double, most_parameters>;
using WideVector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;
using WideMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

void evaluate(const NistProblem& problem, const WideVector& b, WideVector& residuals,
              WideMatrix& jacobian) {
  std::vector<Wide> jets;
  for (Eigen::Index i = 0; i < b.size(); ++i) jets.emplace_back(b[i], static_cast<int>(i));
  for (std::size_t k = 0; k < problem.data.size(); ++k) {
    const std::vector<double>& data = problem.data[k];
    const Wide value = model_of(problem.name, jets.data(), static_cast<long double>(data[1]),
                                static_cast<long double>(data.back()));
    const auto first = static_cast<long double>(data[0]);
    const long double y = problem.name == "Nelson" ? std::log(first) : first;
    const auto row = static_cast<Eigen::Index>(k);
    residuals[row] = y - value.a;
    jacobian.row(row) = value.v.head(b.size()).transpose();
  }
}

}  // namespace

std::vector<NistProblem> nist_problems() {
  std::ifstream file(source_dir + "/tests/support/nist.json");
  const auto json = nlohmann::json::parse(file);
  std::vector<NistProblem> problems;
  for (const auto& entry : json["problems"]) {
    NistProblem problem;
    problem.name = entry["name"];
    problem.model = entry["model"];
    for (const char* start : {"start1", "start2"})
      problem.starts.push_back(entry[start].get<std::vector<double>>());
    if (entry.contains("certified")) entry["certified"].get_to(problem.certified);
    if (entry.contains("sd")) entry["sd"].get_to(problem.standard_deviations);
    entry["data"].get_to(problem.data);
    problems.push_back(std::move(problem));
  }
  return problems;
}

std::vector<ceres::Solver::Options> nist_options(NistOptions which) {
  std::vector<ceres::Solver::Options> passes = {fitting::solver_options(fitting::first_search),
                                                fitting::solver_options(fitting::last_search)};
  if (which == NistOptions::fit) return passes;
  for (ceres::Solver::Options& options : passes) options.max_num_iterations = 5000;
  passes.back().function_tolerance = 1e-16;
  passes.back().parameter_tolerance = 1e-14;
  passes.back().gradient_tolerance = 1e-30;
  if (which == NistOptions::tight) return passes;
  passes.back().initial_trust_region_radius = passes.front().initial_trust_region_radius;
  return {passes.back()};
}

std::vector<ceres::Solver::Options> options_that_solve(const NistProblem& problem,
                                                       std::size_t start) {
  const bool plain = start == 0 && (problem.name == "MGH10" || problem.name == "BoxBOD");
  auto passes = nist_options(plain ? NistOptions::single : NistOptions::tight);
  // From (1, 1) a full step takes BoxBOD's rate to where the exponential is gone, for ever.
  if (plain && problem.name == "BoxBOD") passes.front().initial_trust_region_radius = 10.0;
  return passes;
}

NistSolution solve_nist(const NistProblem& problem, std::size_t start,
                        const std::vector<ceres::Solver::Options>& passes) {
  const std::vector<double>& from = problem.starts[start];
  std::vector<double> x(from.size(), 1.0);
  auto* cost = new ceres::DynamicAutoDiffCostFunction<Residuals, most_parameters>(
      new Residuals{problem, from});
  cost->AddParameterBlock(static_cast<int>(x.size()));
  cost->SetNumResiduals(static_cast<int>(problem.data.size()));
  ceres::Problem ceres_problem;
  ceres_problem.AddResidualBlock(cost, nullptr, x.data());
  NistSolution solution;
  for (ceres::Solver::Options options : passes) {
    options.max_num_consecutive_invalid_steps = 50;  // powers overflow far from the start
    ceres::Solver::Summary summary;
    ceres::Solve(options, &ceres_problem, &summary);
    solution.iterations += static_cast<int>(summary.iterations.size()) - 1;
    solution.converged = summary.termination_type == ceres::CONVERGENCE;
    solution.sum_of_squares = 2.0 * summary.final_cost;
  }
  const auto n = static_cast<Eigen::Index>(problem.data.size());
  const auto p = static_cast<Eigen::Index>(x.size());
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> jacobian(n, p);
  Eigen::VectorXd residuals(n);
  const double* block = x.data();
  double* columns = jacobian.data();
  cost->Evaluate(&block, residuals.data(), &columns);
  const fitting::Uncertainty spread = fitting::uncertainty(
      jacobian, std::vector<std::string>(x.size(), "b"), std::vector<bool>(x.size(), false));
  const double variance = residuals.squaredNorm() / static_cast<double>(n - p);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    solution.parameters.push_back(x[i] * from[i]);
    solution.standard_deviations.push_back(std::sqrt(variance * spread.covariance(k, k)) *
                                           std::abs(from[i]));
  }
  return solution;
}

NistSolution polish_nist(const NistProblem& problem, const std::vector<double>& from) {
  const auto n = static_cast<Eigen::Index>(problem.data.size());
  const auto p = static_cast<Eigen::Index>(from.size());
  WideVector b(p), residuals(n);
  WideMatrix jacobian(n, p);
  for (Eigen::Index i = 0; i < p; ++i) b[i] = from[static_cast<std::size_t>(i)];
  NistSolution solution;
  while (solution.iterations < 500 && !solution.converged) {
    ++solution.iterations;
    evaluate(problem, b, residuals, jacobian);
    const WideVector scale = b.cwiseAbs();
    const WideVector step = (jacobian * scale.asDiagonal()).colPivHouseholderQr().solve(residuals);
    b += scale.cwiseProduct(step);
    solution.converged = step.cwiseAbs().maxCoeff() < 1e-15L;
  }
  evaluate(problem, b, residuals, jacobian);
  const WideVector scale = b.cwiseAbs();
  const WideMatrix scaled = jacobian * scale.asDiagonal();
  const WideMatrix covariance =
      (scaled.transpose() * scaled).ldlt().solve(WideMatrix::Identity(p, p));
  const long double variance = residuals.squaredNorm() / static_cast<long double>(n - p);
  solution.sum_of_squares = static_cast<double>(residuals.squaredNorm());
  for (Eigen::Index i = 0; i < p; ++i) {
    solution.parameters.push_back(static_cast<double>(b[i]));
    solution.standard_deviations.push_back(
        static_cast<double>(std::sqrt(variance * covariance(i, i)) * scale[i]));
  }
  return solution;
}

double off_by_deviations(const std::vector<double>& found, const NistSolution& best) {
  double worst = 0.0;
  for (std::size_t i = 0; i < found.size(); ++i)
    worst = std::max(worst, std::abs(found[i] - best.parameters[i]) / best.standard_deviations[i]);
  return worst;
}

double agreeing_digits(const std::vector<double>& found, const std::vector<double>& expected) {
  if (found.size() != expected.size()) return 0.0;
  double worst = 1e-11;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double error = std::abs(found[i] - expected[i]) / std::abs(expected[i]);
    if (!std::isfinite(error)) return 0.0;
    worst = std::max(worst, error);
  }
  return std::max(0.0, -std::log10(worst));
}

}  // namespace impactrig::tests
