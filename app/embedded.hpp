// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

/// The shipped example, built into the program so that `impactrig demo` needs no other file.
namespace impactrig::app::embedded {

struct EmbeddedFile {
  std::string_view name;
  std::string_view bytes;
  std::string_view sha256;
};

extern const EmbeddedFile shen2007_toml;   ///< datasets/samples/shen2007.toml
extern const EmbeddedFile shen2007_1_uff;  ///< datasets/samples/shen2007-1.uff

}  // namespace impactrig::app::embedded
