// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/mdf4_records.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "acquisition/importers/time_axis.hpp"

namespace impactrig::acquisition {

using datasets::Record;

namespace {

double half_float(std::uint16_t bits) {
  const int exponent = (bits >> 10) & 0x1F;
  const double mantissa = bits & 0x3FF;
  double value = 0.0;
  if (exponent == 0)
    value = std::ldexp(mantissa, -24);
  else if (exponent == 31)
    value = mantissa == 0.0 ? std::numeric_limits<double>::infinity()
                            : std::numeric_limits<double>::quiet_NaN();
  else
    value = std::ldexp(1024.0 + mantissa, exponent - 25);
  return (bits & 0x8000) != 0 ? -value : value;
}

/// An integer of 1 to 64 bits that begins at any bit.
double bits_at(const char* at, const MdfField& field) {
  const std::uint64_t bytes = field.bytes();  // 1 to 9
  const auto byte = [&](std::uint64_t i) {
    return std::uint64_t{static_cast<unsigned char>(at[field.big_endian ? bytes - 1 - i : i])};
  };
  std::uint64_t value = 0;
  for (std::uint64_t i = 0; i < std::min<std::uint64_t>(bytes, 8); ++i) value |= byte(i) << (8 * i);
  value >>= field.bit;
  if (bytes == 9) value |= byte(8) << (64 - field.bit);  // then bit > 0
  if (field.bit_count < 64) value &= (std::uint64_t{1} << field.bit_count) - 1;
  if (!field.with_sign) return static_cast<double>(value);
  const std::uint64_t sign = std::uint64_t{1} << (field.bit_count - 1);
  return static_cast<double>(static_cast<std::int64_t>((value ^ sign) - sign));
}

template <typename Value>
void read_field(const MdfField& field, const char* records, std::uint64_t count,
                std::uint64_t stride, std::vector<Value>& to) {
  to.resize(count);
  const char* const from = records + field.offset;
  if (field.shape == MdfField::Shape::number || field.shape == MdfField::Shape::complex)
    return convert_numbers(field.kind, field.big_endian, from, count, stride, to.data());
  for (std::uint64_t i = 0; i < count; ++i) {
    const char* const at = from + i * stride;
    if (field.shape == MdfField::Shape::bits) {
      to[i] = static_cast<Value>(bits_at(at, field));
    } else {
      const auto low = static_cast<unsigned char>(at[field.big_endian ? 1 : 0]);
      const auto high = static_cast<unsigned char>(at[field.big_endian ? 0 : 1]);
      to[i] = static_cast<Value>(half_float(static_cast<std::uint16_t>(low | high << 8)));
    }
  }
}

/// Reads records by blocks; each gives the values of every channel asked for.
class MdfRecording final : public RecordingReader {
 public:
  MdfRecording(std::unique_ptr<MappedFile> file, Record record, std::vector<MdfGroup> groups,
               std::vector<MdfChannel> channels)
      : file_(std::move(file)),
        groups_(std::move(groups)),
        channels_(std::move(channels)) {
    head_.record = std::move(record);
    for (const MdfChannel& channel : channels_)
      head_.samples.push_back(groups_[channel.group].records);
  }

  const RecordingHead& head() const override { return head_; }

  Record read(const Selection& wanted, SampleSink& sink) override {
    Record record = head_.record;
    record.channels.clear();
    const std::vector<std::size_t> chosen = selected_channels(head_, wanted);
    for (const std::size_t index : chosen) record.channels.push_back(head_.record.channels[index]);
    std::vector<std::vector<std::size_t>> of_group(groups_.size());  // places in `chosen`
    for (std::size_t i = 0; i < chosen.size(); ++i)
      of_group[channels_[chosen[i]].group].push_back(i);
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      if (of_group[g].empty()) continue;
      const MdfGroup& group = groups_[g];
      MdfRecordBytes bytes(*file_, group.fragments);
      datasets::SampleClock clock = record.channels[of_group[g].front()].clock;
      SampleRange range = samples_within(clock, group.records, wanted);
      if (group.times) {
        range = between(group, bytes, wanted, clock);
      } else {
        clock.start += clock.interval * static_cast<double>(range.first);
      }
      for (const std::size_t i : of_group[g]) record.channels[i].clock = clock;
      hand_over(group, bytes, range, chosen, of_group[g], sink);
    }
    return record;
  }

 private:
  static std::uint64_t rows_at_once(const MdfGroup& group) {
    return std::clamp<std::uint64_t>(
        (std::uint64_t{1} << 18) / std::max<std::uint64_t>(group.record_bytes, 1), 1, 32768);
  }

  std::span<const double> times_of(const MdfGroup& group, const char* records,
                                   std::uint64_t count) {
    read_field(*group.times, records, count, group.record_bytes, times_);
    if (group.times_scaling) group.times_scaling(times_);
    return times_;
  }

  SampleRange between(const MdfGroup& group, MdfRecordBytes& bytes, const Selection& wanted,
                      datasets::SampleClock& clock) {
    if (!wanted.has_window()) return {0, group.records};
    TimeWindow found(wanted);
    const std::uint64_t rows = rows_at_once(group);
    for (std::uint64_t i = 0; i < group.records; i += rows) {
      const std::uint64_t count = std::min(rows, group.records - i);
      found.add(
          times_of(group, bytes.view(i * group.record_bytes, count * group.record_bytes), count));
    }
    found.settle(clock);
    return found.range();
  }

  void hand_over(const MdfGroup& group, MdfRecordBytes& bytes, SampleRange range,
                 const std::vector<std::size_t>& chosen, const std::vector<std::size_t>& places,
                 SampleSink& sink) {
    const std::uint64_t rows = rows_at_once(group);
    for (std::uint64_t i = range.first; i < range.last; i += rows) {
      const std::uint64_t count = std::min(rows, range.last - i);
      const char* const records = bytes.view(i * group.record_bytes, count * group.record_bytes);
      for (const std::size_t place : places)
        hand_over(group, channels_[chosen[place]], records, count, place, sink);
      if (group.times) {
        const std::span<const double> times = times_of(group, records, count);
        for (const std::size_t place : places) sink.take_times(place, times);
      }
      release(records, count * group.record_bytes);
    }
  }

  void hand_over(const MdfGroup& group, const MdfChannel& channel, const char* records,
                 std::uint64_t count, std::size_t place, SampleSink& sink) {
    SampleBlock block;
    const MdfField& field = channel.field;
    const auto read = [&](auto& values) {
      read_field(field, records, count, group.record_bytes, values);
      block.raw = std::span(std::as_const(values));
    };
    const bool number =
        field.shape == MdfField::Shape::number || field.shape == MdfField::Shape::complex;
    if (channel.scaling || !number) {
      read(doubles_);
      if (channel.scaling) channel.scaling(doubles_);
    } else if (field.kind == NumberKind::i8 || field.kind == NumberKind::u8 ||
               field.kind == NumberKind::i16) {
      read(shorts_);
    } else if (field.kind == NumberKind::u16 || field.kind == NumberKind::i24 ||
               field.kind == NumberKind::i32) {
      read(integers_);
    } else if (field.kind == NumberKind::f32) {
      read(floats_);
    } else {
      read(doubles_);
    }
    if (field.shape == MdfField::Shape::complex) {
      MdfField imaginary = field;
      imaginary.offset += size_of(field.kind);
      read_field(imaginary, records, count, group.record_bytes, imaginary_);
      block.imaginary = imaginary_;
    }
    if (channel.invalid_bit) {
      valid_.resize(count);
      const char* const byte = records + *channel.invalid_bit / 8;
      for (std::uint64_t i = 0; i < count; ++i)
        valid_[i] = (byte[i * group.record_bytes] >> (*channel.invalid_bit % 8) & 1) == 0 ? 1 : 0;
      block.valid = valid_;
    }
    sink.take(place, block);
  }

  /// Gives back the pages of records that lie in the file.
  void release(const char* records, std::uint64_t length) const {
    const std::string_view all = file_->bytes();
    if (std::less<>()(records, all.data()) || !std::less<>()(records, all.data() + all.size()))
      return;
    const auto first = static_cast<std::size_t>(records - all.data());
    file_->release(first, first + length);
  }

  std::unique_ptr<MappedFile> file_;
  std::vector<MdfGroup> groups_;
  std::vector<MdfChannel> channels_;
  RecordingHead head_;
  std::vector<double> doubles_;
  std::vector<float> floats_;
  std::vector<std::int16_t> shorts_;
  std::vector<std::int32_t> integers_;
  std::vector<double> imaginary_;
  std::vector<double> times_;
  std::vector<std::uint8_t> valid_;
};

}  // namespace

void read_mdf_field(const MdfField& field, const char* records, std::uint64_t count,
                    std::uint64_t stride, std::vector<double>& to) {
  read_field(field, records, count, stride, to);
}

std::unique_ptr<RecordingReader> reader_of_mdf_records(std::unique_ptr<MappedFile> file,
                                                       Record record, std::vector<MdfGroup> groups,
                                                       std::vector<MdfChannel> channels) {
  return std::make_unique<MdfRecording>(std::move(file), std::move(record), std::move(groups),
                                        std::move(channels));
}

}  // namespace impactrig::acquisition
