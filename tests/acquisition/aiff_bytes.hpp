// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/acquisition/bytes.hpp"

namespace impactrig::acquisition::tests {

/// An AIFF or AIFF-C file, written from its fields [Apple, "Audio Interchange File Format", 1989,
/// and its draft of AIFF-C, 1991].
struct AiffFile {
  std::string coding{};  ///< four letters; "": AIFF, which has none
  std::uint16_t channels = 1;
  std::uint32_t frames = 0;
  std::uint16_t bits = 16;
  double rate = 8000;
  std::uint32_t offset = 0;  ///< of the first sample in its chunk
  std::string data{};
  std::string more_chunks{};  ///< between description and samples

  static std::string chunk(const std::string& name, const std::string& content) {
    std::string bytes = name + number(static_cast<std::uint32_t>(content.size())) + content;
    if (bytes.size() % 2 != 0) bytes += '\0';
    return bytes;
  }

  std::string bytes() const {
    int exponent = 0;
    const double mantissa = std::frexp(rate, &exponent);  // 0.5 to 1
    std::string description = number(channels) + number(frames) + number(bits) +
                              number(static_cast<std::uint16_t>(rate == 0 ? 0 : exponent + 16382)) +
                              number(static_cast<std::uint64_t>(std::ldexp(mantissa, 64)));
    if (!coding.empty()) description += coding + std::string(2, '\0');
    const std::string body =
        (coding.empty() ? "AIFF" : "AIFC") + chunk("COMM", description) + more_chunks +
        chunk("SSND", number(offset) + number(std::uint32_t{0}) + std::string(offset, 'x') + data);
    return "FORM" + number(static_cast<std::uint32_t>(body.size())) + body;
  }

 private:
  template <typename Number>
  static std::string number(Number value) {
    return bytes_of_number(value, true);
  }
};

inline std::vector<std::string> aiff_seeds() {
  std::vector<std::string> seeds;
  AiffFile aiff;
  aiff.channels = 2;
  aiff.frames = 2;
  aiff.data = std::string("\x7F\0\x80\0\0\1\0\2", 8);
  aiff.more_chunks = AiffFile::chunk("NAME", "run 7");
  seeds.push_back(aiff.bytes());
  for (const char* coding : {"NONE", "sowt", "raw ", "in24", "fl32"}) {
    aiff.coding = coding;
    aiff.bits = aiff.coding == "raw " ? 8 : 16;
    aiff.data = std::string(16, '\x3F');
    aiff.offset = 2;
    seeds.push_back(aiff.bytes());
  }
  aiff.frames = 0;
  std::string stopped = aiff.bytes();
  stopped.replace(stopped.find("SSND") + 4, 4, std::string("\0\0\0\x0A", 4));
  stopped.replace(4, 4, 4, '\0');
  seeds.push_back(stopped);
  return seeds;
}

}  // namespace impactrig::acquisition::tests
