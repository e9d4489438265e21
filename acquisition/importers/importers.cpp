// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "acquisition/importer.hpp"
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/text_file.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::InputError;
using datasets::Record;
using datasets::SourcePosition;

namespace {

/// A new format is a file beside this one, its two functions in formats.hpp, and a line here. Most
/// specific first.
constexpr std::array<Importer, 5> table = {{
    {"impactrig-hdf5", "impactrig's own HDF5 (.h5)", recognises_hdf5, read_hdf5},  //
    {"uff58b", "universal file with binary functions, dataset 58b (.uff .unv .bunv)",
     recognises_uff58b, read_uff58},  //
    {"uff58", "universal file with functions in text, dataset 58 (.uff .unv)", recognises_uff58,
     read_uff58},  //
    {"polytec-ascii", "Polytec PSV and VibSoft text export (.txt)", recognises_polytec_ascii,
     read_polytec_ascii},  //
    {"csv", "table of numbers: comma, tab, semicolon or blank separated (.csv .txt .tsv .dat)",
     recognises_csv, read_csv},  //
}};

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

SourcePosition whole(const std::string& path) {
  SourcePosition place;
  place.file = path;
  return place;
}

const Importer& named(const std::string& path, const std::string& id) {
  for (const Importer& importer : table)
    if (importer.id == id) return importer;
  throw InputError(whole(path),
                   fmt::format("there is no format '{}'; known are {}", id, known_formats()));
}

const Importer& recognised(const std::string& path, std::string_view head) {
  if (head.empty()) throw InputError(whole(path), "the file is empty");
  std::string converted;
  std::string_view shown = head;
  if (shown.starts_with("\xEF\xBB\xBF")) shown.remove_prefix(3);
  if (shown.starts_with("\xFF\xFE") || shown.starts_with("\xFE\xFF")) {
    converted = utf16_to_utf8(shown);
    shown = converted;
  }
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
    const std::string closed = closed_format(head);
    if (!closed.empty()) throw InputError(whole(path), closed);
  }
  if (best == nullptr)
    throw InputError(
        whole(path),
        fmt::format("the content is of no known format; known are {} (--format states one)",
                    known_formats()));
  return *best;
}

/// What a stated sample rate replaces: the interval, not the time of the first sample.
void apply_sample_rate(Record& record, double rate) {
  for (Channel& channel : record.channels) {
    const auto domain = channel.attributes.find("domain");
    if (domain != channel.attributes.end() && domain->second != "time") continue;
    if (channel.clock.interval > 0.0 && std::abs(rate * channel.clock.interval - 1.0) > 1e-12)
      channel.attributes["sample interval in file"] = fmt::format("{} s", channel.clock.interval);
    channel.clock.interval = 1.0 / rate;
    channel.clock.times.clear();
  }
}

bool lacks_clock(const Channel& channel) {
  const auto domain = channel.attributes.find("domain");
  const bool time = domain == channel.attributes.end() || domain->second == "time";
  return time && channel.size() > 1 && channel.clock.times.empty() &&
         !(channel.clock.interval > 0.0);
}

void check_clock(const std::string& path, Record& record, const ImportOptions& options) {
  const auto lacking = std::find_if(record.channels.begin(), record.channels.end(), lacks_clock);
  if (lacking == record.channels.end()) return;
  const std::string problem = fmt::format(
      "'{}' has neither times nor a sample rate: state it with --sample-rate, or the column with "
      "--time-column",
      lacking->name);
  if (options.require_clock) throw InputError(whole(path), problem);
  if (std::find(record.warnings.begin(), record.warnings.end(), problem) == record.warnings.end())
    record.warnings.push_back(problem);
}

/// Samples that are infinite or not a number cannot be used: they are marked, whatever the format.
void mark_non_finite(Record& record) {
  for (Channel& channel : record.channels) {
    if (std::holds_alternative<std::vector<std::int16_t>>(channel.raw) ||
        std::holds_alternative<std::vector<std::int32_t>>(channel.raw))
      continue;
    const std::size_t n = channel.size();
    std::size_t found = 0;
    std::size_t first = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const bool finite = std::isfinite(channel.value(i)) &&
                          (!channel.complex() || std::isfinite(channel.imaginary[i]));
      if (finite || !channel.is_valid(i)) continue;
      if (channel.valid.empty()) channel.valid.assign(n, 1);
      channel.valid[i] = 0;
      if (found++ == 0) first = i;
    }
    if (found > 0)
      record.warnings.push_back(
          fmt::format("'{}': {} of {} samples {} not finite, the first is sample {}; marked as "
                      "not valid",
                      channel.name, found, n, found == 1 ? "is" : "are", first));
  }
}

}  // namespace

std::span<const Importer> importers() {
  return table;
}

Record import_recording(const std::string& path, const ImportOptions& options) {
  if (options.sample_rate && !(*options.sample_rate > 0.0))
    throw InputError(whole(path), fmt::format("the stated sample rate of {} Hz is not positive",
                                              *options.sample_rate));
  const TextFile file(path);  // throws when it cannot be opened
  const std::string_view head = file.bytes().substr(0, 65536);
  const Importer& importer =
      options.format.empty() ? recognised(path, head) : named(path, options.format);

  Record record = importer.read(path, options);
  if (options.sample_rate) apply_sample_rate(record, *options.sample_rate);
  check_clock(path, record, options);
  mark_non_finite(record);

  datasets::Provenance& provenance = record.provenance;
  provenance.source_file = path;
  provenance.bytes = file.bytes().size();
  provenance.sha256 = datasets::sha256_of(file.bytes());
  if (provenance.importer.empty()) provenance.importer = importer.id;
  provenance.program = datasets::program_version();
  return record;
}

}  // namespace impactrig::acquisition
