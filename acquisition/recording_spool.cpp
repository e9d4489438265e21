// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/recording_spool.hpp"

#include <algorithm>

namespace impactrig::acquisition {

RecordingSpool::RecordingSpool(std::string of, std::size_t channels) : spool_(std::move(of)) {
  for (std::size_t i = 0; i < channels; ++i)
    channels_.push_back({NumberList<double>(&spool_), NumberList<double>(&spool_),
                         NumberList<std::uint8_t>(&spool_), NumberList<double>(&spool_)});
}

void RecordingSpool::take(std::size_t channel, const SampleBlock& block) {
  Lists& lists = channels_[channel];
  if (block.size() == 0) return;
  std::visit(
      [&]<typename Number>(std::span<const Number> samples) {
        using List = NumberList<Number>;
        if (lists.samples == 0) lists.raw = List(&spool_);
        std::get<List>(lists.raw).append(samples);
      },
      block.raw);
  lists.imaginary.append(block.imaginary);
  take_marks(lists, block);
  lists.samples += block.size();
}

void RecordingSpool::take_marks(Lists& lists, const SampleBlock& block) {
  if (lists.invalid.empty() && !block.valid.empty()) lists.invalid.append(lists.samples, 0);
  if (block.valid.empty()) {
    if (!lists.invalid.empty()) lists.invalid.append(block.size(), 0);
    lists.sound_end = lists.samples + block.size();
    return;
  }
  for (std::size_t i = 0; i < block.valid.size(); ++i) {
    const bool sound = block.valid[i] != 0;
    lists.invalid.push_back(sound ? 0 : 1);
    if (sound)
      lists.sound_end = lists.samples + i + 1;
    else
      ++lists.unsound;
  }
}

void RecordingSpool::take_times(std::size_t channel, std::span<const double> times) {
  channels_[channel].times.append(times);
}

SpooledRecording RecordingSpool::finish() {
  SpooledRecording all;
  for (Lists& lists : channels_) {
    StoredChannel stored;
    stored.samples = std::visit([](auto& list) { return list.stored(); }, lists.raw);
    stored.imaginary = lists.imaginary.stored();
    stored.invalid = lists.invalid.stored();
    stored.times = lists.times.stored();
    all.channels.push_back(std::move(stored));
  }
  all.file = spool_.map();
  return all;
}

}  // namespace impactrig::acquisition
