// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace impactrig::acquisition {

/// What of a WAVE file is read: its chunks of format, texts and samples [Microsoft and IBM,
/// "Multimedia Programming Interface and Data Specifications 1.0", 1991; RF64: EBU Tech 3306; BW64,
/// which is laid out alike: ITU-R BS.2088; Wave64: Sonic Foundry, later Sony, "Wave64"].
/// Views into the file's bytes.
struct WaveChunks {
  bool big_endian = false;
  std::string_view format;              ///< content of the first "fmt "; empty: the file has none
  std::string_view broadcast;           ///< content of the first "bext"
  std::vector<std::string_view> texts;  ///< chunks within "LIST" of "INFO", each with its head
  int data_chunks = 0;
  std::size_t samples = 0;         ///< byte at which the first "data" begins
  std::uint64_t sample_bytes = 0;  ///< those that are there
  /// How many of them the head does not count, as of a recorder that was stopped.
  std::uint64_t uncounted = 0;
  /// Of the file, as its head has it; 0: it says nothing of it.
  std::uint64_t declared_bytes = 0;
  std::vector<std::string> warnings;  ///< what is damaged, as sentences
};

bool is_wave(std::string_view head);

/// The same with names of 16 bytes and sizes of 64 bits.
bool is_wave64(std::string_view head);

/// The chunks of a file for which is_wave() or is_wave64() holds; of others there are none. Damage before the samples is
/// passed over up to the next "data", damage behind them ends the file, with a warning. Takes time
/// in proportion to the chunks, at most to the file's size.
WaveChunks wave_chunks(std::string_view bytes);

/// The head of a WAVE file that has these chunks, undamaged, in the usual order, and whose samples
/// are all that follows it: what is handed to libsndfile, which takes minutes (1.2.0) for some
/// damaged ones.
std::string undamaged_head(const WaveChunks& chunks);

}  // namespace impactrig::acquisition
