// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "acquisition/importers/padding.hpp"
#include "acquisition/recording_reader.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// What holds for samples of every format, on their way. Samples that are infinite or not a number
/// cannot be used: they are marked.
class CheckedSamples final : public SampleSink {
 public:
  /// `ranges`: the samples of each channel that go on; none: all, with their times.
  CheckedSamples(std::size_t channels, std::vector<SampleRange> ranges, SampleSink& next);

  void take(std::size_t index, const SampleBlock& whole) override;
  void take_times(std::size_t index, std::span<const double> times) override;

  bool any(std::size_t index) const { return marks_[index].samples > 0; }

  /// Adds warnings of what was marked, and of zeros that look like padding.
  void tell(datasets::Record& record) const;

 private:
  struct Marks {
    std::uint64_t samples = 0;
    std::uint64_t found = 0;
    std::uint64_t first = 0;
    PaddingCheck padding{};
  };

  template <typename Sample>
  void mark(std::span<const Sample> samples, const SampleBlock& block, Marks& marks);

  std::vector<Marks> marks_;
  std::vector<std::uint64_t> seen_;
  std::vector<SampleRange> ranges_;
  SampleSink& next_;
  std::vector<std::uint8_t> valid_;
};

}  // namespace impactrig::acquisition
