// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/number_cursor.hpp"

#include "acquisition/importers/take_apart.hpp"

namespace impactrig::acquisition {

const char* FileWindow::view(std::uint64_t offset, std::uint64_t count, std::uint64_t margin) {
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

const char* FileWindow::column(std::uint64_t offset, std::uint64_t count, std::uint64_t stride,
                               std::size_t width) {
  const std::uint64_t columns = stride / width;
  if (columns < 2 || columns > 2 * wanted_in_row_ || stride % width != 0 || !can_take_apart(width))
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

const char* FileWindow::taken(std::uint64_t offset, std::uint64_t count, std::uint64_t stride,
                              std::size_t width) const {
  if (stride != stride_ || width != width_ || offset < apart_first_) return nullptr;
  const std::uint64_t row = (offset - apart_first_) / stride;
  const std::uint64_t in_row = (offset - apart_first_) % stride;
  if (in_row % width != 0 || row + count > apart_rows_) return nullptr;
  return apart_.data() + in_row / width * pitch_ + row * width;
}

void NumberCursor::skip(std::uint64_t count) {
  if (numbers_->ramp()) {
    at_ += count;
    return;
  }
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

}  // namespace impactrig::acquisition
