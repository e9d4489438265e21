// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/exporter.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "datasets/input_error.hpp"
#include "tests/acquisition/exported.hpp"
#include "tests/acquisition/shared_recordings.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Channel;
using datasets::Quantity;
using datasets::Record;
using tests::example;
using tests::expect_same_head;
using tests::expect_same_samples;
using tests::export_error;
using tests::export_warnings;
using tests::OutputPath;
using tests::round_trip;

class ExactExport : public testing::TestWithParam<const char*> {};

TEST_P(ExactExport, ComesBackBitForBit) {
  const Record record = example();
  const Record back = round_trip(record, GetParam());
  ASSERT_EQ(back.channels.size(), 2U);
  for (std::size_t c = 0; c < 2; ++c) {
    expect_same_head(record.channels[c], back.channels[c]);
    expect_same_samples(record.channels[c], back.channels[c]);
  }
  EXPECT_THAT(back.warnings, testing::IsEmpty());
}

TEST_P(ExactExport, KeepsAnyClock) {
  for (const double interval : {1.0 / 65536.0, 1.0 / 3.0e5, 1.0 / 44100.0, 0.1, 2e-9}) {
    for (const double start : {0.0, -1.0 / 3.0, 1234.5}) {
      Record record = example(300);
      for (Channel& channel : record.channels) {
        channel.clock.start = start;
        channel.clock.interval = interval;
      }
      SCOPED_TRACE(fmt::format("start {} s, interval {} s", start, interval));
      const Record back = round_trip(record, GetParam());
      EXPECT_EQ(back.channels[0].clock.start, start);
      EXPECT_EQ(back.channels[0].clock.interval, interval);
      EXPECT_TRUE(back.channels[0].clock.uniform());
    }
  }
}

TEST_P(ExactExport, KeepsUnevenTimes) {
  Record record = example(4);
  for (Channel& channel : record.channels)
    channel.clock = {0.1, 1.0, {0.1, 0.7, 1.1 / 3.0 + 1.0, 3.1}};
  const Record back = round_trip(record, GetParam());
  EXPECT_EQ(back.channels[0].clock.times, record.channels[0].clock.times);
  expect_same_samples(record.channels[0], back.channels[0]);
}

TEST_P(ExactExport, KeepsQuantitiesThatTheUnitDoesNotTell) {
  Record record = example(5);
  record.channels[0].quantity = Quantity::strain;
  record.channels[0].unit = "1";
  record.channels[1].quantity = Quantity::force;
  record.channels[1].unit = "";
  const Record back = round_trip(record, GetParam());
  expect_same_head(record.channels[0], back.channels[0]);
  expect_same_head(record.channels[1], back.channels[1]);
}

TEST_P(ExactExport, WritesScaledIntegersAsValues) {
  Record record = example(3);
  record.channels.resize(1);
  record.channels[0].raw = std::vector<std::int16_t>{-3, 0, 7};
  record.channels[0].scale = 0.1;
  record.channels[0].offset = 2.0;
  const Record back = round_trip(record, GetParam());
  EXPECT_EQ(back.channels[0].values(), record.channels[0].values());
}

TEST_P(ExactExport, KeepsSamplesThatAreNotFiniteAndFlagsThem) {
  Record record = example(5);
  auto& samples = std::get<std::vector<double>>(record.channels[0].raw);
  samples[3] = std::numeric_limits<double>::quiet_NaN();
  samples[4] = -std::numeric_limits<double>::infinity();
  const Record back = round_trip(record, GetParam());
  expect_same_samples(record.channels[0], back.channels[0]);
  EXPECT_THAT(back.channels[0].valid, testing::ElementsAre(1, 1, 1, 0, 0));
}

TEST_P(ExactExport, OfARecordingWithoutClockComesBackWithoutOne) {
  Record record = example(10);
  for (Channel& channel : record.channels) channel.clock = {};
  const Record back = round_trip(record, GetParam());
  ASSERT_EQ(back.channels.size(), 2U);
  EXPECT_EQ(back.channels[0].clock.interval, 0.0);
  expect_same_samples(record.channels[1], back.channels[1]);
}

TEST(Export, KeepsMarksOfSamplesThatAreNotValid) {
  Record record = example(500);
  std::get<std::vector<double>>(record.channels[0].raw)[7] =
      std::numeric_limits<double>::quiet_NaN();
  for (Channel& channel : record.channels) channel.valid.assign(500, 1);
  for (const std::size_t i : {0, 7, 17, 18, 19, 40, 499}) record.channels[0].valid[i] = 0;
  record.channels[1].valid.assign(500, 0);
  for (const char* ending : {".csv", ".mat", ".h5"}) {
    SCOPED_TRACE(ending);
    const Record back = round_trip(record, ending);
    for (std::size_t c = 0; c < 2; ++c) {
      expect_same_samples(record.channels[c], back.channels[c]);
      EXPECT_EQ(back.channels[c].valid, record.channels[c].valid);
    }
    for (const auto& [key, value] : back.attributes)
      EXPECT_THAT(key, testing::Not(testing::HasSubstr("invalid"))) << value;
  }
  record.channels[0].clock = record.channels[1].clock = {};
  EXPECT_EQ(round_trip(record, ".csv").channels[0].valid, record.channels[0].valid);
}

TEST(Export, TellsWhatAFormatHasNoPlaceFor) {
  Record record = example(60);
  EXPECT_THAT(export_warnings(record, ".uff"), testing::IsEmpty());
  record.channels[0].valid.assign(60, 1);
  for (const std::size_t i : {17, 18, 19, 40}) record.channels[0].valid[i] = 0;
  record.channels[1].valid.assign(60, 1);
  for (const std::size_t i : {1, 3, 5, 7, 9, 11}) record.channels[1].valid[i] = 0;
  record.channels[0].calibration = datasets::Calibration{};
  record.channels[0].delay = record.channels[1].delay = datasets::Delay{};
  for (const char* ending : {".uff", ".unv"})
    EXPECT_THAT(
        export_warnings(record, ending),
        testing::ElementsAre(
            "'Force': 4 samples are marked as not valid (17-19, 40), for which a universal file "
            "has no place: whoever reads it takes them as sound; .h5 and .mat files keep the marks",
            "'Velocity, laser': 6 samples are marked as not valid (1, 3, 5, 7, 9, ...), for which "
            "a universal file has no place: whoever reads it takes them as sound; .h5 and .mat "
            "files keep the marks",
            "a universal file has no place for the calibration of 'Force': .h5 and .mat files keep "
            "it",
            "a universal file has no place for the delay of 'Force', 'Velocity, laser': .h5 and "
            ".mat files keep it"));
  EXPECT_THAT(export_warnings(record, ".csv"),
              testing::ElementsAre("a CSV file has no place for the calibration of 'Force': .h5 "
                                   "and .mat files keep it",
                                   "a CSV file has no place for the delay of 'Force', 'Velocity, "
                                   "laser': .h5 and .mat files keep it"));
  for (const char* ending : {".h5", ".mat"})
    EXPECT_THAT(export_warnings(record, ending), testing::IsEmpty());
}

TEST(Exporters, TellOfFiltersThatAFitWouldNotKnowOf) {
  Record record = example(60);
  record.provenance.edits = {{"low-pass, zero phase",
                              "Force",
                              {{"cutoff", "1 Hz"}, {"order", "4, forwards and backwards"}}}};
  for (const auto& [ending, format] :
       {std::pair{".uff", "a universal file"}, std::pair{".unv", "a universal file"},
        std::pair{".csv", "a CSV file"}})
    EXPECT_THAT(
        export_warnings(record, ending),
        testing::ElementsAre(fmt::format(
            "{} has no place for the filtering of 'Force', so that a fit to it would take them for "
            "what the sensors gave: .h5 and .mat files keep it",
            format)));
  for (const char* ending : {".h5", ".mat"})
    EXPECT_THAT(export_warnings(record, ending), testing::IsEmpty());
}

// Doubles hold times of 1e6 s to a thousandth of 100 ns: an importer of a bare table counts them
// from the first, and 1.7e9 s (seconds since 1970) to a quarter of a microsecond.
TEST(CsvExport, KeepsOrTellsStartsFarFromZero) {
  for (const double start : {1e6, -1e6, 86400.0}) {
    Record record = example(40);
    for (Channel& channel : record.channels) channel.clock = {start, 1e-7, {}};
    EXPECT_THAT(export_warnings(record, ".csv"), testing::IsEmpty());
    expect_same_head(record.channels[0], round_trip(record, ".csv").channels[0]);
  }
  Record record = example(40);
  for (Channel& channel : record.channels) {
    channel.clock = {1.7e9, 1e-4, {}};
    for (int i = 0; i < 40; ++i) channel.clock.times.push_back(1.7e9 + 1e-4 * (i + 0.01 * i * i));
  }
  EXPECT_THAT(export_warnings(record, ".csv"),
              testing::ElementsAre("the file does not give back every start as it is: '1700000000 "
                                   "s' as '0 s', '1700000000 s' as '0 s'; a .h5 file keeps "
                                   "everything"));
}

TEST(Export, KeepsTheIntervalOfASingleSample) {
  Record record = example(1);
  record.channels.resize(1);
  for (const char* ending : {".csv", ".uff", ".unv", ".mat", ".h5"})
    EXPECT_THAT(export_warnings(record, ending), testing::IsEmpty()) << ending;
}

// The head of a table is looked for in its first 256 kB: so much has to be left for the rows.
TEST(CsvExport, TellsOfMarksThatAreTooMany) {
  Record record = example(100000);
  Channel& channel = record.channels[1];
  channel.valid.assign(channel.size(), 1);
  for (std::size_t i = 0; i < 40000; i += 2) channel.valid[i] = 0;
  EXPECT_THAT(export_warnings(record, ".csv"),
              testing::ElementsAre(testing::HasSubstr(
                  "20000 samples are marked as not valid (0, 2, 4, 6, 8, ...), for which the head "
                  "of a CSV file has no place")));
  std::fill(channel.valid.begin() + 30000, channel.valid.end(), std::uint8_t{1});
  const Record back = round_trip(record, ".csv");
  EXPECT_EQ(back.channels[1].valid, channel.valid);
}

INSTANTIATE_TEST_SUITE_P(Formats, ExactExport, testing::Values(".uff", ".csv", ".h5", ".mat"));

TEST(Uff58bExport, KeepsComplexSpectra) {
  Record record = example(8);
  record.channels.resize(1);
  Channel& channel = record.channels[0];
  channel.clock = {};
  channel.imaginary = {1, 2, 3, 4, 5, 6, 7, 8};
  channel.attributes = {{"domain", "frequency"},        {"function", "spectrum"},
                        {"abscissa unit", "Hz"},        {"abscissa first", "12.5"},
                        {"abscissa increment", "0.25"}, {"response entity", "1+Z"},
                        {"response node", "17"},        {"response direction", "-3"}};
  const Record back = round_trip(record, ".uff");
  expect_same_samples(channel, back.channels[0]);
  for (const auto& [key, value] : channel.attributes)
    EXPECT_EQ(back.channels[0].attributes.at(key), value) << key;
}

// The file has the denominator in a line of its own.
TEST(Uff58bExport, DividesTheUnitOfAFrequencyResponseOnce) {
  Record record = example(8);
  record.channels.resize(1);
  Channel& channel = record.channels[0];
  channel.clock = {};
  channel.unit = "(m/s^2)/(N)";
  channel.quantity = Quantity::other;
  channel.attributes = {{"domain", "frequency"},
                        {"function", "frequency response function"},
                        {"abscissa unit", "Hz"},
                        {"abscissa increment", "0.25"},
                        {"denominator unit", "N"}};
  const Record back = round_trip(record, ".uff");
  EXPECT_EQ(back.channels[0].unit, "(m/s^2)/(N)");
  EXPECT_EQ(back.channels[0].attributes.at("denominator unit"), "N");
}

// 13 digits are what E20.12 has.
TEST(Uff58Export, KeepsThirteenDigits) {
  const Record record = example();
  const Record back = round_trip(record, ".unv");
  EXPECT_EQ(back.provenance.importer, "uff58");
  for (std::size_t c = 0; c < 2; ++c) {
    expect_same_head(record.channels[c], back.channels[c]);
    ASSERT_EQ(back.channels[c].size(), record.channels[c].size());
    for (std::size_t i = 0; i < back.channels[c].size(); ++i) {
      const double value = record.channels[c].value(i);
      EXPECT_NEAR(back.channels[c].value(i), value, 1e-12 * std::abs(value)) << i;
    }
  }
}

TEST(Uff58bExport, IsWrittenAsTheStandardSays) {
  Record record = example(1);
  record.channels.resize(1);
  const OutputPath path(".uff");
  export_recording(record, path);
  const std::string bytes = tests::bytes_of(path);
  const std::string head =
      "    -1\n"
      "    58b     1     2          11           8     0     0           0           0\n"
      "Force\nNONE\n30-Apr-20 19:12:52\nNONE\nNONE\n"
      "    1         0    0         0 NONE               0   0 NONE               0   0\n"
      "         4         1         1 -1.00000E-03  1.00000E-06  0.00000E+00\n"
      "        17    0    0    0 Time                 s                   \n"
      "        13    0    0    0 force                N                   \n"
      "         0    0    0    0 NONE                 NONE                \n"
      "         0    0    0    0 NONE                 NONE                \n";
  EXPECT_EQ(bytes.substr(0, head.size()), head);
  EXPECT_EQ(bytes.size(), head.size() + 8 + 7);
  EXPECT_EQ(bytes.substr(bytes.size() - 7), "    -1\n");
}

TEST(CsvExport, LeavesTheCellsOfAChannelWithoutSamplesEmpty) {
  for (const std::size_t empty : {0U, 1U}) {
    datasets::Record record = example(3);
    record.channels[empty].raw = std::vector<double>{};
    record.channels[empty].clock.start = 0.0;
    const OutputPath path(".csv");
    export_recording(record, path);
    const datasets::Record back = import_recording(path);
    ASSERT_EQ(back.channels.size(), 2U);
    EXPECT_EQ(back.channels[empty].size(), 0U);
    EXPECT_EQ(back.channels[empty].name, record.channels[empty].name);
    EXPECT_EQ(back.channels[1 - empty].values(), record.channels[1 - empty].values());
    EXPECT_EQ(back.channels[1 - empty].clock.start, -1e-3);
  }
}

TEST(CsvExport, KeepsTheTimeOfASingleSample) {
  datasets::Record record = example(1);
  for (datasets::Channel& channel : record.channels) channel.clock.interval = 0.0;
  const OutputPath path(".csv");
  export_recording(record, path);
  EXPECT_EQ(import_recording(path).channels.at(1).clock.start, -1e-3);
}

TEST(CsvExport, IsPlainWhereThePlainTableSaysAll) {
  Record record = example(3);
  for (Channel& channel : record.channels) channel.raw = std::vector<double>{0.1, -2.0, 1e-300};
  const OutputPath path(".csv");
  export_recording(record, path);
  EXPECT_EQ(tests::bytes_of(path),
            "time [s],Force [N],\"Velocity, laser "
            "[mm/s]\"\n-0.001,0.1,0.1\n-0.000999,-2,-2\n-0.000998,1e-300,1e-300\n");
}

TEST(Hdf5Export, RemembersWhereTheRecordingFirstCameFrom) {
  const tests::WrittenFile file("time [s],F [N]\n0,1\n1,2\n", ".csv");
  const Record first = import_recording(file.path());
  const Record second = round_trip(first, ".h5");
  const Record third = round_trip(second, ".h5");
  EXPECT_EQ(third.provenance.importer, "impactrig-hdf5");
  EXPECT_EQ(third.attributes.at("origin file"), file.path());
  EXPECT_EQ(third.attributes.at("origin format"), "csv");
  EXPECT_EQ(third.attributes.at("origin sha256"), first.provenance.sha256);
}

// As the sampling rate of a MAT-file, which is a variable of its own.
TEST(CsvExport, LeavesOutSingleNumbersBesideSignals) {
  Record record = example(30);
  Channel constant;
  constant.name = "fs";
  constant.raw = std::vector<double>{1000.0};
  record.channels.insert(record.channels.begin(), constant);
  EXPECT_THAT(export_warnings(record, ".csv"),
              testing::ElementsAre(testing::HasSubstr("a table of samples has no place for: 'fs'; "
                                                      ".h5 and .mat files keep them")));
  const Record back = round_trip(record, ".csv");
  ASSERT_EQ(back.channels.size(), 2U);
  expect_same_head(record.channels[1], back.channels[0]);
  expect_same_samples(record.channels[2], back.channels[1]);
  EXPECT_EQ(round_trip(record, ".mat").channels.size(), 3U);
}

TEST(Export, RefusesWhatAFormatCannotHold) {
  Record record = example(3);
  record.channels[1].clock.interval = 2e-6;
  EXPECT_EQ(export_error(record, ".csv"),
            "OUT: 'Force' and 'Velocity, laser' were not sampled at the same times, and a CSV file "
            "has one time column: choose channels with --channel, or write a .uff or .h5 file");
  record = example(3);
  record.channels[0].imaginary = {1, 2, 3};
  EXPECT_EQ(
      export_error(record, ".csv"),
      "OUT: 'Force' is complex, which a CSV file here does not hold: write a .uff or .h5 file");
  record = example(3);
  record.channels[0].attributes["domain"] = "frequency";
  EXPECT_EQ(export_error(record, ".csv"),
            "OUT: 'Force' is over frequency, a CSV file here holds time records: write a .uff or "
            ".h5 file");
  EXPECT_EQ(export_error(Record{}, ".csv"), "OUT: the recording has no channels to write");
  record = example(3);
  record.channels[0].clock.times = {0, 1, 3};
  EXPECT_EQ(export_error(record, ".unv"),
            "OUT: the samples of 'Force' are not evenly spaced, and dataset 58 holds times as text "
            "with six digits only: write a "
            ".uff file (58b)");
  record = example(3);
  record.channels[0].raw = std::vector<double>{0.0, std::nan(""), 1.0};
  EXPECT_EQ(export_error(record, ".unv"),
            "OUT: sample 1 of 'Force' is not finite, which dataset 58 cannot hold as text: write a "
            ".uff file (58b)");
  record = example(3);
  record.channels[0].unit = "a unit of twenty-one b";
  EXPECT_EQ(export_error(record, ".uff"),
            "OUT: the unit 'a unit of twenty-one b' is longer than the 20 bytes that dataset 58 "
            "has for it");
  record = example(3);
  record.channels[0].name = "two\nlines";
  EXPECT_EQ(export_error(record, ".uff"), "OUT: the name 'two\nlines' has a line break");
}

// The file was not written.
TEST(Export, ToUffCutsALongName) {
  Record record = example(3);
  record.channels[0].name = std::string(79, 'x') + "\u00b5y";
  EXPECT_EQ(round_trip(record, ".uff").channels.at(0).name, std::string(79, 'x'));
  EXPECT_THAT(export_warnings(record, ".uff"),
              testing::Contains(testing::HasSubstr("does not give back every name as it is")));
}

// What WAVE files give: the explanation of the unit is its ordinate label.
TEST(Export, ToUffKeepsALongUnitWithoutItsComment) {
  Record record = example(3);
  record.channels[0].unit = "FS (full scale = 1.0)";
  record.channels[0].quantity = Quantity::unknown;
  for (const char* const ending : {".uff", ".unv"}) {
    const Record back = round_trip(record, ending);
    EXPECT_EQ(back.channels[0].unit, "FS") << ending;
    EXPECT_EQ(back.channels[0].attributes.at("ordinate label"), "full scale = 1.0") << ending;
    EXPECT_EQ(back.channels[0].quantity, Quantity::unknown) << ending;
  }
}

TEST(Export, ChoosesByEndingOrByName) {
  const Record record = example(3);
  EXPECT_THAT(export_error(record, ".xyz"),
              testing::StartsWith("OUT: the ending '.xyz' is of no format that is written; known "
                                  "are "));
  EXPECT_THAT(export_error(record, ".csv", "xyz"),
              testing::StartsWith("OUT: there is no format 'xyz' to write; known are "));
  const OutputPath path(".CSV");
  export_recording(record, path);
  EXPECT_EQ(tests::bytes_of(path).substr(0, 8), "time [s]");
  export_recording(record, path, "uff58b");
  EXPECT_EQ(tests::bytes_of(path).substr(0, 6), "    -1");
}

TEST(Export, IntoAMissingFolderIsAFileError) {
  try {
    export_recording(example(3), "/no/such/folder/x.csv");
    FAIL();
  } catch (const datasets::FileError& error) {
    EXPECT_STREQ(error.what(),
                 "/no/such/folder/x.csv: cannot be written: No such file or directory");
  }
}

TEST(Export, OfAThirdPartyRecordingComesBack) {
  const std::filesystem::path shared = acquisition::tests::shared_recordings();
  if (!std::filesystem::exists(shared)) GTEST_SKIP() << "no recordings at " << shared;
  for (const char* name :
       {"uff/catman_time_history.uff", "uff/sample_58b_bin.uff", "text/rigol_ds1054z.csv",
        "text/tek_mso64.csv", "text/shock_base.txt", "polytec_ascii/time_ref1_voltage.txt"}) {
    const Record record = import_recording((shared / name).string());
    for (const char* ending : {".uff", ".csv", ".h5", ".mat"}) {
      SCOPED_TRACE(std::string(name) + ending);
      const Record back = round_trip(record, ending);
      ASSERT_EQ(back.channels.size(), record.channels.size());
      for (std::size_t c = 0; c < back.channels.size(); ++c) {
        expect_same_head(record.channels[c], back.channels[c]);
        expect_same_samples(record.channels[c], back.channels[c]);
      }
    }
  }
}

}  // namespace
}  // namespace impactrig::acquisition
