// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "acquisition/importers/channel_rows.hpp"
#include "acquisition/importers/quoted_lines.hpp"
#include "acquisition/importers/text_file.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Record;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using tests::import_error;
using tests::imported;
using tests::names_and_units;
using tests::WrittenFile;

constexpr int samples = 100;

std::string force(int k) {
  return fmt::format("{:.4f}", 3.0 * std::sin(0.1 * k));
}

std::string velocity(int k) {
  return fmt::format("{:.4f}", 0.5 * std::cos(0.07 * k));
}

std::string time(int k) {
  return fmt::format("{:.5f}", 1e-5 * k);
}

template <typename Cell>
std::string row_of(const std::string& begin, const Cell& cell, const std::string& delimiter) {
  std::string row = begin;
  for (int k = 0; k < samples; ++k) row += (row.empty() ? "" : delimiter) + cell(k);
  return row + "\n";
}

/// The force and velocity above at 100 kHz.
void expect_the_record(const Record& record) {
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_NEAR(record.channels[0].clock.interval, 1e-5, 1e-15);
  for (int k = 0; k < samples; ++k) {
    const auto i = static_cast<std::size_t>(k);
    EXPECT_EQ(record.channels[0].value(i), std::stod(force(k)));
    EXPECT_EQ(record.channels[1].value(i), std::stod(velocity(k)));
  }
}

TEST(ChannelRows, AreReadAsChannels) {
  const std::string text = "# written by savetxt\n" + row_of("", time, "\t") +
                           row_of("", force, "\t") + row_of("", velocity, "\t");
  const Record record = imported(text);
  expect_the_record(record);
  EXPECT_EQ(record.attributes.at("channels in"), "rows");
  EXPECT_THAT(record.warnings,
              Contains("the file is 3 lines of many numbers: each is taken for a channel (or the "
                       "times of the others), not for a sample"));
}

TEST(ChannelRows, MayBeginWithNameAndUnit) {
  for (const char* delimiter : {",", ";", "\t"}) {
    const std::string d = delimiter;
    for (const auto& [t, f, v] : {std::array{"Time (s)", "Force (N)", "Velocity (m/s)"},
                                  std::array{"Time%s", "Force%N", "Velocity%m/s"}}) {
      std::string text = row_of(t, time, d) + row_of(f, force, d) + row_of(v, velocity, d);
      for (std::size_t at = text.find('%'); at != text.npos; at = text.find('%'))
        text.replace(at, 1, d);
      const Record record = imported(text);
      expect_the_record(record);
      EXPECT_THAT(names_and_units(record), ElementsAre("Force [N]", "Velocity [m/s]"));
    }
  }
}

TEST(ChannelRows, MayStandUnderTitlesAndKeys) {
  for (const char* delimiter : {",", ";", "\t", " "}) {
    const std::string d = delimiter;
    expect_the_record(imported("Drop test 7, bar B\n\n" + row_of("", time, d) +
                               row_of("", force, d) + row_of("", velocity, d)));
  }
  const Record record =
      imported("Drop test 7\nSampling rate [kHz];100\n" + row_of("Force (N)", force, ";") +
               row_of("v (m/s)", velocity, ";"));
  expect_the_record(record);
  EXPECT_THAT(names_and_units(record), ElementsAre("Force [N]", "v [m/s]"));
  EXPECT_THAT(import_error("Drop test 7\nnotes of the day\n"), HasSubstr("no row of numbers"));
}

TEST(ChannelRows, MayBeDividedByBlanksOrHaveDecimalCommas) {
  expect_the_record(
      imported(row_of("", time, "  ") + row_of("", force, "  ") + row_of("", velocity, "  ")));
  std::string text = row_of("", time, ";") + row_of("", force, ";") + row_of("", velocity, ";");
  for (char& c : text)
    if (c == '.') c = ',';
  expect_the_record(imported(text));
}

TEST(ChannelRows, MayBeOneAlone) {
  const Record record = imported(row_of("", force, ","));
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_EQ(record.channels[0].size(), static_cast<std::size_t>(samples));
  EXPECT_THAT(record.warnings, Contains(HasSubstr("the file is 1 line of many numbers: it is taken "
                                                  "for a channel, not for a sample")));
}

TEST(ChannelRows, ThatAreShorterThanOthersLackTheirLastSamples) {
  for (const char* delimiter : {",", " "}) {
    std::string shorter = row_of("", velocity, delimiter);
    shorter = shorter.substr(0, shorter.rfind(delimiter[0])) + "\n";
    const Record record =
        imported(row_of("", time, delimiter) + row_of("", force, delimiter) + shorter);
    ASSERT_EQ(record.channels.size(), 2U);
    EXPECT_EQ(record.channels[1].size(), static_cast<std::size_t>(samples));
    EXPECT_EQ(record.channels[1].valid.back(), 0);
    EXPECT_EQ(record.channels[1].valid.front(), 1);
  }
}

TEST(ChannelRows, AnErrorNamesThePlaceInTheFile) {
  std::string spoilt = row_of("", force, ",");
  const std::size_t at = spoilt.find(force(90));
  spoilt.replace(at, force(90).size(), "1.2.3");
  const std::string times = row_of("", time, ",");
  EXPECT_THAT(import_error(times + spoilt),
              HasSubstr(fmt::format("FILE:2:{} (byte {}): column 1: expected a number, found "
                                    "'1.2.3'",
                                    at + 1, times.size() + at)));
}

TEST(ChannelRows, AreNotSeenWhereRowsAreSamples) {
  std::string channels;  // one sample of so many channels, under their names
  std::string numbers;
  for (int k = 0; k < samples; ++k) {
    channels += fmt::format("{}ch{} [N]", k > 0 ? "," : "", k);
    numbers += (k > 0 ? "," : "") + force(k);
  }
  EXPECT_EQ(imported(channels + "\n" + numbers + "\n").channels.size(),
            static_cast<std::size_t>(samples));
  // as many rows as an eighth of the cells and more
  std::string square;
  for (int k = 0; k < samples / 4; ++k) square += numbers + "\n";
  EXPECT_EQ(imported(square).channels.size(), static_cast<std::size_t>(samples));
}

TEST(ChannelRows, AreNotSeenUnderNamesInARemarkOrBesideDates) {
  std::string names = "# time";
  std::string numbers = "time";
  for (int k = 1; k < samples; ++k) names += fmt::format(",ch{}", k);
  for (int k = 1; k < samples; ++k) numbers += fmt::format(",{}", k);
  const auto row = [](const std::string& begin) { return row_of(begin, force, ","); };
  for (const std::string& text :
       {names + "\n" + row_of("", force, ",") + row_of("", velocity, ","),
        numbers + "\n" + row("0.1").substr(0, row("0.1").rfind(',')) + "\n",
        row("12:00:01") + row("12:00:02"), row("2024-01-01 12:00:01") + row("2024-01-01 12:00:02")})
    EXPECT_FALSE(imported(text).attributes.contains("channels in")) << text.substr(0, 40);
  // a name in one row alone
  EXPECT_FALSE(
      imported(row_of("Force", force, ",") + row_of("", velocity, ",") + row_of("", velocity, ","))
          .attributes.contains("channels in"));
}

TEST(ChannelRows, OfOneChannelKeepTheirDecimalMark) {
  std::string text = row_of("Force (N)", force, ";");
  for (char& c : text)
    if (c == '.') c = ',';
  const Record record = imported(text + "# end\n\x1A");
  EXPECT_THAT(names_and_units(record), ElementsAre("Force [N]"));
  EXPECT_EQ(record.channels[0].value(7), std::stod(force(7)));
}

TEST(ChannelRows, MayHaveThousandsSeparators) {
  const auto grouped = [](int k) { return fmt::format("1 {:03}.50", k); };
  for (const std::string& text :
       {row_of("", grouped, "\t"), row_of("", grouped, "\t") + row_of("", grouped, "\t")}) {
    const Record record = imported(text);
    ASSERT_GE(record.channels.size(), 1U);
    ASSERT_EQ(record.channels.back().size(), static_cast<std::size_t>(samples));
    EXPECT_EQ(record.channels.back().value(7), 1007.5);
  }
}

// Its head says more than the first megabyte.
TEST(ChannelRows, OfALargeTextInUtf16AreTurnedForItsHeadToo) {
  constexpr int many = 1'500'000;
  std::string text;
  for (int line = 0; line < 2; ++line) {
    for (int k = 0; k < many; ++k) text += fmt::format("{}{:.6f}", k > 0 ? "," : "", 1e-6 * k);
    text += '\n';
  }
  std::string bytes = "\xFF\xFE";
  for (const char c : text) {
    bytes += c;
    bytes += '\0';
  }
  const WrittenFile written(bytes, ".csv");
  ImportOptions head;
  head.head_only = true;
  const auto reader = open_recording(written.path(), head);
  ASSERT_EQ(reader->head().record.channels.size(), 1U);
  EXPECT_EQ(reader->head().record.attributes.at("channels in"), "rows");
}

// 36 MB: more than is turned in memory.
TEST(ChannelRows, OfALargeFileAreTurnedOnTheDisk) {
  constexpr int many = 2'000'000;
  std::string text;
  text.reserve(40'000'000);
  for (int k = 0; k < many; ++k) text += fmt::format("{}{:.6f}", k > 0 ? "," : "", 1e-6 * k);
  text += '\n';
  const std::size_t second = text.size();
  for (int k = 0; k < many; ++k)
    text += fmt::format("{}{:.5f}", k > 0 ? "," : "", 0.001 * (k % 997));
  text += '\n';
  const WrittenFile written(text, ".csv");
  TextFile file(written.path());
  auto rows = find_channel_rows(file, {});
  ASSERT_TRUE(rows);
  file.turn(std::move(*rows));
  EXPECT_TRUE(file.text().starts_with("0.000000,0.00000\n0.000001,0.00100\n"));
  EXPECT_TRUE(file.text().ends_with("1.999999,0.01700\n"));
  const std::size_t line = file.text().find("\n0.000002,") + 10;
  EXPECT_EQ(file.position(file.text().data() + line).byte, second + 16);
  const Record record = import_recording(written.path(), {});
  ASSERT_EQ(record.channels.size(), 1U);
  ASSERT_EQ(record.channels[0].size(), static_cast<std::size_t>(many));
  EXPECT_NEAR(record.channels[0].clock.interval, 1e-6, 1e-15);
  EXPECT_EQ(record.channels[0].value(1'999'998), 0.016);
}

TEST(QuotedLines, AreReadAsIfTheQuotesWereNotThere) {
  for (const char* delimiter : {";", "\t", ",", "|"}) {
    std::string text = fmt::format("\"Time [s]{0}Force [N]{0}Velocity [m/s]\"\r\n", delimiter);
    for (int k = 0; k < samples; ++k)
      text += fmt::format("\"{1}{0}{2}{0}{3}\"\r\n", delimiter, time(k), force(k), velocity(k));
    std::string returns = text;
    std::erase(returns, '\n');
    for (const std::string& bytes :
         {text, "\xEF\xBB\xBF" + text, tests::utf16(text), tests::utf16(text, false), returns}) {
      const Record record = imported(bytes);
      expect_the_record(record);
      EXPECT_THAT(names_and_units(record), ElementsAre("Force [N]", "Velocity [m/s]"));
    }
  }
}

TEST(QuotedLines, MayHoldNamesInQuotes) {
  const Record record = imported(
      "\"\"\"Time [s]\"\",\"\"Force, left [N]\"\"\"\n\"0.0,1.5\"\n\"0.1,2.5\"\n\"0.2,3.5\"\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Force, left [N]"));
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1.5, 2.5, 3.5));
}

TEST(QuotedLines, MayBeInACodePage) {
  ImportOptions options;
  options.encoding = "CP932";
  const Record record =
      imported("\"t [s];\x97\xCD [N]\"\n\"0.0;1.5\"\n\"0.1;2.5\"\n\"0.2;3.5\"\n", options);
  EXPECT_THAT(names_and_units(record), ElementsAre("力 [N]"));
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1.5, 2.5, 3.5));
}

TEST(QuotedLines, MayHoldDecimalCommasInQuotes) {
  const Record record = imported(
      "\"\"\"t [s]\"\",\"\"F [N]\"\"\"\n\"\"\"0,0\"\",\"\"1,5\"\"\"\n\"\"\"0,1\"\",\"\"2,5\"\"\"\n"
      "\"\"\"0,2\"\",\"\"3,5\"\"\"\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("F [N]"));
  EXPECT_NEAR(record.channels[0].clock.interval, 0.1, 1e-12);
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1.5, 2.5, 3.5));
}

TEST(QuotedLines, KeepTheirPlacesInErrors) {
  EXPECT_THAT(import_error("\"t [s];F [N]\"\n\"0.0;1.5\"\n\"0.1;2.5\"\n\"0.2;x\"\n\"0.3;2\"\n"),
              HasSubstr("FILE:4:6: F: expected a number, found 'x'"));
}

TEST(QuotedLines, AreNotThoseOfOneCellOrOfCellsInQuotes) {
  for (const char* text :
       {"\"1,5\"\n\"2,5\"\n\"3,5\"\n", "\"1,234.5\"\n\"2,234.5\"\n", "\"a\",\"b\"\n\"1\",\"2\"\n",
        "\"0.5\";\"1\"\n\"0.6\";\"2\"\n", "\"only words\"\n\"and more words\"\n",
        "\"t;F\"\n0;1\n1;2\n", "t;F\n\"0;1\"\n\"1;2\"\n"})
    EXPECT_FALSE(has_quoted_lines(text)) << text;
  EXPECT_TRUE(has_quoted_lines("\"t;F\"\n\"0;1\"\n\"1;2\"\n\"2;"));
  EXPECT_TRUE(has_quoted_lines("\"t;F\"\n\"0;1\"\n\"1;2\"\n"));
}

// Pieces end with lines, so that no line is divided.
TEST(QuotedLines, OnTheDiskAreTheSame) {
  const std::string text = "\"t;F\"\n\"0;1\"\r\n\n\"1;2\"\n\"2;3\"";
  const WrittenFile written(text);
  const MappedFile file(written.path());
  for (const std::size_t piece : {4U, 6U, 9U, 100U})
    EXPECT_EQ(rewritten(file, without_quoted_lines(no_rewriting(0)), piece)->bytes(),
              " t;F \n 0;1 \r\n\n 1;2 \n 2;3 ")
        << piece;
  for (const bool little : {true, false}) {
    const std::string wide = tests::utf16(u"\"t;ĀਅĀ\"\n\"0;1\"\r\n\"1;2\"\n\"2;3\"", little);
    const WrittenFile wide_file(wide, ".wide");
    const MappedFile mapped(wide_file.path());
    for (const std::size_t piece : {4U, 6U, 22U, 100U})
      EXPECT_EQ(rewritten(mapped, without_quoted_lines(utf16_rewriting(wide)), piece)->bytes(),
                " t;ĀਅĀ \n 0;1 \r\n 1;2 \n 2;3 ")
          << piece;
  }
}

TEST(Csv, TextMayStandInTheFirstColumn) {
  const Record record =
      imported("Status,Time (s),Force (N)\nOK,0.0,1.5\nOK,0.1,2.5\nTRIG,0.2,3.5\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Force [N]"));
  EXPECT_NEAR(record.channels[0].clock.interval, 0.1, 1e-12);
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1.5, 2.5, 3.5));
  EXPECT_THAT(record.warnings,
              ElementsAre("'Status' holds text ('OK'), no numbers: it is left out"));
  EXPECT_THAT(import_error("a note of 2,5,7 things\nand one of 8,9,1 more\n"),
              HasSubstr("no row of numbers"));
}

// As pandas' melt() and databases of time series write them.
TEST(Csv, ARowForEachChannelAtEachTimeIsRefused) {
  EXPECT_THAT(import_error("t,sensor,value\n0.000,F,1\n0.000,v,100\n0.001,F,2\n0.001,v,101\n"
                           "0.002,F,3\n0.002,v,102\n"),
              HasSubstr("FILE:2:1 (byte 15): the table has a row for each 'sensor' ('F', 'v', ...) "
                        "at each time: write a column for each"));
  for (const char* rows : {"0.000,OK,1\n0.001,hit,2\n0.002,OK,3\n0.003,hit,4\n",
                           "0.000,OK,1\n0.000,hit,2\n0.001,OK,3\n0.002,OK,4\n0.003,hit,1\n",
                           // times in so few digits that samples share them
                           "0.0,OK,1\n0.0,hit,2\n0.0,OK,3\n0.0,hit,4\n0.1,OK,1\n0.1,hit,2\n"
                           "0.1,OK,3\n0.1,hit,4\n"})
    EXPECT_EQ(imported(std::string("t,state,F (N)\n") + rows).channels.size(), 1U) << rows;
}

TEST(Csv, AColumnOfTextMayBeginWithMissingValues) {
  const Record record = imported("Time (s),Event,Force (N)\n0.0,NAN,1.5\n0.1,NAN,2.5\n0.2,hit,3\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Force [N]"));
  EXPECT_THAT(record.warnings, ElementsAre(HasSubstr("'Event' holds text ('hit'), no numbers")));
}

}  // namespace
}  // namespace impactrig::acquisition
