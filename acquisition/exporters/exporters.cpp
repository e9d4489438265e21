// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>

#include "acquisition/exporter.hpp"
#include "acquisition/exporters/formats.hpp"
#include "acquisition/exporters/outgoing.hpp"
#include "acquisition/exporters/read_back.hpp"
#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/text_table.hpp"
#include "datasets/input_error.hpp"
#include "datasets/record_writer.hpp"
#include "datasets/store.hpp"

namespace impactrig::acquisition {

namespace {

std::vector<std::string> write_hdf5(const OutgoingRecording& recording, const std::string& path) {
  std::vector<std::string> names;
  for (const OutgoingChannel& channel : recording.channels) names.push_back(channel.head->name);
  datasets::RecordWriter writer(path, names);
  for (std::size_t i = 0; i < recording.channels.size(); ++i)
    recording.channels[i].each([&](const datasets::Channel& part, std::uint64_t) {
      std::visit(
          [&](const auto& raw) { writer.append(i, std::span(raw), part.imaginary, part.valid); },
          part.raw);
      if (!part.clock.uniform()) writer.append_times(i, part.clock.times);
    });
  writer.finish(recording.record);
  return {};
}

constexpr std::string_view own_format = "impactrig-hdf5";

/// A new format is a file beside this one, its function in formats.hpp, and a line here.
constexpr std::array<Exporter, 5> table = {{
    {own_format, "impactrig's own HDF5", ".h5 .hdf5", write_hdf5},  //
    {"uff58b", "universal file, binary functions in double precision", ".uff .bunv",
     write_uff58b},                                                                          //
    {"uff58", "universal file, functions as text with 13 digits", ".unv", write_uff58},      //
    {"mat", "MATLAB MAT-file of version 5, a structure a channel", ".mat", write_mat},       //
    {"csv", "table of numbers, comma separated, read back bit for bit", ".csv", write_csv},  //
}};

}  // namespace

std::span<const Exporter> exporters() {
  return table;
}

namespace {

/// Throws datasets::FileError when no format is named so or has the path's ending.
const Exporter& exporter_for(const std::string& path, std::string_view format) {
  const std::string name = lowered(path.substr(path.find_last_of('/') + 1));
  const std::size_t dot = name.find_last_of('.');
  const std::string ending = dot == std::string::npos ? std::string() : name.substr(dot);
  for (const Exporter& exporter : table) {
    if (exporter.id == format) return exporter;
    if (!format.empty()) continue;
    for (const std::string_view known : cells_of(exporter.endings, ' '))
      if (known == ending) return exporter;
  }
  std::string list;
  for (const Exporter& exporter : table)
    list += fmt::format("{}{} ({})", list.empty() ? "" : ", ", exporter.endings, exporter.id);
  throw datasets::FileError(
      path, format.empty()
                ? fmt::format("the ending '{}' is of no format that is written; known are {}",
                              ending, list)
                : fmt::format("there is no format '{}' to write; known are {}", format, list));
}

std::vector<std::string> write_and_read_back(const Exporter& exporter,
                                             const OutgoingRecording& recording,
                                             const std::string& path) {
  std::vector<std::string> warnings;
  const OutgoingRecording written =
      exporter.id == "csv" ? without_single_numbers(recording, warnings) : recording;
  std::ranges::move(exporter.write(written, path), std::back_inserter(warnings));
  if (exporter.id == own_format) return warnings;  // holds all
  std::ranges::move(not_read_back(written, path), std::back_inserter(warnings));
  return warnings;
}

}  // namespace

std::vector<std::string> export_recording(const datasets::Record& record, const std::string& path,
                                          std::string_view format) {
  const Exporter& exporter = exporter_for(path, format);
  if (exporter.id == own_format) {  // compressed, as what is in memory can be
    datasets::write_record(record, path);
    return {};
  }
  return write_and_read_back(exporter, outgoing(record), path);
}

std::vector<std::string> export_recording(const datasets::Record& record,
                                          const SpooledRecording& samples, const std::string& path,
                                          std::string_view format) {
  return write_and_read_back(exporter_for(path, format), outgoing(record, samples), path);
}

}  // namespace impactrig::acquisition
