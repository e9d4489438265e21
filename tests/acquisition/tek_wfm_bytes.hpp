// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "tests/acquisition/byte_writer.hpp"

namespace impactrig::acquisition::tests {

/// A Tektronix reference waveform; what a test does not name is a sound one of three samples.
struct TekWfm {
  int version = 3;
  bool big_endian = false;
  std::int32_t format = 0;  ///< 0 to 7: i16, i32, u32, u64, f32, f64, u8, i8
  std::uint8_t width = 2;   ///< stated bytes a point
  std::string label = "";
  std::string unit = "V";
  std::string x_unit = "s";
  double scale = 0.5;
  double offset = 1.0;
  double interval = 1e-6;
  double start = -2e-6;
  std::int32_t data_type = 2;
  std::int32_t storage = 0;
  std::int32_t time_base = 0;
  std::uint16_t summary = 0;  ///< last frame: 1 average, 2 envelope of the others; from version 2
  std::int32_t gmt = 1649763107;  ///< 2022-04-12T11:31:47Z
  double fraction = 0.25;
  std::vector<std::vector<double>> frames = {{2, -4, 6}};
  std::uint32_t before = 1;  ///< points before and behind a frame's samples that are none
  std::uint32_t behind = 1;
  std::vector<std::pair<std::string, std::string>> meta;

  std::size_t vertical() const { return version == 1 ? 166 : 168; }

  std::size_t horizontal() const { return version == 3 ? 488 : vertical() + 312; }

  std::size_t base() const { return version == 3 ? 760 : vertical() + 576; }

  std::size_t update() const { return base() + 24; }

  std::size_t curve() const { return update() + 24; }

  std::size_t head_size() const { return curve() + 30; }

  void number(ByteWriter& out, double value) const {
    using enum NumberForm;
    constexpr std::array forms = {i16, i32, u32, u64, f32, f64, u8, i8};
    out.add(forms[format < 0 || format > 7 ? 7 : static_cast<std::size_t>(format)], value);
  }

  static std::uint32_t size(std::size_t value) { return static_cast<std::uint32_t>(value); }

  std::string bytes() const {
    const std::size_t points = frames.empty() ? 0 : frames.front().size();
    const std::size_t extra = frames.size() - 1;
    const std::size_t curve_offset = head_size() + 54 * extra;
    ByteWriter out(big_endian);
    out.put(0, std::uint16_t{0x0F0F});
    if (big_endian) out.put(0, std::uint16_t{0xF0F0});
    out.text(2, ":WFM#00" + std::to_string(version));
    out.put(15, width);
    out.put(16, static_cast<std::int32_t>(curve_offset));
    out.text(40, label);
    out.put(72, size(extra));
    out.put(78, std::int32_t{extra > 0 ? 1 : 0});
    out.put(122, data_type);
    if (version > 1) out.put(154, summary);
    out.put(vertical(), scale).put(vertical() + 8, offset).text(vertical() + 20, unit);
    out.put(vertical() + 72, format).put(vertical() + 76, storage);
    out.put(horizontal(), interval).put(horizontal() + 8, start);
    out.text(horizontal() + 20, x_unit);
    out.put(base() + 8, time_base);
    out.put(update() + 4, 0.5).put(update() + 12, fraction).put(update() + 20, gmt);
    const std::size_t data = before * width;
    const std::size_t end = data + points * width;
    const std::size_t frame = end + behind * width;
    out.put(curve() + 14, size(data)).put(curve() + 18, size(end)).put(curve() + 22, size(frame));
    out.resize(head_size());
    for (std::size_t k = 1; k <= extra; ++k) {
      out.add(std::uint32_t{0}).add(0.5 / static_cast<double>(1 << k));
      out.add(fraction).add(gmt + static_cast<std::int32_t>(k));
    }
    out.resize(curve_offset);
    for (const std::vector<double>& samples : frames) {
      for (std::uint32_t i = 0; i < before; ++i) number(out, 99);
      for (const double sample : samples) number(out, sample);
      for (std::uint32_t i = 0; i < behind; ++i) number(out, 99);
    }
    if (meta.empty()) return out.bytes();
    out.add(std::uint64_t{0}).add_text("tekmeta!").add(size(meta.size()));
    for (const auto& [name, value] : meta)
      out.add(size(name.size()))
          .add_text(name)
          .add(std::uint8_t{1})
          .add(size(value.size()))
          .add_text(value);
    return out.bytes();
  }
};

inline std::vector<std::string> tek_wfm_seeds() {
  std::vector<std::string> seeds;
  for (const int version : {1, 2, 3})
    for (const bool big : {false, true}) {
      TekWfm file;
      file.version = version;
      file.big_endian = big;
      file.frames = {{1, 2, 3}, {4, 5, 6}};
      file.meta = {{"yOffset", "0"}};
      seeds.push_back(file.bytes());
    }
  TekWfm floats;
  floats.format = 4;
  floats.width = 4;
  seeds.push_back(floats.bytes());
  return seeds;
}

}  // namespace impactrig::acquisition::tests
