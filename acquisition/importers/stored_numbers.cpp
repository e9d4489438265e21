// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/stored_numbers.hpp"

#include <algorithm>
#include <array>

#include "acquisition/importers/number_cursor.hpp"
#include "acquisition/importers/time_axis.hpp"

namespace impactrig::acquisition {

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

StoredNumbers StoredNumbers::first(std::uint64_t count) const {
  if (ramp_) return StoredNumbers(*ramp_, std::min(count, size_));
  StoredNumbers part(kind_, big_endian_);
  for (NumberRun run : runs_) {
    const std::uint64_t whole = std::min(run.repeats, count / run.count);
    const std::uint64_t rest = whole < run.repeats ? count - whole * run.count : 0;
    count -= whole * run.count + rest;
    const std::uint64_t next = run.offset + whole * run.period;
    run.repeats = whole;
    if (whole > 0) part.add(run);
    run.offset = next;
    run.count = rest;
    run.repeats = 1;
    part.add(run);  // nothing where it is empty
    if (count == 0) break;
  }
  return part;
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

void each_number(const MappedFile& file, const StoredNumbers& numbers, std::uint64_t first,
                 std::uint64_t count, const std::function<void(std::span<const double>)>& use) {
  FileWindow window(file);
  NumberCursor cursor(window, numbers);
  cursor.skip(first);
  std::vector<double> block;
  for (std::uint64_t i = 0; i < count; i += block.size()) {
    block.resize(std::min<std::uint64_t>(numbers_at_once, count - i));
    cursor.read(block.size(), block.data());
    use(block);
  }
}

void each_number(const MappedFile& file, const StoredNumbers& numbers,
                 const std::function<void(std::span<const double>)>& use) {
  each_number(file, numbers, 0, numbers.size(), use);
}

std::string set_stored_times(const MappedFile& file, const StoredNumbers& times,
                             const std::function<void(std::span<double>)>& times_scaling,
                             datasets::SampleClock& clock, StoredChannel& channel) {
  const std::uint64_t n = times.size();
  if (n == 0) return {};
  std::string warning;
  if (times.ramp() && times.ramp()->step > 0.0) {
    std::array<double, 2> course{times.ramp()->first, times.ramp()->step + times.ramp()->first};
    if (times_scaling) times_scaling(course);
    clock.start = course[0];
    clock.interval = times_scaling ? course[1] - course[0] : times.ramp()->step;
    return {};
  }
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

}  // namespace impactrig::acquisition
