// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/acquisition/byte_writer.hpp"

namespace impactrig::acquisition::tests {

/// "|XX,version,length,contents;"
inline std::string imc_key(const std::string& name, int version, const std::string& contents) {
  return fmt::format("|{},{},{},{};", name, version, contents.size(), contents);
}

/// One event of the key CV.
struct ImcEvent {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  double time = 0.0;
  double start = 0.0;
  double interval = 1e-3;
  double factor = 1.0;
  double shift = 0.0;
};

/// "|CV,1,length,1,count,1,72 bytes,2,72 bytes;"
inline std::string imc_events(const std::vector<ImcEvent>& events, bool big_endian = false) {
  std::string contents = fmt::format("1,{}", events.size());
  for (std::size_t i = 0; i < events.size(); ++i) {
    const ImcEvent& event = events[i];
    ByteWriter out(big_endian);
    out.add(event.first).add(event.count).add(event.time).add(event.shift).add(0.0);
    out.add(event.start).add(event.factor).add(1.0).add(event.interval);
    out.add(std::uint32_t{0}).add(std::uint32_t{0});
    contents += fmt::format(",{},", i + 1) + out.bytes();
  }
  return imc_key("CV", 1, contents);
}

/// A component of an imc FAMOS file.
struct ImcComponent {
  int format = 7;   ///< 1 to 8: u8, i8, u16, i16, u32, i32, f32, f64; 12 u64, 13 u48, 14 i64
  int digital = 1;  ///< 2 digital
  std::string range = "1,5.0E-01,1.0E+00,1,1,N";
  std::string name = "force";
  std::string packing = "";  ///< behind the format, instead of the usual
  std::string buffers = "";  ///< contents of Cb, instead of the usual
  std::string more = "";     ///< keys behind CR
  int bit = 0;               ///< of CN
  int index = 0;             ///< of CC, 0: counted
  std::uint64_t first = 0;   ///< byte of the first sample in the buffer
  std::uint64_t filled = 0;  ///< bytes, 0: all
  double start = 0.25;
  double add_time = 0.0;
  std::vector<double> samples = {2, 4, 6};

  std::size_t width() const {
    constexpr std::size_t widths[] = {0, 1, 1, 2, 2, 4, 4, 4, 8, 0, 0, 2, 8, 6, 8};
    return format < 15 ? widths[format] : 2;
  }
};

struct ImcRaw {
  bool big_endian = false;
  std::string closed = "1,1";
  int type = 1;  ///< 1 samples at equal distances, 2 and 3 over an x of their own
  std::string abscissa = "1.0E-03,1,1,s,0,0,0,0.0E+00,1";
  int abscissa_version = 2;
  std::string date = "12, 4,2022,13,31,46.5";
  std::string more = "";  ///< keys behind CF and CK
  std::vector<ImcComponent> components = {{}};
  bool one_group = false;  ///< all components in one group of keys

  void number(ByteWriter& out, int format, double value) const {
    if (format == 13) {
      const auto whole = static_cast<std::uint64_t>(value);
      const auto low = static_cast<std::uint32_t>(whole);
      const auto high = static_cast<std::uint16_t>(whole >> 32);
      big_endian ? out.add(high).add(low) : out.add(low).add(high);
      return;
    }
    using enum NumberForm;
    constexpr std::array forms = {i16, u8,  i8,  u16, i16, u32, i32, f32,
                                  f64, i16, i16, u16, u64, i16, i64};  // by format
    out.add(forms[format > 14 ? 0 : static_cast<std::size_t>(format)], value);
  }

  std::string bytes() const {
    std::string text = imc_key("CF", 2, big_endian ? "2" : "1") + imc_key("CK", 1, closed) + "\r\n";
    text += imc_key("NO", 1, "1,4,test,0,") + more;
    ByteWriter data(big_endian);
    bool first = true;
    std::size_t number_of = 0;
    for (const ImcComponent& one : components) {
      if (first || !one_group) {
        text += imc_key("CG", 1, fmt::format("{},{},1", one_group ? components.size() : 1, type));
        text += imc_key("CD", abscissa_version, abscissa) + imc_key("NT", 1, date);
      }
      first = false;
      const std::size_t offset = data.size();
      for (const double sample : one.samples) number(data, one.format, sample);
      const std::size_t size = data.size() - offset;
      ++number_of;
      text += imc_key(
          "CC", 1,
          fmt::format("{},{}", one.index > 0 ? std::size_t(one.index) : number_of, one.digital));
      text += imc_key("CP", 1,
                      fmt::format("{},{},{},{}", number_of, one.width(), one.format,
                                  one.packing.empty() ? fmt::format("{},0,0,1,0", 8 * one.width())
                                                      : one.packing));
      if (!one.range.empty()) text += imc_key("CR", 1, one.range);
      text += one.more;
      text +=
          imc_key("CN", 1, fmt::format("0,0,{},{},{},2,ok", one.bit, one.name.size(), one.name));
      text += imc_key(
          "Cb", 1,
          one.buffers.empty()
              ? fmt::format("1,0,{},1,{},{},{},{},1,{},{},", number_of, offset, size, one.first,
                            one.filled == 0 ? size : one.filled, one.start, one.add_time)
              : one.buffers);
    }
    return text + imc_key("CS", 1, "1," + data.bytes());
  }
};

inline std::vector<std::string> imc_raw_seeds() {
  std::vector<std::string> seeds;
  for (const bool big : {false, true})
    for (const int format : {2, 4, 6, 7, 8}) {
      ImcRaw file;
      file.big_endian = big;
      file.components[0].format = format;
      seeds.push_back(file.bytes());
    }
  ImcRaw digital;
  digital.components[0] = {.format = 11,
                           .digital = 2,
                           .range = "",
                           .more = imc_key("CN", 1, "0,0,2,4,back,0,"),
                           .bit = 1};
  seeds.push_back(digital.bytes());
  ImcRaw xy;
  xy.type = 2;
  xy.one_group = true;
  xy.components.resize(2);
  xy.components[1].format = 13;
  xy.components[1].range = "1,1E-06,0,1,1,s";
  seeds.push_back(xy.bytes());
  ImcRaw events;
  events.more = imc_events({{.first = 0, .count = 2}, {.first = 2, .count = 1, .time = 7.25}});
  events.components[0].more = imc_key("Cv", 1, "1,0,1,0,2,1,1,0,0");
  seeds.push_back(events.bytes());
  ImcRaw ring;
  ring.components[0].first = 4;
  ring.components.push_back({});
  seeds.push_back(ring.bytes());
  return seeds;
}

}  // namespace impactrig::acquisition::tests
