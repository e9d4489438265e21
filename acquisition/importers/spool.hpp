// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "acquisition/importers/mapped_file.hpp"
#include "acquisition/importers/stored_numbers.hpp"

namespace impactrig::acquisition {

/// Opens a file without a name, which goes when it is closed, in the folder that the environment's
/// TMPDIR names, else in /var/tmp, else in /tmp. Throws datasets::FileError, about `of`, when none
/// can be made.
int open_unnamed_file(const std::string& of);

/// Throws the datasets::FileError that says why (`error`, an errno) what is too large for memory
/// cannot be kept in such a file.
[[noreturn]] void refuse_to_keep(const std::string& of, int error);

/// What memory would not hold, kept on the disk in a file without a name.
class Spool {
 public:
  /// `of` is the file whose content is kept, for errors. Throws datasets::FileError, as every
  /// function here, when nothing can be kept.
  explicit Spool(std::string of);
  ~Spool();
  Spool(const Spool&) = delete;
  Spool& operator=(const Spool&) = delete;

  /// Returns the place of the first byte.
  std::uint64_t append(std::string_view bytes);

  void read(std::uint64_t place, std::size_t count, void* to) const;

  /// All that is kept, as a file of the name given to the constructor. It may outlive the spool.
  std::unique_ptr<MappedFile> map() const;

 private:
  [[noreturn]] void fail_to_read() const;

  std::string of_;
  int file_ = -1;
  std::uint64_t size_ = 0;
};

/// How a spool holds numbers of this type.
template <typename Number>
constexpr NumberKind spooled_kind() {
  if constexpr (std::is_same_v<Number, double>) return NumberKind::f64;
  if constexpr (std::is_same_v<Number, float>) return NumberKind::f32;
  if constexpr (std::is_same_v<Number, std::int16_t>) return NumberKind::i16;
  if constexpr (std::is_same_v<Number, std::int32_t>) return NumberKind::i32;
  if constexpr (std::is_same_v<Number, std::uint8_t>) return NumberKind::u8;
}

/// Numbers in their order: in a spool but for the last ones, or, without a spool, in memory.
template <typename Number>
class NumberList {
 public:
  NumberList() = default;

  /// `spool` must live as long; null: in memory.
  explicit NumberList(Spool* spool) : spool_(spool) {}

  bool empty() const { return size() == 0; }

  std::uint64_t size() const { return kept_.size() + tail_.size(); }

  Number front() const {
    if (kept_.size() == 0) return tail_.front();
    return kept(kept_.runs().front().offset);
  }

  Number back() const {
    if (!tail_.empty()) return tail_.back();
    const NumberRun& last = kept_.runs().back();
    return kept(last.offset + last.period * (last.repeats - 1) + (last.count - 1) * sizeof(Number));
  }

  void push_back(Number value) {
    tail_.push_back(value);
    if (spool_ != nullptr && tail_.size() >= at_once) settle();
  }

  void append(std::span<const Number> values) {
    tail_.insert(tail_.end(), values.begin(), values.end());
    if (spool_ != nullptr && tail_.size() >= at_once) settle();
  }

  /// The same number, so often.
  void append(std::uint64_t count, Number value) {
    for (; spool_ != nullptr && count > at_once; count -= at_once) {
      tail_.insert(tail_.end(), at_once, value);
      settle();
    }
    tail_.insert(tail_.end(), static_cast<std::size_t>(count), value);
  }

  /// Another list of the same spool.
  void append(NumberList&& next) {
    if (spool_ == nullptr) return append(std::span<const Number>(next.tail_));
    settle();
    next.settle();
    for (const NumberRun& run : next.kept_.runs()) kept_.add(run);
  }

  /// The first `count` of these.
  NumberList first(std::uint64_t count) {
    NumberList list(spool_);
    if (spool_ == nullptr)
      list.append(std::span<const Number>(tail_).first(static_cast<std::size_t>(count)));
    else
      list.kept_ = stored().first(count);
    return list;
  }

  /// Nothing stays in memory where there is a spool.
  void settle() {
    if (spool_ == nullptr || tail_.empty()) return;
    const std::string_view bytes(reinterpret_cast<const char*>(tail_.data()),
                                 tail_.size() * sizeof(Number));
    kept_.add({spool_->append(bytes), tail_.size(), sizeof(Number), 1, 0, false});
    tail_ = {};
  }

  /// Hands all to `use`, in pieces.
  template <typename Use>
  void each(const Use& use) const {
    std::vector<Number> piece;
    for (const NumberRun& run : kept_.runs())
      for (std::uint64_t i = 0; i < run.repeats; ++i)
        for (std::uint64_t first = 0; first < run.count; first += piece.size()) {
          piece.resize(
              static_cast<std::size_t>(std::min<std::uint64_t>(at_once, run.count - first)));
          spool_->read(run.offset + i * run.period + first * sizeof(Number),
                       piece.size() * sizeof(Number), piece.data());
          use(std::span<const Number>(piece));
        }
    if (!tail_.empty()) use(std::span<const Number>(tail_));
  }

  /// Where they lie in the spool.
  StoredNumbers stored() {
    settle();
    return kept_;
  }

  /// Of a list in memory.
  std::vector<Number> take() { return std::exchange(tail_, {}); }

 private:
  static constexpr std::size_t at_once = 4096;

  Number kept(std::uint64_t place) const {
    Number value{};
    spool_->read(place, sizeof value, &value);
    return value;
  }

  Spool* spool_ = nullptr;
  StoredNumbers kept_{spooled_kind<Number>(), std::endian::native == std::endian::big};
  std::vector<Number> tail_;
};

}  // namespace impactrig::acquisition
