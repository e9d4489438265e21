// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/acquisition/byte_writer.hpp"

namespace impactrig::acquisition::tests {

/// A DS1000Z waveform; what a test does not name is a sound one of input 1.
struct Rigol1000z {
  std::string firmware = "00.04.04.SP4";
  std::uint8_t enabled = 1;
  std::uint32_t logic = 0;
  std::int64_t delay = 0;  ///< [ps]
  float rate = 0.25F;      ///< [GHz]
  float scale = 2.0F;      ///< [V a division]
  float shift = 3.0F;
  std::uint8_t inverted = 0;
  std::uint8_t unit = 2;
  std::vector<std::uint8_t> samples = {127, 147, 107, 187};
  std::uint32_t depth = 4;

  std::string bytes() const {
    ByteWriter out;
    out.text(0, "\x01\xFF\xFF\xFF\xA5\xA5").text(8, "DS1054Z").text(28, firmware);
    out.put(64, std::uint64_t{50000}).put(72, delay).put(88, enabled).put(108, logic);
    out.put(116, depth).put(120, rate);
    for (std::size_t input = 0; input < 4; ++input) {
      const std::size_t head = 124 + 28 * input;
      out.put(head, std::uint8_t{1}).put(head + 8, scale).put(head + 12, shift);
      out.put(head + 16, inverted).put(head + 17, unit);
    }
    out.put(256, std::uint32_t{20}).put(260, std::uint32_t{300});
    out.resize(320);
    for (const std::uint8_t sample : samples) out.add(sample);
    return out.bytes();
  }
};

/// A DS1000E or D waveform with both inputs.
struct Rigol1000e {
  std::array<bool, 2> enabled = {true, true};
  std::array<std::vector<std::uint8_t>, 2> samples = {{{125, 100, 150, 125}, {125, 75, 125, 125}}};
  std::uint32_t depth = 4;
  std::uint32_t depth2 = 0;  ///< 0 that of the first
  std::uint32_t roll_stop = 0;
  std::int32_t scale = 1000000;  ///< [uV a division]
  std::int16_t shift = 25;
  float probe = 1.0F;
  std::uint8_t inverted = 0;
  std::uint8_t logic = 0;
  std::uint8_t trigger_mode = 0;
  float rate = 1e5F;
  std::int64_t delay = 0;  ///< [ps]
  float rate2 = 1e6F;

  std::string bytes() const {
    ByteWriter out;
    out.text(0, std::string("\xA5\xA5\0\0", 4)).put(20, roll_stop).put(28, depth);
    for (std::size_t input = 0; input < 2; ++input) {
      const std::size_t head = 36 + 24 * input;
      out.put(head + 8, probe).put(head + 13, static_cast<std::uint8_t>(enabled[input] ? 1 : 0));
      out.put(head + 14, inverted).put(head + 16, scale).put(head + 20, shift);
    }
    out.put(100, rate).put(112, delay).put(120, logic).put(142, trigger_mode).put(232, depth2);
    out.put(252, rate2).put(264, delay);
    out.resize(276);
    for (std::size_t input = 0; input < 2; ++input)
      if (enabled[input])
        for (const std::uint8_t sample : samples[input]) out.add(sample);
    return out.bytes();
  }
};

/// A DS2000 waveform; the samples of input 1 lie at 300, those of input 2 at 400.
struct Rigol2000 {
  std::string serial = "DS2D162450999";
  std::string firmware = "00.03.05.03.03";
  std::uint8_t enabled = 3;
  std::uint8_t interwoven = 0;
  std::uint8_t input = 8;  ///< 1 in files of older firmware
  std::array<std::vector<std::uint8_t>, 2> samples = {{{127, 152, 102, 127}, {127, 177, 77, 127}}};
  std::uint32_t points = 4;
  std::uint32_t unsound = 0;  ///< samples before the first sound one
  std::uint32_t second = 400;
  float scale = 0.05F;  ///< [V a division]
  float shift = 0.1F;
  std::uint8_t inverted = 0;
  std::uint8_t unit = 2;
  float rate = 1e9F;
  std::int64_t delay = 4480000;  ///< [ps]

  std::string bytes() const {
    ByteWriter out;
    out.text(0, std::string("\xA5\xA5\x38\0", 4)).text(4, serial).text(24, firmware);
    out.put(64, enabled).put(65, interwoven).put(68, std::uint32_t{300}).put(72, second);
    out.put(96, rate).put(112, delay);
    for (std::size_t i = 0; i < 2; ++i) {
      const std::size_t head = 120 + 28 * i;
      out.put(head, input).put(head + 8, scale).put(head + 12, shift);
      out.put(head + (input == 1 ? 16 : 17), inverted).put(head + (input == 1 ? 17 : 16), unit);
    }
    out.put(248, unsound).put(252, points);
    out.resize(300);
    for (const std::uint8_t sample : samples[0]) out.add(sample);
    out.resize(400);
    for (const std::uint8_t sample : samples[1]) out.add(sample);
    return out.bytes();
  }
};

inline std::vector<std::string> rigol_wfm_seeds() {
  std::vector<std::string> seeds;
  for (const std::uint8_t enabled : std::vector<std::uint8_t>{1, 3, 7, 15}) {
    Rigol1000z file;
    file.enabled = enabled;
    file.samples.resize(16, 120);
    file.depth = 16;
    seeds.push_back(file.bytes());
  }
  seeds.push_back(Rigol1000e{}.bytes());
  Rigol1000e rolled;
  rolled.roll_stop = 1;
  rolled.trigger_mode = 4;
  seeds.push_back(rolled.bytes());
  seeds.push_back(Rigol2000{}.bytes());
  Rigol2000 interwoven;
  interwoven.enabled = 2;
  interwoven.interwoven = 1;
  interwoven.input = 1;
  interwoven.points = 8;
  seeds.push_back(interwoven.bytes());
  return seeds;
}

}  // namespace impactrig::acquisition::tests
