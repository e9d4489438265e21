// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/mat_contents.hpp"

#include <fmt/format.h>

#include <utility>

#include "acquisition/importers/mat4.hpp"
#include "acquisition/importers/mat5.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/importers/text_encoding.hpp"
#include "datasets/input_error.hpp"

namespace impactrig::acquisition {

namespace {

constexpr std::size_t most_skipped = 10000;  ///< that are remembered

}  // namespace

void MatContents::warn(std::string text) {
  if (warnings.size() < 100) warnings.push_back(std::move(text));
}

void MatContents::skip(const std::string& name, std::string_view why) {
  if (skipped.size() < most_skipped)
    skipped.push_back({name, std::string(why)});
  else
    ++more_skipped;
}

void MatContents::add(const MatArray& array, std::uint64_t declared) {
  if (array.count == 0) return skip(array.name, "cut");
  if (array.count < declared)
    warn(fmt::format("'{}' declares {} x {} numbers, {} are there", array.name, array.rows,
                     array.columns, array.count));
  arrays.push_back(array);
}

void MatContents::add_lines(const std::string& name, std::uint64_t lines,
                            std::u16string_view letters) {
  constexpr std::uint64_t most_lines = 1000;
  if (lines == 0 || lines > most_lines || letters.size() % lines != 0)
    return skip(name, "text of many lines");
  for (std::uint64_t line = 0; line < lines; ++line) {
    std::string utf16 = "\xFE\xFF";
    for (std::uint64_t i = line; i < letters.size(); i += lines) {
      utf16 += static_cast<char>(letters[i] >> 8);
      utf16 += static_cast<char>(letters[i] & 0xFF);
    }
    const std::string text = to_utf8_with_controls(utf16_to_utf8(utf16));
    texts.emplace(fmt::format("{}{{{}}}", name, line + 1), trimmed(text));
  }
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
  MatContents contents;
  contents.file = std::make_unique<MappedFile>(path);
  const std::string_view head = contents.bytes();
  if (head.size() >= 128 && (head.substr(126, 2) == "IM" || head.substr(126, 2) == "MI"))
    read_mat5(contents);
  else if (looks_like_mat4(head))
    read_mat4(contents);
  else
    throw datasets::InputError(
        contents.file->byte_position(0),
        "expected the header of a MAT-file: 128 bytes that end with 'IM' or 'MI', or "
        "the 20 bytes of version 4");
  return contents;
}

}  // namespace impactrig::acquisition
