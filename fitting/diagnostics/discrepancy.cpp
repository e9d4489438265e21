// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/diagnostics/discrepancy.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace impactrig::fitting {
namespace {

// Small enough to need no memory of their own.
constexpr int most_states = 3 + 8;
using MatrixXd = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_states, most_states>;
using VectorXd = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most_states, 1>;

/// δ with its first two derivatives (time in units of 1 / λ) and its last p values, which the
/// whitened residuals w_t = δ_t − Σφ_k δ_{t−k} + e_t look at. Variances in units of σ_e².
struct Process {
  MatrixXd transition;   // F
  MatrixXd disturbance;  // Q
  VectorXd observed;     // c
};

Eigen::Matrix3d stationary() {
  Eigen::Matrix3d p;
  p << 1.0, 0.0, -1.0 / 3.0, 0.0, 1.0 / 3.0, 0.0, -1.0 / 3.0, 0.0, 1.0;
  return p;
}

/// `step`: λ Δt; `strength`: a² / σ_e².
Process process(double step, double strength, const NoiseColour& noise) {
  const auto order = static_cast<Eigen::Index>(noise.coefficients.size());
  const Eigen::Index size = 3 + order;
  Process out{MatrixXd::Zero(size, size), MatrixXd::Zero(size, size), VectorXd::Zero(size)};
  const double h = step;
  Eigen::Matrix3d motion;
  motion << 1.0 + h + 0.5 * h * h, h + h * h, 0.5 * h * h,  //
      -0.5 * h * h, 1.0 + h - h * h, h - 0.5 * h * h,       // each row the derivative of that above
      0.5 * h * h - h, h * h - 3.0 * h, 1.0 - 2.0 * h + 0.5 * h * h;
  motion *= std::exp(-h);
  out.transition.topLeftCorner<3, 3>() = motion;
  out.disturbance.topLeftCorner<3, 3>() =
      strength * (stationary() - motion * stationary() * motion.transpose());
  out.observed[0] = 1.0;
  for (Eigen::Index k = 0; k < order; ++k) {
    out.transition(3 + k, k == 0 ? 0 : 2 + k) = 1.0;
    out.observed[3 + k] = -noise.coefficients[static_cast<std::size_t>(k)];
  }
  return out;
}

/// What a step of the Kalman filter leaves for the smoother.
struct Step {
  VectorXd state;       // predicted
  MatrixXd covariance;  // predicted
  double innovation = 0.0, variance = 0.0;
};

/// What δ is like.
struct Character {
  double length = 0.0;    ///< l [s]
  double strength = 0.0;  ///< a² / σ_e² during the contact
  double calm = 1.0;      ///< that after it, as a part
};

class Filter {
 public:
  Filter(const Character& delta, const DiscrepancyTask& task, const NoiseColour& noise)
      : process_(process(std::sqrt(5.0) * task.interval / delta.length, delta.strength, noise)),
        calm_(delta.calm),
        left_(std::lround(task.contact / task.interval)) {
    const Eigen::Index size = process_.observed.size();
    state_ = VectorXd::Zero(size);
    covariance_ = MatrixXd::Zero(size, size);
    // at touch: stationary, but for δ, which is zero there
    const Eigen::Vector3d column = stationary().col(0);
    covariance_.topLeftCorner<3, 3>() =
        delta.strength * (stationary() - column * column.transpose());
    predict();
  }

  /// Takes the next sample in; a missing one is stepped over.
  void take(double w) {
    if (std::isfinite(w)) {
      if (!steady_) {
        gain_ = covariance_ * process_.observed;
        variance_ = 1.0 + process_.observed.dot(gain_);
        gain_ /= variance_;
      }
      innovation_ = w - process_.observed.dot(state_);
      squares_ += innovation_ * innovation_ / variance_;
      logarithms_ += std::log(variance_);
      ++count_;
      state_ += gain_ * innovation_;
      if (!steady_) covariance_ -= variance_ * gain_ * gain_.transpose();
      predict();
    } else {
      steady_ = false;
      predict();
    }
  }

  /// −2 ln L where the noise's size is the most likely one, less a constant.
  double deviance() const {
    const double n = static_cast<double>(count_);
    return n * std::log(squares_ / n) + logarithms_;
  }

  double noise_variance() const { return squares_ / static_cast<double>(count_); }

  Step seen() const { return {state_, covariance_, 0.0, 0.0}; }

  const Process& model() const { return process_; }

 private:
  void predict() {
    if (left_-- == 0) {
      process_.disturbance *= calm_;
      steady_ = steady_ && calm_ == 1.0;
    }
    state_ = process_.transition * state_;
    if (steady_) return;
    MatrixXd next =
        process_.transition * covariance_ * process_.transition.transpose() + process_.disturbance;
    // the covariance no longer depends on the data and soon not on the time
    steady_ = count_ > 8 &&
              (next - last_).cwiseAbs().maxCoeff() < 1e-9 * (1e-30 + next.cwiseAbs().maxCoeff());
    last_ = next;
    covariance_ = std::move(next);
  }

  Process process_;
  VectorXd state_, gain_;
  MatrixXd covariance_, last_ = MatrixXd::Zero(process_.observed.size(), process_.observed.size());
  double variance_ = 1.0, innovation_ = 0.0, squares_ = 0.0, logarithms_ = 0.0;
  double calm_;
  long left_;  // samples until the contact ends
  long count_ = 0;
  bool steady_ = false;
};

struct Best {
  Character delta;
  double deviance = 0.0;
};

/// Most likely character, roughly on a grid, then finer around what was found.
class Search {
 public:
  Search(std::span<const double> w, const DiscrepancyTask& task, const NoiseColour& noise)
      : w_(w),
        task_(task),
        noise_(noise) {}

  Best run(double shortest, double longest) {
    const double ratio = std::pow(std::max(1.0, longest / shortest), 1.0 / (lengths - 1.0));
    for (const double calm : calms)
      for (int i = 0; i < lengths; ++i)
        for (double strength = 1e-3; strength < 1e6; strength *= 16.0)
          attempt({shortest * std::pow(ratio, i), strength, calm});
    const Character rough = best_.delta;
    for (const double longer : {1.0 / std::sqrt(ratio), 1.0, std::sqrt(ratio)})
      for (double strength = rough.strength / 8.0; strength < 10.0 * rough.strength;
           strength *= 2.0)
        attempt({std::clamp(rough.length * longer, shortest, std::max(shortest, longest)), strength,
                 rough.calm});
    return best_;
  }

  /// Places in the grid other than strength, which the likelihood ratio has had its pick of.
  static constexpr double choices() { return lengths * static_cast<double>(std::size(calms)); }

 private:
  static constexpr int lengths = 8;
  static constexpr double calms[] = {1.0, 0.03};

  void attempt(const Character& delta) {
    Filter filter(delta, task_, noise_);
    for (const double value : w_) filter.take(value);
    if (best_.delta.length > 0.0 && !(filter.deviance() < best_.deviance)) return;
    best_ = {delta, filter.deviance()};
  }

  std::span<const double> w_;
  const DiscrepancyTask& task_;
  const NoiseColour& noise_;
  Best best_;
};

struct Smoothed {
  std::vector<double> mean, error;
};

/// δ given all samples. Backwards: r and N gather what later samples say.
Smoothed smooth(std::span<const double> w, const Character& delta, const DiscrepancyTask& task,
                const NoiseColour& noise) {
  Filter filter(delta, task, noise);
  std::vector<Step> steps;
  for (const double value : w) {
    steps.push_back(filter.seen());
    filter.take(value);
  }
  const Process model = filter.model();
  const Eigen::Index size = model.observed.size();
  VectorXd r = VectorXd::Zero(size);
  MatrixXd n = MatrixXd::Zero(size, size);
  Smoothed out{std::vector<double>(w.size()), std::vector<double>(w.size())};
  for (std::size_t i = w.size(); i-- > 0;) {
    const Step& at = steps[i];
    if (std::isfinite(w[i])) {
      const VectorXd seen = at.covariance * model.observed;
      const double variance = 1.0 + model.observed.dot(seen);
      const double innovation = w[i] - model.observed.dot(at.state);
      const MatrixXd left =
          model.transition - (model.transition * seen / variance) * model.observed.transpose();
      r = (model.observed * (innovation / variance) + left.transpose() * r).eval();
      n = (model.observed * model.observed.transpose() / variance + left.transpose() * n * left)
              .eval();
    } else {
      r = (model.transition.transpose() * r).eval();
      n = (model.transition.transpose() * n * model.transition).eval();
    }
    const VectorXd column = at.covariance.col(0);
    out.mean[i] = at.state[0] + column.dot(r);
    const double variance = at.covariance(0, 0) - column.dot(n * column);
    out.error[i] = std::sqrt(std::max(0.0, variance) * filter.noise_variance());
  }
  return out;
}

/// Samples of δ to keep: a few a length, at most 250 around the contact and as many after; of
/// those that each stands for the one furthest from zero, so that no crest is cut.
std::vector<std::size_t> kept(std::span<const double> mean, double length,
                              const DiscrepancyTask& task) {
  constexpr double points_a_length = 4.0, around = 2.5;
  constexpr std::size_t most = 250;
  const std::size_t count = mean.size();
  const auto border = std::min(
      count, static_cast<std::size_t>(std::max(1.0, around * task.contact / task.interval)));
  const auto by_length = static_cast<std::size_t>(length / (points_a_length * task.interval));
  std::vector<std::size_t> out;
  const auto keep = [&](std::size_t begin, std::size_t end) {
    const std::size_t step = std::max({std::size_t{1}, by_length, (end - begin + most - 1) / most});
    for (std::size_t i = begin; i < end; i += step) {
      const auto part = mean.subspan(i, std::min(step, end - i));
      const auto furthest =
          std::ranges::max_element(part, {}, [](double value) { return std::abs(value); });
      out.push_back(i + static_cast<std::size_t>(furthest - part.begin()));
    }
  };
  keep(0, border);
  keep(border, count);
  return out;
}

void report(const Smoothed& found, const DiscrepancyTask& task, Discrepancy& out) {
  double squares = 0.0;
  for (std::size_t i = 0; i < found.mean.size(); ++i) {
    squares += found.mean[i] * found.mean[i];
    if (std::abs(found.mean[i]) < std::abs(out.largest)) continue;
    out.largest = found.mean[i];
    out.largest_error = found.error[i];
    out.largest_time = task.interval * static_cast<double>(i + 1);
  }
  out.rms = std::sqrt(squares / static_cast<double>(found.mean.size()));
  for (const std::size_t i : kept(found.mean, out.length, task)) {
    out.time.push_back(task.interval * static_cast<double>(i + 1));
    out.mean.push_back(found.mean[i]);
    out.error.push_back(found.error[i]);
  }
}

}  // namespace

Discrepancy discrepancy(const DiscrepancyTask& task, const NoiseColour& noise) {
  constexpr double shortest_samples = 4.0;
  constexpr std::size_t fewest = 30, most = 20000;
  Discrepancy out;
  const std::vector<double> w =
      whitened(task.residual.first(std::min(task.residual.size(), most)), noise);
  const std::size_t count = present(w);
  if (count < fewest || !(energy(w) > 0.0) || !(noise.deviation > 0.0)) return out;
  const Best best = Search(w, task, noise).run(shortest_samples * task.interval, task.contact);
  const double n = static_cast<double>(count);
  const double gain = n * std::log(energy(w) / n) - best.deviance;
  const double known = static_cast<double>(noise.samples) / (2.0 * noise.correlation_time);
  const double told = n * task.interval / best.delta.length;
  const double lambda = std::max(0.0, gain * known / (known + told));
  out.p_value = std::min(1.0, Search::choices() * 0.5 * std::erfc(std::sqrt(0.5 * lambda)));
  out.significant = out.p_value < task.level;
  if (!out.significant) return out;
  out.length = best.delta.length;
  report(smooth(w, best.delta, task, noise), task, out);
  return out;
}

}  // namespace impactrig::fitting
