// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/importers/mapped_file.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// What the key CD says: x = start + i interval.
struct ImcAbscissa {
  double interval = 0.0;
  double start = 0.0;
  bool stated_start = false;
  std::string unit;
};

/// What a key Cb says of one buffer.
struct ImcBuffer {
  long samples_key = 0;  ///< number of the key CS
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
  std::uint64_t first = 0;  ///< first sample in a buffer that is a ring [bytes]
  std::uint64_t filled = 0;
  double start = 0.0;                       ///< x of the first sample
  double add_time = 0.0;                    ///< [s] to the trigger time
  std::optional<std::uint64_t> samples_at;  ///< in the file, once its CS has come
  std::uint64_t samples_bytes = 0;
};

/// A component: one row of numbers.
struct ImcComponent {
  std::uint64_t place = 0;
  bool digital = false;
  int bytes = 0;
  int number_format = 0;
  std::uint64_t offset = 0;    ///< of the first number in a buffer [bytes]
  std::uint64_t count = 1;     ///< numbers side by side
  std::uint64_t distance = 0;  ///< bytes between such groups
  double factor = 1.0;
  double shift = 0.0;
  std::string unit;
  std::string name;
  std::string comment;
  std::string group;
  std::vector<ImcBuffer> buffers;
  ImcAbscissa abscissa;
  std::string trigger;  ///< ISO 8601, or ""
};

/// A group of components: one, or an y and its x.
struct ImcField {
  int type = 1;
  std::vector<ImcComponent> components;
};

/// What the keys of an imc FAMOS file say.
struct ImcContents {
  bool big_endian = false;
  std::vector<ImcField> fields{};
  std::vector<std::string> left_out{};  ///< a sentence each
};

/// Reads the keys; `record` takes what they say of the file. Throws datasets::InputError.
ImcContents read_imc_fields(const MappedFile& file, datasets::Record& record);

}  // namespace impactrig::acquisition
