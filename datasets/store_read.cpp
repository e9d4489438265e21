// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "datasets/hdf5_handle.hpp"
#include "datasets/hdf5_reader.hpp"
#include "datasets/input_error.hpp"
#include "datasets/store.hpp"
#include "datasets/store_layout.hpp"

namespace impactrig::datasets {

namespace {

enum class SampleType { f64, f32, i16, i32 };

SampleType type_of(const Hdf5Reader& reader, const Node& node) {
  const Hdf5Handle type(H5Dget_type(node.id()), H5Tclose);
  const H5T_class_t kind = H5Tget_class(type.id());
  const std::size_t size = H5Tget_size(type.id());
  const bool is_signed = kind == H5T_INTEGER && H5Tget_sign(type.id()) == H5T_SGN_2;
  if (kind == H5T_FLOAT && size == 8) return SampleType::f64;
  if (kind == H5T_FLOAT && size == 4) return SampleType::f32;
  if (is_signed && size == 2) return SampleType::i16;
  if (is_signed && size == 4) return SampleType::i32;
  reader.damaged(node.path, "is of a number type that no recording has");
}

template <typename Number>
void read_samples(const Hdf5Reader& reader, const Node& node, std::uint64_t first,
                  std::size_t count, RawSamples& to) {
  if (!std::holds_alternative<std::vector<Number>>(to)) to = std::vector<Number>{};
  reader.numbers(node, first, count, std::get<std::vector<Number>>(to));
}

void read_samples(const Hdf5Reader& reader, const Node& node, SampleType type, std::uint64_t first,
                  std::size_t count, RawSamples& to) {
  switch (type) {
    case SampleType::f64:
      return read_samples<double>(reader, node, first, count, to);
    case SampleType::f32:
      return read_samples<float>(reader, node, first, count, to);
    case SampleType::i16:
      return read_samples<std::int16_t>(reader, node, first, count, to);
    case SampleType::i32:
      return read_samples<std::int32_t>(reader, node, first, count, to);
  }
}

/// The data sets of a channel.
struct ChannelNodes {
  Node samples;
  SampleType type = SampleType::f64;
  std::size_t count = 0;
  std::optional<Node> times{}, imaginary{}, valid{};  ///< one value a sample each
};

std::optional<Node> companion(const Hdf5Reader& reader, const Node& group, const char* name,
                              std::size_t samples) {
  if (!reader.has(group, name)) return std::nullopt;
  Node node = reader.data(group, name);
  const std::size_t length = reader.length(node);
  if (length != samples)
    reader.damaged(node.path, fmt::format("has {} values for {} samples", length, samples));
  return node;
}

ChannelNodes open_channel(const Hdf5Reader& reader, const Node& group) {
  ChannelNodes nodes{reader.data(group, "samples")};
  nodes.type = type_of(reader, nodes.samples);
  nodes.count = reader.length(nodes.samples);
  nodes.times = companion(reader, group, "times", nodes.count);
  nodes.imaginary = companion(reader, group, "imaginary", nodes.count);
  nodes.valid = companion(reader, group, "valid", nodes.count);
  return nodes;
}

/// A channel without samples.
Channel read_head(const Hdf5Reader& reader, const Node& group, const Node& samples,
                  std::vector<std::string>& warnings) {
  Channel channel;
  channel.name = reader.scalar_text(group, "name");
  const std::string quantity = reader.scalar_text(group, "quantity");
  channel.quantity = quantity_named(quantity).value_or(Quantity::other);
  if (!quantity_named(quantity))
    warnings.push_back(
        fmt::format("Channel '{}': this program does not know its quantity '{}' and takes it as "
                    "'other'.",
                    channel.name, quantity));
  channel.unit = reader.scalar_text(group, "unit");
  channel.scale = reader.number<double>(samples, "scale_factor");
  channel.offset = reader.number<double>(samples, "add_offset");
  channel.clock.start = reader.number<double>(samples, "start");
  channel.clock.interval = reader.number<double>(samples, "interval");
  channel.attributes = reader.optional_pairs(group, "attributes");
  return channel;
}

void read_calibration(const Hdf5Reader& reader, const Node& group, Channel& channel) {
  if (reader.has(group, "sensitivity")) {
    Calibration calibration;
    calibration.sensitivity = reader.scalar<double>(group, "sensitivity");
    calibration.uncertainty = reader.scalar<double>(group, "sensitivity_errors");
    calibration.recorded_unit = reader.scalar_text(group, "recorded_unit");
    calibration.physical_unit = reader.scalar_text(group, "physical_unit");
    calibration.source = reader.scalar_text(group, "source");
    channel.calibration = calibration;
  }
  if (reader.has(group, "delay")) {
    Delay delay;
    delay.value = reader.scalar<double>(group, "delay");
    delay.uncertainty = reader.scalar<double>(group, "delay_errors");
    delay.removed = reader.number<std::uint8_t>(reader.data(group, "delay"), "removed") != 0;
    channel.delay = delay;
  }
}

Provenance read_provenance(const Hdf5Reader& reader, const Node& entry) {
  const Node group = reader.group(entry, "provenance");
  Provenance provenance;
  provenance.source_file = reader.scalar_text(group, "source_file");
  provenance.bytes = reader.scalar<std::uint64_t>(group, "bytes");
  provenance.sha256 = reader.scalar_text(group, "sha256");
  provenance.importer = reader.scalar_text(group, "importer");
  provenance.program = reader.scalar_text(group, "program");
  if (!reader.has(group, "edits")) return provenance;
  const Node edits = reader.group(group, "edits");
  for (const std::string& name : reader.names(edits)) {
    const Node one = reader.group(edits, name);
    provenance.edits.push_back({reader.scalar_text(one, "what"), reader.scalar_text(one, "channel"),
                                reader.optional_pairs(one, "parameters")});
  }
  return provenance;
}

/// Refuses files that are not ours, or are of a later day.
void check_format(const Hdf5Reader& reader, const Node& root) {
  if (reader.text(root, "format") != layout::format)
    reader.refuse(
        "is an HDF5 file, but not a recording of impactrig: its root has no attribute 'format' "
        "that says 'impactrig-recording'");
  const std::string version = reader.text(root, "format_version").value_or("");
  int major = 0;
  const char* const last = version.data() + version.size();
  const auto [end, error] = std::from_chars(version.data(), last, major);
  if (error != std::errc{} || end == last || *end != '.' || major < 1)
    reader.damaged("/@format_version", fmt::format("is '{}', not a version", version));
  if (major > layout::format_major)
    reader.refuse(fmt::format(
        "has format {} of recordings, written by {}; this is {}, which reads format {} and what "
        "came before: update it, or write the file again with the older program",
        version, reader.text(root, "creator").value_or("another program"), program_version(),
        layout::format_version));
}

struct FileStart {
  std::string head;         ///< the first 48 bytes, or all there are
  std::uint64_t bytes = 0;  ///< of the whole file
};

FileStart read_start(const std::string& path) {
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  const std::unique_ptr<std::FILE, Close> file(std::fopen(path.c_str(), "rb"));
  if (!file) throw FileError(path, "cannot be opened: " + std::generic_category().message(errno));
  std::array<char, 48> head{};
  const std::size_t count = std::fread(head.data(), 1, head.size(), file.get());
  if (std::ferror(file.get()) != 0)
    throw FileError(path, "cannot be read: " + std::generic_category().message(errno));
  std::error_code error;
  const std::uint64_t bytes = std::filesystem::file_size(path, error);
  if (error) throw FileError(path, "cannot be read: " + error.message());
  return {std::string(head.data(), count), bytes};
}

void check_start(const Hdf5Reader& reader, const FileStart& start, const std::string& path) {
  constexpr std::string_view signature = "\x89HDF\r\n\x1a\n";
  if (start.bytes == 0) reader.refuse("is empty, not an HDF5 file");
  if (signature.starts_with(start.head) || (looks_like_hdf5(start.head) && start.head.size() < 48))
    reader.refuse(
        fmt::format("is cut short: it ends after {} bytes, within the HDF5 header", start.bytes));
  // HDF5 allows a foreign header before its own, which ours never has
  if (!looks_like_hdf5(start.head) && H5Fis_hdf5(path.c_str()) <= 0)
    reader.refuse("is not an HDF5 file: it does not begin with the HDF5 signature");
  const std::uint64_t end = layout::declared_end(start.head);
  if (looks_like_hdf5(start.head) && start.bytes < end)
    reader.refuse(fmt::format("is cut short: it has {} of {} bytes; copy or record it again",
                              start.bytes, end));
}

}  // namespace

class StoredRecord::File {
 public:
  explicit File(const std::string& path) : start_(read_start(path)), reader_(path, start_.bytes) {
    const Hdf5Session session;
    try {
      open(path);
    } catch (...) {
      close();
      throw;
    }
  }

  ~File() {
    const Hdf5Session session;
    close();
  }

  File(const File&) = delete;
  File& operator=(const File&) = delete;

  const Record& head() const { return head_; }

  const ChannelNodes& nodes(std::size_t channel) const { return channels_.at(channel); }

  std::vector<double> times(std::size_t index, std::uint64_t first, std::size_t count) const {
    const Hdf5Session session;
    std::vector<double> times;
    reader_.numbers(channels_.at(index).times.value(), first, count, times);
    return times;
  }

  void piece(std::size_t index, std::uint64_t first, std::size_t count, Channel& to) const {
    const Hdf5Session session;
    const ChannelNodes& nodes = channels_.at(index);
    read_samples(reader_, nodes.samples, nodes.type, first, count, to.raw);
    if (nodes.times) reader_.numbers(*nodes.times, first, count, to.clock.times);
    if (nodes.imaginary) reader_.numbers(*nodes.imaginary, first, count, to.imaginary);
    if (nodes.valid) reader_.numbers(*nodes.valid, first, count, to.valid);
  }

 private:
  void open(const std::string& path) {
    check_start(reader_, start_, path);
    const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    H5Pset_fclose_degree(access.id(), H5F_CLOSE_STRONG);
    // every piece is read once: without a cache it goes where it is wanted, not there by way of it
    H5Pset_cache(access.id(), 0, 1, 0, 1.0);
    file_.emplace(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose);
    if (!file_->valid()) reader_.refuse("is damaged: HDF5 cannot open it");
    const Node root{Hdf5Handle(H5Gopen2(file_->id(), "/", H5P_DEFAULT), H5Gclose), "/"};
    if (!root.handle.valid()) reader_.damaged("/", "cannot be opened");
    check_format(reader_, root);
    const Node entry = reader_.group(root, "entry");
    head_.title = reader_.scalar_text(entry, "title");
    if (reader_.has(entry, "start_time")) head_.started = reader_.scalar_text(entry, "start_time");
    head_.warnings = reader_.optional_texts(entry, "warnings");
    open_channels(entry);
    head_.provenance = read_provenance(reader_, entry);
    head_.attributes = reader_.optional_pairs(entry, "attributes");
  }

  void open_channels(const Node& entry) {
    const Node raw = reader_.group(entry, "raw");
    const Node calibrations = reader_.group(entry, "calibration");
    std::vector<std::pair<std::uint64_t, std::string>> order;
    for (const std::string& name : reader_.names(raw))
      order.emplace_back(reader_.number<std::uint64_t>(reader_.group(raw, name), "index"), name);
    std::ranges::sort(order);
    for (const auto& [index, name] : order) {
      const Node group = reader_.group(raw, name);
      channels_.push_back(open_channel(reader_, group));
      head_.channels.push_back(read_head(reader_, group, channels_.back().samples, head_.warnings));
      if (reader_.has(calibrations, name))
        read_calibration(reader_, reader_.group(calibrations, name), head_.channels.back());
    }
  }

  void close() {
    channels_.clear();
    file_.reset();
  }

  FileStart start_;
  Hdf5Reader reader_;
  std::optional<Hdf5Handle> file_;
  std::vector<ChannelNodes> channels_;
  Record head_;
};

StoredRecord::StoredRecord(const std::string& path) : file_(std::make_unique<File>(path)) {}

StoredRecord::~StoredRecord() = default;

const Record& StoredRecord::head() const {
  return file_->head();
}

std::uint64_t StoredRecord::samples(std::size_t channel) const {
  return file_->nodes(channel).count;
}

bool StoredRecord::has_times(std::size_t channel) const {
  return file_->nodes(channel).times.has_value();
}

std::vector<double> StoredRecord::times(std::size_t channel, std::uint64_t first,
                                        std::size_t count) const {
  return file_->times(channel, first, count);
}

void StoredRecord::piece(std::size_t channel, std::uint64_t first, std::size_t count,
                         Channel& to) const {
  file_->piece(channel, first, count, to);
}

Record read_record(const std::string& path) {
  const StoredRecord stored(path);
  Record record = stored.head();
  for (std::size_t i = 0; i < record.channels.size(); ++i)
    stored.piece(i, 0, static_cast<std::size_t>(stored.samples(i)), record.channels[i]);
  return record;
}

}  // namespace impactrig::datasets
