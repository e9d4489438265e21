// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "acquisition/importers/lvm_recording.hpp"
#include "acquisition/recording_reader.hpp"

namespace impactrig::acquisition {

/// The first lines of a large LabVIEW measurement file.
struct LvmFirstLines {
  double bytes = 0.0;         ///< of the segments read; where there is one, of its rows
  double bytes_behind = 0.0;  ///< that the file has beyond them
  std::uint64_t rows = 0;     ///< in `bytes`
  bool one_heading = false;   ///< packets follow without a header of their own
  bool several_x = false;     ///< every channel has an X column of its own
  int segments = 0;           ///< read, the last one in part
};

/// The head of a file of which only these lines were read, into `recording`, which is finished by
/// this. Where the rows behind them are as long and the header declares about as many samples, it
/// is believed. A segment behind them is assumed to go on where the one before ends, unless those
/// read do not; a warning says so.
RecordingHead expected_head(LvmRecording& recording, const LvmFirstLines& read);

}  // namespace impactrig::acquisition
