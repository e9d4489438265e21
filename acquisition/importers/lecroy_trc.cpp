// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>

#include "acquisition/importers/byte_cursor.hpp"
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/stored_numbers.hpp"

/// LeCroy waveforms: the block WAVEDESC, then texts and times, then the samples.
///
/// Source of the layout: Teledyne LeCroy, MAUI Oscilloscopes Remote Control and Automation Manual,
/// "Waveform Template" (LECROY_2_3); the answers to TMPL? of a 9304A (LECROY_2_2) and a 7200A
/// (LECROY_1_0). Offsets below are counted from WAVEDESC.
namespace impactrig::acquisition {

using datasets::Channel;
using datasets::InputError;
using datasets::Record;

namespace {

constexpr std::string_view way_out = "save it as CSV or as binary of template LECROY_2_3";

/// A block's header ("#9000020746") may stand before the descriptor; more than that does not.
constexpr std::size_t farthest = 256;

constexpr std::array<std::string_view, 10> record_types_2 = {
    "single sweep", "interleaved", "histogram",         "graph",        "filter coefficients",
    "complex",      "extrema",     "sequence obsolete", "centered RIS", "peak detect"};

constexpr std::array<std::string_view, 13> record_types_1 = {"single sweep",
                                                             "interleaved",
                                                             "histogram",
                                                             "trend",
                                                             "filter coefficients",
                                                             "complex",
                                                             "extrema",
                                                             "sequence",
                                                             "centered RIS",
                                                             "rolling",
                                                             "alternating averages",
                                                             "streamed sequence",
                                                             "uncorrected streamed sequence"};

constexpr std::array<std::string_view, 5> couplings = {"DC 50 Ohm", "ground", "DC 1 MOhm", "ground",
                                                       "AC 1 MOhm"};

/// Where the variables of a template are; 0: it has none.
struct Template {
  std::array<std::string_view, 2> names;
  std::span<const std::string_view> types;  ///< of records
  std::uint64_t reserved, trigger_times, ris_times, reserved_array, samples, second_samples;
  std::uint64_t instrument, number, label;
  std::uint64_t count, first_valid, last_valid, first_point, sparsing, segments;
  std::uint64_t gain, offset, bits, interval, start, unit, time_unit;
  std::uint64_t trigger_time, type, ris_sweeps, coupling, probe, source;
  unsigned first_source;    ///< the number of channel 1
  std::uint16_t peak_type;  ///< record type that has a second array, beside the extrema (6)
};

constexpr Template template_2 = {
    .names = {"LECROY_2_2", "LECROY_2_3"},
    .types = record_types_2,
    .reserved = 44,
    .trigger_times = 48,
    .ris_times = 52,
    .reserved_array = 56,
    .samples = 60,
    .second_samples = 64,
    .instrument = 76,
    .number = 92,
    .label = 96,
    .count = 116,
    .first_valid = 124,
    .last_valid = 128,
    .first_point = 132,
    .sparsing = 136,
    .segments = 144,
    .gain = 156,
    .offset = 160,
    .bits = 172,
    .interval = 176,
    .start = 180,
    .unit = 196,
    .time_unit = 244,
    .trigger_time = 296,
    .type = 316,
    .ris_sweeps = 322,
    .coupling = 326,
    .probe = 328,
    .source = 344,
    .first_source = 0,
    .peak_type = 9,
};

constexpr Template template_1 = {
    .names = {"LECROY_1_0", "LECROY_1_0"},
    .types = record_types_1,
    .reserved = 0,
    .trigger_times = 44,
    .ris_times = 0,
    .reserved_array = 0,
    .samples = 48,
    .second_samples = 52,
    .instrument = 56,
    .number = 72,
    .label = 76,
    .count = 92,
    .first_valid = 100,
    .last_valid = 104,
    .first_point = 0,
    .sparsing = 0,
    .segments = 108,
    .gain = 120,
    .offset = 124,
    .bits = 132,
    .interval = 134,
    .start = 138,
    .unit = 154,
    .time_unit = 202,
    .trigger_time = 250,
    .type = 270,
    .ris_sweeps = 0,
    .coupling = 276,
    .probe = 278,
    .source = 296,
    .first_source = 1,
    .peak_type = 10,
};

class TrcReader {
 public:
  explicit TrcReader(std::unique_ptr<MappedFile> file) : file_(std::move(file)), in_(*file_) {
    const std::size_t found = file_->bytes().substr(0, farthest).find("WAVEDESC");
    if (found == std::string_view::npos)
      throw InputError(file_->byte_position(0),
                       fmt::format("expected 'WAVEDESC' in the first {} bytes", farthest));
    base_ = found;
    const std::string name = text(16, 16, "the name of the template");
    for (const Template* const known : {&template_1, &template_2})
      if (std::ranges::find(known->names, name) != known->names.end()) at_ = known;
    if (at_ == nullptr)
      throw InputError(file_->byte_position(base_ + 16),
                       fmt::format("this is a LeCroy waveform of the template '{}', expected "
                                   "LECROY_1_0, LECROY_2_2 or LECROY_2_3: {}",
                                   name, way_out));
    // 1 is little-endian, 0 big-endian: in both the byte at 34 tells
    in_.seek(base_ + 34);
    in_.set_big_endian(in_.read<std::uint8_t>("the byte order") != 1);
  }

  std::unique_ptr<RecordingReader> open() {
    describe();
    find_samples();
    leave_out_padding();
    place_in_time();
    add_sweep();
    if (segments_ > 1) tell_of_segments();
    return reader_of_numbers(std::move(file_), std::move(record_), std::move(stored_));
  }

 private:
  template <typename Number>
  Number field(std::uint64_t offset, std::string_view what) {
    in_.seek(base_ + offset);
    return in_.read<Number>(what);
  }

  std::string text(std::uint64_t offset, std::uint64_t size, std::string_view what) {
    in_.seek(base_ + offset);
    return fixed_text(in_.bytes(size, what));
  }

  /// A block's length: signed in the file. 0 where the template has none.
  std::uint64_t length(std::uint64_t offset, std::string_view what) {
    if (offset == 0) return 0;
    const auto bytes = field<std::int32_t>(offset, what);
    if (bytes < 0)
      throw InputError(file_->byte_position(base_ + offset),
                       fmt::format("{} is {}, expected 0 or more", what, bytes));
    return static_cast<std::uint64_t>(bytes);
  }

  void describe() {
    const unsigned source =
        field<std::uint16_t>(at_->source, "the source of the waveform") - at_->first_source;
    const std::string label = text(at_->label, 16, "the trace label");
    channel_.name = source < 4       ? fmt::format("CH {}", source + 1)
                    : !label.empty() ? label
                                     : "waveform";
    set_attribute(channel_, "trace label", label);
    set_unit(channel_, text(at_->unit, 48, "the vertical unit"));
    const auto gain = field<float>(at_->gain, "the vertical gain");
    const auto offset = field<float>(at_->offset, "the vertical offset");
    set_scale(channel_, gain, -static_cast<double>(offset), *file_, base_ + at_->gain);
    undo_zero_scale(channel_, record_);
    // "S" is LeCroy's second
    const std::string written = text(at_->time_unit, 48, "the horizontal unit");
    unit_ = written == "S" ? "s" : written;
    interval_ = meant_by_float(field<float>(at_->interval, "the sample interval"));
    start_ = field<double>(at_->start, "the time of the first sample");

    const auto coupling = field<std::uint16_t>(at_->coupling, "the coupling");
    if (coupling < couplings.size()) set_attribute(channel_, "coupling", couplings[coupling]);
    channel_.attributes["probe attenuation"] =
        fmt::format("{}", field<float>(at_->probe, "the probe attenuation"));
    channel_.attributes["nominal bits"] =
        fmt::format("{}", field<std::int16_t>(at_->bits, "the number of bits"));
    set_attribute(record_, "instrument", text(at_->instrument, 16, "the instrument's name"));
    record_.attributes["instrument number"] =
        fmt::format("{}", field<std::int32_t>(at_->number, "the instrument's number"));
    set_attribute(record_, "template", text(16, 16, "the name of the template"));
    record_.attributes["byte order"] = in_.big_endian() ? "big-endian" : "little-endian";
    record_.started = trigger_time();
    type_ = field<std::uint16_t>(at_->type, "the type of the record");
    const bool known = type_ < at_->types.size();
    const std::string_view type_name = known ? at_->types[type_] : "unknown";
    record_.attributes["record type"] = type_name;
    if (!known || (type_ >= 2 && type_ <= 5))
      throw InputError(file_->byte_position(base_ + at_->type),
                       fmt::format("this waveform is of the type '{}' ({}), expected samples over "
                                   "time: save it as CSV",
                                   type_name, type_));
    second_array_ = type_ == 6 || type_ == at_->peak_type;
  }

  /// Seconds, minutes, hours, day, month and year.
  std::string trigger_time() {
    constexpr std::string_view what = "the trigger time";
    in_.seek(base_ + at_->trigger_time);
    const auto second = in_.read<double>(what);
    const auto minute = in_.read<std::uint8_t>(what);
    const auto hour = in_.read<std::uint8_t>(what);
    const auto day = in_.read<std::uint8_t>(what);
    const auto month = in_.read<std::uint8_t>(what);
    return iso_time(in_.read<std::int16_t>(what), month, day, hour, minute, second);
  }

  void find_samples() {
    const auto type = field<std::uint16_t>(32, "the type of the samples");
    if (type > 1)
      throw InputError(
          file_->byte_position(base_ + 32),
          fmt::format("the type of the samples (COMM_TYPE) is {}, expected 0 (bytes) or 1 (words)",
                      type));
    kind_ = type == 0 ? NumberKind::i8 : NumberKind::i16;
    trigger_times_ = base_ + length(36, "the length of the descriptor") +
                     length(40, "the length of the user text") +
                     length(at_->reserved, "the length of the reserved descriptor");
    const std::uint64_t times = length(at_->trigger_times, "the length of the trigger times");
    const std::uint64_t ris_times = length(at_->ris_times, "the length of the RIS times");
    trigger_times_bytes_ = times;
    samples_ = trigger_times_ + times + ris_times +
               length(at_->reserved_array, "the length of the reserved array");
    const std::uint64_t bytes = length(at_->samples, "the length of the samples");
    second_samples_ = samples_ + bytes;
    points_ = length(at_->count, "the number of samples");
    if (points_ > bytes / size_of(kind_)) {
      record_.warnings.push_back(
          fmt::format("'{}': {} samples are announced, their {} bytes have {}", channel_.name,
                      points_, bytes, bytes / size_of(kind_)));
      points_ = bytes / size_of(kind_);
    }
    const std::uint64_t segments = length(at_->segments, "the number of segments");
    segments_ = segments == 0 ? 1 : segments;
    segment_points_ = points_ / segments_;
    first_point_ = above_zero(at_->first_point, "the first sample sent (FIRST_POINT)");
    sparsing_ =
        std::max<std::uint64_t>(above_zero(at_->sparsing, "the sparsing (SPARSING_FACTOR)"), 1);
    if (at_->ris_sweeps != 0 && (ris_times > 0 || type_ == 1 || type_ == 8))
      record_.warnings.push_back(fmt::format(
          "'{}' is put together of {} sweeps (RIS), each with a time of its own: its samples are "
          "read as evenly spaced, at HORIZ_INTERVAL",
          channel_.name, field<std::int16_t>(at_->ris_sweeps, "the number of RIS sweeps")));
  }

  std::uint64_t above_zero(std::uint64_t offset, std::string_view what) {
    if (offset == 0) return 0;
    return static_cast<std::uint64_t>(std::max<std::int32_t>(field<std::int32_t>(offset, what), 0));
  }

  /// Samples before FIRST_VALID_PNT and behind LAST_VALID_PNT are padding; the last is
  /// WAVE_ARRAY_COUNT - 1 "except for aborted sequence and rollmode acquisitions" [Waveform
  /// Template], or that of the waveform where fewer were sent. 0: not stated.
  void leave_out_padding() {
    const std::uint64_t first =
        above_zero(at_->first_valid, "the first valid sample (FIRST_VALID_PNT)");
    const std::uint64_t last =
        above_zero(at_->last_valid, "the last valid sample (LAST_VALID_PNT)");
    const std::uint64_t valid = last == 0 ? points_ : std::min(last + 1, points_);
    if (segments_ > 1 && first == 0) return leave_out_segments(valid);
    if (first == 0 && valid == points_) return;
    // whether both count the samples of the waveform or of its part is not told
    const bool is_part = first_point_ > 0 || sparsing_ > 1;
    if (first >= valid || segments_ > 1 || second_array_ || is_part)
      return tell_padding(first, last);
    record_.warnings.push_back(fmt::format(
        "'{}': {} samples at the start and {} at the end were not acquired (FIRST_VALID_PNT {}, "
        "LAST_VALID_PNT {}): they are left out",
        channel_.name, first, points_ - valid, first, last));
    samples_ += first * size_of(kind_);
    points_ = valid - first;
    left_out_ = first;
  }

  /// 0: not stated. LECROY_1_0 has them beside those acquired.
  std::uint64_t segments_asked() {
    constexpr std::string_view what = "the number of segments asked for";
    if (at_ == &template_1) return above_zero(112, what);
    return static_cast<std::uint64_t>(std::max<std::int16_t>(field<std::int16_t>(174, what), 0));
  }

  void tell_padding(std::uint64_t first, std::uint64_t last) {
    record_.warnings.push_back(
        fmt::format("'{}': samples before {} or behind {} are said not to be acquired "
                    "(FIRST_VALID_PNT, LAST_VALID_PNT): they are read like the others",
                    channel_.name, first, last));
  }

  /// Of a sequence that was stopped, the array may have room for all segments it was to have, or
  /// for those that it has.
  void leave_out_segments(std::uint64_t valid) {
    const std::uint64_t stated = segments_asked();
    const std::uint64_t asked = stated > 0 ? stated : segments_;
    if (asked <= segments_) {
      if (valid < points_) tell_padding(0, valid - 1);
      return;
    }
    const std::uint64_t kept = segments_ * (points_ / asked);
    const bool has_room = points_ % asked == 0;
    const bool has_none = points_ % segments_ == 0;
    const bool is_told = valid < points_ ? has_room && valid == kept : has_room != has_none;
    if (!is_told) {
      record_.warnings.push_back(
          fmt::format("'{}': the sequence was stopped after {} of {} segments, and which of its {} "
                      "samples are whose is not told: compare with the oscilloscope",
                      channel_.name, segments_, asked, points_));
      return;
    }
    if (valid == points_ && has_none) return;
    record_.warnings.push_back(
        fmt::format("'{}': the sequence was stopped after {} of {} segments: the {} samples behind "
                    "them were not acquired and are left out",
                    channel_.name, segments_, asked, points_ - kept));
    segment_points_ = points_ / asked;
    points_ = kept;
  }

  /// Sample k is the waveform's FIRST_POINT + k SPARSING_FACTOR, and HORIZ_OFFSET and
  /// HORIZ_INTERVAL are the waveform's [LeCroy, X-Stream Remote Control Manual, WAVEFORM_SETUP].
  void place_in_time() {
    if (first_point_ > 0 || sparsing_ > 1)
      record_.warnings.push_back(
          fmt::format("'{}' is a part of a waveform (FIRST_POINT {}, SPARSING_FACTOR {}): sample k "
                      "is taken as the waveform's {} + {} k, and HORIZ_INTERVAL as that of the "
                      "waveform; compare the times with the oscilloscope's",
                      channel_.name, first_point_, sparsing_, first_point_, sparsing_));
    const auto first = static_cast<double>(first_point_ + left_out_);
    set_axis(channel_, start_ + first * interval_, static_cast<double>(sparsing_) * interval_,
             unit_);
  }

  void add(const Channel& channel, std::uint64_t offset, std::uint64_t points) {
    stored_.push_back(
        {numbers_at(*file_, offset, points, kind_, in_.big_endian(), channel.name, record_)});
    record_.channels.push_back(channel);
    if (record_.channels.size() == 1 && points > 0 && stored_.front().samples.size() == 0)
      throw InputError(file_->byte_position(file_->bytes().size()),
                       "the file ends before its first sample");
  }

  void add_sweep() {
    add(channel_, samples_, points_);
    if (!second_array_) return;
    // extrema and peak detect: the first array is the roof, the second the floor
    const std::uint64_t bytes = length(at_->second_samples, "the length of the second samples");
    if (bytes == 0) return;
    record_.channels.front().name += " max";
    channel_.name += " min";
    add(channel_, second_samples_, bytes / size_of(kind_));
  }

  /// The segments of a sequence lie one behind the other. They stay one channel, in which impacts
  /// are found as in any other; TRIGTIME has for each segment the seconds since the first trigger,
  /// and those from its own trigger to its first sample.
  void tell_of_segments() {
    const std::uint64_t there = stored_.front().samples.size();
    record_.warnings.push_back(
        fmt::format("'{}' is a sequence of {} segments of {} samples: they follow each other as if "
                    "there were no time between them; true within a segment only",
                    channel_.name, segments_, segment_points_));
    Channel& channel = record_.channels.front();
    channel.attributes["segments"] = fmt::format("{}", segments_);
    channel.attributes["samples a segment"] = fmt::format("{}", segment_points_);
    if (there < points_) return;
    constexpr std::uint64_t most_told = 1000;
    std::string triggers;
    std::string starts;
    in_.seek(trigger_times_);
    for (std::uint64_t i = 0; i < std::min({segments_, trigger_times_bytes_ / 16, most_told});
         ++i) {
      triggers += fmt::format("{}{:.12g}", i > 0 ? ", " : "", in_.read<double>("a trigger time"));
      starts += fmt::format("{}{:.12g}", i > 0 ? ", " : "", in_.read<double>("a trigger time"));
    }
    set_attribute(channel, "triggers since the first [s]", triggers);
    set_attribute(channel, "segment starts after their triggers [s]", starts);
  }

  std::unique_ptr<MappedFile> file_;
  ByteCursor in_;
  std::uint64_t base_ = 0;
  const Template* at_ = nullptr;
  Record record_;
  Channel channel_;
  std::vector<StoredChannel> stored_;
  std::string unit_;
  double start_ = 0.0;     ///< of the waveform, of which the file may have a part
  double interval_ = 0.0;  ///< likewise
  std::uint16_t type_ = 0;
  bool second_array_ = false;
  NumberKind kind_ = NumberKind::i8;
  std::uint64_t trigger_times_ = 0;
  std::uint64_t trigger_times_bytes_ = 0;
  std::uint64_t samples_ = 0;
  std::uint64_t second_samples_ = 0;
  std::uint64_t points_ = 0;
  std::uint64_t segments_ = 1;
  std::uint64_t segment_points_ = 0;
  std::uint64_t first_point_ = 0;
  std::uint64_t sparsing_ = 1;
  std::uint64_t left_out_ = 0;  ///< samples before the first valid one
};

}  // namespace

int recognises_lecroy_trc(std::string_view, std::string_view head) {
  const std::size_t found = head.substr(0, farthest).find("WAVEDESC");
  if (found == std::string_view::npos) return 0;
  return found == 0 || head.front() == '#' ? 100 : 80;
}

std::unique_ptr<RecordingReader> open_lecroy_trc(const std::string& path, const ImportOptions&) {
  return TrcReader(std::make_unique<MappedFile>(path)).open();
}

}  // namespace impactrig::acquisition
