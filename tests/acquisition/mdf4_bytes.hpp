// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tests/acquisition/bytes.hpp"

namespace impactrig::acquisition::tests {

/// A zlib stream (RFC 1950) of stored blocks: what deflate gives for noise.
inline std::string stored_stream(const std::string& bytes) {
  std::string stream = "\x78\x01";
  for (std::size_t at = 0; at == 0 || at < bytes.size(); at += 65535) {
    const std::string part = bytes.substr(at, 65535);
    const auto length = static_cast<std::uint16_t>(part.size());
    stream += at + part.size() == bytes.size() ? '\1' : '\0';
    stream += bytes_of_number(length) + bytes_of_number(static_cast<std::uint16_t>(~length)) + part;
  }
  std::uint32_t a = 1;
  std::uint32_t b = 0;
  for (const char c : bytes) {
    a = (a + static_cast<unsigned char>(c)) % 65521;
    b = (b + a) % 65521;
  }
  return stream + bytes_of_number(b << 16 | a, true);
}

/// All first bytes of rows of `columns` bytes, then all second ones; a part of a row stays behind.
inline std::string transposed(const std::string& bytes, std::size_t columns) {
  const std::size_t rows = bytes.size() / columns;
  std::string result;
  for (std::size_t column = 0; column < columns; ++column)
    for (std::size_t row = 0; row < rows; ++row) result += bytes[row * columns + column];
  return result + bytes.substr(rows * columns);
}

/// A channel (CN); the defaults are a double of seconds at the start of a record.
struct MdfChannelBlock {
  std::string name = "t";
  std::string unit{};
  std::uint8_t type = 0;  ///< 0 values, 1 variable length, 2 master, 3 virtual master
  std::uint8_t sync = 0;
  std::uint8_t data_type =
      4;  ///< 0/1 unsigned, 2/3 signed, 4/5 float, 15/16 complex (even: little)
  std::uint8_t bit = 0;
  std::uint32_t byte = 0;
  std::uint32_t bits = 64;
  std::uint32_t flags = 0;
  std::uint32_t invalid_bit = 0;
  std::uint64_t conversion = 0;
  std::uint64_t composition = 0;
};

inline MdfChannelBlock mdf_time() {
  MdfChannelBlock time;
  time.type = 2;
  time.sync = 1;
  return time;
}

/// The number of its group, in front of a record.
inline std::string mdf_record_id(std::uint64_t id, std::uint8_t id_bytes) {
  return bytes_of_number(id).substr(0, id_bytes);
}

/// An MDF 4 file, block after block; blocks give their address.
class MdfFile {
 public:
  explicit MdfFile(std::string_view version = "4.10    ", std::string_view id = "MDF     ",
                   std::uint16_t unfinished = 0) {
    bytes_ = std::string(id) + std::string(version) + "tests   " + std::string(4, '\0') +
             bytes_of_number(std::uint16_t{410}) + std::string(30, '\0') +
             bytes_of_number(unfinished) + std::string(2, '\0');
    block("HD", std::vector<std::uint64_t>(6), std::string(32, '\0'));
  }

  std::uint64_t block(std::string_view id, const std::vector<std::uint64_t>& links,
                      const std::string& data) {
    bytes_.resize((bytes_.size() + 7) / 8 * 8);
    const std::uint64_t at = bytes_.size();
    bytes_ += "##" + std::string(id) + std::string(4, '\0') +
              bytes_of_number(24 + 8 * links.size() + data.size()) +
              bytes_of_number(std::uint64_t{links.size()}) + bytes_of_numbers(links) + data;
    return at;
  }

  std::uint64_t text(const std::string& text, std::string_view id = "TX") {
    return text.empty() ? 0 : block(id, {}, text + '\0');
  }

  std::uint64_t conversion(std::uint8_t type, const std::vector<double>& values,
                           std::uint64_t unit = 0) {
    return block("CC", {0, unit, 0, 0},
                 std::string(1, static_cast<char>(type)) + std::string(5, '\0') +
                     bytes_of_number(static_cast<std::uint16_t>(values.size())) +
                     std::string(16, '\0') + bytes_of_numbers(values));
  }

  /// A table of texts, some of which may be conversions.
  std::uint64_t text_or_scale(std::uint8_t type, const std::vector<double>& values,
                              const std::vector<std::uint64_t>& references) {
    std::vector<std::uint64_t> links(4);
    links.insert(links.end(), references.begin(), references.end());
    return block("CC", links,
                 std::string(1, static_cast<char>(type)) + std::string(3, '\0') +
                     bytes_of_number(static_cast<std::uint16_t>(references.size())) +
                     bytes_of_number(static_cast<std::uint16_t>(values.size())) +
                     std::string(16, '\0') + bytes_of_numbers(values));
  }

  std::uint64_t formula(const std::string& formula, std::uint64_t unit = 0) {
    const std::uint64_t reference = text(formula);
    return block(
        "CC", {0, unit, 0, 0, reference},
        '\3' + std::string(3, '\0') + bytes_of_number(std::uint16_t{1}) + std::string(18, '\0'));
  }

  /// An array whose elements lie in the record, `bytes` and `bits` (of invalidation) apart.
  std::uint64_t array(const std::vector<std::uint64_t>& sizes, std::int32_t bytes,
                      std::uint32_t bits = 0, std::uint32_t flags = 0,
                      std::uint64_t composition = 0, std::uint8_t storage = 0) {
    return block("CA", {composition},
                 '\0' + std::string(1, static_cast<char>(storage)) +
                     bytes_of_number(static_cast<std::uint16_t>(sizes.size())) +
                     bytes_of_number(flags) + bytes_of_number(bytes) + bytes_of_number(bits) +
                     bytes_of_numbers(sizes));
  }

  std::uint64_t channel(const MdfChannelBlock& c, std::uint64_t next = 0) {
    const std::uint64_t name = text(c.name);
    const std::uint64_t unit = text(c.unit);
    return block(
        "CN", {next, c.composition, name, 0, c.conversion, 0, unit, 0},
        bytes_of_numbers(std::vector<std::uint8_t>{c.type, c.sync, c.data_type, c.bit}) +
            bytes_of_numbers(std::vector<std::uint32_t>{c.byte, c.bits, c.flags, c.invalid_bit}) +
            std::string(52, '\0'));
  }

  std::uint64_t channels(const std::vector<MdfChannelBlock>& list) {
    std::uint64_t next = 0;
    for (std::size_t i = list.size(); i-- > 0;) next = channel(list[i], next);
    return next;
  }

  /// `id`: of its records; `flags`: 1 for texts of variable length.
  std::uint64_t group(std::uint64_t channels, std::uint64_t cycles, std::uint32_t data_bytes,
                      std::uint32_t invalid_bytes = 0, std::uint64_t next = 0, std::uint64_t id = 1,
                      std::uint64_t flags = 0) {
    const std::uint64_t name = text("10ms");
    return block("CG", {next, channels, name, 0, 0, 0},
                 bytes_of_numbers(std::vector<std::uint64_t>{id, cycles, flags}) +
                     bytes_of_numbers(std::vector<std::uint32_t>{data_bytes, invalid_bytes}));
  }

  std::uint64_t data_group(std::uint64_t group, std::uint64_t data, std::uint8_t id_bytes = 0,
                           std::uint64_t next = 0) {
    return block("DG", {next, group, data, 0},
                 std::string(1, static_cast<char>(id_bytes)) + std::string(7, '\0'));
  }

  /// A compressed block of data; `announced` replaces the length it expands to.
  std::uint64_t compressed(const std::string& bytes, std::uint32_t columns = 0,
                           std::uint64_t announced = 0, std::uint8_t method = 0) {
    const std::string stream = stored_stream(columns > 0 ? transposed(bytes, columns) : bytes);
    if (columns > 0) method = 1;
    return block("DZ", {},
                 std::string("DT") + static_cast<char>(method) + '\0' + bytes_of_number(columns) +
                     bytes_of_number(announced == 0 ? std::uint64_t{bytes.size()} : announced) +
                     bytes_of_number(std::uint64_t{stream.size()}) + stream);
  }

  std::uint64_t list(const std::vector<std::uint64_t>& parts, std::uint64_t next = 0) {
    std::vector<std::uint64_t> links = {next};
    links.insert(links.end(), parts.begin(), parts.end());
    return block("DL", links,
                 bytes_of_number(std::uint32_t{0}) +
                     bytes_of_number(static_cast<std::uint32_t>(parts.size())) +
                     std::string(8 * parts.size(), '\0'));
  }

  /// The file, beginning with a data group.
  std::string with(std::uint64_t data_group, std::uint64_t start_ns = 0, std::uint8_t flags = 0,
                   std::uint64_t comment = 0) {
    put(64 + 24, bytes_of_number(data_group));
    put(64 + 24 + 40, bytes_of_number(comment));
    put(64 + 72, bytes_of_number(start_ns));
    put(64 + 72 + 12, std::string(1, static_cast<char>(flags)));
    return bytes_;
  }

  void put(std::uint64_t at, const std::string& bytes) {
    std::ranges::copy(bytes, bytes_.begin() + static_cast<std::ptrdiff_t>(at));
  }

 private:
  std::string bytes_;
};

/// Small files of every way to store records.
inline std::vector<std::string> mdf4_seeds() {
  std::vector<std::string> seeds;
  std::string records;
  for (int i = 0; i < 4; ++i)
    records +=
        bytes_of_number(0.25 * i) + bytes_of_number(static_cast<std::int16_t>(10 * i)) + "\1";
  MdfChannelBlock force;
  force.name = "F";
  force.unit = "N";
  force.data_type = 2;
  force.byte = 8;
  force.bits = 16;
  for (int form = 0; form < 6; ++form) {
    MdfFile file;
    force.conversion = form < 3 ? file.conversion(1, {1, 2})
                                : file.conversion(static_cast<std::uint8_t>(form + 1),
                                                  std::vector<double>{0, 1, 2, 3, 4, 5, 6});
    force.flags = form == 1 ? 2 : 0;
    force.bit = form == 2 ? 3 : 0;
    force.bits = form == 2 ? 11 : 16;
    std::uint64_t data = 0;
    if (form == 0) data = file.block("DT", {}, records);
    if (form == 1) data = file.compressed(records, 11);
    if (form > 1) {
      const std::uint64_t first = file.compressed(records.substr(0, 15));
      const std::uint64_t second = file.block("DT", {}, records.substr(15));
      data = file.block("HL", {file.list({first, second})}, std::string(8, '\0'));
    }
    const std::uint64_t group = file.group(file.channels({mdf_time(), force}), 4, 10, 1);
    seeds.push_back(file.with(file.data_group(group, data), 1500000000000000000));
  }
  {  // an array of structures of a formula and an array of two dimensions
    MdfFile file;
    MdfChannelBlock member = force;
    member.flags = 0;
    member.conversion = file.formula("2 * X1 ** 2 - sqrt(abs(X)) / 3");
    member.byte = 0;
    MdfChannelBlock matrix = member;
    matrix.name = "m";
    matrix.bits = 8;
    matrix.composition = file.array({2, 2}, 1);
    MdfChannelBlock structure = member;
    structure.name = "s";
    structure.data_type = 10;
    structure.bits = 32;
    structure.composition = file.array({2}, 4, 0, 0, file.channels({member, matrix}));
    const std::uint64_t group = file.group(file.channels({structure}), 4, 8);
    seeds.push_back(file.with(file.data_group(group, file.block("DT", {}, records.substr(0, 32)))));
  }
  force.conversion = force.flags = 0;
  for (const std::uint8_t id_bytes :
       std::vector<std::uint8_t>{1, 2, 4, 8}) {  // records of two groups and texts, by turns
    const bool finished = id_bytes != 2;
    MdfFile file("4.10    ", finished ? "MDF     " : "UnFinMF ", finished ? 0 : 1);
    std::string mixed;
    for (std::size_t i = 0; i < 4; ++i)
      mixed += mdf_record_id(1, id_bytes) + records.substr(11 * i, 10) +
               mdf_record_id(2, id_bytes) + records.substr(11 * i + 8, 2) +
               mdf_record_id(3, id_bytes) + bytes_of_number(static_cast<std::uint32_t>(i)) +
               std::string(i, 'x');
    force.byte = 0;
    const std::uint64_t texts = file.group(0, 4, 0, 0, 0, 3, 1);
    const std::uint64_t slow = file.group(file.channels({force}), 4, 2, 0, texts, 2);
    force.byte = 8;
    const std::uint64_t fast = file.group(file.channels({mdf_time(), force}), 4, 10, 0, slow);
    const std::uint64_t data =
        file.list({file.block("DT", {}, mixed.substr(0, 25)), file.compressed(mixed.substr(25))});
    seeds.push_back(file.with(file.data_group(fast, data, id_bytes)));
  }
  return seeds;
}

/// A channel of such numbers at this place of the records.
inline MdfChannelBlock mdf_channel(const std::string& name, std::uint8_t data_type,
                                   std::uint32_t bits, std::uint32_t byte, std::uint8_t bit = 0) {
  MdfChannelBlock channel;
  channel.name = name;
  channel.data_type = data_type;
  channel.bits = bits;
  channel.byte = byte;
  channel.bit = bit;
  return channel;
}

/// A file of one group without times.
inline std::string mdf_file_of(const std::vector<MdfChannelBlock>& channels,
                               const std::string& records, std::uint32_t record_bytes) {
  MdfFile file;
  const std::uint64_t data = file.block("DT", {}, records);
  const std::uint64_t group =
      file.group(file.channels(channels), records.size() / record_bytes, record_bytes);
  return file.with(file.data_group(group, data));
}

/// Records of a time in ticks of a millisecond (u32) and a value (i16), 7 bytes with a last one
/// that nobody reads.
struct MdfTicks {
  std::string bytes;
  std::size_t count = 0;

  explicit MdfTicks(const std::vector<std::uint32_t>& ticks) : count(ticks.size()) {
    for (std::size_t i = 0; i < ticks.size(); ++i)
      bytes +=
          bytes_of_number(ticks[i]) + bytes_of_number(static_cast<std::int16_t>(100 * i)) + "x";
  }

  static std::vector<MdfChannelBlock> channels(MdfFile& file) {
    MdfChannelBlock time = mdf_time();
    time.data_type = 0;
    time.bits = 32;
    time.conversion = file.conversion(1, {0.5, 1e-3});
    MdfChannelBlock force = mdf_channel("F", 2, 16, 4);
    force.unit = "kN";
    force.conversion = file.conversion(1, {-1, 0.5});
    return {time, force};
  }
};

}  // namespace impactrig::acquisition::tests
