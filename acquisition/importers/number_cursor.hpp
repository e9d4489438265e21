// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "acquisition/importers/mapped_file.hpp"
#include "acquisition/importers/stored_numbers.hpp"

namespace impactrig::acquisition {

/// Numbers of a channel read at once, at most: they stay in the processor's cache.
constexpr std::uint64_t numbers_at_once = 32768;

/// Bytes looked at through a window at once: a part of the processor's second cache.
constexpr std::uint64_t window_bytes = std::uint64_t{1} << 18;

template <typename Value>
inline constexpr NumberKind own_kind = NumberKind::f64;
template <>
inline constexpr NumberKind own_kind<float> = NumberKind::f32;
template <>
inline constexpr NumberKind own_kind<std::int16_t> = NumberKind::i16;
template <>
inline constexpr NumberKind own_kind<std::int32_t> = NumberKind::i32;

/// A piece of a file in memory, which channels that lie interleaved look at one after another.
class FileWindow {
 public:
  explicit FileWindow(const MappedFile& file) : file_(file) {}

  const MappedFile& file() const { return file_; }

  /// `count` bytes at `offset`; where they have to be fetched, `margin` more on both sides.
  const char* view(std::uint64_t offset, std::uint64_t count, std::uint64_t margin);

  /// Rows of numbers that are all wanted are taken apart at once, which the processor does several
  /// numbers at a time.
  void expect_rows_of(std::uint64_t numbers) { wanted_in_row_ = numbers; }

  /// Numbers of a run from `offset` on that lie side by side, since their rows have been taken
  /// apart; null where they have not been.
  const char* column(std::uint64_t offset, std::uint64_t count, std::uint64_t stride,
                     std::size_t width);

 private:
  const char* taken(std::uint64_t offset, std::uint64_t count, std::uint64_t stride,
                    std::size_t width) const;

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

  void skip(std::uint64_t count);

  /// The next numbers where they lie in memory as they are already, until the window is moved; null
  /// where they do not.
  template <typename Value>
  const Value* in_place(std::uint64_t count) {
    if (numbers_->ramp()) return nullptr;
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
    if (numbers_->ramp()) {
      for (std::uint64_t i = 0; i < count; ++i, ++at_)
        to[i] = static_cast<Value>(numbers_->ramp()->first +
                                   numbers_->ramp()->step * static_cast<double>(at_));
      return;
    }
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
          // numbers of other channels lie between these, and are looked at next
          const std::uint64_t margin = run.stride > width ? run.stride : 0;
          here = window_->view(offset(), (step - 1) * run.stride + width, margin);
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

}  // namespace impactrig::acquisition
