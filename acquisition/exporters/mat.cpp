// SPDX-License-Identifier: BSD-3-Clause
// MAT-files of version 5, not compressed (what MATLAB writes with -v6), in the machine's byte
// order. Layout: MathWorks, "MAT-File Format", 2019; docs/formats.md says which variables there
// are.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <functional>
#include <set>

#include "acquisition/exporters/formats.hpp"
#include "acquisition/exporters/output_file.hpp"
#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/text_file.hpp"
#include "datasets/input_error.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::FileError;
using datasets::Record;

namespace {

constexpr std::uint64_t most_bytes = (std::uint64_t{1} << 31) - 8;  ///< of a variable, for MATLAB
constexpr std::size_t longest_name = 63;                            ///< of a variable, likewise
constexpr std::size_t field_name_width = 32;

// data types of an element
constexpr std::uint32_t mi_int8 = 1;
constexpr std::uint32_t mi_uint8 = 2;
constexpr std::uint32_t mi_uint16 = 4;
constexpr std::uint32_t mi_int32 = 5;
constexpr std::uint32_t mi_uint32 = 6;
constexpr std::uint32_t mi_single = 7;
constexpr std::uint32_t mi_double = 9;
constexpr std::uint32_t mi_matrix = 14;

// classes of an array, and flags
constexpr std::uint32_t mx_struct = 2;
constexpr std::uint32_t mx_char = 4;
constexpr std::uint32_t mx_double = 6;
constexpr std::uint32_t mx_single = 7;
constexpr std::uint32_t mx_uint8 = 9;
constexpr std::uint32_t logical = 0x0200;
constexpr std::uint32_t complex = 0x0800;

template <typename Number>
std::string_view bytes_of(std::span<const Number> numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()};
}

template <typename Number>
std::string bytes_of(Number number) {
  return std::string(bytes_of(std::span<const Number>(&number, 1)));
}

std::uint64_t padded(std::uint64_t size) {
  return (size + 7) / 8 * 8;
}

std::string tag(std::uint32_t type, std::uint64_t size) {
  return bytes_of(type) + bytes_of(static_cast<std::uint32_t>(size));
}

/// A data element; what fits stands within the tag.
std::string element(std::uint32_t type, std::string_view data) {
  std::string bytes = !data.empty() && data.size() <= 4
                          ? bytes_of(static_cast<std::uint32_t>(data.size()) << 16 | type)
                          : tag(type, data.size());
  bytes += data;
  bytes.resize(padded(bytes.size()), '\0');
  return bytes;
}

/// Bytes of a file, some of which are made only when they are written.
class Bytes {
 public:
  using Make = std::function<void(OutputFile&)>;

  Bytes(std::string bytes) { *this += std::move(bytes); }  // NOLINT(google-explicit-constructor)

  Bytes(std::uint64_t size, Make make) : size_(size) { pieces_.push_back({{}, std::move(make)}); }

  Bytes& operator+=(Bytes&& more) {
    size_ += more.size_;
    std::ranges::move(more.pieces_, std::back_inserter(pieces_));
    return *this;
  }

  Bytes& operator+=(std::string bytes) {
    size_ += bytes.size();
    pieces_.push_back({std::move(bytes), {}});
    return *this;
  }

  std::uint64_t size() const { return size_; }

  void write(OutputFile& out) const {
    for (const Piece& piece : pieces_) {
      out.write(piece.bytes);
      if (piece.make) piece.make(out);
    }
  }

 private:
  struct Piece {
    std::string bytes;
    Make make;
  };

  std::uint64_t size_ = 0;
  std::vector<Piece> pieces_;
};

/// An array: what it is, and the elements of its class.
Bytes matrix(std::uint32_t class_and_flags, std::size_t rows, std::size_t columns,
             const std::string& name, Bytes content) {
  const std::array<std::uint32_t, 2> flags = {class_and_flags, 0};
  const std::array<std::int32_t, 2> shape = {static_cast<std::int32_t>(rows),
                                             static_cast<std::int32_t>(columns)};
  const std::string head = element(mi_uint32, bytes_of(std::span<const std::uint32_t>(flags))) +
                           element(mi_int32, bytes_of(std::span<const std::int32_t>(shape))) +
                           element(mi_int8, name);
  Bytes bytes(tag(mi_matrix, head.size() + content.size()) + head);
  bytes += std::move(content);
  return bytes;
}

Bytes empty() {
  return matrix(mx_double, 0, 0, {}, element(mi_double, {}));
}

Bytes scalar(double value) {
  return matrix(mx_double, 1, 1, {}, element(mi_double, bytes_of(value)));
}

std::string utf16_of(std::string_view text) {
  const std::string valid = to_utf8_with_controls(text);
  std::string units;
  for (std::size_t i = 0; i < valid.size();) {
    const auto byte = [&](std::size_t k) {
      return static_cast<std::uint32_t>(static_cast<unsigned char>(valid[i + k]));
    };
    const std::size_t length = byte(0) < 0x80 ? 1 : byte(0) < 0xE0 ? 2 : byte(0) < 0xF0 ? 3 : 4;
    std::uint32_t code = length == 1 ? byte(0) : byte(0) & (0x7FU >> length);
    for (std::size_t k = 1; k < length; ++k) code = code << 6 | (byte(k) & 0x3F);
    i += length;
    if (code >= 0x10000) {
      units += bytes_of(static_cast<std::uint16_t>(0xD7C0 + (code >> 10)));
      code = 0xDC00 | (code & 0x3FF);
    }
    units += bytes_of(static_cast<std::uint16_t>(code));
  }
  return units;
}

Bytes text(std::string_view value) {
  const std::string units = utf16_of(value);
  return matrix(mx_char, units.empty() ? 0 : 1, units.size() / 2, {}, element(mi_uint16, units));
}

struct Field {
  std::string_view name;
  Bytes value;
};

/// One structure, or an array of them whose fields follow each other.
Bytes structures(const std::string& name, const std::vector<std::string_view>& fields,
                 std::vector<Bytes> values) {
  std::string names;
  for (const std::string_view field : fields) {
    names += field;
    names.append(field_name_width - field.size(), '\0');
  }
  Bytes content(element(mi_int32, bytes_of(static_cast<std::int32_t>(field_name_width))) +
                element(mi_int8, names));
  for (Bytes& value : values) content += std::move(value);
  return matrix(mx_struct, 1, values.size() / fields.size(), name, std::move(content));
}

Bytes structure(const std::string& name, std::vector<Field> fields) {
  std::vector<std::string_view> names;
  std::vector<Bytes> values;
  for (Field& field : fields) {
    names.push_back(field.name);
    values.push_back(std::move(field.value));
  }
  return structures(name, names, std::move(values));
}

/// Numbers, one column: those that `take(part, numbers)` appends for each part of a channel.
template <typename Number, typename Take>
Bytes column(std::uint32_t type, const OutgoingChannel& channel, Take take) {
  const std::uint64_t size = channel.size * sizeof(Number);
  if (size <= 4) {  // within the tag
    std::vector<Number> few;
    channel.each([&](const Channel& part, std::uint64_t) { take(part, few); });
    return element(type, bytes_of(std::span<const Number>(few)));
  }
  Bytes bytes(tag(type, size));
  bytes += Bytes(padded(size), [&channel, size, take](OutputFile& out) {
    std::vector<Number> numbers;
    channel.each([&](const Channel& part, std::uint64_t) {
      numbers.clear();
      take(part, numbers);
      out.write(bytes_of(std::span<const Number>(numbers)));
    });
    out.write(std::string(padded(size) - size, '\0'));
  });
  return bytes;
}

/// The values in the channel's unit: nothing is left to multiply.
Bytes values(const OutgoingChannel& channel) {
  const std::uint64_t n = channel.size;
  const bool as_they_are =
      channel.head->scale == 1.0 && channel.head->offset == 0.0 && !channel.complex;
  if (channel.single && as_they_are)
    return matrix(mx_single, n, 1, {},
                  column<float>(mi_single, channel, [](const Channel& part, auto& to) {
                    to = std::get<std::vector<float>>(part.raw);
                  }));
  Bytes real =
      column<double>(mi_double, channel, [](const Channel& part, auto& to) { to = part.values(); });
  if (!channel.complex) return matrix(mx_double, n, 1, {}, std::move(real));
  real += column<double>(mi_double, channel,
                         [](const Channel& part, auto& to) { to = part.imaginary; });
  return matrix(mx_double | complex, n, 1, {}, std::move(real));
}

Bytes times(const OutgoingChannel& channel) {
  if (channel.uniform) return empty();
  return matrix(mx_double, channel.size, 1, {},
                column<double>(mi_double, channel,
                               [](const Channel& part, auto& to) { to = part.clock.times; }));
}

bool all_sound(const OutgoingChannel& channel) {
  bool sound = true;
  if (channel.marked)
    channel.each([&sound](const Channel& part, std::uint64_t) {
      sound = sound && std::ranges::find(part.valid, std::uint8_t{0}) == part.valid.end();
    });
  return sound;
}

/// true where a sample is not valid: `value(invalid) = NaN` is right with and without marks.
Bytes marks(const OutgoingChannel& channel) {
  if (all_sound(channel)) return empty();
  return matrix(mx_uint8 | logical, channel.size, 1, {},
                column<std::uint8_t>(mi_uint8, channel, [](const Channel& part, auto& to) {
                  for (std::size_t i = 0; i < part.size(); ++i)
                    to.push_back(part.is_valid(i) ? 0 : 1);
                }));
}

Bytes attributes(const std::map<std::string, std::string>& all) {
  std::vector<Bytes> entries;
  for (const auto& [name, value] : all) {
    entries.push_back(text(name));
    entries.push_back(text(value));
  }
  return structures({}, {"name", "value"}, std::move(entries));
}

Bytes calibration(const std::optional<datasets::Calibration>& known) {
  if (!known) return empty();
  std::vector<Field> fields;
  fields.push_back({"sensitivity", scalar(known->sensitivity)});
  fields.push_back({"uncertainty", scalar(known->uncertainty)});
  fields.push_back({"recorded_unit", text(known->recorded_unit)});
  fields.push_back({"physical_unit", text(known->physical_unit)});
  fields.push_back({"source", text(known->source)});
  return structure({}, std::move(fields));
}

Bytes delay(const std::optional<datasets::Delay>& known) {
  if (!known) return empty();
  std::vector<Field> fields;
  fields.push_back({"value", scalar(known->value)});
  fields.push_back({"uncertainty", scalar(known->uncertainty)});
  fields.push_back({"removed", scalar(known->removed ? 1.0 : 0.0)});
  return structure({}, std::move(fields));
}

/// All channels have the same fields, so that MATLAB joins them: [Force, Velocity].
Bytes variable(const std::string& name, const OutgoingChannel& outgoing) {
  const Channel& channel = *outgoing.head;
  std::vector<Field> fields;
  fields.push_back({"name", text(channel.name)});
  fields.push_back({"quantity", text(datasets::name(channel.quantity))});
  fields.push_back({"unit", text(channel.unit)});
  fields.push_back({"start", scalar(channel.clock.start)});
  fields.push_back({"interval", scalar(channel.clock.interval)});
  fields.push_back({"time", times(outgoing)});
  fields.push_back({"value", values(outgoing)});
  fields.push_back({"invalid", marks(outgoing)});
  fields.push_back({"calibration", calibration(channel.calibration)});
  fields.push_back({"delay", delay(channel.delay)});
  fields.push_back({"attributes", attributes(channel.attributes)});
  return structure(name, std::move(fields));
}

Bytes edits(const std::vector<datasets::Edit>& all) {
  std::vector<Bytes> entries;
  for (const datasets::Edit& edit : all) {
    entries.push_back(text(edit.what));
    entries.push_back(text(edit.channel));
    entries.push_back(attributes(edit.parameters));
  }
  return structures({}, {"what", "channel", "parameters"}, std::move(entries));
}

Bytes head(const Record& record) {
  std::vector<Bytes> warnings;
  for (const std::string& warning : record.warnings) warnings.push_back(text(warning));
  std::vector<Field> fields;
  fields.push_back({"format", text("impactrig-recording")});
  fields.push_back({"format_version", text("1.0")});
  fields.push_back({"title", text(record.title)});
  fields.push_back({"start_time", text(record.started)});
  fields.push_back({"source_file", text(record.provenance.source_file)});
  fields.push_back({"source_sha256", text(record.provenance.sha256)});
  fields.push_back({"source_format", text(record.provenance.importer)});
  fields.push_back({"source_program", text(record.provenance.program)});
  fields.push_back({"edits", edits(record.provenance.edits)});
  fields.push_back({"warnings", structures({}, {"text"}, std::move(warnings))});
  fields.push_back({"attributes", attributes(record.attributes)});
  return structure("recording", std::move(fields));
}

/// Names of variables as MATLAB takes them: letters, digits and _, a letter first.
class VariableNames {
 public:
  std::string next(std::string_view channel) {
    std::string plain;
    for (const char c : channel) {
      const bool allowed = std::isalnum(static_cast<unsigned char>(c)) != 0 && (c & 0x80) == 0;
      if (allowed)
        plain += c;
      else if (!plain.empty() && plain.back() != '_')
        plain += '_';
    }
    while (!plain.empty() && plain.back() == '_') plain.pop_back();
    if (plain.empty()) plain = "channel";
    if (std::isdigit(static_cast<unsigned char>(plain.front())) != 0 || is_keyword(plain))
      plain.insert(0, "x");
    std::string name = plain.substr(0, longest_name);
    for (int i = 2; !used_.insert(name).second; ++i) {
      const std::string number = fmt::format("_{}", i);
      name = plain.substr(0, longest_name - number.size()) + number;
    }
    return name;
  }

 private:
  static bool is_keyword(std::string_view word) {
    constexpr std::array<std::string_view, 20> keywords = {
        "break",      "case",   "catch",    "classdef", "continue", "else",      "elseif",
        "end",        "for",    "function", "global",   "if",       "otherwise", "parfor",
        "persistent", "return", "spmd",     "switch",   "try",      "while"};
    return std::ranges::find(keywords, word) != keywords.end();
  }

  std::set<std::string> used_ = {"recording"};
};

}  // namespace

std::vector<std::string> write_mat(const OutgoingRecording& recording, const std::string& path) {
  std::vector<Bytes> variables;
  variables.push_back(head(recording.record));
  VariableNames names;
  for (const OutgoingChannel& channel : recording.channels) {
    const std::string& name = channel.head->name;
    Bytes bytes = variable(names.next(name), channel);
    if (bytes.size() > most_bytes)
      throw FileError(
          path,
          fmt::format("'{}' takes {:.1f} GB, a variable of a MAT-file of this version at most "
                      "2.1 GB: choose a part with --from and --to, or write a .h5 file, which "
                      "MATLAB reads with h5read",
                      name, static_cast<double>(bytes.size()) * 1e-9));
    variables.push_back(std::move(bytes));
  }
  std::string start = "MATLAB 5.0 MAT-file, created by " + datasets::program_version();
  start.resize(116, ' ');
  start += std::string(8, '\0') + bytes_of(std::uint16_t{0x0100}) + bytes_of(std::uint16_t{0x4D49});
  OutputFile out(path);
  out.write(start);
  for (const Bytes& bytes : variables) bytes.write(out);
  out.finish();
  return {};
}

}  // namespace impactrig::acquisition
