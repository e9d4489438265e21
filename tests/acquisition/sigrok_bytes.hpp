// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

namespace impactrig::acquisition::tests {

/// Numbers as they lie in a little-endian file.
template <typename Number>
std::string little(Number value) {
  std::string bytes(sizeof(Number), '\0');
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof(Number));
  for (char& byte : bytes) {
    byte = static_cast<char>(bits & 0xFF);
    bits >>= 8;
  }
  return bytes;
}

template <typename Number>
std::string little(const std::vector<Number>& values) {
  std::string bytes;
  for (const Number value : values) bytes += little(value);
  return bytes;
}

/// One file of an archive [PKWARE, APPNOTE.TXT].
struct ZipEntry {
  std::string name;
  std::string content;
  bool deflated = false;
  std::optional<std::uint32_t> declared_size{};  ///< where it lies
  std::uint16_t method = 0;                      ///< where it is neither stored nor deflated
  std::uint16_t flags = 0;                       ///< 1: encrypted
};

inline std::string deflated(const std::string& content) {
  z_stream z{};
  deflateInit2(&z, Z_DEFAULT_COMPRESSION, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
  std::string packed(deflateBound(&z, content.size()), '\0');
  std::string source = content;
  z.next_in = reinterpret_cast<Bytef*>(source.data());
  z.avail_in = static_cast<uInt>(source.size());
  z.next_out = reinterpret_cast<Bytef*>(packed.data());
  z.avail_out = static_cast<uInt>(packed.size());
  deflate(&z, Z_FINISH);
  packed.resize(z.total_out);
  deflateEnd(&z);
  return packed;
}

inline std::string zip_archive(const std::vector<ZipEntry>& entries) {
  std::string bytes;
  std::string directory;
  for (const ZipEntry& entry : entries) {
    const std::string packed = entry.deflated ? deflated(entry.content) : entry.content;
    const auto* const content = reinterpret_cast<const Bytef*>(entry.content.data());
    const auto sum =
        static_cast<std::uint32_t>(crc32(0, content, static_cast<uInt>(entry.content.size())));
    const std::uint16_t method = entry.deflated ? std::uint16_t{8} : entry.method;
    const std::string fields =
        little<std::uint16_t>(20) + little(entry.flags) + little(method) +
        little<std::uint32_t>(0x00210000) + little(sum) +
        little(static_cast<std::uint32_t>(packed.size())) +
        little(entry.declared_size.value_or(static_cast<std::uint32_t>(entry.content.size()))) +
        little(static_cast<std::uint16_t>(entry.name.size())) + little<std::uint16_t>(0);
    directory += "PK\x01\x02" + little<std::uint16_t>(20) + fields + little<std::uint16_t>(0) +
                 little<std::uint16_t>(0) + little<std::uint16_t>(0) + little<std::uint32_t>(0) +
                 little(static_cast<std::uint32_t>(bytes.size())) + entry.name;
    bytes += "PK\x03\x04" + fields + entry.name + packed;
  }
  const auto count = static_cast<std::uint16_t>(entries.size());
  return bytes + directory + "PK\x05\x06" + little<std::uint32_t>(0) + little(count) +
         little(count) + little(static_cast<std::uint32_t>(directory.size())) +
         little(static_cast<std::uint32_t>(bytes.size())) + little<std::uint16_t>(0);
}

constexpr const char* sigrok_metadata =
    "[global]\nsigrok version=0.5.2\n\n[device 1]\nsamplerate=200 kHz\ntotal analog=2\n"
    "analog1=A0\nanalog2=A1\n";

/// A session of two channels, the first in two parts.
inline std::vector<ZipEntry> sigrok_entries(bool packed) {
  return {
      {"version", "2"},
      {"metadata", sigrok_metadata, packed},
      {"analog-1-2-1", little<float>({7, 8, 9, 10}), packed},
      {"analog-1-1-2", little<float>(4), packed},
      {"analog-1-1-1", little<float>({1.5F, 2, 3}), packed},
  };
}

inline std::vector<std::string> sigrok_seeds() {
  std::vector<ZipEntry> logic = sigrok_entries(true);
  logic.push_back({"logic-1-1", "\1\2\3", true});
  return {zip_archive(sigrok_entries(false)), zip_archive(sigrok_entries(true)),
          zip_archive(logic)};
}

}  // namespace impactrig::acquisition::tests
