// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "acquisition/importers/text_file.hpp"

namespace impactrig::acquisition {

/// A LabVIEW measurement file, the place its reading has come to, and how its cells are told apart.
struct LvmText {
  /// `head_only`: of a large file, its first lines are all that is looked at.
  explicit LvmText(const std::string& path, bool head_only = false)
      : file(path, head_only),
        at(file.text().data()),
        end(at + (head_only ? whole_lines(file.text(), telling_part) : file.text()).size()),
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
