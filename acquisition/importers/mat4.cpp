// SPDX-License-Identifier: BSD-3-Clause
// MAT-files of version 4. Layout: MathWorks, "MAT-File Format", 2019.
#include "acquisition/importers/mat4.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "acquisition/importers/text_file.hpp"
#include "datasets/input_error.hpp"

namespace impactrig::acquisition {

using datasets::InputError;

namespace {

/// Characters are numbers, of any type.
int character(const MatArray& array, std::uint64_t index, const MatContents& contents) {
  const std::uint64_t at = array.offset + index * size_of(array.kind);
  double code = 0.0;
  switch (array.kind) {
    case NumberKind::f64:
      code = contents.number<double>(at);
      break;
    case NumberKind::f32:
      code = contents.number<float>(at);
      break;
    case NumberKind::i32:
      code = contents.number<std::int32_t>(at);
      break;
    case NumberKind::i16:
      code = contents.number<std::int16_t>(at);
      break;
    case NumberKind::u16:
      code = contents.number<std::uint16_t>(at);
      break;
    default:
      code = contents.number<std::uint8_t>(at);
  }
  return code >= 0.0 && code < 256.0 ? static_cast<int>(code) : '?';
}

void add(const MatArray& array, std::uint32_t kind, std::uint64_t declared, MatContents& contents) {
  if (declared == 0) return contents.skip(array.name, "empty");
  if (kind == 2) return contents.skip(array.name, "a sparse matrix");
  if (kind == 1) {
    std::string text;
    for (std::uint64_t i = 0; i < std::min(array.count, longest_mat_text); ++i)
      text += static_cast<char>(character(array, i, contents));
    if (array.rows != 1) {
      std::u16string letters;
      for (const char c : text) letters += static_cast<unsigned char>(c);
      return contents.add_lines(array.name, array.rows, letters);
    }
    contents.texts.emplace(array.name, to_utf8(text));
    return;
  }
  contents.add(array, declared);
}

}  // namespace

void read_mat4(MatContents& contents) {
  contents.version = std::string("4");
  std::uint64_t at = 0;
  while (at < contents.bytes().size()) {
    if (contents.bytes().size() - at < 20)
      return contents.warn("the file ends within an array's header");
    const auto type_little = ByteCursor(*contents.file, false, at).read<std::uint32_t>("a type");
    contents.big_endian = type_little > 9999;
    const std::uint32_t type = contents.number<std::uint32_t>(at);
    const auto rows = contents.number<std::int32_t>(at + 4);
    const auto columns = contents.number<std::int32_t>(at + 8);
    const auto complex = contents.number<std::int32_t>(at + 12);
    const auto name_length = contents.number<std::int32_t>(at + 16);
    if (type > 4999 || type / 100 % 10 != 0 || type / 10 % 10 > 5 || type % 10 > 2 || rows < 0 ||
        columns < 0 || complex < 0 || complex > 1 || name_length < 1)
      return contents.warn(fmt::format("what follows at byte {} is no array: it is left out", at));
    if (type / 1000 > 1)
      throw InputError(
          contents.file->byte_position(at),
          fmt::format("the numbers are those of {}, which are not read: load the file in MATLAB "
                      "and save it with -v6",
                      type / 1000 == 4 ? "a Cray" : "a VAX"));
    constexpr std::array<NumberKind, 6> kinds = {NumberKind::f64, NumberKind::f32, NumberKind::i32,
                                                 NumberKind::i16, NumberKind::u16, NumberKind::u8};
    const NumberKind kind = kinds[type / 10 % 10];
    const auto length = static_cast<std::uint64_t>(name_length);
    if (contents.bytes().size() - at - 20 < length)
      return contents.warn(
          fmt::format("the file ends within the name of the array at byte {}", at));
    const std::uint64_t label = at + 20;
    const std::string_view name =
        contents.bytes().substr(label, std::min(length, longest_mat_name));
    MatArray array;
    array.name = to_utf8(name.substr(0, name.find('\0')));
    array.rows = static_cast<std::uint64_t>(rows);
    array.columns = static_cast<std::uint64_t>(columns);
    array.kind = kind;
    array.offset = label + length;
    const std::uint64_t declared = array.rows * array.columns;
    const std::uint64_t width = size_of(kind);
    // each side is below 2^31: no product of these overflows
    const std::uint64_t part_bytes =
        declared > (std::uint64_t{1} << 60) ? ~std::uint64_t{0} : declared * width;
    const std::uint64_t left = contents.bytes().size() - array.offset;
    array.complex = complex == 1;
    array.count = std::min(declared, left / width);
    if (array.complex) {
      array.imaginary_kind = kind;
      array.imaginary_offset = array.offset + std::min(part_bytes, left);
      array.count =
          std::min(array.count, (contents.bytes().size() - array.imaginary_offset) / width);
    }
    add(array, type % 10, declared, contents);
    const std::uint64_t parts = array.complex ? 2 : 1;
    if (part_bytes > left / parts) return;
    at = array.offset + parts * part_bytes;
  }
}

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
  if (length < 2 || length > longest_mat_name || head.size() < 20 + length) return false;
  const std::string_view name = head.substr(20, length - 1);
  return head[20 + length - 1] == '\0' &&
         std::isalpha(static_cast<unsigned char>(name.front())) != 0 &&
         std::ranges::all_of(name, [](char c) {
           return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
         });
}

}  // namespace impactrig::acquisition
