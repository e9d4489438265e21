// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cctype>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/importers/mapped_file.hpp"

namespace impactrig::acquisition {

/// What an answer says of one source.
struct IsfPreamble {
  std::string source;  ///< "CH1" of "CH1:WFID"; "" where the answer does not name its sources
  std::map<std::string, std::string> keys;
};

/// The head of an answer. An answer for several sources states what they have in common, then
/// "CH1:" and what is the first one's own, and so on [Tektronix, TDS Family Oscilloscope Programmer
/// Manual, WFMPre:<wfm>?].
struct IsfHead {
  std::vector<IsfPreamble> preambles{IsfPreamble{}};  ///< one a curve, in their order
  std::size_t curve = std::string_view::npos;         ///< first byte behind the word CURVE
};

/// The way out of files whose curves cannot be told apart.
constexpr std::string_view one_source_a_file = "save each source in a file of its own";

/// True where a preamble begins.
bool begins_isf(std::string_view bytes);

/// Reads the head that begins at `at`. Throws datasets::InputError where it contradicts itself.
IsfHead read_isf_head(const MappedFile& file, std::size_t at);

/// Keys and values are written in any case.
std::string upper_case(std::string_view text);

inline bool is_space(char c) {
  return std::isspace(static_cast<unsigned char>(c)) != 0;
}

}  // namespace impactrig::acquisition
