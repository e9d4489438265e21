// SPDX-License-Identifier: BSD-3-Clause
// ASAM MDF 4. Layout: ASAM, "MDF (Measurement Data Format) 4.1", its wiki at asam.net and the
// public "MDF 4.x programmers' guide"; block names below are the standard's (HD, DG, CG, CN, CC,
// DL, DZ).
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <unordered_set>

#include "acquisition/importers/byte_cursor.hpp"
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/stored_numbers.hpp"
#include "acquisition/importers/text_file.hpp"
#include "acquisition/importers/time_axis.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::InputError;
using datasets::Quantity;
using datasets::Record;

namespace {

constexpr std::uint64_t block_head = 24;  ///< of every block: id, length, number of links [bytes]

// Limits, so that memory stays below 256 MB whatever a file says.
constexpr std::uint64_t most_expanded = std::uint64_t{1} << 26;  ///< bytes of a compressed block
constexpr std::uint64_t most_record_bytes = std::uint64_t{1} << 24;
constexpr std::uint64_t most_time_bytes = std::uint64_t{1} << 26;  ///< read at opening, for times
constexpr std::uint64_t most_times = std::uint64_t{1} << 22;       ///< looked at when opening
constexpr std::size_t most_channels = 100000;
constexpr std::uint64_t most_text_bytes = std::uint64_t{1} << 26;
constexpr std::uint64_t deflate_at_most = 1032;  ///< bytes out for one in, by the method's design

using Scaling = std::function<void(std::span<double>)>;

/// A part of a group's data: bytes of the file, or what they expand to.
struct Fragment {
  std::uint64_t begin = 0;   ///< within the group's data
  std::uint64_t length = 0;  ///< there
  std::uint64_t at = 0;      ///< in the file
  std::uint64_t stored = 0;  ///< bytes in the file
  bool deflated = false;
  std::uint32_t columns = 0;  ///< > 0: transposed, rows of this length
};

/// Gives back the memory that zlib holds.
class Inflater {
 public:
  Inflater() { ready_ = inflateInit(&stream_) == Z_OK; }

  ~Inflater() {
    if (ready_) inflateEnd(&stream_);
  }

  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  /// True when `from` is a whole stream that fills `to` exactly.
  bool expand(std::string_view from, std::span<char> to) {
    if (!ready_ || from.size() > std::numeric_limits<uInt>::max()) return false;
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(from.data()));
    stream_.avail_in = static_cast<uInt>(from.size());
    stream_.next_out = reinterpret_cast<Bytef*>(to.data());
    stream_.avail_out = static_cast<uInt>(to.size());
    return inflate(&stream_, Z_FINISH) == Z_STREAM_END && stream_.avail_out == 0;
  }

 private:
  z_stream stream_{};
  bool ready_ = false;
};

/// The bytes of a group's records, wherever they lie. Expands one compressed block at a time.
class RecordBytes {
 public:
  RecordBytes(const MappedFile& file, const std::vector<Fragment>& fragments)
      : file_(&file),
        fragments_(&fragments) {}

  /// `length` bytes from `begin` on; they live until the next call.
  const char* view(std::uint64_t begin, std::uint64_t length) {
    std::size_t i = fragment_at(begin);
    const Fragment& first = (*fragments_)[i];
    if (begin + length <= first.begin + first.length)
      return bytes_of(i).data() + (begin - first.begin);
    joined_.resize(length);
    for (std::uint64_t done = 0; done < length; ++i) {
      const Fragment& fragment = (*fragments_)[i];
      const std::uint64_t skip = begin + done - fragment.begin;
      const std::uint64_t count = std::min(length - done, fragment.length - skip);
      std::memcpy(joined_.data() + done, bytes_of(i).data() + skip, count);
      done += count;
    }
    return joined_.data();
  }

 private:
  std::size_t fragment_at(std::uint64_t begin) const {
    const auto after = std::ranges::upper_bound(*fragments_, begin, {}, &Fragment::begin);
    return static_cast<std::size_t>(after - fragments_->begin()) - 1;
  }

  std::string_view bytes_of(std::size_t i) {
    const Fragment& fragment = (*fragments_)[i];
    const std::string_view stored = file_->bytes().substr(fragment.at, fragment.stored);
    if (!fragment.deflated) return stored;
    if (expanded_ == i) return {expanded_bytes_.data(), expanded_bytes_.size()};
    expanded_ = none;
    expanded_bytes_.resize(fragment.length);
    if (!Inflater().expand(stored, expanded_bytes_))
      throw InputError(file_->byte_position(fragment.at),
                       fmt::format("the compressed data are damaged, or are not the {} bytes "
                                   "announced",
                                   fragment.length));
    if (fragment.columns > 0) untranspose(fragment.columns);
    file_->release(fragment.at, fragment.at + fragment.stored);
    expanded_ = i;
    return {expanded_bytes_.data(), expanded_bytes_.size()};
  }

  /// All first bytes of the rows, then all second ones, ...: back into rows. What is left after the
  /// last whole row was not transposed.
  void untranspose(std::uint64_t columns) {
    const std::uint64_t rows = expanded_bytes_.size() / columns;
    rows_.resize(rows * columns);
    for (std::uint64_t row = 0; row < rows; ++row)
      for (std::uint64_t column = 0; column < columns; ++column)
        rows_[row * columns + column] = expanded_bytes_[column * rows + row];
    std::ranges::copy(rows_, expanded_bytes_.begin());
  }

  static constexpr std::size_t none = ~std::size_t{0};

  const MappedFile* file_;
  const std::vector<Fragment>* fragments_;
  std::size_t expanded_ = none;
  std::vector<char> expanded_bytes_;
  std::vector<char> rows_;
  std::vector<char> joined_;
};

/// How a value lies in a record.
struct Field {
  enum class Shape { number, complex, bits, half_float };
  Shape shape = Shape::number;
  NumberKind kind = NumberKind::f64;  ///< number and complex
  bool big_endian = false;
  bool with_sign = false;        ///< bits
  std::uint64_t offset = 0;      ///< of its first byte in the record
  std::uint32_t bit = 0;         ///< bits: of its lowest bit
  std::uint32_t bit_count = 64;  ///< bits

  std::uint64_t bytes() const {
    switch (shape) {
      case Shape::number:
        return size_of(kind);
      case Shape::complex:
        return 2 * size_of(kind);
      case Shape::half_float:
        return 2;
      case Shape::bits:
        break;
    }
    return (bit + bit_count + 7) / 8;
  }
};

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
double bits_at(const char* at, const Field& field) {
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
void read_field(const Field& field, const char* records, std::uint64_t count, std::uint64_t stride,
                std::vector<Value>& to) {
  to.resize(count);
  const char* const from = records + field.offset;
  if (field.shape == Field::Shape::number || field.shape == Field::Shape::complex)
    return convert_numbers(field.kind, field.big_endian, from, count, stride, to.data());
  for (std::uint64_t i = 0; i < count; ++i) {
    const char* const at = from + i * stride;
    if (field.shape == Field::Shape::bits) {
      to[i] = static_cast<Value>(bits_at(at, field));
    } else {
      const auto low = static_cast<unsigned char>(at[field.big_endian ? 1 : 0]);
      const auto high = static_cast<unsigned char>(at[field.big_endian ? 0 : 1]);
      to[i] = static_cast<Value>(half_float(static_cast<std::uint16_t>(low | high << 8)));
    }
  }
}

struct Group {
  std::vector<Fragment> fragments;
  std::uint64_t record_bytes = 0;  ///< with record id and invalidation bytes
  std::uint64_t records = 0;
  std::optional<Field> times;  ///< of a time master whose clock is not uniform
  Scaling times_scaling;
};

struct MdfChannel {
  std::size_t group = 0;
  Field field;
  Scaling scaling;
  std::optional<std::uint64_t> invalid_bit;  ///< in the record
};

/// Reads records by blocks; each gives the values of every channel asked for.
class MdfRecording final : public RecordingReader {
 public:
  MdfRecording(std::unique_ptr<MappedFile> file, Record record, std::vector<Group> groups,
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
      const Group& group = groups_[g];
      RecordBytes bytes(*file_, group.fragments);
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
  static std::uint64_t rows_at_once(const Group& group) {
    return std::clamp<std::uint64_t>(
        (std::uint64_t{1} << 18) / std::max<std::uint64_t>(group.record_bytes, 1), 1, 32768);
  }

  std::span<const double> times_of(const Group& group, const char* records, std::uint64_t count) {
    read_field(*group.times, records, count, group.record_bytes, times_);
    if (group.times_scaling) group.times_scaling(times_);
    return times_;
  }

  SampleRange between(const Group& group, RecordBytes& bytes, const Selection& wanted,
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

  void hand_over(const Group& group, RecordBytes& bytes, SampleRange range,
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

  void hand_over(const Group& group, const MdfChannel& channel, const char* records,
                 std::uint64_t count, std::size_t place, SampleSink& sink) {
    SampleBlock block;
    const Field& field = channel.field;
    const auto read = [&](auto& values) {
      read_field(field, records, count, group.record_bytes, values);
      block.raw = std::span(std::as_const(values));
    };
    const bool number = field.shape == Field::Shape::number || field.shape == Field::Shape::complex;
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
    if (field.shape == Field::Shape::complex) {
      Field imaginary = field;
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
  std::vector<Group> groups_;
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

/// What a conversion (CC) makes of a number.
struct Conversion {
  double scale = 1.0;
  double offset = 0.0;
  Scaling function;
  std::string unit;
  std::string problem;  ///< why it cannot be applied
};

class MdfReader {
 public:
  explicit MdfReader(const std::string& path)
      : file_(std::make_unique<MappedFile>(path)),
        size_(file_->bytes().size()) {}

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
    return std::make_unique<MdfRecording>(std::move(file_), std::move(record_), std::move(groups_),
                                          std::move(channels_));
  }

 private:
  [[noreturn]] void fail(std::uint64_t at, std::string_view problem) const {
    throw InputError(file_->byte_position(std::min(at, size_)), problem);
  }

  void warn(std::string sentence) {
    if (std::ranges::find(record_.warnings, sentence) == record_.warnings.end())
      record_.warnings.push_back(std::move(sentence));
  }

  /// A block: its links, and a cursor at its data.
  struct Block {
    std::uint64_t at;
    std::string id;  ///< "HD"
    std::vector<std::uint64_t> links;
    std::uint64_t data;  ///< [byte in the file]
    std::uint64_t end;

    std::uint64_t link(std::size_t i) const { return i < links.size() ? links[i] : 0; }
  };

  /// A block with its first links, `most` of them.
  Block block_at(std::uint64_t at, std::string_view what,
                 std::uint64_t most = ~std::uint64_t{0}) const {
    ByteCursor in(*file_, false, at);
    Block block{at, {}, {}, 0, 0};
    const std::string_view id = in.bytes(4, what);
    if (!id.starts_with("##")) fail(at, fmt::format("expected {}, found '{}'", what, to_utf8(id)));
    block.id = to_utf8(id.substr(2));
    in.skip(4);
    const auto length = in.read<std::uint64_t>(what);
    const auto links = in.read<std::uint64_t>(what);
    block.end = length > size_ - at ? size_ : at + length;
    if (length < block_head || links > (length - block_head) / 8)
      fail(at, fmt::format("a block {} of {} bytes with {} links", block.id, length, links));
    if (links > in.left() / 8) fail(size_, fmt::format("the file ends within {}", what));
    block.data = in.at() + 8 * links;
    most = std::min(most, links);
    block.links.reserve(most);
    for (std::uint64_t i = 0; i < most; ++i) block.links.push_back(in.read<std::uint64_t>(what));
    return block;
  }

  /// A block that is part of a chain, which must not come back to it.
  Block new_block_at(std::uint64_t at, std::string_view id, std::string_view what) {
    if (!seen_.insert(at).second)
      fail(at, fmt::format("{} is referred to twice: blocks are chained in a circle", what));
    Block block = block_at(at, what);
    if (!id.empty() && block.id != id)
      fail(at, fmt::format("expected {} ({}), found a block {}", what, id, block.id));
    return block;
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
    record_.attributes["written by"] = trimmed_text(program);
    in.seek(60);
    const auto flags = in.read<std::uint16_t>("the state of an MDF file");
    if (id == "UnFinMF ") {
      unfinished_ = true;
      last_length_unknown_ = (flags & 4) != 0;
      warn("the recording was not finished (aborted?): what is there is read");
    }
  }

  static std::string trimmed_text(std::string_view text) {
    const std::size_t first = text.find_first_not_of(' ');
    if (first == std::string_view::npos) return {};
    return std::string(text.substr(first, text.find_last_not_of(' ') - first + 1));
  }

  std::uint64_t read_header() {
    const Block header = new_block_at(64, "HD", "the header of an MDF file");
    ByteCursor in(*file_, false, header.data);
    const auto start = in.read<std::uint64_t>("the start of a measurement");
    in.skip(4);
    const auto flags = in.read<std::uint8_t>("the start of a measurement");
    if (start != 0) {
      record_.started = iso_utc(static_cast<std::int64_t>(start / 1000000000),
                                static_cast<std::uint32_t>(start % 1000000000 / 1000));
      if ((flags & 1) != 0 && record_.started.ends_with('Z')) record_.started.pop_back();  // local
    }
    const std::string comment = text_at(header.link(5));
    if (!comment.empty()) record_.attributes["comment"] = comment;
    return header.link(0);
  }

  /// The text of a block TX, or what stands between <TX> and </TX> in the XML of a block MD.
  std::string text_at(std::uint64_t at) {
    std::string text = at == 0 ? std::string() : read_text(at);
    text_bytes_ += text.size();
    if (text_bytes_ > most_text_bytes)
      fail(at, fmt::format("there are more than {} bytes of names and comments", most_text_bytes));
    return text;
  }

  std::string read_text(std::uint64_t at) const {
    const Block block = block_at(at, "a text", 0);
    if (block.id != "TX" && block.id != "MD") return {};
    std::string_view text = file_->bytes().substr(block.data, block.end - block.data);
    text = text.substr(0, std::min<std::size_t>(text.find('\0'), 10000));
    if (block.id == "MD") {
      const std::size_t open = text.find("<TX");
      const std::size_t begin = open == std::string_view::npos ? open : text.find('>', open);
      if (begin == std::string_view::npos || text[begin - 1] == '/') return {};
      text.remove_prefix(begin + 1);
      text = text.substr(0, text.find("</TX>"));
      return trimmed_text(without_entities(to_utf8(text)));
    }
    return trimmed_text(to_utf8(text));
  }

  static std::string without_entities(std::string text) {
    constexpr std::array<std::pair<std::string_view, std::string_view>, 5> entities = {
        {{"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&apos;", "'"}, {"&amp;", "&"}}};
    for (const auto& [entity, character] : entities)
      for (std::size_t at = text.find(entity); at != std::string::npos;
           at = text.find(entity, at + 1))
        text.replace(at, entity.size(), character);
    return text;
  }

  /// Reads a data group; returns where the next one is.
  std::uint64_t read_data_group(std::uint64_t at, std::uint64_t number) {
    const Block data_group = new_block_at(at, "DG", "a data group");
    ByteCursor in(*file_, false, data_group.data);
    const auto id_bytes = in.read<std::uint8_t>("the size of record ids");
    std::vector<Block> groups;
    for (std::uint64_t next = data_group.link(1); next != 0;) {
      groups.push_back(new_block_at(next, "CG", "a channel group"));
      next = groups.back().link(0);
    }
    std::size_t filled = 0;
    for (const Block& group : groups)
      if (cycles_of(group) > 0) ++filled;
    if (filled > 1 || (unfinished_ && groups.size() > 1)) {
      if (unsorted_.empty()) unsorted_at_ = at;
      unsorted_ =
          "channel groups that share a block of data (an unsorted file) are not read: sort the "
          "file "
          "with the program that wrote it";
      return data_group.link(0);
    }
    std::vector<Fragment> fragments;
    if (!groups.empty()) collect(data_group.link(2), fragments);
    for (const Block& group : groups) {
      const bool owner = filled == 0 ? &group == &groups.front() : cycles_of(group) > 0;
      read_channel_group(group, id_bytes, owner ? std::move(fragments) : std::vector<Fragment>{},
                         number);
    }
    return data_group.link(0);
  }

  std::uint64_t cycles_of(const Block& group) const {
    ByteCursor in(*file_, false, group.data + 8);
    return in.read<std::uint64_t>("the number of records of a channel group");
  }

  /// Appends the parts of a group's data that a block stands for.
  void collect(std::uint64_t at, std::vector<Fragment>& fragments) {
    while (at != 0) {
      if (beyond_the_end(at)) return;
      const Block block = new_block_at(at, "", "a block of data");
      if (block.id == "HL") {  // a head of the list, which follows
        at = block.link(0);
      } else if (block.id == "DL") {
        for (std::size_t i = 1; i < block.links.size(); ++i) {
          if (block.links[i] == 0) continue;
          if (beyond_the_end(block.links[i])) return;
          const Block part = new_block_at(block.links[i], "", "a block of data");
          if (!append(part, fragments)) return;
        }
        at = block.link(0);
      } else {
        append(block, fragments);
        return;
      }
    }
  }

  bool beyond_the_end(std::uint64_t at) {
    if (size_ >= block_head && at <= size_ - block_head) return false;
    warn("the file ends before its data do");
    return true;
  }

  bool append(const Block& block, std::vector<Fragment>& fragments) {
    Fragment fragment;
    if (!fragments.empty()) fragment.begin = fragments.back().begin + fragments.back().length;
    if (block.id == "DT") {
      const bool to_the_end = last_length_unknown_ && block.end == block.data;
      fragment.at = block.data;
      fragment.stored = fragment.length = (to_the_end ? size_ : block.end) - block.data;
    } else if (block.id == "DZ") {
      if (!describe_compressed(block, fragment)) return false;
    } else if (block.id == "DV" || block.id == "LD") {
      fail(block.at,
           "the data are stored by columns (MDF 4.2), which is not read: save the file as "
           "MDF 4.1 with the program that wrote it");
    } else {
      fail(block.at,
           fmt::format("expected a block of data (DT, DZ, DL, HL), found a block {}", block.id));
    }
    if (fragment.length > 0) fragments.push_back(fragment);
    return true;
  }

  /// False when the file ends within the block.
  bool describe_compressed(const Block& block, Fragment& fragment) {
    ByteCursor in(*file_, false, block.data);
    const std::string original = to_utf8(in.bytes(2, "a compressed block"));
    const auto method = in.read<std::uint8_t>("a compressed block");
    in.skip(1);
    const auto columns = in.read<std::uint32_t>("a compressed block");
    const auto length = in.read<std::uint64_t>("a compressed block");
    const auto stored = in.read<std::uint64_t>("a compressed block");
    if (original != "DT")
      fail(block.at,
           fmt::format("expected compressed records (DT), found a compressed block {}", original));
    if (method > 1)
      fail(block.at,
           fmt::format("the data are compressed by method {}, which is not read: save the "
                       "file with deflate or uncompressed",
                       method));
    if (stored > in.left()) {
      warn("the file ends within a compressed block of data: it is left out");
      return false;
    }
    if (length > most_expanded || length > deflate_at_most * stored)
      fail(block.at, fmt::format("a compressed block of {} bytes announces {} bytes: it is refused",
                                 stored, length));
    fragment.at = in.at();
    fragment.stored = stored;
    fragment.length = length;
    fragment.deflated = true;
    if (method == 1 && columns > 1 && columns <= length) fragment.columns = columns;
    return true;
  }

  void read_channel_group(const Block& block, std::uint64_t id_bytes,
                          std::vector<Fragment> fragments, std::uint64_t number) {
    ByteCursor in(*file_, false, block.data + 16);
    const std::uint64_t cycles = cycles_of(block);
    const auto flags = in.read<std::uint16_t>("a channel group");
    in.skip(6);
    const auto data_bytes = in.read<std::uint32_t>("a channel group");
    const auto invalid_bytes = in.read<std::uint32_t>("a channel group");
    if ((flags & 1) != 0) return;  // values of variable length of a channel elsewhere
    Group group;
    group.record_bytes = id_bytes + data_bytes + invalid_bytes;
    if (group.record_bytes > most_record_bytes)
      fail(block.at, fmt::format("a channel group has records of {} bytes", group.record_bytes));
    const std::uint64_t total =
        fragments.empty() ? 0 : fragments.back().begin + fragments.back().length;
    const std::uint64_t there = group.record_bytes == 0 ? 0 : total / group.record_bytes;
    group.records = unfinished_ && cycles == 0 ? there : std::min(cycles, there);
    if (cycles > there && !(group.record_bytes == 0))
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
    Field field;
    Conversion conversion;
    std::optional<std::uint64_t> invalid_bit;
    std::string comment;
    bool usable = true;
  };

  void read_channels(const Block& block, std::uint64_t id_bytes, std::uint64_t data_bytes,
                     std::uint64_t number) {
    std::vector<Described> found;
    for (std::uint64_t next = block.link(1); next != 0;) {
      const Block channel = new_block_at(next, "CN", "a channel");
      next = channel.link(0);
      if (++blocks_ > most_channels)
        fail(channel.at, fmt::format("there are more than {} channels", most_channels));
      found.push_back(described(channel, id_bytes, data_bytes));
    }
    const auto master = std::ranges::find_if(
        found, [](const Described& c) { return (c.type == 2 || c.type == 3) && c.usable; });
    datasets::SampleClock clock;
    std::string domain;
    if (master != found.end()) domain = set_clock(*master, clock);
    const std::string acquisition = text_at(block.link(2));
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
    Conversion& conversion = described.conversion;
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

  Described described(const Block& block, std::uint64_t id_bytes, std::uint64_t data_bytes) {
    ByteCursor in(*file_, false, block.data);
    Described channel;
    channel.at = block.at;
    channel.name = text_at(block.link(2));
    if (channel.name.empty()) channel.name = fmt::format("channel {}", blocks_ - 1);
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
    channel.unit = text_at(block.link(6));
    channel.comment = text_at(block.link(7));
    channel.conversion = conversion_at(block.link(4));
    if (channel.unit.empty()) channel.unit = channel.conversion.unit;
    channel.field = field_of(channel, data_type, bit_offset, bit_count);
    channel.field.offset = id_bytes + byte_offset;
    if (channel.field.shape == Field::Shape::complex && block.link(4) != 0) {
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

  Field field_of(const Described& channel, std::uint8_t data_type, std::uint32_t bit_offset,
                 std::uint32_t bit_count) const {
    Field field;
    if (data_type >= 15) {
      field.big_endian = data_type == 16;
      field.shape = Field::Shape::complex;
      field.kind = bit_count == 64 ? NumberKind::f32 : NumberKind::f64;
      if (bit_offset == 0 && (bit_count == 64 || bit_count == 128)) return field;
    } else if (data_type >= 4) {
      field.big_endian = data_type == 5;
      field.kind = bit_count == 32 ? NumberKind::f32 : NumberKind::f64;
      if (bit_count == 16) field.shape = Field::Shape::half_float;
      if (bit_offset == 0 && (bit_count == 16 || bit_count == 32 || bit_count == 64)) return field;
    } else if (bit_offset < 8 && bit_count > 0 && bit_count <= 64) {
      field.big_endian = data_type % 2 == 1;
      field.with_sign = data_type >= 2;
      field.bit = bit_offset;
      field.bit_count = bit_count;
      field.shape = Field::Shape::bits;
      constexpr std::array<std::pair<std::uint32_t, std::array<NumberKind, 2>>, 4> whole = {
          {{8, {NumberKind::u8, NumberKind::i8}},
           {16, {NumberKind::u16, NumberKind::i16}},
           {32, {NumberKind::u32, NumberKind::i32}},
           {64, {NumberKind::u64, NumberKind::i64}}}};
      for (const auto& [bits, kinds] : whole) {
        if (bit_offset != 0 || bit_count != bits) continue;
        field.shape = Field::Shape::number;
        field.kind = kinds[field.with_sign ? 1 : 0];
      }
      return field;
    }
    fail(channel.at, fmt::format("'{}' has numbers of type {} with {} bits from bit {} on",
                                 channel.name, data_type, bit_count, bit_offset));
  }

  /// The conversion at a place. Channels that share it share its parameters.
  Conversion conversion_at(std::uint64_t at) {
    if (at == 0) return {};
    const auto known = conversions_.find(at);
    if (known != conversions_.end()) return known->second;
    return conversions_.emplace(at, read_conversion(at)).first->second;
  }

  Conversion read_conversion(std::uint64_t at) {
    Conversion conversion;
    const Block block = block_at(at, "a conversion", 4);
    if (block.id != "CC")
      fail(at, fmt::format("expected a conversion (CC), found a block {}", block.id));
    conversion.unit = text_at(block.link(1));
    ByteCursor in(*file_, false, block.data);
    const auto type = in.read<std::uint8_t>("a conversion");
    in.skip(5);
    const auto count = in.read<std::uint16_t>("a conversion");
    in.skip(16);
    std::vector<double> values;
    for (std::uint16_t i = 0; i < count; ++i) values.push_back(in.read<double>("a conversion"));
    set_conversion(type, std::move(values), at, conversion);
    if (!std::isfinite(conversion.scale) || !std::isfinite(conversion.offset)) {
      conversion.scale = 1.0;
      conversion.offset = 0.0;
      conversion.problem = "its conversion is not finite";
    }
    return conversion;
  }

  void set_conversion(std::uint8_t type, std::vector<double> p, std::uint64_t at,
                      Conversion& conversion) const {
    const auto needs = [&](bool enough) {
      if (!enough)
        fail(at, fmt::format("a conversion of type {} states {} parameters", type, p.size()));
    };
    switch (type) {
      case 0:
        return;
      case 1:  // p0 + p1 x
        needs(p.size() >= 2);
        conversion.offset = p[0];
        conversion.scale = p[1];
        return;
      case 2:
        needs(p.size() >= 6);
        if (p[0] == 0.0 && p[3] == 0.0 && p[4] == 0.0) {  // a straight line
          conversion.scale = p[1] / p[5];
          conversion.offset = p[2] / p[5];
          return;
        }
        p.resize(6);
        conversion.function = [p = shared(std::move(p))](std::span<double> x) {
          const double* const c = p->data();
          for (double& v : x) v = ((c[0] * v + c[1]) * v + c[2]) / ((c[3] * v + c[4]) * v + c[5]);
        };
        return;
      case 3:
        conversion.problem = "its conversion is a formula in text";
        return;
      case 4:
      case 5:
        needs(p.size() >= 2 && p.size() % 2 == 0);
        return set_table(std::move(p), type == 4, conversion);
      case 6:
        needs(p.size() % 3 == 1);
        conversion.function = [p = shared(std::move(p))](std::span<double> x) {
          for (double& v : x) v = value_of_range(*p, v);
        };
        return;
      case 7:
      case 8:
        conversion.problem = "its conversion gives texts";
        return;
      default:
        conversion.problem = fmt::format("its conversion is of the type {}", type);
    }
  }

  /// Pairs of key and value; between keys a straight line, or the value of the nearest key.
  static void set_table(std::vector<double> p, bool interpolated, Conversion& conversion) {
    std::vector<double> x;
    std::vector<double> y;
    for (std::size_t i = 0; i < p.size(); i += 2) {
      if (!std::isfinite(p[i]) || (!x.empty() && !(p[i] > x.back()))) {
        conversion.problem = "its conversion is a table whose keys do not increase";
        return;
      }
      x.push_back(p[i]);
      y.push_back(p[i + 1]);
    }
    conversion.function = [k = shared(std::move(x)), w = shared(std::move(y)),
                           interpolated](std::span<double> all) {
      const std::vector<double>& keys = *k;
      const std::vector<double>& values = *w;
      for (double& v : all) {
        if (std::isnan(v)) continue;
        const auto above = std::ranges::upper_bound(keys, v);
        const auto i = static_cast<std::size_t>(above - keys.begin());
        if (i == 0)
          v = values.front();
        else if (i == keys.size())
          v = values.back();
        else if (interpolated)
          v = values[i - 1] +
              (values[i] - values[i - 1]) * (v - keys[i - 1]) / (keys[i] - keys[i - 1]);
        else
          v = v - keys[i - 1] > keys[i] - v ? values[i] : values[i - 1];
      }
    };
  }

  static std::shared_ptr<const std::vector<double>> shared(std::vector<double> numbers) {
    return std::make_shared<const std::vector<double>>(std::move(numbers));
  }

  /// Triples of lowest key, highest key and value, then the value of all else.
  static double value_of_range(const std::vector<double>& p, double key) {
    for (std::size_t i = 0; i + 2 < p.size(); i += 3)
      if (key >= p[i] && key <= p[i + 1]) return p[i + 2];
    return p.back();
  }

  /// The clock of the group at hand from its master; returns what it is over where that is not
  /// time.
  std::string set_clock(const Described& master, datasets::SampleClock& clock) {
    constexpr std::array<const char*, 5> domains = {"other", "", "angle", "distance", "index"};
    const std::string domain = master.sync < domains.size() ? domains[master.sync] : "other";
    if (!domain.empty()) return domain;
    Group& group = groups_.back();
    const Conversion& conversion = master.conversion;
    if (!conversion.problem.empty()) {
      warn(fmt::format("the times in '{}' are not used: {}", master.name, conversion.problem));
      return {};
    }
    if (master.type == 3) {  // no bytes: the number of the record, converted
      clock.start = conversion.offset;
      clock.interval = conversion.function ? 0.0 : std::max(0.0, conversion.scale);
      return {};
    }
    if (group.records == 0) return {};
    const auto unit = datasets::conversion(master.unit, "s");  // the standard has seconds
    const double factor = unit ? unit->factor : 1.0;
    const Scaling seconds = [scale = conversion.scale, offset = conversion.offset, factor,
                             function = conversion.function](std::span<double> x) {
      if (function) function(x);
      for (double& v : x) v = factor * (function ? v : scale * v + offset);
    };
    RecordBytes bytes(*file_, group.fragments);
    std::vector<double> block;
    const auto read = [&](std::uint64_t first, std::uint64_t count) {
      const std::uint64_t size = group.record_bytes;
      read_field(master.field, bytes.view(first * size, count * size), count, size, block);
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
  std::uint64_t size_;
  Record record_;
  std::vector<Group> groups_;
  std::vector<MdfChannel> channels_;
  std::unordered_set<std::uint64_t> seen_;
  std::map<std::string, Quantity> quantities_;
  std::size_t blocks_ = 0;
  std::uint64_t text_bytes_ = 0;
  std::uint64_t time_bytes_ = 0;  // read at opening
  std::map<std::uint64_t, Conversion> conversions_;
  std::vector<std::string> left_out_;
  std::size_t left_out_count_ = 0;
  std::string unsorted_;
  std::uint64_t unsorted_at_ = 0;
  bool unfinished_ = false;
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
