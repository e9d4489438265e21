// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/background.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <numeric>
#include <unsupported/Eigen/FFT>

#include "acquisition/disk_memory.hpp"

namespace impactrig::acquisition {

namespace {

constexpr std::size_t sample_limit = std::size_t{1} << 18;
constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

double as_double(std::size_t n) {
  return static_cast<double>(n);
}

/// What `of` says of indices from `first` to `end`, so that there are at most `most`.
template <typename Of>
std::vector<double> sampled(std::size_t first, std::size_t end, std::size_t most, const Of& of) {
  const std::size_t stride = (end + most - 1) / most;
  std::vector<double> sample;
  sample.reserve(end / stride + 1);
  for (std::size_t i = first; i < end; i += stride) {
    sample.push_back(of(i));
    if (sample.size() % 8 == 0) DiskMemory::keep_small();
  }
  return sample;
}

bool counts(std::span<const std::uint8_t> valid, std::size_t i) {
  return valid.empty() || valid[i] != 0;
}

std::span<const std::uint8_t> part_of(std::span<const std::uint8_t> valid, std::size_t begin,
                                      std::size_t end) {
  return valid.empty() ? valid : valid.subspan(begin, end - begin);
}

std::size_t count_within(std::span<const std::uint8_t> valid, std::size_t begin, std::size_t end) {
  const auto part = part_of(valid, begin, end);
  return valid.empty() ? end - begin
                       : part.size() - static_cast<std::size_t>(std::ranges::count(part, 0));
}

/// Medians of up to `blocks` equal blocks and the indices of their middles, of the valid samples;
/// without blocks that have none.
struct BlockMedians {
  std::vector<double> index, value;
};

BlockMedians block_medians(std::span<const double> values, std::span<const std::uint8_t> valid,
                           std::size_t begin, std::size_t end, std::size_t blocks) {
  blocks = std::min(blocks, end - begin);
  BlockMedians result;
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::size_t from = begin + (end - begin) * b / blocks;
    const std::size_t to = begin + (end - begin) * (b + 1) / blocks;
    std::vector<double> block;
    double indices = 0.0;
    for (std::size_t i = from; i < to; ++i) {
      if (!counts(valid, i)) continue;
      block.push_back(values[i]);
      indices += as_double(i);
    }
    if (block.empty()) continue;
    result.index.push_back(indices / as_double(block.size()));
    result.value.push_back(median(std::move(block)));
  }
  return result;
}

/// The median of the slopes between all pairs of points (Theil–Sen), and the median intercept.
void robust_line(const BlockMedians& blocks, QuietFit& fit) {
  std::vector<double> slopes, intercepts;
  for (std::size_t i = 0; i < blocks.index.size(); ++i)
    for (std::size_t j = i + 1; j < blocks.index.size(); ++j)
      slopes.push_back((blocks.value[j] - blocks.value[i]) / (blocks.index[j] - blocks.index[i]));
  const double slope = slopes.empty() ? 0.0 : median(slopes);
  for (std::size_t i = 0; i < blocks.index.size(); ++i)
    intercepts.push_back(blocks.value[i] - slope * (blocks.index[i] - fit.middle));
  fit.coefficients[0] = median(intercepts);
  fit.coefficients[1] = slope * fit.half;
}

/// Least squares over the valid samples that lie within `band` of the course so far.
void refit_within(std::span<const double> values, std::span<const std::uint8_t> valid, double band,
                  int degree, QuietFit& fit) {
  const int terms = degree + 1;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  std::size_t used = 0;
  double sum = 0.0, squares = 0.0;
  for (std::size_t i = fit.begin; i < fit.end; ++i) {
    if (!counts(valid, i) || std::abs(values[i] - fit.at(as_double(i))) > band) continue;
    const double u = (as_double(i) - fit.middle) / fit.half;
    const Eigen::Vector3d row(1.0, u, u * u);
    normal += row * row.transpose();
    right += row * values[i];
    sum += values[i];
    ++used;
  }
  if (used < static_cast<std::size_t>(terms) + 1) return;
  const Eigen::VectorXd solution =
      normal.topLeftCorner(terms, terms).ldlt().solve(right.head(terms));
  const QuietFit before = fit;
  for (int k = 0; k < 3; ++k) fit.coefficients[k] = k < terms ? solution[k] : 0.0;
  for (std::size_t i = fit.begin; i < fit.end; ++i) {
    if (!counts(valid, i) || std::abs(values[i] - before.at(as_double(i))) > band) continue;
    const double residual = values[i] - fit.at(as_double(i));
    squares += residual * residual;
  }
  fit.mean = sum / as_double(used);
  fit.sigma = std::sqrt(squares / (as_double(used) - terms));
}

/// Of the valid samples.
std::vector<double> distances(std::span<const double> values, std::span<const std::uint8_t> valid,
                              const QuietFit& fit) {
  std::vector<double> distances;
  distances.reserve(fit.size());
  for (std::size_t i = fit.begin; i < fit.end; ++i)
    if (counts(valid, i)) distances.push_back(std::abs(values[i] - fit.at(as_double(i))));
  return distances;
}

/// 0 where a sample is not valid.
std::vector<double> residuals_of(std::span<const double> values,
                                 std::span<const std::uint8_t> valid, const QuietFit& fit) {
  std::vector<double> residuals;
  residuals.reserve(fit.size());
  for (std::size_t i = fit.begin; i < fit.end; ++i)
    residuals.push_back(counts(valid, i) ? values[i] - fit.at(as_double(i)) : 0.0);
  return residuals;
}

}  // namespace

std::vector<double> evenly_spread(std::span<const double> values, std::size_t most) {
  return sampled(0, values.size(), most, [&](std::size_t i) { return values[i]; });
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

Spread robust_spread(std::span<const double> values, std::span<const std::uint8_t> valid) {
  std::vector<double> sample = sampled(0, values.size(), sample_limit, [&](std::size_t i) {
    return counts(valid, i) ? values[i] : nothing;
  });
  std::erase_if(sample, [](double value) { return std::isnan(value); });
  if (sample.empty()) sample = evenly_spread(values, sample_limit);
  Spread spread;
  spread.centre = median(sample);
  for (double& value : sample) value = std::abs(value - spread.centre);
  spread.sigma = normal_mad * median(std::move(sample));
  return spread;
}

double step_noise(std::span<const double> values, std::span<const std::uint8_t> valid) {
  if (values.size() < 3) return 0.0;
  std::vector<double> steps = sampled(2, values.size(), sample_limit, [&](std::size_t i) {
    const bool count = counts(valid, i) && counts(valid, i - 1) && counts(valid, i - 2);
    return count ? std::abs(values[i] - 2.0 * values[i - 1] + values[i - 2]) : nothing;
  });
  std::erase_if(steps, [](double step) { return std::isnan(step); });
  if (steps.empty()) return step_noise(values);
  return normal_mad * median(std::move(steps)) / std::sqrt(6.0);
}

std::vector<double> block_means(std::span<const double> values, std::span<const std::uint8_t> valid,
                                std::size_t blocks) {
  std::vector<double> means;
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::size_t from = values.size() * b / blocks;
    const std::size_t to = values.size() * (b + 1) / blocks;
    double sum = 0.0, sound = 0.0;
    for (std::size_t i = from; i < to; ++i) {
      if (!valid.empty() && valid[i] == 0) continue;
      sum += values[i];
      sound += 1.0;
    }
    if (sound == 0.0 || 4.0 * sound < as_double(to - from)) continue;
    means.push_back(sum / sound);
  }
  return means;
}

double range_of_means(std::span<const double> values, std::span<const std::uint8_t> valid,
                      std::size_t blocks) {
  const std::vector<double> means = block_means(values, valid, blocks);
  if (means.empty()) return 0.0;
  const auto [least, most] = std::ranges::minmax(means);
  return most - least;
}

double noise_gate(std::size_t n) {
  return std::max(6.0, std::sqrt(2.0 * std::log(as_double(n))) + 1.7);
}

namespace {

/// The step of a grid through one of some values, sorted, on which at least 98 % of them lie; it is
/// near `step`, and sharper the further the values lie apart. 0: there is none.
double grid_step(std::span<const double> values, std::size_t anchor, double step) {
  constexpr double near_grid = 0.1, on_grid = 0.03;  // steps
  const double middle = values[anchor];
  std::size_t below = anchor, above = anchor + 1, near = 1;
  while (below > 0 || above < values.size()) {
    const bool up = below == 0 ||
                    (above < values.size() && values[above] - middle < middle - values[below - 1]);
    const double distance = std::abs(values[up ? above++ : --below] - middle);
    const double whole = std::round(distance / step);
    const double beside = std::abs(distance / step - whole);
    if (beside >= near_grid || whole == 0.0) continue;
    ++near;
    if (beside < on_grid) step = distance / whole;
  }
  return 100 * near >= 98 * values.size() ? step : 0.0;
}

}  // namespace

double quantum_of(std::span<const double> values, std::span<const std::uint8_t> valid) {
  std::vector<double> sorted = sampled(0, values.size(), std::size_t{1} << 16, [&](std::size_t i) {
    return counts(valid, i) ? values[i] : nothing;
  });
  std::erase_if(sorted, [](double value) { return std::isnan(value); });
  if (sorted.size() < 16) return 0.0;
  std::ranges::sort(sorted);
  const double span = sorted.back() - sorted.front();
  // Values that differ by rounding only are one value: 1e-9 of the span is below any digitiser.
  std::vector<double> distinct{sorted.front()};
  std::size_t anchor = 0, here = 0, most = 0;  // the value that occurs most often lies on the grid
  for (const double value : sorted) {
    if (value - distinct.back() > 1e-9 * span) {
      distinct.push_back(value);
      here = 0;
    }
    if (++here > most) {
      most = here;
      anchor = distinct.size() - 1;
    }
  }
  if (distinct.size() < 2 || 2 * distinct.size() > sorted.size()) return 0.0;

  std::vector<double> steps;
  for (std::size_t i = 1; i < distinct.size(); ++i) steps.push_back(distinct[i] - distinct[i - 1]);
  std::ranges::sort(steps);
  // Values beside the grid make the smallest steps: a coarser one that fits comes first.
  for (const std::size_t part : {4, 20})
    if (const double quantum = grid_step(distinct, anchor, steps[steps.size() / part]);
        quantum > 0.0)
      return quantum;
  return grid_step(distinct, anchor, steps.front());
}

double grain_of(std::span<const double> values, std::span<const std::uint8_t> valid) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return std::max(quantum_of(values, valid), 1e-7 * largest);
}

QuietFit fit_quiet(std::span<const double> values, std::size_t begin, std::size_t end, int degree,
                   double quantum, std::span<const std::uint8_t> valid) {
  if (count_within(valid, begin, end) < static_cast<std::size_t>(std::max(3, degree + 2)))
    valid = {};
  QuietFit fit;
  fit.begin = begin;
  fit.end = end;
  fit.middle = 0.5 * (as_double(begin) + as_double(end) - 1.0);
  fit.half = std::max(1.0, 0.5 * as_double(end - begin));
  const BlockMedians blocks = block_medians(values, valid, begin, end, 32);
  if (degree > 0)
    robust_line(blocks, fit);
  else
    fit.coefficients[0] = median(blocks.value);

  for (int round = 0; round < 3; ++round) {
    std::vector<double> off = distances(values, valid, fit);
    const double largest = std::ranges::max(off);
    double sigma = std::max(normal_mad * median(std::move(off)), fit.sigma);
    if (sigma < 1e-9 * largest) sigma = 0.0;  // most samples differ by rounding alone
    const double band = std::max(4.0 * sigma, 1.6 * quantum);
    refit_within(values, valid, band > 0.0 ? band : largest, degree, fit);
  }
  fit.correlation = correlation_time(residuals_of(values, valid, fit), part_of(valid, begin, end));
  return fit;
}

namespace {

/// Sums of the products of samples `lag` apart, for all lags: the transform of the power spectrum.
std::vector<double> lagged_products(std::span<const double> values) {
  std::size_t size = 1;
  while (size < 2 * values.size()) size *= 2;
  std::vector<double> padded(size, 0.0);
  std::ranges::copy(values, padded.begin());
  std::vector<std::complex<double>> transform;
  Eigen::FFT<double> fft;
  fft.fwd(transform, padded);
  for (std::complex<double>& value : transform) value = std::norm(value);
  fft.inv(padded, transform);
  return padded;
}

/// How many pairs of samples `lag` apart both count, of those there are: a part of it.
class PairShare {
 public:
  explicit PairShare(std::span<const std::uint8_t> valid) : counts_(valid.begin(), valid.end()) {
    if (!counts_.empty()) pairs_ = lagged_products(counts_);
  }

  /// What a sum of products `lag` apart would be if as many of them counted as of squares.
  double made_up(double product, std::size_t lag) const {
    if (counts_.empty()) return product;
    const double n = as_double(counts_.size());
    const double expected = pairs_[0] * (n - as_double(lag)) / n;
    return pairs_[lag] > 0.5 ? product * expected / pairs_[lag] : 0.0;
  }

 private:
  std::vector<double> counts_, pairs_;
};

}  // namespace

double correlation_time(std::span<const double> residuals, std::span<const std::uint8_t> valid) {
  constexpr std::size_t few = 64;                       // lags: faster summed up than transformed
  constexpr std::size_t enough = std::size_t{1} << 20;  // samples
  if (residuals.size() > enough)
    return correlation_time(
        residuals.subspan((residuals.size() - enough) / 2, enough),
        part_of(valid, (residuals.size() - enough) / 2, (residuals.size() - enough) / 2 + enough));
  const std::size_t n = residuals.size();
  const double power =
      std::inner_product(residuals.begin(), residuals.end(), residuals.begin(), 0.0);
  if (!(power > 0.0)) return 1.0;
  const PairShare pairs(valid);
  double time = 1.0;
  std::vector<double> products;
  for (std::size_t lag = 1; lag < n / 2; ++lag) {
    if (lag == few) products = lagged_products(residuals);
    double product = lag < few ? 0.0 : products[lag];
    for (std::size_t i = lag; i < n && lag < few; ++i) product += residuals[i] * residuals[i - lag];
    time += 2.0 * pairs.made_up(product, lag) / power;
    if (as_double(lag) >= 5.0 * time) break;
  }
  return std::max(time, 1.0);
}

/// Legendre polynomials P_0 to P_degree at x in [-1, 1].
void legendre_row(double x, Eigen::Ref<Eigen::RowVectorXd> row) {
  row[0] = 1.0;
  if (row.size() > 1) row[1] = x;
  for (Eigen::Index k = 2; k < row.size(); ++k) {
    const auto order = static_cast<double>(k);
    row[k] = ((2.0 * order - 1.0) * x * row[k - 1] - (order - 1.0) * row[k - 2]) / order;
  }
}

FastPart fast_part(std::span<const double> values, double interval) {
  const std::size_t n = values.size();
  const std::size_t blocks = std::min<std::size_t>(n, 128);
  // A polynomial follows a sinusoid of half-phase theta to a percent from degree theta + 3 on.
  const double theta = std::numbers::pi * 200.0 * interval * as_double(n);
  const auto terms = static_cast<Eigen::Index>(std::ceil(theta)) + 4;
  FastPart part{0.0, 0.0, blocks};
  if (terms + 4 > static_cast<Eigen::Index>(blocks)) return part;

  Eigen::MatrixXd basis(blocks, terms);
  Eigen::VectorXd mean(blocks);
  Eigen::RowVectorXd row(terms);
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::size_t from = n * b / blocks;
    const std::size_t to = n * (b + 1) / blocks;
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(from);
    const auto last = values.begin() + static_cast<std::ptrdiff_t>(to);
    mean[static_cast<Eigen::Index>(b)] = std::accumulate(first, last, 0.0) / as_double(to - from);
    legendre_row(as_double(from + to) / as_double(n) - 1.0, row);
    basis.row(static_cast<Eigen::Index>(b)) = row;
  }
  const Eigen::VectorXd solution = basis.householderQr().solve(mean);
  part.rms = (mean - basis * solution).norm() / std::sqrt(as_double(blocks));
  for (std::size_t i = 0; i < n; ++i) {
    legendre_row((2.0 * as_double(i) + 1.0) / as_double(n) - 1.0, row);
    part.highest = std::max(part.highest, std::abs(values[i] - row.dot(solution)));
  }
  return part;
}

bool explained_by_drift_and_hum(std::span<const double> values, double interval, double height,
                                double sigma) {
  const FastPart fast = fast_part(values, interval);
  const double block_noise = sigma / std::sqrt(as_double(values.size()) / as_double(fast.blocks));
  return fast.rms < std::max(1.4 * block_noise, 0.01 * height);
}

}  // namespace impactrig::acquisition
