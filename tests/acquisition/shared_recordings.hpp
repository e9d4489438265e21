// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/places.hpp"

namespace impactrig::acquisition::tests {

/// The folder of third-party recordings, each with the answer of another reader beside it
/// (X.truth.json); it may be absent.
inline std::filesystem::path shared_recordings() {
  return std::filesystem::path(impactrig::tests::shared_dir) / "recordings";
}

/// Their names within that folder, in order.
inline std::vector<std::string> names_of_shared_recordings() {
  namespace fs = std::filesystem;
  std::vector<std::string> names;
  const fs::path folder = shared_recordings();
  if (!fs::exists(folder)) return names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string path = entry.path().string();
    if (path.ends_with(".truth.json") || !fs::exists(path + ".truth.json")) continue;
    names.push_back(fs::relative(path, folder).string());
  }
  std::ranges::sort(names);
  return names;
}

/// A name that a test may have.
inline std::string test_name_of(std::string recording) {
  for (char& c : recording)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  return recording;
}

}  // namespace impactrig::acquisition::tests
