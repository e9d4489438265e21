// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "acquisition/importers/text_file.hpp"

namespace impactrig::acquisition {

/// A LabVIEW measurement file, the place its reading has come to, and how its cells are told apart.
struct LvmText {
  explicit LvmText(const std::string& path)
      : file(path),
        at(file.text().data()),
        end(at + file.text().size()) {}

  TextFile file;
  const char* at;
  const char* end;
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
