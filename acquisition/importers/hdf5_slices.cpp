// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/hdf5_sender.hpp"

#include <hdf5.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "acquisition/importers/hdf5_open_file.hpp"
#include "acquisition/importers/hdf5_types.hpp"
#include "datasets/hdf5_handle.hpp"

namespace impactrig::acquisition {

using datasets::Hdf5Handle;

namespace {

/// Lists in records, as many rows as were read last.
struct Lists {
  std::uint64_t first = 0, rows = 0;
  std::vector<char> bytes{};
};

/// Those of each field, by the type they were read as.
class KeptLists {
 public:
  Lists& of(const Hdf5Array& array, hid_t number) {
    return fields_[{array.path, array.field_path, H5Tget_class(number), H5Tget_size(number)}];
  }

 private:
  std::map<std::tuple<std::string, std::vector<std::string>, H5T_class_t, std::size_t>, Lists>
      fields_;
};

/// How many samples of a slice are sent at once.
std::uint64_t block_of(const Hdf5Slice& slice) {
  constexpr std::uint64_t most_numbers = std::uint64_t{1} << 21;  // of all lists of a field
  std::uint64_t longest = 1;
  for (const Hdf5Slice* one : {&slice, slice.times.get()})
    if (one != nullptr) longest = std::max(longest, one->array->elements);
  return std::min<std::uint64_t>(hdf5_block_size,
                                 std::max<std::uint64_t>(most_numbers / longest, 1));
}

/// One slice on its way out.
class SliceReader {
 public:
  SliceReader(hid_t file, const Hdf5Slice& slice, KeptLists& lists)
      : slice_(&slice),
        lists_(&lists) {
    const Hdf5Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
    H5Pset_chunk_cache(access.id(), 12421, std::size_t{32} << 20, 1.0);
    data_ = Hdf5Handle(H5Dopen2(file, slice.array->path.c_str(), access.id()), H5Dclose);
    if (slice.times != nullptr)
      times_ = Hdf5Handle(H5Dopen2(file, slice.times->array->path.c_str(), access.id()), H5Dclose);
    at_ = slice.first;
    left_ = slice.count;
  }

  bool done() const { return left_ == 0; }

  /// False when HDF5 cannot read it.
  bool send(std::size_t index, const PipeWriter& out) {
    const std::uint64_t count = std::min(block_of(*slice_), left_);
    const Hdf5Array& array = *slice_->array;
    bytes_.resize(count * width_of(array.numbers));
    std::vector<double> imaginary;
    if (array.complex) {
      imaginary.resize(count);
      if (!read(data_.id(), *slice_, part_of_complex(0).id(), count, bytes_.data()) ||
          !read(data_.id(), *slice_, part_of_complex(1).id(), count, imaginary.data()))
        return false;
    } else if (!read_numbers(data_.id(), *slice_, hdf5_memory_type(array.numbers), count,
                             bytes_.data())) {
      return false;
    }
    std::vector<double> times;
    if (slice_->times != nullptr) {
      times.resize(count);
      if (!read_numbers(times_.id(), *slice_->times, H5T_NATIVE_DOUBLE, count, times.data()))
        return false;
    }
    out.number(index);
    out.number(count);
    out.bytes(bytes_.data(), bytes_.size());
    if (slice_->array->complex) out.bytes(imaginary.data(), count * sizeof(double));
    if (slice_->times != nullptr) out.bytes(times.data(), count * sizeof(double));
    at_ += count;
    left_ -= count;
    return true;
  }

 private:
  /// The real part of a complex number is its first field.
  Hdf5Handle part_of_complex(unsigned part) const {
    const Hdf5Handle type(H5Dget_type(data_.id()), H5Tclose);
    char* const name = H5Tget_member_name(type.id(), part);
    const std::string field = name == nullptr ? "" : name;
    H5free_memory(name);
    return hdf5_field_type({field}, H5T_NATIVE_DOUBLE);
  }

  /// Reads numbers, which are what the slice asks for: as they are, or less the first of all.
  bool read_numbers(hid_t data, const Hdf5Slice& slice, hid_t number, std::uint64_t count,
                    void* to) {
    if (!slice.from_first) return read_as(data, slice, number, count, to);
    if (!first_) {
      std::int64_t first = 0;
      const std::uint64_t at = std::exchange(at_, 0);
      const bool there = read_as(data, slice, H5T_NATIVE_INT64, 1, &first);
      at_ = at;
      if (!there) return false;
      first_ = first;
    }
    std::vector<std::int64_t> integers(count);
    if (!read_as(data, slice, H5T_NATIVE_INT64, count, integers.data())) return false;
    std::ranges::transform(integers, static_cast<double*>(to), [this](std::int64_t integer) {
      // modulo 2^64, for the difference of integers of any sign
      return static_cast<double>(static_cast<std::int64_t>(static_cast<std::uint64_t>(integer) -
                                                           static_cast<std::uint64_t>(*first_)));
    });
    return true;
  }

  /// Reads numbers of a data set or of a field.
  bool read_as(hid_t data, const Hdf5Slice& slice, hid_t number, std::uint64_t count, void* to) {
    const Hdf5Array& array = *slice.array;
    if (array.bits && H5Tget_class(number) != H5T_BITFIELD)
      return read_as(data, slice, hdf5_bits_of(array.numbers), count, to) &&
             H5Tconvert(hdf5_memory_type(array.numbers), number, count, to, nullptr, H5P_DEFAULT) >=
                 0;
    if (array.field_path.empty()) return read(data, slice, number, count, to);
    if (array.elements == 0)
      return read(data, slice, hdf5_field_type(array.field_path, number).id(), count, to);
    return read_element(data, slice, number, count, static_cast<char*>(to));
  }

  /// Reads one number of each list. HDF5 reads whole lists: they are kept for the slices of their
  /// other numbers.
  bool read_element(hid_t data, const Hdf5Slice& slice, hid_t number, std::uint64_t count,
                    char* to) {
    const Hdf5Array& array = *slice.array;
    const hsize_t length = array.elements;
    const std::size_t width = H5Tget_size(number);
    Lists& lists = lists_->of(array, number);
    if (lists.first != at_ || lists.rows < count) {
      lists = {at_, count, std::vector<char>(count * length * width)};
      const Hdf5Handle list(H5Tarray_create2(number, 1, &length), H5Tclose);
      const Hdf5Handle type = hdf5_field_type(array.field_path, list.id());
      if (!read(data, slice, type.id(), count, lists.bytes.data())) {
        lists = {};
        return false;
      }
    }
    for (std::uint64_t i = 0; i < count; ++i)
      std::memcpy(to + i * width, lists.bytes.data() + (i * length + array.element) * width, width);
    return true;
  }

  bool read(hid_t data, const Hdf5Slice& slice, hid_t type, std::uint64_t count, void* to) const {
    const Hdf5Handle space(H5Dget_space(data), H5Sclose);
    const auto& shape = slice.array->shape;
    if (H5Sget_simple_extent_ndims(space.id()) != static_cast<int>(shape.size())) return false;
    const hsize_t size = count;
    const Hdf5Handle memory(H5Screate_simple(1, &size, nullptr), H5Sclose);
    if (shape.empty()) return H5Dread(data, type, memory.id(), H5S_ALL, H5P_DEFAULT, to) >= 0;
    if (slice.whole && shape.size() > 1)
      return read_whole(data, space.id(), shape, type, count, to);
    const std::size_t along = shape.size() == 1 ? 0 : slice.along;
    const std::vector<std::uint64_t> places = places_of(slice);
    std::vector<hsize_t> start(places.begin(), places.end());
    std::vector<hsize_t> block(shape.size(), 1);
    start[along] = at_;
    block[along] = count;
    if (H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start.data(), nullptr, block.data(),
                            nullptr) < 0)
      return false;
    return H5Dread(data, type, memory.id(), space.id(), H5P_DEFAULT, to) >= 0;
  }

  /// Numbers in the file's order from a data set of several dimensions: rows of the fastest
  /// dimension, one after another.
  bool read_whole(hid_t data, hid_t space, const std::vector<std::uint64_t>& shape, hid_t type,
                  std::uint64_t count, void* to) const {
    const std::size_t rank = shape.size();
    const std::size_t width = H5Tget_size(type);
    auto* out = static_cast<char*>(to);
    std::uint64_t at = at_;
    while (count > 0) {
      std::vector<hsize_t> start(rank);
      std::uint64_t rest = at;
      for (std::size_t d = rank; d-- > 0;) {
        start[d] = rest % shape[d];
        rest /= shape[d];
      }
      std::vector<hsize_t> block(rank, 1);
      block[rank - 1] = std::min<std::uint64_t>(count, shape[rank - 1] - start[rank - 1]);
      // whole rows together, where nothing is cut off
      if (start[rank - 1] == 0 && block[rank - 1] == shape[rank - 1])
        block[rank - 2] =
            std::min<std::uint64_t>(count / shape[rank - 1], shape[rank - 2] - start[rank - 2]);
      const hsize_t size = block[rank - 1] * block[rank - 2];
      const Hdf5Handle memory(H5Screate_simple(1, &size, nullptr), H5Sclose);
      if (H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, block.data(), nullptr) <
              0 ||
          H5Dread(data, type, memory.id(), space, H5P_DEFAULT, out) < 0)
        return false;
      out += size * width;
      at += size;
      count -= size;
    }
    return true;
  }

  const Hdf5Slice* slice_;
  Hdf5Handle data_{H5I_INVALID_HID, H5Dclose};
  Hdf5Handle times_{H5I_INVALID_HID, H5Dclose};
  std::uint64_t at_ = 0;
  std::uint64_t left_ = 0;
  std::optional<std::int64_t> first_;  ///< of the integers that are handed over less their first
  std::vector<char> bytes_;
  KeptLists* lists_;
};

}  // namespace

void send_hdf5_slices(const std::string& path, const std::vector<Hdf5Slice>& slices,
                      const PipeWriter& out) {
  const Hdf5OpenFile open(path);
  KeptLists lists;
  std::vector<SliceReader> readers;
  for (const Hdf5Slice& slice : slices) readers.emplace_back(open.file.id(), slice, lists);
  // all channels in step: those of one table find its pieces unpacked
  for (bool more = open.file.valid(); more;) {
    more = false;
    for (std::size_t i = 0; i < readers.size(); ++i) {
      if (readers[i].done()) continue;
      if (!readers[i].send(i, out)) {
        out.number(hdf5_end_of_blocks);
        out.number(i);
        return;
      }
      more = more || !readers[i].done();
    }
  }
  out.number(hdf5_end_of_blocks);
  out.number(hdf5_end_of_blocks);
}

}  // namespace impactrig::acquisition
