// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "acquisition/importer.hpp"
#include "acquisition/importers/checked_samples.hpp"
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/mapped_file.hpp"
#include "acquisition/importers/text_file.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::InputError;
using datasets::Record;
using datasets::SourcePosition;

namespace {

/// A new format is a file beside this one, its two functions in formats.hpp, and a line here. Most
/// specific first.
constexpr auto table = std::to_array<Importer>({
    {"impactrig-hdf5", "impactrig's own HDF5 (.h5)", recognises_hdf5, open_hdf5},  //
    {"uff58b", "universal file with binary functions, dataset 58b (.uff .unv .bunv)",
     recognises_uff58b, open_uff58},  //
    {"uff58", "universal file with functions in text, dataset 58 (.uff .unv)", recognises_uff58,
     open_uff58},                                                                          //
    {"tdms", "NI TDMS, DAQmx raw data too (.tdms)", recognises_tdms, open_tdms},           //
    {"tdm", "NI TDM of DIAdem and LabVIEW (.tdm beside .tdx)", recognises_tdm, open_tdm},  //
    {"mdf4", "ASAM MDF 4 (.mf4 .mdf)", recognises_mdf4, open_mdf4},                        //
    {"polytec-ascii", "Polytec PSV and VibSoft text export (.txt)", recognises_polytec_ascii,
     open_polytec_ascii},                                                                         //
    {"tek-wfm", "Tektronix waveform, versions 1 to 3 (.wfm)", recognises_tek_wfm, open_tek_wfm},  //
    {"tek-isf", "Tektronix internal save format (.isf)", recognises_tek_isf, open_tek_isf},       //
    {"lecroy-trc", "LeCroy waveform (.trc)", recognises_lecroy_trc, open_lecroy_trc},             //
    {"keysight-bin", "Agilent and Keysight waveforms (.bin)", recognises_keysight_bin,
     open_keysight_bin},                                                            //
    {"rigol-bin", "Rigol waveforms (.bin)", recognises_rigol_bin, open_rigol_bin},  //
    {"rigol-wfm", "Rigol DS1000Z, DS1000E/D and DS2000 waveform (.wfm)", recognises_rigol_wfm,
     open_rigol_wfm},  //
    {"yokogawa-wvf", "Yokogawa DL and WE7000 waveforms (.hdr beside .wvf)", recognises_yokogawa_wvf,
     open_yokogawa_wvf},                                                              //
    {"catman", "HBM catman binary export (.bin)", recognises_catman, open_catman},    //
    {"imc-raw", "imc FAMOS raw file (.raw .dat)", recognises_imc_raw, open_imc_raw},  //
    {"hdf5", "HDF5 of other programs: data sets of numbers by their paths (.h5 .hdf5 .nxs)",
     recognises_foreign_hdf5, open_foreign_hdf5},                         //
    {"mat", "MATLAB MAT-file (.mat)", recognises_mat, open_mat},          //
    {"numpy", "NumPy arrays (.npy .npz)", recognises_numpy, open_numpy},  //
    {"wav", "WAVE sound file: RIFF, RIFX, RF64, BW64, Wave64 (.wav .w64)", recognises_wav,
     open_wav},                                                                               //
    {"aiff", "AIFF and AIFF-C sound file (.aif .aiff .aifc)", recognises_aiff, open_aiff},    //
    {"sigrok", "sigrok session with analog channels (.sr)", recognises_sigrok, open_sigrok},  //
    {"lvm", "LabVIEW measurement file, with or without header (.lvm)", recognises_lvm,
     open_lvm},  //
    {"csv", "table of numbers: comma, tab, semicolon or blank separated (.csv .txt .tsv .dat)",
     recognises_csv, open_csv},  //
});

/// Those that heed ImportOptions::units.
constexpr auto formats_with_stated_units = std::to_array<std::string_view>(
    {"csv", "lvm", "polytec-ascii", "sigrok", "mat", "numpy", "tdms", "hdf5"});

/// A score up to this one says "text with numbers" and no more.
constexpr int generic = 20;

std::string known_formats() {
  std::string list;
  for (const Importer& importer : table) {
    if (!list.empty()) list += ", ";
    list += importer.id;
  }
  return list;
}

SourcePosition place_of(const std::string& path) {
  SourcePosition place;
  place.file = path;
  return place;
}

const Importer& named(const std::string& path, const std::string& id) {
  for (const Importer& importer : table)
    if (importer.id == id) return importer;
  throw InputError(place_of(path),
                   fmt::format("there is no format '{}'; known are {}", id, known_formats()));
}

/// The first bytes without a byte order mark, of UTF-16 as UTF-8.
std::string without_mark(std::string_view head) {
  if (head.starts_with("\xEF\xBB\xBF")) head.remove_prefix(3);
  if (head.starts_with("\xFF\xFE") || head.starts_with("\xFE\xFF")) return utf16_to_utf8(head);
  return std::string(head);
}

const Importer& recognised(const std::string& path, std::string_view head) {
  if (head.empty()) throw InputError(place_of(path), "the file is empty");
  const std::string shown = without_mark(head);
  const std::string file_name = path.substr(path.find_last_of('/') + 1);
  const Importer* best = nullptr;
  int best_score = 0;
  for (const Importer& importer : table) {
    const int score = importer.recognises(file_name, shown);
    if (score > best_score) {
      best_score = score;
      best = &importer;
    }
  }
  if (best_score <= generic) {
    const bool utf16 = head.starts_with("\xFF\xFE") || head.starts_with("\xFE\xFF");
    const std::string closed = closed_format(file_name, utf16 ? shown : head);
    if (!closed.empty()) throw InputError(place_of(path), closed);
  }
  const std::string closed = best == nullptr ? closed_ending(file_name) : std::string();
  if (!closed.empty()) throw InputError(place_of(path), closed);
  if (best == nullptr)
    throw InputError(
        place_of(path),
        fmt::format("the content is of no known format; known are {} (--format states one)",
                    known_formats()));
  return *best;
}

/// What a stated sample rate replaces: the interval, not the time of the first sample, unless that
/// is none.
void apply_sample_rate(Record& record, double rate) {
  for (Channel& channel : record.channels) {
    const auto domain = channel.attributes.find("domain");
    if (domain != channel.attributes.end() && domain->second != "time") continue;
    if (channel.clock.interval > 0.0 && std::abs(rate * channel.clock.interval - 1.0) > 1e-12)
      channel.attributes["sample interval in file"] =
          fmt::format("{:.12g} s", channel.clock.interval);
    channel.clock.interval = 1.0 / rate;
    if (!std::isfinite(channel.clock.start)) channel.clock.start = 0.0;
  }
}

bool lacks_clock(const RecordingHead& head, std::size_t index) {
  const Channel& channel = head.record.channels[index];
  const auto domain = channel.attributes.find("domain");
  const bool time = domain == channel.attributes.end() || domain->second == "time";
  return time && head.samples[index] > 1 && !(channel.clock.interval > 0.0);
}

/// Of channels that have the same name, how they are told apart; "" where there are none.
std::string same_names(const Record& record) {
  std::map<std::string_view, std::vector<const Channel*>> named;
  for (const Channel& channel : record.channels) named[channel.name].push_back(&channel);
  const auto group_of = [](const Channel& channel) {
    const auto group = channel.attributes.find("group");
    return group == channel.attributes.end() ? std::string() : group->second;
  };
  for (const Channel& channel : record.channels) {
    const std::vector<const Channel*>& same = named[channel.name];
    if (same.size() < 2) continue;
    std::set<std::string> groups;
    for (const Channel* const one : same) groups.insert(group_of(*one));
    if (groups.size() == same.size() && !groups.contains(""))
      return fmt::format("several groups have a channel '{0}': state the group too, '{1}/{0}'",
                         channel.name, group_of(*same[1]));
    return fmt::format(
        "{} channels are called '{}': the name means the first of them, an index any other",
        same.size(), channel.name);
  }
  return {};
}

/// What holds for recordings of every format.
class CheckedRecording final : public RecordingReader {
 public:
  CheckedRecording(std::unique_ptr<RecordingReader> reader, const ImportOptions& options,
                   const std::string& path)
      : reader_(std::move(reader)),
        head_(reader_->head()),
        rate_(options.sample_rate),
        require_clock_(options.require_clock),
        path_(path) {
    if (require_clock_ && !rate_ && options.channels.empty()) hide_small_lists();
    if (rate_) apply_sample_rate(head_.record, *rate_);
    if (std::string sentence = same_names(head_.record); !sentence.empty()) tell(sentence);
    if (require_clock_) return;
    std::vector<std::size_t> all(head_.samples.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    if (std::string sentence = without_clock(all); !sentence.empty())
      head_.record.warnings.push_back(std::move(sentence));
  }

  const RecordingHead& head() const override { return head_; }

  void tell(const std::string& sentence) {
    auto& warnings = head_.record.warnings;
    if (std::ranges::find(warnings, sentence) == warnings.end()) warnings.push_back(sentence);
  }

  void set_provenance(std::string_view importer, std::uint64_t bytes) {
    datasets::Provenance& provenance = head_.record.provenance;
    provenance.source_file = path_;
    provenance.bytes = bytes;
    if (provenance.importer.empty()) provenance.importer = importer;
    provenance.program = datasets::program_version();
  }

  Record read(const Selection& wanted, SampleSink& sink) override {
    const std::vector<std::size_t> chosen = selected_channels(head_, wanted);
    if (require_clock_)
      if (const std::string sentence = without_clock(chosen); !sentence.empty())
        throw InputError(place_of(path_), sentence);
    // with another rate than the file's, the window is not the file's either
    Selection of_file = wanted;
    if (rate_) of_file = {wanted.channels};
    if (!shown_.empty()) {
      of_file.channels.clear();
      for (const std::size_t index : chosen) of_file.channels.push_back(shown_[index]);
    }
    CheckedSamples checked(chosen.size(),
                           rate_ ? ranges(chosen, wanted) : std::vector<SampleRange>{}, sink);
    Record record = reader_->read(of_file, checked);
    if (rate_) {
      apply_sample_rate(record, *rate_);
      for (std::size_t i = 0; i < chosen.size(); ++i) {
        datasets::SampleClock& clock = record.channels[i].clock;
        clock.start += clock.interval * static_cast<double>(range_of(clock, wanted).first);
      }
    }
    if (wanted.has_window()) refuse_empty_window(chosen, wanted, checked);
    for (const std::string& warning : head_.record.warnings)
      if (std::ranges::find(record.warnings, warning) == record.warnings.end())
        record.warnings.push_back(warning);
    checked.tell(record);
    record.provenance = head_.record.provenance;
    return record;
  }

 private:
  /// Names those of the channels that have no clock, and says why; "" where all have one.
  std::string without_clock(const std::vector<std::size_t>& channels) const {
    std::map<std::string, std::vector<std::string_view>> names;  // by what the file states
    for (const std::size_t index : channels)
      if (lacks_clock(head_, index)) {
        const Channel& channel = head_.record.channels[index];
        names[stated_clock(channel)].push_back(channel.name);
      }
    std::uint64_t longest = 0;  // of those without
    for (const std::size_t index : channels)
      if (lacks_clock(head_, index)) longest = std::max(longest, head_.samples[index]);
    const bool names_others = std::ranges::any_of(channels, [&](std::size_t index) {
      return head_.samples[index] > longest && !lacks_clock(head_, index);
    });
    std::string sentence;
    for (const auto& [stated, channels_named] : names)
      sentence += fmt::format(
          "{}{} {}", sentence.empty() ? "" : "; ", first_of(channels_named),
          stated.empty() ? fmt::format("{} neither times nor a sample rate",
                                       channels_named.size() == 1 ? "has" : "have")
                         : fmt::format("{} no sample rate, since {}",
                                       channels_named.size() == 1 ? "has" : "have", stated));
    if (sentence.empty()) return {};
    return sentence + ": state it with --sample-rate, or the column with --time-column" +
           (names_others ? ", or choose others with --channel" : "");
  }

  /// Why a file that states a clock gives none; "" where it states nothing.
  static std::string stated_clock(const Channel& channel) {
    const auto unusable = channel.attributes.find(std::string(unusable_clock));
    if (unusable != channel.attributes.end())
      return fmt::format("the file states {}", unusable->second);
    return channel.clock.interval < 0.0 ? "its times do not increase" : "";
  }

  /// The first ten of many names.
  static std::string first_of(const std::vector<std::string_view>& names) {
    constexpr std::size_t most = 10;
    std::string list;
    for (std::size_t i = 0; i < std::min(most, names.size()); ++i)
      list += fmt::format("{}'{}'", i > 0 ? ", " : "", names[i]);
    if (names.size() > most) list += fmt::format(" and {} more", names.size() - most);
    return list;
  }

  /// The samples of a re-rated clock in the window, however many there are.
  static SampleRange range_of(const datasets::SampleClock& clock, const Selection& wanted) {
    return samples_within(clock, ~std::uint64_t{0} >> 12, wanted);
  }

  std::vector<SampleRange> ranges(const std::vector<std::size_t>& chosen,
                                  const Selection& wanted) const {
    std::vector<SampleRange> list;
    for (const std::size_t index : chosen)
      list.push_back(range_of(head_.record.channels[index].clock, wanted));
    return list;
  }

  /// Lists of a few numbers beside channels that have a clock (positions, settings) are no
  /// channels, and need none.
  void hide_small_lists() {
    constexpr std::uint64_t few = 10;         // of so many times more samples
    constexpr std::uint64_t no_record = 100;  // from so many on it may be a slow channel
    const std::size_t n = head_.samples.size();
    std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
    for (std::size_t i = 0; i < n; ++i)
      if (head_.samples[i] > 1 && !lacks_clock(head_, i)) least = std::min(least, head_.samples[i]);
    if (least == std::numeric_limits<std::uint64_t>::max()) return;
    std::vector<std::string_view> hidden;
    for (std::size_t i = 0; i < n; ++i) {
      if (lacks_clock(head_, i) && head_.samples[i] < std::min(least / few, no_record))
        hidden.push_back(head_.record.channels[i].name);
      else
        shown_.push_back(i);
    }
    if (hidden.empty()) return shown_.clear();
    const std::string sentence = fmt::format(
        "{} {} no clock and few numbers: left out, and not counted where channels are told by "
        "their "
        "number (--channel and --sample-rate read them)",
        first_of(hidden), hidden.size() == 1 ? "has" : "have");
    RecordingHead shown;
    shown.record = head_.record;
    shown.record.channels.clear();
    shown.counted = head_.counted;
    for (const std::size_t i : shown_) {
      shown.record.channels.push_back(head_.record.channels[i]);
      shown.samples.push_back(head_.samples[i]);
    }
    head_ = std::move(shown);
    tell(sentence);
  }

  /// Where the head has samples but the window none; a number beside them is not counted.
  void refuse_empty_window(const std::vector<std::size_t>& chosen, const Selection& wanted,
                           const CheckedSamples& checked) const {
    double first = std::numeric_limits<double>::infinity();
    double last = -first;
    const bool many =
        std::ranges::any_of(chosen, [this](std::size_t index) { return head_.samples[index] > 1; });
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const std::size_t index = chosen[i];
      if (head_.samples[index] <= (many ? 1U : 0U)) continue;
      if (checked.any(i)) return;
      const datasets::SampleClock& clock = head_.record.channels[index].clock;
      first = std::min(first, clock.start);
      last = std::max(last,
                      clock.start + clock.interval * static_cast<double>(head_.samples[index] - 1));
    }
    if (first > last) return;
    throw InputError(
        place_of(path_),
        fmt::format("there is no sample between {:.9g} and {:.9g} s: the recording goes "
                    "from {:.9g} to {:.9g} s",
                    wanted.from, wanted.to, first, last));
  }

  std::unique_ptr<RecordingReader> reader_;
  RecordingHead head_;
  std::optional<double> rate_;
  bool require_clock_;
  std::string path_;
  std::vector<std::size_t> shown_;  ///< channels of reader_ that are those of head_; none: all
};

}  // namespace

std::span<const Importer> importers() {
  return table;
}

namespace {

/// Formats whose files are read as a TextFile throughout.
bool is_text(std::string_view format) {
  return format == "csv" || format == "lvm" || format == "polytec-ascii";
}

/// A stated encoding, else what the words of a text in `head` look like; "" where neither is there.
/// Throws InputError where what is stated cannot be.
std::string encoding_of(const std::string& path, std::string_view format, std::string_view head,
                        const ImportOptions& options) {
  if (options.encoding.empty()) {
    const std::string likely = is_text(format) ? likely_code_page(head) : std::string();
    return is_code_page(likely) ? likely : std::string();  // the C library may lack its table
  }
  if (!is_text(format))
    throw InputError(
        place_of(path),
        fmt::format("--encoding is not for the format {}, but for tables of text", format));
  if (!is_code_page(options.encoding))
    throw InputError(place_of(path),
                     fmt::format("the encoding '{}' is not known; `iconv -l` lists those that are, "
                                 "of which the ones that extend ASCII can be read",
                                 options.encoding));
  return options.encoding;
}

/// Of a file without content: whether an importer's list of endings, or its table's, has its own.
bool has_ending_of_recordings(std::string file_name) {
  for (char& c : file_name)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  const std::size_t dot = file_name.rfind('.');
  if (dot == std::string::npos) return false;
  const std::string ending = file_name.substr(dot);
  return std::ranges::any_of(table, [&](const Importer& importer) {
    const std::string_view endings =
        importer.description.substr(importer.description.rfind('(') + 1);
    return endings.find(ending + " ") != std::string_view::npos ||
           endings.find(ending + ")") != std::string_view::npos ||
           importer.recognises(file_name, "") >= generic;
  });
}

}  // namespace

bool looks_like_recording(const std::string& path) try {
  const MappedFile file(path);
  const std::string_view head = file.bytes().substr(0, 65536);
  const std::string file_name = path.substr(path.find_last_of('/') + 1);
  if (head.empty()) return has_ending_of_recordings(file_name);
  return std::ranges::any_of(table, [&](const Importer& importer) {
    return importer.recognises(file_name, head) >= generic;
  });

} catch (const datasets::FileError&) {
  return false;
}

std::vector<std::string> files_of_recording(const std::string& path) {
  std::vector<std::string> files = {path};
  const MappedFile file(path);  // throws when it cannot be opened
  if (recognises_yokogawa_wvf(path, file.bytes()) > 0)
    if (std::string samples = samples_of_yokogawa_wvf(path); !samples.empty())
      files.push_back(std::move(samples));
  if (recognises_tdm(path, without_mark(file.bytes().substr(0, 65536))) > 0)
    for (std::string& samples : samples_of_tdm(path)) files.push_back(std::move(samples));
  return files;
}

std::uint64_t bytes_of_recording(const std::string& path) {
  std::uint64_t bytes = 0;
  for (const std::string& file : files_of_recording(path)) bytes += MappedFile(file).bytes().size();
  return bytes;
}

std::string sha256_of_recording(const std::string& path) {
  return datasets::sha256_of_files(files_of_recording(path));
}

std::unique_ptr<RecordingReader> open_recording(const std::string& path,
                                                const ImportOptions& options) {
  if (options.sample_rate && !(*options.sample_rate > 0.0 && std::isfinite(*options.sample_rate)))
    throw InputError(place_of(path),
                     fmt::format("the stated sample rate of {:.12g} Hz is not a number greater "
                                 "than zero",
                                 *options.sample_rate));
  const MappedFile file(path);  // throws when it cannot be opened
  const std::string_view head = file.bytes().substr(0, 65536);
  const Importer& importer =
      options.format.empty() ? recognised(path, head) : named(path, options.format);
  if (!options.units.empty() &&
      std::ranges::find(formats_with_stated_units, importer.id) == formats_with_stated_units.end())
    throw InputError(place_of(path),
                     fmt::format("--units is not for the format {}; a map states the units of its "
                                 "channels (--suggest-map, --map)",
                                 importer.id));
  ImportOptions decided = options;
  decided.encoding = encoding_of(path, importer.id, head, options);
  auto checked = std::make_unique<CheckedRecording>(importer.open(path, decided), decided, path);
  checked->set_provenance(importer.id, bytes_of_recording(path));
  if (decided.encoding != options.encoding)
    checked->tell(
        fmt::format("the text is not UTF-8 and is read as {}, which its words look like "
                    "(--encoding names another)",
                    decided.encoding));
  const std::size_t padding = is_text(importer.id) ? padding_of(file) : 0;
  if (padding > 0)
    checked->tell(
        fmt::format("the file ends with {} byte{} of zero (was its writer stopped?): {} left out",
                    padding, padding == 1 ? "" : "s", padding == 1 ? "it is" : "they are"));
  return checked;
}

Selection selection_of(const RecordingHead& head, const ImportOptions& options) {
  Selection wanted;
  wanted.from = options.from;
  wanted.to = options.to;
  const Record& record = head.record;
  for (const std::string& name : options.channels) {
    const Channel* const channel = record.find(name);
    if (channel == nullptr) {
      std::string list;
      for (const Channel& there : record.channels)
        list += (list.empty() ? "'" : ", '") + there.name + "'";
      throw InputError(place_of(record.provenance.source_file),
                       fmt::format("there is no channel '{}'; the channels are {}", name,
                                   list.empty() ? "none" : list));
    }
    const auto index = static_cast<std::size_t>(channel - record.channels.data());
    if (std::ranges::find(wanted.channels, index) == wanted.channels.end())  // by name and by index
      wanted.channels.push_back(index);
  }
  return wanted;
}

Record import_recording(const std::string& path, const ImportOptions& options) {
  const std::unique_ptr<RecordingReader> reader = open_recording(path, options);
  Record record = read_into_memory(*reader, selection_of(reader->head(), options));
  record.provenance.sha256 = sha256_of_recording(path);
  return record;
}

}  // namespace impactrig::acquisition
