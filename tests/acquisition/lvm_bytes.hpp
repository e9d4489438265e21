// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace impactrig::acquisition::tests {

/// A LabVIEW measurement file, written from its parts; "|" stands for the separator.
struct LvmFile {
  char separator = '\t';
  std::string word = "Tab";   ///< how the header names it
  std::string decimal = ".";  ///< Decimal_Separator; "" leaves the key away
  std::string x_columns = "One";
  std::string multi_headings = "Yes";
  std::string more_keys;  ///< lines of the header

  std::string header() const {
    return with_separators(
        "LabVIEW Measurement|\nWriter_Version|2\nReader_Version|2\nSeparator|" + word + "\n" +
        (decimal.empty() ? "" : "Decimal_Separator|" + decimal + "\n") + "Multi_Headings|" +
        multi_headings + "\nX_Columns|" + x_columns + "\nTime_Pref|Absolute\n" + more_keys +
        "Date|2024/02/29\nTime|09:51:39.5\n***End_of_Header***|\n|\n");
  }

  /// A segment: the lines of its header, its names and its rows.
  std::string segment(const std::string& keys, const std::string& names,
                      const std::string& rows) const {
    return with_separators(keys + "***End_of_Header***|\n" + names + "\n" + rows);
  }

  std::string with_separators(std::string text) const {
    for (char& c : text)
      if (c == '|') c = separator;
    return text;
  }
};

/// The header of a segment of two channels with one X column or none.
inline std::string lvm_two_channels(const std::string& samples, const std::string& x0,
                                    const std::string& delta,
                                    const std::string& time = "09:51:40.25") {
  return "Channels|2|||\nSamples|" + samples + "|" + samples +
         "|\nDate|2024/02/29|2024/02/29|\nTime|" + time + "|" + time +
         "|\nY_Unit_Label|N|m/s^2|\nX_Dimension|Time|Time|\nX0|" + x0 + "|" + x0 + "|\nDelta_X|" +
         delta + "|" + delta + "|\n";
}

inline std::vector<std::string> lvm_seeds() {
  LvmFile plain;
  LvmFile comma{',', "Comma", ".", "No", "No", ""};
  LvmFile german{'\t', "Tab", ",", "Multi", "Yes", ""};
  LvmFile bare{'\t', "Tab", "", "No", "Yes", ""};
  const std::string multi_keys =
      "Channels|2||||\nSamples|2||2||\nDate|2024/02/29||2024/02/29||\nY_Unit_Label|N||g||\n"
      "X_Dimension|Time||Time||\nX0|0,0E+0||0,0E+0||\nDelta_X|0,001||0,001||\n";
  return {
      plain.header() +
          plain.segment(lvm_two_channels("2", "0", "0.001"), "X_Value|a|b|Comment",
                        "0|1|2\n0.001|3|4|hit\n\n") +
          plain.segment(lvm_two_channels("2", "0.002", "0.001"), "X_Value|a|b|Comment",
                        "0.002|5|6\n0.003|7|\n"),
      comma.header() +
          comma.segment(lvm_two_channels("1", "0", "1e-3"), "X_Value|a|b|Comment", "|1|2\n|3|4\n"),
      german.header() + "***Start_Special***\nx\n***End_Special***\n" +
          german.segment(multi_keys, "X_Value|a|X_Value|b|Comment",
                         "0,000|1,5|0,000|2,5\n0,001|3|0,001|4\n"),
      bare.header() + bare.segment(lvm_two_channels("2", "0.0", "0.000977"), "X_Value|a|b|Comment",
                                   "|1.5|\n|2.5|3\n"),
      "0.000000\t1.5\t2.5\t9\n5.0E-6\t1\t2\t\n1.0E-5\t3\t4\t\n",
  };
}

}  // namespace impactrig::acquisition::tests
