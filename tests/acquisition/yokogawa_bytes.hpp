// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <vector>

namespace impactrig::acquisition::tests {

/// A head as a WE7000 writes it, of two traces in one group.
inline std::string yokogawa_head(std::string_view format = "Block", std::string_view endian = "Ltl",
                                 int blocks = 1, std::string_view type = "IS2",
                                 std::string_view offset = "0") {
  return fmt::format(
      "//YOKOGAWA ASCII FILE FORMAT\r\n\r\n$PublicInfo\r\nFormatVersion     1.01\r\n"
      "Model             WE7273\r\nEndian            {}\r\nDataFormat        {}\r\n"
      "GroupNumber       1\r\nTraceTotalNumber  2\r\nDataOffset        {}\r\n\r\n"
      "$Group1\r\nTraceNumber       2\r\nBlockNumber       {}\r\n"
      "TraceName         CH1            Hammer\r\nBlockSize         3              2\r\n"
      "VResolution       5.0e-001       2.0e+000\r\nVOffset           -1.0e+000      0.0e+000\r\n"
      "VDataType         {}            IS2\r\nVUnit             V              N\r\n"
      "VPlusOverData     100            32015\r\nVMinusOverData    -100           -32014\r\n"
      "VIllegalData      NAN            7\r\nHResolution       1.0e-004       1.0e-003\r\n"
      "HOffset           -2.0e-004      0.0e+000\r\nHUnit             s              s\r\n"
      "Date              2016/01/22     2016/01/22\r\n"
      "Time              16:27:26       16:27:26\r\n\r\n$PrivateInfo\r\nRefFileNumber     0\r\n",
      endian, format, offset, blocks, type);
}

inline std::vector<std::string> yokogawa_seeds() {
  return {yokogawa_head(), yokogawa_head("Trace", "Big", 2)};
}

}  // namespace impactrig::acquisition::tests
