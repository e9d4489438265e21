// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/identifiability.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "datasets/number_text.hpp"
#include "models/contact/elastic_law.hpp"

namespace impactrig::fitting {
namespace {

constexpr double told_exponent = 0.1;
constexpr double hardly_known = 0.1;   // relative error of a combination worth a remedy
constexpr double far_worse = 30.0;     // and this much worse than the best known one
constexpr double no_influence = 1e-9;  // of the largest singular value: rounding
constexpr double log_step = 1e-4;      // of a parameter, for differences of the closed contact law

/// The unknowns of the physics and their values.
std::vector<std::size_t> physics_of(const FitProblem& problem) {
  std::vector<std::size_t> columns;
  for (std::size_t k = 0; k < problem.unknowns().size(); ++k) {
    const Variable& v = problem.variables()[problem.unknowns()[k]];
    if (v.physics && v.value > 0.0) columns.push_back(k);
  }
  return columns;
}

/// Columns of the physics by the logarithms of their parameters, less their projection on all other
/// columns.
Eigen::MatrixXd by_logarithms(const FitProblem& problem, const Eigen::MatrixXd& jacobian,
                              const std::vector<std::size_t>& physics) {
  Eigen::MatrixXd own(jacobian.rows(), static_cast<Eigen::Index>(physics.size()));
  Eigen::MatrixXd others(jacobian.rows(), jacobian.cols() - own.cols());
  Eigen::Index next = 0, other = 0;
  for (Eigen::Index k = 0; k < jacobian.cols(); ++k) {
    const bool is_physics =
        std::ranges::find(physics, static_cast<std::size_t>(k)) != physics.end();
    const double value = problem.value(problem.unknowns()[static_cast<std::size_t>(k)]);
    if (is_physics)
      own.col(next++) = value * jacobian.col(k);
    else if (const double norm = jacobian.col(k).norm(); norm > 0.0)
      others.col(other++) = jacobian.col(k) / norm;
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(others.leftCols(other));
  const Eigen::MatrixXd basis =
      qr.householderQ() * Eigen::MatrixXd::Identity(jacobian.rows(), qr.rank());
  return own - basis * (basis.transpose() * own);
}

/// dF/dδ of the elastic law where it gives this force.
double stiffness_at(const models::Rig& rig, double force) {
  const models::ElasticLaw law = models::elastic_law(rig.contact);
  double low = 0.0, high = 1e-9;
  while (elastic_force(law, high) < force && high < 1.0) high *= 2.0;
  for (int i = 0; i < 80; ++i) {
    const double middle = 0.5 * (low + high);
    (elastic_force(law, middle) < force ? low : high) = middle;
  }
  const double step = 1e-4 * high;
  return (elastic_force(law, high + step) - elastic_force(law, high - step)) / (2.0 * step);
}

ContactStiffness contact_stiffness(const FitProblem& problem,
                                   const std::vector<std::size_t>& physics,
                                   const Eigen::MatrixXd& directions, const Eigen::VectorXd& errors,
                                   double force) {
  const models::Rig rig = problem.shots().front().cost->rig();
  ContactStiffness result{.force = force, .stiffness = stiffness_at(rig, force)};
  Eigen::VectorXd gradient(static_cast<Eigen::Index>(physics.size()));
  for (std::size_t k = 0; k < physics.size(); ++k) {
    const Variable& v = problem.variables()[problem.unknowns()[physics[k]]];
    models::Rig above = rig, below = rig;
    if (v.recording <= 0) {
      v.physics->of(above) = v.value * (1.0 + log_step);
      v.physics->of(below) = v.value * (1.0 - log_step);
    }
    gradient[static_cast<Eigen::Index>(k)] =
        (std::log(stiffness_at(above, force)) - std::log(stiffness_at(below, force))) /
        (2.0 * log_step);
  }
  double variance = 0.0;
  for (Eigen::Index i = 0; i < errors.size(); ++i) {
    const double share = gradient.dot(directions.col(i));
    if (std::abs(share) > 1e-6) variance += share * share * errors[i] * errors[i];
  }
  result.relative_error = std::sqrt(variance);
  return result;
}

std::string text_of(const Combination& c) {
  std::string text;
  for (const auto& [name, exponent] : c.exponents)
    text += fmt::format("{}{}^{:.2g}", text.empty() ? "" : " · ", name, exponent);
  return text;
}

std::string error_text(double relative) {
  return relative < 1.0 ? "to " + datasets::percent(relative) : "not at all";
}

/// Names of the worst known combination and three ways out of it.
std::string remedy_for(const FitProblem& problem, const Identifiability& found) {
  const Combination& worst = found.combinations.front();
  const Combination& best = found.combinations.back();
  if (worst.exponents.size() < 2 || !(worst.relative_error > hardly_known) ||
      worst.relative_error < far_worse * best.relative_error)
    return "";
  std::string names;
  bool of_contact = false, linear = false, factor = false;
  for (const auto& [name, exponent] : worst.exponents) {
    names += fmt::format("{}{}", names.empty() ? "" : ", ", name);
    of_contact = of_contact || (name.starts_with("contact.") && name != "contact.restitution");
    factor = factor || name == "contact.stiffness_factor";
    for (const Variable& v : problem.variables())
      linear = linear || (v.name == name && !v.by_logarithm);
  }
  std::string text = fmt::format(
      "The data know {} {}, though {} {}. Fix one of {} (--fix), give one a prior "
      "(--prior NAME=VALUE+-UNCERTAINTY)",
      text_of(worst), error_text(worst.relative_error), text_of(best),
      error_text(best.relative_error), names);
  if (linear)
    text +=
        ", search them by their logarithms (--log NAMES), in which a product is a straight line";
  if (of_contact && found.contact.force > 0.0)
    text += fmt::format(
        ", or free {}: what one impact tells of the contact is its stiffness at the peak, {:.4g} "
        "N/m "
        "at {:.4g} N, known {}",
        factor ? "contact.stiffness_factor alone of them"
               : "contact.stiffness_factor in their place",
        found.contact.stiffness, found.contact.force, error_text(found.contact.relative_error));
  return text + ".";
}

}  // namespace

Identifiability identifiability(const FitProblem& problem, const Eigen::MatrixXd& jacobian,
                                double inflation, double peak_force) {
  Identifiability result;
  const std::vector<std::size_t> physics = physics_of(problem);
  if (physics.empty()) return result;
  const Eigen::MatrixXd columns = by_logarithms(problem, jacobian, physics);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(columns.transpose() * columns, Eigen::ComputeFullV);
  Eigen::VectorXd errors(svd.singularValues().size());
  for (Eigen::Index i = 0; i < errors.size(); ++i) {
    const double squared = svd.singularValues()[i];
    errors[i] = squared > no_influence * no_influence * svd.singularValues()[0]
                    ? inflation / std::sqrt(squared)
                    : std::numeric_limits<double>::infinity();
  }
  for (Eigen::Index i = errors.size(); i-- > 0;) {
    Combination c{.exponents = {}, .relative_error = errors[i]};
    const Eigen::VectorXd direction = svd.matrixV().col(i);
    Eigen::Index largest = 0;
    direction.cwiseAbs().maxCoeff(&largest);
    const double sign = direction[largest] < 0.0 ? -1.0 : 1.0;
    for (std::size_t k = 0; k < physics.size(); ++k) {
      const double exponent = sign * direction[static_cast<Eigen::Index>(k)];
      if (std::abs(exponent) >= told_exponent)
        c.exponents.emplace_back(problem.variables()[problem.unknowns()[physics[k]]].name,
                                 exponent);
    }
    std::ranges::stable_sort(c.exponents, std::greater{},
                             [](const auto& e) { return std::abs(e.second); });
    result.combinations.push_back(std::move(c));
  }
  if (peak_force > 0.0)
    result.contact = contact_stiffness(problem, physics, svd.matrixV(), errors, peak_force);
  result.remedy = remedy_for(problem, result);
  return result;
}

}  // namespace impactrig::fitting
