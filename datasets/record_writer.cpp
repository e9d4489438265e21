// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/record_writer.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <limits>
#include <optional>
#include <system_error>

#include "datasets/hdf5_handle.hpp"
#include "datasets/hdf5_write.hpp"
#include "datasets/input_error.hpp"
#include "datasets/quicklook_builder.hpp"
#include "datasets/store_layout.hpp"
#include "datasets/store_parts.hpp"
#include "datasets/units.hpp"

namespace impactrig::datasets {

namespace {

// pieces go to the disk as they lie in memory
static_assert(std::endian::native == std::endian::little);

/// A data set of one dimension that grows by pieces, each written at once and not compressed.
class GrowingData {
 public:
  template <typename Number>
  GrowingData(hid_t parent, const char* name, Number)
      : number_bytes_(sizeof(Number)),
        data_(made_in(parent, name, hdf5_file_type(Number{}))) {}

  hid_t id() const { return data_.id(); }

  std::uint64_t count() const { return count_; }

  template <typename Number>
  void append(std::span<const Number> numbers) {
    const auto* bytes = reinterpret_cast<const char*>(numbers.data());
    std::size_t left = numbers.size() * number_bytes_;
    count_ += numbers.size();
    const std::size_t piece = layout::chunk * number_bytes_;
    while (left > 0) {
      if (buffer_.empty() && left >= piece) {
        write(bytes, piece);
        bytes += piece;
        left -= piece;
        continue;
      }
      const std::size_t step = std::min(left, piece - buffer_.size());
      buffer_.insert(buffer_.end(), bytes, bytes + step);
      bytes += step;
      left -= step;
      if (buffer_.size() == piece) flush();
    }
  }

  /// Writes what is left and sets the size.
  void finish() {
    if (!buffer_.empty()) {
      buffer_.resize(layout::chunk * number_bytes_, '\0');
      flush();
    }
    const hsize_t size = count_;
    check(H5Dset_extent(data_.id(), &size));
  }

 private:
  static Hdf5Handle made_in(hid_t parent, const char* name, hid_t type) {
    const hsize_t none = 0;
    const hsize_t unlimited = H5S_UNLIMITED;
    const hsize_t piece = layout::chunk;
    const Hdf5Handle space = made(H5Screate_simple(1, &none, &unlimited), H5Sclose);
    const Hdf5Handle properties = made(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    check(H5Pset_chunk(properties.id(), 1, &piece));
    check(H5Pset_fill_time(properties.id(), H5D_FILL_TIME_NEVER));
    return made(
        H5Dcreate2(parent, name, type, space.id(), H5P_DEFAULT, properties.id(), H5P_DEFAULT),
        H5Dclose);
  }

  void flush() {
    write(buffer_.data(), buffer_.size());
    buffer_.clear();
  }

  void write(const char* bytes, std::size_t size) {
    const hsize_t first = written_;
    written_ += layout::chunk;
    const hsize_t extent = written_;
    check(H5Dset_extent(data_.id(), &extent));
    check(H5Dwrite_chunk(data_.id(), H5P_DEFAULT, 0, &first, size, bytes));
  }

  std::size_t number_bytes_;
  Hdf5Handle data_;
  std::uint64_t count_ = 0;
  std::uint64_t written_ = 0;
  std::vector<char> buffer_;
};

/// What is written of one channel so far.
struct ChannelData {
  Hdf5Handle group;
  std::optional<GrowingData> samples, imaginary, times, valid;
  QuicklookBuilder look{layout::quicklook_points};
};

}  // namespace

class RecordWriter::File {
 public:
  File(std::string path, const std::vector<std::string>& names)
      : path_(std::move(path)),
        part_(path_ + ".part"),
        names_(group_names(names)) {
    // opened first without HDF5, whose errors do not say why a file cannot be made; then removed,
    // as ext4 writes a file that was emptied to the disk before it lets it be closed
    std::FILE* const probe = std::fopen(part_.c_str(), "wb");
    if (probe == nullptr) fail(std::generic_category().message(errno));
    std::fclose(probe);
    std::remove(part_.c_str());
    guarded([&] {
      const Hdf5Handle access = made(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
      check(H5Pset_libver_bounds(access.id(), H5F_LIBVER_V18, H5F_LIBVER_V110));
      check(H5Pset_fclose_degree(access.id(), H5F_CLOSE_STRONG));
      file_ = made(H5Fcreate(part_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()), H5Fclose);
      add_file_head(file_->id());
      entry_ = add_group(file_->id(), "entry", "NXentry");
      const Hdf5Handle raw = add_group(entry_->id(), "raw", "NXcollection");
      for (const std::string& name : names_)
        channels_.push_back({add_group(raw.id(), name, "NXcollection"), {}, {}, {}, {}});
    });
  }

  ~File() {
    if (!file_) return;
    const Hdf5Session session;
    abandon();
  }

  File(const File&) = delete;
  File& operator=(const File&) = delete;

  void append(std::size_t index, const RawSpan& raw, std::span<const double> imaginary,
              std::span<const std::uint8_t> valid) {
    guarded([&] {
      ChannelData& channel = channels_.at(index);
      const std::uint64_t before = channel.samples ? channel.samples->count() : 0;
      std::visit(
          [&](auto samples) {
            append_to(channel.samples, channel, "samples", samples);
            if (valid.empty()) return channel.look.add(samples, imaginary);
            shown_.assign(samples.begin(), samples.end());
            for (std::size_t i = 0; i < valid.size(); ++i)
              if (valid[i] == 0) shown_[i] = std::numeric_limits<double>::quiet_NaN();
            channel.look.add(std::span<const double>(shown_), imaginary);
          },
          raw);
      if (!imaginary.empty()) append_to(channel.imaginary, channel, "imaginary", imaginary);
      append_valid(channel, before, valid);
    });
  }

  void append_times(std::size_t index, std::span<const double> times) {
    if (times.empty()) return;
    guarded([&] {
      ChannelData& channel = channels_.at(index);
      append_to(channel.times, channel, "times", times);
    });
  }

  void finish(const Record& record) {
    guarded([&] {
      const Hdf5Handle calibration = add_group(entry_->id(), "calibration", "NXcollection");
      const Hdf5Handle quicklook = add_group(entry_->id(), "quicklook", "NXcollection");
      std::vector<ShownChannel> shown;
      for (std::size_t i = 0; i < channels_.size(); ++i) {
        const Channel& channel = record.channels.at(i);
        finish_channel(i, channel);
        add_calibration(calibration.id(), names_[i], channel);
        const std::uint64_t samples = channels_[i].look.samples();
        if (samples > 0)
          add_quicklook(quicklook.id(), names_[i], channel.name, samples, look_of(i, channel));
        shown.push_back({names_[i], channel.quantity, samples});
      }
      show_first(entry_->id(), quicklook.id(), shown);
      describe_record(entry_->id(), record);
      channels_.clear();
      entry_.reset();
      check(file_->close() ? 0 : -1);
    });
    file_.reset();
    if (std::rename(part_.c_str(), path_.c_str()) == 0) return;
    const int error = errno;
    std::remove(part_.c_str());
    fail(std::generic_category().message(error));
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw FileError(path_, "cannot be written: " + why);
  }

  /// Runs HDF5 code; what fails leaves no file.
  template <typename Work>
  void guarded(const Work& work) {
    const Hdf5Session session;
    errno = 0;
    try {
      work();
    } catch (const WriteFailure& failure) {
      const int error = errno;
      abandon();
      fail(error == ENOSPC || error == EFBIG || error == EDQUOT
               ? std::generic_category().message(error)
               : failure.reason);
    }
  }

  /// HDF5 1.10.8 cannot close a file whose last pages find no room: it is made empty first.
  void abandon() {
    [[maybe_unused]] const int emptied = ::truncate(part_.c_str(), 0);
    channels_.clear();
    entry_.reset();
    file_.reset();
    std::remove(part_.c_str());
  }

  template <typename Number>
  static void append_to(std::optional<GrowingData>& data, ChannelData& channel, const char* name,
                        std::span<const Number> numbers) {
    if (!data) data.emplace(channel.group.id(), name, Number{});
    data->append(numbers);
  }

  /// Marks are written from the first sample that is not sound on; those before it are.
  static void append_valid(ChannelData& channel, std::uint64_t before,
                           std::span<const std::uint8_t> valid) {
    const std::uint64_t after = channel.samples->count();
    if (!channel.valid && valid.empty()) return;
    if (!channel.valid) channel.valid.emplace(channel.group.id(), "valid", std::uint8_t{});
    const std::vector<std::uint8_t> sound(layout::chunk, 1);
    const std::uint64_t until = valid.empty() ? after : before;
    while (channel.valid->count() < until)
      channel.valid->append(std::span<const std::uint8_t>(sound).first(static_cast<std::size_t>(
          std::min<std::uint64_t>(until - channel.valid->count(), sound.size()))));
    channel.valid->append(valid);
  }

  void finish_channel(std::size_t index, const Channel& channel) {
    ChannelData& data = channels_[index];
    describe_channel(data.group.id(), index, channel);
    if (!data.samples) data.samples.emplace(data.group.id(), "samples", double{});
    describe_samples(data.samples->id(), channel);
    for (std::optional<GrowingData>* part :
         {&data.samples, &data.imaginary, &data.times, &data.valid})
      if (*part) (*part)->finish();
    if (data.times) describe_times(data.times->id());
    if (data.imaginary) describe_imaginary(data.imaginary->id(), channel);
    if (data.valid) describe_valid(data.valid->id());
  }

  Quicklook look_of(std::size_t index, const Channel& channel) {
    const std::string_view si = si_unit(channel.quantity);
    const auto to_si = si.empty() ? std::nullopt : conversion(channel.unit, si);
    const UnitConversion to_shown = to_si.value_or(UnitConversion{});
    Quicklook look;
    look.unit = to_si ? std::string(si) : channel.unit;
    const std::vector<QuicklookBuilder::Point> points = channels_[index].look.points();
    for (const QuicklookBuilder::Point& point : points) {
      look.values.push_back(to_shown.factor * (channel.scale * point.value + channel.offset) +
                            to_shown.offset);
      if (channels_[index].imaginary) look.imaginary.push_back(to_shown.factor * point.imaginary);
      look.time.push_back(channel.clock.start +
                          channel.clock.interval * static_cast<double>(point.sample));
    }
    if (channels_[index].times) read_times(channels_[index].times->id(), points, look.time);
    return look;
  }

  /// The stated times of these samples, read back.
  static void read_times(hid_t data, const std::vector<QuicklookBuilder::Point>& points,
                         std::vector<double>& times) {
    std::vector<hsize_t> samples;
    for (const QuicklookBuilder::Point& point : points) samples.push_back(point.sample);
    const hsize_t count = samples.size();
    const Hdf5Handle memory = made(H5Screate_simple(1, &count, nullptr), H5Sclose);
    const Hdf5Handle space = made(H5Dget_space(data), H5Sclose);
    check(H5Sselect_elements(space.id(), H5S_SELECT_SET, samples.size(), samples.data()));
    check(H5Dread(data, H5T_NATIVE_DOUBLE, memory.id(), space.id(), H5P_DEFAULT, times.data()));
  }

  std::string path_;
  std::string part_;
  std::vector<std::string> names_;
  std::optional<Hdf5Handle> file_;
  std::optional<Hdf5Handle> entry_;
  std::vector<ChannelData> channels_;
  std::vector<double> shown_;
};

RecordWriter::RecordWriter(const std::string& path, const std::vector<std::string>& names)
    : file_(std::make_unique<File>(path, names)) {}

RecordWriter::~RecordWriter() = default;

void RecordWriter::append(std::size_t channel, const RawSpan& raw,
                          std::span<const double> imaginary, std::span<const std::uint8_t> valid) {
  file_->append(channel, raw, imaginary, valid);
}

void RecordWriter::append_times(std::size_t channel, std::span<const double> times) {
  file_->append_times(channel, times);
}

void RecordWriter::finish(const Record& record) {
  file_->finish(record);
}

}  // namespace impactrig::datasets
