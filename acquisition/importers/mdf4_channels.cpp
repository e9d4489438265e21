// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/mdf4_channels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "acquisition/importers/byte_cursor.hpp"
#include "acquisition/importers/mdf4_arrays.hpp"

namespace impactrig::acquisition {
namespace {

// A limit, so that memory stays small whatever a file says.
constexpr std::size_t most_channels = 100000;
constexpr int deepest_structure = 16;

}  // namespace

void MdfChannels::count_channels(std::uint64_t at, std::uint64_t more) {
  channel_blocks_ += more;
  if (channel_blocks_ > most_channels)
    fail(at, fmt::format("there are more than {} channels", most_channels));
}

std::vector<MdfDescribed> MdfChannels::chain_of_channels(std::uint64_t next, const Around& around) {
  std::vector<MdfDescribed> found;
  while (next != 0) {
    const MdfBlock channel = blocks_.new_block_at(next, "CN", "a channel");
    next = channel.link(0);
    count_channels(channel.at, 1);
    if (channel.link(1) == 0)
      found.push_back(described(channel, around.records));
    else
      for (MdfDescribed& part : parts_of(channel, around)) found.push_back(std::move(part));
  }
  return found;
}

/// The channels that a structure or an array in each record is made of.
std::vector<MdfDescribed> MdfChannels::parts_of(const MdfBlock& block, const Around& around) {
  const std::string name = name_of(block);
  if (around.depth == deepest_structure) {
    leave_out(name);
    return {};
  }
  const Around within{around.records, around.depth + 1};
  const MdfBlock composed = blocks_.block_at(block.link(1), "the composition of a channel");
  if (composed.id == "CN") {
    std::vector<MdfDescribed> parts;
    if (has_numbers(block))
      parts.push_back(described(block, around.records));  // a word and its bits
    for (MdfDescribed& member : chain_of_channels(block.link(1), within)) {
      // many programs name them by all of their name
      if (!member.name.starts_with(name + ".")) member.name = name + "." + member.name;
      parts.push_back(std::move(member));
    }
    return parts;
  }
  return elements_of(block, name, within);
}

/// Those of an array.
std::vector<MdfDescribed> MdfChannels::elements_of(const MdfBlock& block, const std::string& name,
                                                   const Around& within) {
  const MdfArray array = mdf_array(blocks_, block.link(1));
  if (!array.problem.empty()) {
    warn_(fmt::format("'{}' is left out: {}", name, array.problem));
    return {};
  }
  std::vector<MdfDescribed> members;
  if (array.members != 0)
    members = chain_of_channels(array.members, within);
  else
    members.push_back(described(block, within.records));
  std::erase_if(members,
                [](const MdfDescribed& member) { return !member.usable || member.type == 3; });
  for (MdfDescribed& member : members)
    if (member.name.starts_with(name + ".")) member.name.erase(0, name.size() + 1);
  if (!members.empty()) count_channels(block.at, array.elements * members.size());
  std::vector<MdfDescribed> parts;
  for (std::uint64_t i = 0; i < array.elements; ++i) {
    const auto [indices, bytes, bits] = array.element(i);
    for (const MdfDescribed& member : members) {
      MdfDescribed part = member;
      part.name = name + indices + (array.members != 0 ? "." + member.name : "");
      place(part, bytes, bits, within.records);
      parts.push_back(std::move(part));
    }
  }
  return parts;
}

/// Of a channel with members, which as a rule is but the bytes of them.
bool MdfChannels::has_numbers(const MdfBlock& block) const {
  ByteCursor in(blocks_.file(), false, block.data + 2);
  return in.read<std::uint8_t>("a channel") <= 5;
}

/// Moves a channel within the record.
void MdfChannels::place(MdfDescribed& channel, std::int64_t bytes, std::int64_t bits,
                        const Records& records) const {
  const std::int64_t first = static_cast<std::int64_t>(channel.field.offset - records.id) + bytes;
  const auto last = first + static_cast<std::int64_t>(channel.field.bytes()) - 1;
  if (first < 0 || last >= static_cast<std::int64_t>(records.values))
    fail(channel.at, fmt::format("'{}' lies in bytes {} to {} of records that have {}",
                                 channel.name, first, last, records.values));
  channel.field.offset = records.id + static_cast<std::uint64_t>(first);
  if (!channel.invalid_bit) return;
  const std::int64_t bit = static_cast<std::int64_t>(*channel.invalid_bit) + bits;
  if (bit / 8 >= static_cast<std::int64_t>(records.all))
    fail(channel.at,
         fmt::format("the invalidation bit of '{}' lies outside of the records", channel.name));
  channel.invalid_bit = static_cast<std::uint64_t>(bit);
}

std::string MdfChannels::name_of(const MdfBlock& block) {
  std::string name = blocks_.text_at(block.link(2));
  return name.empty() ? fmt::format("channel {}", channel_blocks_ - 1) : name;
}

void MdfChannels::leave_out(const std::string& name) {
  if (left_out_.size() < 3) left_out_.push_back(name);
  ++left_out_count_;
}

MdfDescribed MdfChannels::described(const MdfBlock& block, const Records& records) {
  ByteCursor in(blocks_.file(), false, block.data);
  MdfDescribed channel;
  channel.at = block.at;
  channel.name = name_of(block);
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
  if (!numbers || channel.type == 1 || channel.type >= 4) {
    leave_out(channel.name);
    channel.usable = false;
    return channel;
  }
  channel.unit = blocks_.text_at(block.link(6));
  channel.comment = blocks_.text_at(block.link(7));
  const bool floating = data_type == 4 || data_type == 5;
  channel.conversion = conversion_at(block.link(4), floating);
  if (channel.unit.empty()) channel.unit = channel.conversion.unit;
  const auto field = field_of(data_type, bit_offset, bit_count);
  if (!field) {
    warn_(fmt::format(
        "'{}' is left out: it has numbers of type {} with {} bits from bit {} on, which "
        "are not read",
        channel.name, data_type, bit_count, bit_offset));
    channel.usable = false;
    return channel;
  }
  channel.field = *field;
  channel.field.offset = records.id + byte_offset;
  if (channel.field.complex && block.link(4) != 0) {
    channel.conversion = {};
    channel.conversion.problem = "its numbers are complex";
  }
  if (byte_offset + channel.field.bytes() > records.values)
    fail(block.at,
         fmt::format("'{}' lies in bytes {} to {} of records that have {}", channel.name,
                     byte_offset, byte_offset + channel.field.bytes() - 1, records.values));
  channel.never_valid = (flags & 1) != 0;
  if (channel.never_valid)
    warn_(fmt::format("'{}': the file says that none of its values is valid: all are marked",
                      channel.name));
  if ((flags & 2) != 0) {
    const std::uint64_t bit = 8 * (records.id + records.values) + invalid_bit;
    if (bit / 8 >= records.all)
      fail(block.at, fmt::format("the invalidation bit {} of '{}' lies outside of the records",
                                 invalid_bit, channel.name));
    channel.invalid_bit = bit;
  }
  return channel;
}

/// None for numbers that no type of the standard has.
std::optional<MdfField> MdfChannels::field_of(std::uint8_t data_type, std::uint32_t bit_offset,
                                              std::uint32_t bit_count) {
  MdfField field;
  if (data_type >= 4) {
    field.complex = data_type >= 15;
    field.big_endian = data_type == 5 || data_type == 16;
    const std::uint32_t bits = field.complex ? bit_count / 2 : bit_count;  // of a part
    field.kind = bits == 32 ? NumberKind::f32 : NumberKind::f64;
    if (bits == 16) field.shape = MdfField::Shape::half_float;
    const bool whole = bit_offset == 0 && (!field.complex || bit_count % 2 == 0);
    if (whole && (bits == 16 || bits == 32 || bits == 64)) return field;
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
  return std::nullopt;
}

/// The conversion at a place. Channels that share it share its parameters.
const MdfConversion& MdfChannels::conversion_at(std::uint64_t at, bool floating) {
  static const MdfConversion none;
  if (at == 0) return none;
  const auto known = conversions_.find({at, floating});
  if (known != conversions_.end()) return known->second;
  return conversions_.emplace(std::pair(at, floating), read_mdf_conversion(blocks_, at, floating))
      .first->second;
}

void MdfChannels::tell_left_out() const {
  if (left_out_count_ == 0) return;
  std::string list;
  for (const std::string& name : left_out_) list += (list.empty() ? "'" : ", '") + name + "'";
  warn_(fmt::format("{} channel{} of texts, byte arrays or record numbers {} left out: {}{}",
                    left_out_count_, left_out_count_ == 1 ? "" : "s",
                    left_out_count_ == 1 ? "is" : "are", list,
                    left_out_count_ > left_out_.size() ? ", ..." : ""));
}

}  // namespace impactrig::acquisition
