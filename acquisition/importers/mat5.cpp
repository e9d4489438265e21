// SPDX-License-Identifier: BSD-3-Clause
// MAT-files of version 5 (that is, -v6 and -v7). Layout: MathWorks, "MAT-File Format", 2019.
#include "acquisition/importers/mat5.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>

#include "acquisition/importers/byte_cursor.hpp"
#include "acquisition/importers/packed_mat.hpp"
#include "acquisition/importers/text_file.hpp"
#include "datasets/input_error.hpp"

namespace impactrig::acquisition {

using datasets::InputError;

namespace {

constexpr int deepest = 16;                                  ///< structures in structures
constexpr std::uint64_t most_text = std::uint64_t{1} << 26;  ///< of one file [bytes]

// data types of an element
constexpr std::uint32_t mi_int8 = 1;
constexpr std::uint32_t mi_uint8 = 2;
constexpr std::uint32_t mi_uint16 = 4;
constexpr std::uint32_t mi_int32 = 5;
constexpr std::uint32_t mi_uint32 = 6;

constexpr std::uint32_t mi_matrix = 14;
constexpr std::uint32_t mi_compressed = 15;
constexpr std::uint32_t mi_utf8 = 16;
constexpr std::uint32_t mi_utf16 = 17;

/// Sizes are signed by the format; some writers have the other type, as numbers below 2^31 may.
bool is_int32(std::uint32_t type) {
  return type == mi_int32 || type == mi_uint32;
}

std::optional<NumberKind> kind_of(std::uint32_t type) {
  switch (type) {
    case mi_int8:
      return NumberKind::i8;
    case mi_uint8:
      return NumberKind::u8;
    case 3:
      return NumberKind::i16;
    case mi_uint16:
      return NumberKind::u16;
    case mi_int32:
      return NumberKind::i32;
    case mi_uint32:
      return NumberKind::u32;
    case 7:
      return NumberKind::f32;
    case 9:
      return NumberKind::f64;
    case 12:
      return NumberKind::i64;
    case 13:
      return NumberKind::u64;
    default:
      return std::nullopt;
  }
}

/// What a class that is no array of numbers is called.
constexpr unsigned object_class = 17;

std::string_view class_name(unsigned number) {
  switch (number) {
    case 3:
      return "an object";
    case 5:
      return "a sparse matrix";
    case 16:
      return "a function handle";
    default:
      return "of an unknown class";
  }
}

/// A data element: what its tag says.
struct Element {
  std::uint32_t type = 0;
  std::uint64_t data = 0;  ///< first byte
  std::uint64_t end = 0;   ///< behind the last byte that is there
  std::uint64_t next = 0;  ///< the next tag
  bool cut = false;        ///< it declares more bytes than there are
};

class Mat5Parser {
 public:
  explicit Mat5Parser(MatContents& contents) : contents_(contents) {}

  void read();

 private:
  std::string_view bytes() const { return contents_.bytes(); }

  template <typename Number>
  Number number(std::uint64_t at) const {
    return contents_.number<Number>(at);
  }

  /// The tag at `at`; none when fewer than 8 bytes are left.
  std::optional<Element> element_at(std::uint64_t at, std::uint64_t last) const {
    if (last > bytes().size() || at > last || last - at < 8) return std::nullopt;
    Element element;
    const auto first = number<std::uint32_t>(at);
    const std::uint32_t small = first >> 16;
    std::uint64_t size = 0;
    if (small != 0) {  // up to 4 bytes within the tag itself
      element.type = first & 0xFFFF;
      element.data = at + 4;
      size = small;
      element.next = at + 8;
      element.cut = size > 4;
      element.end = element.data + std::min<std::uint64_t>(size, 4);
      return element;
    }
    element.type = first;
    size = number<std::uint32_t>(at + 4);
    element.data = at + 8;
    const std::uint64_t left = last - element.data;
    element.cut = size > left;
    element.end = element.data + std::min(size, left);
    const std::uint64_t padded = element.type == mi_compressed ? size : (size + 7) / 8 * 8;
    element.next = element.data + std::min(padded, left);
    return element;
  }

  std::vector<FilePart> top_level() {
    std::vector<FilePart> parts;
    std::uint64_t at = 128;
    const std::uint64_t last = bytes().size();
    while (const auto element = element_at(at, last)) {
      if (element->type == mi_compressed) packed_ = true;
      if (element->type != mi_compressed && element->type != mi_matrix) {
        contents_.warn(
            fmt::format("the file goes on at byte {} with data of type {}, which is no array: the "
                        "rest is left out",
                        at, element->type));
        return parts;
      }
      if (element->cut)
        contents_.warn(fmt::format("the file ends within the array that begins at byte {}", at));
      parts.push_back({at, element->next});
      at = element->next;
    }
    if (at != last) contents_.warn("the file ends within an array's tag");
    return parts;
  }

  /// The same file without compression.
  std::vector<FilePart> unpack(const std::vector<FilePart>& parts) {
    std::vector<MatElement> elements;
    for (const FilePart& part : parts)
      if (const auto element = element_at(part.first, part.last))
        elements.push_back({part, {element->data, element->end}, element->type == mi_compressed});
    InflatedMat inflated =
        inflated_mat(std::move(contents_.file), elements, contents_.big_endian,
                     [this](std::string text) { contents_.warn(std::move(text)); });
    contents_.file = std::move(inflated.file);
    return std::move(inflated.elements);
  }

  /// An array and, where it is a structure, its fields.
  void read_matrix(const Element& matrix, const std::string& given_name, int depth) {
    std::uint64_t at = matrix.data;
    const auto next = [&]() -> std::optional<Element> {
      const auto element = element_at(at, matrix.end);
      if (element) at = element->next;
      return element;
    };
    const auto flags = next();
    const auto shape = flags ? next() : std::nullopt;
    const auto label = shape ? next() : std::nullopt;
    if (!label) {
      if (matrix.end > matrix.data)
        contents_.skip(given_name.empty() ? fmt::format("byte {}", matrix.data) : given_name,
                       "cut");
      return;
    }
    const bool flags_there = flags->type == mi_uint32 && flags->end - flags->data >= 8;
    const auto word = flags_there ? number<std::uint32_t>(flags->data) : 0;
    const unsigned class_number = word & 0xFF;
    if (class_number == object_class) return skip_object(*shape, next(), given_name, depth);
    std::string name = given_name;
    if (depth == 0) name = to_utf8(text_of(*label, longest_mat_name));
    if (!flags_there || !is_int32(shape->type)) return contents_.skip(name, "damaged");
    const bool complex = (word & 0x0800) != 0;
    // unnamed at the top: where MATLAB keeps what its objects consist of
    if (depth == 0 && name.empty())
      return contents_.skip("unnamed data of objects", "not published");
    MatArray array;
    array.name = name;
    if (!set_shape(*shape, array)) return contents_.skip(name, "damaged: its size is not one");
    if (class_number == 1) return read_cells(matrix, at, array, depth);
    if (class_number == 2) return read_structure(matrix, at, array, depth);
    if (class_number == 4) return read_text(next(), array);
    if (class_number < 6 || class_number > 15)
      return contents_.skip(name, class_name(class_number));
    const auto real = next();
    const auto imaginary = complex && real ? next() : std::nullopt;
    add_numbers(array, real, complex, imaginary);
  }

  /// Objects of MATLAB's newer classes (string, datetime, table) have texts where arrays have their
  /// size: their own name, whose classes these are, and the name of their class.
  void skip_object(const Element& own_name, const std::optional<Element>& of_class,
                   const std::string& given_name, int depth) {
    const std::string name = depth == 0 ? to_utf8(text_of(own_name, longest_mat_name)) : given_name;
    const std::string type = of_class ? to_utf8(text_of(*of_class, longest_mat_name)) : "";
    contents_.skip(name, matlab_object(type));
  }

  bool set_shape(const Element& shape, MatArray& array) const {
    const std::uint64_t dimensions = (shape.end - shape.data) / 4;
    if (dimensions < 2 || dimensions > 32) return false;
    array.dimensions = dimensions;
    array.rows = 1;
    array.columns = 1;
    for (std::uint64_t i = 0; i < dimensions; ++i) {
      const auto length = number<std::int32_t>(shape.data + 4 * i);
      if (length < 0) return false;
      std::uint64_t& side = i == 1 && dimensions == 2 ? array.columns : array.rows;
      const auto factor = static_cast<std::uint64_t>(length);
      if (factor != 0 && side > (std::uint64_t{1} << 62) / factor) return false;
      side *= factor;
    }
    return array.columns == 0 || array.rows <= (std::uint64_t{1} << 62) / array.columns;
  }

  std::string_view text_of(const Element& element, std::uint64_t most) const {
    std::string_view text =
        bytes().substr(element.data, std::min<std::uint64_t>(element.end - element.data, most));
    return text.substr(0, text.find('\0'));
  }

  void add_numbers(MatArray& array, const std::optional<Element>& real, bool complex,
                   const std::optional<Element>& imaginary) {
    const std::uint64_t declared = array.rows * array.columns;
    if (declared == 0) return contents_.skip(array.name, "empty");
    if (!real || (complex && !imaginary)) return contents_.skip(array.name, "cut");
    const auto kind = kind_of(real->type);
    const auto imaginary_kind = complex ? kind_of(imaginary->type) : NumberKind::f64;
    if (!kind || !imaginary_kind)
      return contents_.skip(array.name, fmt::format("damaged: its numbers are of type {}",
                                                    kind ? imaginary->type : real->type));
    array.kind = *kind;
    array.offset = real->data;
    array.count = std::min(declared, (real->end - real->data) / size_of(*kind));
    array.complex = complex;
    if (complex) {
      array.imaginary_kind = *imaginary_kind;
      array.imaginary_offset = imaginary->data;
      array.count =
          std::min(array.count, (imaginary->end - imaginary->data) / size_of(*imaginary_kind));
    }
    contents_.add(array, declared);
  }

  void read_text(const std::optional<Element>& element, const MatArray& array) {
    if (array.rows * array.columns == 0) return;
    if (array.dimensions > 2) return contents_.skip(array.name, "text of three dimensions");
    if (!element) return contents_.skip(array.name, "cut");
    text_bytes_ += std::min<std::uint64_t>(element->end - element->data, longest_mat_text);
    if (text_bytes_ > most_text) return contents_.skip(array.name, "more text than 64 MB");
    if (array.rows != 1) return read_lines(*element, array);
    std::string text;
    if (element->type == mi_uint16 || element->type == mi_utf16) {
      text = contents_.big_endian ? "\xFE\xFF" : "\xFF\xFE";
      text += bytes().substr(
          element->data, std::min<std::uint64_t>(element->end - element->data, longest_mat_text));
      text = utf16_to_utf8(text);
    } else if (element->type == mi_utf8 || element->type == mi_uint8 || element->type == mi_int8) {
      text = to_utf8_with_controls(text_of(*element, longest_mat_text));
    } else {
      return contents_.skip(array.name, fmt::format("text of type {}", element->type));
    }
    contents_.texts.emplace(array.name, text);
  }

  void read_lines(const Element& element, const MatArray& array) {
    const std::uint64_t letters = array.rows * array.columns;
    const bool wide = element.type == mi_uint16 || element.type == mi_utf16;
    const bool narrow =
        element.type == mi_utf8 || element.type == mi_uint8 || element.type == mi_int8;
    if (!wide && !narrow)
      return contents_.skip(array.name, fmt::format("text of type {}", element.type));
    if ((element.end - element.data) / (wide ? 2 : 1) < letters)
      return contents_.skip(array.name, "cut");
    if (letters > longest_mat_text) return contents_.skip(array.name, "text of many lines");
    std::u16string text;
    for (std::uint64_t i = 0; i < letters; ++i)
      text += wide ? number<std::uint16_t>(element.data + 2 * i)
                   : static_cast<unsigned char>(bytes()[element.data + i]);
    // letters of UTF-8 have several bytes, and lines are no longer told apart
    if (narrow && std::ranges::any_of(text, [](char16_t letter) { return letter >= 0x80; }))
      return contents_.skip(array.name, "text of several lines that is not ASCII");
    contents_.add_lines(array.name, array.rows, text);
  }

  void read_structure(const Element& matrix, std::uint64_t at, const MatArray& array, int depth) {
    if (depth >= deepest) return contents_.skip(array.name, "nested too deeply");
    if (depth == 0) contents_.variables.push_back(array.name);
    if (depth <= 2) contents_.structures.emplace(array.name, array.rows * array.columns);
    const auto width = element_at(at, matrix.end);
    const auto names = width ? element_at(width->next, matrix.end) : std::nullopt;
    if (!names || !is_int32(width->type) || width->end - width->data < 4 || names->type != mi_int8)
      return contents_.skip(array.name, "damaged");
    const auto length = number<std::int32_t>(width->data);
    if (length < 1 || static_cast<std::uint64_t>(length) > longest_mat_name)
      return contents_.skip(array.name, "damaged: its names have no length");
    const auto step = static_cast<std::uint64_t>(length);
    const std::uint64_t fields = (names->end - names->data) / step;
    const std::uint64_t structures = array.rows * array.columns;
    std::uint64_t from = names->next;
    for (std::uint64_t s = 0; s < structures && fields > 0; ++s)
      for (std::uint64_t f = 0; f < fields; ++f) {
        const auto field = element_at(from, matrix.end);
        if (!field) {
          if (from != matrix.end || s + 1 < structures || f < fields)
            contents_.skip(array.name, "cut");
          return;
        }
        from = field->next;
        if (field->type != mi_matrix) continue;
        Element label;
        label.data = names->data + f * step;
        label.end = label.data + step;
        const std::string which = structures > 1 ? fmt::format("({})", s + 1) : std::string();
        read_matrix(*field,
                    fmt::format("{}{}.{}", array.name, which, to_utf8(text_of(label, step))),
                    depth + 1);
      }
  }

  /// What a cell array holds, column after column.
  void read_cells(const Element& matrix, std::uint64_t at, const MatArray& array, int depth) {
    if (depth >= deepest) return contents_.skip(array.name, "nested too deeply");
    const std::uint64_t cells = array.rows * array.columns;
    if (cells == 0) return contents_.skip(array.name, "empty");
    for (std::uint64_t i = 0; i < cells; ++i) {
      const auto cell = element_at(at, matrix.end);
      if (!cell) return contents_.skip(array.name, "cut");
      at = cell->next;
      if (cell->type == mi_matrix)
        read_matrix(*cell, fmt::format("{}{{{}}}", array.name, i + 1), depth + 1);
    }
  }

  MatContents& contents_;
  bool packed_ = false;
  std::uint64_t text_bytes_ = 0;
};

void Mat5Parser::read() {
  const std::string_view head = bytes();
  contents_.version = "5";
  contents_.big_endian = head[126] == 'M';
  std::string_view text = head.substr(0, 116);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\0')) text.remove_suffix(1);
  contents_.header = to_utf8(text);
  const auto version = number<std::uint16_t>(124);
  if (version == 0x0200)
    throw InputError(contents_.file->byte_position(124),
                     "this is a MAT-file of version 7.3, but there is no HDF5 signature at byte "
                     "512: it is damaged or cut");
  if (version != 0x0100)
    throw InputError(
        contents_.file->byte_position(124),
        fmt::format("version 0x{:04X} of MAT-files is not known, expected 0x0100", version));
  std::vector<FilePart> parts = top_level();
  if (packed_) parts = unpack(parts);
  for (const FilePart& part : parts) {
    const auto element = element_at(part.first, part.last);
    if (!element || element->type != mi_matrix) continue;
    read_matrix(*element, {}, 0);
  }
}

}  // namespace

void read_mat5(MatContents& contents) {
  Mat5Parser(contents).read();
}

}  // namespace impactrig::acquisition
