// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <sndfile.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>

#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/full_scale.hpp"
#include "acquisition/importers/mapped_file.hpp"
#include "acquisition/importers/stored_numbers.hpp"
#include "acquisition/importers/text_file.hpp"
#include "acquisition/importers/wave_chunks.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::InputError;
using datasets::Record;

namespace {

/// Samples of all channels that are read at once.
constexpr std::size_t block_samples = 65536;

/// The name of a coding [RFC 2361] that libsndfile is not asked to read; "" of those that it is.
std::string unread_coding(unsigned code) {
  switch (code) {
    case 0x0001:  // PCM
    case 0x0003:  // floating point
    case 0x0006:  // A-law
    case 0x0007:  // u-law
    case 0x0101:  // u-law of IBM
    case 0x0102:  // A-law of IBM
    case 0xFFFE:  // extensible
      return "";
    case 0x0002:
      return "Microsoft ADPCM";
    case 0x0011:
      return "IMA ADPCM";
    case 0x0031:
      return "GSM 6.10";
    case 0x0055:
      return "MPEG layer 3";
    default:
      return fmt::format("0x{:04x}", code);
  }
}

/// The facts of the chunk "fmt ", of at least 16 bytes.
struct WaveFormat {
  unsigned code = 0;  ///< of the samples; of extensible ones that which is named within
  std::size_t code_at = 0;
  unsigned channels = 0;
  unsigned row = 0;  ///< [bytes]
  unsigned bits = 0;
  bool no_rate = false;
};

WaveFormat wave_format(const WaveChunks& chunks) {
  constexpr unsigned extensible = 0xFFFE;
  const auto field = [&](std::size_t offset) {
    const auto low = static_cast<unsigned char>(chunks.format[offset + chunks.big_endian]);
    const auto high = static_cast<unsigned char>(chunks.format[offset + !chunks.big_endian]);
    return unsigned{low} + 256 * unsigned{high};
  };
  WaveFormat format{field(0), 0, field(2), field(12), field(14), field(4) == 0 && field(6) == 0};
  if (format.code == extensible && chunks.format.size() >= 28) {
    // the first number of a GUID, of 32 bits
    format.code_at = chunks.big_endian && field(24) == 0 ? 26 : 24;
    format.code = field(format.code_at);
  }
  return format;
}

/// Integers of 64 bits, which libsndfile does not read.
bool is_pcm_64(const WaveChunks& chunks) {
  if (chunks.format.size() < 16) return false;
  const WaveFormat format = wave_format(chunks);
  return format.code == 1 && format.bits == 64 && format.row == 8 * format.channels;
}

/// What is wrong with a file's chunks that libsndfile passes over or does not name, as a sentence:
/// it reads 24 bits in rows of 4 bytes as if they were packed, which gives other numbers, and says
/// "internal error" of a rate of zero. "" where there is nothing.
std::string wrong_chunks(const WaveChunks& chunks) {
  if (chunks.data_chunks > 1)
    return "the samples are in several chunks 'data', of which a file may have one: join them";
  if (chunks.format.size() < 16) return "";
  const auto [code, code_at, channels, row, bits, no_rate] = wave_format(chunks);
  if (no_rate) return "the header states a sample rate of 0 Hz: its writer has to state it";
  if (const std::string name = unread_coding(code); !name.empty())
    return fmt::format(
        "the samples are coded as {}, which loses what a measurement needs and is not read: save "
        "it as PCM or floating point",
        name);
  const bool is_plain = code == 1 || code == 3;
  if (is_plain && row != 0 && bits != 0 && row != channels * ((bits + 7) / 8))
    return fmt::format(
        "the header states {} bits a sample and {} channel{}, but rows of {} bytes: what fills "
        "them is not told; save it as PCM of whole bytes",
        bits, channels, channels == 1 ? "" : "s", row);
  if (code == 1 && bits > 32 && bits < 64)
    return fmt::format(
        "the header states {} bits a sample; integers of up to 32 and of 64 bits are read: save "
        "it as one of these or as floating point",
        bits);
  return "";
}

/// libsndfile's view: an undamaged head and the file's samples. It never sees the file system, nor
/// what is damaged. Integers of 64 bits it takes for floating point.
class SoundBytes {
 public:
  explicit SoundBytes(const MappedFile& file)
      : file_(file),
        chunks_(wave_chunks(file.bytes())),
        pcm_64_(is_pcm_64(chunks_)),
        format_(chunks_.format) {
    if (pcm_64_) format_[wave_format(chunks_).code_at + (chunks_.big_endian ? 1 : 0)] = 3;
    chunks_.format = format_;
    head_ = undamaged_head(chunks_);
  }

  SoundBytes(const SoundBytes&) = delete;
  SoundBytes& operator=(const SoundBytes&) = delete;

  const WaveChunks& chunks() const { return chunks_; }

  bool pcm_64() const { return pcm_64_; }

  static sf_count_t length(void* self) { return static_cast<SoundBytes*>(self)->size(); }

  static sf_count_t seek(sf_count_t offset, int whence, void* self) {
    auto& sound = *static_cast<SoundBytes*>(self);
    sf_count_t from = 0;
    if (whence == SEEK_CUR) from = sound.at_;
    if (whence == SEEK_END) from = sound.size();
    // a position that a damaged format makes up may be anywhere
    sf_count_t to = 0;
    if (__builtin_add_overflow(from, offset, &to) || to < 0) return -1;
    sound.at_ = std::min(to, sound.size());
    return sound.at_;
  }

  static sf_count_t read(void* to, sf_count_t count, void* self) {
    auto& sound = *static_cast<SoundBytes*>(self);
    const auto there =
        static_cast<std::size_t>(std::clamp<sf_count_t>(count, 0, sound.size() - sound.at_));
    const auto at = static_cast<std::size_t>(sound.at_);
    const std::size_t of_head =
        at < sound.head_.size() ? sound.head_.copy(static_cast<char*>(to), there, at) : 0;
    try {
      if (there > of_head)
        sound.file_.copy(sound.chunks_.samples + (at + of_head - sound.head_.size()),
                         there - of_head, static_cast<char*>(to) + of_head);
    } catch (const datasets::FileError&) {
      return 0;  // libsndfile is C: no exception may pass it
    }
    sound.at_ += static_cast<sf_count_t>(there);
    return static_cast<sf_count_t>(there);
  }

  static sf_count_t write(const void*, sf_count_t, void*) { return 0; }

  static sf_count_t tell(void* self) { return static_cast<SoundBytes*>(self)->at_; }

 private:
  sf_count_t size() const { return static_cast<sf_count_t>(head_.size() + chunks_.sample_bytes); }

  const MappedFile& file_;
  WaveChunks chunks_;
  bool pcm_64_;
  std::string format_;
  std::string head_;
  sf_count_t at_ = 0;
};

/// How samples are handed over: as they lie in the file where a type of ours holds them.
enum class Handed { i16, i32, i64, f32, f64 };

struct Coding {
  Handed handed = Handed::f64;
  double scale = 1.0;  ///< what makes full scale 1.0 of them
  std::string_view name;
};

/// libsndfile puts integers of up to 24 bits at the upper end of the next type: value x 2^8 for 8
/// and 24 bits. Divided by full scale that is the same number.
std::optional<Coding> coding_of(int subtype) {
  constexpr double full_16 = 1.0 / 32768.0;
  constexpr double full_32 = 1.0 / 2147483648.0;
  switch (subtype) {
    case SF_FORMAT_PCM_U8:
      return Coding{Handed::i16, full_16, "PCM, 8 bits"};
    case SF_FORMAT_PCM_16:
      return Coding{Handed::i16, full_16, "PCM, 16 bits"};
    case SF_FORMAT_PCM_24:
      return Coding{Handed::i32, full_32, "PCM, 24 bits"};
    case SF_FORMAT_PCM_32:
      return Coding{Handed::i32, full_32, "PCM, 32 bits"};
    case SF_FORMAT_FLOAT:
      return Coding{Handed::f32, 1.0, "floating point, 32 bits"};
    case SF_FORMAT_DOUBLE:
      return Coding{Handed::f64, 1.0, "floating point, 64 bits"};
    case SF_FORMAT_ULAW:
      return Coding{Handed::i16, full_16, "G.711 u-law"};
    case SF_FORMAT_ALAW:
      return Coding{Handed::i16, full_16, "G.711 A-law"};
    default:
      return std::nullopt;
  }
}

class WavReader final : public RecordingReader {
 public:
  explicit WavReader(const std::string& path) : file_(path), bytes_(file_) {
    if (!is_wave(file_.bytes()) && !is_wave64(file_.bytes()))
      throw InputError(file_.byte_position(0),
                       "expected 'RIFF', 'RIFX', 'RF64' or 'BW64' and 'WAVE' at byte 8");
    if (const std::string problem = wrong_chunks(bytes_.chunks()); !problem.empty())
      throw InputError(file_.byte_position(0), problem);
    SF_VIRTUAL_IO access{SoundBytes::length, SoundBytes::seek, SoundBytes::read, SoundBytes::write,
                         SoundBytes::tell};
    sound_.reset(sf_open_virtual(&access, SFM_READ, &info_, &bytes_));
    if (!sound_)
      throw InputError(file_.byte_position(0),
                       fmt::format("libsndfile cannot read it: {}", to_utf8(sf_strerror(nullptr))));
    const int subtype = info_.format & SF_FORMAT_SUBMASK;
    const auto coding = coding_of(subtype);
    if (!coding)
      throw InputError(file_.byte_position(0),
                       fmt::format("samples of coding 0x{:x} are not read: save it as PCM or "
                                   "floating point",
                                   subtype));
    coding_ = *coding;
    if (bytes_.pcm_64()) coding_ = {Handed::i64, 0x1p-63, "PCM, 64 bits"};
    // floating point as it is, also beyond full scale
    sf_command(sound_.get(), SFC_SET_NORM_FLOAT, nullptr, SF_FALSE);
    sf_command(sound_.get(), SFC_SET_NORM_DOUBLE, nullptr, SF_FALSE);
    describe();
  }

  const RecordingHead& head() const override { return head_; }

  /// The first byte of samples that lie in the file as they are handed over, one chunk of whole
  /// rows; none where libsndfile alone can read them.
  std::optional<std::uint64_t> plain_samples() {
    const int subtype = info_.format & SF_FORMAT_SUBMASK;
    if (subtype != SF_FORMAT_PCM_16 && subtype != SF_FORMAT_PCM_32 && subtype != SF_FORMAT_FLOAT &&
        subtype != SF_FORMAT_DOUBLE)
      return std::nullopt;
    if (head_.samples.empty()) return std::nullopt;
    const std::uint64_t row = size_of(kind()) * head_.samples.size();
    if (head_.samples.front() > bytes_.chunks().sample_bytes / row) return std::nullopt;
    return bytes_.chunks().samples;
  }

  NumberKind kind() const {
    switch (coding_.handed) {
      case Handed::i16:
        return NumberKind::i16;
      case Handed::i32:
        return NumberKind::i32;
      case Handed::i64:
        return NumberKind::i64;
      case Handed::f32:
        return NumberKind::f32;
      case Handed::f64:
        return NumberKind::f64;
    }
    return NumberKind::f64;
  }

  Record read(const Selection& wanted, SampleSink& sink) override {
    const std::vector<std::size_t> chosen = selected_channels(head_, wanted);
    Record record = head_.record;
    record.channels.clear();
    if (chosen.empty()) return record;
    const datasets::SampleClock& clock = head_.record.channels.front().clock;
    const SampleRange range = samples_within(clock, head_.samples.front(), wanted);
    for (const std::size_t index : chosen) {
      record.channels.push_back(head_.record.channels[index]);
      record.channels.back().clock.start =
          clock.start + clock.interval * static_cast<double>(range.first);
    }
    switch (coding_.handed) {
      case Handed::i16:
        hand_over<std::int16_t>(sf_readf_short, chosen, range, sink);
        break;
      case Handed::i32:
        hand_over<std::int32_t>(sf_readf_int, chosen, range, sink);
        break;
      case Handed::f32:
        hand_over<float>(sf_readf_float, chosen, range, sink);
        break;
      case Handed::i64:  // never by libsndfile
        break;
      case Handed::f64:
        hand_over<double>(sf_readf_double, chosen, range, sink);
        break;
    }
    return record;
  }

 private:
  struct Close {
    void operator()(SNDFILE* sound) const { sf_close(sound); }
  };

  void describe() {
    Record& record = head_.record;
    record.attributes["coding"] = coding_.name;
    const std::array<std::pair<int, const char*>, 5> texts = {{{SF_STR_TITLE, "title"},
                                                               {SF_STR_COMMENT, "comment"},
                                                               {SF_STR_DATE, "date"},
                                                               {SF_STR_ARTIST, "artist"},
                                                               {SF_STR_SOFTWARE, "software"}}};
    for (const auto& [which, name] : texts) {
      const char* const text = sf_get_string(sound_.get(), which);
      if (text != nullptr && *text != '\0') record.attributes[name] = to_utf8(text);
    }
    SF_BROADCAST_INFO broadcast{};
    if (sf_command(sound_.get(), SFC_GET_BROADCAST_INFO, &broadcast, sizeof broadcast) == SF_TRUE) {
      const std::string date =
          to_utf8({broadcast.origination_date, sizeof broadcast.origination_date});
      const std::string time =
          to_utf8({broadcast.origination_time, sizeof broadcast.origination_time});
      if (date.find_first_of("123456789") != std::string::npos) record.started = date + "T" + time;
    }
    tell_cut();
    const WaveChunks& chunks = bytes_.chunks();
    if (chunks.uncounted > 0)
      record.warnings.push_back(fmt::format(
          "the header says that there are no samples, as of a recorder that was stopped: "
          "the {} bytes behind it are read as samples",
          chunks.uncounted));
    record.warnings.insert(record.warnings.end(), chunks.warnings.begin(), chunks.warnings.end());
    const auto title = record.attributes.find("title");
    if (title != record.attributes.end()) record.title = title->second;
    const double interval = info_.samplerate > 0 ? 1.0 / info_.samplerate : 0.0;
    add_full_scale_channels(
        head_, "a WAVE file", static_cast<std::size_t>(std::max(info_.channels, 0)),
        static_cast<std::uint64_t>(std::max<sf_count_t>(info_.frames, 0)), interval, coding_.scale);
  }

  /// The file's size as its header has it; a recorder that was stopped leaves another one.
  void tell_cut() {
    const std::uint64_t there = file_.bytes().size();
    const std::uint64_t declared = bytes_.chunks().declared_bytes;
    if (declared > there)
      head_.record.warnings.push_back(fmt::format(
          "the file is cut: its header declares {} bytes, {} are there", declared, there));
  }

  template <typename Sample>
  void hand_over(sf_count_t (*read_frames)(SNDFILE*, Sample*, sf_count_t),
                 const std::vector<std::size_t>& chosen, SampleRange range, SampleSink& sink) {
    if (range.first >= range.last) return;
    const auto all = static_cast<std::size_t>(info_.channels);
    const std::size_t most = std::max<std::size_t>(block_samples / all, 1);
    std::vector<Sample> frames(most * all);
    std::vector<Sample> samples(most);
    if (sf_seek(sound_.get(), static_cast<sf_count_t>(range.first), SEEK_SET) < 0)
      throw InputError(file_.byte_position(0),
                       fmt::format("libsndfile does not find sample {}", range.first));
    for (std::uint64_t at = range.first; at < range.last;) {
      const std::uint64_t wanted = std::min<std::uint64_t>(most, range.last - at);
      const sf_count_t got =
          read_frames(sound_.get(), frames.data(), static_cast<sf_count_t>(wanted));
      if (got <= 0 || static_cast<std::uint64_t>(got) > wanted)
        throw InputError(file_.byte_position(file_.bytes().size()),
                         fmt::format("the file ends within the samples: {} of {} are there", at,
                                     head_.samples.front()));
      const auto count = static_cast<std::size_t>(got);
      for (std::size_t k = 0; k < chosen.size(); ++k) {
        SampleBlock block;
        block.raw = std::span<const Sample>(frames.data(), count);
        if (all > 1) {
          for (std::size_t i = 0; i < count; ++i) samples[i] = frames[i * all + chosen[k]];
          block.raw = std::span<const Sample>(samples.data(), count);
        }
        sink.take(k, block);
      }
      at += count;
    }
  }

  MappedFile file_;
  SoundBytes bytes_;
  SF_INFO info_{};
  std::unique_ptr<SNDFILE, Close> sound_;
  Coding coding_;
  RecordingHead head_;
};

}  // namespace

int recognises_wav(std::string_view, std::string_view head) {
  return is_wave(head) || is_wave64(head) ? 100 : 0;
}

std::unique_ptr<RecordingReader> open_wav(const std::string& path, const ImportOptions&) {
  auto wav = std::make_unique<WavReader>(path);
  const auto first = wav->plain_samples();
  if (!first) return wav;
  auto file = std::make_unique<MappedFile>(path);
  const RecordingHead& head = wav->head();
  const std::uint64_t width = size_of(wav->kind());
  std::vector<StoredChannel> channels(head.samples.size());
  for (std::size_t c = 0; c < channels.size(); ++c) {
    channels[c].samples = StoredNumbers(wav->kind(), file->bytes().starts_with("RIFX"));
    channels[c].samples.add({*first + c * width, head.samples[c], channels.size() * width, 1, 0});
  }
  return reader_of_numbers(std::move(file), head.record, std::move(channels));
}

}  // namespace impactrig::acquisition
