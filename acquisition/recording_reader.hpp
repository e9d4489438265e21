// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// Samples of one channel that follow each other, as the file holds them; what they mean is the
/// channel's `scale` and `offset`. All that is not empty has the length of `raw`.
struct SampleBlock {
  datasets::RawSpan raw;
  std::span<const double> imaginary{};    ///< of a complex channel
  std::span<const std::uint8_t> valid{};  ///< 1 sound, 0 not; empty: all sound

  std::size_t size() const;
};

/// Where samples go as they are read.
class SampleSink {
 public:
  virtual ~SampleSink() = default;
  /// The next samples of a channel; `channel` counts the channels that were asked for, from 0. A
  /// channel's blocks come in order and are of one type; blocks of channels may alternate. What
  /// `block` points to lives until the return.
  virtual void take(std::size_t channel, const SampleBlock& block) = 0;
  /// The next stated times [s] of a channel whose clock is not uniform, in order, one a sample in
  /// the end; they may come before, between or after the blocks.
  virtual void take_times(std::size_t channel, std::span<const double> times) = 0;
};

/// What of a recording is asked for.
struct Selection {
  std::vector<std::size_t> channels;  ///< of the head, in the order wanted; empty: all
  double from = -std::numeric_limits<double>::infinity();  ///< time of the first sample [s]
  double to = std::numeric_limits<double>::infinity();     ///< of the last [s], inclusive

  bool has_window() const;
};

/// What a recording says before its samples are read.
struct RecordingHead {
  datasets::Record record;             ///< channels without samples
  std::vector<std::uint64_t> samples;  ///< one a channel
  bool counted = true;  ///< false: `samples` and the clocks are estimates from the first and last
                        ///< rows of a text that was not read through
};

/// A recording, opened: its head is read, its samples are read when asked for, in blocks, so that
/// memory does not grow with the file.
class RecordingReader {
 public:
  virtual ~RecordingReader() = default;

  virtual const RecordingHead& head() const = 0;

  /// Hands the samples asked for to `sink`. Returns the record of these channels, without samples:
  /// clocks begin at the first sample handed over, and warnings tell what only reading could.
  /// Throws datasets::InputError.
  virtual datasets::Record read(const Selection& wanted, SampleSink& sink) = 0;
};

/// A run of samples, [first, last).
struct SampleRange {
  std::uint64_t first = 0;
  std::uint64_t last = 0;
};

/// The samples of a uniform clock that lie in wanted's window. A clock without interval (no time
/// information, or a spectrum) has them all.
SampleRange samples_within(const datasets::SampleClock& clock, std::uint64_t samples,
                           const Selection& wanted);

/// Finds the samples of a window among stated times that come piece by piece. Times that go back
/// are not cut.
class TimeWindow {
 public:
  explicit TimeWindow(const Selection& wanted) : wanted_(wanted) {}

  void add(std::span<const double> times);

  SampleRange range() const;

  /// Makes a clock that of these samples: start and mean step.
  void settle(datasets::SampleClock& clock) const;

 private:
  const Selection& wanted_;
  std::uint64_t seen_ = 0;
  double before_ = -std::numeric_limits<double>::infinity();
  bool increasing_ = true;
  bool inside_ = false;
  SampleRange range_{};
  double first_ = 0.0;  // times of the range's ends
  double last_ = 0.0;
};

/// The channels asked for, by index. Throws std::invalid_argument for one that is not there.
std::vector<std::size_t> selected_channels(const RecordingHead& head, const Selection& wanted);

/// A recording that is in memory already: what an importer makes that reads small files whole.
std::unique_ptr<RecordingReader> reader_of(datasets::Record record);

/// A head without samples: read() throws std::logic_error.
std::unique_ptr<RecordingReader> reader_of_head(RecordingHead head);

/// As reader.read(). Of an uneven clock the times of a window are judged by themselves: where they
/// are evenly spaced, the clock is uniform, and a warning says so.
datasets::Record read_window(RecordingReader& reader, const Selection& wanted, SampleSink& sink);

/// Reads what is asked for into memory, by read_window().
datasets::Record read_into_memory(RecordingReader& reader, const Selection& wanted = {});

}  // namespace impactrig::acquisition
