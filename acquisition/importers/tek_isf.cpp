// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <optional>

#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/importers/stored_numbers.hpp"
#include "acquisition/importers/text_file.hpp"

/// Tektronix oscilloscopes' internal save format: the answer to WAVFRM?, a preamble as text and the
/// curve as a block or as text.
///
/// Source: Tektronix, TDS3000 Series Digital Phosphor Oscilloscopes Programmer Manual (071-0381),
/// "Waveform Commands", and MSO4000/DPO4000 Programmer Manual (077-0248), WFMOutpre: keys with long
/// and short spellings, value = (raw - YOFF) YMULT + YZERO, time = XZERO + XINCR (i - PT_OFF).
namespace impactrig::acquisition {

using datasets::Channel;
using datasets::InputError;
using datasets::Record;

namespace {

/// The keys that matter, with their short spelling.
constexpr std::array<std::pair<std::string_view, std::string_view>, 17> spellings = {{
    {"BYT_NR", "BYT_N"},  //
    {"BIT_NR", "BIT_N"},  //
    {"ENCDG", "ENC"},     //
    {"BN_FMT", "BN_F"},   //
    {"BYT_OR", "BYT_O"},  //
    {"NR_PT", "NR_P"},    //
    {"WFID", "WFI"},      //
    {"PT_FMT", "PT_F"},   //
    {"PT_OFF", "PT_O"},   //
    {"XINCR", "XIN"},     //
    {"XZERO", "XZE"},     //
    {"XUNIT", "XUN"},     //
    {"YMULT", "YMU"},     //
    {"YZERO", "YZE"},     //
    {"YOFF", "YOF"},      //
    {"YUNIT", "YUN"},     //
    {"CURVE", "CURV"},    //
}};

constexpr std::size_t longest_head = 65536;

std::string upper(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return out;
}

/// The long spelling of ":WFMPRE:BYT_N", "BYT_NR" and the like; the key itself when it is none.
std::string long_spelling(std::string_view key) {
  const std::string name = upper(trimmed(key.substr(key.rfind(':') + 1)));
  for (const auto& [full, abbreviated] : spellings)
    if (name == full || name == abbreviated) return std::string(full);
  return name;
}

/// The head of such a file.
struct IsfHead {
  std::map<std::string, std::string> keys;
  std::size_t curve = std::string_view::npos;  ///< first byte behind the word CURVE
};

IsfHead read_isf_head(std::string_view bytes) {
  IsfHead head;
  std::size_t at = 0;
  const std::size_t end = std::min(bytes.size(), longest_head);
  while (at < end) {
    // a key ends at a blank; a value at a semicolon that is not quoted
    while (at < end && (bytes[at] == ';' || std::isspace(static_cast<unsigned char>(bytes[at]))))
      ++at;
    const std::size_t first = at;
    while (at < end && bytes[at] != ' ' && bytes[at] != ';' && bytes[at] != '#' &&
           bytes[at] != '\t')
      ++at;
    const std::string key = long_spelling(bytes.substr(first, at - first));
    if (key == "CURVE") {
      head.curve = at;
      return head;
    }
    const std::size_t start = at;
    bool quoted = false;
    while (at < end && (quoted || bytes[at] != ';')) {
      if (bytes[at] == '"') quoted = !quoted;
      ++at;
    }
    std::string_view value = trimmed(bytes.substr(start, at - start));
    if (value.size() >= 2 && value.front() == '"' && value.back() == '"')
      value = value.substr(1, value.size() - 2);
    if (!key.empty()) head.keys[to_utf8(key)] = to_utf8(trimmed(value));
  }
  return head;
}

class IsfReader {
 public:
  explicit IsfReader(std::unique_ptr<MappedFile> file)
      : file_(std::move(file)),
        head_(read_isf_head(file_->bytes())) {
    if (head_.curve == std::string_view::npos)
      throw InputError(file_->byte_position(0),
                       "this is a Tektronix waveform without its curve: expected ':CURVE ' in its "
                       "first 64 KiB");
  }

  std::unique_ptr<RecordingReader> open() {
    describe();
    const std::string_view bytes = file_->bytes();
    std::size_t at = head_.curve;
    while (at < bytes.size() && std::isspace(static_cast<unsigned char>(bytes[at]))) ++at;
    const std::string encoding = upper(text("ENCDG"));
    const bool block = at < bytes.size() && bytes[at] == '#';
    if (!block && !encoding.starts_with("ASC"))
      throw InputError(file_->byte_position(at),
                       "expected '#' and the length of the curve behind CURVE");
    return block ? open_block(at) : read_ascii(at);
  }

 private:
  std::string text(const std::string& key) const {
    const auto found = head_.keys.find(key);
    return found == head_.keys.end() ? std::string() : found->second;
  }

  std::optional<double> number(const std::string& key) const {
    const std::string value = text(key);
    if (value.empty()) return std::nullopt;
    const auto read = number_in(value);
    if (!read || !std::isfinite(*read))
      throw InputError(file_->byte_position(0),
                       fmt::format("{}: expected a number, found '{}'", key, value));
    return read;
  }

  void describe() {
    const std::string id = text("WFID");
    const std::string input = std::string(trimmed(id.substr(0, id.find(','))));
    channel_.name = input.empty() ? "waveform" : input_name(input);
    set_unit(channel_, text("YUNIT"));
    const auto scale = number("YMULT");
    if (!scale)
      record_.warnings.push_back(fmt::format(
          "'{}': the preamble has no YMULT: the values are those of the digitizer", channel_.name));
    const double factor = scale.value_or(1.0);
    set_scale(channel_, factor,
              number("YZERO").value_or(0.0) - factor * number("YOFF").value_or(0.0), *file_, 0);
    envelope_ = upper(text("PT_FMT")).starts_with("ENV");
    const double interval = number("XINCR").value_or(0.0);
    start_ = number("XZERO").value_or(0.0) - interval * number("PT_OFF").value_or(0.0);
    // an envelope has two numbers for each place in time [071-0381, PT_Fmt]
    set_axis(channel_, start_, envelope_ ? 2.0 * interval : interval, text("XUNIT"));
    for (const auto& [key, value] : head_.keys) set_attribute(record_, key, value);
    record_.title = id;
  }

  NumberKind kind() const {
    const std::string format = upper(text("BN_FMT"));
    const auto width = number("BYT_NR");
    if (!width)
      throw InputError(file_->byte_position(0),
                       "the preamble has no BYT_NR: expected the bytes of a sample");
    const bool plain = format.empty() || format == "RI";
    if (plain && *width == 1.0) return NumberKind::i8;
    if (plain && *width == 2.0) return NumberKind::i16;
    if (plain && *width == 4.0) return NumberKind::i32;
    if (format == "RP" && *width == 1.0) return NumberKind::u8;
    if (format == "RP" && *width == 2.0) return NumberKind::u16;
    if (format == "RP" && *width == 4.0) return NumberKind::u32;
    if (format == "FP" && *width == 4.0) return NumberKind::f32;
    if (format == "FP" && *width == 8.0) return NumberKind::f64;
    throw InputError(file_->byte_position(0),
                     fmt::format("samples of BN_FMT '{}' with BYT_NR {} are not read: expected RI, "
                                 "RP or FP with 1, 2 or 4",
                                 format, *width));
  }

  /// Warns when the preamble announces another number of samples.
  void compare_count(std::uint64_t found) {
    const auto announced = number("NR_PT");
    if (announced && *announced != static_cast<double>(found))
      record_.warnings.push_back(fmt::format("'{}': NR_PT announces {} samples, the curve has {}",
                                             channel_.name, *announced, found));
  }

  std::unique_ptr<RecordingReader> open_block(std::size_t at) {
    const std::string_view bytes = file_->bytes();
    const std::string order = upper(text("BYT_OR"));
    if (!order.empty() && order != "MSB" && order != "LSB")
      throw InputError(file_->byte_position(0),
                       fmt::format("BYT_OR: expected MSB or LSB, found '{}'", order));
    const NumberKind number_kind = kind();
    if (size_of(number_kind) > 1 && order.empty())
      throw InputError(file_->byte_position(0), "the preamble has no BYT_OR: expected MSB or LSB");
    // IEEE 488.2, 8.7.9: '#', the number of digits, the digits; #0: to the end
    const std::size_t first = at + 2;
    const int digits = at + 1 < bytes.size() ? bytes[at + 1] - '0' : -1;
    if (digits < 0 || digits > 9)
      throw InputError(file_->byte_position(at + 1),
                       "expected the number of digits of the curve's length behind '#'");
    std::uint64_t length = bytes.size() - std::min(bytes.size(), first);
    std::uint64_t begin = first;
    if (digits > 0) {
      const std::string_view written =
          bytes.substr(std::min(bytes.size(), first), static_cast<std::size_t>(digits));
      const auto stated = integer_in(written);
      if (!stated || *stated < 0 || written.size() != static_cast<std::size_t>(digits))
        throw InputError(file_->byte_position(first),
                         fmt::format("expected the length of the curve, {} digits, found '{}'",
                                     digits, to_utf8(written)));
      length = static_cast<std::uint64_t>(*stated);
      begin += static_cast<std::uint64_t>(digits);
    }
    const std::uint64_t width = size_of(number_kind);
    const std::uint64_t announced = length / width;
    compare_count(announced);
    const bool big_endian = order == "MSB";
    std::vector<StoredChannel> stored;
    if (!envelope_) {
      stored.push_back(
          {numbers_at(*file_, begin, announced, number_kind, big_endian, channel_.name, record_)});
      record_.channels.push_back(std::move(channel_));
    } else {
      const std::uint64_t there = numbers_there(*file_, begin, width, number_kind, announced) / 2;
      if (there < announced / 2)
        record_.warnings.push_back(cut_off(channel_.name, there, announced / 2));
      for (const std::uint64_t which : {0U, 1U}) {
        StoredNumbers numbers(number_kind, big_endian);
        numbers.add({begin + which * width, there, 2 * width});
        stored.push_back({numbers});
        record_.channels.push_back(channel_);
        record_.channels.back().name += which == 0 ? " min" : " max";
      }
    }
    if (stored.front().samples.size() == 0 && announced > 0)
      throw InputError(file_->byte_position(bytes.size()), "the file ends before its first sample");
    return reader_of_numbers(std::move(file_), std::move(record_), std::move(stored));
  }

  /// A curve as text is small: such a transfer is slow.
  std::unique_ptr<RecordingReader> read_ascii(std::size_t at) {
    const std::string_view bytes = file_->bytes();
    std::vector<double> samples;
    while (at < bytes.size() && bytes[at] != ';') {
      const std::size_t comma = std::min(bytes.find_first_of(",;", at), bytes.size());
      const std::string_view cell = trimmed(bytes.substr(at, comma - at));
      const auto value = number_in(cell);
      if (!value) {
        // the last number may have been cut off, or a line end stand behind it
        if (comma == bytes.size() && cell.empty()) break;
        throw InputError(file_->byte_position(at),
                         fmt::format("{}: expected a number, found '{}'", channel_.name,
                                     to_utf8(cell.substr(0, 40))));
      }
      samples.push_back(*value);
      at = comma < bytes.size() && bytes[comma] == ',' ? comma + 1 : comma;
    }
    compare_count(samples.size());
    if (!envelope_) {
      channel_.raw = std::move(samples);
      record_.channels.push_back(std::move(channel_));
      return reader_of(std::move(record_));
    }
    for (const std::size_t which : {0U, 1U}) {
      std::vector<double> half;
      for (std::size_t i = which; i + 1 - which < samples.size(); i += 2)
        half.push_back(samples[i]);
      Channel channel = channel_;
      channel.name += which == 0 ? " min" : " max";
      channel.raw = std::move(half);
      record_.channels.push_back(std::move(channel));
    }
    return reader_of(std::move(record_));
  }

  std::unique_ptr<MappedFile> file_;
  IsfHead head_;
  Record record_;
  Channel channel_;
  bool envelope_ = false;
  double start_ = 0.0;
};

}  // namespace

int recognises_tek_isf(std::string_view, std::string_view head) {
  const std::string start = upper(trimmed(head.substr(0, 64)));
  const bool preamble = start.starts_with(":WFMP") || start.starts_with(":WFMO") ||
                        start.starts_with("WFMP") || start.starts_with("WFMO") ||
                        start.starts_with("BYT_N") || start.starts_with(":CURV");
  if (!preamble) return 0;
  return head.find("CURV") != std::string_view::npos ? 100 : 90;
}

std::unique_ptr<RecordingReader> open_tek_isf(const std::string& path, const ImportOptions&) {
  return IsfReader(std::make_unique<MappedFile>(path)).open();
}

}  // namespace impactrig::acquisition
