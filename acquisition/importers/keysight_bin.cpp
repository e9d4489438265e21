// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/waveform_container.hpp"

namespace impactrig::acquisition {

int recognises_keysight_bin(std::string_view, std::string_view head) {
  if (head.starts_with("AG01") || head.starts_with("AG03") || head.starts_with("AG10")) return 100;
  return 0;
}

std::unique_ptr<RecordingReader> open_keysight_bin(const std::string& path, const ImportOptions&) {
  return open_waveform_container(std::make_unique<MappedFile>(path), {"AG", "Keysight", false});
}

}  // namespace impactrig::acquisition
