// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/sensor_response.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "datasets/sampled_curve.hpp"

namespace impactrig::datasets {

namespace {

enum class Pass { low, high };

/// One or two poles of the chain: 1/(1 + s/ω) or 1/(1 + 2ζ s/ω + (s/ω)²), times (s/ω)^order for a
/// high-pass.
struct Section {
  Pass pass = Pass::low;
  int order = 2;         ///< 1 or 2
  double omega = 0.0;    ///< [rad/s]
  double damping = 0.0;  ///< ζ of an order of 2
};

/// A small square matrix, row by row.
class Matrix {
 public:
  explicit Matrix(std::size_t n) : n_(n), values_(n * n, 0.0) {}

  double& operator()(std::size_t i, std::size_t j) { return values_[i * n_ + j]; }

  double operator()(std::size_t i, std::size_t j) const { return values_[i * n_ + j]; }

  std::size_t size() const { return n_; }

  /// this + factor * other
  Matrix plus(double factor, const Matrix& other) const {
    Matrix sum = *this;
    for (std::size_t k = 0; k < values_.size(); ++k) sum.values_[k] += factor * other.values_[k];
    return sum;
  }

  Matrix times(const Matrix& other) const {
    Matrix product(n_);
    for (std::size_t i = 0; i < n_; ++i)
      for (std::size_t k = 0; k < n_; ++k)
        for (std::size_t j = 0; j < n_; ++j) product(i, j) += (*this)(i, k) * other(k, j);
    return product;
  }

  Matrix scaled(double factor) const { return Matrix(n_).plus(factor, *this); }

  /// Largest sum of magnitudes in a row.
  double norm() const {
    double largest = 0.0;
    for (std::size_t i = 0; i < n_; ++i) {
      double sum = 0.0;
      for (std::size_t j = 0; j < n_; ++j) sum += std::abs((*this)(i, j));
      largest = std::max(largest, sum);
    }
    return largest;
  }

 private:
  std::size_t n_;
  std::vector<double> values_;
};

/// exp(M) − 1 and φ₁(M) = M⁻¹ (exp(M) − 1), both to full relative precision however slow a mode of
/// M is.
struct Exponential {
  Matrix minus_one;
  Matrix phi;
};

/// Taylor's series of M/2ˢ, doubled s times. Doubling exp(M) − 1 rather than exp(M) keeps the 0.01
/// Hz of a low cut apart from 1 where the same chain has a megahertz.
Exponential exponential(const Matrix& m) {
  const double norm = m.norm();
  const int doublings = norm > 0.5 ? std::ilogb(norm) + 2 : 0;
  const Matrix small = m.scaled(std::ldexp(1.0, -doublings));
  Matrix phi(m.size());
  for (std::size_t i = 0; i < m.size(); ++i) phi(i, i) = 1.0;
  Matrix term = phi;
  for (int k = 2; k <= 16; ++k) {  // 0.5¹⁶/17! is below 1e-19
    term = term.times(small).scaled(1.0 / k);
    phi = phi.plus(1.0, term);
  }
  Exponential result{small.times(phi), phi};
  for (int k = 0; k < doublings; ++k) {
    result.phi = result.phi.plus(0.5, result.minus_one.times(result.phi));
    result.minus_one =
        result.minus_one.scaled(2.0).plus(1.0, result.minus_one.times(result.minus_one));
  }
  return result;
}

/// The chain as x' = A x + B u', y = C x + D u, with states that vanish while the input rests.
///
/// Of a section with input w and low-pass output p the states are e = p − w and, at order 2, v =
/// p'/ω:
///   order 1: e' = −ω e − w';   order 2: e' = ω v − w', v' = −ω (e + 2ζ v).
/// A low-pass gives w + e, a high-pass −e or −(e + 2ζ v). So a constant input is passed without
/// rounding, and the slope w' of a section's input is a sum over the states before it, and u'.
struct Chain {
  Matrix a;
  std::vector<double> b;
  std::vector<double> c;
  double d = 1.0;
};

Chain chain_of(const std::vector<Section>& sections) {
  std::size_t n = 0;
  for (const Section& section : sections) n += static_cast<std::size_t>(section.order);
  Chain chain{Matrix(n), std::vector<double>(n), std::vector<double>(n), 1.0};
  std::vector<double> slope(n);  // of the next section's input, over the states ...
  double slope_of_input = 1.0;   // ... and over u'

  std::size_t e = 0;
  for (const Section& section : sections) {
    const double omega = section.omega;
    for (std::size_t j = 0; j < n; ++j) chain.a(e, j) = -slope[j];
    chain.b[e] = -slope_of_input;
    const std::size_t v = e + 1;
    if (section.order == 1) {
      chain.a(e, e) = -omega;
    } else {
      chain.a(e, v) = omega;
      chain.a(v, e) = -omega;
      chain.a(v, v) = -2.0 * section.damping * omega;
    }
    const double two_zeta = section.order == 1 ? 0.0 : 2.0 * section.damping;
    if (section.pass == Pass::low) {
      chain.c[e] = 1.0;
      // p' itself, so that the difference of e' and w' never has to be taken
      std::ranges::fill(slope, 0.0);
      slope_of_input = 0.0;
      if (section.order == 1) slope[e] = -omega;
      if (section.order == 2) slope[v] = omega;
    } else {
      std::ranges::fill(chain.c, 0.0);
      chain.d = 0.0;
      chain.c[e] = -1.0;
      if (section.order == 1) slope[e] = omega;
      if (section.order == 2) {
        chain.c[v] = -two_zeta;
        slope[e] = two_zeta * omega;
        slope[v] = (two_zeta * two_zeta - 1.0) * omega;
      }
    }
    e += static_cast<std::size_t>(section.order);
  }
  return chain;
}

void require(bool holds, std::string_view what, double found) {
  if (!holds) throw std::invalid_argument(fmt::format("sensor response: {}, not {}", what, found));
}

double angular(double frequency, std::string_view what) {
  require(frequency > 0.0 && std::isfinite(frequency), what, frequency);
  return 2.0 * std::numbers::pi * frequency;
}

/// Butterworth's poles, on a circle of the 3 dB frequency: pairs of ζ = sin((2k − 1) π/(2 order)),
/// and one real pole where the order is odd.
void add_butterworth(std::vector<Section>& sections, Pass pass, const BandLimit& limit,
                     std::string_view name) {
  const double omega =
      angular(limit.frequency, fmt::format("the {}'s frequency must be above 0 Hz", name));
  require(limit.order >= 1 && limit.order <= 8,
          fmt::format("the {}'s order must be from 1 to 8", name), limit.order);
  if (limit.order % 2 == 1) sections.push_back({pass, 1, omega, 0.0});
  for (int k = 1; k <= limit.order / 2; ++k)
    sections.push_back(
        {pass, 2, omega, std::sin((2.0 * k - 1.0) * std::numbers::pi / (2.0 * limit.order))});
}

std::vector<Section> sections_of(const Sensor& sensor) {
  std::vector<Section> sections;
  if (sensor.resonance) {
    const double omega =
        angular(sensor.resonance->frequency, "the resonance's frequency must be above 0 Hz");
    const double quality = sensor.resonance->quality;
    require(quality > 0.5, "the resonance's quality must be above 0.5", quality);
    sections.push_back({Pass::low, 2, omega, 0.5 / quality});
  }
  if (sensor.low_cut) add_butterworth(sections, Pass::high, *sensor.low_cut, "low cut");
  if (sensor.high_cut) add_butterworth(sections, Pass::low, *sensor.high_cut, "high cut");
  return sections;
}

/// The chain at work on an input that is linear from one place to the next.
class ChainRun {
 public:
  ChainRun(Chain chain, double interval, double first)
      : chain_(std::move(chain)),
        interval_(interval),
        whole_(step_of(1.0)),
        state_(chain_.b.size(), 0.0),
        next_(state_),
        input_(first) {}

  double output() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < state_.size(); ++i) sum += chain_.c[i] * state_[i];
    return chain_.d * input_ + sum;
  }

  /// Over a part of an interval, the input going straight to another value.
  void go(double part, double to) {
    if (part == 1.0)
      go(whole_, to);
    else
      go(step_of(part), to);
  }

  void jump(double size) {
    for (std::size_t i = 0; i < state_.size(); ++i) state_[i] += chain_.b[i] * size;
    input_ += size;
  }

  /// A spike of this area [s].
  void strike(double area) {
    const std::size_t n = state_.size();
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) state_[i] += area * chain_.a(i, j) * chain_.b[j];
  }

  double input() const { return input_; }

 private:
  struct Step {
    Matrix minus_one;
    std::vector<double> kick;  // φ₁ B: what a unit change of the input adds to the states
  };

  Step step_of(double part) const {
    const std::size_t n = chain_.b.size();
    auto [minus_one, phi] = exponential(chain_.a.scaled(part * interval_));
    Step step{std::move(minus_one), std::vector<double>(n, 0.0)};
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) step.kick[i] += phi(i, j) * chain_.b[j];
    return step;
  }

  void go(const Step& step, double to) {
    const std::size_t n = state_.size();
    const double rise = to - input_;
    for (std::size_t i = 0; i < n; ++i) {
      double change = step.kick[i] * rise;
      for (std::size_t j = 0; j < n; ++j) change += step.minus_one(i, j) * state_[j];
      next_[i] = state_[i] + change;
    }
    std::swap(state_, next_);
    input_ = to;
  }

  Chain chain_;
  double interval_;
  Step whole_;
  std::vector<double> state_, next_;
  double input_;
};

// Of an interval: what is as near to a sample is on it.
constexpr double on_sample = 1e-6;

/// Sends a curve through a chain, interval by interval.
class CurveRun {
 public:
  CurveRun(Chain chain, SampledCurve& curve)
      : curve_(curve),
        run_(std::move(chain), curve.interval, curve.values.front()),
        jump_(curve.jumps.begin()),
        spike_(curve.spikes.begin()) {}

  void complete() {
    curve_.values[0] = run_.output();
    for (std::size_t sample = 1; sample < curve_.values.size(); ++sample) go_to(sample);
    curve_.spikes.clear();
  }

 private:
  void go_to(std::size_t sample) {
    sample_ = static_cast<double>(sample);
    left_ = 1.0;
    for (; jump_ != curve_.jumps.end(); ++jump_) {
      const double rest = left_at(jump_->time);
      if (rest < -on_sample) break;
      go(rest < on_sample ? 0.0 : std::min(rest, left_), jump_->before);
      const double size = jump_->after - jump_->before;
      jump_->before = run_.output();
      if (left_ == 0.0) curve_.values[sample] = jump_->before;
      run_.jump(size);
      jump_->after = run_.output();
    }
    if (left_ == 0.0) return;
    go(0.0, curve_.values[sample]);
    curve_.values[sample] = run_.output();
  }

  /// Of the interval before the sample, what is left at a time.
  double left_at(double time) const { return sample_ - (time - curve_.start) / curve_.interval; }

  /// Until so much of the interval is left, where the input is `to`; a spike at either end comes
  /// after what is shown there.
  void go(double rest, double to) {
    const double first = run_.input(), begun = left_;
    for (; spike_ != curve_.spikes.end(); ++spike_) {
      const double there = std::min(left_at(spike_->time), left_);
      if (there <= (rest == 0.0 ? on_sample : rest)) break;
      if (there < left_)
        run_.go(left_ - there, first + (to - first) * (begun - there) / (begun - rest));
      run_.strike(spike_->area);
      left_ = there;
    }
    if (left_ > rest) run_.go(left_ - rest, to);
    left_ = rest;
  }

  SampledCurve& curve_;
  ChainRun run_;
  std::vector<CurveJump>::iterator jump_;
  std::vector<CurveSpike>::const_iterator spike_;
  double sample_ = 0.0, left_ = 0.0;
};

}  // namespace

SampledCurve sensor_response(const Sensor& sensor, SampledCurve curve) {
  require(curve.interval > 0.0 && std::isfinite(curve.interval), "the interval must be above 0 s",
          curve.interval);
  const std::vector<Section> sections = sections_of(sensor);
  if (sections.empty() || curve.values.empty()) return curve;

  CurveRun(chain_of(sections), curve).complete();
  return curve;
}

std::vector<double> sensor_response(const Sensor& sensor, std::span<const double> input,
                                    double interval) {
  return sensor_response(sensor,
                         SampledCurve{.interval = interval, .values = {input.begin(), input.end()}})
      .values;
}

}  // namespace impactrig::datasets
