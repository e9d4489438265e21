// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/importer.hpp"

namespace impactrig::acquisition::tests {

/// A file with the given bytes, named after the running test and process, gone afterwards.
class WrittenFile {
 public:
  explicit WrittenFile(std::string_view bytes, std::string_view ending = ".txt")
      : path_(testing::TempDir() + "impactrig_" + test_name() + std::to_string(getpid()) +
              std::string(ending)) {
    std::ofstream(path_, std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }

  ~WrittenFile() { std::remove(path_.c_str()); }

  WrittenFile(const WrittenFile&) = delete;
  WrittenFile& operator=(const WrittenFile&) = delete;

  const std::string& path() const { return path_; }

  static std::string test_name() {
    const auto* const info = testing::UnitTest::GetInstance()->current_test_info();
    std::string name = fmt::format("{}_{}", info->test_suite_name(), info->name());
    for (char& c : name)
      if (c == '/') c = '_';
    return name;
  }

 private:
  std::string path_;
};

inline std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// With a byte order mark.
inline std::string utf16(std::u16string_view text, bool little = true) {
  std::string bytes;
  const auto append = [&](char16_t unit) {
    const char low = static_cast<char>(unit & 0xFFU);
    const char high = static_cast<char>(unit >> 8U);
    bytes.append({little ? low : high, little ? high : low});
  };
  bytes.reserve(2 * text.size() + 2);
  append(u'\uFEFF');
  for (const char16_t unit : text) append(unit);
  return bytes;
}

/// Of ASCII.
inline std::string utf16(std::string_view text, bool little = true) {
  return utf16(std::u16string(text.begin(), text.end()), little);
}

/// Imports bytes as a file; a missing clock is a warning.
inline datasets::Record imported(std::string_view bytes, ImportOptions options = {},
                                 std::string_view ending = ".txt") {
  const WrittenFile file(bytes, ending);
  options.require_clock = false;
  return import_recording(file.path(), options);
}

/// What an import of these bytes throws, with the file's name as FILE; "" when it succeeds.
inline std::string import_error(std::string_view bytes, const ImportOptions& options = {},
                                std::string_view ending = ".txt") {
  const WrittenFile file(bytes, ending);
  try {
    import_recording(file.path(), options);
  } catch (const std::exception& error) {
    std::string text = error.what();
    const std::size_t place = text.find(file.path());
    if (place != std::string::npos) text.replace(place, file.path().size(), "FILE");
    return text;
  }
  return {};
}

/// "Force [N]" of each channel.
inline std::vector<std::string> names_and_units(const datasets::Record& record) {
  std::vector<std::string> list;
  for (const datasets::Channel& channel : record.channels)
    list.push_back(channel.name + " [" + channel.unit + "]");
  return list;
}

}  // namespace impactrig::acquisition::tests
