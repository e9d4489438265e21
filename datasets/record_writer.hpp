// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "datasets/record.hpp"

namespace impactrig::datasets {

/// Writes a recording whose samples come in blocks as the HDF5 file that write_record writes, but
/// for one thing: samples are not compressed, as that takes twenty times as long as writing them.
/// Memory does not grow with the recording. The file appears under its name with finish(); until
/// then it is path.part, which goes when the writer is destroyed without it.
///
/// Every function throws FileError, after which nothing is left of the file.
class RecordWriter {
 public:
  /// `names` of the channels to come.
  RecordWriter(const std::string& path, const std::vector<std::string>& names);
  ~RecordWriter();
  RecordWriter(const RecordWriter&) = delete;
  RecordWriter& operator=(const RecordWriter&) = delete;

  /// The next samples of a channel; all of a channel's are of one type. `imaginary` and `valid` are
  /// empty or one a sample.
  void append(std::size_t channel, const RawSpan& raw, std::span<const double> imaginary = {},
              std::span<const std::uint8_t> valid = {});

  /// The next stated times [s] of a channel whose clock is not uniform.
  void append_times(std::size_t channel, std::span<const double> times);

  /// Writes what is known of the record now: its channels, without samples, are those appended to.
  void finish(const Record& record);

 private:
  class File;
  std::unique_ptr<File> file_;
};

}  // namespace impactrig::datasets
