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

RawSamples read_samples(const Hdf5Reader& reader, const Node& node) {
  const Hdf5Handle type(H5Dget_type(node.id()), H5Tclose);
  const H5T_class_t kind = H5Tget_class(type.id());
  const std::size_t size = H5Tget_size(type.id());
  const bool is_signed = kind == H5T_INTEGER && H5Tget_sign(type.id()) == H5T_SGN_2;
  if (kind == H5T_FLOAT && size == 8) return reader.numbers<double>(node);
  if (kind == H5T_FLOAT && size == 4) return reader.numbers<float>(node);
  if (is_signed && size == 2) return reader.numbers<std::int16_t>(node);
  if (is_signed && size == 4) return reader.numbers<std::int32_t>(node);
  reader.damaged(node.path, "is of a number type that no recording has");
}

/// An optional companion of the samples, one value each.
template <typename Number>
std::vector<Number> read_companion(const Hdf5Reader& reader, const Node& group, const char* name,
                                   std::size_t samples) {
  if (!reader.has(group, name)) return {};
  const Node node = reader.data(group, name);
  std::vector<Number> values = reader.numbers<Number>(node);
  if (values.size() != samples)
    reader.damaged(node.path, fmt::format("has {} values for {} samples", values.size(), samples));
  return values;
}

Channel read_channel(const Hdf5Reader& reader, const Node& group,
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
  const Node samples = reader.data(group, "samples");
  channel.raw = read_samples(reader, samples);
  channel.unit = reader.scalar_text(group, "unit");
  channel.scale = reader.number<double>(samples, "scale_factor");
  channel.offset = reader.number<double>(samples, "add_offset");
  channel.clock.start = reader.number<double>(samples, "start");
  channel.clock.interval = reader.number<double>(samples, "interval");
  channel.clock.times = read_companion<double>(reader, group, "times", channel.size());
  channel.imaginary = read_companion<double>(reader, group, "imaginary", channel.size());
  channel.valid = read_companion<std::uint8_t>(reader, group, "valid", channel.size());
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

std::vector<Channel> read_channels(const Hdf5Reader& reader, const Node& entry,
                                   std::vector<std::string>& warnings) {
  const Node raw = reader.group(entry, "raw");
  const Node calibrations = reader.group(entry, "calibration");
  std::vector<std::pair<std::uint64_t, std::string>> order;
  for (const std::string& name : reader.names(raw))
    order.emplace_back(reader.number<std::uint64_t>(reader.group(raw, name), "index"), name);
  std::ranges::sort(order);

  std::vector<Channel> channels;
  for (const auto& [index, name] : order) {
    channels.push_back(read_channel(reader, reader.group(raw, name), warnings));
    if (reader.has(calibrations, name.c_str()))
      read_calibration(reader, reader.group(calibrations, name), channels.back());
  }
  return channels;
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

Record read_record(const std::string& path) {
  const FileStart start = read_start(path);
  const Hdf5Session session;
  const Hdf5Reader reader(path, start.bytes);
  check_start(reader, start, path);

  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fclose_degree(access.id(), H5F_CLOSE_STRONG);
  const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose);
  if (!file.valid()) reader.refuse("is damaged: HDF5 cannot open it");
  const Node root{Hdf5Handle(H5Gopen2(file.id(), "/", H5P_DEFAULT), H5Gclose), "/"};
  if (!root.handle.valid()) reader.damaged("/", "cannot be opened");
  check_format(reader, root);

  const Node entry = reader.group(root, "entry");
  Record record;
  record.title = reader.scalar_text(entry, "title");
  if (reader.has(entry, "start_time")) record.started = reader.scalar_text(entry, "start_time");
  record.warnings = reader.optional_texts(entry, "warnings");
  record.channels = read_channels(reader, entry, record.warnings);
  record.provenance = read_provenance(reader, entry);
  record.attributes = reader.optional_pairs(entry, "attributes");
  return record;
}

}  // namespace impactrig::datasets
