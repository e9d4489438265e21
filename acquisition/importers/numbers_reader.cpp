// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <numeric>

#include "acquisition/importers/number_cursor.hpp"
#include "acquisition/importers/stored_numbers.hpp"
#include "acquisition/importers/wide_integers.hpp"

namespace impactrig::acquisition {

using datasets::InputError;
using datasets::Record;

namespace {

/// Numbers handed over at once where channels lie interleaved, so that the rows are still in the
/// cache when the next channel is read, or where there are so many channels that their blocks fill
/// the memory.
std::uint64_t block_size_for(std::uint64_t largest_stride, std::size_t channels) {
  constexpr std::uint64_t rows = std::uint64_t{1} << 18;  // [bytes], a part of the second cache
  constexpr std::uint64_t all = std::uint64_t{1} << 22;   // numbers of all channels, 32 MB
  const std::uint64_t fit =
      std::max<std::uint64_t>(rows / std::max<std::uint64_t>(largest_stride, 1), 1024);
  const std::uint64_t share = std::max<std::uint64_t>(all / std::max<std::size_t>(channels, 1), 64);
  return std::min({numbers_at_once, fit, share});
}

/// One channel on its way out.
class ChannelStream {
 public:
  ChannelStream(FileWindow& window, const StoredChannel& channel, SampleRange range)
      : channel_(&channel),
        samples_(window, channel.samples),
        imaginary_(window, channel.imaginary),
        invalid_(window, channel.invalid),
        times_(window, channel.times),
        left_(range.last - range.first) {
    samples_.skip(range.first);
    for (const StoredNumbers& other : channel.others) {
      others_.emplace_back(window, other);
      others_.back().skip(range.first);
    }
    other_values_.resize(others_.size());
    if (channel.imaginary.size() > 0) imaginary_.skip(range.first);
    if (channel.invalid.size() > 0) invalid_.skip(range.first);
    if (channel.times.size() > 0) times_.skip(range.first);
  }

  bool done() const { return left_ == 0; }

  std::string warning(std::string_view name) const { return wide_.warning(name); }

  std::uint64_t first_byte() const {
    const std::vector<NumberRun>& runs = channel_->samples.runs();
    return runs.empty() ? 0 : runs.front().offset;
  }

  void hand_over(std::size_t index, std::uint64_t most, SampleSink& sink) {
    const std::uint64_t count = std::min(left_, most);
    SampleBlock block;
    block.raw = raw(count);
    if (channel_->imaginary.size() > 0)
      block.imaginary = read(imaginary_, count, imaginary_values_);
    if (channel_->invalid.size() > 0) block.valid = marks(count);
    sink.take(index, block);
    if (channel_->times.size() > 0) {
      read(times_, count, time_values_);
      if (channel_->times_scaling) channel_->times_scaling(time_values_);
      sink.take_times(index, time_values_);
    }
    left_ -= count;
  }

 private:
  template <typename Value>
  static std::span<const Value> read(NumberCursor& cursor, std::uint64_t count,
                                     std::vector<Value>& values) {
    values.resize(count);
    cursor.read(count, values.data());
    return values;
  }

  std::span<const std::uint8_t> marks(std::uint64_t count) {
    read(invalid_, count, mark_values_);
    if (channel_->invalid_meaning) channel_->invalid_meaning(mark_values_);
    valid_.resize(count);
    std::ranges::transform(mark_values_, valid_.begin(), [](double mark) {
      return mark == 0.0 ? std::uint8_t{1} : std::uint8_t{0};
    });
    return valid_;
  }

  /// Samples alone in their block need no copy.
  template <typename Value>
  std::span<const Value> read_samples(std::uint64_t count, std::vector<Value>& values) {
    if (count > 0 && channel_->imaginary.size() == 0 && channel_->invalid.size() == 0)
      if (const Value* const there = samples_.in_place<Value>(count)) return {there, count};
    return read(samples_, count, values);
  }

  datasets::RawSpan raw(std::uint64_t count) {
    if (channel_->scaling || channel_->joining) {
      read(samples_, count, doubles_);
      for (std::size_t i = 0; i < others_.size(); ++i) read(others_[i], count, other_values_[i]);
      if (channel_->joining) channel_->joining(doubles_, other_values_);
      if (channel_->scaling) channel_->scaling(doubles_);
      return std::span<const double>(doubles_);
    }
    switch (channel_->samples.kind()) {
      case NumberKind::i8:
      case NumberKind::u8:
        return read_samples(count, shorts_);
      case NumberKind::i16:
        return read_samples(count, shorts_);
      case NumberKind::u16:
      case NumberKind::i24:
        return read_samples(count, integers_);
      case NumberKind::i32:
        return read_samples(count, integers_);
      case NumberKind::f32:
        return read_samples(count, floats_);
      case NumberKind::f64:
      case NumberKind::u32:
        return read_samples(count, doubles_);
      case NumberKind::i64:
      case NumberKind::u64:
        wide_.look(read(samples_, count, doubles_));
        break;
    }
    return std::span<const double>(doubles_);
  }

  const StoredChannel* channel_;
  NumberCursor samples_;
  NumberCursor imaginary_;
  NumberCursor invalid_;
  NumberCursor times_;
  std::vector<NumberCursor> others_;
  std::uint64_t left_;
  WideIntegers wide_;
  std::vector<double> doubles_;
  std::vector<float> floats_;
  std::vector<std::int16_t> shorts_;
  std::vector<std::int32_t> integers_;
  std::vector<double> imaginary_values_;
  std::vector<double> mark_values_;
  std::vector<std::uint8_t> valid_;
  std::vector<double> time_values_;
  std::vector<std::vector<double>> other_values_;
};

class NumbersReader final : public RecordingReader {
 public:
  NumbersReader(std::unique_ptr<MappedFile> file, Record record,
                std::vector<StoredChannel> channels)
      : file_(std::move(file)),
        channels_(std::move(channels)) {
    head_.record = std::move(record);
    for (const StoredChannel& channel : channels_) {
      check_within_file(channel.samples);
      check_within_file(channel.imaginary);
      check_within_file(channel.invalid);
      check_within_file(channel.times);
      for (const StoredNumbers& other : channel.others) check_within_file(other);
      head_.samples.push_back(channel.samples.size());
    }
  }

  const RecordingHead& head() const override { return head_; }

  Record read(const Selection& wanted, SampleSink& sink) override {
    Record record = head_.record;
    record.channels.clear();
    std::vector<ChannelStream> streams;
    FileWindow window(*file_);
    std::uint64_t largest_stride = 1;
    for (const std::size_t index : selected_channels(head_, wanted)) {
      const StoredChannel& stored = channels_[index];
      if (!stored.samples.runs().empty())
        largest_stride = std::max(largest_stride, stored.samples.runs().front().stride);
      record.channels.push_back(head_.record.channels[index]);
      datasets::SampleClock& clock = record.channels.back().clock;
      const SampleRange range = stored.times.size() == 0
                                    ? samples_within(clock, stored.samples.size(), wanted)
                                    : samples_between(stored, wanted, clock);
      streams.emplace_back(window, stored, range);
      if (stored.times.size() == 0)
        clock.start += clock.interval * static_cast<double>(range.first);
    }
    window.expect_rows_of(streams.size());
    std::vector<std::size_t> by_place(streams.size());
    std::iota(by_place.begin(), by_place.end(), std::size_t{0});
    std::ranges::sort(by_place, {}, [&](std::size_t i) { return streams[i].first_byte(); });
    const std::uint64_t most = block_size_for(largest_stride, streams.size());
    for (bool more = true; more;) {
      more = false;
      for (const std::size_t i : by_place) {
        if (streams[i].done()) continue;
        do streams[i].hand_over(i, most, sink);
        while (file_->only_forward() && !streams[i].done());
        more = more || !streams[i].done();
      }
    }
    for (std::size_t i = 0; i < streams.size(); ++i) {
      std::string warning = streams[i].warning(record.channels[i].name);
      if (!warning.empty()) record.warnings.push_back(std::move(warning));
    }
    return record;
  }

 private:
  void check_within_file(const StoredNumbers& numbers) const {
    const std::uint64_t size = file_->bytes().size();
    for (const NumberRun& run : numbers.runs()) {
      // in 64 digits: exact below 2^64, and announced numbers cannot overflow it
      const long double last =
          static_cast<long double>(run.offset) +
          static_cast<long double>(run.period) * static_cast<long double>(run.repeats - 1) +
          static_cast<long double>(run.stride) * static_cast<long double>(run.count - 1) +
          static_cast<long double>(size_of(numbers.kind()));
      if (last > static_cast<long double>(size))
        throw InputError(file_->byte_position(std::min(run.offset, size)),
                         "the file ends within the samples");
    }
  }

  /// The samples whose stated times lie in the window; `clock` then starts at the first of them.
  SampleRange samples_between(const StoredChannel& channel, const Selection& wanted,
                              datasets::SampleClock& clock) const {
    const StoredNumbers& times = channel.times;
    if (!wanted.has_window()) return {0, times.size()};
    FileWindow window(*file_);
    NumberCursor cursor(window, times);
    TimeWindow found(wanted);
    std::vector<double> block;
    for (std::uint64_t i = 0; i < times.size(); i += block.size()) {
      block.resize(std::min(numbers_at_once, times.size() - i));
      cursor.read(block.size(), block.data());
      if (channel.times_scaling) channel.times_scaling(block);
      found.add(block);
    }
    found.settle(clock);
    return found.range();
  }

  std::unique_ptr<MappedFile> file_;
  std::vector<StoredChannel> channels_;
  RecordingHead head_;
};

}  // namespace

std::unique_ptr<RecordingReader> reader_of_numbers(std::unique_ptr<MappedFile> file, Record record,
                                                   std::vector<StoredChannel> channels) {
  return std::make_unique<NumbersReader>(std::move(file), std::move(record), std::move(channels));
}

}  // namespace impactrig::acquisition
