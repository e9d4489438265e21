// SPDX-License-Identifier: BSD-3-Clause
// ASAM MDF 4. Layout: ASAM, "MDF (Measurement Data Format) 4.1", its wiki at asam.net and the
// public "MDF 4.x programmers' guide"; block names below are the standard's (HD, DG, CG, CN, CC,
// DL, DZ).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <unordered_set>

#include "acquisition/importers/byte_cursor.hpp"
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/mdf4_blocks.hpp"
#include "acquisition/importers/mdf4_channels.hpp"
#include "acquisition/importers/mdf4_conversion.hpp"
#include "acquisition/importers/mdf4_data.hpp"
#include "acquisition/importers/mdf4_mixed.hpp"
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
constexpr std::uint64_t most_time_bytes = std::uint64_t{1} << 26;   ///< read at opening, for times
constexpr std::uint64_t least_time_bytes = std::uint64_t{1} << 20;  ///< where groups share data
constexpr std::uint64_t most_times = std::uint64_t{1} << 22;        ///< looked at when opening

class MdfReader {
 public:
  explicit MdfReader(const std::string& path)
      : file_(std::make_unique<MappedFile>(path)),
        blocks_(*file_),
        described_(blocks_, [this](std::string sentence) { warn(std::move(sentence)); }) {}

  std::unique_ptr<RecordingReader> open() {
    read_identification();
    const std::uint64_t first_group = read_header();
    std::uint64_t number = 0;
    for (std::uint64_t at = first_group; at != 0; ++number) at = read_data_group(at, number);
    described_.tell_left_out();
    if (record_.channels.empty() && !unread_.empty()) fail(unread_at_, unread_);
    if (!unread_.empty()) warn(unread_);
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
    if (told_.insert(sentence).second) record_.warnings.push_back(std::move(sentence));
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
    bool variable = false;  // values that stand among the records, counted or not
    for (const MdfBlock& group : groups) {
      if (cycles_of(group) > 0) ++filled;
      variable = variable || (id_bytes > 0 && facts_of(group).variable);
    }
    if (filled > 1 || ((unfinished_ || variable) && groups.size() > 1)) {
      read_mixed_groups(data_group, groups, id_bytes, number);
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
    const GroupFacts facts = facts_of(block);
    if (facts.variable) return;
    const std::string name = fmt::format("group {}", number);
    MdfGroup group;
    group.record_bytes = record_bytes(block, id_bytes, facts);
    const std::uint64_t total =
        fragments.empty() ? 0 : fragments.back().begin + fragments.back().length;
    const std::uint64_t there = group.record_bytes == 0 ? 0 : total / group.record_bytes;
    take_count(group, name, facts.cycles, there);
    group.fragments = std::move(fragments);
    groups_.push_back(std::move(group));
    std::vector<MdfDescribed> found = channels_of(block, id_bytes, facts);
    datasets::SampleClock clock;
    std::string domain;
    const MdfDescribed* const master = master_of(found);
    if (master != nullptr)
      domain = set_clock(
          *master, groups_.back(), [&] { return times_seen(*master); }, clock);
    add_channels({groups_.size() - 1, name, blocks_.text_at(block.link(2)), clock, domain}, master,
                 found);
  }

  /// What a channel group (CG) says of its records.
  struct GroupFacts {
    std::uint64_t id = 0;
    std::uint64_t cycles = 0;
    bool variable = false;  ///< values of variable length of a channel elsewhere
    std::uint64_t data_bytes = 0;
    std::uint64_t invalid_bytes = 0;
  };

  std::vector<MdfDescribed> channels_of(const MdfBlock& group, std::uint64_t id_bytes,
                                        const GroupFacts& facts) {
    return described_.chain(group.link(1),
                            {id_bytes, facts.data_bytes, record_bytes(group, id_bytes, facts)});
  }

  GroupFacts facts_of(const MdfBlock& block) const {
    ByteCursor in(*file_, false, block.data);
    GroupFacts facts;
    facts.id = in.read<std::uint64_t>("a channel group");
    facts.cycles = in.read<std::uint64_t>("a channel group");
    facts.variable = (in.read<std::uint16_t>("a channel group") & 1) != 0;
    in.skip(6);
    facts.data_bytes = in.read<std::uint32_t>("a channel group");
    facts.invalid_bytes = in.read<std::uint32_t>("a channel group");
    return facts;
  }

  std::uint64_t record_bytes(const MdfBlock& block, std::uint64_t id_bytes,
                             const GroupFacts& facts) const {
    const std::uint64_t bytes = id_bytes + facts.data_bytes + facts.invalid_bytes;
    if (bytes > most_record_bytes)
      fail(block.at, fmt::format("a channel group has records of {} bytes", bytes));
    return bytes;
  }

  /// Where the file says that its counts were not brought up to date, its data say how many.
  bool is_stale(std::uint64_t cycles) const {
    return unfinished_ && (cycles == 0 || counts_stale_);
  }

  /// `there`: records that the data hold.
  void take_count(MdfGroup& group, const std::string& name, std::uint64_t cycles,
                  std::uint64_t there) {
    group.records = is_stale(cycles) ? there : std::min(cycles, there);
    if (cycles > there && group.record_bytes != 0 && !counts_stale_)
      warn(mdf_short(name, cycles, there));
    else if (cycles < there && group.records == cycles && group.record_bytes != 0)
      warn(fmt::format("{} announces {} records, {} are there: the last ones are not read", name,
                       cycles, there));
  }

  /// A channel group whose records stand among those of others, before its channels are made.
  struct MixedPart {
    GroupFacts facts;
    std::size_t group = 0;
    std::string acquisition;
    std::vector<MdfDescribed> channels;
    std::uint64_t seen = 0;     ///< records
    std::vector<double> times;  ///< of them, as they are stored: the first ones and the last
  };

  /// Reads channel groups whose records stand by turns.
  void read_mixed_groups(const MdfBlock& data_group, const std::vector<MdfBlock>& blocks,
                         std::uint64_t id_bytes, std::uint64_t number) {
    const auto mixed = std::make_shared<MdfMixed>();
    mixed->id_bytes = id_bytes;
    mixed->name = fmt::format("group {}", number);
    if (const std::string problem = kinds_of(blocks, *mixed); !problem.empty()) {
      if (unread_.empty()) unread_at_ = data_group.at;
      unread_ = problem;
      return;
    }
    MdfData data = mdf_data(blocks_, data_group.link(2), last_length_unknown_);
    if (!data.warning.empty()) warn(data.warning);
    mixed->fragments = std::move(data.fragments);
    std::vector<MixedPart> parts;
    for (const MdfBlock& block : blocks) {
      MixedPart part;
      part.facts = facts_of(block);
      if (part.facts.variable) continue;
      MdfGroup group;
      group.record_bytes = record_bytes(block, id_bytes, part.facts);
      group.mixed = mixed;
      group.name = fmt::format("{}.{}", mixed->name, part.facts.id);
      part.group = groups_.size();
      mixed->groups.push_back(part.group);
      groups_.push_back(std::move(group));
      part.acquisition = blocks_.text_at(block.link(2));
      part.channels = channels_of(block, id_bytes, part.facts);
      parts.push_back(std::move(part));
    }
    look_at_mixed(*mixed, parts);
  }

  /// Takes the ids of groups; returns why their records cannot be told apart, "" where they can.
  std::string kinds_of(const std::vector<MdfBlock>& blocks, MdfMixed& mixed) const {
    constexpr std::string_view sort = "sort the file with the program that wrote it";
    if (mixed.id_bytes == 0)
      return fmt::format(
          "channel groups that share a block of data without record ids are not read: {}", sort);
    if (mixed.id_bytes > 8 || !std::has_single_bit(mixed.id_bytes))
      return fmt::format(
          "channel groups that share a block of data with record ids of {} bytes are not read: {}",
          mixed.id_bytes, sort);
    for (const bool filled : {true, false}) {  // empty groups may have the ids of others
      std::size_t place = 0;
      for (const MdfBlock& block : blocks) {
        const GroupFacts facts = facts_of(block);
        MdfMixed::Kind kind;
        kind.variable = facts.variable;
        kind.bytes = facts.variable ? mixed.id_bytes + sizeof(std::uint32_t)
                                    : record_bytes(block, mixed.id_bytes, facts);
        kind.place = facts.variable ? 0 : place++;
        if ((facts.cycles > 0 || unfinished_) != filled) continue;
        if (!mixed.kinds.emplace(facts.id, kind).second && filled)
          return fmt::format(
              "channel groups that share a block of data and the record id {} are not read: {}",
              facts.id, sort);
      }
    }
    return {};
  }

  /// Goes through the data as far as it does not take long, which says how many records there are
  /// and when they were taken; of what is behind only the counts are known.
  void look_at_mixed(const MdfMixed& mixed, std::vector<MixedPart>& parts) {
    MdfMixedRecords records(*file_, mixed);
    std::vector<const MdfDescribed*> masters;
    for (const MixedPart& part : parts) masters.push_back(stored_time_of(part.channels));
    const std::uint64_t most =
        std::max(most_time_bytes - std::min(most_time_bytes, time_bytes_), least_time_bytes);
    std::uint64_t times = 0;
    std::vector<double> value;
    while (times < most_times) {
      const auto record = records.next(most);
      if (!record) break;
      MixedPart& part = parts[record->place];
      ++part.seen;
      if (masters[record->place] == nullptr) continue;
      read_mdf_field(masters[record->place]->field, record->bytes, 1, 1, value);
      part.times.push_back(value.front());
      ++times;
    }
    time_bytes_ += records.at();
    if (!records.problem().empty()) warn(records.problem());
    const bool whole = records.at_the_end();
    const double share = whole ? 1.0
                               : static_cast<double>(records.at()) /
                                     static_cast<double>(mixed.bytes());  // > 0: it has a record
    std::vector<datasets::SampleClock> clocks(parts.size());
    std::vector<std::string> domains(parts.size());
    double longest = 0.0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      MixedPart& part = parts[i];
      count_mixed(part, whole, share, mixed.bytes());
      const MdfDescribed* const master = master_of(part.channels);
      if (master == nullptr) continue;
      domains[i] = set_clock(
          *master, groups_[part.group], [&] { return times_seen(part, whole); }, clocks[i]);
      if (part.seen > 1)
        longest = std::max(longest, clocks[i].interval * static_cast<double>(part.seen - 1));
    }
    for (std::size_t i = 0; i < parts.size(); ++i) {
      MixedPart& part = parts[i];
      const MdfGroup& group = groups_[part.group];
      // a group of which hardly any record was seen: as long as the others
      if (!whole && group.times && part.seen < 2 && group.records > 1)
        clocks[i].interval = longest / share / static_cast<double>(group.records);
      add_channels({part.group, group.name, part.acquisition, clocks[i], domains[i]},
                   master_of(part.channels), part.channels);
    }
  }

  void count_mixed(const MixedPart& part, bool whole, double share, std::uint64_t total) {
    MdfGroup& group = groups_[part.group];
    const std::uint64_t cycles = part.facts.cycles;
    const std::uint64_t room = total / group.record_bytes;  // at least the id
    if (whole) return take_count(group, group.name, cycles, part.seen);
    group.counted = false;
    group.estimated = is_stale(cycles);
    group.records = group.estimated
                        ? static_cast<std::uint64_t>(static_cast<double>(part.seen) / share)
                        : cycles;
    group.announced = group.estimated ? 0 : cycles;
    group.records = std::min(group.records, room);
  }

  static const MdfDescribed* master_of(const std::vector<MdfDescribed>& channels) {
    const auto master = std::ranges::find_if(channels, [](const MdfDescribed& channel) {
      return (channel.type == 2 || channel.type == 3) && channel.usable;
    });
    return master == channels.end() ? nullptr : &*master;
  }

  /// The master whose values are times that can be used; null: there is none.
  static const MdfDescribed* stored_time_of(const std::vector<MdfDescribed>& channels) {
    const MdfDescribed* const master = master_of(channels);
    const bool stored = master != nullptr && master->type == 2 && domain_of(*master).empty() &&
                        master->conversion.problem.empty();
    return stored ? master : nullptr;
  }

  /// What the channels of a group have in common.
  struct Shared {
    std::size_t group = 0;
    std::string name;
    std::string acquisition;
    datasets::SampleClock clock;
    std::string domain;
  };

  void add_channels(const Shared& shared, const MdfDescribed* master,
                    std::vector<MdfDescribed>& found) {
    for (MdfDescribed& channel : found) {
      const bool is_time = &channel == master && shared.domain.empty();
      if (channel.usable && !is_time && channel.type != 3) add_channel(channel, shared);
    }
  }

  void add_channel(MdfDescribed& described, const Shared& shared) {
    Channel channel;
    channel.name = described.name;
    channel.unit = described.unit;
    channel.attributes["group"] = shared.name;
    if (!shared.acquisition.empty()) channel.attributes["acquisition"] = shared.acquisition;
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
    channel.clock = shared.clock;
    channel.scale = conversion.scale;
    channel.offset = conversion.offset;
    if (!shared.domain.empty()) channel.attributes["domain"] = shared.domain;
    record_.channels.push_back(std::move(channel));
    channels_.push_back({shared.group, described.field, std::move(conversion.function),
                         described.invalid_bit, described.never_valid});
  }

  /// What a master is over; "" for times.
  static std::string domain_of(const MdfDescribed& master) {
    constexpr std::array<const char*, 5> domains = {"other", "", "angle", "distance", "index"};
    return master.sync < domains.size() ? domains[master.sync] : "other";
  }

  /// Times of a group as they are stored.
  struct TimesSeen {
    std::vector<double> times;
    bool all = false;
    std::uint64_t steps = 0;  ///< where not all: from the first to the last of them
  };

  /// The clock of a group from its master, whose times `seen` gives; returns what it is over where
  /// that is not time.
  template <typename Seen>
  std::string set_clock(const MdfDescribed& master, MdfGroup& group, const Seen& seen,
                        datasets::SampleClock& clock) {
    std::string domain = domain_of(master);
    if (!domain.empty()) return domain;
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
    TimesSeen found = seen();
    seconds(found.times);
    if (found.all) {
      found.times.resize(std::min<std::uint64_t>(found.times.size(), group.records));
      const TimeAxis axis = time_axis(std::move(found.times));
      clock.start = axis.clock.start;
      clock.interval = axis.clock.interval;
      if (!axis.warning.empty())
        warn(fmt::format("times from '{}': {}", master.name, axis.warning));
      if (group.records == 1 || axis.clock.uniform()) return {};
    } else if (!found.times.empty()) {
      clock.start = found.times.front();
      if (found.steps > 0)
        clock.interval = (found.times.back() - clock.start) / static_cast<double>(found.steps);
    }
    group.times = master.field;
    group.times_scaling = seconds;
    return {};
  }

  /// Of the group at hand: all where that does not take long, else the first and the last.
  TimesSeen times_seen(const MdfDescribed& master) {
    const MdfGroup& group = groups_.back();
    MdfRecordBytes bytes(*file_, group.fragments);
    TimesSeen seen;
    std::vector<double> block;
    const auto read = [&](std::uint64_t first, std::uint64_t count) {
      const std::uint64_t size = group.record_bytes;
      read_mdf_field(master.field, bytes.view(first * size, count * size), count, size, block);
      seen.times.insert(seen.times.end(), block.begin(), block.end());
    };
    seen.all = group.records <= most_times &&
               time_bytes_ + group.records * group.record_bytes <= most_time_bytes;
    if (!seen.all) {
      read(0, 1);
      read(group.records - 1, 1);
      seen.steps = group.records - 1;
      return seen;
    }
    time_bytes_ += group.records * group.record_bytes;
    seen.times.reserve(group.records);
    const std::uint64_t rows = std::clamp<std::uint64_t>((1 << 18) / group.record_bytes, 1, 32768);
    for (std::uint64_t i = 0; i < group.records; i += rows)
      read(i, std::min(rows, group.records - i));
    return seen;
  }

  /// Of a group among others, of which `whole` says whether all records were gone through.
  static TimesSeen times_seen(MixedPart& part, bool whole) {
    TimesSeen seen{std::move(part.times), whole, 0};
    if (!whole && !seen.times.empty()) seen.steps = seen.times.size() - 1;
    return seen;
  }

  std::unique_ptr<MappedFile> file_;
  MdfBlocks blocks_;
  MdfChannels described_;
  Record record_;
  std::unordered_set<std::string> told_;  // its warnings
  std::vector<MdfGroup> groups_;
  std::vector<MdfChannel> channels_;
  std::map<std::string, Quantity> quantities_;
  std::uint64_t time_bytes_ = 0;  // read at opening
  std::string unread_;            // why a data group is not
  std::uint64_t unread_at_ = 0;
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
