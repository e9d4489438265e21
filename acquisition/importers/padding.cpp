// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/padding.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <variant>

namespace impactrig::acquisition {

namespace {

constexpr std::uint64_t fewest = 32;  ///< zeros, and samples beside them

/// Whether samples go up and down about their median as noise does, and repeat far less often on
/// end than the zeros beside them.
bool is_noise(std::vector<double> samples, std::uint64_t zeros) {
  std::erase_if(samples, [](double sample) { return !std::isfinite(sample); });
  if (zeros < fewest || samples.size() < fewest) return false;
  std::vector<double> sorted = samples;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::ranges::nth_element(sorted, middle);
  std::uint64_t run = 1, longest = 1, crossings = 0;
  bool above = samples.front() > *middle;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    run = samples[i] == samples[i - 1] ? run + 1 : 1;
    longest = std::max(longest, run);
    if ((samples[i] > *middle) != above) ++crossings;
    above = samples[i] > *middle;
  }
  return 8 * longest < zeros && 8 * crossings > samples.size();
}

}  // namespace

void PaddingCheck::add(const SampleBlock& block) {
  std::visit([this](auto samples) { look(samples); }, block.raw);
}

template <typename Sample>
void PaddingCheck::look(std::span<const Sample> samples) {
  const auto zero = [](Sample sample) { return sample == Sample{0}; };
  std::size_t first = 0;
  if (leading_ == seen_)
    while (first < samples.size() && zero(samples[first])) ++first;
  leading_ += first;
  seen_ += samples.size();
  const std::uint64_t enough =
      leading_ < fewest ? 0 : std::min<std::uint64_t>(leading_, most_beside);
  for (std::size_t i = first; i < samples.size() && behind_.size() < enough; ++i)
    behind_.push_back(static_cast<double>(samples[i]));
  std::size_t last = samples.size();
  while (last > first && zero(samples[last - 1])) --last;
  if (last > first) {
    within_ = std::max(within_, trailing_);
    trailing_ = 0;
  }
  trailing_ += samples.size() - last;
  for (std::size_t i = std::max(first, last - std::min(last, most_beside)); i < last; ++i)
    before_[before_count_++ % most_beside] = static_cast<double>(samples[i]);
}

std::uint64_t PaddingCheck::begin() const {
  return is_noise(behind_, leading_) ? leading_ : 0;
}

std::uint64_t PaddingCheck::end() const {
  std::vector<double> before;
  const std::uint64_t beside = std::min<std::uint64_t>({before_count_, trailing_, most_beside});
  for (std::uint64_t i = before_count_ - beside; i < before_count_; ++i)
    before.push_back(before_[i % most_beside]);
  return 8 * within_ < trailing_ && is_noise(before, trailing_) ? trailing_ : 0;
}

}  // namespace impactrig::acquisition
