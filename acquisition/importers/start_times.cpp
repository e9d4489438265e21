// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/start_times.hpp"

#include <fmt/format.h>

#include <cmath>

#include "acquisition/importers/date_time.hpp"

namespace impactrig::acquisition {
namespace {

constexpr double of_writing = 2.0;  // [s]

bool apart(const std::string& one, const std::string& other) {
  if (one == other) return false;
  const auto from = date_time_in(one), to = date_time_in(other);
  const auto seconds = from && to ? seconds_between(*from, *to) : std::nullopt;
  return !seconds || std::abs(*seconds) > of_writing;
}

}  // namespace

void StartTimes::add(const std::string& start) {
  if (start.empty() || !other_.empty()) return;
  if (first_.empty())
    first_ = start;
  else if (apart(first_, start))
    other_ = start;
}

void StartTimes::tell(datasets::Record& record) const {
  if (other_.empty()) return;
  record.warnings.push_back(
      fmt::format("channels were started at different times (the first at {}, another at {}): each "
                  "counts its time from its own start",
                  first_, other_));
}

}  // namespace impactrig::acquisition
