// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "tests/acquisition/byte_writer.hpp"

namespace impactrig::acquisition::tests {

/// A Tektronix preamble and curve; what a test does not name is a sound one with long keys.
struct Isf {
  bool short_keys = false;
  bool big_endian = true;
  std::string encoding = "BIN";
  std::string format = "RI";
  int width = 2;
  std::string id = "Ch2, DC coupling, 1.0E0 V/div; probe";
  std::string point_format = "Y";
  std::string more = "";  ///< keys before the curve, each with its semicolon
  std::string scaling = "YMULT 5.0E-1;YOFF 2.0E0;YZERO 1.0E0;";
  std::vector<double> samples = {2, -4, 6};
  std::string block = "";  ///< instead of "#<digits><length>"

  void number(ByteWriter& out, double value) const {
    if (format == "FP") {
      width == 4 ? out.add(static_cast<float>(value)) : out.add(value);
    } else if (format == "RP") {
      if (width == 1) out.add(static_cast<std::uint8_t>(static_cast<int>(value)));
      if (width == 2) out.add(static_cast<std::uint16_t>(static_cast<int>(value)));
      if (width == 4) out.add(static_cast<std::uint32_t>(static_cast<int>(value)));
    } else {
      if (width == 1) out.add(static_cast<std::int8_t>(value));
      if (width == 2) out.add(static_cast<std::int16_t>(value));
      if (width == 4) out.add(static_cast<std::int32_t>(value));
    }
  }

  std::string head() const {
    std::string text = fmt::format(
        ":WFMPRE:BYT_NR {};BIT_NR {};ENCDG {};BN_FMT {};BYT_OR {};NR_PT {};WFID \"{}\";PT_FMT {};"
        "XINCR 1.0E-6;PT_OFF 1;XZERO -1.0E-6;XUNIT \"s\";{}YUNIT \"V\";{}:CURVE ",
        width, 8 * width, encoding, format, big_endian ? "MSB" : "LSB", samples.size(), id,
        point_format, scaling, more);
    if (!short_keys) return text;
    for (const auto& [full, abbreviated] :
         std::vector<std::pair<std::string, std::string>>{{":WFMPRE:BYT_NR", ":WFMP:BYT_N"},
                                                          {"BIT_NR", "BIT_N"},
                                                          {"ENCDG", "ENC"},
                                                          {"BN_FMT", "BN_F"},
                                                          {"BYT_OR", "BYT_O"},
                                                          {"NR_PT", "NR_P"},
                                                          {"WFID", "WFI"},
                                                          {"PT_FMT", "PT_F"},
                                                          {"XINCR", "XIN"},
                                                          {"PT_OFF", "PT_O"},
                                                          {"XZERO", "XZE"},
                                                          {"XUNIT", "XUN"},
                                                          {"YMULT", "YMU"},
                                                          {"YOFF", "YOF"},
                                                          {"YZERO", "YZE"},
                                                          {"YUNIT", "YUN"},
                                                          {":CURVE", ":CURV"}})
      if (const std::size_t at = text.find(full); at != std::string::npos)
        text.replace(at, full.size(), abbreviated);
    return text;
  }

  std::string bytes() const {
    if (encoding == "ASC") {
      std::string list;
      for (const double sample : samples)
        list += fmt::format("{}{}", list.empty() ? "" : ",", sample);
      return head() + list + "\n";
    }
    ByteWriter out(big_endian);
    for (const double sample : samples) number(out, sample);
    const std::string length = std::to_string(out.size());
    const std::string mark = block.empty() ? fmt::format("#{}{}", length.size(), length) : block;
    return head() + mark + out.bytes() + "\n";
  }
};

inline std::vector<std::string> tek_isf_seeds() {
  std::vector<std::string> seeds;
  for (const bool short_keys : {false, true})
    for (const bool big : {false, true}) {
      Isf file;
      file.short_keys = short_keys;
      file.big_endian = big;
      seeds.push_back(file.bytes());
    }
  Isf ascii;
  ascii.encoding = "ASC";
  seeds.push_back(ascii.bytes());
  Isf envelope;
  envelope.point_format = "ENV";
  envelope.format = "RP";
  envelope.width = 1;
  seeds.push_back(envelope.bytes());
  seeds.push_back(ascii.bytes() + ascii.bytes());
  seeds.push_back(
      ":WFMPRE:BYT_NR 1;ENCDG BIN;CH1:NR_PT 2;NR_FR 2;YMULT 1;CH2:NR_PT 4;YMULT 2;:CURVE #14abcd,"
      "#14efgh\n");
  return seeds;
}

}  // namespace impactrig::acquisition::tests
