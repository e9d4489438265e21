// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string_view>

#include "acquisition/importers/mapped_file.hpp"
#include "acquisition/recording_reader.hpp"

namespace impactrig::acquisition {

/// What differs between the makers that write Agilent's container of waveforms.
struct WaveformContainer {
  std::string_view cookie;  ///< "AG", "RG"
  std::string_view maker;   ///< "Keysight"
  /// Rigol's x origin is how long before the trigger the first sample lies, not when.
  bool origin_before_trigger = false;
};

/// Opens a file that has been recognised by its cookie.
std::unique_ptr<RecordingReader> open_waveform_container(std::unique_ptr<MappedFile> file,
                                                         const WaveformContainer& format);

}  // namespace impactrig::acquisition
