// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/recording_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "acquisition/importers/spool.hpp"
#include "acquisition/importers/time_axis.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Record;
using datasets::SampleClock;

namespace {

/// Samples handed over at once: they stay in the processor's cache on their way.
constexpr std::size_t block_size = 65536;

/// A head's count may be wrong: vectors grow beyond this only as samples come.
constexpr std::uint64_t most_reserved = std::uint64_t{1} << 24;

template <typename T>
std::span<const T> part(const std::vector<T>& all, std::size_t first, std::size_t count) {
  return all.empty() ? std::span<const T>{} : std::span<const T>(all).subspan(first, count);
}

class RecordInMemory final : public RecordingReader {
 public:
  explicit RecordInMemory(Record record) : full_(std::move(record)) {
    for (const Channel& channel : full_.channels) head_.samples.push_back(channel.size());
    head_.record.title = full_.title;
    head_.record.started = full_.started;
    head_.record.provenance = full_.provenance;
    head_.record.warnings = full_.warnings;
    head_.record.attributes = full_.attributes;
    for (const Channel& channel : full_.channels) head_.record.channels.push_back(without(channel));
  }

  const RecordingHead& head() const override { return head_; }

  Record read(const Selection& wanted, SampleSink& sink) override {
    const std::vector<std::size_t> chosen = selected_channels(head_, wanted);
    Record record = head_.record;
    record.channels.clear();
    for (const std::size_t index : chosen) {
      const Channel& channel = full_.channels[index];
      Channel head = without(channel);
      const SampleRange range = range_of(channel, wanted, head.clock);
      hand_over(channel, range, record.channels.size(), sink);
      record.channels.push_back(std::move(head));
    }
    return record;
  }

 private:
  static Channel without(const Channel& channel) {
    Channel head;
    head.name = channel.name;
    head.quantity = channel.quantity;
    head.unit = channel.unit;
    head.clock = {channel.clock.start, channel.clock.interval, {}};
    head.scale = channel.scale;
    head.offset = channel.offset;
    head.calibration = channel.calibration;
    head.delay = channel.delay;
    head.attributes = channel.attributes;
    return head;
  }

  /// The samples of a window, whose clock `clock` becomes.
  static SampleRange range_of(const Channel& channel, const Selection& wanted, SampleClock& clock) {
    if (channel.clock.uniform()) {
      const SampleRange range = samples_within(channel.clock, channel.size(), wanted);
      clock.start = channel.clock.time(range.first);
      return range;
    }
    if (!wanted.has_window()) return {0, channel.size()};
    TimeWindow window(wanted);
    window.add(channel.clock.times);
    window.settle(clock);
    return window.range();
  }

  static void hand_over(const Channel& channel, SampleRange range, std::size_t index,
                        SampleSink& sink) {
    for (std::size_t first = range.first; first < range.last; first += block_size) {
      const std::size_t count = std::min(block_size, static_cast<std::size_t>(range.last) - first);
      SampleBlock block;
      std::visit([&](const auto& raw) { block.raw = std::span(raw).subspan(first, count); },
                 channel.raw);
      block.imaginary = part(channel.imaginary, first, count);
      block.valid = part(channel.valid, first, count);
      sink.take(index, block);
      if (!channel.clock.uniform()) sink.take_times(index, part(channel.clock.times, first, count));
    }
  }

  Record full_;
  RecordingHead head_;
};

class HeadAlone final : public RecordingReader {
 public:
  explicit HeadAlone(RecordingHead head) : head_(std::move(head)) {}

  const RecordingHead& head() const override { return head_; }

  Record read(const Selection&, SampleSink&) override {
    throw std::logic_error("the recording was opened for its head alone");
  }

 private:
  RecordingHead head_;
};

/// Appends what it is handed to channels' vectors.
class MemorySink final : public SampleSink {
 public:
  explicit MemorySink(std::vector<std::uint64_t> expected)
      : channels_(expected.size()),
        expected_(std::move(expected)) {}

  void take(std::size_t index, const SampleBlock& block) override {
    Channel& channel = channels_[index];
    const std::size_t before = channel.size();
    std::visit([&](auto samples) { append(channel, samples, expected_[index]); }, block.raw);
    append(channel.imaginary, block.imaginary);
    if (channel.valid.empty() && !block.valid.empty()) channel.valid.assign(before, 1);
    if (!block.valid.empty())
      append(channel.valid, block.valid);
    else if (!channel.valid.empty())
      channel.valid.resize(channel.size(), 1);
  }

  void take_times(std::size_t index, std::span<const double> times) override {
    append(channels_[index].clock.times, times);
  }

  /// Moves the samples to the channels they belong to.
  void deliver(Record& record) {
    for (std::size_t i = 0; i < record.channels.size(); ++i) {
      record.channels[i].raw = std::move(channels_[i].raw);
      record.channels[i].imaginary = std::move(channels_[i].imaginary);
      record.channels[i].clock.times = std::move(channels_[i].clock.times);
      record.channels[i].valid = std::move(channels_[i].valid);
    }
  }

 private:
  template <typename T>
  static void append(Channel& channel, std::span<const T> samples, std::uint64_t expected) {
    if (channel.size() == 0 && !std::holds_alternative<std::vector<T>>(channel.raw))
      channel.raw = std::vector<T>{};
    auto& all = std::get<std::vector<T>>(channel.raw);
    if (all.empty()) all.reserve(static_cast<std::size_t>(std::min(expected, most_reserved)));
    all.insert(all.end(), samples.begin(), samples.end());
  }

  template <typename T>
  static void append(std::vector<T>& all, std::span<const T> more) {
    all.insert(all.end(), more.begin(), more.end());
  }

  std::vector<Channel> channels_;
  std::vector<std::uint64_t> expected_;
};

/// Keeps stated times back until all are there; samples go on.
class TimesLater final : public SampleSink {
 public:
  /// Where there may be many times, they are kept on the disk; `file` is for errors.
  TimesLater(std::size_t channels, bool many, std::string file, SampleSink& next)
      : next_(next),
        many_(many),
        file_(std::move(file)),
        times_(channels) {}

  void take(std::size_t index, const SampleBlock& block) override { next_.take(index, block); }

  void take_times(std::size_t index, std::span<const double> times) override {
    if (many_ && !spool_) {
      spool_.emplace(file_);
      times_.assign(times_.size(), NumberList<double>(&*spool_));
    }
    times_[index].append(times);
  }

  /// The times go on where no step stands for them.
  void deliver(Record& record) {
    for (std::size_t i = 0; i < times_.size(); ++i) {
      const NumberList<double>& times = times_[i];
      if (const auto even = even_axis(times)) {
        record.channels[i].clock = even->clock;
        tell(*even, times, record);
      } else {
        times.each([&](std::span<const double> piece) { next_.take_times(i, piece); });
      }
    }
  }

 private:
  static std::optional<TimeAxis> even_axis(const NumberList<double>& times) {
    if (times.size() < 3) return std::nullopt;  // two have one step, whatever the clock
    TimeAxisCheck check(times.front(), times.back(), times.size());
    times.each([&](std::span<const double> piece) { check.add(piece); });
    TimeAxis axis = check.axis();
    if (!check.uniform() || !(axis.clock.interval > 0.0)) return std::nullopt;
    return axis;
  }

  static void tell(const TimeAxis& axis, const NumberList<double>& times, Record& record) {
    const std::string sentence = fmt::format(
        "the samples between {:.9g} and {:.9g} s are evenly spaced, and a step of {:.9g} s stands "
        "for their times",
        times.front(), times.back(), axis.clock.interval);
    for (const std::string& text : {axis.warning, sentence})
      // channels mostly share their times
      if (!text.empty() && std::ranges::find(record.warnings, text) == record.warnings.end())
        record.warnings.push_back(text);
  }

  SampleSink& next_;
  bool many_;
  std::string file_;
  std::optional<Spool> spool_;
  std::vector<NumberList<double>> times_;
};

}  // namespace

std::size_t SampleBlock::size() const {
  return std::visit([](auto samples) { return samples.size(); }, raw);
}

bool Selection::has_window() const {
  return from > -std::numeric_limits<double>::infinity() ||
         to < std::numeric_limits<double>::infinity();
}

SampleRange samples_within(const SampleClock& clock, std::uint64_t samples,
                           const Selection& wanted) {
  if (!(clock.interval > 0.0) || !wanted.has_window()) return {0, samples};
  const auto end = static_cast<double>(samples);
  // a window's edge that is a sample's time but for rounding takes the sample
  constexpr double rounding = 1e-6;
  const double first = std::ceil((wanted.from - clock.start) / clock.interval - rounding);
  const double last = std::floor((wanted.to - clock.start) / clock.interval + rounding) + 1.0;
  SampleRange range;
  // written so that an edge that is not a number cuts nothing
  range.first = first > 0.0 ? static_cast<std::uint64_t>(std::min(first, end)) : 0;
  range.last = last < end ? static_cast<std::uint64_t>(std::max(last, 0.0)) : samples;
  range.last = std::max(range.first, range.last);
  return range;
}

void TimeWindow::add(std::span<const double> times) {
  for (const double time : times) {
    increasing_ = increasing_ && !(time < before_);
    before_ = time;
    if (time >= wanted_.from && time <= wanted_.to) {
      if (!inside_) {
        inside_ = true;
        range_.first = seen_;
        first_ = time;
      }
      range_.last = seen_ + 1;
      last_ = time;
    }
    ++seen_;
  }
}

SampleRange TimeWindow::range() const {
  return increasing_ ? range_ : SampleRange{0, seen_};
}

void TimeWindow::settle(SampleClock& clock) const {
  if (!increasing_ || !inside_) return;
  clock.start = first_;
  const std::uint64_t samples = range_.last - range_.first;
  if (samples > 1) clock.interval = (last_ - first_) / static_cast<double>(samples - 1);
}

std::vector<std::size_t> selected_channels(const RecordingHead& head, const Selection& wanted) {
  const std::size_t n = head.record.channels.size();
  std::vector<std::size_t> chosen = wanted.channels;
  if (chosen.empty())
    for (std::size_t i = 0; i < n; ++i) chosen.push_back(i);
  for (const std::size_t index : chosen)
    if (index >= n)
      throw std::invalid_argument(
          fmt::format("channel {} is asked for, the recording has {}", index, n));
  return chosen;
}

std::unique_ptr<RecordingReader> reader_of(Record record) {
  return std::make_unique<RecordInMemory>(std::move(record));
}

std::unique_ptr<RecordingReader> reader_of_head(RecordingHead head) {
  return std::make_unique<HeadAlone>(std::move(head));
}

Record read_window(RecordingReader& reader, const Selection& wanted, SampleSink& sink) {
  if (!wanted.has_window()) return reader.read(wanted, sink);
  const std::vector<std::size_t> chosen = selected_channels(reader.head(), wanted);
  std::uint64_t samples = 0;
  for (const std::size_t index : chosen) samples += reader.head().samples[index];
  TimesLater later(chosen.size(), samples > most_reserved,
                   reader.head().record.provenance.source_file, sink);
  Record record = reader.read(wanted, later);
  later.deliver(record);
  return record;
}

Record read_into_memory(RecordingReader& reader, const Selection& wanted) {
  std::vector<std::uint64_t> expected;
  for (const std::size_t index : selected_channels(reader.head(), wanted)) {
    const SampleRange range = samples_within(reader.head().record.channels[index].clock,
                                             reader.head().samples[index], wanted);
    expected.push_back(range.last - range.first);
  }
  MemorySink sink(std::move(expected));
  Record record = read_window(reader, wanted, sink);
  sink.deliver(record);
  return record;
}

}  // namespace impactrig::acquisition
