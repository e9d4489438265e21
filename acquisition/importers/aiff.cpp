// SPDX-License-Identifier: BSD-3-Clause
// AIFF and AIFF-C. Layout: Apple, "Audio Interchange File Format: AIFF", 1989, and its draft of
// AIFF-C, 1991; names of codings that came later as QuickTime has them.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>

#include "acquisition/importers/byte_cursor.hpp"
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/full_scale.hpp"
#include "acquisition/importers/mapped_file.hpp"
#include "acquisition/importers/stored_numbers.hpp"
#include "acquisition/importers/text_file.hpp"

namespace impactrig::acquisition {

using datasets::InputError;

namespace {

bool is_aiff(std::string_view head) {
  return head.size() >= 12 && head.starts_with("FORM") &&
         (head.substr(8, 4) == "AIFF" || head.substr(8, 4) == "AIFC");
}

/// As libsndfile has it of WAVE files; a header of a few bytes may state any number.
constexpr std::uint64_t most_channels = 1024;

/// How the samples of an AIFF-C file may be coded.
struct Coding {
  std::string_view name;
  enum class Numbers { integers, without_sign, floating } numbers;
  bool big_endian = true;
  unsigned bits = 0;  ///< of a sample; 0: as the file says
};

constexpr auto codings = std::to_array<Coding>({
    {"NONE", Coding::Numbers::integers},               //
    {"twos", Coding::Numbers::integers},               //
    {"sowt", Coding::Numbers::integers, false},        //
    {"in24", Coding::Numbers::integers, true, 24},     //
    {"in32", Coding::Numbers::integers, true, 32},     //
    {"raw ", Coding::Numbers::without_sign, true, 8},  //
    {"fl32", Coding::Numbers::floating, true, 32},     //
    {"FL32", Coding::Numbers::floating, true, 32},     //
    {"fl64", Coding::Numbers::floating, true, 64},     //
    {"FL64", Coding::Numbers::floating, true, 64},     //
});

class AiffReader {
 public:
  explicit AiffReader(const std::string& path) : file_(std::make_unique<MappedFile>(path)) {}

  std::unique_ptr<RecordingReader> open() {
    if (!is_aiff(file_->bytes())) fail(0, "expected 'FORM', and 'AIFF' or 'AIFC' at byte 8");
    read_chunks();
    if (!described_)
      fail(file_->bytes().size(), "there is no chunk 'COMM', which describes samples");
    const NumberKind kind = number_kind();
    const std::uint64_t row = channels_ * size_of(kind);
    const std::uint64_t rows = row == 0 ? 0 : rows_there(row);
    const bool floating = coding_.numbers == Coding::Numbers::floating;
    const double scale = floating ? 1.0 : std::ldexp(2.0, -8 * static_cast<int>(size_of(kind)));
    add_full_scale_channels(head_, "an AIFF file", channels_, rows, 1.0 / rate_, scale);
    head_.record.attributes["coding"] =
        fmt::format("{}, {} bits", floating ? "floating point" : "PCM", bits_);
    std::vector<StoredChannel> channels(channels_);
    for (std::size_t c = 0; c < channels.size(); ++c) {
      channels[c].samples = StoredNumbers(kind, coding_.big_endian);
      channels[c].samples.add({samples_ + c * size_of(kind), rows, row, 1, 0});
      if (kind == NumberKind::u8) head_.record.channels[c].offset = -1.0;
    }
    return reader_of_numbers(std::move(file_), std::move(head_.record), std::move(channels));
  }

 private:
  [[noreturn]] void fail(std::uint64_t at, std::string_view problem) const {
    throw InputError(file_->byte_position(at), problem);
  }

  void warn(std::string sentence) { head_.record.warnings.push_back(std::move(sentence)); }

  void read_chunks() {
    ByteCursor in(*file_, true, 4);
    const std::uint64_t end = in.read<std::uint32_t>("the size of an AIFF file") + std::uint64_t{8};
    in.skip(4);
    while (in.left() >= 8) {
      const std::uint64_t at = in.at();
      const std::string_view name = in.bytes(4, "a chunk");
      const std::uint64_t size = in.read<std::uint32_t>("a chunk");
      const std::uint64_t begin = in.at();
      if (name == "COMM" && !described_)
        describe(at, size);
      else if (name == "SSND" && samples_ == 0)
        find_samples(in, size, end);
      else if (size <= in.left())
        take_text(name, file_->bytes().substr(begin, size));
      in.seek(begin + size + size % 2);
    }
  }

  void describe(std::uint64_t at, std::uint64_t size) {
    const std::string_view what = "the chunk 'COMM'";
    const bool may_be_coded = file_->bytes().substr(8, 4) == "AIFC";
    if (size < (may_be_coded ? 22 : 18)) fail(at, fmt::format("{} has {} bytes", what, size));
    ByteCursor in(*file_, true, at + 8);
    channels_ = in.read<std::uint16_t>(what);
    frames_ = in.read<std::uint32_t>(what);
    bits_ = in.read<std::uint16_t>(what);
    if (channels_ > most_channels)
      fail(at, fmt::format("the header states {} channels, up to {} are read", channels_,
                           most_channels));
    rate_ = rate(in, what);
    if (!(rate_ > 0.0) || !std::isfinite(1.0 / rate_))
      fail(at, fmt::format("the header states a sample rate of {} Hz: its writer has to state it",
                           rate_));
    const std::string_view name = may_be_coded ? in.bytes(4, what) : "NONE";
    const auto known = std::ranges::find(codings, name, &Coding::name);
    if (known == codings.end())
      fail(at, fmt::format("the samples are coded as '{}', which is not read: save it as PCM or "
                           "floating point",
                           to_utf8_with_controls(name)));
    coding_ = *known;
    if (coding_.bits != 0) bits_ = coding_.bits;
    described_ = true;
  }

  /// A number of 80 bits: sign, 15 bits of exponent, 64 of mantissa with its first bit.
  static double rate(ByteCursor& in, std::string_view what) {
    const auto exponent = in.read<std::uint16_t>(what);
    const auto mantissa = static_cast<double>(in.read<std::uint64_t>(what));
    return (exponent & 0x8000) != 0 ? -mantissa : std::ldexp(mantissa, exponent - 16383 - 63);
  }

  /// Integers are at the upper end of their bytes.
  NumberKind number_kind() const {
    if (coding_.numbers == Coding::Numbers::without_sign) return NumberKind::u8;
    if (coding_.numbers == Coding::Numbers::floating)
      return bits_ == 32 ? NumberKind::f32 : NumberKind::f64;
    constexpr std::array kinds = {NumberKind::i8, NumberKind::i16, NumberKind::i24,
                                  NumberKind::i32};
    if (bits_ == 0 || bits_ > 32)
      fail(0, fmt::format("the header states {} bits a sample; integers of up to 32 bits are read",
                          bits_));
    return kinds[(bits_ - 1) / 8];
  }

  /// `end`: of the file, as its header has it.
  void find_samples(ByteCursor in, std::uint64_t size, std::uint64_t end) {
    const auto offset = in.read<std::uint32_t>("the chunk 'SSND'");
    in.skip(4);
    const std::uint64_t head = std::uint64_t{8} + offset;
    samples_ = in.at() + offset;
    const std::uint64_t all = file_->bytes().size();
    const std::uint64_t rest = all - std::min(all, samples_);
    sample_bytes_ = std::min(rest, size - std::min(size, head));
    is_cut_ = size > head + sample_bytes_;
    // as a recorder leaves it that was stopped
    if (size <= head && end <= samples_) uncounted_ = rest;
  }

  std::uint64_t rows_there(std::uint64_t row) {
    if (frames_ == 0 && uncounted_ >= row) {
      warn(
          fmt::format("the header says that there are no samples, as of a recorder that was "
                      "stopped: the {} bytes behind it are read as samples",
                      uncounted_));
      return uncounted_ / row;
    }
    const std::uint64_t rows = sample_bytes_ / row;
    if (rows != frames_)
      warn(fmt::format("the file {}: its header declares {} samples a channel, {} are there",
                       is_cut_ || rows < frames_ ? "is cut" : "contradicts itself", frames_, rows));
    return std::min(rows, frames_);
  }

  void take_text(std::string_view name, std::string_view content) {
    constexpr std::array<std::pair<std::string_view, const char*>, 4> texts = {
        {{"NAME", "title"}, {"AUTH", "artist"}, {"(c) ", "copyright"}, {"ANNO", "comment"}}};
    constexpr std::size_t longest = 2047;
    const auto known =
        std::ranges::find(texts, name, &std::pair<std::string_view, const char*>::first);
    if (known == texts.end()) return;
    const std::string text = to_utf8(content.substr(0, std::min(content.find('\0'), longest)));
    if (text.empty()) return;
    const bool is_first = head_.record.attributes.emplace(known->second, text).second;
    if (name == "NAME" && is_first) head_.record.title = text;
  }

  std::unique_ptr<MappedFile> file_;
  RecordingHead head_;
  bool described_ = false;
  std::uint64_t channels_ = 0;
  std::uint64_t frames_ = 0;
  unsigned bits_ = 0;
  double rate_ = 0.0;
  Coding coding_{};
  std::uint64_t samples_ = 0;  ///< [byte]; 0: none
  std::uint64_t sample_bytes_ = 0;
  std::uint64_t uncounted_ = 0;
  bool is_cut_ = false;
};

}  // namespace

int recognises_aiff(std::string_view, std::string_view head) {
  return is_aiff(head) ? 100 : 0;
}

std::unique_ptr<RecordingReader> open_aiff(const std::string& path, const ImportOptions&) {
  return AiffReader(path).open();
}

}  // namespace impactrig::acquisition
