// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/importers/stored_numbers.hpp"
#include "acquisition/importers/tek_isf_head.hpp"
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

std::size_t behind_spaces(std::string_view bytes, std::size_t at) {
  while (at < bytes.size() && is_space(bytes[at])) ++at;
  return at;
}

/// A curve's waveform, as its preamble has it.
struct Waveform {
  const IsfPreamble* preamble = nullptr;
  Channel channel;
  bool envelope = false;
  std::uint64_t frames = 1;  ///< of a FastFrame sequence

  std::string text(const std::string& key) const {
    const auto found = preamble->keys.find(key);
    return found == preamble->keys.end() ? std::string() : found->second;
  }
};

/// A block of IEEE 488.2, 8.7.9: '#', the number of digits, the digits; #0 [8.7.10]: to the end,
/// which a line feed marks.
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
  if (digits == 0) {
    const std::size_t end = bytes.size() - (bytes.ends_with('\n') ? 1 : 0);
    return {first, end - std::min(end, first)};
  }
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
    IsfHead head = read_isf_head(*file_, 0);
    if (head.curve == std::string_view::npos)
      throw InputError(file_->byte_position(0),
                       "this is a Tektronix waveform without its curve: expected ':CURVE ' in its "
                       "first 64 KiB");
    std::size_t at = add_answer(head, true);
    // answers may follow each other
    while (begins_isf(file_->bytes().substr(at))) {
      head = read_isf_head(*file_, at);
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
    for (const IsfPreamble& preamble : head.preambles) waveforms.push_back(describe(preamble));
    tell_keys(waveforms, is_first);
    const std::string_view bytes = file_->bytes();
    std::size_t at = behind_spaces(bytes, head.curve);
    const bool block = at < bytes.size() && bytes[at] == '#';
    if (!block && !upper_case(waveforms.front().text("ENCDG")).starts_with("ASC"))
      throw InputError(file_->byte_position(at),
                       "expected '#' and the length of the curve behind CURVE");
    if (is_first) in_blocks_ = block;
    if (block != in_blocks_)
      throw InputError(file_->byte_position(at),
                       fmt::format("one curve is binary and the other text, which are not read "
                                   "together: {}",
                                   one_source_a_file));
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

  Waveform describe(const IsfPreamble& preamble) {
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
    undo_zero_scale(channel, record_);
    const std::string points = upper_case(waveform.text("PT_FMT"));
    waveform.envelope = points.starts_with("ENV");
    if (!points.empty() && points != "Y" && !waveform.envelope)
      throw InputError(file_->byte_position(0),
                       fmt::format("'{}': points of PT_FMT '{}' are not read, expected Y (samples) "
                                   "or ENV (minimum and maximum): save it as CSV",
                                   channel.name, points));
    const auto stated_interval = number(waveform, "XINCR");
    const double interval = stated_interval.value_or(0.0);
    const double start = number(waveform, "XZERO").value_or(0.0) -
                         interval * number(waveform, "PT_OFF").value_or(0.0);
    // an envelope has two numbers for each place in time [071-0381, PT_Fmt]
    set_axis(channel, start, waveform.envelope ? 2.0 * interval : interval, waveform.text("XUNIT"));
    if (!stated_interval) channel.attributes.erase(std::string(unusable_clock));
    return waveform;
  }

  NumberKind kind(const Waveform& waveform) const {
    const std::string format = upper_case(waveform.text("BN_FMT"));
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
                                 preambles, preambles == 1 ? "" : "s", found, one_source_a_file));
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
    const std::string order = upper_case(waveform.text("BYT_OR"));
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
    double announced = 0.0;
    for (const Waveform& waveform : waveforms) announced += points_of(waveform);
    const std::vector<double> all = numbers_of_text(waveforms.front().channel.name, announced, at);
    std::span<const double> left = all;
    if (waveforms.size() == 1) {
      add_text(waveforms.front(), left);
      return at;
    }
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

  /// `announced`: numbers that are expected; 0 where that is not told.
  std::vector<double> numbers_of_text(std::string_view channel, double announced, std::size_t& at) {
    const std::string_view bytes = file_->bytes();
    std::vector<double> samples;
    while (at < bytes.size() && bytes[at] != ';') {
      const std::size_t comma = std::min(bytes.find_first_of(",;", at), bytes.size());
      const std::string_view cell = trimmed(bytes.substr(at, comma - at));
      const auto value = number_in(cell);
      const bool is_last = comma == bytes.size();
      if (is_last && cell.empty()) {  // the line end
        at = comma;
        break;
      }
      const bool is_open = is_last && cell.data() + cell.size() == bytes.data() + bytes.size();
      const bool is_missed = static_cast<double>(samples.size() + 1) < announced;
      if (is_open && (!value || is_missed)) {
        record_.warnings.push_back(
            fmt::format("'{}': the file ends within a number ('{}') of the curve: it is left out",
                        channel, to_utf8(cell.substr(0, 40))));
        at = comma;
        break;
      }
      if (!value) {
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
  if (!begins_isf(head)) return 0;
  return head.find("CURV") != std::string_view::npos ? 100 : 90;
}

std::unique_ptr<RecordingReader> open_tek_isf(const std::string& path, const ImportOptions&) {
  return IsfReader(std::make_unique<MappedFile>(path)).open();
}

}  // namespace impactrig::acquisition
