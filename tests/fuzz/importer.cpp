// SPDX-License-Identifier: BSD-3-Clause
// Feeds bytes to the importer of the format that IMPACTRIG_FUZZED_FORMAT names, as a file: a record
// whose parts fit together, or an InputError. Anything else ends the program.
#include <sys/mman.h>
#include <unistd.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "acquisition/importer.hpp"
#include "acquisition/importers/formats.hpp"
#include "datasets/input_error.hpp"

namespace {

using namespace impactrig;

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "broken promise: %s\n", what);
  std::abort();
}

/// The format all inputs are taken for.
const std::string& fuzzed_format() {
  static const std::string format = [] {
    const char* name = std::getenv("IMPACTRIG_FUZZED_FORMAT");
    require(name != nullptr, "the environment names a format");
    return std::string(name);
  }();
  return format;
}

/// A file in memory with a name. HDF5 wants one that lies in a folder, and TDM has its samples
/// beside it: the same bytes once more.
class MemoryFile {
 public:
  MemoryFile(const std::uint8_t* data, std::size_t size)
      : in_folder_(fuzzed_format().ends_with("hdf5") || fuzzed_format() == "tdm"),
        path_("/dev/shm/fuzz-XXXXXX"),
        id_(in_folder_ ? mkstemp(path_.data()) : memfd_create("fuzz", MFD_CLOEXEC)) {
    require(id_ >= 0 && write(id_, data, size) == static_cast<ssize_t>(size), "a file in memory");
    if (!in_folder_) path_ = "/proc/self/fd/" + std::to_string(id_);
    if (fuzzed_format() == "tdm")
      require(link(path_.c_str(), (path_ + ".tdx").c_str()) == 0, "samples beside it");
  }

  ~MemoryFile() {
    if (in_folder_) unlink(path_.c_str());
    if (fuzzed_format() == "tdm") unlink((path_ + ".tdx").c_str());
    close(id_);
  }

  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  bool in_folder_;
  std::string path_;
  int id_;
};

/// What is printed must be JSON without replacement of invalid UTF-8.
void require_text(const std::string& text) {
  static_cast<void>(nlohmann::json(text).dump());
}

class Counter final : public acquisition::SampleSink {
 public:
  explicit Counter(std::size_t channels) : samples(channels), times(channels) {}

  void take(std::size_t channel, const acquisition::SampleBlock& block) override {
    require(channel < samples.size(), "a block belongs to a channel asked for");
    const std::size_t n = block.size();
    require(block.imaginary.empty() || block.imaginary.size() == n, "imaginary parts");
    require(block.valid.empty() || block.valid.size() == n, "marks");
    samples[channel] += n;
    std::visit(
        [&](auto raw) {
          for (std::size_t i = 0; i < n; ++i)
            if (block.valid.empty() || block.valid[i] != 0) add(static_cast<double>(raw[i]));
        },
        block.raw);
  }

  void take_times(std::size_t channel, std::span<const double> stated) override {
    require(channel < samples.size(), "times belong to a channel asked for");
    times[channel] += stated.size();
    for (const double time : stated) add(time);
  }

  /// The same numbers, in whatever blocks; channels may come in another order.
  bool same_as(const Counter& other) const {
    return samples == other.samples && times == other.times && sum_ == other.sum_;
  }

  std::vector<std::uint64_t> samples;
  std::vector<std::uint64_t> times;

 private:
  void add(double number) { sum_ += std::bit_cast<std::uint64_t>(number) * 0x9E3779B97F4A7C15U; }

  std::uint64_t sum_ = 0;
};

/// What goes by way of the disk, as large files do, is what is read at once.
void require_same_by_blocks(const std::string& path, const acquisition::ImportOptions& options,
                            const Counter& at_once) {
  const auto reader = acquisition::open_lvm_by_blocks(path, options);
  require(reader->head().samples == at_once.samples, "as many samples by blocks");
  Counter counter(at_once.samples.size());
  reader->read({}, counter);
  require(counter.same_as(at_once), "the same numbers by blocks");
}

/// What is said of a large file by its first part. It need not be right, but in order.
void require_estimate(const std::string& path, acquisition::ImportOptions options,
                      std::size_t size) {
  options.head_only = true;
  acquisition::RecordingHead head;
  if (options.format == "lvm") {
    auto expected = acquisition::estimated_lvm_head(path, options, size / 2);
    if (!expected) return;
    head = std::move(*expected);
  } else {
    const auto reader = options.format == "csv"
                            ? acquisition::open_csv_by_blocks(path, options)
                            : acquisition::open_polytec_ascii_by_blocks(path, options);
    head = reader->head();
  }
  require(!head.counted, "an estimate says so");
  require(head.samples.size() == head.record.channels.size(), "one estimate a channel");
  for (const std::string& warning : head.record.warnings) require_text(warning);
}

bool has_large_route(std::string_view format) {
  return format == "lvm" || format == "csv" || format == "polytec-ascii";
}

bool has_lvm_header(const datasets::Record& record) {
  return record.warnings.empty() || !record.warnings.front().starts_with("the file has no header");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const MemoryFile file(data, size);
  acquisition::ImportOptions options;
  options.format = fuzzed_format();
  options.require_clock = false;
  try {
    const auto reader = acquisition::open_recording(file.path(), options);
    const acquisition::RecordingHead& head = reader->head();
    require(head.samples.size() == head.record.channels.size(), "one count a channel");
    Counter counter(head.samples.size());
    const datasets::Record record = reader->read({}, counter);
    require(record.channels.size() == head.record.channels.size(), "all channels");
    if (head.counted) require(counter.samples == head.samples, "the samples announced");
    for (std::size_t i = 0; i < counter.times.size(); ++i)
      require(counter.times[i] == 0 || counter.times[i] == counter.samples[i], "one time a sample");
    if (options.format == "lvm" && has_lvm_header(record)) {
      Counter unchecked(head.samples.size());
      acquisition::open_lvm(file.path(), options)->read({}, unchecked);
      require_same_by_blocks(file.path(), options, unchecked);
    }
    if (has_large_route(options.format)) require_estimate(file.path(), options, size);
    for (const datasets::Channel& channel : record.channels) {
      require_text(channel.name);
      require_text(channel.unit);
      for (const auto& [key, value] : channel.attributes) require_text(key + value);
    }
    for (const auto& [key, value] : record.attributes) require_text(key + value);
    for (const std::string& warning : record.warnings) require_text(warning);
    require_text(record.title + record.started);
  } catch (const datasets::InputError& error) {
    require_text(error.what());
  } catch (const datasets::FileError& error) {
    require_text(error.what());
  }
  return 0;
}
