// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/mdf4_records.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "acquisition/importers/time_axis.hpp"
#include "acquisition/importers/wide_integers.hpp"

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
  if (field.shape == MdfField::Shape::number)
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
    for (const MdfChannel& channel : channels_) {
      head_.samples.push_back(groups_[channel.group].records);
      head_.counted = head_.counted && groups_[channel.group].counted;
    }
  }

  const RecordingHead& head() const override { return head_; }

  Record read(const Selection& wanted, SampleSink& sink) override {
    Record record = head_.record;
    record.channels.clear();
    const std::vector<std::size_t> chosen = selected_channels(head_, wanted);
    for (const std::size_t index : chosen) record.channels.push_back(head_.record.channels[index]);
    wide_.assign(chosen.size(), {});
    std::vector<std::vector<std::size_t>> of_group(groups_.size());  // places in `chosen`
    for (std::size_t i = 0; i < chosen.size(); ++i)
      of_group[channels_[chosen[i]].group].push_back(i);
    std::set<const MdfMixed*> done;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      if (of_group[g].empty()) continue;
      const MdfGroup& group = groups_[g];
      if (group.mixed) {
        if (done.insert(group.mixed.get()).second)
          read_mixed(*group.mixed, wanted, chosen, of_group, record, sink);
        continue;
      }
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
    for (std::size_t i = 0; i < chosen.size(); ++i)
      if (const std::string told = wide_[i].warning(record.channels[i].name); !told.empty())
        tell(told, record);
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
      hand_over(group, records, count, chosen, places, sink);
      bytes.release(records, count * group.record_bytes);
    }
  }

  void hand_over(const MdfGroup& group, const char* records, std::uint64_t count,
                 const std::vector<std::size_t>& chosen, const std::vector<std::size_t>& places,
                 SampleSink& sink) {
    for (const std::size_t place : places)
      hand_over(group, channels_[chosen[place]], records, count, place, sink);
    if (!group.times) return;
    const std::span<const double> times = times_of(group, records, count);
    for (const std::size_t place : places) sink.take_times(place, times);
  }

  /// What is read of a group among others.
  struct Part {
    SampleRange range{};        ///< empty: nothing
    std::uint64_t seen = 0;     ///< records so far
    std::uint64_t rows = 1;     ///< that are handed over at once
    std::uint64_t waiting = 0;  ///< of them
    std::vector<char> records;
  };

  /// Hands the records of some groups to `use` as it goes through the data of all of them, by
  /// blocks of one group: use(place, records, count). False where it saw the end of the data.
  template <typename Use>
  bool each_block(MdfMixedRecords& all, std::vector<Part>& parts, const MdfMixed& mixed,
                  const Use& use) const {
    std::size_t open = 0;
    for (const Part& part : parts)
      if (part.range.last > part.range.first) ++open;
    while (open > 0) {
      const auto record = all.next();
      if (!record) break;
      Part& part = parts[record->place];
      const std::uint64_t index = part.seen++;
      if (index < part.range.first || index >= part.range.last) continue;
      const std::uint64_t bytes = groups_[mixed.groups[record->place]].record_bytes;
      if (part.rows == 1) {
        use(record->place, record->bytes, std::uint64_t{1});
      } else {
        part.records.insert(part.records.end(), record->bytes, record->bytes + bytes);
        if (++part.waiting == part.rows) settle(part, record->place, use);
      }
      if (part.seen == part.range.last) --open;
    }
    for (std::size_t place = 0; place < parts.size(); ++place) settle(parts[place], place, use);
    return open == 0;
  }

  template <typename Use>
  static void settle(Part& part, std::size_t place, const Use& use) {
    if (part.waiting > 0) use(place, part.records.data(), part.waiting);
    part.records.clear();
    part.waiting = 0;
  }

  /// All records of the groups that `wants` holds for, none of the others.
  template <typename Wants>
  std::vector<Part> parts_of(const MdfMixed& mixed, const Wants& wants) const {
    std::vector<Part> parts(mixed.groups.size());
    const auto count = static_cast<std::uint64_t>(std::ranges::count_if(mixed.groups, wants));
    for (std::size_t place = 0; place < parts.size(); ++place) {
      const MdfGroup& group = groups_[mixed.groups[place]];
      if (!wants(mixed.groups[place])) continue;
      parts[place].range.last = group.estimated ? ~std::uint64_t{0} : group.records;
      parts[place].rows =
          std::min(rows_at_once(group),
                   std::max<std::uint64_t>(most_waiting / count / group.record_bytes, 1));
    }
    return parts;
  }

  /// The channels of groups whose records stand by turns: in one go, or two where a window has to
  /// be found in times.
  void read_mixed(const MdfMixed& mixed, const Selection& wanted,
                  const std::vector<std::size_t>& chosen,
                  const std::vector<std::vector<std::size_t>>& of_group, Record& record,
                  SampleSink& sink) {
    const auto is_read = [&](std::size_t group) { return !of_group[group].empty(); };
    const auto has_times = [&](std::size_t group) {
      return is_read(group) && groups_[group].times.has_value();
    };
    const auto add_times = [&](std::vector<TimeWindow>& found, std::size_t place,
                               const char* records, std::uint64_t count) {
      const MdfGroup& group = groups_[mixed.groups[place]];
      if (group.times) found[place].add(times_of(group, records, count));
    };
    std::vector<Part> parts = parts_of(mixed, is_read);
    std::vector<TimeWindow> found(mixed.groups.size(), TimeWindow(wanted));
    if (wanted.has_window() && std::ranges::any_of(mixed.groups, has_times)) {
      std::vector<Part> of_times = parts_of(mixed, has_times);
      MdfMixedRecords all(*file_, mixed);
      each_block(all, of_times, mixed, [&](std::size_t place, const char* records, auto count) {
        add_times(found, place, records, count);
      });
    }
    for (std::size_t place = 0; place < parts.size(); ++place) {
      const std::size_t g = mixed.groups[place];
      if (!is_read(g)) continue;
      datasets::SampleClock clock = record.channels[of_group[g].front()].clock;
      if (!groups_[g].times) {
        parts[place].range = samples_within(clock, parts[place].range.last, wanted);
        clock.start += clock.interval * static_cast<double>(parts[place].range.first);
      } else if (wanted.has_window()) {
        parts[place].range = found[place].range();
        found[place].settle(clock);
      }
      for (const std::size_t i : of_group[g]) record.channels[i].clock = clock;
    }
    MdfMixedRecords all(*file_, mixed);
    const bool to_the_end =
        !each_block(all, parts, mixed, [&](std::size_t place, const char* records, auto count) {
          const std::size_t g = mixed.groups[place];
          hand_over(groups_[g], records, count, chosen, of_group[g], sink);
          if (!wanted.has_window()) add_times(found, place, records, count);
        });
    for (std::size_t place = 0; place < parts.size(); ++place) {
      const std::size_t g = mixed.groups[place];
      if (!is_read(g)) continue;
      if (groups_[g].times && !wanted.has_window())
        for (const std::size_t i : of_group[g]) found[place].settle(record.channels[i].clock);
      if (to_the_end && parts[place].seen < groups_[g].announced)
        tell(mdf_short(groups_[g].name, groups_[g].announced, parts[place].seen), record);
    }
    if (to_the_end && !all.problem().empty()) tell(all.problem(), record);
  }

  static void tell(const std::string& sentence, Record& record) {
    if (std::ranges::find(record.warnings, sentence) == record.warnings.end())
      record.warnings.push_back(sentence);
  }

  void hand_over(const MdfGroup& group, const MdfChannel& channel, const char* records,
                 std::uint64_t count, std::size_t place, SampleSink& sink) {
    SampleBlock block;
    const MdfField& field = channel.field;
    const auto read = [&](auto& values) {
      read_field(field, records, count, group.record_bytes, values);
      block.raw = std::span(std::as_const(values));
    };
    if (channel.scaling || field.shape != MdfField::Shape::number) {
      read(doubles_);
      if (field.is_wide()) wide_[place].look(doubles_);
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
      if (field.is_wide()) wide_[place].look(doubles_);
    }
    if (field.complex) {
      MdfField imaginary = field;
      imaginary.offset += field.bytes_of_part();
      read_field(imaginary, records, count, group.record_bytes, imaginary_);
      block.imaginary = imaginary_;
    }
    if (channel.never_valid) {
      valid_.assign(count, 0);
      block.valid = valid_;
    } else if (channel.invalid_bit) {
      valid_.resize(count);
      const char* const byte = records + *channel.invalid_bit / 8;
      for (std::uint64_t i = 0; i < count; ++i)
        valid_[i] = (byte[i * group.record_bytes] >> (*channel.invalid_bit % 8) & 1) == 0 ? 1 : 0;
      block.valid = valid_;
    }
    sink.take(place, block);
  }

  /// Of groups that stand by turns, all together: bytes that wait to be handed over.
  static constexpr std::uint64_t most_waiting = std::uint64_t{1} << 26;

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
  std::vector<WideIntegers> wide_;  ///< of the channels asked for
};

}  // namespace

void read_mdf_field(const MdfField& field, const char* records, std::uint64_t count,
                    std::uint64_t stride, std::vector<double>& to) {
  read_field(field, records, count, stride, to);
}

std::string mdf_short(std::string_view group, std::uint64_t announced, std::uint64_t there) {
  return fmt::format("{} announces {} records, {} are there", group, announced, there);
}

std::unique_ptr<RecordingReader> reader_of_mdf_records(std::unique_ptr<MappedFile> file,
                                                       Record record, std::vector<MdfGroup> groups,
                                                       std::vector<MdfChannel> channels) {
  return std::make_unique<MdfRecording>(std::move(file), std::move(record), std::move(groups),
                                        std::move(channels));
}

}  // namespace impactrig::acquisition
