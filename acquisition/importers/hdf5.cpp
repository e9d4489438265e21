// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <utility>

#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/text_file.hpp"
#include "datasets/store.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Record;

namespace {

/// Samples read at once: a piece of the file.
constexpr std::uint64_t read_at_once = 65536;

/// Texts of ours are UTF-8; those of a damaged file may be anything.
void mend(std::string& text) {
  text = to_utf8_with_controls(text);
}

void mend(std::map<std::string, std::string>& texts) {
  std::map<std::string, std::string> mended;
  for (const auto& [key, value] : texts)
    mended.emplace(to_utf8_with_controls(key), to_utf8_with_controls(value));
  texts = std::move(mended);
}

void mend(Channel& channel) {
  mend(channel.name);
  mend(channel.unit);
  mend(channel.attributes);
  if (!channel.calibration) return;
  mend(channel.calibration->recorded_unit);
  mend(channel.calibration->physical_unit);
  mend(channel.calibration->source);
}

void mend(Record& record) {
  mend(record.title);
  mend(record.started);
  mend(record.attributes);
  for (std::string& warning : record.warnings) mend(warning);
  for (Channel& channel : record.channels) mend(channel);
  datasets::Provenance& from = record.provenance;
  for (std::string* const text : {&from.source_file, &from.sha256, &from.importer, &from.program})
    mend(*text);
  for (datasets::Edit& edit : from.edits) {
    mend(edit.what);
    mend(edit.channel);
    mend(edit.parameters);
  }
}

class OurRecording final : public RecordingReader {
 public:
  explicit OurRecording(const std::string& path) : stored_(path) {
    head_.record = stored_.head();
    mend(head_.record);
    for (std::size_t i = 0; i < head_.record.channels.size(); ++i)
      head_.samples.push_back(stored_.samples(i));
    // the provenance will name this file; where the record first came from stays with it
    datasets::Provenance& origin = head_.record.provenance;
    auto& says = head_.record.attributes;
    if (!origin.source_file.empty()) says.emplace("origin file", origin.source_file);
    if (!origin.sha256.empty()) says.emplace("origin sha256", origin.sha256);
    if (!origin.importer.empty()) says.emplace("origin format", origin.importer);
    if (!origin.program.empty()) says.emplace("origin program", origin.program);
    origin.importer.clear();
  }

  const RecordingHead& head() const override { return head_; }

  Record read(const Selection& wanted, SampleSink& sink) override {
    Record record = head_.record;
    record.channels.clear();
    for (const std::size_t index : selected_channels(head_, wanted)) {
      record.channels.push_back(head_.record.channels[index]);
      read_channel(index, wanted, record.channels.size() - 1, record.channels.back(), sink);
    }
    return record;
  }

 private:
  void read_channel(std::size_t index, const Selection& wanted, std::size_t number, Channel& head,
                    SampleSink& sink) const {
    const SampleRange range = range_of(index, wanted, head.clock);
    Channel piece;
    for (std::uint64_t at = range.first; at < range.last;) {
      // pieces end where the file's do
      const std::uint64_t count = std::min(range.last - at, read_at_once - at % read_at_once);
      stored_.piece(index, at, static_cast<std::size_t>(count), piece);
      hand_over(piece, number, sink);
      at += count;
    }
  }

  /// The samples of a window, whose clock `clock` becomes.
  SampleRange range_of(std::size_t index, const Selection& wanted,
                       datasets::SampleClock& clock) const {
    const std::uint64_t samples = head_.samples[index];
    if (!stored_.has_times(index)) {
      const SampleRange range = samples_within(clock, samples, wanted);
      clock.start += clock.interval * static_cast<double>(range.first);
      return range;
    }
    if (!wanted.has_window()) return {0, samples};
    TimeWindow found(wanted);
    for (std::uint64_t at = 0; at < samples; at += read_at_once)
      found.add(
          stored_.times(index, at, static_cast<std::size_t>(std::min(read_at_once, samples - at))));
    found.settle(clock);
    return found.range();
  }

  static void hand_over(const Channel& piece, std::size_t number, SampleSink& sink) {
    SampleBlock block;
    std::visit([&](const auto& raw) { block.raw = std::span(raw); }, piece.raw);
    block.imaginary = piece.imaginary;
    block.valid = piece.valid;
    sink.take(number, block);
    if (!piece.clock.times.empty()) sink.take_times(number, piece.clock.times);
  }

  datasets::StoredRecord stored_;
  RecordingHead head_;
};

}  // namespace

int recognises_hdf5(std::string_view, std::string_view head) {
  if (!datasets::looks_like_hdf5(head)) return 0;
  // an attribute of the root, which is the first object of the file
  return head.find("impactrig-recording") != std::string_view::npos ? 100 : 50;
}

std::unique_ptr<RecordingReader> open_hdf5(const std::string& path, const ImportOptions&) {
  return std::make_unique<OurRecording>(path);
}

}  // namespace impactrig::acquisition
