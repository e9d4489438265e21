// SPDX-License-Identifier: BSD-3-Clause
// ASAM MDF 4. Layout: ASAM, "MDF (Measurement Data Format) 4.1", its wiki at asam.net and the
// public "MDF 4.x programmers' guide"; block names below are the standard's (HD, DG, CG, CN, CC,
// DL, DZ).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <optional>

#include "acquisition/importers/byte_cursor.hpp"
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/mdf4_blocks.hpp"
#include "acquisition/importers/mdf4_conversion.hpp"
#include "acquisition/importers/mdf4_data.hpp"
#include "acquisition/importers/mdf4_records.hpp"
#include "acquisition/importers/text_file.hpp"
#include "acquisition/importers/time_axis.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Quantity;
using datasets::Record;

namespace {

// Limits, so that memory stays below 256 MB whatever a file says.
constexpr std::uint64_t most_record_bytes = std::uint64_t{1} << 24;
constexpr std::uint64_t most_time_bytes = std::uint64_t{1} << 26;  ///< read at opening, for times
constexpr std::uint64_t most_times = std::uint64_t{1} << 22;       ///< looked at when opening
constexpr std::size_t most_channels = 100000;

class MdfReader {
 public:
  explicit MdfReader(const std::string& path)
      : file_(std::make_unique<MappedFile>(path)),
        blocks_(*file_) {}

  std::unique_ptr<RecordingReader> open() {
    read_identification();
    const std::uint64_t first_group = read_header();
    std::uint64_t number = 0;
    for (std::uint64_t at = first_group; at != 0; ++number) at = read_data_group(at, number);
    tell_left_out();
    if (record_.channels.empty() && !unsorted_.empty()) fail(unsorted_at_, unsorted_);
    if (!unsorted_.empty()) warn(unsorted_);
    if (record_.channels.empty())
      warn("no recordings in this file: it has no channel with numbers");
    return reader_of_mdf_records(std::move(file_), std::move(record_), std::move(groups_),
                                 std::move(channels_));
  }

 private:
  [[noreturn]] void fail(std::uint64_t at, std::string_view problem) const {
    blocks_.fail(at, problem);
  }

  void warn(std::string sentence) {
    if (std::ranges::find(record_.warnings, sentence) == record_.warnings.end())
      record_.warnings.push_back(std::move(sentence));
  }

  void read_identification() {
    ByteCursor in(*file_);
    const std::string_view id = in.bytes(8, "the identification of an MDF file");
    if (id != "MDF     " && id != "UnFinMF ")
      fail(0, fmt::format("expected 'MDF' at the start, found '{}'", to_utf8(id)));
    const std::string version = to_utf8(in.bytes(8, "the version of an MDF file"));
    if (!version.starts_with('4'))
      fail(8, fmt::format("this is MDF version {}, which is not read: save it as MDF 4 with the "
                          "program that wrote it",
                          version.substr(0, version.find(' '))));
    record_.attributes["version"] = version.substr(0, version.find(' '));
    const std::string program = to_utf8(in.bytes(8, "the program of an MDF file"));
    record_.attributes["written by"] = trimmed_mdf_text(program);
    in.seek(60);
    const auto flags = in.read<std::uint16_t>("the state of an MDF file");
    if (id == "UnFinMF ") {
      unfinished_ = true;
      counts_stale_ = (flags & 1) != 0;
      last_length_unknown_ = (flags & 4) != 0;
      warn("the recording was not finished (aborted?): what is there is read");
    }
  }

  std::uint64_t read_header() {
    const MdfBlock header = blocks_.new_block_at(64, "HD", "the header of an MDF file");
    ByteCursor in(*file_, false, header.data);
    const auto start = in.read<std::uint64_t>("the start of a measurement");
    in.skip(4);
    const auto flags = in.read<std::uint8_t>("the start of a measurement");
    if (start != 0) {
      record_.started = iso_utc(static_cast<std::int64_t>(start / 1000000000),
                                static_cast<std::uint32_t>(start % 1000000000 / 1000));
      if ((flags & 1) != 0 && record_.started.ends_with('Z')) record_.started.pop_back();  // local
    }
    const std::string comment = blocks_.text_at(header.link(5));
    if (!comment.empty()) record_.attributes["comment"] = comment;
    return header.link(0);
  }

  /// Reads a data group; returns where the next one is.
  std::uint64_t read_data_group(std::uint64_t at, std::uint64_t number) {
    const MdfBlock data_group = blocks_.new_block_at(at, "DG", "a data group");
    ByteCursor in(*file_, false, data_group.data);
    const auto id_bytes = in.read<std::uint8_t>("the size of record ids");
    std::vector<MdfBlock> groups;
    for (std::uint64_t next = data_group.link(1); next != 0;) {
      groups.push_back(blocks_.new_block_at(next, "CG", "a channel group"));
      next = groups.back().link(0);
    }
    std::size_t filled = 0;
    for (const MdfBlock& group : groups)
      if (cycles_of(group) > 0) ++filled;
    if (filled > 1 || (unfinished_ && groups.size() > 1)) {
      if (unsorted_.empty()) unsorted_at_ = at;
      unsorted_ =
          "channel groups that share a block of data (an unsorted file) are not read: sort the "
          "file "
          "with the program that wrote it";
      return data_group.link(0);
    }
    MdfData data;
    if (!groups.empty()) data = mdf_data(blocks_, data_group.link(2), last_length_unknown_);
    if (!data.warning.empty()) warn(data.warning);
    for (const MdfBlock& group : groups) {
      const bool owner = filled == 0 ? &group == &groups.front() : cycles_of(group) > 0;
      read_channel_group(group, id_bytes,
                         owner ? std::move(data.fragments) : std::vector<MdfFragment>{}, number);
    }
    return data_group.link(0);
  }

  std::uint64_t cycles_of(const MdfBlock& group) const {
    ByteCursor in(*file_, false, group.data + 8);
    return in.read<std::uint64_t>("the number of records of a channel group");
  }

  void read_channel_group(const MdfBlock& block, std::uint64_t id_bytes,
                          std::vector<MdfFragment> fragments, std::uint64_t number) {
    ByteCursor in(*file_, false, block.data + 16);
    const std::uint64_t cycles = cycles_of(block);
    const auto flags = in.read<std::uint16_t>("a channel group");
    in.skip(6);
    const auto data_bytes = in.read<std::uint32_t>("a channel group");
    const auto invalid_bytes = in.read<std::uint32_t>("a channel group");
    if ((flags & 1) != 0) return;  // values of variable length of a channel elsewhere
    MdfGroup group;
    group.record_bytes = id_bytes + data_bytes + invalid_bytes;
    if (group.record_bytes > most_record_bytes)
      fail(block.at, fmt::format("a channel group has records of {} bytes", group.record_bytes));
    const std::uint64_t total =
        fragments.empty() ? 0 : fragments.back().begin + fragments.back().length;
    const std::uint64_t there = group.record_bytes == 0 ? 0 : total / group.record_bytes;
    // where the file says that its counts were not brought up to date, its data say how many
    group.records = unfinished_ && (cycles == 0 || counts_stale_) ? there : std::min(cycles, there);
    if (cycles > there && group.record_bytes != 0 && !counts_stale_)
      warn(fmt::format("group {} announces {} records, {} are there", number, cycles, there));
    group.fragments = std::move(fragments);
    groups_.push_back(std::move(group));
    read_channels(block, id_bytes, data_bytes, number);
  }

  /// A channel (CN) of the group at hand.
  struct Described {
    std::uint64_t at = 0;
    std::string name;
    std::string unit;
    std::uint8_t type = 0;  ///< 0 values, 2 master, 3 virtual master, ...
    std::uint8_t sync = 0;  ///< of a master: 1 time, 2 angle, 3 distance, 4 index
    MdfField field;
    MdfConversion conversion;
    std::optional<std::uint64_t> invalid_bit;
    std::string comment;
    bool usable = true;
  };

  void read_channels(const MdfBlock& block, std::uint64_t id_bytes, std::uint64_t data_bytes,
                     std::uint64_t number) {
    std::vector<Described> found;
    for (std::uint64_t next = block.link(1); next != 0;) {
      const MdfBlock channel = blocks_.new_block_at(next, "CN", "a channel");
      next = channel.link(0);
      if (++channel_blocks_ > most_channels)
        fail(channel.at, fmt::format("there are more than {} channels", most_channels));
      found.push_back(described(channel, id_bytes, data_bytes));
    }
    const auto master = std::ranges::find_if(
        found, [](const Described& c) { return (c.type == 2 || c.type == 3) && c.usable; });
    datasets::SampleClock clock;
    std::string domain;
    if (master != found.end()) domain = set_clock(*master, clock);
    const std::string acquisition = blocks_.text_at(block.link(2));
    for (Described& channel : found) {
      const bool is_time =
          &channel == (master == found.end() ? nullptr : &*master) && domain.empty();
      if (!channel.usable || is_time || channel.type == 3) continue;
      add_channel(channel, clock, domain, acquisition, number);
    }
  }

  void add_channel(Described& described, const datasets::SampleClock& clock,
                   const std::string& domain, const std::string& acquisition,
                   std::uint64_t number) {
    Channel channel;
    channel.name = described.name;
    channel.unit = described.unit;
    channel.attributes["group"] = fmt::format("group {}", number);
    if (!acquisition.empty()) channel.attributes["acquisition"] = acquisition;
    if (!described.comment.empty()) channel.attributes["comment"] = described.comment;
    MdfConversion& conversion = described.conversion;
    if (!conversion.problem.empty()) {
      warn(fmt::format("'{}' is read unscaled, without its unit{}: {}", channel.name,
                       channel.unit.empty() ? "" : fmt::format(" '{}'", channel.unit),
                       conversion.problem));
      channel.unit.clear();
    }
    const auto [known, added] = quantities_.try_emplace(channel.unit, Quantity::unknown);
    if (added) known->second = datasets::quantity_of_unit(channel.unit);
    channel.quantity = known->second;
    channel.clock = clock;
    channel.scale = conversion.scale;
    channel.offset = conversion.offset;
    if (!domain.empty()) channel.attributes["domain"] = domain;
    record_.channels.push_back(std::move(channel));
    channels_.push_back({groups_.size() - 1, described.field, std::move(conversion.function),
                         described.invalid_bit});
  }

  Described described(const MdfBlock& block, std::uint64_t id_bytes, std::uint64_t data_bytes) {
    ByteCursor in(*file_, false, block.data);
    Described channel;
    channel.at = block.at;
    channel.name = blocks_.text_at(block.link(2));
    if (channel.name.empty()) channel.name = fmt::format("channel {}", channel_blocks_ - 1);
    channel.type = in.read<std::uint8_t>("a channel");
    channel.sync = in.read<std::uint8_t>("a channel");
    const auto data_type = in.read<std::uint8_t>("a channel");
    const auto bit_offset = in.read<std::uint8_t>("a channel");
    const auto byte_offset = in.read<std::uint32_t>("a channel");
    const auto bit_count = in.read<std::uint32_t>("a channel");
    const auto flags = in.read<std::uint32_t>("a channel");
    const auto invalid_bit = in.read<std::uint32_t>("a channel");
    if (channel.type == 3) {
      channel.conversion = conversion_at(block.link(4));
      channel.unit = blocks_.text_at(block.link(6));
      if (channel.unit.empty()) channel.unit = channel.conversion.unit;
      return channel;
    }
    const bool numbers = data_type <= 5 || data_type == 15 || data_type == 16;
    if (!numbers || channel.type == 1 || channel.type == 4 || channel.type >= 5 ||
        block.link(1) != 0) {
      if (left_out_.size() < 3) left_out_.push_back(channel.name);
      ++left_out_count_;
      channel.usable = false;
      return channel;
    }
    channel.unit = blocks_.text_at(block.link(6));
    channel.comment = blocks_.text_at(block.link(7));
    const bool floating = data_type == 4 || data_type == 5;
    channel.conversion = conversion_at(block.link(4), floating);
    if (channel.unit.empty()) channel.unit = channel.conversion.unit;
    channel.field = field_of(channel, data_type, bit_offset, bit_count);
    channel.field.offset = id_bytes + byte_offset;
    if (channel.field.shape == MdfField::Shape::complex && block.link(4) != 0) {
      channel.conversion = {};
      channel.conversion.problem = "its numbers are complex";
    }
    if (byte_offset + channel.field.bytes() > data_bytes)
      fail(block.at,
           fmt::format("'{}' lies in bytes {} to {} of records that have {}", channel.name,
                       byte_offset, byte_offset + channel.field.bytes() - 1, data_bytes));
    if ((flags & 1) != 0)
      warn(fmt::format("'{}': the file says that none of its values is valid", channel.name));
    if ((flags & 2) != 0) {
      const std::uint64_t bit = 8 * (id_bytes + data_bytes) + invalid_bit;
      if (bit / 8 >= groups_.back().record_bytes)
        fail(block.at, fmt::format("the invalidation bit {} of '{}' lies outside of the records",
                                   invalid_bit, channel.name));
      channel.invalid_bit = bit;
    }
    return channel;
  }

  MdfField field_of(const Described& channel, std::uint8_t data_type, std::uint32_t bit_offset,
                    std::uint32_t bit_count) const {
    MdfField field;
    if (data_type >= 15) {
      field.big_endian = data_type == 16;
      field.shape = MdfField::Shape::complex;
      field.kind = bit_count == 64 ? NumberKind::f32 : NumberKind::f64;
      if (bit_offset == 0 && (bit_count == 64 || bit_count == 128)) return field;
    } else if (data_type >= 4) {
      field.big_endian = data_type == 5;
      field.kind = bit_count == 32 ? NumberKind::f32 : NumberKind::f64;
      if (bit_count == 16) field.shape = MdfField::Shape::half_float;
      if (bit_offset == 0 && (bit_count == 16 || bit_count == 32 || bit_count == 64)) return field;
    } else if (bit_offset < 8 && bit_count > 0 && bit_count <= 64) {
      field.big_endian = data_type % 2 == 1;
      field.with_sign = data_type >= 2;
      field.bit = bit_offset;
      field.bit_count = bit_count;
      field.shape = MdfField::Shape::bits;
      constexpr std::array<std::pair<std::uint32_t, std::array<NumberKind, 2>>, 4> whole = {
          {{8, {NumberKind::u8, NumberKind::i8}},
           {16, {NumberKind::u16, NumberKind::i16}},
           {32, {NumberKind::u32, NumberKind::i32}},
           {64, {NumberKind::u64, NumberKind::i64}}}};
      for (const auto& [bits, kinds] : whole) {
        if (bit_offset != 0 || bit_count != bits) continue;
        field.shape = MdfField::Shape::number;
        field.kind = kinds[field.with_sign ? 1 : 0];
      }
      return field;
    }
    fail(channel.at, fmt::format("'{}' has numbers of type {} with {} bits from bit {} on",
                                 channel.name, data_type, bit_count, bit_offset));
  }

  /// The conversion at a place. Channels that share it share its parameters.
  MdfConversion conversion_at(std::uint64_t at, bool floating = false) {
    if (at == 0) return {};
    const auto known = conversions_.find({at, floating});
    if (known != conversions_.end()) return known->second;
    return conversions_.emplace(std::pair(at, floating), read_mdf_conversion(blocks_, at, floating))
        .first->second;
  }

  /// The clock of the group at hand from its master; returns what it is over where that is not
  /// time.
  std::string set_clock(const Described& master, datasets::SampleClock& clock) {
    constexpr std::array<const char*, 5> domains = {"other", "", "angle", "distance", "index"};
    const std::string domain = master.sync < domains.size() ? domains[master.sync] : "other";
    if (!domain.empty()) return domain;
    MdfGroup& group = groups_.back();
    const MdfConversion& conversion = master.conversion;
    if (!conversion.problem.empty()) {
      warn(fmt::format("the times in '{}' are not used: {}", master.name, conversion.problem));
      return {};
    }
    const auto unit = datasets::conversion(master.unit, "s");  // the standard has seconds
    const double factor = unit ? unit->factor : 1.0;
    if (master.type == 3) {  // no bytes: the number of the record, converted
      clock.start = factor * conversion.offset;
      clock.interval = conversion.function ? 0.0 : std::max(0.0, factor * conversion.scale);
      return {};
    }
    if (group.records == 0) return {};
    const MdfScaling seconds = [scale = conversion.scale, offset = conversion.offset, factor,
                                function = conversion.function](std::span<double> x) {
      if (function) function(x);
      for (double& v : x) v = factor * (function ? v : scale * v + offset);
    };
    MdfRecordBytes bytes(*file_, group.fragments);
    std::vector<double> block;
    const auto read = [&](std::uint64_t first, std::uint64_t count) {
      const std::uint64_t size = group.record_bytes;
      read_mdf_field(master.field, bytes.view(first * size, count * size), count, size, block);
      seconds(block);
    };
    if (group.records <= most_times &&
        time_bytes_ + group.records * group.record_bytes <= most_time_bytes) {
      time_bytes_ += group.records * group.record_bytes;
      std::vector<double> times;
      times.reserve(group.records);
      const std::uint64_t rows =
          std::clamp<std::uint64_t>((1 << 18) / group.record_bytes, 1, 32768);
      for (std::uint64_t i = 0; i < group.records; i += rows) {
        read(i, std::min(rows, group.records - i));
        times.insert(times.end(), block.begin(), block.end());
      }
      const TimeAxis axis = time_axis(std::move(times));
      clock.start = axis.clock.start;
      clock.interval = axis.clock.interval;
      if (!axis.warning.empty())
        warn(fmt::format("times from '{}': {}", master.name, axis.warning));
      if (group.records == 1 || axis.clock.uniform()) return {};
    } else {
      read(0, 1);
      clock.start = block.front();
      read(group.records - 1, 1);
      clock.interval = (block.front() - clock.start) / static_cast<double>(group.records - 1);
    }
    group.times = master.field;
    group.times_scaling = seconds;
    return {};
  }

  void tell_left_out() {
    if (left_out_count_ == 0) return;
    std::string list;
    for (const std::string& name : left_out_) list += (list.empty() ? "'" : ", '") + name + "'";
    warn(fmt::format("{} channel{} of texts, byte arrays or structures {} left out: {}{}",
                     left_out_count_, left_out_count_ == 1 ? "" : "s",
                     left_out_count_ == 1 ? "is" : "are", list,
                     left_out_count_ > left_out_.size() ? ", ..." : ""));
  }

  std::unique_ptr<MappedFile> file_;
  MdfBlocks blocks_;
  Record record_;
  std::vector<MdfGroup> groups_;
  std::vector<MdfChannel> channels_;
  std::map<std::string, Quantity> quantities_;
  std::size_t channel_blocks_ = 0;
  std::uint64_t time_bytes_ = 0;                                         // read at opening
  std::map<std::pair<std::uint64_t, bool>, MdfConversion> conversions_;  // and whether of floats
  std::vector<std::string> left_out_;
  std::size_t left_out_count_ = 0;
  std::string unsorted_;
  std::uint64_t unsorted_at_ = 0;
  bool unfinished_ = false;
  bool counts_stale_ = false;
  bool last_length_unknown_ = false;
};

}  // namespace

int recognises_mdf4(std::string_view, std::string_view head) {
  const bool mdf = head.starts_with("MDF     ") || head.starts_with("UnFinMF ");
  return mdf && head.size() > 8 && head[8] == '4' ? 100 : 0;
}

std::unique_ptr<RecordingReader> open_mdf4(const std::string& path, const ImportOptions&) {
  return MdfReader(path).open();
}

}  // namespace impactrig::acquisition
