// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/wave_chunks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

namespace impactrig::acquisition {

namespace {

constexpr std::uint32_t said_elsewhere = 0xFFFFFFFF;  ///< sizes in RF64
/// Longer ones libsndfile does not keep.
constexpr std::size_t longest_text = 2047;
constexpr std::size_t most_texts = 256;

template <typename Number>
Number number_at(std::string_view bytes, std::size_t at, bool big_endian) {
  Number number = 0;
  for (std::size_t i = 0; i < sizeof(Number); ++i)
    number = static_cast<Number>(
        number << 8 |
        static_cast<unsigned char>(bytes[at + (big_endian ? i : sizeof(Number) - 1 - i)]));
  return number;
}

template <typename Number>
std::string written(Number number, bool big_endian) {
  std::string bytes(sizeof(Number), '\0');
  for (std::size_t i = 0; i < sizeof(Number); ++i)
    bytes[big_endian ? sizeof(Number) - 1 - i : i] = static_cast<char>(number >> 8 * i & 0xFF);
  return bytes;
}

struct Chunk {
  std::string_view name;
  std::uint32_t size = 0;    ///< as its head has it
  std::string_view content;  ///< what of it is there
  std::size_t at = 0;
  std::size_t end = 0;  ///< where the next one begins

  bool is_whole() const { return content.size() == size; }

  bool is_named() const {
    return std::ranges::all_of(name, [](char c) { return c >= ' ' && c <= '~'; });
  }

  bool is_list() const { return name == "LIST" || name == "list"; }
};

std::optional<Chunk> chunk_at(std::string_view bytes, std::size_t at, bool big_endian) {
  if (at > bytes.size() || bytes.size() - at < 8) return std::nullopt;
  Chunk chunk;
  chunk.name = bytes.substr(at, 4);
  chunk.size = number_at<std::uint32_t>(bytes, at + 4, big_endian);
  chunk.content = bytes.substr(at + 8, chunk.size);
  chunk.at = at;
  chunk.end = std::min(at + 8 + std::size_t{chunk.size} + chunk.size % 2, bytes.size());
  return chunk;
}

/// True where the bytes from `at` on are chunks that follow each other.
bool are_chunks(std::string_view bytes, std::size_t at, bool big_endian) {
  while (const auto chunk = chunk_at(bytes, at, big_endian)) {
    if (!chunk->is_named() || !chunk->is_whole()) return false;
    at = chunk->end;
  }
  return true;
}

class Finder {
 public:
  explicit Finder(std::string_view bytes) : bytes_(bytes) {
    found_.big_endian = bytes.starts_with("RIFX");
  }

  WaveChunks find() {
    std::size_t at = 12;
    while (const auto chunk = chunk_at(bytes_, at, found_.big_endian)) {
      if (chunk->name == "data") {
        at = take_samples(*chunk);
      } else if (chunk->is_named() && chunk->is_whole()) {
        take(*chunk);
        at = chunk->end;
      } else if (const auto next = behind_damage(*chunk)) {
        at = *next;
      } else {
        break;
      }
    }
    return std::move(found_);
  }

 private:
  void take(const Chunk& chunk) {
    if (chunk.name == "fmt " && found_.format.empty()) found_.format = chunk.content;
    if (chunk.name == "bext" && found_.broadcast.empty()) found_.broadcast = chunk.content;
    if (chunk.name == "ds64" && chunk.size >= 16)
      long_size_ = number_at<std::uint64_t>(chunk.content, 8, found_.big_endian);
    if (chunk.is_list()) take_texts(chunk);
  }

  void take_texts(const Chunk& list) {
    if (list.size < 4 || !are_chunks(list.content, 4, found_.big_endian)) return tell_list(list);
    if (!list.content.starts_with("INFO")) return;
    std::size_t at = 4;
    while (const auto text = chunk_at(list.content, at, found_.big_endian)) {
      if (text->name.starts_with('I') && text->name != "INFO" && text->size <= longest_text &&
          found_.texts.size() < most_texts)
        found_.texts.push_back(list.content.substr(at, 8 + text->size));
      at = text->end;
    }
  }

  /// Returns where the next chunk begins.
  std::size_t take_samples(const Chunk& chunk) {
    if (++found_.data_chunks > 1) return chunk.end;
    found_.samples = chunk.at + 8;
    const std::uint64_t rest = bytes_.size() - found_.samples;
    const std::uint64_t said =
        chunk.size == said_elsewhere ? long_size_.value_or(rest) : std::uint64_t{chunk.size};
    found_.sample_bytes = std::min(said, rest);
    if (said == 0 && rest > 0 && !are_chunks(bytes_, found_.samples, found_.big_endian))
      found_.sample_bytes = found_.uncounted = rest;
    return static_cast<std::size_t>(found_.samples + found_.sample_bytes + found_.sample_bytes % 2);
  }

  /// Tells of a chunk that is longer than the file or has no name. Returns where the samples begin
  /// behind it, none where there are no others.
  std::optional<std::size_t> behind_damage(const Chunk& chunk) {
    if (chunk.is_list()) tell_list(chunk);
    if (found_.data_chunks > 0) return std::nullopt;
    const std::size_t next = bytes_.find("data", chunk.at + 8);
    if (chunk.name == "fmt " && found_.format.empty())
      found_.format = bytes_.substr(chunk.at + 8, next - std::min(next, chunk.at + 8));
    if (next == std::string_view::npos) return std::nullopt;
    if (!chunk.is_list())
      found_.warnings.push_back(fmt::format(
          "the chunk at byte {} is damaged: what follows the next word 'data', at byte {}, is "
          "taken for the samples",
          chunk.at, next));
    return next;
  }

  void tell_list(const Chunk& list) {
    found_.warnings.push_back(fmt::format(
        "the list at byte {} is damaged, its parts do not fit into it: it is left out", list.at));
  }

  std::string_view bytes_;
  WaveChunks found_;
  std::optional<std::uint64_t> long_size_;  ///< of the samples, of RF64
};

}  // namespace

bool is_wave(std::string_view head) {
  const bool riff =
      head.starts_with("RIFF") || head.starts_with("RIFX") || head.starts_with("RF64");
  return riff && head.size() >= 12 && head.substr(8, 4) == "WAVE";
}

WaveChunks wave_chunks(std::string_view bytes) {
  return Finder(bytes).find();
}

std::string undamaged_head(const WaveChunks& chunks) {
  const auto number = [&](auto value) { return written(value, chunks.big_endian); };
  const auto chunk = [&](std::string_view name, std::string_view content) {
    // even: of RF64, libsndfile does not pass over what fills up odd ones
    std::string filled(content);
    if (content.size() % 2 != 0) filled += '\0';
    return std::string(name) + number(static_cast<std::uint32_t>(filled.size())) + filled;
  };
  std::string body;
  if (!chunks.format.empty()) body += chunk("fmt ", chunks.format);
  if (!chunks.broadcast.empty()) body += chunk("bext", chunks.broadcast);
  if (!chunks.texts.empty()) {
    std::string texts = "INFO";
    for (const std::string_view text : chunks.texts) {
      texts += text;
      if (text.size() % 2 != 0) texts += '\0';
    }
    body += chunk("LIST", texts);
  }
  // as RF64, sizes may be of 64 bits
  const std::uint64_t all = 4 + body.size() + 8 + chunks.sample_bytes;
  const bool is_long = all >= said_elsewhere;
  const auto size = [&](std::uint64_t bytes) {
    return number(is_long ? said_elsewhere : static_cast<std::uint32_t>(bytes));
  };
  if (is_long)
    body.insert(0, chunk("ds64", number(all + 36) + number(chunks.sample_bytes) +
                                     number(std::uint64_t{0}) + number(std::uint32_t{0})));
  if (chunks.data_chunks > 0) body += "data" + size(chunks.sample_bytes);
  const std::string_view name = is_long ? "RF64" : chunks.big_endian ? "RIFX" : "RIFF";
  return std::string(name) + size(all) + "WAVE" + body;
}

}  // namespace impactrig::acquisition
