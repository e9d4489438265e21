// SPDX-License-Identifier: BSD-3-Clause
// HDF5 files of other programs, and MAT-files of version 7.3, which are HDF5 behind 512 bytes.
#include <fmt/format.h>

#include <utility>

#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/hdf5_arrays.hpp"
#include "acquisition/importers/hdf5_channels.hpp"
#include "acquisition/importers/hdf5_clocks.hpp"
#include "acquisition/importers/hdf5_programs.hpp"
#include "acquisition/importers/mapped_file.hpp"
#include "acquisition/importers/time_axis.hpp"
#include "datasets/input_error.hpp"
#include "datasets/store.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Record;

namespace {

class ForeignReader final : public RecordingReader {
 public:
  ForeignReader(const std::string& path, Hdf5Listing listing, const ImportOptions& options,
                bool matlab)
      : file_(path, std::move(listing), matlab, options.units) {
    set_clocks(file_, options);
    file_.settle_the_rest();
    head_.record = std::move(file_.record);
    for (const Hdf5Slice& slice : file_.slices) head_.samples.push_back(slice.count);
  }

  const RecordingHead& head() const override { return head_; }

  Record read(const Selection& wanted, SampleSink& sink) override {
    Record record = head_.record;
    record.channels.clear();
    std::vector<Hdf5Slice> slices;
    for (const std::size_t index : selected_channels(head_, wanted)) {
      Channel channel = head_.record.channels[index];
      Hdf5Slice slice = file_.slices[index];
      const SampleRange range = slice.times == nullptr
                                    ? samples_within(channel.clock, slice.count, wanted)
                                    : range_of_times(slice, wanted, channel.clock);
      if (slice.times == nullptr)
        channel.clock.start += channel.clock.interval * static_cast<double>(range.first);
      slice.first = range.first;
      slice.count = range.last - range.first;
      slices.push_back(slice);
      record.channels.push_back(std::move(channel));
    }
    const std::vector<Hdf5SliceSeen> seen = read_hdf5_slices(file_.path, slices, sink);
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const std::string& name = record.channels[i].name;
      if (seen[i].missing > 0)
        record.warnings.push_back(fmt::format("'{}': {} of {} samples are {}; marked as not valid",
                                              name, seen[i].missing, slices[i].count,
                                              slices[i].none.text()));
      if (std::string wide = seen[i].wide.warning(name); !wide.empty())
        record.warnings.push_back(std::move(wide));
    }
    return record;
  }

 private:
  SampleRange range_of_times(const Hdf5Slice& slice, const Selection& wanted,
                             datasets::SampleClock& clock) const {
    if (!wanted.has_window()) return {0, slice.count};
    TimeWindow found(wanted);
    std::vector<double> times;
    each_number_of(file_.path, *slice.times, [&](std::span<const double> numbers) {
      times.assign(numbers.begin(), numbers.end());
      for (double& time : times) time = slice.time_factor * time + slice.time_offset;
      found.add(times);
    });
    found.settle(clock);
    return found.range();
  }

  Hdf5Channels file_;
  RecordingHead head_;  ///< whose record is that of the file
};

/// Where the HDF5 file begins: behind a user block of 0, 512, 1024, ... bytes; none when it does
/// not within the first 64 KiB.
bool has_hdf5_signature(std::string_view head) {
  for (std::size_t at = 0; at < head.size(); at = at == 0 ? 512 : 2 * at)
    if (datasets::looks_like_hdf5(head.substr(at))) return true;
  return false;
}

bool is_own(const Hdf5Listing& listing) {
  const auto root = listing.groups.find("/");
  if (root == listing.groups.end()) return false;
  const auto format = root->second.texts.find("format");
  return format != root->second.texts.end() && format->second == "impactrig-recording";
}

}  // namespace

int recognises_foreign_hdf5(std::string_view, std::string_view head) {
  return has_hdf5_signature(head) ? 90 : 0;
}

std::unique_ptr<RecordingReader> open_foreign_hdf5(const std::string& path,
                                                   const ImportOptions& options) {
  const MappedFile file(path);
  if (!has_hdf5_signature(file.bytes().substr(0, 65536)))
    throw datasets::InputError(file.byte_position(0),
                               "expected the signature of HDF5 at byte 0, 512, 1024, ...");
  Hdf5Listing listing = list_hdf5(path);
  if (!is_own(listing)) {
    state_programs_words(listing);
    return std::make_unique<ForeignReader>(path, std::move(listing), options, false);
  }
  if (!options.units.empty()) {
    datasets::SourcePosition place;
    place.file = path;
    throw datasets::InputError(place,
                               "--units is not for impactrig's own HDF5; a map states the units of "
                               "its channels (--suggest-map, --map)");
  }
  return open_hdf5(path, options);
}

std::unique_ptr<RecordingReader> open_mat73(const std::string& path, const ImportOptions& options) {
  return std::make_unique<ForeignReader>(path, list_hdf5(path), options, true);
}

}  // namespace impactrig::acquisition
