// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/impact.hpp"
#include "datasets/record.hpp"

namespace impactrig::datasets {

/// Writes a record as an HDF5 file laid out for h5py, MATLAB and HDF5 browsers (docs/formats.md):
/// raw samples with their scale, an NXdata group with time axis and SI values, calibration,
/// provenance. The file appears under its name only when complete. Throws FileError.
void write_record(const Record& record, const std::string& path);

/// Reads what write_record wrote, bit for bit. Throws FileError when the file cannot be opened,
/// InputError when it is cut short, is no HDF5 file, or is an HDF5 file of somebody else's.
Record read_record(const std::string& path);

/// A recording in our file, opened: its samples are read piece by piece.
class StoredRecord {
 public:
  /// Throws what read_record throws.
  explicit StoredRecord(const std::string& path);
  ~StoredRecord();
  StoredRecord(const StoredRecord&) = delete;
  StoredRecord& operator=(const StoredRecord&) = delete;

  /// Channels without samples, times and marks.
  const Record& head() const;

  std::uint64_t samples(std::size_t channel) const;
  bool has_times(std::size_t channel) const;

  /// A piece of the stated times of a channel that has them [s]. Throws InputError.
  std::vector<double> times(std::size_t channel, std::uint64_t first, std::size_t count) const;

  /// A piece of a channel's samples with the times, imaginary parts and marks that go with them,
  /// into a channel that may be used again for the same one's next piece. Throws InputError.
  void piece(std::size_t channel, std::uint64_t first, std::size_t count, Channel& to) const;

 private:
  class File;
  std::unique_ptr<File> file_;
};

/// True when the first bytes of a file (at least 8) are HDF5's signature.
bool looks_like_hdf5(std::string_view head);

}  // namespace impactrig::datasets
