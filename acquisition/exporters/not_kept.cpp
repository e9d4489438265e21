// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/exporters/not_kept.hpp"

#include <fmt/format.h>

#include <cmath>

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Record;

namespace {

template <typename Has>
std::string names_of(const Record& record, const Has& has) {
  std::string names;
  for (const Channel& channel : record.channels)
    if (has(channel)) names += fmt::format("{}'{}'", names.empty() ? "" : ", ", channel.name);
  return names;
}

}  // namespace

std::vector<SampleRange> marked_samples(const Channel& channel) {
  std::vector<SampleRange> runs;
  for (std::size_t i = 0; i < channel.valid.size(); ++i) {
    if (channel.is_valid(i) || !std::isfinite(channel.value(i))) continue;
    if (channel.complex() && !std::isfinite(channel.imaginary[i])) continue;
    if (!runs.empty() && runs.back().last == i)
      ++runs.back().last;
    else
      runs.push_back({i, i + 1});
  }
  return runs;
}

std::string listed(const std::vector<SampleRange>& runs, std::string_view separator) {
  std::string list;
  for (const SampleRange& run : runs) {
    if (!list.empty()) list += separator;
    list += run.last - run.first == 1 ? fmt::format("{}", run.first)
                                      : fmt::format("{}-{}", run.first, run.last - 1);
  }
  return list;
}

void tell_of_calibrations(const Record& record, std::string_view format,
                          std::vector<std::string>& warnings) {
  const auto tell = [&](std::string_view what, const std::string& names) {
    if (!names.empty())
      warnings.push_back(fmt::format("{} has no place for the {} of {}: .h5 and .mat files keep it",
                                     format, what, names));
  };
  tell("calibration", names_of(record, [](const Channel& c) { return c.calibration.has_value(); }));
  tell("delay", names_of(record, [](const Channel& c) { return c.delay.has_value(); }));
}

void tell_of_marks(const Channel& channel, std::string_view format,
                   std::vector<std::string>& warnings) {
  std::vector<SampleRange> runs = marked_samples(channel);
  if (runs.empty()) return;
  std::uint64_t samples = 0;
  for (const SampleRange& run : runs) samples += run.last - run.first;
  constexpr std::size_t shown = 5;
  const bool more = runs.size() > shown;
  if (more) runs.resize(shown);
  warnings.push_back(fmt::format(
      "'{}': {} {} marked as not valid ({}{}), for which {} has no place: whoever reads "
      "it takes them as sound; .h5 and .mat files keep the marks",
      channel.name, samples, samples == 1 ? "sample is" : "samples are", listed(runs, ", "),
      more ? ", ..." : "", format));
}

}  // namespace impactrig::acquisition
