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
#include "datasets/store_parts.hpp"

namespace impactrig::datasets {

namespace {

void add_raw(hid_t parent, const std::string& name, std::size_t index, const Channel& channel) {
  const Hdf5Handle group = add_group(parent, name, "NXcollection");
  describe_channel(group.id(), index, channel);
  const Hdf5Handle samples = std::visit(
      [&](const auto& raw) { return add_data(group.id(), "samples", raw); }, channel.raw);
  describe_samples(samples.id(), channel);
  if (!channel.clock.uniform())
    describe_times(add_data(group.id(), "times", channel.clock.times).id());
  if (channel.complex())
    describe_imaginary(add_data(group.id(), "imaginary", channel.imaginary).id(), channel);
  if (!channel.valid.empty()) describe_valid(add_data(group.id(), "valid", channel.valid).id());
}

void add_channels(hid_t entry, const std::vector<Channel>& channels) {
  std::vector<std::string> titles;
  for (const Channel& channel : channels) titles.push_back(channel.name);
  const std::vector<std::string> names = group_names(titles);
  const Hdf5Handle raw = add_group(entry, "raw", "NXcollection");
  const Hdf5Handle calibration = add_group(entry, "calibration", "NXcollection");
  const Hdf5Handle quicklook = add_group(entry, "quicklook", "NXcollection");
  std::vector<ShownChannel> shown;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const Channel& channel = channels[i];
    add_raw(raw.id(), names[i], i, channel);
    add_calibration(calibration.id(), names[i], channel);
    if (channel.size() > 0)
      add_quicklook(quicklook.id(), names[i], channel.name, channel.size(),
                    quicklook_of(channel, layout::quicklook_points));
    shown.push_back({names[i], channel.quantity, channel.size()});
  }
  show_first(entry, quicklook.id(), shown);
}

void add_record(hid_t file, const Record& record) {
  add_file_head(file);
  const Hdf5Handle entry = add_group(file, "entry", "NXentry");
  add_channels(entry.id(), record.channels);
  describe_record(entry.id(), record);
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
