// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "acquisition/importers/text_file.hpp"

namespace impactrig::acquisition {

/// A LabVIEW measurement file, the place its reading has come to, and how its cells are told apart.
struct LvmText {
  static constexpr std::size_t all = std::string_view::npos;

  /// `looked_at`: bytes whose whole lines are all that is looked at.
  explicit LvmText(const std::string& path, const std::string& code_page,
                   std::size_t looked_at = all)
      : file(path, looked_at != all, code_page),
        at(file.text().data()),
        end(at + (looked_at != all ? whole_lines(file.text(), looked_at) : file.text()).size()),
        is_part(file.is_part() || end != at + file.text().size()) {}

  TextFile file;
  const char* at;
  const char* end;
  const bool is_part;  ///< the file goes on behind `end`
  char separator = '\t';
  char decimal = '\0';       ///< '\0': not known yet
  bool multi = false;        ///< every channel has an X column of its own
  bool one_heading = false;  ///< packets follow without a header of their own

  /// True for a line without a value.
  bool blank(std::string_view line) const {
    return std::ranges::all_of(line, [this](char c) {
      return c == separator || c == ' ' || c == '\t' || c == '\r' || c == '\0';
    });
  }
};

}  // namespace impactrig::acquisition
