// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <array>
#include <optional>

#include "acquisition/importers/byte_cursor.hpp"
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/stored_numbers.hpp"
#include "acquisition/importers/text_file.hpp"

/// Tektronix performance oscilloscopes' reference waveforms, versions 1 to 3.
///
/// Source of the layout: Tektronix, Performance Oscilloscope Reference Waveform File Format
/// (077-0220), tables 3 to 15. The text behind the samples ("tekmeta!"): tektronix/tm_data_types.
namespace impactrig::acquisition {

using datasets::Channel;
using datasets::InputError;
using datasets::Record;

namespace {

/// Where the parts of a version's header lie [bytes]. Version 2 has two bytes (summary frame type)
/// more before the dimensions, version 3 four bytes more in each of the four dimensions.
struct Layout {
  std::uint64_t vertical;    ///< explicit dimension 1
  std::uint64_t horizontal;  ///< implicit dimension 1
  std::uint64_t time_base;   ///< of dimension 1
  std::uint64_t update;      ///< specification of the first frame
  std::uint64_t curve;       ///< of the first frame
  std::uint64_t end;
};

constexpr std::array<Layout, 3> layouts = {{
    {166, 478, 742, 766, 790, 820},  //
    {168, 480, 744, 768, 792, 822},  //
    {168, 488, 760, 784, 808, 838},  //
}};

constexpr std::string_view way_out = "save it as CSV on the oscilloscope";

/// 1 to 3 of ":WFM#00n" behind the byte order; 0 for anything else.
int version_of(std::string_view head) {
  if (head.size() < 10) return 0;
  std::string_view text = head.substr(2, 8);
  if (text.starts_with(':')) text.remove_prefix(1);
  if (!text.starts_with("WFM#00")) return 0;
  const int version = text[6] - '0';
  return version >= 1 && version <= 3 ? version : 0;
}

std::optional<NumberKind> kind_of(std::int32_t format, int version) {
  constexpr std::array<NumberKind, 8> kinds = {NumberKind::i16, NumberKind::i32, NumberKind::u32,
                                               NumberKind::u64, NumberKind::f32, NumberKind::f64,
                                               NumberKind::u8,  NumberKind::i8};
  const std::int32_t known = version == 3 ? 8 : 6;  // bytes came with version 3
  if (format < 0 || format >= known) return std::nullopt;
  return kinds[static_cast<std::size_t>(format)];
}

/// When a frame was triggered.
std::string trigger_time(ByteCursor& in, std::uint64_t update) {
  in.seek(update + 12);  // behind the real point offset and the trigger's place between samples
  const auto fraction = in.read<double>("the trigger time");
  const auto seconds = in.read<std::int32_t>("the trigger time");
  if (seconds <= 0) return {};
  return iso_time_utc(static_cast<double>(seconds) +
                      (fraction >= 0.0 && fraction < 1.0 ? fraction : 0.0));
}

/// The names and values behind the samples.
std::map<std::string, std::string> meta_data(const MappedFile& file, bool big_endian,
                                             std::uint64_t samples_end) {
  std::map<std::string, std::string> found;
  const std::string_view bytes = file.bytes();
  if (samples_end >= bytes.size()) return found;
  // an eight-byte checksum stands before it, and where the file was made up, other things too
  const std::size_t mark = bytes.substr(samples_end, 4096).find("tekmeta!");
  if (mark == std::string_view::npos) return found;
  ByteCursor in(file, big_endian, samples_end + mark + 8);
  try {
    const auto count = in.read<std::uint32_t>("the number of meta data");
    for (std::uint32_t i = 0; i < count && i < 1000; ++i) {
      const std::string key =
          to_utf8(in.bytes(in.read<std::uint32_t>("a length of meta data"), "a name of meta data"));
      const auto type = in.read<std::uint8_t>("a type of meta data");
      if (type == 1) {
        const auto text =
            in.bytes(in.read<std::uint32_t>("a length of meta data"), "a text of meta data");
        if (text.size() <= 256) found[key] = to_utf8(text);  // longer ones are pictures
      } else if (type == 2) {
        found[key] = fmt::format("{}", in.read<std::int32_t>("a value of meta data"));
      } else if (type == 3) {
        found[key] = fmt::format("{}", in.read<double>("a value of meta data"));
      } else if (type == 4) {
        found[key] = fmt::format("{}", in.read<std::uint32_t>("a value of meta data"));
      } else {
        break;
      }
    }
  } catch (const InputError&) {
    // a file that is cut off here has all its samples
  }
  return found;
}

class TekWfmHeader {
 public:
  explicit TekWfmHeader(const MappedFile& file) : file_(file), in_(file) {
    const std::string_view bytes = file.bytes();
    version_ = version_of(bytes);
    if (bytes.starts_with("LLWFM") || bytes.substr(0, 8).find("LLWFM") != std::string_view::npos)
      throw InputError(file.byte_position(0),
                       fmt::format("this is a Tektronix waveform of the older kind (LLWFM), which "
                                   "is not read: {}",
                                   way_out));
    if (version_ == 0)
      throw InputError(
          file.byte_position(2),
          fmt::format("expected ':WFM#001', ':WFM#002' or ':WFM#003', found '{}': {}",
                      to_utf8(bytes.substr(std::min<std::size_t>(2, bytes.size()), 8)), way_out));
    if (!bytes.starts_with("\x0F\x0F") && !bytes.starts_with("\xF0\xF0"))
      throw InputError(
          file.byte_position(0),
          fmt::format("expected the byte order 0F0F or F0F0, found {:02X}{:02X}",
                      static_cast<unsigned char>(bytes[0]), static_cast<unsigned char>(bytes[1])));
    in_.set_big_endian(bytes[0] == '\xF0');
    at_ = layouts[static_cast<std::size_t>(version_ - 1)];
    if (bytes.size() < at_.end)
      throw InputError(file.byte_position(bytes.size()),
                       fmt::format("the file ends within its header of {} bytes", at_.end));
    check_kind();
    read_curve();
  }

  std::unique_ptr<RecordingReader> open(std::unique_ptr<MappedFile> file) {
    Record record;
    std::vector<StoredChannel> stored;
    record.started = trigger_time(in_, at_.update);
    record.attributes["version"] = fmt::format("WFM#{:03}", version_);
    record.attributes["byte order"] = in_.big_endian() ? "big-endian" : "little-endian";
    const Channel channel = describe(record);
    if (frames_ > 1)
      record.warnings.push_back(
          fmt::format("this is a FastFrame sequence of {} frames: each is a channel, with the time "
                      "from its own trigger to within a sample: what is left stands in each "
                      "channel's 'trigger to next sample'",
                      frames_));
    if (frames_ > 1 && !summary_.empty())
      record.warnings.push_back(
          fmt::format("the last frame is no measurement but the {} of those before it", summary_));
    for (std::uint64_t frame = 0; frame < frames_; ++frame) {
      Channel one = channel;
      if (frames_ > 1) {
        one.name = frame + 1 == frames_ && !summary_.empty()
                       ? fmt::format("{}, {} of the frames", channel.name, summary_)
                       : fmt::format("{}, frame {}", channel.name, frame + 1);
        const std::uint64_t update = frame == 0 ? at_.update : at_.end + 24 * (frame - 1);
        set_attribute(one, "trigger time", trigger_time(in_, update));
        one.attributes["trigger to next sample"] = trigger_place(update);
      }
      const std::uint64_t offset = curve_offset_ + frame * frame_bytes_ + data_start_;
      const StoredNumbers numbers =
          numbers_at(file_, offset, points_, kind_, in_.big_endian(), one.name, record);
      if (numbers.size() == 0 && points_ > 0) {
        if (frame == 0)
          throw InputError(file_.byte_position(file_.bytes().size()),
                           "the file ends before its first sample");
        record.warnings.push_back(
            fmt::format("the file ends before frame {} of {}", frame + 1, frames_));
        break;
      }
      stored.push_back({numbers});
      record.channels.push_back(std::move(one));
    }
    return reader_of_numbers(std::move(file), std::move(record), std::move(stored));
  }

 private:
  template <typename Number>
  Number field(std::uint64_t offset, std::string_view what) {
    in_.seek(offset);
    return in_.read<Number>(what);
  }

  std::string text(std::uint64_t offset, std::uint64_t size) {
    in_.seek(offset);
    return fixed_text(in_.bytes(size, "the header"));
  }

  /// Of a frame, by its update specification.
  std::string trigger_place(std::uint64_t update) {
    return fmt::format("{} samples", field<double>(update + 4, "the trigger's place"));
  }

  void check_kind() {
    const auto data_type = field<std::int32_t>(122, "the data type");
    if (data_type != 2) {
      constexpr std::array<std::string_view, 7> names = {
          "a measurement", "a constant", "",          "a pixel map",
          "invalid data",  "a database", "logic data"};
      const bool known = data_type >= 0 && data_type < 7;
      throw InputError(
          file_.byte_position(122),
          fmt::format("this waveform file holds {} (data type {}), which is not read: {}",
                      known ? names[static_cast<std::size_t>(data_type)] : "unknown data",
                      data_type, way_out));
    }
    const auto base = field<std::int32_t>(at_.time_base + 8, "the type of the time base");
    if (base == 2)
      throw InputError(
          file_.byte_position(at_.time_base + 8),
          fmt::format("this waveform is the phase of a spectrum, which is not read: {}", way_out));
    const auto storage = field<std::int32_t>(at_.vertical + 76, "the kind of storage");
    const auto format = field<std::int32_t>(at_.vertical + 72, "the format of the samples");
    const auto kind = kind_of(format, version_);
    if (!kind)
      throw InputError(
          file_.byte_position(at_.vertical + 72),
          fmt::format("samples of format {} are not read in version {}: expected 0 to {}", format,
                      version_, version_ == 3 ? 7 : 5));
    kind_ = *kind;
    storage_ = storage;
    // TDS5000B Online Programmer Guide, HORizontal:FASTframe:SUMFrame: the last frame
    const auto summary = version_ == 1 ? 0 : field<std::uint16_t>(154, "the summary frame");
    summary_ = summary == 1 ? "average" : summary == 2 ? "envelope" : "";
    const auto width = field<std::uint8_t>(15, "the bytes of a point");
    if (width != size_of(kind_))
      throw InputError(file_.byte_position(15),
                       fmt::format("the header states {} bytes a point, its format {} has {}",
                                   width, format, size_of(kind_)));
  }

  void read_curve() {
    const auto offset = field<std::int32_t>(16, "the place of the samples");
    if (offset < static_cast<std::int64_t>(at_.end))
      throw InputError(
          file_.byte_position(16),
          fmt::format("the samples are said to begin at byte {}, within the header", offset));
    curve_offset_ = static_cast<std::uint64_t>(offset);
    data_start_ = field<std::uint32_t>(at_.curve + 14, "the start of the samples");
    const auto data_end = field<std::uint32_t>(at_.curve + 18, "the end of the samples");
    frame_bytes_ = field<std::uint32_t>(at_.curve + 22, "the end of a frame");
    if (data_end < data_start_)
      throw InputError(file_.byte_position(at_.curve + 18),
                       fmt::format("the samples are said to end at {}, before they begin at {}",
                                   data_end, data_start_));
    points_ = (data_end - data_start_) / size_of(kind_);
    frames_ = std::uint64_t{field<std::uint32_t>(72, "the number of frames")} + 1;
    if (frames_ > most_channels)
      throw InputError(
          file_.byte_position(72),
          fmt::format("this is a FastFrame sequence of {} frames, at most {} are read: save it in "
                      "parts",
                      frames_, most_channels));
    if (frames_ > 1 && frame_bytes_ < data_end)
      throw InputError(file_.byte_position(at_.curve + 22),
                       fmt::format("a frame is said to end at {}, before its samples end at {}",
                                   frame_bytes_, data_end));
    const auto meta =
        meta_data(file_, in_.big_endian(),
                  curve_offset_ + frames_ * std::max<std::uint64_t>(frame_bytes_, data_end));
    meta_ = meta;
    for (const auto& [name, value] : meta_)
      if (name.starts_with("IQ_"))
        throw InputError(
            file_.byte_position(curve_offset_),
            fmt::format("this is an IQ waveform (two numbers a sample), which is not read: {}",
                        way_out));
    if (storage_ != 0)
      throw InputError(file_.byte_position(at_.vertical + 76),
                       fmt::format("the samples are not stored one by one but as {} (storage type "
                                   "{}), which is not read: {}",
                                   storage_ == 1 ? "pairs of minimum and maximum" : "a histogram",
                                   storage_, way_out));
  }

  Channel describe(Record& record) {
    Channel channel;
    const std::string label = text(40, 32);
    channel.name = label.empty() ? "waveform" : label;
    set_unit(channel, text(at_.vertical + 20, 20));
    const auto scale = field<double>(at_.vertical, "the vertical scale");
    const auto offset = field<double>(at_.vertical + 8, "the vertical offset");
    set_scale(channel, scale, offset, file_, at_.vertical);
    undo_zero_scale(channel, record);
    if (points_ == 0)
      record.warnings.push_back(
          fmt::format("'{}': the header says that there are no samples", channel.name));
    const auto interval = field<double>(at_.horizontal, "the sample interval");
    const auto start = field<double>(at_.horizontal + 8, "the time of the first sample");
    set_axis(channel, start, interval, text(at_.horizontal + 20, 20));
    channel.attributes["trigger to next sample"] = trigger_place(at_.update);
    for (const auto& [name, value] : meta_) set_attribute(record, name, value);
    return channel;
  }

  const MappedFile& file_;
  ByteCursor in_;
  int version_ = 0;
  Layout at_{};
  NumberKind kind_ = NumberKind::i16;
  std::int32_t storage_ = 0;
  std::string_view summary_;  ///< what the last frame is of the others; "": a frame like them
  std::uint64_t curve_offset_ = 0;
  std::uint64_t data_start_ = 0;
  std::uint64_t frame_bytes_ = 0;
  std::uint64_t points_ = 0;
  std::uint64_t frames_ = 1;
  std::map<std::string, std::string> meta_;
};

}  // namespace

int recognises_tek_wfm(std::string_view, std::string_view head) {
  if (version_of(head) != 0) return 100;
  if (head.substr(0, 8).find("LLWFM") != std::string_view::npos) return 100;
  return head.size() >= 6 && head.substr(2).starts_with(":WFM#") ? 90 : 0;
}

std::unique_ptr<RecordingReader> open_tek_wfm(const std::string& path, const ImportOptions&) {
  auto file = std::make_unique<MappedFile>(path);
  TekWfmHeader header(*file);
  return header.open(std::move(file));
}

}  // namespace impactrig::acquisition
