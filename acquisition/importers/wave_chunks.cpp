// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/wave_chunks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

namespace impactrig::acquisition {

namespace {

constexpr std::uint32_t said_elsewhere = 0xFFFFFFFF;  ///< sizes in RF64
constexpr std::uint64_t most_said = std::uint64_t{1} << 62;
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

/// Names of chunks that stand beside the samples [the sources above; EBU Tech 3285, 3306; ID3v2].
constexpr std::array<std::string_view, 26> known_names = {
    "LIST", "list", "fact", "cue ", "smpl", "inst", "plst", "id3 ", "ID3 ",
    "bext", "iXML", "axml", "chna", "_PMX", "PEAK", "JUNK", "junk", "FLLR",
    "PAD ", "DISP", "acid", "strc", "cart", "levl", "umid", "link"};

/// Where a chunk may begin: it has a name and is whole, or is the samples', or one cut off.
bool may_begin(std::string_view bytes, std::size_t at, bool big_endian) {
  const auto chunk = chunk_at(bytes, at, big_endian);
  if (!chunk || !chunk->is_named()) return false;
  return chunk->is_whole() || chunk->name == "data" ||
         std::ranges::find(known_names, chunk->name) != known_names.end();
}

/// Where the chunk behind content that ends at `end` begins: at an even distance, or, where no
/// chunk is there, at the content's end, of writers that leave out the byte that fills it up.
std::size_t next_chunk(std::string_view bytes, std::size_t end, bool is_odd, bool big_endian) {
  if (!is_odd || end >= bytes.size()) return std::min(end, bytes.size());
  if (!may_begin(bytes, end + 1, big_endian) && may_begin(bytes, end, big_endian)) return end;
  return end + 1;
}

/// Where the chunks begin that end the file, behind samples whose size is not stated; none: its
/// size. They are looked for in its last MiB.
std::size_t last_chunks(std::string_view bytes, std::size_t samples, bool big_endian) {
  constexpr std::size_t looked_at = std::size_t{1} << 20;
  const std::size_t from = std::max(samples, bytes.size() - std::min(bytes.size(), looked_at));
  std::vector<bool> passed(bytes.size() - from);  // each place is looked at once
  const auto ends_file = [&](std::size_t at) {
    while (const auto chunk = chunk_at(bytes, at, big_endian)) {
      if (!chunk->is_named() || !chunk->is_whole() || passed[at - from]) return false;
      passed[at - from] = true;
      at = chunk->end;
    }
    return at == bytes.size();
  };
  std::size_t first = bytes.size();
  for (std::size_t at = from; at + 8 <= bytes.size() && first == bytes.size(); ++at)
    if (std::ranges::find(known_names, bytes.substr(at, 4)) != known_names.end() && ends_file(at))
      first = at;
  return first;
}

class Finder {
 public:
  explicit Finder(std::string_view bytes) : bytes_(bytes) {
    found_.big_endian = bytes.starts_with("RIFX");
  }

  WaveChunks find() {
    const bool is_long = bytes_.starts_with("RF64") || bytes_.starts_with("BW64");
    const auto declared = number_at<std::uint32_t>(bytes_, 4, found_.big_endian);
    if (!is_long && declared != said_elsewhere) found_.declared_bytes = declared + std::uint64_t{8};
    std::size_t at = 12;
    while (const auto chunk = chunk_at(bytes_, at, found_.big_endian)) {
      if (chunk->name == "data") {
        at = take_samples(*chunk);
        // a head that counts too few bytes of the file does not tell the last ones that are cut
        constexpr std::uint64_t a_few = 65536;
        const std::uint64_t end = chunk->at + std::uint64_t{8} + chunk->size;
        if (found_.data_chunks == 1 && end > bytes_.size() && end - bytes_.size() < a_few)
          found_.declared_bytes = std::max(found_.declared_bytes, end);
      } else if (chunk->is_named() && chunk->is_whole()) {
        take(*chunk);
        at = next_chunk(bytes_, chunk->at + 8 + chunk->size, chunk->size % 2 != 0,
                        found_.big_endian);
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
    if (chunk.name == "ds64" && chunk.size >= 16) {
      long_file_ = number_at<std::uint64_t>(chunk.content, 0, found_.big_endian);
      long_size_ = number_at<std::uint64_t>(chunk.content, 8, found_.big_endian);
    }
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
    // of 64 bits the size of the file may be left at 0: it has at least the samples
    if (chunk.size == said_elsewhere && long_size_.value_or(0) > rest)
      found_.declared_bytes =
          std::max(long_file_, found_.samples + std::min(*long_size_, most_said) - 8) + 8;
    const std::uint64_t said =
        chunk.size == said_elsewhere ? long_size_.value_or(rest) : std::uint64_t{chunk.size};
    found_.sample_bytes = std::min(said, rest);
    const bool is_stated = chunk.size != said_elsewhere || long_size_.has_value();
    if (said == 0 && rest > 0 && !are_chunks(bytes_, found_.samples, found_.big_endian))
      found_.sample_bytes = found_.uncounted = to_last_chunks();
    else if (said > rest || !is_stated)
      found_.sample_bytes = to_last_chunks();
    else
      take_what_is_behind();
    return next_chunk(bytes_, static_cast<std::size_t>(found_.samples + found_.sample_bytes),
                      found_.sample_bytes % 2 != 0, found_.big_endian);
  }

  std::uint64_t to_last_chunks() const {
    return last_chunks(bytes_, found_.samples, found_.big_endian) - found_.samples;
  }

  /// Samples that the header does not count, where no chunk follows those that it does and the
  /// file is longer than it declares: a recorder that lost its power between two updates of the
  /// header, or a file whose sizes went beyond 32 bits.
  void take_what_is_behind() {
    const std::uint64_t counted = found_.sample_bytes;
    const auto end = static_cast<std::size_t>(found_.samples + counted);
    const std::size_t next = next_chunk(bytes_, end, counted % 2 != 0, found_.big_endian);
    if (bytes_.size() < next + 8 || is_foreign(bytes_.substr(next)) ||
        may_begin(bytes_, next, found_.big_endian))
      return;
    const std::uint64_t stated = number_at<std::uint32_t>(bytes_, 4, found_.big_endian);
    const std::uint64_t declared = 8 + (stated == said_elsewhere ? long_file_ : stated);
    if (declared >= bytes_.size()) {
      found_.warnings.push_back(
          fmt::format("the {} bytes behind the {} bytes of samples are no chunk: they are left out",
                      bytes_.size() - next, counted));
      return;
    }
    found_.sample_bytes = beyond_32_bits(counted).value_or(to_last_chunks());
    found_.warnings.push_back(fmt::format(
        "the header counts {} bytes of samples and declares a file of {} bytes, but no chunk "
        "follows them and the file has {}, as of a recorder that lost its power or a file of more "
        "than 4 GiB: {} bytes are read as samples",
        counted, declared, bytes_.size(), found_.sample_bytes));
  }

  /// The size of samples whose lower 32 bits are stated: one with which they end at the file's end
  /// or at the chunks that end it.
  std::optional<std::uint64_t> beyond_32_bits(std::uint64_t stated) const {
    constexpr std::uint64_t more = std::uint64_t{1} << 32;
    for (std::uint64_t size = stated + more; found_.samples + size <= bytes_.size(); size += more) {
      const auto end = static_cast<std::size_t>(found_.samples + size);
      if (end + size % 2 >= bytes_.size()) return size;
      if (may_begin(bytes_, next_chunk(bytes_, end, size % 2 != 0, found_.big_endian),
                    found_.big_endian))
        return size;
    }
    return std::nullopt;
  }

  /// True for what others than the recorder put behind a file: texts of an ID3 or APE tag, or
  /// zeros that fill up a sector.
  static bool is_foreign(std::string_view behind) {
    if (behind.starts_with("TAG") && behind.size() == 128) return true;
    if (behind.starts_with("ID3") || behind.starts_with("APETAGEX")) return true;
    constexpr std::size_t sector = 4096;
    return behind.size() < sector && behind.find_first_not_of('\0') == std::string_view::npos;
  }

  /// Tells of a chunk that is longer than the file or has no name. Returns where the samples begin
  /// behind it, none where there are no others.
  std::optional<std::size_t> behind_damage(const Chunk& chunk) {
    if (chunk.is_list()) tell_list(chunk);
    if (found_.data_chunks > 0) return std::nullopt;
    const std::size_t next = samples_behind(chunk.at + 8);
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

  /// The next word "data" that begins a chunk: one that is whole and ends the file or that
  /// another follows, else one whose size is no text, as that of a comment is.
  std::size_t samples_behind(std::size_t from) const {
    constexpr std::size_t none = std::string_view::npos;
    std::size_t possible = none;
    for (std::size_t at = bytes_.find("data", from); at != none; at = bytes_.find("data", at + 1)) {
      const auto chunk = chunk_at(bytes_, at, found_.big_endian);
      if (!chunk) break;
      const std::size_t end = at + 8 + chunk->content.size();
      if (chunk->is_whole() && chunk->size > 0 &&
          (chunk->end == bytes_.size() ||
           may_begin(bytes_, next_chunk(bytes_, end, chunk->size % 2 != 0, found_.big_endian),
                     found_.big_endian)))
        return at;
      const std::string_view size = bytes_.substr(at + 4, 4);
      const bool is_text = std::ranges::all_of(size, [](char c) { return c >= ' ' && c <= '~'; });
      if (possible == none && !is_text) possible = at;
    }
    return possible;
  }

  void tell_list(const Chunk& list) {
    found_.warnings.push_back(fmt::format(
        "the list at byte {} is damaged, its parts do not fit into it: it is left out", list.at));
  }

  std::string_view bytes_;
  WaveChunks found_;
  std::optional<std::uint64_t> long_size_;  ///< of the samples, of RF64
  std::uint64_t long_file_ = 0;             ///< of the file but 8 bytes, of RF64
};

// Names of Wave64 are GUIDs: four letters, and what is the same of all but the first.
constexpr std::string_view wave64_riff("\x2E\x91\xCF\x11\xA5\xD6\x28\xDB\x04\xC1\0\0", 12);
constexpr std::string_view wave64_name("\xF3\xAC\xD3\x11\x8C\xD1\0\xC0\x4F\x8E\xDB\x8A", 12);
constexpr std::size_t wave64_head = 40;
constexpr std::size_t wave64_chunk_head = 24;  ///< which a chunk's size counts

/// A chunk that is shorter than its head, or longer than the file, ends it.
WaveChunks wave64_chunks(std::string_view bytes) {
  WaveChunks found;
  found.declared_bytes = number_at<std::uint64_t>(bytes, 16, false);
  std::size_t at = wave64_head;
  while (bytes.size() - at >= wave64_chunk_head) {
    const std::string_view name = bytes.substr(at, 4);
    const bool is_known = bytes.substr(at + 4, 12) == wave64_name;
    const auto size = number_at<std::uint64_t>(bytes, at + 16, false);
    const std::uint64_t said = size - std::min<std::uint64_t>(size, wave64_chunk_head);
    const std::string_view content = bytes.substr(at + wave64_chunk_head, said);
    if (is_known && name == "fmt " && found.format.empty()) found.format = content;
    if (is_known && name == "bext" && found.broadcast.empty()) found.broadcast = content;
    if (is_known && name == "data" && ++found.data_chunks == 1) {
      found.samples = at + wave64_chunk_head;
      found.sample_bytes = content.size();
      // as a recorder leaves it that was stopped
      if (said == 0 && found.declared_bytes <= found.samples)
        found.sample_bytes = found.uncounted = bytes.size() - found.samples;
    }
    const std::uint64_t next = (size + 7) / 8 * 8;
    if (size < wave64_chunk_head || size > bytes.size() - at || next > bytes.size() - at) break;
    at += next;
  }
  return found;
}

}  // namespace

bool is_wave(std::string_view head) {
  const bool riff = head.starts_with("RIFF") || head.starts_with("RIFX") ||
                    head.starts_with("RF64") || head.starts_with("BW64");
  return riff && head.size() >= 12 && head.substr(8, 4) == "WAVE";
}

bool is_wave64(std::string_view head) {
  return head.size() >= wave64_head && head.starts_with("riff" + std::string(wave64_riff)) &&
         head.substr(24, 16) == "wave" + std::string(wave64_name);
}

WaveChunks wave_chunks(std::string_view bytes) {
  if (is_wave64(bytes)) return wave64_chunks(bytes);
  return is_wave(bytes) ? Finder(bytes).find() : WaveChunks();
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
