// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace impactrig::acquisition::tests {

/// A WAVE file, written from its fields [Microsoft and IBM, "Multimedia Programming Interface and
/// Data Specifications 1.0", 1991; RF64: EBU Tech 3306].
struct WavFile {
  std::uint16_t format = 1;  ///< 1 PCM, 3 floating point, 6 A-law, 7 u-law, 0xFFFE extensible
  std::uint16_t channels = 1;
  std::uint16_t bits = 16;
  std::uint32_t rate = 8000;
  bool big_endian = false;  ///< RIFX
  bool rf64 = false;
  std::string data;
  std::string more_chunks{};  ///< between format and data

  template <typename Number>
  std::string number(Number value) const {
    std::string bytes(sizeof(Number), '\0');
    std::memcpy(bytes.data(), &value, sizeof(Number));
    if (big_endian) std::ranges::reverse(bytes);  // the machines of the tests are little-endian
    return bytes;
  }

  template <typename Number>
  std::string numbers(const std::vector<Number>& values) const {
    std::string bytes;
    for (const Number value : values) bytes += number(value);
    return bytes;
  }

  std::string chunk(const std::string& name, const std::string& content) const {
    std::string bytes = name + number(static_cast<std::uint32_t>(content.size())) + content;
    if (bytes.size() % 2 != 0) bytes += '\0';
    return bytes;
  }

  std::string bytes() const {
    const auto frame = static_cast<std::uint16_t>(channels * ((bits + 7) / 8));
    std::string description = number(format) + number(channels) + number(rate) +
                              number(static_cast<std::uint32_t>(rate * frame)) + number(frame) +
                              number(bits);
    if (format == 0xFFFE)  // 22 more bytes: valid bits, speakers, and PCM as a GUID
      description += number<std::uint16_t>(22) + number(bits) + number<std::uint32_t>(0) +
                     number<std::uint32_t>(1) + number<std::uint16_t>(0) +
                     number<std::uint16_t>(16) + std::string("\x80\0\0\xAA\0\x38\x9B\x71", 8);
    std::string body = "WAVE";
    if (rf64)
      body += chunk("ds64", number<std::uint64_t>(0) + number<std::uint64_t>(data.size()) +
                                number<std::uint64_t>(data.size() / std::max(1, int{frame})) +
                                number<std::uint32_t>(0));
    body += chunk("fmt ", description) + more_chunks + chunk("data", data);
    if (rf64) body.replace(body.find("data") + 4, 4, "\xFF\xFF\xFF\xFF");
    const std::uint32_t size = rf64 ? 0xFFFFFFFF : static_cast<std::uint32_t>(body.size());
    return (big_endian ? "RIFX" : rf64 ? "RF64" : "RIFF") + number(size) + body;
  }
};

/// The same in chunks of Wave64, of 8 bytes a multiple.
inline std::string wave64_of(const WavFile& wav) {
  const std::string all = wav.bytes();
  const std::string name("\xF3\xAC\xD3\x11\x8C\xD1\0\xC0\x4F\x8E\xDB\x8A", 12);
  const auto chunk = [&](const std::string& letters, const std::string& content) {
    return letters + name + wav.number<std::uint64_t>(24 + content.size()) + content +
           std::string((8 - content.size() % 8) % 8, '\0');
  };
  const std::string body = chunk("fmt ", all.substr(20, 16)) + chunk("data", wav.data);
  return std::string("riff\x2E\x91\xCF\x11\xA5\xD6\x28\xDB\x04\xC1\0\0", 16) +
         wav.number<std::uint64_t>(40 + body.size()) + "wave" + name + body;
}

inline std::vector<std::string> wav_seeds() {
  std::vector<std::string> seeds;
  for (const bool big : {false, true}) {
    WavFile wav;
    wav.big_endian = big;
    wav.channels = 2;
    wav.data = wav.numbers<std::int16_t>({1, -2, 300, -400});
    wav.more_chunks = wav.chunk("LIST", "INFO" + wav.chunk("INAM", "name"));
    seeds.push_back(wav.bytes());
    wav.bits = 24;
    wav.data = std::string(12, '\x7F');
    seeds.push_back(wav.bytes());
    wav.format = 3;
    wav.bits = 32;
    wav.data = wav.numbers<float>({1, -2, 0.5F, 0.25F});
    seeds.push_back(wav.bytes());
    wav.bits = 64;
    wav.data = wav.numbers<double>({1, -2, 0.5, 0.25});
    seeds.push_back(wav.bytes());
  }
  WavFile wav;
  wav.bits = 8;
  wav.data = "\x80\xFF\x01\x02";
  seeds.push_back(wav.bytes());
  seeds.push_back(wave64_of(wav));
  wav.rf64 = true;
  seeds.push_back(wav.bytes());
  wav.rf64 = false;
  wav.format = 0xFFFE;
  wav.bits = 32;
  seeds.push_back(wav.bytes());
  wav.format = 7;
  wav.bits = 8;
  seeds.push_back(wav.bytes());
  std::string uncounted = wav.bytes();
  uncounted.replace(uncounted.find("data") + 4, 4, 4, '\0');
  seeds.push_back(uncounted);
  return seeds;
}

}  // namespace impactrig::acquisition::tests
