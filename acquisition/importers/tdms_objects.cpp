// SPDX-License-Identifier: BSD-3-Clause
// Layout: National Instruments, "TDMS File Format Internal Structure" (2023); the digital line
// scaler (0x126A in files, 0x1369 in that text) and the types of DAQmx scalers as files have them.
#include "acquisition/importers/tdms_objects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "acquisition/importers/text_file.hpp"

namespace impactrig::acquisition {

namespace {

constexpr std::uint32_t format_changing_scaler = 0x1269;
constexpr std::uint32_t digital_line_scaler = 0x126A;
constexpr std::uint32_t digital_line_scaler_as_documented = 0x1369;

constexpr std::uint64_t most_chunk_bytes = std::uint64_t{1} << 46;  // of one channel: 70 TB

constexpr std::uint32_t text_type = 0x20;
constexpr std::uint32_t time_type = 0x44;
constexpr std::uint32_t daqmx_raw_type = 0xFFFFFFFF;

constexpr std::array<TdmsType, 20> types = {{
    {0x00, "void", TdmsRole::nothing, NumberKind::u8, 0},                               //
    {0x01, "8-bit integer", TdmsRole::number, NumberKind::i8, 1},                       //
    {0x02, "16-bit integer", TdmsRole::number, NumberKind::i16, 2},                     //
    {0x03, "32-bit integer", TdmsRole::number, NumberKind::i32, 4},                     //
    {0x04, "64-bit integer", TdmsRole::number, NumberKind::i64, 8},                     //
    {0x05, "unsigned 8-bit integer", TdmsRole::number, NumberKind::u8, 1},              //
    {0x06, "unsigned 16-bit integer", TdmsRole::number, NumberKind::u16, 2},            //
    {0x07, "unsigned 32-bit integer", TdmsRole::number, NumberKind::u32, 4},            //
    {0x08, "unsigned 64-bit integer", TdmsRole::number, NumberKind::u64, 8},            //
    {0x09, "single precision", TdmsRole::number, NumberKind::f32, 4},                   //
    {0x0A, "double precision", TdmsRole::number, NumberKind::f64, 8},                   //
    {0x0B, "extended precision", TdmsRole::unsupported, NumberKind::f64, 0},            //
    {0x19, "single precision with unit", TdmsRole::number, NumberKind::f32, 4},         //
    {0x1A, "double precision with unit", TdmsRole::number, NumberKind::f64, 8},         //
    {0x1B, "extended precision with unit", TdmsRole::unsupported, NumberKind::f64, 0},  //
    {0x20, "text", TdmsRole::text, NumberKind::u8, 0},                                  //
    {0x21, "boolean", TdmsRole::number, NumberKind::u8, 1},                             //
    {0x44, "time stamp", TdmsRole::time, NumberKind::i64, 16},                          //
    {0x08000C, "complex single precision", TdmsRole::complex, NumberKind::f32, 8},      //
    {0x10000D, "complex double precision", TdmsRole::complex, NumberKind::f64, 16},     //
}};

/// The types of DAQmx scalers, by their code.
constexpr std::array<NumberKind, 10> daqmx_kinds = {
    NumberKind::u8,  NumberKind::i8,  NumberKind::u16, NumberKind::i16, NumberKind::u32,
    NumberKind::i32, NumberKind::u64, NumberKind::i64, NumberKind::f32, NumberKind::f64};
constexpr std::uint32_t daqmx_time_stamp = 0xFFFFFFFF;

const TdmsType& known_type(const MappedFile& file, std::uint32_t code, const TdmsObject& object,
                           std::uint64_t at) {
  const TdmsType* const type = tdms_type(code);
  if (type == nullptr)
    fail_in_tdms(file, at,
                 fmt::format("{} has data of the unknown type 0x{:X}", object.path, code));
  return *type;
}

std::uint64_t counted(const MappedFile& file, ByteCursor& in, const TdmsObject& object) {
  const std::uint64_t at = in.at();
  const auto dimensions = in.read<std::uint32_t>("the dimensions of raw data");
  if (dimensions != 1)
    fail_in_tdms(
        file, at,
        fmt::format("{} has data of {} dimensions, 1 is expected", object.path, dimensions));
  return in.read<std::uint64_t>("the number of values in a chunk");
}

TdmsRawIndex plain_index(const MappedFile& file, ByteCursor& in, const TdmsObject& object) {
  const std::uint64_t at = in.at();
  TdmsRawIndex index;
  index.type = &known_type(file, in.read<std::uint32_t>("the type of raw data"), object, at);
  index.count = counted(file, in, object);
  if (index.type->role == TdmsRole::unsupported && index.count > 0)
    fail_in_tdms(
        file, at,
        fmt::format("{} has numbers of {}, whose width in a file is not published: convert the "
                    "channel to double precision with the program that wrote it",
                    object.path, index.type->name));
  if (index.type->role == TdmsRole::text) {
    index.bytes = in.read<std::uint64_t>("the size of texts");
    if (index.bytes > most_chunk_bytes)
      fail_in_tdms(
          file, at,
          fmt::format("{} announces {} bytes of text in a chunk", object.path, index.bytes));
    return index;
  }
  if (index.type->size == 0) {
    index.count = 0;
    return index;
  }
  if (index.count > most_chunk_bytes / index.type->size)
    fail_in_tdms(file, at,
                 fmt::format("{} announces {} values of {} bytes in a chunk", object.path,
                             index.count, index.type->size));
  index.bytes = index.count * index.type->size;
  return index;
}

TdmsRawIndex daqmx_index(const MappedFile& file, ByteCursor& in, const TdmsObject& object,
                         bool digital) {
  const std::uint64_t at = in.at();
  TdmsRawIndex index;
  index.daqmx = true;
  const auto type = in.read<std::uint32_t>("the type of raw data");
  if (type != daqmx_raw_type) known_type(file, type, object, at);
  index.count = counted(file, in, object);
  const auto scalers = in.read<std::uint32_t>("the number of DAQmx scalers");
  for (std::uint32_t i = 0; i < scalers; ++i) {
    const std::uint64_t here = in.at();
    TdmsScaler scaler{};
    const auto kind = in.read<std::uint32_t>("the type of a DAQmx scaler");
    const bool time = kind == daqmx_time_stamp && type == time_type && scalers == 1;
    if (kind >= daqmx_kinds.size() && !time)
      fail_in_tdms(file, here,
                   fmt::format("{} has a DAQmx scaler of the unknown type {}", object.path, kind));
    if (time) index.type = tdms_type(time_type);
    scaler.kind = time ? index.type->kind : daqmx_kinds[kind];
    scaler.buffer = in.read<std::uint32_t>("the raw buffer of a DAQmx scaler");
    scaler.offset = in.read<std::uint32_t>("the offset of a DAQmx scaler");
    scaler.bit = -1;
    if (digital) {
      scaler.bit = static_cast<int>(scaler.offset % 8);
      scaler.offset /= 8;
      in.skip(1);  // sample format bitmap
    } else {
      in.skip(4);
    }
    scaler.id = in.read<std::uint32_t>("the scale of a DAQmx scaler");
    index.scalers.push_back(scaler);
  }
  const auto widths = in.read<std::uint32_t>("the number of raw buffers");
  for (std::uint32_t i = 0; i < widths; ++i)
    index.widths.push_back(in.read<std::uint32_t>("the width of a raw buffer"));
  for (const TdmsScaler& scaler : index.scalers) {
    const std::uint64_t size = index.type != nullptr ? index.type->size : size_of(scaler.kind);
    const std::uint64_t last = std::uint64_t{scaler.offset} + size;
    if (scaler.buffer >= index.widths.size())
      fail_in_tdms(file, at,
                   fmt::format("{} is in the raw buffer {} of {}", object.path, scaler.buffer,
                               index.widths.size()));
    if (last > index.widths[scaler.buffer])
      fail_in_tdms(
          file, at,
          fmt::format("{} lies in bytes {} to {} of the rows of a raw buffer, which have {}",
                      object.path, scaler.offset, last - 1, index.widths[scaler.buffer]));
    if (index.count > most_chunk_bytes / index.widths[scaler.buffer])
      fail_in_tdms(file, at,
                   fmt::format("{} announces {} values of {} bytes in a chunk", object.path,
                               index.count, index.widths[scaler.buffer]));
  }
  return index;
}

}  // namespace

const TdmsType* tdms_type(std::uint32_t code) {
  const auto found = std::ranges::find(types, code, &TdmsType::code);
  return found == types.end() ? nullptr : &*found;
}

void fail_in_tdms(const MappedFile& file, std::uint64_t at, std::string_view problem) {
  throw datasets::InputError(file.byte_position(std::min<std::uint64_t>(at, file.bytes().size())),
                             problem);
}

std::string_view read_tdms_text(ByteCursor& in, std::string_view what) {
  const auto length = in.read<std::uint32_t>(what);
  return in.bytes(length, what);
}

TdmsTime read_tdms_time(ByteCursor& in) {
  constexpr std::string_view what = "a time stamp";
  TdmsTime time;
  if (in.big_endian()) time.seconds = in.read<std::int64_t>(what);
  time.fraction = in.read<std::uint64_t>(what);
  if (!in.big_endian()) time.seconds = in.read<std::int64_t>(what);
  return time;
}

std::optional<TdmsProperty> read_tdms_value(ByteCursor& in, std::uint32_t code) {
  constexpr std::string_view what = "the value of a property";
  switch (code) {
    case 0x00:
      return std::string();
    case 0x01:
      return std::int64_t{in.read<std::int8_t>(what)};
    case 0x02:
      return std::int64_t{in.read<std::int16_t>(what)};
    case 0x03:
      return std::int64_t{in.read<std::int32_t>(what)};
    case 0x04:
      return in.read<std::int64_t>(what);
    case 0x05:
      return std::uint64_t{in.read<std::uint8_t>(what)};
    case 0x06:
      return std::uint64_t{in.read<std::uint16_t>(what)};
    case 0x07:
      return std::uint64_t{in.read<std::uint32_t>(what)};
    case 0x08:
      return in.read<std::uint64_t>(what);
    case 0x09:
    case 0x19:
      return double{in.read<float>(what)};
    case 0x0A:
    case 0x1A:
      return in.read<double>(what);
    case text_type:
      return to_utf8(read_tdms_text(in, what));
    case 0x21:
      return std::string(in.read<std::uint8_t>(what) != 0 ? "true" : "false");
    case time_type:
      return read_tdms_time(in);
    case 0x08000C: {
      const float re = in.read<float>(what);
      return fmt::format("{}{:+}i", re, in.read<float>(what));
    }
    case 0x10000D: {
      const double re = in.read<double>(what);
      return fmt::format("{}{:+}i", re, in.read<double>(what));
    }
    default:
      return std::nullopt;
  }
}

TdmsRawIndex read_tdms_index(const MappedFile& file, ByteCursor& in, std::uint32_t header,
                             const TdmsObject& object) {
  if (header == format_changing_scaler || header == digital_line_scaler ||
      header == digital_line_scaler_as_documented)
    return daqmx_index(file, in, object, header != format_changing_scaler);
  return plain_index(file, in, object);
}

}  // namespace impactrig::acquisition
