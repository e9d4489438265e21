// SPDX-License-Identifier: BSD-3-Clause
// Arrays of NumPy: one in a file (.npy), or several in a ZIP archive (.npz).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <optional>

#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/mat_contents.hpp"
#include "acquisition/importers/numpy_head.hpp"
#include "acquisition/importers/spool.hpp"
#include "acquisition/importers/text_encoding.hpp"
#include "acquisition/importers/zip_archive.hpp"

namespace impactrig::acquisition {

namespace {

constexpr std::string_view zip_begin("PK\x03\x04", 4);
constexpr std::size_t unpacked_at_once = std::size_t{1} << 20;  ///< [bytes]
constexpr std::uint64_t most_texts = 100;                       ///< of one array

std::optional<NumberKind> number_kind(const NumpyField& field) {
  struct Known {
    char kind;
    std::uint64_t size;
    NumberKind number;
  };

  constexpr std::array<Known, 13> known = {{{'f', 4, NumberKind::f32},
                                            {'f', 8, NumberKind::f64},
                                            {'c', 8, NumberKind::f32},
                                            {'c', 16, NumberKind::f64},
                                            {'i', 1, NumberKind::i8},
                                            {'u', 1, NumberKind::u8},
                                            {'b', 1, NumberKind::u8},
                                            {'i', 2, NumberKind::i16},
                                            {'u', 2, NumberKind::u16},
                                            {'i', 4, NumberKind::i32},
                                            {'u', 4, NumberKind::u32},
                                            {'i', 8, NumberKind::i64},
                                            {'u', 8, NumberKind::u64}}};
  const auto* const found = std::ranges::find_if(
      known, [&](const Known& one) { return one.kind == field.kind && one.size == field.size; });
  return found == known.end() ? std::nullopt : std::optional(found->number);
}

std::string why_not(const NumpyField& field) {
  switch (field.kind) {
    case 'O':
      return "Python objects";
    case 'M':
    case 'm':
      return "dates; save them as numbers of seconds";
    case 'S':
    case 'U':
      return "text";
    case 'f':
    case 'c':
      if (field.size == 2) return "half precision; save them as float32";
      if (field.kind == 'f' ? field.size > 8 : field.size > 16)
        return "extended precision; save them in double precision";
      [[fallthrough]];
    default:
      return fmt::format("numbers of {} bytes of kind '{}'", field.size, to_utf8({&field.kind, 1}));
  }
}

/// Adds the arrays of .npy files to the contents that those of MATLAB make too.
class NumpyArrays {
 public:
  explicit NumpyArrays(MatContents& contents) : contents_(contents) {}

  /// One that begins at `at` of contents.file and ends at `end`.
  void add(const std::string& name, std::uint64_t at, std::uint64_t end) {
    ByteCursor cursor(*contents_.file, false, at);
    head_ = read_numpy_head(cursor, name.empty() ? "the array" : fmt::format("'{}'", name));
    there_ = end > head_.data ? (end - head_.data) / head_.element_size : 0;
    declared_ = 1;
    for (const std::uint64_t side : head_.shape)
      declared_ = side > 0 && declared_ > std::numeric_limits<std::uint64_t>::max() / side
                      ? std::numeric_limits<std::uint64_t>::max()
                      : declared_ * side;
    for (const NumpyField& field : head_.fields) {
      if (field.kind == 'V' && field.name.empty() && head_.fields.size() > 1) continue;  // padding
      const std::string full = name.empty()         ? field.name
                               : field.name.empty() ? name
                                                    : name + "." + field.name;
      add(full.empty() ? "array" : full, field);
    }
  }

 private:
  void add(const std::string& name, const NumpyField& field) {
    const auto kind = number_kind(field);
    if (field.kind == 'U' || field.kind == 'S') return add_texts(name, field);
    if (!kind) return contents_.skip(name, why_not(field));
    if (declared_ == 0) return contents_.skip(name, "empty");
    MatArray array;
    array.name = name;
    array.kind = *kind;
    array.other_order = field.big_endian;
    array.dimensions = std::max<std::size_t>(head_.shape.size(), 2);
    const auto& shape = head_.shape;
    array.rows = shape.size() == 2 ? shape[0] : declared_;
    array.columns = declared_ / array.rows;
    // row after row: what are its rows are columns of a MAT-file
    array.transposed = shape.size() == 2 && !head_.by_columns;
    if (array.transposed) std::swap(array.rows, array.columns);
    array.offset = head_.data + field.offset;
    array.stride = head_.element_size;
    array.count = std::min(declared_, there_);
    array.complex = field.kind == 'c';
    array.imaginary_kind = *kind;
    array.imaginary_offset = array.offset + size_of(*kind);
    contents_.add(array, declared_);
  }

  /// One is a fact, several may be names or units of columns.
  void add_texts(const std::string& name, const NumpyField& field) {
    const std::uint64_t count = std::min(declared_, there_);
    if (count > most_texts) return contents_.skip(name, "text");
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::string_view bytes =
          contents_.bytes().substr(head_.data + i * head_.element_size + field.offset, field.size);
      std::string text = field.kind == 'S' ? std::string(bytes.substr(0, bytes.find('\0')))
                                           : of_units(bytes, field.big_endian);
      contents_.texts.emplace(head_.shape.empty() ? name : fmt::format("{}{{{}}}", name, i + 1),
                              to_utf8_with_controls(text));
    }
  }

  /// UTF-32 without what is beyond the first 65536 characters.
  static std::string of_units(std::string_view bytes, bool big_endian) {
    std::string utf16 = "\xFE\xFF";
    for (std::size_t i = 0; i + 4 <= bytes.size(); i += 4) {
      const auto at = [&](std::size_t k) { return bytes[i + (big_endian ? k : 3 - k)]; };
      if (at(0) == 0 && at(1) == 0 && at(2) == 0 && at(3) == 0) break;
      const bool wide = at(0) != 0 || at(1) != 0;
      utf16 += wide ? '\xFF' : at(2);
      utf16 += wide ? '\xFD' : at(3);
    }
    return utf16_to_utf8(utf16);
  }

  MatContents& contents_;
  NumpyHead head_;
  std::uint64_t there_ = 0;     ///< elements
  std::uint64_t declared_ = 0;  ///< elements
};

/// Unpacks the arrays of an archive one after another; contents.file is then what holds them all.
void add_archive(const std::string& path, MatContents& contents) {
  struct Part {
    std::string name;
    std::uint64_t begin, end;
  };

  const MappedFile file(path);
  ZipArchive archive(file);
  Spool spool(path);
  std::vector<Part> parts;
  std::string piece;
  for (std::uint64_t i = 0; i < archive.entries(); ++i) {
    const std::string name = to_utf8(archive.name(i));
    constexpr std::string_view ending = ".npy";
    if (!name.ends_with(ending)) {
      contents.skip(name, "no array");
      continue;
    }
    std::uint64_t left = archive.size(i, name);
    const std::uint64_t begin = parts.empty() ? 0 : parts.back().end;
    parts.push_back({name.substr(0, name.size() - ending.size()), begin, begin + left});
    ZipArchive::Entry entry = archive.open(i, name);
    while (left > 0) {
      piece.resize(static_cast<std::size_t>(std::min<std::uint64_t>(left, unpacked_at_once)));
      entry.read(piece.data(), piece.size());
      spool.append(piece);
      left -= piece.size();
    }
    entry.check_sum();
  }
  contents.file = spool.map();
  NumpyArrays arrays(contents);
  for (const Part& part : parts) arrays.add(part.name, part.begin, part.end);
}

}  // namespace

int recognises_numpy(std::string_view, std::string_view head) {
  if (head.starts_with("\x93NUMPY")) return 100;
  // the name of the first entry stands behind its header of 30 bytes
  if (!head.starts_with(zip_begin) || head.size() < 30) return 0;
  const auto length = static_cast<std::size_t>(static_cast<unsigned char>(head[26])) |
                      static_cast<std::size_t>(static_cast<unsigned char>(head[27])) << 8U;
  return head.substr(30, length).ends_with(".npy") ? 90 : 0;
}

std::unique_ptr<RecordingReader> open_numpy(const std::string& path, const ImportOptions& options) {
  MatContents contents;
  contents.file = std::make_unique<MappedFile>(path);
  if (contents.bytes().starts_with(zip_begin))
    add_archive(path, contents);
  else
    NumpyArrays(contents).add("", 0, contents.bytes().size());
  return reader_of_mat_contents(std::move(contents), options);
}

}  // namespace impactrig::acquisition
