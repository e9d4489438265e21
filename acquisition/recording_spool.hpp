// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "acquisition/importers/spool.hpp"
#include "acquisition/importers/stored_numbers.hpp"
#include "acquisition/recording_reader.hpp"

namespace impactrig::acquisition {

/// Samples that lie on the disk, in a file without a name that goes with this.
struct SpooledRecording {
  std::unique_ptr<MappedFile> file;
  std::vector<StoredChannel> channels;
};

/// Takes the samples of a recording to the disk, for what needs to know how many they are, or needs
/// all channels at a time.
class RecordingSpool final : public SampleSink {
 public:
  /// `of` is the file that errors name. Throws datasets::FileError, as take() and take_times() do,
  /// when the disk is full.
  RecordingSpool(std::string of, std::size_t channels);

  void take(std::size_t channel, const SampleBlock& block) override;
  void take_times(std::size_t channel, std::span<const double> times) override;

  /// Samples of a channel up to its last sound one.
  std::uint64_t sound_end(std::size_t channel) const { return channels_[channel].sound_end; }

  /// Samples of a channel that are not sound.
  std::uint64_t unsound(std::size_t channel) const { return channels_[channel].unsound; }

  /// What was taken; no more is.
  SpooledRecording finish();

 private:
  using Raw = std::variant<NumberList<double>, NumberList<float>, NumberList<std::int16_t>,
                           NumberList<std::int32_t>>;

  struct Lists {
    Raw raw;
    NumberList<double> imaginary;
    NumberList<std::uint8_t> invalid;
    NumberList<double> times;
    std::uint64_t samples = 0;
    std::uint64_t sound_end = 0;
    std::uint64_t unsound = 0;
  };

  void take_marks(Lists& lists, const SampleBlock& block);

  Spool spool_;
  std::vector<Lists> channels_;
};

}  // namespace impactrig::acquisition
