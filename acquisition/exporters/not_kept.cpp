// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/exporters/not_kept.hpp"

#include <fmt/format.h>

#include <cmath>

#include "datasets/sample_filter.hpp"

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

MarkedSamples marked_samples(const OutgoingChannel& channel, std::size_t most) {
  MarkedSamples marked;
  if (!channel.marked) return marked;
  std::uint64_t last = 0;  // of the run before
  channel.each([&](const Channel& part, std::uint64_t first) {
    for (std::size_t i = 0; i < part.valid.size(); ++i) {
      if (part.is_valid(i) || !std::isfinite(part.value(i))) continue;
      if (part.complex() && !std::isfinite(part.imaginary[i])) continue;
      const bool goes_on = marked.count > 0 && last == first + i;
      last = first + i + 1;
      ++marked.count;
      if (!goes_on && marked.runs.size() == most) marked.more = true;
      if (marked.more) continue;
      if (goes_on)
        marked.runs.back().last = last;
      else
        marked.runs.push_back({first + i, last});
    }
  });
  return marked;
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

void tell_of_filters(const Record& record, std::string_view format,
                     std::vector<std::string>& warnings) {
  const std::string names = names_of(record, [&record](const Channel& channel) {
    const auto filters = datasets::filters_of(record, channel);
    return !filters || !filters->empty();
  });
  if (!names.empty())
    warnings.push_back(fmt::format(
        "{} has no place for the filtering of {}, so that a fit to it would take them for what the "
        "sensors gave: .h5 and .mat files keep it",
        format, names));
}

void tell_of_marks(const OutgoingChannel& channel, std::string_view format,
                   std::vector<std::string>& warnings) {
  constexpr std::size_t shown = 5;
  const MarkedSamples marked = marked_samples(channel, shown);
  if (marked.count == 0) return;
  warnings.push_back(fmt::format(
      "'{}': {} {} marked as not valid ({}{}), for which {} has no place: whoever reads "
      "it takes them as sound; .h5 and .mat files keep the marks",
      channel.head->name, marked.count, marked.count == 1 ? "sample is" : "samples are",
      listed(marked.runs, ", "), marked.more ? ", ..." : "", format));
}

}  // namespace impactrig::acquisition
