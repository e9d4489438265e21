// SPDX-License-Identifier: BSD-3-Clause
// MAT-files of versions 4 and 5 (that is, -v4, -v6 and -v7). Layout: MathWorks, "MAT-File Format",
// 2019.
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

constexpr int deepest = 16;                                     ///< structures in structures
constexpr std::uint64_t longest_name = 256;                     ///< MATLAB: 63 [bytes]
constexpr std::uint64_t longest_text = std::uint64_t{1} << 20;  ///< [bytes]
constexpr std::uint64_t most_text = std::uint64_t{1} << 26;     ///< of one file [bytes]
constexpr std::size_t most_skipped = 10000;                     ///< that are remembered

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

class MatParser {
 public:
  explicit MatParser(const std::string& path) {
    contents_.file = std::make_unique<MappedFile>(path);
  }

  MatContents read() {
    const std::string_view head = bytes();
    const bool five =
        head.size() >= 128 && (head.substr(126, 2) == "IM" || head.substr(126, 2) == "MI");
    if (five)
      read_5();
    else if (looks_like_mat4(head))
      read_4();
    else
      throw InputError(
          contents_.file->byte_position(0),
          "expected the header of a MAT-file: 128 bytes that end with 'IM' or 'MI', or "
          "the 20 bytes of version 4");
    return std::move(contents_);
  }

 private:
  std::string_view bytes() const { return contents_.file->bytes(); }

  void warn(std::string text) {
    if (contents_.warnings.size() < 100) contents_.warnings.push_back(std::move(text));
  }

  void skip(const std::string& name, std::string_view why) {
    if (contents_.skipped.size() < most_skipped)
      contents_.skipped.push_back({name, std::string(why)});
    else
      ++contents_.more_skipped;
  }

  template <typename Number>
  Number number(std::uint64_t at) const {
    return ByteCursor(*contents_.file, contents_.big_endian, at).read<Number>("a field");
  }

  // ---- version 5

  void read_5() {
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
        warn(
            fmt::format("the file goes on at byte {} with data of type {}, which is no array: the "
                        "rest is left out",
                        at, element->type));
        return parts;
      }
      if (element->cut)
        warn(fmt::format("the file ends within the array that begins at byte {}", at));
      parts.push_back({at, element->next});
      at = element->next;
    }
    if (at != last) warn("the file ends within an array's tag");
    return parts;
  }

  /// The same file without compression.
  std::vector<FilePart> unpack(const std::vector<FilePart>& parts) {
    std::vector<MatElement> elements;
    for (const FilePart& part : parts)
      if (const auto element = element_at(part.first, part.last))
        elements.push_back({part, {element->data, element->end}, element->type == mi_compressed});
    InflatedMat inflated = inflated_mat(std::move(contents_.file), elements, contents_.big_endian,
                                        [this](std::string text) { warn(std::move(text)); });
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
        skip(given_name.empty() ? fmt::format("byte {}", matrix.data) : given_name, "cut");
      return;
    }
    const bool flags_there = flags->type == mi_uint32 && flags->end - flags->data >= 8;
    const auto word = flags_there ? number<std::uint32_t>(flags->data) : 0;
    const unsigned class_number = word & 0xFF;
    if (class_number == object_class) return skip_object(*shape, next(), given_name, depth);
    std::string name = given_name;
    if (depth == 0) name = to_utf8(text_of(*label, longest_name));
    if (!flags_there || shape->type != mi_int32) return skip(name, "damaged");
    const bool complex = (word & 0x0800) != 0;
    // unnamed at the top: where MATLAB keeps what its objects consist of
    if (depth == 0 && name.empty()) return skip("unnamed data of objects", "not published");
    MatArray array;
    array.name = name;
    if (!set_shape(*shape, array)) return skip(name, "damaged: its size is not one");
    if (class_number == 1) return read_cells(matrix, at, array, depth);
    if (class_number == 2) return read_structure(matrix, at, array, depth);
    if (class_number == 4) return read_text(next(), array);
    if (class_number < 6 || class_number > 15) return skip(name, class_name(class_number));
    const auto real = next();
    const auto imaginary = complex && real ? next() : std::nullopt;
    add_numbers(array, real, complex, imaginary);
  }

  /// Objects of MATLAB's newer classes (string, datetime, table) have texts where arrays have their
  /// size: their own name, whose classes these are, and the name of their class.
  void skip_object(const Element& own_name, const std::optional<Element>& of_class,
                   const std::string& given_name, int depth) {
    const std::string name = depth == 0 ? to_utf8(text_of(own_name, longest_name)) : given_name;
    const std::string type = of_class ? to_utf8(text_of(*of_class, longest_name)) : "";
    skip(name, matlab_object(type));
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
    if (declared == 0) return skip(array.name, "empty");
    if (!real || (complex && !imaginary)) return skip(array.name, "cut");
    const auto kind = kind_of(real->type);
    const auto imaginary_kind = complex ? kind_of(imaginary->type) : NumberKind::f64;
    if (!kind || !imaginary_kind)
      return skip(array.name, fmt::format("damaged: its numbers are of type {}",
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
    if (array.count == 0) return skip(array.name, "cut");
    if (array.count < declared)
      warn(fmt::format("'{}' declares {} x {} numbers, {} are there", array.name, array.rows,
                       array.columns, array.count));
    contents_.arrays.push_back(array);
  }

  void read_text(const std::optional<Element>& element, const MatArray& array) {
    if (array.rows * array.columns == 0) return;
    if (array.rows != 1) return skip(array.name, "text of several lines");
    if (!element) return skip(array.name, "cut");
    text_bytes_ += std::min<std::uint64_t>(element->end - element->data, longest_text);
    if (text_bytes_ > most_text) return skip(array.name, "more text than 64 MB");
    std::string text;
    if (element->type == mi_uint16 || element->type == mi_utf16) {
      text = contents_.big_endian ? "\xFE\xFF" : "\xFF\xFE";
      text += bytes().substr(element->data,
                             std::min<std::uint64_t>(element->end - element->data, longest_text));
      text = utf16_to_utf8(text);
    } else if (element->type == mi_utf8 || element->type == mi_uint8 || element->type == mi_int8) {
      text = to_utf8_with_controls(text_of(*element, longest_text));
    } else {
      return skip(array.name, fmt::format("text of type {}", element->type));
    }
    contents_.texts.emplace(array.name, text);
  }

  void read_structure(const Element& matrix, std::uint64_t at, const MatArray& array, int depth) {
    if (depth >= deepest) return skip(array.name, "nested too deeply");
    if (depth == 0) contents_.variables.push_back(array.name);
    if (depth <= 1) contents_.structures.emplace(array.name, array.rows * array.columns);
    const auto width = element_at(at, matrix.end);
    const auto names = width ? element_at(width->next, matrix.end) : std::nullopt;
    if (!names || width->type != mi_int32 || width->end - width->data < 4 || names->type != mi_int8)
      return skip(array.name, "damaged");
    const auto length = number<std::int32_t>(width->data);
    if (length < 1 || static_cast<std::uint64_t>(length) > longest_name)
      return skip(array.name, "damaged: its names have no length");
    const auto step = static_cast<std::uint64_t>(length);
    const std::uint64_t fields = (names->end - names->data) / step;
    const std::uint64_t structures = array.rows * array.columns;
    std::uint64_t from = names->next;
    for (std::uint64_t s = 0; s < structures && fields > 0; ++s)
      for (std::uint64_t f = 0; f < fields; ++f) {
        const auto field = element_at(from, matrix.end);
        if (!field) {
          if (from != matrix.end || s + 1 < structures || f < fields) skip(array.name, "cut");
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
    if (depth >= deepest) return skip(array.name, "nested too deeply");
    const std::uint64_t cells = array.rows * array.columns;
    if (cells == 0) return skip(array.name, "empty");
    for (std::uint64_t i = 0; i < cells; ++i) {
      const auto cell = element_at(at, matrix.end);
      if (!cell) return skip(array.name, "cut");
      at = cell->next;
      if (cell->type == mi_matrix)
        read_matrix(*cell, fmt::format("{}{{{}}}", array.name, i + 1), depth + 1);
    }
  }

  // ---- version 4

  void read_4() {
    contents_.version = "4";
    std::uint64_t at = 0;
    while (at < bytes().size()) {
      if (bytes().size() - at < 20) return warn("the file ends within an array's header");
      const auto type_little = ByteCursor(*contents_.file, false, at).read<std::uint32_t>("a type");
      contents_.big_endian = type_little > 9999;
      const std::uint32_t type = number<std::uint32_t>(at);
      const auto rows = number<std::int32_t>(at + 4);
      const auto columns = number<std::int32_t>(at + 8);
      const auto complex = number<std::int32_t>(at + 12);
      const auto name_length = number<std::int32_t>(at + 16);
      if (type > 4999 || type / 100 % 10 != 0 || type / 10 % 10 > 5 || type % 10 > 2 || rows < 0 ||
          columns < 0 || complex < 0 || complex > 1 || name_length < 1)
        return warn(fmt::format("what follows at byte {} is no array: it is left out", at));
      if (type / 1000 > 1)
        throw InputError(
            contents_.file->byte_position(at),
            fmt::format("the numbers are those of {}, which are not read: load the file in MATLAB "
                        "and save it with -v6",
                        type / 1000 == 4 ? "a Cray" : "a VAX"));
      constexpr std::array<NumberKind, 6> kinds = {NumberKind::f64, NumberKind::f32,
                                                   NumberKind::i32, NumberKind::i16,
                                                   NumberKind::u16, NumberKind::u8};
      const NumberKind kind = kinds[type / 10 % 10];
      const auto length = static_cast<std::uint64_t>(name_length);
      if (bytes().size() - at - 20 < length)
        return warn(fmt::format("the file ends within the name of the array at byte {}", at));
      Element label;
      label.data = at + 20;
      label.end = label.data + length;
      MatArray array;
      array.name = to_utf8(text_of(label, longest_name));
      array.rows = static_cast<std::uint64_t>(rows);
      array.columns = static_cast<std::uint64_t>(columns);
      array.kind = kind;
      array.offset = label.end;
      const std::uint64_t declared = array.rows * array.columns;
      const std::uint64_t width = size_of(kind);
      // each side is below 2^31: no product of these overflows
      const std::uint64_t part_bytes =
          declared > (std::uint64_t{1} << 60) ? ~std::uint64_t{0} : declared * width;
      const std::uint64_t left = bytes().size() - array.offset;
      array.complex = complex == 1;
      array.count = std::min(declared, left / width);
      if (array.complex) {
        array.imaginary_kind = kind;
        array.imaginary_offset = array.offset + std::min(part_bytes, left);
        array.count = std::min(array.count, (bytes().size() - array.imaginary_offset) / width);
      }
      add_4(array, type % 10, declared);
      const std::uint64_t parts = array.complex ? 2 : 1;
      if (part_bytes > left / parts) return;
      at = array.offset + parts * part_bytes;
    }
  }

  void add_4(const MatArray& array, std::uint32_t kind, std::uint64_t declared) {
    if (declared == 0) return skip(array.name, "empty");
    if (kind == 2) return skip(array.name, "a sparse matrix");
    if (kind == 1) {
      if (array.rows != 1) return skip(array.name, "text of several lines");
      std::string text;
      for (std::uint64_t i = 0; i < std::min(array.count, longest_text); ++i)
        text += static_cast<char>(character(array, i));
      contents_.texts.emplace(array.name, to_utf8(text));
      return;
    }
    if (array.count == 0) return skip(array.name, "cut");
    if (array.count < declared)
      warn(fmt::format("'{}' declares {} x {} numbers, {} are there", array.name, array.rows,
                       array.columns, array.count));
    contents_.arrays.push_back(array);
  }

  /// Characters are numbers, of any type.
  int character(const MatArray& array, std::uint64_t index) const {
    const std::uint64_t at = array.offset + index * size_of(array.kind);
    double code = 0.0;
    switch (array.kind) {
      case NumberKind::f64:
        code = number<double>(at);
        break;
      case NumberKind::f32:
        code = number<float>(at);
        break;
      case NumberKind::i32:
        code = number<std::int32_t>(at);
        break;
      case NumberKind::i16:
        code = number<std::int16_t>(at);
        break;
      case NumberKind::u16:
        code = number<std::uint16_t>(at);
        break;
      default:
        code = number<std::uint8_t>(at);
    }
    return code >= 0.0 && code < 256.0 ? static_cast<int>(code) : '?';
  }

  MatContents contents_;
  bool packed_ = false;
  std::uint64_t text_bytes_ = 0;
};

}  // namespace

bool looks_like_mat4(std::string_view head) {
  if (head.size() < 22) return false;
  const auto field = [&head](std::size_t index, bool big) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i)
      value = value << 8 | static_cast<unsigned char>(head[4 * index + (big ? i : 3 - i)]);
    return value;
  };
  const bool big = field(0, false) > 9999;
  const std::uint32_t type = field(0, big);
  const std::uint32_t length = field(4, big);
  if (type > 4999 || type / 100 % 10 != 0 || type / 10 % 10 > 5 || type % 10 > 2) return false;
  if (field(1, big) >> 31 != 0 || field(2, big) >> 31 != 0 || field(3, big) > 1) return false;
  if (length < 2 || length > longest_name || head.size() < 20 + length) return false;
  const std::string_view name = head.substr(20, length - 1);
  return head[20 + length - 1] == '\0' &&
         std::isalpha(static_cast<unsigned char>(name.front())) != 0 &&
         std::ranges::all_of(name, [](char c) {
           return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
         });
}

std::string matlab_object(std::string_view type) {
  std::string text = type.empty() ? "an object" : fmt::format("an object of class {}", type);
  if (type == "table") text += ": table2struct(t, 'ToScalar', true) makes arrays of it";
  if (type == "timetable")
    text += ": table2struct(timetable2table(t), 'ToScalar', true) makes arrays of it";
  return text;
}

std::string skipped_arrays(const MatContents& contents) {
  std::string list;
  std::uint64_t more = contents.more_skipped;
  for (const auto& [name, why] : contents.skipped) {
    if (list.size() > 500)
      ++more;
    else
      list += fmt::format("{}'{}' ({})", list.empty() ? "not read: " : ", ", name, why);
  }
  if (more > 0) list += fmt::format(" and {} more", more);
  return list;
}

MatContents read_mat_contents(const std::string& path) {
  return MatParser(path).read();
}

}  // namespace impactrig::acquisition
