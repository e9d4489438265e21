// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "tests/acquisition/byte_writer.hpp"

namespace impactrig::acquisition::tests {

/// A LeCroy waveform; what a test does not name is a sound one of three words.
struct Trc {
  std::string before = "";  ///< "#9000000362"
  std::string pattern = "LECROY_2_3";
  bool big_endian = false;
  std::uint16_t type = 1;  ///< 0 bytes, 1 words
  std::string label = "";
  std::string unit = "V";
  std::string x_unit = "S";
  float gain = 0.5F;
  float offset = 1.0F;
  float interval = 1e-9F;
  double start = -2e-9;
  std::uint16_t record_type = 0;
  std::uint16_t source = 1;
  std::int32_t user_text = 7;  ///< bytes
  std::int32_t segments = 1;
  std::int16_t segments_asked = 0;  ///< 0: not stated, as in the five that follow
  std::int32_t first_valid = 0;
  std::int32_t last_valid = 0;
  std::int32_t first_point = 0;
  std::int32_t sparsing = 0;
  std::int16_t ris_sweeps = 0;
  std::vector<double> ris_times;                    ///< [s]
  std::vector<std::pair<double, double>> triggers;  ///< since the first, to the first sample [s]
  std::vector<double> samples = {2, -4, 6};
  std::vector<double> second;  ///< samples of the second array
  std::int16_t year = 2022;
  double second_of_trigger = 52.5;

  std::string bytes() const {
    if (pattern == "LECROY_1_0") return bytes_of_template_1();
    const std::size_t width = type == 0 ? 1 : 2;
    ByteWriter out(big_endian);
    out.text(0, "WAVEDESC").text(16, pattern);
    out.put(32, type).put(34, static_cast<std::uint16_t>(big_endian ? 0 : 1));
    out.put(36, std::int32_t{346}).put(40, user_text);
    out.put(48, static_cast<std::int32_t>(16 * triggers.size()));
    out.put(52, static_cast<std::int32_t>(8 * ris_times.size()));
    out.put(60, static_cast<std::int32_t>(width * samples.size()));
    out.put(64, static_cast<std::int32_t>(width * second.size()));
    out.text(76, "LECROYWR64Xi-A").put(92, std::int32_t{50699}).text(96, label);
    out.put(116, static_cast<std::int32_t>(samples.size())).put(144, segments);
    out.put(124, first_valid).put(128, last_valid).put(132, first_point).put(136, sparsing);
    out.put(174, segments_asked).put(322, ris_sweeps);
    out.put(156, gain).put(160, offset).put(172, std::int16_t{8});
    out.put(176, interval).put(180, start).text(196, unit).text(244, x_unit);
    out.put(296, second_of_trigger).put(304, std::uint8_t{23}).put(305, std::uint8_t{9});
    out.put(306, std::uint8_t{9}).put(307, std::uint8_t{11}).put(308, year);
    out.put(316, record_type).put(326, std::uint16_t{2}).put(328, 10.0F).put(344, source);
    out.resize(346 + static_cast<std::size_t>(user_text));
    for (const auto& [since_first, first] : triggers) out.add(since_first).add(first);
    for (const double time : ris_times) out.add(time);
    for (const auto* row : {&samples, &second})
      for (const double sample : *row)
        type == 0 ? out.add(static_cast<std::int8_t>(sample))
                  : out.add(static_cast<std::int16_t>(sample));
    return before + out.bytes();
  }

 private:
  /// Without RIS times and parts of waveforms.
  std::string bytes_of_template_1() const {
    const std::size_t width = type == 0 ? 1 : 2;
    ByteWriter out(big_endian);
    out.text(0, "WAVEDESC").text(16, pattern);
    out.put(32, type).put(34, static_cast<std::uint16_t>(big_endian ? 0 : 1));
    out.put(36, std::int32_t{320}).put(40, user_text);
    out.put(44, static_cast<std::int32_t>(16 * triggers.size()));
    out.put(48, static_cast<std::int32_t>(width * samples.size()));
    out.put(52, static_cast<std::int32_t>(width * second.size()));
    out.text(56, "LeCroy 7200 DSO").put(72, std::int32_t{7200}).text(76, label);
    out.put(92, static_cast<std::int32_t>(samples.size()));
    out.put(100, first_valid).put(104, last_valid).put(108, segments);
    out.put(112, std::int32_t{segments_asked}).put(120, gain).put(124, offset);
    out.put(132, std::int16_t{8}).put(134, interval).put(138, start);
    out.text(154, unit).text(202, x_unit);
    out.put(250, 52.5).put(258, std::uint8_t{23}).put(259, std::uint8_t{9});
    out.put(260, std::uint8_t{9}).put(261, std::uint8_t{11}).put(262, year);
    out.put(270, record_type).put(276, std::uint16_t{2}).put(278, 10.0F);
    out.put(290, 20 * offset).put(296, static_cast<std::uint16_t>(source + 1));
    out.resize(320 + static_cast<std::size_t>(user_text));
    for (const auto& [since_first, first] : triggers) out.add(since_first).add(first);
    for (const auto* row : {&samples, &second})
      for (const double sample : *row)
        type == 0 ? out.add(static_cast<std::int8_t>(sample))
                  : out.add(static_cast<std::int16_t>(sample));
    return before + out.bytes();
  }
};

inline std::vector<std::string> lecroy_trc_seeds() {
  std::vector<std::string> seeds;
  for (const bool big : {false, true})
    for (const std::uint16_t type : std::vector<std::uint16_t>{0, 1}) {
      Trc file;
      file.big_endian = big;
      file.type = type;
      seeds.push_back(file.bytes());
      file.before = "#9000000362";
      file.segments = 2;
      file.samples = {1, 2, 3, 4};
      file.triggers = {{0.0, -1e-9}, {1.0, -2e-9}};
      seeds.push_back(file.bytes());
    }
  Trc old;
  old.pattern = "LECROY_1_0";
  old.triggers = {{0.0, -1e-9}, {1.0, -2e-9}};
  seeds.push_back(old.bytes());
  Trc part;
  part.first_valid = 1;
  part.last_valid = 1;
  part.sparsing = 2;
  part.ris_times = {0.0, 1e-10};
  seeds.push_back(part.bytes());
  part.segments = 1;
  part.segments_asked = 3;
  seeds.push_back(part.bytes());
  Trc extrema;
  extrema.record_type = 6;
  extrema.second = {1, 2, 3};
  seeds.push_back(extrema.bytes());
  return seeds;
}

}  // namespace impactrig::acquisition::tests
