// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "datasets/hdf5_handle.hpp"
#include "datasets/hdf5_write.hpp"
#include "datasets/input_error.hpp"
#include "datasets/quicklook.hpp"
#include "datasets/store.hpp"
#include "datasets/store_layout.hpp"

namespace impactrig::datasets {

namespace {

/// What a viewer plots of one channel.
void add_quicklook(hid_t parent, const std::string& name, const Channel& channel) {
  const Quicklook look = quicklook_of(channel, layout::quicklook_points);
  const Hdf5Handle group = add_group(parent, name, "NXdata");
  add_text(group.id(), "title", channel.name);
  add_text(group.id(), "signal", "value");
  add_text_list(group.id(), "axes", "time");
  add_number(group.id(), "time_indices", std::int64_t{0});
  add_number(group.id(), "samples", static_cast<std::uint64_t>(channel.size()));

  const Hdf5Handle time = add_data(group.id(), "time", look.time);
  add_text(time.id(), "units", "s");
  add_text(time.id(), "long_name", "time (s)");
  std::vector<Hdf5Handle> data;
  const auto add_signal = [&](const char* set, const std::vector<double>& values,
                              std::string_view label) {
    data.push_back(add_data(group.id(), set, values));
    add_text(data.back().id(), "units", look.unit);
    add_text(data.back().id(), "long_name",
             look.unit.empty() ? std::string(label) : fmt::format("{} ({})", label, look.unit));
  };
  add_signal("value", look.values, channel.name);
  if (channel.complex()) {
    add_signal("imaginary", look.imaginary, "imaginary part of " + channel.name);
    add_text_list(group.id(), "auxiliary_signals", "imaginary");
  }
  attach_time(group.id(), time, data);
}

void add_raw(hid_t parent, const std::string& name, std::size_t index, const Channel& channel) {
  const Hdf5Handle group = add_group(parent, name, "NXcollection");
  add_number(group.id(), "index", static_cast<std::uint64_t>(index));
  add_scalar_text(group.id(), "name", channel.name);
  add_scalar_text(group.id(), "quantity", impactrig::datasets::name(channel.quantity));
  add_scalar_text(group.id(), "unit", channel.unit);

  const Hdf5Handle samples = std::visit(
      [&](const auto& raw) { return add_data(group.id(), "samples", raw); }, channel.raw);
  const bool scaled = channel.scale != 1.0 || channel.offset != 0.0;
  add_text(samples.id(), "units", scaled ? "1" : channel.unit);
  add_text(samples.id(), "physical_units", channel.unit);
  add_number(samples.id(), "scale_factor", channel.scale);
  add_number(samples.id(), "add_offset", channel.offset);
  add_number(samples.id(), "start", channel.clock.start);
  add_number(samples.id(), "interval", channel.clock.interval);
  if (!channel.clock.uniform()) {
    const Hdf5Handle times = add_data(group.id(), "times", channel.clock.times);
    add_text(times.id(), "units", "s");
  }
  if (channel.complex()) {
    const Hdf5Handle imaginary = add_data(group.id(), "imaginary", channel.imaginary);
    add_text(imaginary.id(), "units", channel.unit);
  }
  if (!channel.valid.empty()) {
    const Hdf5Handle valid = add_data(group.id(), "valid", channel.valid);
    add_text(valid.id(), "flag_meanings", "0: not sound, 1: sound");
  }
  add_pairs(group.id(), "attributes", channel.attributes);
}

void add_calibration(hid_t parent, const std::string& name, const Channel& channel) {
  if (!channel.calibration && !channel.delay) return;
  const Hdf5Handle group = add_group(parent, name, "NXcollection");
  if (channel.calibration) {
    const Calibration& calibration = *channel.calibration;
    const std::string& physical = calibration.physical_unit;
    const bool simple = physical.find_first_of(" ./*()") == std::string::npos;
    const std::string unit =
        calibration.recorded_unit + (simple ? "/" + physical : "/(" + physical + ")");
    add_text(add_scalar(group.id(), "sensitivity", calibration.sensitivity).id(), "units", unit);
    add_text(add_scalar(group.id(), "sensitivity_errors", calibration.uncertainty).id(), "units",
             unit);
    add_scalar_text(group.id(), "recorded_unit", calibration.recorded_unit);
    add_scalar_text(group.id(), "physical_unit", calibration.physical_unit);
    add_scalar_text(group.id(), "source", calibration.source);
  }
  if (channel.delay) {
    const Hdf5Handle delay = add_scalar(group.id(), "delay", channel.delay->value);
    add_text(delay.id(), "units", "s");
    add_number(delay.id(), "removed", static_cast<std::uint8_t>(channel.delay->removed));
    add_text(add_scalar(group.id(), "delay_errors", channel.delay->uncertainty).id(), "units", "s");
  }
}

void add_provenance(hid_t parent, const Provenance& provenance) {
  const Hdf5Handle group = add_group(parent, "provenance", "NXcollection");
  add_scalar_text(group.id(), "source_file", provenance.source_file);
  add_scalar(group.id(), "bytes", provenance.bytes);
  add_scalar_text(group.id(), "sha256", provenance.sha256);
  add_scalar_text(group.id(), "importer", provenance.importer);
  add_scalar_text(group.id(), "program", provenance.program);
  if (provenance.edits.empty()) return;
  const Hdf5Handle edits = add_group(group.id(), "edits", "NXcollection");
  for (std::size_t i = 0; i < provenance.edits.size(); ++i) {
    const Edit& edit = provenance.edits[i];
    const Hdf5Handle one = add_group(edits.id(), fmt::format("edit_{:06}", i), "NXcollection");
    add_scalar_text(one.id(), "what", edit.what);
    add_scalar_text(one.id(), "channel", edit.channel);
    add_pairs(one.id(), "parameters", edit.parameters);
  }
}

/// Names of [a-z][a-z0-9_]*, one a channel, as close to the channels' own as that allows.
std::vector<std::string> group_names(const std::vector<Channel>& channels) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const Channel& channel : channels) {
    std::string base;
    for (const char c : channel.name) {
      const bool upper = c >= 'A' && c <= 'Z';
      const bool plain = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
      if (upper) base += static_cast<char>(c - 'A' + 'a');
      if (plain) base += c;
      if (!upper && !plain && !base.empty() && base.back() != '_') base += '_';
    }
    base.resize(std::min<std::size_t>(base.size(), 40));
    while (base.ends_with('_')) base.pop_back();
    if (base.empty() || (base.front() >= '0' && base.front() <= '9'))
      base = base.empty() ? "channel" : "channel_" + base;
    std::string name = base;
    for (int copy = 2; !taken.insert(name).second; ++copy) name = fmt::format("{}_{}", base, copy);
    names.push_back(name);
  }
  return names;
}

/// The channel a viewer opens with: the first force, else the first; none without samples.
std::size_t first_shown(const std::vector<Channel>& channels) {
  const auto shown = [](const Channel& channel) { return channel.size() > 0; };
  auto found = std::ranges::find_if(channels, [&](const Channel& channel) {
    return shown(channel) && channel.quantity == Quantity::force;
  });
  if (found == channels.end()) found = std::ranges::find_if(channels, shown);
  return static_cast<std::size_t>(found - channels.begin());
}

void add_channels(hid_t entry, const std::vector<Channel>& channels) {
  const std::vector<std::string> names = group_names(channels);
  const Hdf5Handle raw = add_group(entry, "raw", "NXcollection");
  const Hdf5Handle calibration = add_group(entry, "calibration", "NXcollection");
  const Hdf5Handle quicklook = add_group(entry, "quicklook", "NXcollection");
  for (std::size_t i = 0; i < channels.size(); ++i) {
    add_raw(raw.id(), names[i], i, channels[i]);
    add_calibration(calibration.id(), names[i], channels[i]);
    if (channels[i].size() > 0) add_quicklook(quicklook.id(), names[i], channels[i]);
  }
  const std::size_t shown = first_shown(channels);
  if (shown == channels.size()) return;
  add_text(entry, "default", "quicklook");
  add_text(quicklook.id(), "default", names[shown]);
}

void add_record(hid_t file, const Record& record) {
  add_text(file, "NX_class", "NXroot");
  add_text(file, "default", "entry");
  add_text(file, "format", layout::format);
  add_text(file, "format_version", layout::format_version);
  add_text(file, "creator", program_version());
  const Hdf5Handle entry = add_group(file, "entry", "NXentry");
  add_scalar_text(entry.id(), "title", record.title);
  if (!record.started.empty()) add_scalar_text(entry.id(), "start_time", record.started);
  add_channels(entry.id(), record.channels);
  add_provenance(entry.id(), record.provenance);
  add_text_data(entry.id(), "warnings", record.warnings);
  add_pairs(entry.id(), "attributes", record.attributes);
}

/// The bytes of a file that HDF5 lays out in memory, kept when HDF5 closes it. (H5Fget_file_image
/// of 1.10.8 gives a superblock with a wrong checksum.)
class Image {
 public:
  Image() = default;
  Image(const Image&) = delete;
  Image& operator=(const Image&) = delete;

  ~Image() { std::free(bytes_); }

  /// An access property list for the one file that goes here.
  Hdf5Handle access() {
    constexpr std::size_t increment = std::size_t{1} << 22;
    Hdf5Handle list = made(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    check(H5Pset_libver_bounds(list.id(), H5F_LIBVER_V18, H5F_LIBVER_V110));
    check(H5Pset_fclose_degree(list.id(), H5F_CLOSE_STRONG));
    check(H5Pset_fapl_core(list.id(), increment, 0));
    H5FD_file_image_callbacks_t callbacks{allocate, copy, resize, release, same, keep, this};
    check(H5Pset_file_image_callbacks(list.id(), &callbacks));
    return list;
  }

  /// After the file is closed. HDF5 takes memory in large pieces; its superblock says where the
  /// file ends.
  std::string_view bytes() const {
    const std::string_view all(static_cast<const char*>(bytes_), size_);
    return all.substr(0, layout::declared_end(all));
  }

 private:
  static void* allocate(std::size_t size, H5FD_file_image_op_t, void*) { return std::malloc(size); }

  static void* copy(void* to, const void* from, std::size_t size, H5FD_file_image_op_t, void*) {
    return std::memcpy(to, from, size);
  }

  static void* resize(void* bytes, std::size_t size, H5FD_file_image_op_t, void* image) {
    void* const moved = std::realloc(bytes, size);
    if (moved != nullptr) static_cast<Image*>(image)->size_ = size;
    return moved;
  }

  static herr_t release(void* bytes, H5FD_file_image_op_t operation, void* image) {
    if (operation == H5FD_FILE_IMAGE_OP_FILE_CLOSE)
      static_cast<Image*>(image)->bytes_ = bytes;
    else
      std::free(bytes);
    return 0;
  }

  static void* same(void* image) { return image; }

  static herr_t keep(void*) { return 0; }

  void* bytes_ = nullptr;
  std::size_t size_ = 0;
};

/// HDF5 never writes to the disk itself, as 1.10.8 crashes when that is full.
void lay_out(const Record& record, Image& image) {
  const Hdf5Session session;
  const Hdf5Handle access = image.access();
  Hdf5Handle file = made(H5Fcreate("in memory", H5F_ACC_TRUNC, H5P_DEFAULT, access.id()), H5Fclose);
  add_record(file.id(), record);
  check(file.close() ? 0 : -1);
}

void require_matching(const Channel& channel, std::size_t count, std::string_view what) {
  if (count == 0 || count == channel.size()) return;
  throw std::invalid_argument(fmt::format("write_record: channel '{}' has {} {} for {} samples",
                                          channel.name, count, what, channel.size()));
}

[[noreturn]] void fail_with(int error) {
  throw WriteFailure{std::generic_category().message(error)};
}

/// Writes all bytes and waits until they are on the disk.
void write_bytes(const std::string& path, std::string_view bytes) {
  struct Descriptor {
    int id;

    ~Descriptor() {
      if (id >= 0) close(id);
    }
  };

  const Descriptor file{open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)};
  if (file.id < 0) fail_with(errno);
  while (!bytes.empty()) {
    const ssize_t count = write(file.id, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail_with(errno);
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  if (fsync(file.id) != 0) fail_with(errno);
}

/// Under another name first, so that a crash leaves the old file or the new one.
void publish(const std::string& path, std::string_view bytes) {
  const std::string part = path + ".part";
  try {
    write_bytes(part, bytes);
    if (std::rename(part.c_str(), path.c_str()) != 0) fail_with(errno);
  } catch (const WriteFailure&) {
    std::remove(part.c_str());
    throw;
  }
}

}  // namespace

void write_record(const Record& record, const std::string& path) {
  for (const Channel& channel : record.channels) {
    require_matching(channel, channel.clock.times.size(), "times");
    require_matching(channel, channel.imaginary.size(), "imaginary parts");
    require_matching(channel, channel.valid.size(), "validity flags");
  }
  try {
    Image image;
    lay_out(record, image);
    publish(path, image.bytes());
  } catch (const WriteFailure& failure) {
    throw FileError(path, "cannot be written: " + failure.reason);
  }
}

}  // namespace impactrig::datasets
