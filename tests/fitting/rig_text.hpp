// SPDX-License-Identifier: BSD-3-Clause
//
// Rig files of tests, made of the paper's.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "datasets/input_error.hpp"
#include "fitting/rig_file.hpp"
#include "tests/fitting/synthetic_shot.hpp"

namespace impactrig::tests {

/// Of the error that the text is; "no error" where it is none.
inline std::string message_of(const std::string& text,
                              const std::vector<fitting::Override>& overrides = {}) {
  try {
    fitting::parse_rig_file(text, "rig.toml", overrides);
  } catch (const datasets::InputError& error) {
    return error.what();
  }
  return "no error";
}

/// The paper's rig with one line replaced.
inline std::string with(const std::string& line, const std::string& replacement) {
  std::string text = paper_rig;
  const std::size_t at = text.find(line);
  EXPECT_NE(at, std::string::npos) << line;
  return text.replace(at, line.size(), replacement);
}

/// The paper's rig with keys of its contact added or replaced by others.
inline std::string with_contact(const std::string& lines) {
  return with("restitution = 0.5\n", lines + "\n");
}

}  // namespace impactrig::tests
