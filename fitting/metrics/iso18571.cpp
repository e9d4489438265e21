// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/metrics/iso18571.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "fitting/metrics/corridor.hpp"

namespace impactrig::fitting {
namespace {

using Segment = std::span<const double>;

/// A score that falls from 1 at no error to 0 at `worst`.
double falling(double error, double worst) {
  return std::max(0.0, (worst - error) / worst);
}

/// A sum of errors in parts of the reference's; nothing is an error of nothing alone.
double relative(double error, double size) {
  if (size > 0.0) return error / size;
  return error > 0.0 ? std::numeric_limits<double>::infinity() : 0.0;
}

/// For each sample the end of the run of equal values that it begins.
std::vector<std::size_t> ends_of_runs(Segment x) {
  std::vector<std::size_t> ends(x.size());
  for (std::size_t i = x.size(); i-- > 0;)
    ends[i] = i + 1 < x.size() && x[i] == x[i + 1] ? ends[i + 1] : i + 1;
  return ends;
}

/// Pearson's correlation of the pair at any shift.
class ShiftedCorrelation {
 public:
  explicit ShiftedCorrelation(const HistoryPair& pair)
      : pair_(pair),
        m_runs_(ends_of_runs(pair.measured)),
        c_runs_(ends_of_runs(pair.computed)) {}

  /// `shift` > 0: computed history late, moved to the left.
  double operator()(std::ptrdiff_t shift) const {
    const auto [m, c] = overlap(pair_, shift);
    const auto m_first = static_cast<std::size_t>(m.data() - pair_.measured.data());
    const auto c_first = static_cast<std::size_t>(c.data() - pair_.computed.data());
    if (m_runs_[m_first] >= m_first + m.size() || c_runs_[c_first] >= c_first + c.size())
      return of_constant(m, c);
    using Array = Eigen::Map<const Eigen::ArrayXd>;
    const auto size = static_cast<Eigen::Index>(m.size());
    const Array a(m.data(), size), b(c.data(), size);
    const double a_mean = a.mean(), b_mean = b.mean();
    const double ab = ((a - a_mean) * (b - b_mean)).sum();
    const double squares = (a - a_mean).square().sum() * (b - b_mean).square().sum();
    return squares > 0.0 ? ab / std::sqrt(squares) : of_constant(m, c);
  }

  struct Overlap {
    Segment measured, computed;
  };

  static Overlap overlap(const HistoryPair& pair, std::ptrdiff_t shift) {
    const auto away = static_cast<std::size_t>(std::abs(shift));
    const std::size_t length = pair.measured.size() - away;
    return {pair.measured.subspan(shift > 0 ? 0 : away, length),
            pair.computed.subspan(shift > 0 ? away : 0, length)};
  }

 private:
  static double of_constant(Segment m, Segment c) { return std::ranges::equal(m, c) ? 1.0 : 0.0; }

  HistoryPair pair_;
  std::vector<std::size_t> m_runs_, c_runs_;
};

void find_shift(const HistoryPair& pair, Iso18571& result) {
  constexpr double improvement = 1e-12;
  const ShiftedCorrelation correlation(pair);
  result.shift = 0;
  result.correlation = correlation(0);
  const auto farthest = static_cast<std::ptrdiff_t>(pair.measured.size() / 5);
  for (std::ptrdiff_t n = 1; n <= farthest; ++n)
    for (const std::ptrdiff_t shift : {n, -n}) {
      const double found = correlation(shift);
      if (!(found > result.correlation + improvement)) continue;
      result.correlation = found;
      result.shift = shift;
    }
}

/// Cells (i, s − i) of one antidiagonal of the warping, by i: the cost of the best path to each and
/// what was summed up along it. Place 0 is i = −1.
struct Antidiagonal {
  explicit Antidiagonal(std::size_t size)
      : cost(size + 2, std::numeric_limits<double>::infinity()),
        difference(size + 2),
        reference(size + 2),
        length(size + 2) {}

  std::vector<double> cost, difference, reference, length;
};

/// One antidiagonal from the two before it, cells first ≤ i ≤ last. `m` is so placed that m[i] goes
/// with c[i]. Branch-free, so that it is compiled to vectors.
void advance(const Antidiagonal& before, const Antidiagonal& two_before, const double* c,
             const double* m, std::ptrdiff_t first, std::ptrdiff_t last, Antidiagonal& next) {
  const double* const up_cost = before.cost.data();        // (i − 1, j) at place i
  const double* const left_cost = before.cost.data() + 1;  // (i, j − 1)
  const double* const both_cost = two_before.cost.data();  // (i − 1, j − 1)
  const double* const up_difference = before.difference.data();
  const double* const both_difference = two_before.difference.data();
  const double* const up_reference = before.reference.data();
  const double* const both_reference = two_before.reference.data();
  const double* const up_length = before.length.data();
  const double* const both_length = two_before.length.data();
  double* const cost = next.cost.data() + 1;
  double* const difference = next.difference.data() + 1;
  double* const reference = next.reference.data() + 1;
  double* const length = next.length.data() + 1;
  for (std::ptrdiff_t i = first; i <= last; ++i) {
    const bool up_first = up_cost[i] <= left_cost[i];
    const double one = up_first ? up_cost[i] : left_cost[i];
    const double one_difference = up_first ? up_difference[i] : up_difference[i + 1];
    const double one_reference = up_first ? up_reference[i] : up_reference[i + 1];
    const double one_length = up_first ? up_length[i] : up_length[i + 1];
    const bool one_first = one <= both_cost[i];
    const double error = c[i] - m[i];
    cost[i] = error * error + (one_first ? one : both_cost[i]);
    difference[i] = std::abs(error) + (one_first ? one_difference : both_difference[i]);
    reference[i] = std::abs(m[i]) + (one_first ? one_reference : both_reference[i]);
    length[i] = 1.0 + (one_first ? one_length : both_length[i]);
  }
}

/// ε_mag and the length of the path: dynamic time warping in memory of O(M).
void warp(Segment measured, Segment computed, Iso18571& result) {
  const auto size = static_cast<std::ptrdiff_t>(measured.size());
  const std::ptrdiff_t band = (size + 9) / 10;  // ⌈0.1 M⌉
  const std::vector<double> reversed(measured.rbegin(), measured.rend());
  Antidiagonal two_before(measured.size()), before(measured.size()), next(measured.size());
  constexpr double infinity = std::numeric_limits<double>::infinity();
  two_before.cost[0] = 0.0;  // before the first cell
  for (std::ptrdiff_t s = 0; s <= 2 * (size - 1); ++s) {
    // |i − j| = |2 i − s| < band within the square
    const std::ptrdiff_t first = std::max(
        {std::ptrdiff_t{0}, s - size + 1, s < band ? std::ptrdiff_t{0} : (s - band) / 2 + 1});
    const std::ptrdiff_t last = std::min({size - 1, s, (s + band - 1) / 2});
    advance(before, two_before, computed.data(), reversed.data() + (size - 1 - s), first, last,
            next);
    next.cost[static_cast<std::size_t>(first)] = infinity;     // the place before `first`
    next.cost[static_cast<std::size_t>(last) + 2] = infinity;  // and behind `last`
    if (s == 0) two_before.cost[0] = infinity;
    std::swap(two_before, before);
    std::swap(before, next);
  }
  const auto end = static_cast<std::size_t>(size);
  result.magnitude_error = relative(before.difference[end], before.reference[end]);
  result.path_length = static_cast<std::size_t>(before.length[end]);
}

/// Differences of a unit step, central and one-sided at the ends, averaged over up to 9 samples.
std::vector<double> smooth_slope(Segment x) {
  const std::size_t n = x.size();
  std::vector<double> slope(n), result(n);
  slope.front() = x[1] - x[0];
  slope.back() = x[n - 1] - x[n - 2];
  for (std::size_t i = 1; i + 1 < n; ++i) slope[i] = 0.5 * (x[i + 1] - x[i - 1]);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t half = std::min({i, n - 1 - i, std::size_t{4}});
    double sum = 0.0;
    for (std::size_t k = i - half; k <= i + half; ++k) sum += slope[k];
    result[i] = sum / static_cast<double>(2 * half + 1);
  }
  return result;
}

double slope_error(Segment measured, Segment computed) {
  const std::vector<double> m = smooth_slope(measured), c = smooth_slope(computed);
  double error = 0.0, size = 0.0;
  for (std::size_t i = 0; i < m.size(); ++i) {
    error += std::abs(c[i] - m[i]);
    size += std::abs(m[i]);
  }
  return relative(error, size);
}

}  // namespace

Iso18571 iso18571(const HistoryPair& pair) {
  require_comparable(pair, 2);
  Iso18571 result;
  result.corridor = corridor_score(pair);
  find_shift(pair, result);
  result.phase = falling(5.0 * static_cast<double>(std::abs(result.shift)),
                         static_cast<double>(pair.measured.size()));
  const auto [measured, computed] = ShiftedCorrelation::overlap(pair, result.shift);
  warp(measured, computed, result);
  result.magnitude = falling(result.magnitude_error, 0.5);
  result.slope_error = slope_error(measured, computed);
  result.slope = falling(result.slope_error, 2.0);
  result.rating = 0.4 * result.corridor + 0.2 * (result.phase + result.magnitude + result.slope);
  return result;
}

std::string_view iso18571_grade(double rating) {
  if (rating > 0.94) return "excellent";
  if (rating > 0.8) return "good";
  return rating > 0.58 ? "fair" : "poor";
}

}  // namespace impactrig::fitting
