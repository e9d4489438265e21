// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/quicklook.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace impactrig::datasets {

namespace {

/// NaN where the sample is not valid.
double shown(const Channel& channel, std::size_t i) {
  return channel.is_valid(i) ? channel.value(i) : std::numeric_limits<double>::quiet_NaN();
}

/// Indices of the smallest and largest of [begin, end), in ascending order; one where they are the
/// same sample.
void add_extremes(const Channel& channel, std::size_t begin, std::size_t end,
                  std::vector<std::size_t>& kept) {
  std::size_t lowest = begin;
  std::size_t highest = begin;
  for (std::size_t i = begin + 1; i < end; ++i) {
    const double value = shown(channel, i);
    // written so that a NaN loses against any number
    if (value < shown(channel, lowest) || std::isnan(shown(channel, lowest))) lowest = i;
    if (value > shown(channel, highest) || std::isnan(shown(channel, highest))) highest = i;
  }
  kept.push_back(std::min(lowest, highest));
  if (lowest != highest) kept.push_back(std::max(lowest, highest));
}

std::vector<std::size_t> kept_samples(const Channel& channel, std::size_t most) {
  const std::size_t n = channel.size();
  std::vector<std::size_t> kept;
  if (n <= most) {
    kept.resize(n);
    std::iota(kept.begin(), kept.end(), std::size_t{0});
    return kept;
  }
  const std::size_t buckets = std::max<std::size_t>(most / 2, 1);
  // n / buckets and its remainder apart, as n * buckets may not fit
  const std::size_t whole = n / buckets;
  const std::size_t longer = n % buckets;
  std::size_t begin = 0;
  for (std::size_t bucket = 0; bucket < buckets; ++bucket) {
    const std::size_t end = begin + whole + (bucket < longer ? 1 : 0);
    add_extremes(channel, begin, end, kept);
    begin = end;
  }
  return kept;
}

}  // namespace

Quicklook quicklook_of(const Channel& channel, std::size_t most) {
  Quicklook look;
  const std::string_view si = si_unit(channel.quantity);
  const auto to_si = si.empty() ? std::nullopt : conversion(channel.unit, si);
  const UnitConversion to_shown = to_si.value_or(UnitConversion{});
  look.unit = to_si ? std::string(si) : channel.unit;
  for (const std::size_t i : kept_samples(channel, most)) {
    look.time.push_back(channel.clock.time(i));
    look.values.push_back(to_shown.factor * shown(channel, i) + to_shown.offset);
    if (channel.complex()) look.imaginary.push_back(to_shown.factor * channel.imaginary[i]);
  }
  return look;
}

}  // namespace impactrig::datasets
