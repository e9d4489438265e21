// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/waveform_container.hpp"

namespace impactrig::acquisition {

int recognises_rigol_bin(std::string_view, std::string_view head) {
  return head.starts_with("RG01") || head.starts_with("RG03") ? 100 : 0;
}

std::unique_ptr<RecordingReader> open_rigol_bin(const std::string& path, const ImportOptions&) {
  return open_waveform_container(std::make_unique<MappedFile>(path), {"RG", "Rigol", true});
}

}  // namespace impactrig::acquisition
