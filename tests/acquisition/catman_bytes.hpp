// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/acquisition/byte_writer.hpp"

namespace impactrig::acquisition::tests {

/// One channel of a catman file.
struct CatmanColumn {
  std::string name = "force";
  std::string unit = "N";
  std::string comment = "";
  std::string formula = "";
  std::int16_t format = 0;
  std::int16_t width = 8;
  std::int32_t header_bytes = 148;
  double interval = 0.5;       ///< [ms]
  std::uint8_t precision = 1;  ///< 0: 8 bytes, 1: 4 bytes, 2: 2 bytes
  double low = 0.0;            ///< of 2 bytes
  double high = 32767.0;
  std::int32_t length = -1;  ///< announced, -1: as many as there are
  std::vector<double> samples = {1, 2, 3};
};

/// A catman binary export.
struct Catman {
  std::int16_t id = 5012;
  std::string comment = "drop test";
  std::int32_t data_offset = 0;  ///< 0: right behind the header
  std::int16_t channels = -1;    ///< announced, -1: as many as there are
  std::int32_t longest = 0;      ///< the maximum channel length
  std::int32_t reduction = 0;    ///< the reduction factor
  double date = 44663.5;         ///< 2022-04-12, noon
  std::vector<CatmanColumn> columns = {
      {.name = "Time  1", .unit = "s", .samples = {0.0, 0.0005, 0.001}}, {}};

  static void text(ByteWriter& out, const std::string& text) {
    out.add(static_cast<std::int16_t>(text.size())).add_text(text);
  }

  std::string bytes() const {
    ByteWriter out;
    out.add(id).add(data_offset);
    text(out, comment);
    for (int i = 0; id != 5010 && i < 32; ++i) text(out, " ");
    out.add(channels < 0 ? static_cast<std::int16_t>(columns.size()) : channels);
    out.add(longest);
    for (std::size_t i = 0; i < columns.size(); ++i) out.add(std::int32_t{0});
    out.add(reduction);
    for (const CatmanColumn& column : columns) {
      out.add(std::int16_t{0});
      out.add(column.length < 0 ? static_cast<std::int32_t>(column.samples.size()) : column.length);
      text(out, column.name);
      text(out, column.unit);
      text(out, column.comment);
      out.add(column.format).add(column.width).add(date).add(column.header_bytes);
      const std::size_t header = out.size();
      out.put(header, date).put(header + 8, column.interval);
      out.text(header + 52, "9E5001CCB       ");
      out.put(header + 140, column.precision);
      out.resize(header + 148);
      out.add(std::uint8_t{0}).add(std::uint8_t{0}).add(std::uint8_t{1}).add(1.0);
      out.add(std::int16_t{0});
      text(out, column.formula);
      if (id > 5011)
        out.add(std::int32_t{68}).add(std::int16_t{1}).add_text("strain gage", 50).add_text("", 16);
    }
    if (data_offset == 0) out.put(2, static_cast<std::int32_t>(out.size()));
    if (data_offset > 0) out.resize(static_cast<std::size_t>(data_offset));
    for (const CatmanColumn& column : columns) {
      if (column.precision == 2) out.add(column.low).add(column.high);
      for (const double sample : column.samples) {
        if (column.precision == 0) out.add(sample);
        if (column.precision == 1) out.add(static_cast<float>(sample));
        if (column.precision == 2) out.add(static_cast<std::int16_t>(std::max(sample, -32768.0)));
      }
    }
    return out.bytes();
  }
};

inline std::vector<std::string> catman_seeds() {
  std::vector<std::string> seeds;
  for (const std::uint8_t precision : std::vector<std::uint8_t>{0, 1, 2}) {
    Catman file;
    for (CatmanColumn& column : file.columns) column.precision = precision;
    file.columns[1].samples[1] = -1000000.0;
    seeds.push_back(file.bytes());
    file.id = static_cast<std::int16_t>(5010 + precision);
    file.columns[0].interval = 0.0;
    file.columns[0].samples = {0, 1, 7};
    seeds.push_back(file.bytes());
  }
  return seeds;
}

}  // namespace impactrig::acquisition::tests
