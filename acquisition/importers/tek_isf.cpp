// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

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
constexpr std::array<std::pair<std::string_view, std::string_view>, 18> spellings = {{
    {"BYT_NR", "BYT_N"},  //
    {"BIT_NR", "BIT_N"},  //
    {"ENCDG", "ENC"},     //
    {"BN_FMT", "BN_F"},   //
    {"BYT_OR", "BYT_O"},  //
    {"NR_PT", "NR_P"},    //
    {"NR_FR", "NR_FR"},   //
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

/// The long spelling of "BYT_N" and the like; the key itself when it is none.
std::string long_spelling(std::string_view key) {
  const std::string name = upper(trimmed(key));
  for (const auto& [full, abbreviated] : spellings)
    if (name == full || name == abbreviated) return std::string(full);
  return name;
}

bool is_known(std::string_view key) {
  return std::ranges::any_of(spellings, [&](const auto& one) { return one.first == key; });
}

bool is_space(char c) {
  return std::isspace(static_cast<unsigned char>(c)) != 0;
}

std::size_t behind_spaces(std::string_view bytes, std::size_t at) {
  while (at < bytes.size() && is_space(bytes[at])) ++at;
  return at;
}

/// True where a preamble begins.
bool is_preamble(std::string_view bytes) {
  const std::string start = upper(trimmed(bytes.substr(0, 64)));
  return start.starts_with(":WFMP") || start.starts_with(":WFMO") || start.starts_with("WFMP") ||
         start.starts_with("WFMO") || start.starts_with("BYT_N") || start.starts_with(":CURV");
}

/// What an answer says of one source.
struct Preamble {
  std::string source;  ///< "CH1" of "CH1:WFID"; "" where the answer does not name its sources
  std::map<std::string, std::string> keys;
};

/// The head of an answer. An answer for several sources states what they have in common, then
/// "CH1:" and what is the first one's own, and so on [Tektronix, TDS Family Oscilloscope Programmer
/// Manual, WFMPre:<wfm>?].
struct IsfHead {
  std::vector<Preamble> preambles{Preamble{}};  ///< one a curve, in their order
  std::size_t curve = std::string_view::npos;   ///< first byte behind the word CURVE
};

constexpr std::string_view one_a_file = "save each source in a file of its own";

class IsfHeadReader {
 public:
  IsfHeadReader(const MappedFile& file, std::size_t at)
      : file_(file),
        bytes_(file.bytes().substr(0, std::min(file.bytes().size(), at + longest_head))),
        at_(at) {}

  IsfHead read() {
    while (at_ < bytes_.size()) {
      // a key ends at a blank; a value at a semicolon that is not quoted
      while (at_ < bytes_.size() && (bytes_[at_] == ';' || is_space(bytes_[at_]))) ++at_;
      const std::size_t first = at_;
      at_ = std::min(bytes_.find_first_of(" ;#\t", at_), bytes_.size());
      const std::string_view header = bytes_.substr(first, at_ - first);
      const std::size_t colon = header.rfind(':');
      const std::string_view name = header.substr(colon + 1);
      if (const std::size_t word = curve_word(name); word > 0) {
        head_.curve = first + (colon + 1) + word;
        return std::move(head_);
      }
      const std::string key = long_spelling(name);
      if (colon != std::string_view::npos && is_known(key)) begin_source(header.substr(0, colon));
      set(key, value());
    }
    return std::move(head_);
  }

 private:
  /// Length of the word CURVE, in which a list of numbers may follow without a blank; 0 for others.
  static std::size_t curve_word(std::string_view name) {
    const std::string start = upper(name.substr(0, 6));
    const std::size_t length = start.starts_with("CURVE") ? 5 : start.starts_with("CURV") ? 4 : 0;
    const bool goes_on =
        start.size() > length && std::isalpha(static_cast<unsigned char>(start[length])) != 0;
    return goes_on ? 0 : length;
  }

  /// Of the path ":WFMPRE:CH1" or "CH1"; others than a source's change nothing.
  void begin_source(std::string_view path) {
    const std::string source = to_utf8(upper(path.substr(path.rfind(':') + 1)));
    if (source.empty() || source.starts_with("WFM")) return;
    if (head_.preambles.back().source == source) return;
    if (head_.preambles.back().source.empty())
      common_ = head_.preambles.back().keys;
    else
      head_.preambles.push_back({"", common_});
    head_.preambles.back().source = source;
  }

  std::string value() {
    const std::size_t start = at_;
    bool quoted = false;
    while (at_ < bytes_.size() && (quoted || bytes_[at_] != ';')) {
      if (bytes_[at_] == '"') quoted = !quoted;
      ++at_;
    }
    std::string_view value = trimmed(bytes_.substr(start, at_ - start));
    if (value.size() >= 2 && value.front() == '"' && value.back() == '"')
      value = value.substr(1, value.size() - 2);
    return to_utf8(trimmed(value));
  }

  void set(const std::string& key, const std::string& value) {
    if (key.empty()) return;
    Preamble& preamble = head_.preambles.back();
    const auto [place, is_new] = preamble.keys.try_emplace(to_utf8(key), value);
    if (is_new || place->second == value) return;
    // a source's own replaces what all have in common
    const auto common = common_.find(place->first);
    const bool replaces =
        !preamble.source.empty() && common != common_.end() && common->second == place->second;
    if (!replaces && is_known(key))
      throw InputError(file_.byte_position(at_),
                       fmt::format("the preamble states {} twice, '{}' and '{}', without naming "
                                   "the source of each: {}",
                                   place->first, place->second, value, one_a_file));
    place->second = value;
  }

  const MappedFile& file_;
  std::string_view bytes_;
  std::size_t at_;
  IsfHead head_;
  std::map<std::string, std::string> common_;  ///< of all sources of the answer
};

/// A curve's waveform, as its preamble has it.
struct Waveform {
  const Preamble* preamble = nullptr;
  Channel channel;
  bool envelope = false;
  std::uint64_t frames = 1;  ///< of a FastFrame sequence

  std::string text(const std::string& key) const {
    const auto found = preamble->keys.find(key);
    return found == preamble->keys.end() ? std::string() : found->second;
  }
};

/// A block of IEEE 488.2, 8.7.9: '#', the number of digits, the digits; #0: to the end.
struct Block {
  std::uint64_t begin = 0;
  std::uint64_t length = 0;  ///< as announced [bytes]
};

Block block_at(const MappedFile& file, std::size_t at) {
  const std::string_view bytes = file.bytes();
  const std::size_t first = at + 2;
  const int digits = at + 1 < bytes.size() ? bytes[at + 1] - '0' : -1;
  if (digits < 0 || digits > 9)
    throw InputError(file.byte_position(at + 1),
                     "expected the number of digits of the curve's length behind '#'");
  if (digits == 0) return {first, bytes.size() - std::min(bytes.size(), first)};
  const std::string_view written =
      bytes.substr(std::min(bytes.size(), first), static_cast<std::size_t>(digits));
  const auto stated = integer_in(written);
  if (!stated || *stated < 0 || written.size() != static_cast<std::size_t>(digits))
    throw InputError(file.byte_position(first),
                     fmt::format("expected the length of the curve, {} digits, found '{}'", digits,
                                 to_utf8(written)));
  return {first + static_cast<std::uint64_t>(digits), static_cast<std::uint64_t>(*stated)};
}

class IsfReader {
 public:
  explicit IsfReader(std::unique_ptr<MappedFile> file) : file_(std::move(file)) {}

  std::unique_ptr<RecordingReader> open() {
    IsfHead head = IsfHeadReader(*file_, 0).read();
    if (head.curve == std::string_view::npos)
      throw InputError(file_->byte_position(0),
                       "this is a Tektronix waveform without its curve: expected ':CURVE ' in its "
                       "first 64 KiB");
    std::size_t at = add_answer(head, true);
    // answers may follow each other
    while (is_preamble(file_->bytes().substr(at))) {
      head = IsfHeadReader(*file_, at).read();
      if (head.curve == std::string_view::npos) break;
      at = add_answer(head, false);
    }
    if (at < file_->bytes().size())
      record_.warnings.push_back(
          fmt::format("{} bytes follow the curve at byte {} and are not read: its head announces "
                      "no more, and they are no other waveform",
                      file_->bytes().size() - at, at));
    if (in_blocks_)
      return reader_of_numbers(std::move(file_), std::move(record_), std::move(stored_));
    return reader_of(std::move(record_));
  }

 private:
  std::optional<double> number(const Waveform& waveform, const std::string& key) const {
    const std::string value = waveform.text(key);
    if (value.empty()) return std::nullopt;
    const auto read = number_in(value);
    if (!read || !std::isfinite(*read))
      throw InputError(file_->byte_position(0),
                       fmt::format("{}: expected a number, found '{}'", key, value));
    return read;
  }

  /// Returns where it ends, behind what separates it from another.
  std::size_t add_answer(const IsfHead& head, bool is_first) {
    std::vector<Waveform> waveforms;
    for (const Preamble& preamble : head.preambles) waveforms.push_back(describe(preamble));
    tell_keys(waveforms, is_first);
    const std::string_view bytes = file_->bytes();
    std::size_t at = behind_spaces(bytes, head.curve);
    const bool block = at < bytes.size() && bytes[at] == '#';
    if (!block && !upper(waveforms.front().text("ENCDG")).starts_with("ASC"))
      throw InputError(file_->byte_position(at),
                       "expected '#' and the length of the curve behind CURVE");
    if (is_first) in_blocks_ = block;
    if (block != in_blocks_)
      throw InputError(file_->byte_position(at),
                       fmt::format("one curve is binary and the other text, which are not read "
                                   "together: {}",
                                   one_a_file));
    at = block ? add_blocks(waveforms, at) : add_texts(waveforms, at);
    while (at < bytes.size() && (bytes[at] == ';' || is_space(bytes[at]))) ++at;
    return at;
  }

  /// The keys are the recording's where it has one waveform, else each channel's own.
  void tell_keys(std::vector<Waveform>& waveforms, bool is_first) {
    if (is_first && waveforms.size() == 1) {
      for (const auto& [key, value] : waveforms.front().preamble->keys)
        set_attribute(record_, key, value);
      record_.title = waveforms.front().text("WFID");
      return;
    }
    for (Channel& channel : record_.channels)
      for (const auto& [key, value] : record_.attributes) set_attribute(channel, key, value);
    record_.attributes.clear();
    record_.title.clear();
    for (Waveform& waveform : waveforms)
      for (const auto& [key, value] : waveform.preamble->keys)
        set_attribute(waveform.channel, key, value);
  }

  Waveform describe(const Preamble& preamble) {
    Waveform waveform;
    waveform.preamble = &preamble;
    Channel& channel = waveform.channel;
    const std::string id = waveform.text("WFID");
    const std::string input(trimmed(id.substr(0, id.find(','))));
    channel.name = !input.empty()             ? input_name(input)
                   : !preamble.source.empty() ? input_name(preamble.source)
                                              : "waveform";
    set_unit(channel, waveform.text("YUNIT"));
    const auto scale = number(waveform, "YMULT");
    if (!scale)
      record_.warnings.push_back(fmt::format(
          "'{}': the preamble has no YMULT: the values are those of the digitizer", channel.name));
    const double factor = scale.value_or(1.0);
    set_scale(
        channel, factor,
        number(waveform, "YZERO").value_or(0.0) - factor * number(waveform, "YOFF").value_or(0.0),
        *file_, 0);
    const std::string points = upper(waveform.text("PT_FMT"));
    waveform.envelope = points.starts_with("ENV");
    if (!points.empty() && points != "Y" && !waveform.envelope)
      throw InputError(file_->byte_position(0),
                       fmt::format("'{}': points of PT_FMT '{}' are not read, expected Y (samples) "
                                   "or ENV (minimum and maximum): save it as CSV",
                                   channel.name, points));
    const double interval = number(waveform, "XINCR").value_or(0.0);
    const double start = number(waveform, "XZERO").value_or(0.0) -
                         interval * number(waveform, "PT_OFF").value_or(0.0);
    // an envelope has two numbers for each place in time [071-0381, PT_Fmt]
    set_axis(channel, start, waveform.envelope ? 2.0 * interval : interval, waveform.text("XUNIT"));
    return waveform;
  }

  NumberKind kind(const Waveform& waveform) const {
    const std::string format = upper(waveform.text("BN_FMT"));
    const auto width = number(waveform, "BYT_NR");
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

  /// How many frames a curve of so many numbers has [Tektronix, TDS5000B Online Programmer Guide,
  /// WFMOutpre?, NR_FR]. Warns when the preamble announces another
  /// number of them.
  std::uint64_t frames_of(const Waveform& waveform, std::uint64_t found) {
    const auto points = number(waveform, "NR_PT");
    const double frames = number(waveform, "NR_FR").value_or(1.0);
    if (!(frames > 1.0)) {
      if (points && *points != static_cast<double>(found))
        record_.warnings.push_back(fmt::format("'{}': NR_PT announces {} samples, the curve has {}",
                                               waveform.channel.name, *points, found));
      return 1;
    }
    if (frames > static_cast<double>(most_channels) ||
        points.value_or(0.0) * frames != static_cast<double>(found))
      throw InputError(
          file_->byte_position(0),
          fmt::format("'{}' is a FastFrame sequence of {} frames (NR_FR) of {} samples "
                      "(NR_PT), but its curve has {}: where a frame ends is not told; "
                      "save each frame in a file of its own",
                      waveform.channel.name, frames, points.value_or(0.0), found));
    record_.warnings.push_back(
        fmt::format("'{}' is a FastFrame sequence of {} frames: each is a channel, with the time "
                    "from its own trigger",
                    waveform.channel.name, frames));
    return static_cast<std::uint64_t>(frames);
  }

  static Channel frame_channel(const Waveform& waveform, std::uint64_t frame,
                               std::uint64_t frames) {
    Channel channel = waveform.channel;
    if (frames > 1) channel.name += fmt::format(", frame {}", frame + 1);
    return channel;
  }

  [[noreturn]] void refuse_curves(std::size_t at, std::size_t preambles, std::string_view found) {
    throw InputError(file_->byte_position(at),
                     fmt::format("the preamble is of {} source{}, {}: which curve is whose is not "
                                 "told; {}",
                                 preambles, preambles == 1 ? "" : "s", found, one_a_file));
  }

  /// Curves of several sources are blocks with commas between them.
  std::size_t add_blocks(const std::vector<Waveform>& waveforms, std::size_t at) {
    const std::string_view bytes = file_->bytes();
    const auto comma_and_block = [&] {
      const std::size_t comma = behind_spaces(bytes, at);
      const std::size_t next = behind_spaces(bytes, comma + 1);
      return comma < bytes.size() && bytes[comma] == ',' && next < bytes.size() &&
                     bytes[next] == '#'
                 ? next
                 : std::string_view::npos;
    };
    for (std::size_t i = 0; i < waveforms.size(); ++i) {
      if (i > 0) {
        const std::size_t next = comma_and_block();
        if (next == std::string_view::npos)
          refuse_curves(at, waveforms.size(),
                        fmt::format("but {} curve{} there", i, i == 1 ? " is" : "s are"));
        at = next;
      }
      const Block block = block_at(*file_, at);
      add_block(waveforms[i], block);
      const bool is_cut =
          block.length > bytes.size() - std::min<std::uint64_t>(bytes.size(), block.begin);
      if (!is_cut) {
        at = static_cast<std::size_t>(block.begin + block.length);
        continue;
      }
      for (std::size_t k = i + 1; k < waveforms.size(); ++k)
        record_.warnings.push_back(
            fmt::format("the file ends before the curve of '{}'", waveforms[k].channel.name));
      return bytes.size();
    }
    if (comma_and_block() != std::string_view::npos)
      refuse_curves(at, waveforms.size(), "but more curves are there");
    return at;
  }

  void add_block(const Waveform& waveform, const Block& block) {
    const std::string order = upper(waveform.text("BYT_OR"));
    if (!order.empty() && order != "MSB" && order != "LSB")
      throw InputError(file_->byte_position(0),
                       fmt::format("BYT_OR: expected MSB or LSB, found '{}'", order));
    const NumberKind number_kind = kind(waveform);
    const std::uint64_t width = size_of(number_kind);
    if (width > 1 && order.empty())
      throw InputError(file_->byte_position(0), "the preamble has no BYT_OR: expected MSB or LSB");
    const std::uint64_t announced = block.length / width;
    const std::uint64_t frames = frames_of(waveform, announced);
    const std::uint64_t points = announced / frames;
    for (std::uint64_t frame = 0; frame < frames; ++frame) {
      const std::uint64_t begin = block.begin + frame * points * width;
      if (frame > 0 && numbers_there(*file_, begin, width, number_kind, points) == 0) {
        record_.warnings.push_back(
            fmt::format("the file ends before frame {} of {}", frame + 1, frames));
        return;
      }
      add_stored(waveform, frame_channel(waveform, frame, frames), {begin, points, width},
                 StoredNumbers(number_kind, order == "MSB"));
    }
  }

  void add_stored(const Waveform& waveform, const Channel& channel, const NumberRun& run,
                  const StoredNumbers& none) {
    const bool is_first = stored_.empty();
    const NumberKind number_kind = none.kind();
    if (!waveform.envelope) {
      stored_.push_back({numbers_at(*file_, run.offset, run.count, number_kind, none.big_endian(),
                                    channel.name, record_)});
      record_.channels.push_back(channel);
    } else {
      const std::uint64_t there =
          numbers_there(*file_, run.offset, run.stride, number_kind, run.count) / 2;
      if (there < run.count / 2)
        record_.warnings.push_back(cut_off(channel.name, there, run.count / 2));
      for (const std::uint64_t which : {0U, 1U}) {
        StoredNumbers numbers = none;
        numbers.add({run.offset + which * run.stride, there, 2 * run.stride});
        stored_.push_back({numbers});
        record_.channels.push_back(channel);
        record_.channels.back().name += which == 0 ? " min" : " max";
      }
    }
    if (is_first && stored_.front().samples.size() == 0 && run.count > 0)
      throw InputError(file_->byte_position(file_->bytes().size()),
                       "the file ends before its first sample");
  }

  /// A curve as text is small: such a transfer is slow. Those of several sources follow each other
  /// as one list.
  std::size_t add_texts(const std::vector<Waveform>& waveforms, std::size_t at) {
    const std::size_t first = at;
    const std::vector<double> all = numbers_of_text(waveforms.front().channel.name, at);
    std::span<const double> left = all;
    if (waveforms.size() == 1) {
      add_text(waveforms.front(), left);
      return at;
    }
    double announced = 0.0;
    for (const Waveform& waveform : waveforms) announced += points_of(waveform);
    if (announced != static_cast<double>(all.size()))
      refuse_curves(first, waveforms.size(),
                    fmt::format("but their NR_PT, {} together, are not the {} numbers of the curve",
                                announced, all.size()));
    for (const Waveform& waveform : waveforms) {
      const auto count = static_cast<std::size_t>(points_of(waveform));
      add_text(waveform, left.first(count));
      left = left.subspan(count);
    }
    return at;
  }

  /// Numbers of all frames that the preamble announces; 0 where it does not say.
  double points_of(const Waveform& waveform) const {
    const double points = number(waveform, "NR_PT").value_or(0.0);
    return std::max(0.0,
                    std::floor(points * std::max(1.0, number(waveform, "NR_FR").value_or(1.0))));
  }

  std::vector<double> numbers_of_text(std::string_view channel, std::size_t& at) const {
    const std::string_view bytes = file_->bytes();
    std::vector<double> samples;
    while (at < bytes.size() && bytes[at] != ';') {
      const std::size_t comma = std::min(bytes.find_first_of(",;", at), bytes.size());
      const std::string_view cell = trimmed(bytes.substr(at, comma - at));
      const auto value = number_in(cell);
      if (!value) {
        // the last number may have been cut off, or a line end stand behind it
        if (comma == bytes.size() && cell.empty()) {
          at = comma;
          break;
        }
        throw InputError(
            file_->byte_position(at),
            fmt::format("{}: expected a number, found '{}'", channel, to_utf8(cell.substr(0, 40))));
      }
      samples.push_back(*value);
      at = comma < bytes.size() && bytes[comma] == ',' ? comma + 1 : comma;
    }
    return samples;
  }

  void add_text(const Waveform& waveform, std::span<const double> samples) {
    const std::uint64_t frames = frames_of(waveform, samples.size());
    const std::size_t points = samples.size() / static_cast<std::size_t>(frames);
    for (std::uint64_t frame = 0; frame < frames; ++frame) {
      const Channel channel = frame_channel(waveform, frame, frames);
      const auto own = samples.subspan(static_cast<std::size_t>(frame) * points, points);
      if (!waveform.envelope) {
        record_.channels.push_back(channel);
        record_.channels.back().raw = std::vector<double>(own.begin(), own.end());
        continue;
      }
      for (const std::size_t which : {0U, 1U}) {
        std::vector<double> half;
        for (std::size_t i = which; i + 1 - which < own.size(); i += 2) half.push_back(own[i]);
        record_.channels.push_back(channel);
        record_.channels.back().name += which == 0 ? " min" : " max";
        record_.channels.back().raw = std::move(half);
      }
    }
  }

  std::unique_ptr<MappedFile> file_;
  Record record_;
  std::vector<StoredChannel> stored_;
  bool in_blocks_ = true;
};

}  // namespace

int recognises_tek_isf(std::string_view, std::string_view head) {
  if (!is_preamble(head)) return 0;
  return head.find("CURV") != std::string_view::npos ? 100 : 90;
}

std::unique_ptr<RecordingReader> open_tek_isf(const std::string& path, const ImportOptions&) {
  return IsfReader(std::make_unique<MappedFile>(path)).open();
}

}  // namespace impactrig::acquisition
