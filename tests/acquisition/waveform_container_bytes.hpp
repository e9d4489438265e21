// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/acquisition/byte_writer.hpp"

namespace impactrig::acquisition::tests {

/// One buffer of a waveform.
struct ContainerBuffer {
  std::uint16_t type = 1;   ///< 1 normal, 2 maximum, 3 minimum, 4 time, 5 counts, 6 digital
  std::uint16_t width = 4;  ///< 4 single precision, 1 byte
  std::vector<float> samples = {1.5F, -2.0F, 3.0F};
};

struct ContainerWaveform {
  std::string label = "CH2";
  std::uint32_t header_size = 140;
  std::uint32_t type = 1;
  std::uint32_t x_unit = 2;
  std::uint32_t y_unit = 1;
  std::uint32_t segment = 0;
  double time_tag = 0.0;
  double interval = 1e-6;
  double origin = -2e-6;
  std::string date = "22 NOV 2020";
  std::string time = "19:02:34";
  std::vector<ContainerBuffer> buffers = {{}};
};

/// Agilent's container as Keysight ("AG") and Rigol ("RG") write it.
struct WaveformFile {
  std::string cookie = "AG10";
  std::vector<ContainerWaveform> waveforms = {{}};
  std::uint32_t announced = 0;  ///< waveforms, where it lies

  void size(ByteWriter& out, std::size_t value) const {
    cookie.ends_with("03") ? out.add(std::uint64_t{value})
                           : out.add(static_cast<std::uint32_t>(value));
  }

  std::string bytes() const {
    ByteWriter out;
    out.add_text(cookie);
    size(out, 0);
    out.add(announced != 0 ? announced : static_cast<std::uint32_t>(waveforms.size()));
    for (const ContainerWaveform& waveform : waveforms) {
      const std::size_t start = out.size();
      out.add(waveform.header_size).add(waveform.type);
      out.add(static_cast<std::uint32_t>(waveform.buffers.size()));
      out.add(static_cast<std::uint32_t>(
          waveform.buffers.empty() ? 0 : waveform.buffers.front().samples.size()));
      out.add(std::uint32_t{1}).add(0.0F).add(0.0).add(waveform.interval).add(waveform.origin);
      out.add(waveform.x_unit).add(waveform.y_unit);
      out.add_text(waveform.date, 16).add_text(waveform.time, 16);
      out.add_text("DSO-X 1102G:CN1", 24).add_text(waveform.label, 16);
      if (waveform.header_size >= 140) out.add(waveform.time_tag).add(waveform.segment);
      out.resize(std::max<std::size_t>(out.size(), start + std::min(waveform.header_size, 200U)));
      for (const ContainerBuffer& buffer : waveform.buffers) {
        out.add(std::uint32_t{cookie.ends_with("03") ? 16U : 12U});
        out.add(buffer.type).add(buffer.width);
        size(out, buffer.width * buffer.samples.size());
        for (const float sample : buffer.samples)
          buffer.width == 1 ? out.add(static_cast<std::uint8_t>(sample)) : out.add(sample);
      }
    }
    if (cookie.ends_with("03"))
      out.put(4, std::uint64_t{out.size()});
    else
      out.put(4, static_cast<std::uint32_t>(out.size()));
    return out.bytes();
  }
};

inline std::vector<std::string> container_seeds(const std::string& maker) {
  std::vector<std::string> seeds;
  for (const char* version : {"01", "03", "10"}) {
    WaveformFile file;
    file.cookie = maker + version;
    file.waveforms.resize(2);
    file.waveforms[1].label = "1";
    file.waveforms[1].buffers = {{2, 4, {1.0F, 2.0F}}, {3, 4, {0.0F, 1.0F}}, {6, 1, {1.0F, 0.0F}}};
    seeds.push_back(file.bytes());
  }
  return seeds;
}

inline std::vector<std::string> keysight_bin_seeds() {
  return container_seeds("AG");
}

inline std::vector<std::string> rigol_bin_seeds() {
  return container_seeds("RG");
}

}  // namespace impactrig::acquisition::tests
