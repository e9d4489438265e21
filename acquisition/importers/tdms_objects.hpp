// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/importers/byte_cursor.hpp"
#include "acquisition/importers/mapped_file.hpp"
#include "acquisition/importers/stored_numbers.hpp"
#include "acquisition/importers/tdms_scaling.hpp"

namespace impactrig::acquisition {

/// What the numbers of a type are to us.
enum class TdmsRole { number, complex, time, text, nothing, unsupported };

/// A type of numbers or properties.
struct TdmsType {
  std::uint32_t code;
  std::string_view name;
  TdmsRole role;
  NumberKind kind;
  std::uint32_t size;  ///< [bytes]; 0 text and nothing
};

/// None for a code that is not known.
const TdmsType* tdms_type(std::uint32_t code);

/// Where a DAQmx channel's numbers lie within a row of one of the raw buffers.
struct TdmsScaler {
  std::uint32_t id;
  NumberKind kind;
  std::uint32_t buffer;
  std::uint32_t offset;  ///< [bytes]
  int bit;               ///< of a digital line, from 0; -1 the whole number
};

/// What a chunk of raw data holds of a channel.
struct TdmsRawIndex {
  const TdmsType* type = nullptr;  ///< null for DAQmx raw data but time stamps
  std::uint64_t count = 0;         ///< values in a chunk
  std::uint64_t bytes = 0;         ///< in a chunk; DAQmx: shared, 0
  bool daqmx = false;
  std::vector<TdmsScaler> scalers{};
  std::vector<std::uint32_t> widths{};  ///< of the rows of each raw buffer [bytes]
};

/// The numbers of a channel from one scaler (DAQmx), or all it has.
struct TdmsSource {
  std::uint32_t id = TdmsScaling::raw_data;
  int bit = -1;
  StoredNumbers numbers{};
  StoredNumbers imaginary{};
};

/// Samples of a channel of which the same properties hold.
struct TdmsPart {
  TdmsProperties properties{};
  const TdmsType* type = nullptr;  ///< of the raw data so far
  std::vector<TdmsSource> sources{};
  std::uint64_t texts = 0;
  std::uint64_t first_value = 0;  ///< byte offsets of a time stamp channel's ends
  std::uint64_t last_value = 0;
  std::size_t segment = 1;  ///< of the file, where they begin
  double after = 0.0;  ///< what parts before take up since the stated start [s, or as abscissa]
  /// Of TDM: its numbers are the abscissa of its group; its times are DIAdem's; one mark a sample,
  /// whose lowest bit says that it is sound.
  bool is_axis = false;
  bool diadem_times = false;
  StoredNumbers marks{};
  std::uint64_t announced = 0;  ///< of TDM: samples, where the file ends before them

  std::uint64_t samples() const { return sources.empty() ? 0 : sources.front().numbers.size(); }
};

/// The file, a group or a channel, with its latest part.
struct TdmsObject : TdmsPart {
  std::string path{};
  std::string group{};
  std::string name{};
  int depth = 0;  ///< 0 the file, 1 a group, 2 a channel
  std::optional<TdmsRawIndex> index{};
  bool listed = false;  ///< in the list of the segment at hand
  bool has_data = false;
  std::vector<TdmsPart> earlier{};  ///< parts before, in their order
  TdmsProperties carried_on{};      ///< the latest start that only said where the samples went on
  bool scales_change = false;       ///< of the file or a group: once there were samples
};

/// Throws datasets::InputError at a byte, or at the end of the file.
[[noreturn]] void fail_in_tdms(const MappedFile& file, std::uint64_t at, std::string_view problem);

/// A length, then a text of that length, as it is.
std::string_view read_tdms_text(ByteCursor& in, std::string_view what);

TdmsTime read_tdms_time(ByteCursor& in);

/// The value of a property; none for a type that no property has.
std::optional<TdmsProperty> read_tdms_value(ByteCursor& in, std::uint32_t code);

/// A raw data index behind its `header`, which says of what sort it is. Throws
/// datasets::InputError for what cannot be.
TdmsRawIndex read_tdms_index(const MappedFile& file, ByteCursor& in, std::uint32_t header,
                             const TdmsObject& object);

}  // namespace impactrig::acquisition
