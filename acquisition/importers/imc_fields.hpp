// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
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
  /// Which x is that of the first sample: 0 none, 1 the one of the buffer (Cb), 2 `start`.
  int start_usage = 1;
  std::string unit;
};

/// The date and time of the key NT.
struct ImcTrigger {
  int year = 0;  ///< 0: not stated
  int month = 0;
  int day = 0;
  int hour = 0;
  int minute = 0;
  double second = 0.0;
};

/// One event of a list of events (CV).
struct ImcEvent {
  std::uint64_t first = 0;  ///< sample
  std::uint64_t count = 0;  ///< samples
  double time = 0.0;        ///< [s]
  double shift = 0.0;
  double start = 0.0;  ///< x of the first sample
  double factor = 1.0;
  double interval = 0.0;
};

/// Which events of which list a component has (Cv).
struct ImcEventReference {
  long list = 0;  ///< number of the key CV
  std::uint64_t first = 0;
  std::uint64_t step = 1;  ///< from one event to the next
  std::uint64_t count = 0;
  bool own_axis = false;   ///< starts and intervals are those of the list
  bool own_scale = false;  ///< so are factors and offsets
};

/// What a key Cb says of one buffer.
struct ImcBuffer {
  long samples_key = 0;  ///< number of the key CS
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
  std::uint64_t first = 0;  ///< first sample in a buffer that is a ring [bytes]
  std::uint64_t filled = 0;
  bool new_event = true;                    ///< else it goes on where the one before ends
  double start = 0.0;                       ///< x of the first sample
  double add_time = 0.0;                    ///< [s] to the trigger time
  std::optional<std::uint64_t> samples_at;  ///< in the file, once its CS has come
  std::uint64_t samples_bytes = 0;
};

/// What the key CN says.
struct ImcName {
  int bit = 0;  ///< of digital words, from 1; 0 all of them
  std::string name;
  std::string comment;
};

/// A component: one row of numbers, or one bit of the words of a digital one.
struct ImcComponent {
  std::uint64_t place = 0;
  long index = 1;  ///< 1 y, 2 x where there are two
  bool digital = false;
  int bit = 0;  ///< as ImcName
  std::vector<ImcName> other_bits{};
  bool named = false;
  int bytes = 0;
  int number_format = 0;
  std::uint64_t mask = 0;      ///< bits to be ignored
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
  std::uint64_t segment = 0;  ///< samples of a segment (CZ), 0: none
  ImcTrigger trigger;
  std::optional<ImcEventReference> events;
};

/// A group of components: one, or an y and its x.
struct ImcField {
  int type = 1;
  std::vector<ImcComponent> components;
};

/// What the keys of an imc FAMOS file say.
struct ImcContents {
  bool big_endian = false;
  bool closed = true;  ///< by the program that wrote it
  std::vector<ImcField> fields{};
  std::map<long, std::vector<ImcEvent>> events{};  ///< by the number of the key CV
  std::vector<std::string> left_out{};             ///< a sentence each
};

/// Reads the keys; `record` takes what they say of the file. Throws datasets::InputError.
ImcContents read_imc_fields(const MappedFile& file, datasets::Record& record);

}  // namespace impactrig::acquisition
