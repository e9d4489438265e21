// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/packed_mat.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <list>
#include <new>
#include <string_view>

#include "datasets/input_error.hpp"

namespace impactrig::acquisition {

using datasets::FileError;
using datasets::InputError;

namespace {

constexpr std::uint64_t most_kept = std::uint64_t{256} << 20;  ///< of one file [bytes]
constexpr std::uint64_t most_expansion = 1032;                 ///< what deflate can make of a byte
constexpr std::uint64_t longest_number_kept = 4096;            ///< of an element [bytes]
constexpr std::uint64_t longest_text_kept = std::uint64_t{1} << 20;

/// Inflates from the start of a part of a file on.
class Inflater {
 public:
  Inflater(const MappedFile& file, FilePart packed) : file_(file), packed_(packed) {
    if (inflateInit(&z_) != Z_OK) throw std::bad_alloc();
  }

  ~Inflater() { inflateEnd(&z_); }

  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  std::uint64_t position() const { return position_; }

  /// The next bytes; fewer than asked for where the data end or are damaged.
  std::uint64_t read(char* to, std::uint64_t count) {
    std::uint64_t got = 0;
    while (got < count && state_ == Z_OK) {
      if (z_.avail_in == 0) refill();
      const auto room =
          static_cast<uInt>(std::min<std::uint64_t>(count - got, std::uint64_t{1} << 30));
      z_.next_out = reinterpret_cast<Bytef*>(to + got);
      z_.avail_out = room;
      state_ = inflate(&z_, Z_NO_FLUSH);
      got += room - z_.avail_out;
    }
    position_ += got;
    return got;
  }

  /// False where more than padding is left, or the checksum behind the bytes is not theirs. One
  /// that the file's end cuts off tells nothing.
  bool ends_well() {
    std::array<char, 8> padding;
    return read(padding.data(), padding.size()) < padding.size() && state_ != Z_DATA_ERROR;
  }

  /// Passes over bytes; false when they are not there.
  bool skip_to(std::uint64_t position) {
    std::array<char, 65536> passed;
    while (position_ < position)
      if (read(passed.data(), std::min<std::uint64_t>(passed.size(), position - position_)) == 0)
        return false;
    return true;
  }

 private:
  void refill() {
    const std::uint64_t count =
        std::min<std::uint64_t>(source_.size(), packed_.last - packed_.first);
    file_.copy(packed_.first, count, source_.data());
    packed_.first += count;
    z_.next_in = reinterpret_cast<Bytef*>(source_.data());
    z_.avail_in = static_cast<uInt>(count);
  }

  const MappedFile& file_;
  FilePart packed_;
  std::array<char, 65536> source_;
  z_stream z_{};
  int state_ = Z_OK;
  std::uint64_t position_ = 0;
};

std::uint32_t word_at(const char* bytes, bool big_endian) {
  const auto byte = [&](std::size_t i) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[big_endian ? 3 - i : i]));
  };
  return byte(0) | byte(1) << 8 | byte(2) << 16 | byte(3) << 24;
}

/// Room for all that is inflated, of which only pages that are written take memory.
class SparseBytes {
 public:
  SparseBytes(const std::string& path, std::uint64_t size) : size_(size) {
    if (size == 0) return;
    void* const memory = ::mmap(nullptr, size, PROT_READ | PROT_WRITE,
                                MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (memory == MAP_FAILED)
      throw FileError(path,
                      fmt::format("its arrays, {} bytes once they are inflated, cannot be laid "
                                  "out: {}",
                                  size, std::strerror(errno)));
    bytes_ = static_cast<char*>(memory);
  }

  ~SparseBytes() {
    if (size_ > 0) ::munmap(bytes_, size_);
  }

  SparseBytes(const SparseBytes&) = delete;
  SparseBytes& operator=(const SparseBytes&) = delete;

  char* bytes() const { return bytes_; }

 private:
  char* bytes_ = nullptr;
  std::uint64_t size_;
};

/// Where an element's bytes come from.
struct Source {
  FilePart place;  ///< among the inflated bytes
  FilePart from;   ///< in the file
  bool compressed = false;
};

/// Bytes of the file as it would be without compression.
class Inflated final : public ByteSource {
 public:
  Inflated(std::unique_ptr<MappedFile> file, std::uint64_t size)
      : file_(std::move(file)),
        kept_(file_->path(), size) {}

  const MappedFile& file() const { return *file_; }

  char* kept() const { return kept_.bytes(); }

  void add(const Source& source) { sources_.push_back(source); }

  void copy(std::size_t offset, std::size_t count, void* to) override {
    auto* at = static_cast<char*>(to);
    while (count > 0) {
      auto source = std::ranges::upper_bound(
          sources_, offset, {}, [](const Source& candidate) { return candidate.place.last; });
      if (source == sources_.end() || offset < source->place.first)
        throw FileError(file_->path(), "is read beyond its end");
      const std::uint64_t within = offset - source->place.first;
      const std::uint64_t step = std::min<std::uint64_t>(count, source->place.last - offset);
      if (source->compressed)
        inflate_part(*source, within, step, at);
      else
        file_->copy(source->from.first + within, step, at);
      at += step;
      offset += step;
      count -= step;
    }
  }

  bool only_forward() const override { return true; }

 private:
  struct Open {
    const Source* source;
    std::unique_ptr<Inflater> inflater;
  };

  /// Goes on where an inflater stands that is not yet past the place.
  void inflate_part(const Source& source, std::uint64_t first, std::uint64_t count, char* to) {
    auto best = open_.end();
    for (auto it = open_.begin(); it != open_.end(); ++it)
      if (it->source == &source && it->inflater->position() <= first &&
          (best == open_.end() || it->inflater->position() > best->inflater->position()))
        best = it;
    if (best == open_.end()) {
      if (open_.size() >= most_open) open_.pop_back();
      open_.push_front({&source, std::make_unique<Inflater>(*file_, source.from)});
    } else {
      open_.splice(open_.begin(), open_, best);
    }
    Inflater& inflater = *open_.front().inflater;
    if (!inflater.skip_to(first) || inflater.read(to, count) < count)
      throw FileError(file_->path(), "has changed while it was read");
  }

  static constexpr std::size_t most_open = 6;  // values, imaginary parts, times, marks of a channel

  std::unique_ptr<MappedFile> file_;
  SparseBytes kept_;
  std::vector<Source> sources_;
  std::list<Open> open_;
};

/// Inflates one array and keeps its tags, its small elements and its texts.
class Skeleton {
 public:
  Skeleton(const MappedFile& file, const MatElement& element, bool big_endian, char* to,
           std::uint64_t room, std::uint64_t& kept)
      : file_(file),
        element_(element),
        big_endian_(big_endian),
        inflater_(file, element.packed),
        to_(to),
        room_(room),
        kept_(kept) {}

  /// Whether the array ends where walk() did.
  bool ends_well() { return inflater_.ends_well(); }

  /// Returns how many bytes there are.
  std::uint64_t walk() {
    std::uint32_t class_number = 0;
    while (keep(8)) {
      const char* const tag = to_ + inflater_.position() - 8;
      const std::uint32_t first = word_at(tag, big_endian_);
      if (first >> 16 != 0) continue;  // an element within its tag
      const std::uint64_t size = word_at(tag + 4, big_endian_);
      if (first == array_type) continue;  // its elements follow
      const std::uint64_t next = inflater_.position() + (size + 7) / 8 * 8;
      const bool texts = class_number == structure_class || class_number == text_class;
      if (!keep(std::min(size, texts                         ? longest_text_kept
                               : size <= longest_number_kept ? size
                                                             : std::uint64_t{0})))
        break;
      if (first == flags_type && size == 8)
        class_number = word_at(to_ + inflater_.position() - 8, big_endian_) & 0xFF;
      if (!inflater_.skip_to(std::min(next, room_))) break;
    }
    return inflater_.position();
  }

 private:
  static constexpr std::uint32_t array_type = 14;
  static constexpr std::uint32_t flags_type = 6;
  static constexpr std::uint32_t structure_class = 2;
  static constexpr std::uint32_t text_class = 4;

  /// Puts the next bytes where they belong; false when they are not all there.
  bool keep(std::uint64_t count) {
    const std::uint64_t at = inflater_.position();
    const std::uint64_t wanted = std::min(count, room_ - at);
    kept_ += wanted;
    if (kept_ > most_kept)
      throw InputError(
          file_.byte_position(element_.packed.first),
          fmt::format("the arrays up to here are more than {} MB once they are inflated: load the "
                      "file in MATLAB and save it with -v6 or -v7.3",
                      most_kept >> 20));
    return inflater_.read(to_ + at, wanted) == count;
  }

  const MappedFile& file_;
  const MatElement& element_;
  bool big_endian_;
  Inflater inflater_;
  char* to_;
  std::uint64_t room_;
  std::uint64_t& kept_;
};

/// How long an element is once it is inflated: what its tag declares, and no more than deflate can
/// make.
std::uint64_t inflated_size(const MappedFile& file, const MatElement& element, bool big_endian) {
  if (!element.compressed) return element.place.last - element.place.first;
  std::array<char, 8> tag{};
  const std::uint64_t got = Inflater(file, element.packed).read(tag.data(), tag.size());
  if (got < tag.size()) return tag.size();
  const std::uint64_t packed = element.packed.last - element.packed.first;
  return std::min<std::uint64_t>(8 + word_at(tag.data() + 4, big_endian), packed * most_expansion);
}

}  // namespace

InflatedMat inflated_mat(std::unique_ptr<MappedFile> file, const std::vector<MatElement>& elements,
                         bool big_endian, const std::function<void(std::string)>& warn) {
  std::vector<std::uint64_t> sizes;
  std::uint64_t total = 0;
  for (const MatElement& element : elements) {
    sizes.push_back(inflated_size(*file, element, big_endian));
    total += sizes.back();
  }
  const std::string path = file->path();
  auto inflated = std::make_unique<Inflated>(std::move(file), total);
  InflatedMat result;
  std::uint64_t at = 0;
  std::uint64_t kept = 0;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const MatElement& element = elements[i];
    char* const to = inflated->kept() + at;
    std::uint64_t size = sizes[i];
    if (element.compressed) {
      Skeleton skeleton(inflated->file(), element, big_endian, to, sizes[i], kept);
      size = skeleton.walk();
      const std::uint64_t declared = size < 8 ? 8 : 8 + std::uint64_t{word_at(to + 4, big_endian)};
      if (size < declared)
        warn(fmt::format(
            "the compressed array at byte {} is damaged or cut: {} of {} bytes could be inflated",
            element.packed.first, size, declared));
      else if (!skeleton.ends_well()) {
        warn(
            fmt::format("the compressed array at byte {} is damaged (its checksum or its length "
                        "is not that of its numbers): it is left out",
                        element.packed.first));
        size = 0;
      }
    } else {
      kept += size;
      if (kept > most_kept)
        throw InputError(inflated->file().byte_position(element.place.first),
                         fmt::format("the arrays up to here that are not compressed are more than "
                                     "{} MB: load the file in MATLAB and save it with -v6 or -v7.3",
                                     most_kept >> 20));
      inflated->file().copy(element.place.first, size, to);
    }
    result.elements.push_back({at, at + size});
    inflated->add({result.elements.back(), element.compressed ? element.packed : element.place,
                   element.compressed});
    at += size;
  }
  const std::string_view shown(inflated->kept(), at);
  result.file = std::make_unique<MappedFile>(path, shown, std::move(inflated));
  return result;
}

}  // namespace impactrig::acquisition
