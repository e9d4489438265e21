// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "acquisition/importers/byte_cursor.hpp"
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/stored_numbers.hpp"

/// Rigol oscilloscopes' own waveforms: each family has a layout of its own. DS1000Z and DS1000E/D
/// are read.
///
/// Source of the layouts: Rigol, "DS1000Z Waveform Storage Structure" and "DS1000E/D WFM structure
/// instruction", as scottprahl/RigolWFM (ksy/) and mabl/pyRigolWFM write them out; where these
/// leave the zero of the digitizer open, from recordings beside the oscilloscope's own CSV.
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
};

constexpr std::array<Family, 4> not_read = {{
    {"\xA1\xA5\x00\x00"sv, "DS1000C"},               //
    {"\xA5\xA5\xA4\x01"sv, "DS1000B"},               //
    {"\xA5\xA5\x38\x00"sv, "DS2000, 4000 or 6000"},  //
    {"\x02\x00\x00\x00"sv, "DHO800, 900 or 1000"},   //
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

std::unique_ptr<RecordingReader> open_1000z(std::unique_ptr<MappedFile> file) {
  Fields fields(*file);
  Record record;
  const std::string model = fields.text(8, 20);
  const std::string firmware = fields.text(28, 20);
  set_attribute(record, "model", model);
  set_attribute(record, "firmware", firmware);
  const auto enabled = fields.at<std::uint8_t>(88);
  const auto depth = fields.at<std::uint32_t>(116);
  const double interval = interval_of(fields.at<float>(120), 1e9);
  const double delay = static_cast<double>(fields.at<std::int64_t>(72)) * 1e-12;
  const std::uint64_t data =
      std::uint64_t{fields.at<std::uint32_t>(260)} + std::uint64_t{fields.at<std::uint32_t>(256)};
  std::uint64_t inputs = 0;
  for (int i = 0; i < 4; ++i) inputs += enabled >> i & 1U;
  if (inputs == 0)
    fields.fail(88,
                "no analog input was switched on: digital inputs are not read, save them as "
                "CSV on the oscilloscope");
  if (fields.at<std::uint32_t>(108) != 0)
    record.warnings.push_back("the digital inputs are not read");
  // bytes of the inputs alternate; of three there are four, one of them idle
  const std::uint64_t stride = inputs == 3 ? 4 : inputs;
  const std::uint64_t points = depth / stride;
  // this firmware puts the zero elsewhere with two inputs: to one count, by its own CSV files
  const bool other_zero = firmware == "00.04.04.SP3" && inputs == 2;
  if (other_zero)
    record.warnings.push_back(
        fmt::format("the zero of firmware {} with two inputs is known to one count of the "
                    "digitizer only",
                    firmware));

  std::vector<StoredChannel> stored;
  for (std::uint64_t input = 0; input < 4; ++input) {
    if ((enabled >> input & 1U) == 0) continue;
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
    if (other_zero) bias = shift < 0.0 ? division / 5.0 : 0.0;
    set_scale(channel, division / 20.0, bias - shift - 127.0 * division / 20.0, *file, head + 8);
    set_axis(channel, delay - static_cast<double>(points) * interval / 2.0, interval, "s");
    channel.attributes["volts per division"] = fmt::format("{}", std::abs(division));
    constexpr std::array<std::string_view, 3> couplings = {"DC", "AC", "ground"};
    const auto coupling = fields.at<std::uint8_t>(head + 1);
    if (coupling < couplings.size()) set_attribute(channel, "coupling", couplings[coupling]);
    // of two inputs the first has the odd bytes, of four the last comes first
    std::uint64_t place = 0;
    if (stride == 2) place = (enabled & ((1U << input) - 1U)) == 0 ? 1 : 0;
    if (stride == 4) place = 3 - input;
    const std::uint64_t there = numbers_there(*file, data + place, stride, NumberKind::u8, points);
    if (there < points) record.warnings.push_back(cut_off(channel.name, there, points));
    StoredNumbers numbers(NumberKind::u8);
    numbers.add({data + place, there, stride});
    stored.push_back({numbers});
    record.channels.push_back(std::move(channel));
  }
  if (points > 0) require_samples(*file, stored);
  return reader_of_numbers(std::move(file), std::move(record), std::move(stored));
}

std::unique_ptr<RecordingReader> open_1000e(std::unique_ptr<MappedFile> file) {
  constexpr std::uint64_t data = 276;
  Fields fields(*file);
  Record record;
  const auto roll_stop = fields.at<std::uint32_t>(20);
  const std::array<std::uint64_t, 2> heads = {36, 60};
  const std::array<bool, 2> enabled = {fields.at<std::uint8_t>(heads[0] + 13) != 0,
                                       fields.at<std::uint8_t>(heads[1] + 13) != 0};
  const std::uint64_t depth1 = fields.at<std::uint32_t>(28);
  const auto depth2_stated = fields.at<std::uint32_t>(232);
  const std::array<std::uint64_t, 2> depths = {
      depth1, depth2_stated == 0 ? depth1 : std::uint64_t{depth2_stated}};
  // older models have samples at 272 or 256: DS1000C with this magic
  const std::uint64_t announced = (enabled[0] ? depth1 : 0) + (enabled[1] ? depths[1] : 0);
  const std::uint64_t size = file->bytes().size();
  if (announced > 0 && (size == 256 + announced || size == 272 + announced))
    fields.fail(0,
                "this is a waveform of a Rigol DS1000C, which is not read: save it as CSV on "
                "the oscilloscope");
  if (!enabled[0] && !enabled[1])
    fields.fail(heads[0] + 13,
                "no analog input was switched on: digital inputs are not read, save "
                "them as CSV on the oscilloscope");
  if (fields.at<std::uint8_t>(120) % 2 != 0)
    record.warnings.push_back("the digital inputs are not read");
  const bool alternating = fields.at<std::uint8_t>(142) == 4;  // each input has its own time base
  const std::uint64_t skip = roll_stop == 0 ? 0 : std::uint64_t{roll_stop} + 2;

  std::vector<StoredChannel> stored;
  std::uint64_t offset = data;
  for (std::uint64_t input = 0; input < 2; ++input) {
    if (!enabled[input]) continue;
    const std::uint64_t head = heads[input];
    Channel channel;
    channel.name = fmt::format("CH {}", input + 1);
    set_unit(channel, "V");
    const double probe = fields.at<float>(head + 8);
    const double division = 1e-6 * fields.at<std::int32_t>(head + 16) * probe;
    const bool inverted = fields.at<std::uint8_t>(head + 14) != 0;
    const double shift = fields.at<std::int16_t>(head + 20);
    // 25 counts a division, downwards from 125
    const double count = division / 25.0;
    set_scale(channel, -count, (125.0 - shift) * count, *file, head + 16);
    channel.attributes["volts per division"] = fmt::format("{}", division);
    channel.attributes["probe attenuation"] = fmt::format("{}", probe);
    if (inverted) channel.attributes["inverted"] = "yes";
    const std::uint64_t time = alternating && input == 1 ? 236 : 84;
    const double interval = interval_of(fields.at<float>(time + 16));
    const double delay = static_cast<double>(fields.at<std::int64_t>(time + 28)) * 1e-12;
    const std::uint64_t depth = depths[input];
    set_axis(channel, delay - static_cast<double>(depth) * interval / 2.0, interval, "s");
    const std::uint64_t points = depth > skip ? depth - skip : 0;
    stored.push_back(
        {numbers_at(*file, offset, points, NumberKind::u8, false, channel.name, record)});
    if (skip > 0)
      record.warnings.push_back(fmt::format("'{}': rolling was stopped: {} of {} samples are sound",
                                            channel.name, points, depth));
    offset += depth;
    record.channels.push_back(std::move(channel));
    if (points > 0 && stored.size() == 1) require_samples(*file, stored);
  }
  return reader_of_numbers(std::move(file), std::move(record), std::move(stored));
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
  for (const Family& family : not_read)
    if (bytes.starts_with(family.magic))
      throw InputError(file->byte_position(0),
                       fmt::format("this is a waveform of a Rigol {}, which is not read: save it "
                                   "as CSV on the oscilloscope",
                                   family.name));
  throw InputError(file->byte_position(0), "this is no waveform of a Rigol oscilloscope");
}

}  // namespace impactrig::acquisition
