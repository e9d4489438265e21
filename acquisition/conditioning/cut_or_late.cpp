// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/cut_or_late.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace impactrig::acquisition {

using datasets::Impact;
using datasets::ImpactSignal;

namespace {

/// What the force of a contact has done up to any time.
class Impulse {
 public:
  explicit Impulse(const Impact& impact)
      : start_(impact.force->start),
        interval_(impact.force->interval) {
    const ImpactSignal& force = *impact.force;
    double so_far = 0.0, integral = 0.0;
    for (std::size_t i = 0; i < force.values.size(); ++i) {
      const double t = force.time(i);
      if (t >= impact.start && t <= impact.end) so_far += force.values[i];
      integral += so_far;
      impulse_.push_back(so_far);
      integral_.push_back(integral);
    }
    scale(impulse_, so_far);
    scale(integral_, so_far * (impact.end - impact.start) / interval_);
  }

  double at(double t) const { return interpolated(impulse_, t); }

  double integral_at(double t) const { return interpolated(integral_, t); }

 private:
  static void scale(std::vector<double>& values, double whole) {
    for (double& value : values) value /= whole;
  }

  /// Samples stand for half of an interval to either side.
  double interpolated(const std::vector<double>& values, double t) const {
    const double place = (t - start_) / interval_ - 0.5;
    if (place <= 0.0) return values.front();
    const auto i = static_cast<std::size_t>(place);
    if (i + 1 >= values.size()) return values.back();
    return values[i] + (place - static_cast<double>(i)) * (values[i + 1] - values[i]);
  }

  double start_, interval_;
  std::vector<double> impulse_, integral_;
};

/// The velocity beside the level, as far as the contact may reach with any of the delays.
struct Beside {
  std::vector<double> times, values;

  Beside(const ImpactSignal& velocity, double from, double to) {
    for (std::size_t i = 0; i < velocity.values.size(); ++i) {
      const double t = velocity.time(i);
      if (t < from || t > to || (!velocity.valid.empty() && velocity.valid[i] == 0)) continue;
      times.push_back(t);
      values.push_back(velocity.values[i]);
    }
  }

  /// Mean square of what the force leaves of it where it is shown so much later.
  double misfit(const Impulse& impulse, double delay) const {
    const auto n = static_cast<Eigen::Index>(times.size());
    Eigen::MatrixXd basis(n, 3);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double t = times[static_cast<std::size_t>(i)] - delay;
      basis.row(i) << 1.0, impulse.at(t), impulse.integral_at(t);
    }
    const Eigen::Map<const Eigen::VectorXd> v(values.data(), n);
    return (v - basis * basis.colPivHouseholderQr().solve(v)).squaredNorm() /
           static_cast<double>(n);
  }
};

}  // namespace

double impulse_until(const Impact& impact, double time) {
  return Impulse(impact).at(time);
}

bool is_cut_not_late(const Impact& impact, const LevelEnd& level) {
  constexpr int delays = 32;
  constexpr double unsure = 0.1;  // of the contact: how far its ends may be off
  constexpr double times_better = 2.0;
  constexpr std::size_t fewest = 12;  // samples
  const double more = unsure * (impact.end - impact.start);
  const double most = level.begins ? level.edge - impact.start + more : 0.0;
  const double least = level.begins ? 0.0 : level.edge - impact.end - more;
  const Beside beside(*impact.velocity, level.begins ? level.edge : impact.start + least,
                      level.begins ? impact.end + most : level.edge);
  if (beside.times.size() < fewest) return false;
  const Impulse impulse(impact);
  double cut = INFINITY, late = INFINITY;
  for (int k = 0; k <= delays; ++k) {
    const double delay = least + (most - least) * k / delays;
    const double done = impulse.at(level.edge - delay);
    double& best = done > level.little && done < 1.0 - level.little ? cut : late;
    best = std::min(best, beside.misfit(impulse, delay));
  }
  return late > times_better * cut;
}

}  // namespace impactrig::acquisition
