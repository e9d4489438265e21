// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "acquisition/importers/byte_cursor.hpp"
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/stored_numbers.hpp"

/// Rigol oscilloscopes' own waveforms: each family has a layout of its own. DS1000Z, DS1000E/D and
/// DS2000 are read.
///
/// Source of the layouts: Rigol, "DS1000Z Waveform Storage Structure", "DS1000E/D WFM structure
/// instruction" and "WFM save format" (DS2000), as scottprahl/RigolWFM (ksy/) and mabl/pyRigolWFM
/// write them out; where these leave the zero of the digitizer open, from recordings beside the
/// oscilloscope's own CSV.
namespace impactrig::acquisition {

using datasets::Channel;
using datasets::InputError;
using datasets::Record;
using namespace std::string_view_literals;

namespace {

constexpr std::string_view magic_1000z = "\x01\xFF\xFF\xFF";
constexpr std::string_view magic_1000e = "\xA5\xA5\x00\x00"sv;

/// Families that are recognised and not read.
struct Family {
  std::string_view magic;
  std::string_view name;
  std::string_view instead = "CSV";  ///< how the oscilloscope can save what is read
};

constexpr std::string_view magic_2000 = "\xA5\xA5\x38\x00"sv;  // also of the 4000 and 6000

constexpr std::array<Family, 4> not_read = {{
    {"\xA1\xA5\x00\x00"sv, "DS1000C"},
    {"\xA5\xA5\xA4\x01"sv, "DS1000B"},
    {magic_2000, "DS4000 or 6000"},
    // when the trigger was is not in it
    {"\x02\x00\x00\x00"sv, "DHO800, 900 or 1000", ".bin or CSV"},
}};

/// A field of a header, wherever it lies.
class Fields {
 public:
  explicit Fields(const MappedFile& file) : file_(file), in_(file) {}

  template <typename Number>
  Number at(std::uint64_t offset) {
    in_.seek(offset);
    return in_.read<Number>("the header");
  }

  std::string text(std::uint64_t offset, std::uint64_t size) {
    in_.seek(offset);
    return fixed_text(in_.bytes(size, "the header"));
  }

  [[noreturn]] void fail(std::uint64_t offset, const std::string& problem) const {
    throw InputError(file_.byte_position(offset), problem);
  }

 private:
  const MappedFile& file_;
  ByteCursor in_;
};

/// A sample interval [s] of a rate [Hz] in single precision.
double interval_of(float rate, double unit = 1.0) {
  const double meant = meant_by_float(rate) * unit;
  return meant > 0.0 && std::isfinite(meant) ? 1.0 / meant : 0.0;
}

void require_samples(const MappedFile& file, const std::vector<StoredChannel>& stored) {
  if (!stored.empty() && stored.front().samples.size() == 0)
    throw InputError(file.byte_position(file.bytes().size()),
                     "the file ends before its first sample");
}

/// What the header of a DS1000Z says of all its inputs.
struct Header1000z {
  unsigned enabled = 0;      ///< a bit an input
  std::uint64_t stride = 1;  ///< bytes from one sample of an input to the next
  std::uint64_t points = 0;  ///< of each input
  std::uint64_t data = 0;    ///< byte of the first sample
  double interval = 0.0;     ///< [s]
  double delay = 0.0;        ///< [s]
  bool other_zero = false;   ///< known to one count only

  bool has(std::uint64_t input) const { return (enabled >> input & 1U) != 0; }
};

Header1000z header_1000z(Fields& fields, Record& record) {
  const std::string model = fields.text(8, 20);
  const std::string firmware = fields.text(28, 20);
  set_attribute(record, "model", model);
  set_attribute(record, "firmware", firmware);
  Header1000z header;
  header.enabled = fields.at<std::uint8_t>(88);
  const auto depth = fields.at<std::uint32_t>(116);
  header.interval = interval_of(fields.at<float>(120), 1e9);
  header.delay = static_cast<double>(fields.at<std::int64_t>(72)) * 1e-12;
  header.data =
      std::uint64_t{fields.at<std::uint32_t>(260)} + std::uint64_t{fields.at<std::uint32_t>(256)};
  std::uint64_t inputs = 0;
  for (std::uint64_t input = 0; input < 4; ++input) inputs += header.has(input) ? 1 : 0;
  if (inputs == 0)
    fields.fail(88,
                "no analog input was switched on: digital inputs are not read, save them as "
                "CSV on the oscilloscope");
  if (fields.at<std::uint32_t>(108) != 0)
    record.warnings.push_back("the digital inputs are not read");
  // bytes of the inputs alternate; of three there are four, one of them idle
  header.stride = inputs == 3 ? 4 : inputs;
  header.points = depth / header.stride;
  // this firmware puts the zero elsewhere with two inputs: to one count, by its own CSV files
  header.other_zero = firmware == "00.04.04.SP3" && inputs == 2;
  if (header.other_zero)
    record.warnings.push_back(
        fmt::format("the zero of firmware {} with two inputs is known to one count of the "
                    "digitizer only",
                    firmware));
  return header;
}

/// An input of a DS1000Z, counted from 0, without its samples.
Channel channel_1000z(const MappedFile& file, Fields& fields, const Header1000z& header,
                      std::uint64_t input) {
  const std::uint64_t head = 124 + 28 * input;
  Channel channel;
  channel.name = fmt::format("CH {}", input + 1);
  constexpr std::array<std::string_view, 4> units = {"W", "A", "V", ""};
  const auto unit = fields.at<std::uint8_t>(head + 17);
  set_unit(channel, unit < units.size() ? units[unit] : std::string_view());
  const bool inverted = fields.at<std::uint8_t>(head + 16) != 0;
  const double division = static_cast<double>(fields.at<float>(head + 8)) * (inverted ? -1 : 1);
  const double shift = fields.at<float>(head + 12);
  // 20 counts a division around 127; the trace lies a division above that
  double bias = division;
  if (header.other_zero) bias = shift < 0.0 ? division / 5.0 : 0.0;
  set_scale(channel, division / 20.0, bias - shift - 127.0 * division / 20.0, file, head + 8);
  set_axis(channel, header.delay - static_cast<double>(header.points) * header.interval / 2.0,
           header.interval, "s");
  channel.attributes["volts per division"] = fmt::format("{}", std::abs(division));
  constexpr std::array<std::string_view, 3> couplings = {"DC", "AC", "ground"};
  const auto coupling = fields.at<std::uint8_t>(head + 1);
  if (coupling < couplings.size()) set_attribute(channel, "coupling", couplings[coupling]);
  return channel;
}

/// Where the samples of an input begin: of two inputs the first has the odd bytes, of four the last
/// comes first.
std::uint64_t samples_1000z(const Header1000z& header, std::uint64_t input) {
  std::uint64_t place = 0;
  if (header.stride == 2) place = (header.enabled & ((1U << input) - 1U)) == 0 ? 1 : 0;
  if (header.stride == 4) place = 3 - input;
  return header.data + place;
}

std::unique_ptr<RecordingReader> open_1000z(std::unique_ptr<MappedFile> file) {
  Fields fields(*file);
  Record record;
  const Header1000z header = header_1000z(fields, record);
  std::vector<StoredChannel> stored;
  for (std::uint64_t input = 0; input < 4; ++input) {
    if (!header.has(input)) continue;
    Channel channel = channel_1000z(*file, fields, header, input);
    const std::uint64_t begin = samples_1000z(header, input);
    const std::uint64_t there =
        numbers_there(*file, begin, header.stride, NumberKind::u8, header.points);
    if (there < header.points)
      record.warnings.push_back(cut_off(channel.name, there, header.points));
    StoredNumbers numbers(NumberKind::u8);
    numbers.add({begin, there, header.stride});
    stored.push_back({numbers});
    record.channels.push_back(std::move(channel));
  }
  if (header.points > 0) require_samples(*file, stored);
  return reader_of_numbers(std::move(file), std::move(record), std::move(stored));
}

/// What the header of a DS1000E or D says of both its inputs.
struct Header1000e {
  std::array<bool, 2> enabled{};
  std::array<std::uint64_t, 2> depths{};  ///< samples in the file
  std::uint64_t skip = 0;                 ///< of them that are not sound
  bool alternating = false;               ///< each input has its own time base
};

constexpr std::array<std::uint64_t, 2> heads_1000e = {36, 60};

Header1000e header_1000e(Fields& fields, std::uint64_t file_size, Record& record) {
  Header1000e header;
  const auto roll_stop = fields.at<std::uint32_t>(20);
  header.enabled = {fields.at<std::uint8_t>(heads_1000e[0] + 13) != 0,
                    fields.at<std::uint8_t>(heads_1000e[1] + 13) != 0};
  const std::uint64_t depth1 = fields.at<std::uint32_t>(28);
  const auto depth2_stated = fields.at<std::uint32_t>(232);
  header.depths = {depth1, depth2_stated == 0 ? depth1 : std::uint64_t{depth2_stated}};
  // older models have samples at 272 or 256: DS1000C with this magic
  const std::uint64_t announced =
      (header.enabled[0] ? depth1 : 0) + (header.enabled[1] ? header.depths[1] : 0);
  if (announced > 0 && (file_size == 256 + announced || file_size == 272 + announced))
    fields.fail(0,
                "this is a waveform of a Rigol DS1000C, which is not read: save it as CSV on "
                "the oscilloscope");
  if (!header.enabled[0] && !header.enabled[1])
    fields.fail(heads_1000e[0] + 13,
                "no analog input was switched on: digital inputs are not read, save "
                "them as CSV on the oscilloscope");
  if (fields.at<std::uint8_t>(120) % 2 != 0)
    record.warnings.push_back("the digital inputs are not read");
  header.alternating = fields.at<std::uint8_t>(142) == 4;
  header.skip = roll_stop == 0 ? 0 : std::uint64_t{roll_stop} + 2;
  return header;
}

/// An input of a DS1000E or D, counted from 0, without its samples.
Channel channel_1000e(const MappedFile& file, Fields& fields, const Header1000e& header,
                      std::uint64_t input) {
  const std::uint64_t head = heads_1000e[input];
  Channel channel;
  channel.name = fmt::format("CH {}", input + 1);
  set_unit(channel, "V");
  const double probe = fields.at<float>(head + 8);
  const double division = 1e-6 * fields.at<std::int32_t>(head + 16) * probe;
  const bool inverted = fields.at<std::uint8_t>(head + 14) != 0;
  const double shift = fields.at<std::int16_t>(head + 20);
  // 25 counts a division, downwards from 125
  const double count = division / 25.0;
  set_scale(channel, -count, (125.0 - shift) * count, file, head + 16);
  channel.attributes["volts per division"] = fmt::format("{}", division);
  channel.attributes["probe attenuation"] = fmt::format("{}", probe);
  if (inverted) channel.attributes["inverted"] = "yes";
  const std::uint64_t time = header.alternating && input == 1 ? 236 : 84;
  const double interval = interval_of(fields.at<float>(time + 16));
  const double delay = static_cast<double>(fields.at<std::int64_t>(time + 28)) * 1e-12;
  set_axis(channel, delay - static_cast<double>(header.depths[input]) * interval / 2.0, interval,
           "s");
  return channel;
}

std::unique_ptr<RecordingReader> open_1000e(std::unique_ptr<MappedFile> file) {
  Fields fields(*file);
  Record record;
  const Header1000e header = header_1000e(fields, file->bytes().size(), record);
  std::vector<StoredChannel> stored;
  std::uint64_t offset = 276;
  for (std::uint64_t input = 0; input < 2; ++input) {
    if (!header.enabled[input]) continue;
    Channel channel = channel_1000e(*file, fields, header, input);
    const std::uint64_t depth = header.depths[input];
    const std::uint64_t points = depth > header.skip ? depth - header.skip : 0;
    stored.push_back(
        {numbers_at(*file, offset, points, NumberKind::u8, false, channel.name, record)});
    if (header.skip > 0)
      record.warnings.push_back(fmt::format("'{}': rolling was stopped: {} of {} samples are sound",
                                            channel.name, points, depth));
    offset += depth;
    record.channels.push_back(std::move(channel));
    if (points > 0 && stored.size() == 1) require_samples(*file, stored);
  }
  return reader_of_numbers(std::move(file), std::move(record), std::move(stored));
}

/// What the header of a DS2000 says of all its inputs.
struct Header2000 {
  unsigned enabled = 0;                   ///< a bit an input
  bool interwoven = false;                ///< one input has the memory of both, by turns
  std::array<std::uint64_t, 2> begins{};  ///< bytes of the first samples
  std::uint64_t points = 0;               ///< of each input
  double interval = 0.0;                  ///< [s]
  double delay = 0.0;                     ///< [s]
};

Header2000 header_2000(Fields& fields, Record& record) {
  set_attribute(record, "serial number", fields.text(4, 20));
  const std::string firmware = fields.text(24, 20);
  set_attribute(record, "firmware", firmware);
  Header2000 header;
  header.enabled = fields.at<std::uint8_t>(64) & 3U;
  header.interwoven = (fields.at<std::uint8_t>(65) & 1U) != 0;
  if (header.enabled == 0)
    fields.fail(64,
                "no analog input was switched on: digital inputs are not read, save them as "
                "CSV on the oscilloscope");
  if (header.interwoven && header.enabled == 3)
    fields.fail(65, "two inputs are said to share the memory of both");
  const std::uint64_t unsound = fields.at<std::uint32_t>(248);
  header.begins = {fields.at<std::uint32_t>(68) + unsound, fields.at<std::uint32_t>(72) + unsound};
  header.points = fields.at<std::uint32_t>(252);
  header.interval = interval_of(fields.at<float>(96));
  header.delay = static_cast<double>(fields.at<std::int64_t>(112)) * 1e-12;
  if (firmware == "00.03.00.01.03" && header.delay != 0.0)
    record.warnings.push_back(
        fmt::format("firmware {} may state a time of the trigger that it does not show: {} s",
                    firmware, header.delay));
  return header;
}

/// An input of a DS2000, counted from 0, without its samples.
Channel channel_2000(const MappedFile& file, Fields& fields, const Header2000& header,
                     std::uint64_t input) {
  const std::uint64_t head = 120 + 28 * input;
  // the order of the two came to be another as the byte of the input became 8
  const bool older = fields.at<std::uint8_t>(head) == 1;
  Channel channel;
  channel.name = fmt::format("CH {}", input + 1);
  constexpr std::array<std::string_view, 4> units = {"W", "A", "V", ""};
  const auto unit = fields.at<std::uint8_t>(head + (older ? 17 : 16));
  set_unit(channel, unit < units.size() ? units[unit] : std::string_view());
  const bool inverted = fields.at<std::uint8_t>(head + (older ? 16 : 17)) == 1;
  const double division = meant_by_float(fields.at<float>(head + 8)) * (inverted ? -1.0 : 1.0);
  const double shift = meant_by_float(fields.at<float>(head + 12));
  // 25 counts a division around 127
  set_scale(channel, division / 25.0, -127.0 * division / 25.0 - shift, file, head + 8);
  set_axis(channel, header.delay - static_cast<double>(header.points) * header.interval / 2.0,
           header.interval, "s");
  channel.attributes["volts per division"] = fmt::format("{}", std::abs(division));
  if (inverted) channel.attributes["inverted"] = "yes";
  return channel;
}

/// Samples that lie in two places by turns.
StoredNumbers by_turns(const MappedFile& file, const Header2000& header, const std::string& name,
                       Record& record) {
  const auto [first, second] = header.begins;
  if (second <= first)
    throw InputError(file.byte_position(72), "the second half of the samples precedes the first");
  const std::uint64_t pairs = header.points / 2;
  const std::uint64_t there = numbers_there(file, second, 1, NumberKind::u8, pairs);
  if (there < pairs) record.warnings.push_back(cut_off(name, 2 * there, header.points));
  StoredNumbers numbers(NumberKind::u8);
  if (there > 0) numbers.add({first, 2, second - first, there, 1});
  return numbers;
}

std::unique_ptr<RecordingReader> open_2000(std::unique_ptr<MappedFile> file) {
  Fields fields(*file);
  Record record;
  const Header2000 header = header_2000(fields, record);
  std::vector<StoredChannel> stored;
  for (std::uint64_t input = 0; input < 2; ++input) {
    if ((header.enabled >> input & 1U) == 0) continue;
    Channel channel = channel_2000(*file, fields, header, input);
    stored.push_back({header.interwoven ? by_turns(*file, header, channel.name, record)
                                        : numbers_at(*file, header.begins[input], header.points,
                                                     NumberKind::u8, false, channel.name, record)});
    record.channels.push_back(std::move(channel));
  }
  if (header.points > 0) require_samples(*file, stored);
  return reader_of_numbers(std::move(file), std::move(record), std::move(stored));
}

/// Families that share their first bytes are told apart by the serial number.
bool is_2000(std::string_view head) {
  return head.starts_with(magic_2000) && head.substr(magic_2000.size()).starts_with("DS2");
}

}  // namespace

int recognises_rigol_wfm(std::string_view file_name, std::string_view head) {
  if (head.starts_with(magic_1000z) || head.starts_with(magic_1000e)) return 100;
  for (const Family& family : not_read)
    if (head.starts_with(family.magic))
      // this one's first bytes are but a number
      return family.magic.front() != '\x02' ? 100 : file_name.ends_with(".wfm") ? 60 : 0;
  return 0;
}

std::unique_ptr<RecordingReader> open_rigol_wfm(const std::string& path, const ImportOptions&) {
  auto file = std::make_unique<MappedFile>(path);
  const std::string_view bytes = file->bytes();
  if (bytes.starts_with(magic_1000z)) return open_1000z(std::move(file));
  if (bytes.starts_with(magic_1000e)) return open_1000e(std::move(file));
  if (is_2000(bytes)) return open_2000(std::move(file));
  for (const Family& family : not_read)
    if (bytes.starts_with(family.magic))
      throw InputError(file->byte_position(0),
                       fmt::format("this is a waveform of a Rigol {}, which is not read: save it "
                                   "as {} on the oscilloscope",
                                   family.name, family.instead));
  throw InputError(file->byte_position(0), "this is no waveform of a Rigol oscilloscope");
}

}  // namespace impactrig::acquisition
