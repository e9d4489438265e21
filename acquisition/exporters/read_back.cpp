// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/exporters/read_back.hpp"

#include <fmt/format.h>

#include <cmath>

#include "acquisition/importer.hpp"
#include "datasets/input_error.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Record;

namespace {

constexpr std::string_view way_out = "a .h5 file keeps everything";

/// A sentence for a thousand channels too: the first few of them, and how many more.
class Differences {
 public:
  void add(const std::string& was, const std::string& is) {
    constexpr int shown = 3;
    if (++count_ <= shown)
      list_ += fmt::format("{}'{}' as '{}'", list_.empty() ? "" : ", ", was, is);
    else
      more_ = fmt::format(" and {} more", count_ - shown);
  }

  void tell(std::string_view what, std::vector<std::string>& warnings) const {
    if (count_ > 0)
      warnings.push_back(fmt::format("the file does not give back every {} as it is: {}{}; {}",
                                     what, list_, more_, way_out));
  }

 private:
  int count_ = 0;
  std::string list_, more_;
};

bool is_time_record(const Channel& channel) {
  const auto domain = channel.attributes.find("domain");
  return domain == channel.attributes.end() || domain->second == "time";
}

/// As well as the head of a long table, which is not read through, can tell.
bool same_interval(double a, double b) {
  return std::abs(a - b) <= 1e-3 * std::abs(a);
}

/// The time of the first sample [s].
double start_of(const OutgoingChannel& channel) {
  return channel.uniform ? channel.head->clock.start : channel.part(0, 1).clock.times.front();
}

double start_of(const Channel& channel) {
  return channel.clock.times.empty() ? channel.clock.start : channel.clock.times.front();
}

bool same_start(double a, double b, double interval) {
  return std::abs(a - b) <= 1e-3 * interval;
}

std::string names_of(const Record& record) {
  std::string names;
  for (const Channel& channel : record.channels)
    names += fmt::format("{}'{}'", names.empty() ? "" : ", ", channel.name);
  return names.empty() ? "none" : names;
}

void compare(const OutgoingRecording& recording, const Record& back,
             std::vector<std::string>& warnings) {
  if (back.channels.size() != recording.channels.size()) {
    warnings.push_back(fmt::format(
        "the file gives back {} of {} channels ({}): others look like times or sample numbers; {}",
        back.channels.size(), recording.channels.size(), names_of(back), way_out));
    return;
  }
  Differences names, units, clocks, starts;
  for (std::size_t c = 0; c < back.channels.size(); ++c) {
    const OutgoingChannel& outgoing = recording.channels[c];
    const Channel& was = *outgoing.head;
    const Channel& is = back.channels[c];
    if (is.name != was.name) names.add(was.name, is.name);
    if (is.unit != was.unit) units.add(was.unit, is.unit);
    if (outgoing.uniform && outgoing.size > 0 && is_time_record(was) &&
        !same_interval(was.clock.interval, is.clock.interval))
      clocks.add(fmt::format("{:.12g} s", was.clock.interval),
                 fmt::format("{:.12g} s", is.clock.interval));
    if (outgoing.size > 0 && is_time_record(was) &&
        !same_start(start_of(outgoing), start_of(is), was.clock.interval))
      starts.add(fmt::format("{:.12g} s", start_of(outgoing)),
                 fmt::format("{:.12g} s", start_of(is)));
  }
  names.tell("name", warnings);
  units.tell("unit", warnings);
  clocks.tell("sample interval", warnings);
  starts.tell("start", warnings);
}

}  // namespace

std::vector<std::string> not_read_back(const OutgoingRecording& recording,
                                       const std::string& path) {
  ImportOptions options;
  options.require_clock = false;
  options.head_only = true;
  std::vector<std::string> warnings;
  try {
    compare(recording, open_recording(path, options)->head().record, warnings);
  } catch (const datasets::InputError& error) {
    warnings.push_back(fmt::format("the file cannot be read back ({}); {}", error.what(), way_out));
  }
  return warnings;
}

}  // namespace impactrig::acquisition
