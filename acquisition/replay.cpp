// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/replay.hpp"

#include <algorithm>
#include <iterator>
#include <thread>
#include <utility>

namespace impactrig::acquisition {

using datasets::Record;

namespace {

/// From the first to the last sample of any channel [s].
double duration_of(const Record& record) {
  double longest = 0.0;
  for (const auto& channel : record.channels) {
    if (channel.size() == 0) continue;
    longest = std::max(longest, channel.clock.time(channel.size() - 1) - channel.clock.time(0));
  }
  return longest;
}

}  // namespace

ReplaySource::ReplaySource(std::vector<std::string> files, ImportOptions options, Pace pace)
    : items_(std::make_move_iterator(files.begin()), std::make_move_iterator(files.end())),
      options_(std::move(options)),
      pace_(pace) {}

ReplaySource::ReplaySource(std::vector<Record> records, Pace pace)
    : items_(std::make_move_iterator(records.begin()), std::make_move_iterator(records.end())),
      pace_(pace) {}

std::optional<Record> ReplaySource::next() {
  if (position_ == items_.size()) return std::nullopt;
  auto& item = items_[position_++];
  Record record = std::holds_alternative<std::string>(item)
                      ? import_recording(std::get<std::string>(item), options_)
                      : std::move(std::get<Record>(item));
  if (pace_ == Pace::real_time) {
    const auto now = std::chrono::steady_clock::now();
    const auto wait = std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(duration_of(record)));
    // Reading takes time too: the pace is that of the records, not of the reader.
    due_ = due_.value_or(now) + wait;
    std::this_thread::sleep_until(*due_);
    due_ = std::max(*due_, now);
  }
  return record;
}

}  // namespace impactrig::acquisition
