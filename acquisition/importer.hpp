// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/recording_reader.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// What the user may state where a file does not, or states it wrongly. Every importer honours what
/// applies to it.
struct ImportOptions {
  std::string format;             ///< importer id; "" = recognise
  std::optional<char> delimiter;  ///< text
  std::optional<char> decimal;    ///< '.' or ','
  /// Text: what iconv calls its code page, "CP932"; "" = UTF-8, UTF-16, Windows-1252, or what its
  /// words look like, with a warning. InputError where the format is none of text tables.
  std::string encoding;
  /// Text: lines before the column names (or the data when there are none).
  std::optional<int> skip_lines;
  std::optional<std::string> time_column;  ///< name, or index from 0; "none" = there is none
  std::optional<double> sample_rate;       ///< [Hz]; replaces what the file says
  /// One a column of a text, one a channel of other formats that take them: replaces what the file
  /// says; "" = leave that one. InputError where they are more or fewer, or the format takes none.
  std::vector<std::string> units;
  /// true: a recording without times and without a sample rate is an InputError that names
  /// --sample-rate. false (inspect): it is a warning, and SampleClock::interval is 0.
  bool require_clock = true;
  /// true (inspect --no-statistics): nothing but the head is wanted. That of a large text is then
  /// what its first MB lets expect, and its read() throws std::logic_error.
  bool head_only = false;
  /// Channels to read, by name or by index from 0; empty: all. HDF5 of somebody else's: paths of
  /// data sets.
  std::vector<std::string> channels;
  double from = -std::numeric_limits<double>::infinity();  ///< time of the first sample read [s]
  double to = std::numeric_limits<double>::infinity();     ///< of the last [s]
};

/// One recording format: its two functions in one file of importers/, one line in importers.cpp.
struct Importer {
  std::string_view id;           ///< "uff58"
  std::string_view description;  ///< one line, with the file endings
  /// How sure the format is from the file's name and first bytes (up to 64 KiB): 0 not mine, 100
  /// certain. A specific format beats a generic one.
  int (*recognises)(std::string_view file_name, std::string_view head);
  /// Reads the head. Throws what open_recording throws.
  std::unique_ptr<RecordingReader> (*open)(const std::string& path, const ImportOptions& options);
};

/// All formats, most specific first.
std::span<const Importer> importers();

/// Whether a file of a folder is meant as a recording: a format's own first bytes, or the ending of
/// a table. Any text with a number in it may be a table when it is named; found in a folder it is
/// not. An empty file is meant as one by any recording's ending. false for what cannot be read.
bool looks_like_recording(const std::string& path);

/// The files that a recording is made of: the one of that name, and the one beside it that holds
/// its samples (Yokogawa's .wvf, NI's .tdx). Throws datasets::FileError.
std::vector<std::string> files_of_recording(const std::string& path);

std::uint64_t bytes_of_recording(const std::string& path);  ///< of all its files

/// SHA-256 of its files, one behind the other, 64 hex digits. Throws datasets::FileError.
std::string sha256_of_recording(const std::string& path);

/// Opens a recording of any known format. Its provenance states size, importer and program
/// version. Samples that are not finite are handed over as not valid, and a warning counts them. A
/// file without recordings gives a head without channels and a warning. Channels over anything but
/// time (a spectrum) have the attribute "domain" and no clock (interval 0). Throws
/// datasets::FileError (cannot be opened) or datasets::InputError (unknown format, broken content).
std::unique_ptr<RecordingReader> open_recording(const std::string& path,
                                                const ImportOptions& options = {});

/// What `options` asks for of an opened recording. Throws datasets::InputError, which lists the
/// channels, for one that is not there.
Selection selection_of(const RecordingHead& head, const ImportOptions& options);

/// Opens a recording and reads what is asked for into memory; its provenance has the SHA-256 too.
datasets::Record import_recording(const std::string& path, const ImportOptions& options = {});

}  // namespace impactrig::acquisition
