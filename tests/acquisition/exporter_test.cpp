// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/exporter.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <filesystem>
#include <limits>
#include <random>

#include "acquisition/recording_spool.hpp"
#include "datasets/input_error.hpp"
#include "tests/acquisition/mat_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Channel;
using datasets::Quantity;
using datasets::Record;

/// A path for the running test's output; the file is removed.
class OutputPath {
 public:
  explicit OutputPath(const std::string& ending)
      : path_(testing::TempDir() + "impactrig_out_" + tests::WrittenFile::test_name() +
              std::to_string(getpid()) + ending) {}

  ~OutputPath() { std::filesystem::remove(path_); }

  OutputPath(const OutputPath&) = delete;
  OutputPath& operator=(const OutputPath&) = delete;

  operator const std::string&() const { return path_; }

  std::string part() const { return path_ + ".part"; }

  bool exists() const { return std::filesystem::exists(path_); }

 private:
  std::string path_;
};

/// Two channels of one clock, with samples of every magnitude.
Record example(std::size_t n = 500) {
  Record record;
  record.started = "2020-04-30T19:12:52";
  std::mt19937_64 random(5);
  for (const auto& [name, unit, quantity] :
       {std::tuple{"Force", "N", Quantity::force},
        std::tuple{"Velocity, laser", "mm/s", Quantity::velocity}}) {
    Channel channel;
    channel.name = name;
    channel.unit = unit;
    channel.quantity = quantity;
    channel.clock.start = -1e-3;
    channel.clock.interval = 1e-6;
    std::vector<double> samples(n);
    for (double& sample : samples) {
      do {
        sample = std::bit_cast<double>(random());
      } while (!std::isfinite(sample));
    }
    if (n > 2) {
      samples[1] = -0.0;
      samples[2] = std::numeric_limits<double>::denorm_min();
    }
    channel.raw = std::move(samples);
    record.channels.push_back(std::move(channel));
  }
  return record;
}

Record round_trip(const Record& record, const std::string& ending) {
  const OutputPath path(ending);
  export_recording(record, path);
  EXPECT_FALSE(std::filesystem::exists(path.part()));
  ImportOptions options;
  options.require_clock = false;
  return import_recording(path, options);
}

std::vector<std::string> export_warnings(const Record& record, const std::string& ending) {
  const OutputPath path(ending);
  return export_recording(record, path);
}

void expect_same_samples(const Channel& a, const Channel& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::isnan(a.value(i)) && std::isnan(b.value(i))) continue;
    ASSERT_EQ(std::bit_cast<std::uint64_t>(a.value(i)), std::bit_cast<std::uint64_t>(b.value(i)))
        << i;
  }
  EXPECT_EQ(a.imaginary, b.imaginary);
}

void expect_same_head(const Channel& a, const Channel& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.unit, b.unit);
  EXPECT_EQ(a.quantity, b.quantity);
  EXPECT_EQ(a.clock.start, b.clock.start);
  EXPECT_EQ(a.clock.interval, b.clock.interval);
  EXPECT_EQ(a.clock.times, b.clock.times);
}

std::string export_error(const Record& record, const std::string& ending,
                         std::string_view format = {}) {
  const OutputPath path(ending);
  try {
    export_recording(record, path, format);
  } catch (const datasets::FileError& error) {
    EXPECT_FALSE(path.exists());
    EXPECT_FALSE(std::filesystem::exists(path.part()));
    std::string text = error.what();
    return text.replace(0, static_cast<const std::string&>(path).size(), "OUT");
  }
  return {};
}

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

/// One channel of what only some formats keep.
Channel particular(const std::string& name) {
  Channel channel;
  channel.name = name;
  channel.quantity = Quantity::force;
  channel.unit = "N";
  channel.clock = {-1.0 / 3.0, 1e-6, {}};
  channel.raw = std::vector<float>{1.5F, -0.0F, 3e38F};
  channel.valid = {1, 0, 1};
  channel.calibration = {4e-12, 1e-14, "C", "N", "certificate \xC2\xB5 17"};
  channel.delay = {2e-6, 1e-7, true};
  channel.attributes = {{"coupling", "AC"}, {"note", "two\nlines \xF0\x9F\x94\xA8"}};
  return channel;
}

TEST(MatExport, KeepsWhateverIsKnown) {
  Record record;
  record.title = "Shot 7, \xC2\xB5s";
  record.started = "2020-04-30T19:12:52";
  record.warnings = {"one sentence.", "and another."};
  record.attributes = {{"operator", "N. N."}};
  record.provenance.source_file = "shot.tdms";
  record.provenance.importer = "tdms";
  record.channels = {particular("Kraft \xC3\xA4/1"),
                     particular("Kraft \xC3\xA4/1"),
                     particular("7 end"),
                     particular("end"),
                     particular("recording"),
                     particular("")};
  record.channels[1].clock = {0.5, 0.25, {0.5, 0.6, 1.0}};
  record.channels[1].valid.clear();
  record.channels[2].raw = std::vector<double>{};
  record.channels[2].valid.clear();
  record.channels[3].raw = std::vector<std::int32_t>{1, 2, 3};
  record.channels[3].scale = 0.1;
  record.channels[3].offset = -7.0;
  record.channels[4].imaginary = {1, 1.0 / 3.0, -0.0};
  record.channels[4].calibration.reset();
  record.channels[5].delay.reset();
  const Record back = round_trip(record, ".mat");
  EXPECT_EQ(back.title, record.title);
  EXPECT_EQ(back.started, record.started);
  EXPECT_EQ(back.warnings, record.warnings);
  EXPECT_EQ(back.attributes.at("operator"), "N. N.");
  EXPECT_EQ(back.attributes.at("origin file"), "shot.tdms");
  EXPECT_EQ(back.attributes.at("origin format"), "tdms");
  ASSERT_EQ(back.channels.size(), record.channels.size());
  for (std::size_t c = 0; c < back.channels.size(); ++c) {
    SCOPED_TRACE(c);
    const Channel& was = record.channels[c];
    const Channel& is = back.channels[c];
    expect_same_head(was, is);
    expect_same_samples(was, is);
    EXPECT_EQ(is.valid, was.valid);
    EXPECT_EQ(is.attributes, was.attributes);
    ASSERT_EQ(is.calibration.has_value(), was.calibration.has_value());
    if (was.calibration) {
      EXPECT_EQ(is.calibration->sensitivity, was.calibration->sensitivity);
      EXPECT_EQ(is.calibration->uncertainty, was.calibration->uncertainty);
      EXPECT_EQ(is.calibration->recorded_unit, was.calibration->recorded_unit);
      EXPECT_EQ(is.calibration->physical_unit, was.calibration->physical_unit);
      EXPECT_EQ(is.calibration->source, was.calibration->source);
    }
    ASSERT_EQ(is.delay.has_value(), was.delay.has_value());
    if (was.delay) {
      EXPECT_EQ(is.delay->value, was.delay->value);
      EXPECT_EQ(is.delay->uncertainty, was.delay->uncertainty);
      EXPECT_EQ(is.delay->removed, was.delay->removed);
    }
  }
  EXPECT_TRUE(std::holds_alternative<std::vector<float>>(back.channels[0].raw));
}

// The file built from its parts by the tests' own MatBytes.
TEST(MatExport, IsWrittenAsTheStandardSays) {
  Record record;
  record.channels.resize(1);
  Channel& channel = record.channels[0];
  channel.name = "F 1";
  channel.unit = "N";
  channel.quantity = Quantity::force;
  channel.clock = {0.5, 0.25, {}};
  channel.raw = std::vector<double>{1.0, 2.0, 3.0};
  channel.valid = {1, 0, 1};
  const OutputPath path(".mat");
  export_recording(record, path);
  const std::string bytes = tests::bytes_of(path);

  const tests::MatBytes b{std::endian::native == std::endian::big};
  const auto word = [&b](const std::string& letters) {
    const std::vector<std::uint16_t> units(letters.begin(), letters.end());
    const std::string data = b.numbers(units);
    const auto n = static_cast<std::int32_t>(units.size());
    return b.matrix(b.head(4, {n > 0 ? 1 : 0, n}, "") +
                    (n == 1 || n == 2 ? b.small(4, data) : b.element(4, data)));
  };
  const std::string none = b.matrix(b.head(6, {0, 0}, "") + b.element(9, ""));
  const std::string no_pairs = b.structure("", {"name", "value"}, "", 0);
  const std::string marks = b.matrix(b.head(0x0209, {3, 1}, "") + b.small(2, {0, 1, 0}));
  EXPECT_EQ(bytes.substr(0, 19), "MATLAB 5.0 MAT-file");
  EXPECT_EQ(bytes.substr(116, 12), b.header().substr(116));
  EXPECT_EQ(bytes.substr(128),
            b.structure(
                "recording",
                {"format", "format_version", "title", "start_time", "source_file", "source_sha256",
                 "source_format", "source_program", "warnings", "attributes"},
                word("impactrig-recording") + word("1.0") + word("") + word("") + word("") +
                    word("") + word("") + word("") + b.structure("", {"text"}, "", 0) + no_pairs) +
                b.structure("F_1",
                            {"name", "quantity", "unit", "start", "interval", "time", "value",
                             "invalid", "calibration", "delay", "attributes"},
                            word("F 1") + word("force") + word("N") + b.doubles("", {0.5}) +
                                b.doubles("", {0.25}) + none + b.doubles("", {1, 2, 3}) + marks +
                                none + none + no_pairs));
}

TEST(MatExport, NamesWhatItCannotHold) {
  Record record = example(3);
  record.channels[0].raw = std::vector<std::int16_t>(std::size_t{1} << 28);
  EXPECT_EQ(export_error(record, ".mat"),
            "OUT: 'Force' takes 2.1 GB, a variable of a MAT-file of this version at most 2.1 GB: "
            "choose a part with --from and --to, or write a .h5 file, which MATLAB reads with "
            "h5read");
}

TEST(MatExport, WhatIsAddedToItIsNamed) {
  const OutputPath path(".mat");
  export_recording(example(3), path);
  const tests::MatBytes b{std::endian::native == std::endian::big};
  const Record back =
      tests::imported(tests::bytes_of(path) + b.doubles("x", {1}) + b.text("note", "hit") +
                          b.structure("run", {"value"}, b.doubles("", {1})),
                      {}, ".mat");
  EXPECT_EQ(back.channels.size(), 2U);
  EXPECT_THAT(back.warnings,
              testing::ElementsAre("not read, since no channel of the recording is there: 'run', "
                                   "'x', 'note'"));
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

TEST(Export, RefusesWhatAFormatCannotHold) {
  Record record = example(3);
  record.channels[1].clock.interval = 2e-6;
  EXPECT_EQ(export_error(record, ".csv"),
            "OUT: 'Force' and 'Velocity, laser' were not sampled at the same times, and a CSV file "
            "has one time column: write a "
            ".uff or .h5 file");
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

/// Every kind of samples, with and without marks, stated times and imaginary parts.
Record of_every_kind(std::size_t n) {
  Record record = example(n);
  const auto add = [&record](const std::string& name, auto samples) -> Channel& {
    Channel channel;
    channel.name = name;
    channel.unit = "V";
    channel.clock = {0.5, 1e-5, {}};
    channel.raw = std::move(samples);
    record.channels.push_back(std::move(channel));
    return record.channels.back();
  };
  std::vector<float> singles(n);
  std::vector<std::int16_t> shorts(n);
  std::vector<std::int32_t> integers(n);
  std::vector<double> times(n);
  std::vector<std::uint8_t> valid(n, 1);
  for (std::size_t i = 0; i < n; ++i) {
    singles[i] = static_cast<float>(std::sin(0.01 * static_cast<double>(i)));
    shorts[i] = static_cast<std::int16_t>(i * 7919);
    integers[i] = static_cast<std::int32_t>(i) * 10007;
    times[i] = 1e-5 * static_cast<double>(i * i);
    valid[i] = i % 9000 == 8191 || i % 9000 == 8192 ? 0 : 1;
  }
  add("single", singles).valid = valid;
  Channel& scaled = add("short", shorts);
  scaled.scale = 0.125;
  scaled.offset = -1.0;
  scaled.calibration = {2.0, 0.1, "V", "N", "certificate"};
  add("integer", integers).clock = {0.0, 1.0, times};
  Channel& complex = add("complex", times);
  complex.imaginary = times;
  complex.attributes["domain"] = "frequency";
  return record;
}

/// Hands samples over in blocks of uneven lengths, channels by turns.
SpooledRecording spooled(const Record& record) {
  RecordingSpool spool("OUT", record.channels.size());
  bool more = true;
  for (std::size_t first = 0, step = 1; more; first += step, step = step * 2 % 5000 + 1) {
    more = false;
    for (std::size_t c = 0; c < record.channels.size(); ++c) {
      const Channel& channel = record.channels[c];
      if (first >= channel.size()) continue;
      more = true;
      const std::size_t count = std::min(step, channel.size() - first);
      SampleBlock block;
      std::visit([&](const auto& raw) { block.raw = std::span(raw).subspan(first, count); },
                 channel.raw);
      if (channel.complex()) block.imaginary = std::span(channel.imaginary).subspan(first, count);
      // marks may begin where the first of them is
      if (!channel.valid.empty() && first + count > 8191)
        block.valid = std::span(channel.valid).subspan(first, count);
      spool.take(c, block);
      if (!channel.clock.uniform())
        spool.take_times(c, std::span(channel.clock.times).subspan(first, count));
    }
  }
  return spool.finish();
}

TEST(Export, FromTheDiskIsTheSameAsFromMemory) {
  for (const std::size_t n : {1U, 8192U, 30000U}) {
    for (const std::string ending : {".uff", ".unv", ".mat", ".csv", ".h5"}) {
      SCOPED_TRACE(ending + fmt::format(" {}", n));
      Record record = of_every_kind(n);
      if (ending == ".unv") record.channels.erase(record.channels.begin() + 4);
      if (ending == ".csv") {
        record.channels.erase(record.channels.begin() + 4, record.channels.end());
        for (Channel& channel : record.channels) channel.clock = {0.5, 1e-5, {}};
      }
      Record head = record;
      for (Channel& channel : head.channels) {
        channel.raw = std::vector<double>{};
        channel.imaginary.clear();
        channel.valid.clear();
        channel.clock.times.clear();
      }
      const OutputPath memory("_memory" + ending);
      const OutputPath disk("_disk" + ending);
      const std::vector<std::string> warnings = export_recording(record, memory);
      EXPECT_EQ(export_recording(head, spooled(record), disk), warnings);
      if (ending != ".h5") {
        EXPECT_TRUE(tests::bytes_of(memory) == tests::bytes_of(disk));
        continue;
      }
      const Record found = import_recording(disk);
      ASSERT_EQ(found.channels.size(), record.channels.size());
      for (std::size_t c = 0; c < found.channels.size(); ++c) {
        EXPECT_EQ(found.channels[c].raw.index(), record.channels[c].raw.index());
        expect_same_samples(found.channels[c], record.channels[c]);
        EXPECT_EQ(found.channels[c].clock.times, record.channels[c].clock.times);
        for (std::size_t i = 0; i < n; ++i)
          ASSERT_EQ(found.channels[c].is_valid(i), record.channels[c].is_valid(i)) << i;
      }
    }
  }
}

TEST(CsvExport, OfStatedTimesIsTheSameFromTheDisk) {
  Record record = example(20000);
  for (std::size_t i = 0; i < 20000; ++i)
    record.channels[0].clock.times.push_back(1e-6 * static_cast<double>(i * i));
  record.channels[1].clock.times = record.channels[0].clock.times;
  const OutputPath memory("_memory.csv");
  const OutputPath disk("_disk.csv");
  export_recording(record, memory);
  export_recording(record, spooled(record), disk);
  EXPECT_TRUE(tests::bytes_of(memory) == tests::bytes_of(disk));
  record.channels[1].clock.times[19999] += 1.0;
  EXPECT_THROW(export_recording(record, spooled(record), disk), datasets::FileError);
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
  const std::filesystem::path shared = std::filesystem::path(IMPACTRIG_SHARED_DIR) / "recordings";
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
