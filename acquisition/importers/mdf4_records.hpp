// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/importers/mapped_file.hpp"
#include "acquisition/importers/mdf4_data.hpp"
#include "acquisition/importers/mdf4_mixed.hpp"
#include "acquisition/importers/stored_numbers.hpp"
#include "acquisition/recording_reader.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// How a value lies in a record.
struct MdfField {
  enum class Shape { number, bits, half_float };
  Shape shape = Shape::number;
  bool complex = false;               ///< two of them, the imaginary part last
  NumberKind kind = NumberKind::f64;  ///< number
  bool big_endian = false;
  bool with_sign = false;        ///< bits
  std::uint64_t offset = 0;      ///< of its first byte in the record
  std::uint32_t bit = 0;         ///< bits: of its lowest bit
  std::uint32_t bit_count = 64;  ///< bits

  /// Integers that a double may not hold.
  bool is_wide() const {
    if (shape == Shape::bits) return bit_count > 53;
    return shape == Shape::number && (kind == NumberKind::u64 || kind == NumberKind::i64);
  }

  std::uint64_t bytes() const { return (complex ? 2 : 1) * bytes_of_part(); }

  /// Of the real part, and of the imaginary one.
  std::uint64_t bytes_of_part() const {
    switch (shape) {
      case Shape::number:
        return size_of(kind);
      case Shape::half_float:
        return 2;
      case Shape::bits:
        break;
    }
    return (bit + bit_count + 7) / 8;
  }
};

/// Reads a field of `count` records, `stride` bytes apart.
void read_mdf_field(const MdfField& field, const char* records, std::uint64_t count,
                    std::uint64_t stride, std::vector<double>& to);

/// Changes numbers in place.
using MdfScaling = std::function<void(std::span<double>)>;

/// Channels whose values lie in the same records.
struct MdfGroup {
  std::vector<MdfFragment> fragments;
  std::uint64_t record_bytes = 0;  ///< with record id and invalidation bytes
  std::uint64_t records = 0;
  /// Instead of fragments: data that it shares with other groups, of which its records are a part.
  std::shared_ptr<const MdfMixed> mixed;
  std::string name;               ///< "group 3.1", for warnings; only where mixed
  bool counted = true;            ///< false: `records` has not been compared with the data
  bool estimated = false;         ///< likewise, and there may be more
  std::uint64_t announced = 0;    ///< likewise, by the file
  std::optional<MdfField> times;  ///< of a time master whose clock is not uniform
  MdfScaling times_scaling;
};

/// Where a channel's values lie.
struct MdfChannel {
  std::size_t group = 0;
  MdfField field;
  MdfScaling scaling;
  std::optional<std::uint64_t> invalid_bit;  ///< in the record
  bool never_valid = false;                  ///< the file says that none of its values is
};

/// "group 3 announces 9 records, 7 are there".
std::string mdf_short(std::string_view group, std::uint64_t announced, std::uint64_t there);

/// Reads records by blocks; each gives the values of every channel asked for. `record` has one
/// channel an MdfChannel, without samples.
std::unique_ptr<RecordingReader> reader_of_mdf_records(std::unique_ptr<MappedFile> file,
                                                       datasets::Record record,
                                                       std::vector<MdfGroup> groups,
                                                       std::vector<MdfChannel> channels);

}  // namespace impactrig::acquisition
