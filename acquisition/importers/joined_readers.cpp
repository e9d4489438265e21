// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/joined_readers.hpp"

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

namespace impactrig::acquisition {

using datasets::Record;

namespace {

/// Hands on what one reader gives, under the numbers that its channels have among all.
class PartOfSink final : public SampleSink {
 public:
  PartOfSink(SampleSink& whole, std::vector<std::size_t> places)
      : whole_(whole),
        places_(std::move(places)) {}

  void take(std::size_t channel, const SampleBlock& block) override {
    whole_.take(places_[channel], block);
  }

  void take_times(std::size_t channel, std::span<const double> times) override {
    whole_.take_times(places_[channel], times);
  }

 private:
  SampleSink& whole_;
  std::vector<std::size_t> places_;
};

void say_once(const std::vector<std::string>& warnings, Record& record) {
  for (const std::string& warning : warnings)
    if (std::ranges::find(record.warnings, warning) == record.warnings.end())
      record.warnings.push_back(warning);
}

class JoinedReaders final : public RecordingReader {
 public:
  JoinedReaders(Record says, std::vector<std::unique_ptr<RecordingReader>> readers)
      : says_(std::move(says)),
        readers_(std::move(readers)) {
    says_.channels.clear();
    head_.record = says_;
    for (const auto& reader : readers_) {
      const RecordingHead& part = reader->head();
      std::ranges::copy(part.record.channels, std::back_inserter(head_.record.channels));
      std::ranges::copy(part.samples, std::back_inserter(head_.samples));
      head_.counted = head_.counted && part.counted;
      say_once(part.record.warnings, head_.record);
    }
  }

  const RecordingHead& head() const override { return head_; }

  Record read(const Selection& wanted, SampleSink& sink) override {
    const std::vector<std::size_t> chosen = selected_channels(head_, wanted);
    Record record = says_;
    record.channels.resize(chosen.size());
    std::size_t first = 0;  // channel of the reader
    for (const auto& reader : readers_) {
      const std::size_t channels = reader->head().record.channels.size();
      Selection part = wanted;
      part.channels.clear();
      std::vector<std::size_t> places;
      for (std::size_t i = 0; i < chosen.size(); ++i) {
        if (chosen[i] < first || chosen[i] >= first + channels) continue;
        part.channels.push_back(chosen[i] - first);
        places.push_back(i);
      }
      first += channels;
      // of a reader without channels, only all are asked for
      if (places.empty() && (channels > 0 || !wanted.channels.empty())) continue;
      PartOfSink part_of_sink(sink, places);
      Record found = reader->read(part, part_of_sink);
      for (std::size_t i = 0; i < places.size(); ++i)
        record.channels[places[i]] = std::move(found.channels[i]);
      say_once(found.warnings, record);
    }
    return record;
  }

 private:
  Record says_;
  std::vector<std::unique_ptr<RecordingReader>> readers_;
  RecordingHead head_;
};

}  // namespace

std::unique_ptr<RecordingReader> join_readers(
    Record says, std::vector<std::unique_ptr<RecordingReader>> readers) {
  return std::make_unique<JoinedReaders>(std::move(says), std::move(readers));
}

}  // namespace impactrig::acquisition
