// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/importer.hpp"

/// The formats that importers.cpp lists. Each pair is an Importer's `recognises` and its `open`, or
/// a `read` of the whole file, and lives in a file of its own name.
namespace impactrig::acquisition {

int recognises_uff58b(std::string_view file_name, std::string_view head);
int recognises_uff58(std::string_view file_name, std::string_view head);
std::unique_ptr<RecordingReader> open_uff58(const std::string& path, const ImportOptions& options);
/// As open_uff58 does for large files, whatever the size.
std::unique_ptr<RecordingReader> open_uff58_by_blocks(const std::string& path,
                                                      const ImportOptions& options);

int recognises_polytec_ascii(std::string_view file_name, std::string_view head);
std::unique_ptr<RecordingReader> open_polytec_ascii(const std::string& path,
                                                    const ImportOptions& options);
/// As open_polytec_ascii does for large files, whatever the size.
std::unique_ptr<RecordingReader> open_polytec_ascii_by_blocks(const std::string& path,
                                                              const ImportOptions& options);

int recognises_tdms(std::string_view file_name, std::string_view head);
std::unique_ptr<RecordingReader> open_tdms(const std::string& path, const ImportOptions& options);

/// A description in XML; its samples are in the .tdx beside it.
int recognises_tdm(std::string_view file_name, std::string_view head);
/// The files of samples beside a description; none where it cannot be read.
std::vector<std::string> samples_of_tdm(const std::string& path);
std::unique_ptr<RecordingReader> open_tdm(const std::string& path, const ImportOptions& options);

int recognises_mdf4(std::string_view file_name, std::string_view head);
std::unique_ptr<RecordingReader> open_mdf4(const std::string& path, const ImportOptions& options);
int recognises_lvm(std::string_view file_name, std::string_view head);
std::unique_ptr<RecordingReader> open_lvm(const std::string& path, const ImportOptions& options);
/// As open_lvm does for large files, whatever the size: by blocks where counting tells all there is
/// to know (one segment on the clock of its header), else by way of the disk.
std::unique_ptr<RecordingReader> open_lvm_by_blocks(const std::string& path,
                                                    const ImportOptions& options);
/// What the whole lines of the first `looked_at` bytes say; None where the whole file has to be
/// read to know its head, or what is wrong with it.
std::optional<RecordingHead> estimated_lvm_head(const std::string& path,
                                                const ImportOptions& options,
                                                std::size_t looked_at);

int recognises_mat(std::string_view file_name, std::string_view head);
std::unique_ptr<RecordingReader> open_mat(const std::string& path, const ImportOptions& options);

int recognises_numpy(std::string_view file_name, std::string_view head);
std::unique_ptr<RecordingReader> open_numpy(const std::string& path, const ImportOptions& options);

int recognises_wav(std::string_view file_name, std::string_view head);
std::unique_ptr<RecordingReader> open_wav(const std::string& path, const ImportOptions& options);

int recognises_aiff(std::string_view file_name, std::string_view head);
std::unique_ptr<RecordingReader> open_aiff(const std::string& path, const ImportOptions& options);

int recognises_sigrok(std::string_view file_name, std::string_view head);
std::unique_ptr<RecordingReader> open_sigrok(const std::string& path, const ImportOptions& options);

int recognises_csv(std::string_view file_name, std::string_view head);
std::unique_ptr<RecordingReader> open_csv(const std::string& path, const ImportOptions& options);
/// As open_csv does for large files, whatever the size.
std::unique_ptr<RecordingReader> open_csv_by_blocks(const std::string& path,
                                                    const ImportOptions& options);

int recognises_tek_wfm(std::string_view file_name, std::string_view head);
std::unique_ptr<RecordingReader> open_tek_wfm(const std::string& path,
                                              const ImportOptions& options);

int recognises_tek_isf(std::string_view file_name, std::string_view head);
std::unique_ptr<RecordingReader> open_tek_isf(const std::string& path,
                                              const ImportOptions& options);

int recognises_lecroy_trc(std::string_view file_name, std::string_view head);
std::unique_ptr<RecordingReader> open_lecroy_trc(const std::string& path,
                                                 const ImportOptions& options);

int recognises_keysight_bin(std::string_view file_name, std::string_view head);
std::unique_ptr<RecordingReader> open_keysight_bin(const std::string& path,
                                                   const ImportOptions& options);

int recognises_rigol_bin(std::string_view file_name, std::string_view head);
std::unique_ptr<RecordingReader> open_rigol_bin(const std::string& path,
                                                const ImportOptions& options);

int recognises_rigol_wfm(std::string_view file_name, std::string_view head);
std::unique_ptr<RecordingReader> open_rigol_wfm(const std::string& path,
                                                const ImportOptions& options);

int recognises_catman(std::string_view file_name, std::string_view head);
std::unique_ptr<RecordingReader> open_catman(const std::string& path, const ImportOptions& options);

/// A head in text; its samples are in the .wvf beside it.
int recognises_yokogawa_wvf(std::string_view file_name, std::string_view head);
/// The file of samples beside a head; "": it is not there.
std::string samples_of_yokogawa_wvf(const std::string& path);
std::unique_ptr<RecordingReader> open_yokogawa_wvf(const std::string& path,
                                                   const ImportOptions& options);

int recognises_imc_raw(std::string_view file_name, std::string_view head);
std::unique_ptr<RecordingReader> open_imc_raw(const std::string& path,
                                              const ImportOptions& options);

int recognises_hdf5(std::string_view file_name, std::string_view head);
std::unique_ptr<RecordingReader> open_hdf5(const std::string& path, const ImportOptions& options);

int recognises_foreign_hdf5(std::string_view file_name, std::string_view head);
std::unique_ptr<RecordingReader> open_foreign_hdf5(const std::string& path,
                                                   const ImportOptions& options);
/// A MAT-file of version 7.3.
std::unique_ptr<RecordingReader> open_mat73(const std::string& path, const ImportOptions& options);

/// What a file is that we know but do not read, and how its content can be brought here; "" for
/// anything else. The ending tells whose file a container is that several programs use.
std::string closed_format(std::string_view file_name, std::string_view head);

/// The same by the ending of a file whose content is of no known format.
std::string closed_ending(std::string_view file_name);

}  // namespace impactrig::acquisition
