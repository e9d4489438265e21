// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "acquisition/importers/mapped_file.hpp"
#include "acquisition/recording_reader.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// How a number lies in a file.
enum class NumberKind { i8, u8, i16, u16, i24, i32, u32, i64, u64, f32, f64 };

std::size_t size_of(NumberKind kind);  ///< [bytes]

/// Numbers at equal distances; the whole may repeat at equal distances, as in chunks.
struct NumberRun {
  std::uint64_t offset = 0;   ///< of the first number, from the start of the file
  std::uint64_t count = 0;    ///< numbers of one repetition
  std::uint64_t stride = 0;   ///< from one number to the next [bytes]
  std::uint64_t repeats = 1;  ///< > 0
  std::uint64_t period = 0;   ///< from one repetition to the next [bytes]
  bool other_order = false;   ///< true: in the other byte order than StoredNumbers::big_endian says
};

/// Number i is first + i step.
struct NumberRamp {
  double first = 0.0;
  double step = 0.0;
};

/// Where the numbers of a channel lie in a binary file, in their order.
class StoredNumbers {
 public:
  StoredNumbers() = default;

  explicit StoredNumbers(NumberKind kind, bool big_endian = false)
      : kind_(kind),
        big_endian_(big_endian) {}

  /// Numbers that a head states by their course, and no file holds.
  StoredNumbers(NumberRamp ramp, std::uint64_t count) : size_(count), ramp_(ramp) {}

  /// A run that continues the pattern of the one before becomes a repetition of it, so that a file
  /// of a million equal chunks takes no memory.
  void add(const NumberRun& run);

  NumberKind kind() const { return kind_; }

  bool big_endian() const { return big_endian_; }

  std::uint64_t size() const { return size_; }

  const std::vector<NumberRun>& runs() const { return runs_; }

  const std::optional<NumberRamp>& ramp() const { return ramp_; }

  /// The first `count` of these.
  StoredNumbers first(std::uint64_t count) const;

 private:
  NumberKind kind_ = NumberKind::f64;
  bool big_endian_ = false;
  std::uint64_t size_ = 0;
  std::vector<NumberRun> runs_;
  std::optional<NumberRamp> ramp_{};  // in place of runs_
};

/// How many numbers of a run that begins at `offset` the file holds whole, `announced` at most.
std::uint64_t numbers_there(const MappedFile& file, std::uint64_t offset, std::uint64_t stride,
                            NumberKind kind, std::uint64_t announced);

/// Where a channel's samples lie.
struct StoredChannel {
  StoredNumbers samples;
  StoredNumbers imaginary{};  ///< of a complex channel: as many as samples; else none
  StoredNumbers invalid{};    ///< of a channel with marks: 0 sound, else not; as many as samples
  /// Makes 0 of a mark that means sound, of others anything else; none: as is.
  std::function<void(std::span<double>)> invalid_meaning{};
  StoredNumbers times{};  ///< [s], where the clock is not uniform: as many as samples; else none
  /// What the file does to its numbers beyond Channel::scale and offset (a polynomial, a table).
  /// Where it is set, samples are handed over in double precision and changed by it.
  std::function<void(std::span<double>)> scaling{};
  std::function<void(std::span<double>)>
      times_scaling{};  ///< makes seconds of `times`; none: as is
  /// Numbers of further signals that `joining` makes one with the samples, before `scaling` (the
  /// cold junction of a thermocouple): as many as samples each.
  std::vector<StoredNumbers> others{};
  std::function<void(std::span<double>, std::span<const std::vector<double>>)> joining{};
};

/// Reads numbers, from the one with index `first` on, as many as `to` takes.
void read_numbers(const MappedFile& file, const StoredNumbers& numbers, std::uint64_t first,
                  std::span<double> to);

/// Hands `count` of them, from the one with index `first` on, to `use`, in pieces and in their
/// order.
void each_number(const MappedFile& file, const StoredNumbers& numbers, std::uint64_t first,
                 std::uint64_t count, const std::function<void(std::span<const double>)>& use);

/// All of them.
void each_number(const MappedFile& file, const StoredNumbers& numbers,
                 const std::function<void(std::span<const double>)>& use);

/// Converts numbers that lie in memory at a distance of `stride` bytes. Value is double, float,
/// std::int32_t or std::int16_t and holds the kind.
template <typename Value>
void convert_numbers(NumberKind kind, bool big_endian, const char* from, std::uint64_t count,
                     std::uint64_t stride, Value* to);

/// Gives a channel the clock that a channel of times stands for: uniform where they are so few that
/// they can be looked at now (a million) and even; else every time is read with its sample. Returns
/// a sentence for the user where that needs one.
std::string set_stored_times(const MappedFile& file, const StoredNumbers& times,
                             const std::function<void(std::span<double>)>& times_scaling,
                             datasets::SampleClock& clock, StoredChannel& channel);

/// Reads numbers as they lie in a file: by blocks, only what is asked for, without a conversion
/// where the machine's own numbers lie side by side. `record` has one channel a StoredChannel,
/// without samples. Integers of 8 bits become 16, those of 16 without sign and of 24 become 32,
/// wider ones double (exact up to 2^53). Throws datasets::InputError when numbers lie outside of
/// the file.
std::unique_ptr<RecordingReader> reader_of_numbers(std::unique_ptr<MappedFile> file,
                                                   datasets::Record record,
                                                   std::vector<StoredChannel> channels);

}  // namespace impactrig::acquisition
