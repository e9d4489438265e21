// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "acquisition/importer.hpp"
#include "acquisition/importers/text_encoding.hpp"
#include "acquisition/importers/text_file.hpp"
#include "tests/acquisition/written_file.hpp"

/// Text that is neither UTF-8 nor Windows-1252. The bytes are those that Python's codecs make.
namespace impactrig::acquisition {
namespace {

using datasets::Record;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::import_error;
using tests::imported;
using tests::names_and_units;
using tests::WrittenFile;

// Second bytes of three of these are | and \, as delimiters are
constexpr const char* japanese =
    "\x8E\x9E\x8A\xD4 [s],\x95\xCF\x88\xCA\x83Z\x83\x93\x83T [mm],"
    "\x83|\x83\x93\x83v\x95\\\x8E\xA6 [N]\n";
constexpr const char* chinese =
    "\xCA\xB1\xBC\xE4\xA3\xA8s\xA3\xA9,\xC1\xA6\xA3\xA8N\xA3\xA9,\xCB\xD9\xB6\xC8\xA3\xA8m/s"
    "\xA3\xA9\n";
constexpr const char* russian =
    "\xC2\xF0\xE5\xEC\xFF, \xEC\xF1;\xD1\xE8\xEB\xE0, \xCD;"
    "\xD1\xEA\xEE\xF0\xEE\xF1\xF2\xFC, \xEC/\xF1\n";
constexpr const char* russian_capitals = "\xC2\xD0\xC5\xCC\xDF (\xF1);\xD1\xC8\xCB\xC0 (\xCD)\n";
constexpr const char* korean =
    "\xBD\xC3\xB0\xA3 (s),\xC7\xCF\xC1\xDF (N),\xBC\xD3\xB5\xB5 (m/s),\xBA\xAF\xC0\xA7 (mm),"
    "\xB0\xA1\xBC\xD3\xB5\xB5 (g),\xBF\xC2\xB5\xB5\n";
constexpr const char* polish =
    "Czas [s];Si\xB3"
    "a [N];Pr\xEA"
    "dko\x9C\xE6 [m/s]\n";

std::string spoken_of(const std::string& code_page) {
  return "the text is not UTF-8 and is read as " + code_page +
         ", which its words look like (--encoding names another)";
}

TEST(CodePage, IsToldByTheWords) {
  EXPECT_EQ(likely_code_page(japanese), "CP932");
  EXPECT_EQ(likely_code_page(chinese), "GB18030");
  EXPECT_EQ(likely_code_page("\xC1\xA6\xB4\xAB\xB8\xD0\xC6\xF7,\xBC\xD3\xCB\xD9\xB6\xC8\xBC\xC6\n"),
            "GB18030");
  EXPECT_EQ(likely_code_page(russian), "CP1251");
  EXPECT_EQ(likely_code_page(russian_capitals), "CP1251");
  EXPECT_EQ(likely_code_page(korean), "CP949");
}

TEST(CodePage, IsNotSeenInWesternTextOrUtf8) {
  for (const char* text :
       {"Gr\xF6\xDF"
        "e [\xB5m/m\xB2],Temp\xE9rature [\xB0"
        "C]\n",
        "\xC4\xD6\xDC [s],F [N]\n", "\xB5\xB1\xB2\xB3 [s]\n", "\x97\x97\x97\x97\x97\x97\n",
        "\xA6\xA6\xA6\xA6\xA6\xA6\n", polish, "Time [s],F [N]\n", "",
        "Umlaute: \xE4\xF6\xFC \xC4\xD6\xDC \xDF\nZeit [s],Gr\xF6\xDF"
        "e [N]\n",
        "\u65F6\u95F4 [s],\u529B [N]\n", "\u0412\u0440\u0435\u043C\u044F, \u043C\u0441\n"})
    EXPECT_EQ(likely_code_page(text), "") << text;
  const std::string utf8 = "\u65F6\u95F4\u65F6\u95F4\u65F6\u95F4";
  for (std::size_t cut = 1; cut < 4; ++cut)
    EXPECT_EQ(likely_code_page(utf8.substr(0, utf8.size() - cut)), "") << cut;
}

TEST(CodePage, IsReadInATable) {
  Record record = imported(japanese + std::string("0,1,2\n1e-3,3,4\n"));
  EXPECT_THAT(names_and_units(record), ElementsAre("変位センサ [mm]", "ポンプ表示 [N]"));
  EXPECT_EQ(record.channels[0].clock.interval, 1e-3);
  EXPECT_THAT(record.warnings, ElementsAre(spoken_of("CP932")));

  record = imported(chinese + std::string("0,1,2\n1e-3,3,4\n"));
  EXPECT_THAT(names_and_units(record), ElementsAre("力 [N]", "速度 [m/s]"));
  EXPECT_EQ(record.channels[1].quantity, datasets::Quantity::velocity);

  record = imported(russian + std::string("0;1,5;2\n0,001;3,5;4\n"));
  EXPECT_THAT(names_and_units(record), ElementsAre("Сила [Н]", "Скорость [м/с]"));
  EXPECT_EQ(record.channels[0].quantity, datasets::Quantity::force);
  EXPECT_EQ(record.channels[1].quantity, datasets::Quantity::velocity);
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 1e-6) << "мс";
}

TEST(CodePage, MayBeStated) {
  ImportOptions options;
  options.encoding = "CP1250";
  const std::string rows = "0;1;2\n0.001;3;4\n";
  Record record = imported(polish + rows, options);
  EXPECT_THAT(names_and_units(record), ElementsAre("Siła [N]", "Prędkość [m/s]"));
  EXPECT_THAT(record.warnings, IsEmpty());

  options.encoding = "windows-1252";  // against what the words look like
  record = imported(russian + rows, options);
  EXPECT_THAT(names_and_units(record), Contains(HasSubstr("\u00D1\u00E8\u00EB\u00E0")));
  EXPECT_THAT(record.warnings, Not(Contains(HasSubstr("look like"))));
}

TEST(CodePage, HasToBeKnownAndToExtendAscii) {
  EXPECT_TRUE(is_code_page("SHIFT_JIS"));
  for (const char* name : {"", "none", "UTF-16", "UTF-32LE", "EBCDIC-US"})
    EXPECT_FALSE(is_code_page(name)) << name;
  ImportOptions options;
  options.encoding = "none";
  EXPECT_EQ(import_error("Time [s],F [N]\n0,1\n1,2\n", options, ".csv"),
            "FILE: the encoding 'none' is not known; `iconv -l` lists those that are, of which the "
            "ones that extend ASCII can be read");
  options.format = "tdms";
  EXPECT_EQ(import_error("TDSm", options, ".tdms"),
            "FILE: --encoding is not for the format tdms, but for tables of text");
}

// What a page has no character for, and one that the end cuts off.
TEST(CodePage, MakesReplacementCharactersOfWhatIsNone) {
  const Rewriting rewriting = code_page_rewriting("CP932", false);
  EXPECT_EQ(rewriting.part("a\x83Z\xFF"
                           "b\x83"),
            "a\u30BB\uFFFDb\uFFFD");
}

// Whatever the pieces, and with either end of a line: no character is cut in two.
TEST(CodePage, OnTheDiskBecomesTheSameUtf8) {
  const std::string lines = japanese + std::string("1,2,3\n\x95\\,\x83|\n") + japanese;
  for (const bool returns : {false, true}) {
    std::string bytes = lines;
    if (returns) std::ranges::replace(bytes, '\n', '\r');
    const WrittenFile written(bytes);
    const Rewriting rewriting = code_page_rewriting("CP932", returns);
    const std::string expected = rewriting.part(bytes);
    EXPECT_THAT(expected, HasSubstr("\n表,ポ\n時間"));
    const MappedFile file(written.path());
    for (std::size_t piece = 4; piece < bytes.size() + 2; ++piece)
      EXPECT_EQ(rewritten(file, rewriting, piece)->bytes(), expected) << piece;
  }
}

// 34 MB, which are rewritten on the disk; for the head alone the first lines are.
TEST(CodePage, OfALargeFileIsReadWithItsLength) {
  std::string bytes = chinese;
  const std::size_t rows = (std::size_t{34} << 20) / 8;
  bytes.reserve(bytes.size() + 8 * rows);
  for (std::size_t i = 0; i < rows; ++i) bytes += i % 2 == 0 ? "1,2,3.0\n" : "2,2,4.0\n";
  const WrittenFile written(bytes, ".csv");
  TextFile file(written.path(), false, "GB18030");
  EXPECT_TRUE(file.text().starts_with("时间（s）,力（N）"));
  EXPECT_TRUE(file.text().ends_with("\n2,2,4.0\n"));
  TextFile head(written.path(), true, "GB18030");
  EXPECT_TRUE(head.text().starts_with("时间（s）,力（N）"));
  EXPECT_NEAR(head.expected_size(), static_cast<double>(file.text().size()),
              1e-4 * static_cast<double>(file.text().size()));
}

TEST(CodePage, IsReadInALabviewMeasurement) {
  const Record record = imported(
      "LabVIEW Measurement\nSeparator\tTab\nDecimal_Separator\t.\nX_Columns\tNo\n"
      "***End_of_Header***\nChannels\t1\nSamples\t2\nY_Unit_Label\tN\nX_Dimension\tTime\nX0\t0\n"
      "Delta_X\t0.001\n***End_of_Header***\nX_Value\t\xC1\xA6\xB4\xAB\xB8\xD0\xC6\xF7\n\t1\n\t2\n",
      {}, ".lvm");
  EXPECT_THAT(names_and_units(record), ElementsAre("力传感器 [N]"));
  EXPECT_THAT(record.warnings, Contains(spoken_of("GB18030")));
}

}  // namespace
}  // namespace impactrig::acquisition
