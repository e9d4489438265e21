// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/stored_numbers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <numeric>

#include "acquisition/importers/take_apart.hpp"
#include "acquisition/importers/time_axis.hpp"

namespace impactrig::acquisition {

using datasets::InputError;
using datasets::Record;

std::size_t size_of(NumberKind kind) {
  switch (kind) {
    case NumberKind::i8:
    case NumberKind::u8:
      return 1;
    case NumberKind::i16:
    case NumberKind::u16:
      return 2;
    case NumberKind::i24:
      return 3;
    case NumberKind::i32:
    case NumberKind::u32:
    case NumberKind::f32:
      return 4;
    case NumberKind::i64:
    case NumberKind::u64:
    case NumberKind::f64:
      return 8;
  }
  return 1;
}

void StoredNumbers::add(const NumberRun& run) {
  if (run.count == 0) return;
  size_ += run.count * run.repeats;
  if (!runs_.empty()) {
    NumberRun& last = runs_.back();
    const bool alike = last.count == run.count && last.stride == run.stride && run.repeats == 1 &&
                       last.other_order == run.other_order;
    const std::uint64_t distance = run.offset - last.offset;
    if (alike && last.repeats == 1 && run.offset > last.offset) {
      last.period = distance;
      last.repeats = 2;
      return;
    }
    if (alike && last.repeats > 1 && distance == last.period * last.repeats) {
      ++last.repeats;
      return;
    }
  }
  runs_.push_back(run);
}

std::uint64_t numbers_there(const MappedFile& file, std::uint64_t offset, std::uint64_t stride,
                            NumberKind kind, std::uint64_t announced) {
  const std::uint64_t size = file.bytes().size();
  const std::uint64_t width = size_of(kind);
  if (offset > size || size - offset < width) return 0;
  if (stride == 0) return std::min<std::uint64_t>(announced, 1);
  return std::min(announced, (size - offset - width) / stride + 1);
}

namespace {

/// Numbers of a channel handed over at once, at most: they stay in the processor's cache.
constexpr std::uint64_t block_size = 32768;

/// Numbers handed over at once where channels lie interleaved, so that the rows are still in the
/// cache when the next channel is read, or where there are so many channels that their blocks fill
/// the memory.
std::uint64_t block_size_for(std::uint64_t largest_stride, std::size_t channels) {
  constexpr std::uint64_t rows = std::uint64_t{1} << 18;  // [bytes], a part of the second cache
  constexpr std::uint64_t all = std::uint64_t{1} << 22;   // numbers of all channels, 32 MB
  const std::uint64_t fit =
      std::max<std::uint64_t>(rows / std::max<std::uint64_t>(largest_stride, 1), 1024);
  const std::uint64_t share = std::max<std::uint64_t>(all / std::max<std::size_t>(channels, 1), 64);
  return std::min({block_size, fit, share});
}

template <typename Number>
Number byte_swapped(Number value) {
  auto bytes = std::bit_cast<std::array<char, sizeof(Number)>>(value);
  std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<Number>(bytes);
}

/// Copies `count` numbers at a distance of `stride` bytes to doubles, floats or integers.
template <typename Stored, bool Swapped, typename Value>
void gather(const char* from, std::uint64_t count, std::uint64_t stride, Value* to) {
  if (stride == sizeof(Stored)) stride = sizeof(Stored);  // lets the compiler see the common case
  for (std::uint64_t i = 0; i < count; ++i, from += stride) {
    Stored number;
    std::memcpy(&number, from, sizeof(Stored));
    if constexpr (Swapped) number = byte_swapped(number);
    to[i] = static_cast<Value>(number);
  }
}

template <typename Stored, typename Value>
void gather(const char* from, std::uint64_t count, std::uint64_t stride, bool swapped, Value* to) {
  if (sizeof(Stored) > 1 && swapped)
    gather<Stored, true>(from, count, stride, to);
  else if (stride == sizeof(Stored))
    gather<Stored, false>(from, count, sizeof(Stored), to);
  else
    gather<Stored, false>(from, count, stride, to);
}

template <typename Value>
void gather_24(const char* from, std::uint64_t count, std::uint64_t stride, bool big_endian,
               Value* to) {
  for (std::uint64_t i = 0; i < count; ++i, from += stride) {
    const auto byte = [&](int k) {
      return static_cast<std::uint32_t>(static_cast<unsigned char>(from[big_endian ? 2 - k : k]));
    };
    const std::uint32_t bits = byte(0) << 8 | byte(1) << 16 | byte(2) << 24;
    to[i] = static_cast<Value>(static_cast<std::int32_t>(bits) >> 8);
  }
}

}  // namespace

template <typename Value>
void convert_numbers(NumberKind kind, bool big_endian, const char* from, std::uint64_t count,
                     std::uint64_t stride, Value* to) {
  const bool swapped = big_endian != (std::endian::native == std::endian::big);
  switch (kind) {
    case NumberKind::i8:
      return gather<std::int8_t>(from, count, stride, swapped, to);
    case NumberKind::u8:
      return gather<std::uint8_t>(from, count, stride, swapped, to);
    case NumberKind::i16:
      return gather<std::int16_t>(from, count, stride, swapped, to);
    case NumberKind::u16:
      return gather<std::uint16_t>(from, count, stride, swapped, to);
    case NumberKind::i24:
      return gather_24(from, count, stride, big_endian, to);
    case NumberKind::i32:
      return gather<std::int32_t>(from, count, stride, swapped, to);
    case NumberKind::u32:
      return gather<std::uint32_t>(from, count, stride, swapped, to);
    case NumberKind::i64:
      return gather<std::int64_t>(from, count, stride, swapped, to);
    case NumberKind::u64:
      return gather<std::uint64_t>(from, count, stride, swapped, to);
    case NumberKind::f32:
      return gather<float>(from, count, stride, swapped, to);
    case NumberKind::f64:
      return gather<double>(from, count, stride, swapped, to);
  }
}

template void convert_numbers(NumberKind, bool, const char*, std::uint64_t, std::uint64_t, double*);
template void convert_numbers(NumberKind, bool, const char*, std::uint64_t, std::uint64_t, float*);
template void convert_numbers(NumberKind, bool, const char*, std::uint64_t, std::uint64_t,
                              std::int16_t*);
template void convert_numbers(NumberKind, bool, const char*, std::uint64_t, std::uint64_t,
                              std::int32_t*);

namespace {

/// Bytes looked at through a window at once: a part of the processor's second cache.
constexpr std::uint64_t window_bytes = std::uint64_t{1} << 18;

template <typename Value>
constexpr NumberKind own_kind = NumberKind::f64;
template <>
constexpr NumberKind own_kind<float> = NumberKind::f32;
template <>
constexpr NumberKind own_kind<std::int16_t> = NumberKind::i16;
template <>
constexpr NumberKind own_kind<std::int32_t> = NumberKind::i32;

/// A piece of a file in memory, which channels that lie interleaved look at one after another.
class FileWindow {
 public:
  explicit FileWindow(const MappedFile& file) : file_(file) {}

  const MappedFile& file() const { return file_; }

  /// `count` bytes at `offset`; where they have to be fetched, `margin` more on both sides.
  const char* view(std::uint64_t offset, std::uint64_t count, std::uint64_t margin) {
    if (offset < first_ || offset + count > first_ + held_) {
      first_ = offset - std::min(offset, margin);
      const std::uint64_t end =
          std::min<std::uint64_t>(offset + count + margin, file_.bytes().size());
      held_ = end - first_;
      if (bytes_.size() < held_) bytes_.resize(held_);
      file_.copy(first_, held_, bytes_.data());
    }
    return bytes_.data() + (offset - first_);
  }

  /// Rows of numbers that are all wanted are taken apart at once, which the processor does several
  /// numbers at a time.
  void expect_rows_of(std::uint64_t numbers) { wanted_in_row_ = numbers; }

  /// Numbers of a run from `offset` on that lie side by side, since their rows have been taken
  /// apart; null where they have not been.
  const char* column(std::uint64_t offset, std::uint64_t count, std::uint64_t stride,
                     std::size_t width) {
    const std::uint64_t columns = stride / width;
    if (columns < 2 || columns > 2 * wanted_in_row_ || stride % width != 0 ||
        !can_take_apart(width))
      return nullptr;
    if (const char* const there = taken(offset, count, stride, width)) return there;
    // the first of a row's numbers takes all apart; those it did not take, of another size or
    // another order, are read one by one
    const bool in_these_rows =
        offset + stride > apart_first_ && offset < apart_first_ + apart_rows_ * stride_;
    if (in_these_rows || (file_.bytes().size() - offset) / stride < count) return nullptr;
    const char* const here = view(offset, count * stride, 0);
    apart_first_ = offset;
    apart_rows_ = count;
    stride_ = stride;
    width_ = width;
    // not a power of two apart, where columns would push each other out of the cache
    pitch_ = (count * width + 63) / 64 * 64 + 64;
    if (apart_.size() < columns * pitch_) apart_.resize(columns * pitch_);
    take_apart(here, count, columns, width, apart_.data(), pitch_);
    return apart_.data();
  }

 private:
  const char* taken(std::uint64_t offset, std::uint64_t count, std::uint64_t stride,
                    std::size_t width) const {
    if (stride != stride_ || width != width_ || offset < apart_first_) return nullptr;
    const std::uint64_t row = (offset - apart_first_) / stride;
    const std::uint64_t in_row = (offset - apart_first_) % stride;
    if (in_row % width != 0 || row + count > apart_rows_) return nullptr;
    return apart_.data() + in_row / width * pitch_ + row * width;
  }

  const MappedFile& file_;
  std::uint64_t first_ = 0;
  std::uint64_t held_ = 0;
  std::vector<char> bytes_;
  std::uint64_t wanted_in_row_ = 0;
  std::uint64_t apart_first_ = 0;  // what was taken apart last
  std::uint64_t apart_rows_ = 0;
  std::uint64_t stride_ = 0;
  std::size_t width_ = 0;
  std::uint64_t pitch_ = 0;  // from column to column
  std::vector<char> apart_;  // column after column
};

/// Walks along the numbers of a channel.
class NumberCursor {
 public:
  NumberCursor(FileWindow& window, const StoredNumbers& numbers)
      : window_(&window),
        numbers_(&numbers) {}

  void skip(std::uint64_t count) {
    while (count > 0) {
      const NumberRun& run = numbers_->runs()[run_];
      if (at_ == 0 && repeat_ == 0 && count >= run.count * run.repeats) {
        count -= run.count * run.repeats;
        ++run_;
        continue;
      }
      if (at_ == 0 && count >= run.count) {
        const std::uint64_t whole = std::min(count / run.count, run.repeats - repeat_);
        count -= whole * run.count;
        advance_repeats(whole);
        continue;
      }
      const std::uint64_t step = std::min(count, run.count - at_);
      count -= step;
      advance(step);
    }
  }

  /// The next numbers where they lie in memory as they are already, until the window is moved; null
  /// where they do not.
  template <typename Value>
  const Value* in_place(std::uint64_t count) {
    const NumberRun& run = numbers_->runs()[run_];
    const bool own = numbers_->kind() == own_kind<Value> &&
                     big_endian(run) == (std::endian::native == std::endian::big);
    if (!own || run.stride == sizeof(Value) || count > run.count - at_ ||
        count > window_bytes / std::max<std::uint64_t>(run.stride, 1))
      return nullptr;
    const char* const there = window_->column(offset(), count, run.stride, sizeof(Value));
    if (there != nullptr) advance(count);
    return reinterpret_cast<const Value*>(there);
  }

  template <typename Value>
  void read(std::uint64_t count, Value* to) {
    while (count > 0) {
      const NumberRun& run = numbers_->runs()[run_];
      std::uint64_t step = std::min(count, run.count - at_);
      if (is_own<Value>(run)) {
        window_->file().copy(offset(), step * sizeof(Value), to);
      } else {
        step = std::min(step, std::max<std::uint64_t>(
                                  window_bytes / std::max<std::uint64_t>(run.stride, 1), 1));
        const std::size_t width = size_of(numbers_->kind());
        std::uint64_t stride = width;
        const char* here = window_->column(offset(), step, run.stride, width);
        if (here == nullptr) {
          here = window_->view(offset(), (step - 1) * run.stride + width, run.stride);
          stride = run.stride;
        }
        convert_numbers(numbers_->kind(), big_endian(run), here, step, stride, to);
      }
      to += step;
      count -= step;
      advance(step);
    }
  }

 private:
  std::uint64_t offset() const {
    const NumberRun& run = numbers_->runs()[run_];
    return run.offset + repeat_ * run.period + at_ * run.stride;
  }

  bool big_endian(const NumberRun& run) const { return numbers_->big_endian() != run.other_order; }

  /// True where the file holds the machine's own numbers side by side.
  template <typename Value>
  bool is_own(const NumberRun& run) const {
    return numbers_->kind() == own_kind<Value> && run.stride == sizeof(Value) &&
           big_endian(run) == (std::endian::native == std::endian::big);
  }

  void advance(std::uint64_t count) {
    at_ += count;
    if (at_ < numbers_->runs()[run_].count) return;
    at_ = 0;
    advance_repeats(1);
  }

  void advance_repeats(std::uint64_t count) {
    repeat_ += count;
    if (repeat_ < numbers_->runs()[run_].repeats) return;
    repeat_ = 0;
    ++run_;
  }

  FileWindow* window_;
  const StoredNumbers* numbers_;
  std::size_t run_ = 0;
  std::uint64_t repeat_ = 0;
  std::uint64_t at_ = 0;
};

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
    if (channel.imaginary.size() > 0) imaginary_.skip(range.first);
    if (channel.invalid.size() > 0) invalid_.skip(range.first);
    if (channel.times.size() > 0) times_.skip(range.first);
  }

  bool done() const { return left_ == 0; }

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
    if (channel_->scaling) {
      read(samples_, count, doubles_);
      channel_->scaling(doubles_);
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
        return read_samples(count, doubles_);
      case NumberKind::u32:
      case NumberKind::i64:
      case NumberKind::u64:
        return read_samples(count, doubles_);
    }
    return read(samples_, count, doubles_);
  }

  const StoredChannel* channel_;
  NumberCursor samples_;
  NumberCursor imaginary_;
  NumberCursor invalid_;
  NumberCursor times_;
  std::uint64_t left_;
  std::vector<double> doubles_;
  std::vector<float> floats_;
  std::vector<std::int16_t> shorts_;
  std::vector<std::int32_t> integers_;
  std::vector<double> imaginary_values_;
  std::vector<double> mark_values_;
  std::vector<std::uint8_t> valid_;
  std::vector<double> time_values_;
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
      block.resize(std::min(block_size, times.size() - i));
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

/// Times looked at when a recording is opened.
constexpr std::uint64_t most_times = std::uint64_t{1} << 20;

}  // namespace

void read_numbers(const MappedFile& file, const StoredNumbers& numbers, std::uint64_t first,
                  std::span<double> to) {
  if (to.empty()) return;
  FileWindow window(file);
  NumberCursor cursor(window, numbers);
  cursor.skip(first);
  cursor.read(to.size(), to.data());
}

std::string set_stored_times(const MappedFile& file, const StoredNumbers& times,
                             const std::function<void(std::span<double>)>& times_scaling,
                             datasets::SampleClock& clock, StoredChannel& channel) {
  const std::uint64_t n = times.size();
  if (n == 0) return {};
  std::string warning;
  if (n <= most_times) {
    std::vector<double> all(n);
    read_numbers(file, times, 0, all);
    if (times_scaling) times_scaling(all);
    TimeAxis axis = time_axis(std::move(all));
    clock.start = axis.clock.start;
    clock.interval = axis.clock.interval;
    if (n == 1 || axis.clock.uniform()) return axis.warning;
    warning = axis.warning;
  } else {
    std::array<double, 2> ends{};
    read_numbers(file, times, 0, std::span(ends).first(1));
    read_numbers(file, times, n - 1, std::span(ends).last(1));
    if (times_scaling) times_scaling(ends);
    clock.start = ends[0];
    clock.interval = (ends[1] - ends[0]) / static_cast<double>(n - 1);
  }
  channel.times = times;
  channel.times_scaling = times_scaling;
  return warning;
}

std::unique_ptr<RecordingReader> reader_of_numbers(std::unique_ptr<MappedFile> file, Record record,
                                                   std::vector<StoredChannel> channels) {
  return std::make_unique<NumbersReader>(std::move(file), std::move(record), std::move(channels));
}

}  // namespace impactrig::acquisition
