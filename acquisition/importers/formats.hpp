// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "acquisition/importer.hpp"

/// The formats that importers.cpp lists. Each pair is an Importer's `recognises` and its `open`, or
/// a `read` of the whole file, and lives in a file of its own name.
namespace impactrig::acquisition {

int recognises_uff58b(std::string_view file_name, std::string_view head);
int recognises_uff58(std::string_view file_name, std::string_view head);
datasets::Record read_uff58(const std::string& path, const ImportOptions& options);

int recognises_polytec_ascii(std::string_view file_name, std::string_view head);
datasets::Record read_polytec_ascii(const std::string& path, const ImportOptions& options);

int recognises_lvm(std::string_view file_name, std::string_view head);
datasets::Record read_lvm(const std::string& path, const ImportOptions& options);

int recognises_mat(std::string_view file_name, std::string_view head);
std::unique_ptr<RecordingReader> open_mat(const std::string& path, const ImportOptions& options);

int recognises_wav(std::string_view file_name, std::string_view head);
std::unique_ptr<RecordingReader> open_wav(const std::string& path, const ImportOptions& options);

int recognises_sigrok(std::string_view file_name, std::string_view head);
std::unique_ptr<RecordingReader> open_sigrok(const std::string& path, const ImportOptions& options);

int recognises_csv(std::string_view file_name, std::string_view head);
datasets::Record read_csv(const std::string& path, const ImportOptions& options);

int recognises_hdf5(std::string_view file_name, std::string_view head);
datasets::Record read_hdf5(const std::string& path, const ImportOptions& options);

int recognises_foreign_hdf5(std::string_view file_name, std::string_view head);
std::unique_ptr<RecordingReader> open_foreign_hdf5(const std::string& path,
                                                   const ImportOptions& options);
/// A MAT-file of version 7.3.
std::unique_ptr<RecordingReader> open_mat73(const std::string& path, const ImportOptions& options);

/// What a file is that we know but do not read, and how its content can be brought here; "" for
/// anything else.
std::string closed_format(std::string_view head);

}  // namespace impactrig::acquisition
