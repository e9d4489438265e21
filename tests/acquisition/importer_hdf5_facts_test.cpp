// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <hdf5.h>

#include <cstdint>
#include <limits>
#include <map>
#include <string>

#include "acquisition/importer.hpp"
#include "tests/acquisition/hdf5_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Channel;
using datasets::Record;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::Hdf5File;
using tests::import_error;
using tests::imported;

TEST(Hdf5Records, EachFieldOfNumbersIsAChannel) {
  for (const hsize_t chunk : {5U, 300U}) {
    const Hdf5File file;
    file.group("/daq");
    file.records("/daq/rows", 300, chunk);
    file.texts("/daq/rows", "units", {"", "s", "N", ""});
    const Record record = imported(file.bytes());
    ASSERT_EQ(record.channels.size(), 3U);
    const Channel& force = record.channels[1];
    EXPECT_EQ(force.name, "/daq/rows.force");
    EXPECT_EQ(force.unit, "N");
    EXPECT_EQ(force.clock.interval, 0.25);
    EXPECT_EQ(force.size(), 300U);
    EXPECT_EQ(force.value(299), 299.0 * 299.0);
    EXPECT_EQ(record.channels[0].unit, "s");
    EXPECT_EQ(record.channels[0].value(2), 0.5);
    EXPECT_EQ(record.channels[2].value(0), 1152921504606846976.0);
    EXPECT_THAT(record.warnings, ElementsAre("not read: '/daq/rows.name' (text)",
                                             HasSubstr("'/daq/rows.ticks': 300 samples are beyond "
                                                       "2^53")));
  }
}

TEST(Hdf5Records, WithinRecordsAreReadFieldByField) {
  struct Row {
    double time;

    struct Shot {
      float force;
      std::int16_t volts;
    } shot;
  };

  const hid_t shot = H5Tcreate(H5T_COMPOUND, sizeof(Row::Shot));
  H5Tinsert(shot, "force", HOFFSET(Row::Shot, force), H5T_NATIVE_FLOAT);
  H5Tinsert(shot, "a.b", HOFFSET(Row::Shot, volts), H5T_NATIVE_INT16);
  const hid_t row = H5Tcreate(H5T_COMPOUND, sizeof(Row));
  H5Tinsert(row, "time", HOFFSET(Row, time), H5T_NATIVE_DOUBLE);
  H5Tinsert(row, "shot", HOFFSET(Row, shot), shot);
  const Hdf5File file;
  file.data<Row>("/data", {3}, {{0.0, {1.5F, 7}}, {0.5, {2.5F, 8}}, {1.0, {3.5F, 9}}}, row, row);
  H5Tclose(row);
  H5Tclose(shot);
  ImportOptions options;
  options.channels = {"/data.shot.force", "/data.shot.a.b"};
  const Record record = imported(file.bytes(), options);
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1.5, 2.5, 3.5));
  EXPECT_THAT(record.channels[1].values(), ElementsAre(7, 8, 9));
  EXPECT_EQ(record.channels[1].clock.interval, 0.5);
}

TEST(Hdf5Records, AreReadByWindowAndChannel) {
  const Hdf5File file;
  file.records("/rows", 100, 7);
  ImportOptions options;
  options.channels = {"/rows.force"};
  options.from = 10.0;
  options.to = 10.5;
  const Record record = imported(file.bytes(), options);
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1600, 1681, 1764));
  EXPECT_EQ(record.channels[0].clock.start, 10.0);
}

TEST(Hdf5Columns, HaveTheNamesAndUnitsOfTheirLists) {
  std::vector<double> table;
  for (int i = 0; i < 200; ++i) {
    table.push_back(1e-3 * (i + (i > 100 ? 0.4 : 0.0)));  // uneven
    table.push_back(i % 7);
  }
  const Hdf5File file;
  file.data<double>("/table", {200, 2}, table, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE, {64, 2});
  file.texts("/table", "columns", {"time", "force"});
  file.texts("/table", "unit", {"ms", "kN"});
  const Record record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 2U);
  const Channel& force = record.channels[1];
  EXPECT_EQ(force.name, "/table.force");
  EXPECT_EQ(force.unit, "kN");
  ASSERT_EQ(force.clock.times.size(), 200U);
  EXPECT_NEAR(force.clock.times[199], 1e-6 * 199.4, 1e-18);
  EXPECT_THAT(force.values()[8], 1.0);
  file.texts("/table", "names", {"twice", "twice"});  // the others still name them
  EXPECT_EQ(imported(file.bytes()).channels[1].name, "/table.force");
}

// The '/' of a unit divides no groups.
TEST(Hdf5Columns, MayHaveUnitsInTheirNames) {
  std::vector<double> table;
  for (int i = 0; i < 200; ++i) {
    table.push_back(0.5 * i);
    table.push_back(i % 7);
  }
  const Hdf5File file;
  file.data<double>("/table", {200, 2}, table, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
  file.texts("/table", "columns", {"time (ms)", "v (m/s)"});
  const Record record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_EQ(record.channels[1].unit, "m/s");
  EXPECT_DOUBLE_EQ(record.channels[1].clock.interval, 5e-4);
}

// Without names, a first column that increases evenly is the time, as in MAT-files.
TEST(Hdf5Columns, WithoutNamesBeginWithTheTime) {
  const Hdf5File file;
  std::vector<double> table;
  for (int i = 0; i < 200; ++i) {
    table.push_back(0.01 * i);
    table.push_back(i % 7);
  }
  file.data<double>("/table", {200, 2}, table, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
  EXPECT_DOUBLE_EQ(imported(file.bytes()).channels[1].clock.interval, 0.01);
  ImportOptions options;
  options.time_column = "/table:1";
  EXPECT_DOUBLE_EQ(imported(file.bytes(), options).channels[1].clock.interval, 0.01);
}

// NetCDF: value = scale_factor * number + add_offset, and a number that stands for none.
TEST(Hdf5Packing, IsUndone) {
  const Hdf5File file;
  file.data<std::int16_t>("/force", {4}, {100, -32768, 300, 400}, H5T_NATIVE_INT16, H5T_STD_I16BE);
  file.number("/force", "scale_factor", 0.5);
  file.number("/force", "add_offset", 5.0);
  file.number("/force", "_FillValue", -32768.0);
  file.data<std::int16_t>("/time", {4}, {0, 1, 3, 4}, H5T_NATIVE_INT16, H5T_STD_I16LE);
  file.number("/time", "scale_factor", 0.25);
  file.number("/time", "add_offset", 40.0);
  file.text("/time", "units", "milliseconds since 2024-03-01 12:00");
  const Record record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 2U);
  const Channel& force = record.channels[0];
  EXPECT_TRUE(std::holds_alternative<std::vector<std::int16_t>>(force.raw));
  EXPECT_EQ(force.value(0), 55.0);
  EXPECT_EQ(force.value(3), 205.0);
  EXPECT_THAT(force.valid, ElementsAre(1, 0, 1, 1));
  ASSERT_EQ(force.clock.times.size(), 4U);
  EXPECT_DOUBLE_EQ(force.clock.times[2], 0.04075);
  EXPECT_THAT(record.warnings, Contains("'/force': 1 of 4 samples are -32768, which stands for "
                                        "none; marked as not valid"));
}

// -999.9 in double precision is none of the numbers of single precision that a file has.
TEST(Hdf5Packed, NumbersThatStandForNoneAreOfTheTypeOfTheSamples) {
  const Hdf5File file;
  file.data<float>("/force", {4}, {1.0F, -999.9F, 3.0F, -1.0F}, H5T_NATIVE_FLOAT, H5T_IEEE_F32LE);
  file.number("/force", "missing_value", -999.9);
  file.number("/force", "_FillValue", -1.0);
  const Record record = imported(file.bytes());
  EXPECT_THAT(record.channels.at(0).valid, ElementsAre(1, 0, 1, 0));
  EXPECT_THAT(record.warnings,
              Contains(HasSubstr("2 of 4 samples are -1 or -999.9000244140625, which stands for "
                                 "none; marked as not valid")));
}

TEST(Hdf5Packed, SamplesBeyondTheValidRangeAreMarked) {
  const Hdf5File file;
  file.doubles("/range", {1, -4, 3, 2});
  file.numbers("/range", "valid_range", {-3.0, 2.0});
  file.doubles("/least", {1, -4, 3, 2});
  file.number("/least", "valid_min", 1.5);
  file.number("/least", "missing_value", 2.0);
  const Record record = imported(file.bytes());
  EXPECT_THAT(record.channels.at(0).valid, ElementsAre(0, 0, 1, 0));
  EXPECT_THAT(record.channels.at(1).valid, ElementsAre(1, 0, 0, 1));
  EXPECT_THAT(
      record.warnings,
      testing::IsSupersetOf({std::string("'/range': 2 of 4 samples are not between -3 and 2; "
                                         "marked as not valid"),
                             std::string("'/least': 3 of 4 samples are 2, which stands for "
                                         "none, or not between 1.5 and inf; marked as not "
                                         "valid")}));
}

/// 200 rows of two columns of integers, 0 to 199 and three times that.
void two_columns(const Hdf5File& file) {
  std::vector<std::int16_t> table;
  for (std::int16_t i = 0; i < 200; ++i) {
    table.push_back(i);
    table.push_back(static_cast<std::int16_t>(3 * i));
  }
  file.data<std::int16_t>("/data", {200, 2}, table, H5T_NATIVE_INT16, H5T_STD_I16LE);
  file.texts("/data", "units", {"N", "m/s"});
  file.number("/data", "dt", 1e-5);
}

TEST(Hdf5Packing, MayBeStatedColumnByColumn) {
  const Hdf5File file;
  two_columns(file);
  file.numbers("/data", "scale_factor", {0.5, 0.001});
  file.numbers("/data", "add_offset", {0.0, 1.0});
  const Record record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_EQ(record.channels[0].unit, "N");
  EXPECT_EQ(record.channels[0].value(199), 99.5);
  EXPECT_EQ(record.channels[1].unit, "m/s");
  EXPECT_DOUBLE_EQ(record.channels[1].value(199), 1.597);
  EXPECT_THAT(record.warnings, IsEmpty());
}

TEST(Hdf5Packing, OfRecordsIsStatedFieldByField) {
  const Hdf5File file;
  file.records("/rows", 300, 300);
  file.texts("/rows", "units", {"", "s", "N", ""});
  file.numbers("/rows", "scale_factor", {1.0, 2.0, 0.5, 1.0});
  const Record record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 3U);
  EXPECT_EQ(record.channels[1].value(4), 8.0);
  EXPECT_EQ(record.channels[1].clock.interval, 0.5);
}

// Numbers as they are stored in a unit they are not in would look like a measurement.
TEST(Hdf5Packing, ThatCannotBeUndoneLeavesNoUnit) {
  const auto expect_stored = [](const Hdf5File& file, const std::string& why) {
    const Record record = imported(file.bytes());
    for (const Channel& channel : record.channels) {
      EXPECT_EQ(channel.unit, "") << why;
      EXPECT_EQ(channel.quantity, datasets::Quantity::unknown) << why;
      EXPECT_EQ(channel.scale, 1.0);
      EXPECT_EQ(channel.offset, 0.0);
    }
    EXPECT_THAT(record.warnings, ElementsAre("'/data': " + why +
                                             ": its numbers are as they are stored, without a "
                                             "unit"));
  };
  {
    const Hdf5File file;
    two_columns(file);
    file.number("/data", "scale_factor", 0.5);
    file.text("/data", "add_offset", "3");
    expect_stored(file, "its attribute 'add_offset' is a text, not a number");
  }
  {
    const Hdf5File file;
    two_columns(file);
    file.numbers("/data", "scale_factor", {0.5, 1.0, 2.0});
    expect_stored(file, "its attribute 'scale_factor' lists 3 numbers, not one or 2");
  }
  for (const double factor :
       {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN(), 0.0}) {
    const Hdf5File file;
    two_columns(file);
    file.number("/data", "scale_factor", factor);
    expect_stored(file, fmt::format("its attribute 'scale_factor' is {}", factor));
  }
}

TEST(Hdf5Packing, ThatCannotBeUndoneLeavesNoTimeEither) {
  const Hdf5File file;
  file.doubles("/force", {1, 2, 3});
  file.doubles("/time", {0, 1, 2});
  file.text("/time", "units", "s");
  file.text("/time", "scale_factor", "a thousandth");
  const Record record = imported(file.bytes());
  EXPECT_EQ(record.channels[0].clock.interval, 0.0);
}

// Programs call many things so, and nothing says which way round they count.
TEST(Hdf5Packing, ByOtherNamesIsToldAndNotGuessed) {
  const Hdf5File file;
  for (const std::string name : {"/plain", "/scaled", "/unity", "/without unit"}) {
    file.doubles(name, {1, 2, 3});
    file.number(name, "dt", 1.0);
    if (name != "/without unit") file.text(name, "units", "N");
  }
  file.number("/scaled", "Gain", 10.0);
  file.number("/scaled", "offset", 2.0);
  file.number("/unity", "scale", 1.0);
  file.number("/unity", "offset", 0.0);
  file.number("/without unit", "scaling_factor", 7.0);
  const Record record = imported(file.bytes());
  EXPECT_EQ(record.channels[1].unit, "N");
  EXPECT_THAT(record.channels[1].values(), ElementsAre(1, 2, 3));
  EXPECT_THAT(record.warnings,
              ElementsAre("'/scaled': its attributes 'Gain', 'offset' are not applied: its numbers "
                          "are taken in N as they are stored",
                          "'/without unit': its attribute 'scaling_factor' is not applied: its "
                          "numbers are taken as they are stored"));
}

// A converter gives integers, and what they stand for is stated in many words.
TEST(Hdf5Facts, IntegersMayHaveMoreWordsForTheirScale) {
  for (const char* word : {"slope", "calibration", "lsb", "volts_per_count", "sensitivity"}) {
    const Hdf5File file;
    file.data<std::int16_t>("/raw", {3}, {1, 2, 3}, H5T_NATIVE_INT16, H5T_STD_I16LE);
    file.doubles("/force", {1, 2, 3});
    for (const char* set : {"/raw", "/force"}) {
      file.number(set, "dt", 1.0);
      file.number(set, word, 0.1);
    }
    EXPECT_THAT(
        imported(file.bytes()).warnings,
        ElementsAre(HasSubstr(std::string("'/raw': its attribute '") + word + "' is not applied")));
  }
}

TEST(Hdf5Facts, AStartIsInTheUnitOfItsInterval) {
  const auto clock = [](const std::map<std::string, double>& numbers,
                        const std::map<std::string, std::string>& texts) {
    const Hdf5File file;
    file.doubles("/force", {1, 2, 3});
    for (const auto& [name, value] : numbers) file.number("/force", name, value);
    for (const auto& [name, text] : texts) file.text("/force", name, text);
    return imported(file.bytes()).channels.at(0).clock;
  };
  const auto in_ms = clock({{"dt", 0.1}, {"t0", -10.0}}, {{"dt_units", "ms"}});
  EXPECT_DOUBLE_EQ(in_ms.interval, 1e-4);
  EXPECT_DOUBLE_EQ(in_ms.start, -10e-3);
  const auto own = clock({{"dt", 0.1}, {"t0", -10.0}}, {{"dt_units", "ms"}, {"t0_units", "us"}});
  EXPECT_DOUBLE_EQ(own.start, -10e-6);
  const auto all = clock({{"dt", 100.0}, {"t_start", -5.0}}, {{"time_unit", "us"}});
  EXPECT_DOUBLE_EQ(all.interval, 1e-4);
  EXPECT_DOUBLE_EQ(all.start, -5e-6);
}

TEST(Hdf5Facts, AGroupsUnitIsThatOfItsOnlyDataSet) {
  const Hdf5File file;
  file.group("/force");
  file.text("/force", "Unit", "kN");
  file.number("/force", "dt", 1e-3);
  file.doubles("/force/data", {1, 2, 3});
  file.group("/end");
  file.text("/end", "Unit", "bar end");
  file.doubles("/end/data", {1, 2, 3});
  file.group("/both");
  file.text("/both", "Unit", "N");
  file.doubles("/both/a", {1, 2, 3});
  file.doubles("/both/b", {1, 2, 3});
  ImportOptions options;
  options.sample_rate = 1000.0;
  const auto record = imported(file.bytes(), options);
  std::map<std::string, std::string> units;
  for (const auto& channel : record.channels) units[channel.name] = channel.unit;
  EXPECT_EQ(units,
            (std::map<std::string, std::string>{
                {"/force/data", "kN"}, {"/end/data", ""}, {"/both/a", ""}, {"/both/b", ""}}));
}

TEST(Hdf5Facts, ARateMayHaveManyNames) {
  const auto interval = [](const std::string& name, double value) {
    const Hdf5File file;
    file.doubles("/force", {1, 2, 3});
    file.number("/force", name, value);
    return imported(file.bytes()).channels.at(0).clock.interval;
  };
  for (const char* const name : {"Sampling Rate", "fs_Hz", "sample_rate_hz", "sr", "f_s"})
    EXPECT_EQ(interval(name, 500.0), 2e-3) << name;
  for (const char* const name : {"sample_period", "time_step", "timestep", "dt_s"})
    EXPECT_EQ(interval(name, 0.5), 0.5) << name;
  EXPECT_DOUBLE_EQ(interval("dt_ms", 0.5), 5e-4);
  for (const char* const name : {"rate", "ts", "xinc"}) EXPECT_EQ(interval(name, 2.0), 0.0);
}

TEST(Hdf5Facts, ADataSetMayStateItsStartWhereItsGroupStatesTheRate) {
  const Hdf5File file;
  file.group("/daq");
  file.number("/daq", "fs", 1000.0);
  file.doubles("/daq/force", {1, 2, 3});
  file.number("/daq/force", "t0", -0.25);
  const auto record = imported(file.bytes());
  EXPECT_EQ(record.channels.at(0).clock.start, -0.25);
  EXPECT_EQ(record.channels.at(0).clock.interval, 1e-3);
}

// [CF 1.11, 4.4; ACDD 1.3, time_coverage_start]
TEST(Hdf5Facts, AStartMayBeThatOfItsTimesOrOfTheFile) {
  const auto started = [](const char* units, const char* key, const char* start) {
    const Hdf5File file;
    file.doubles("/time", {0, 0.5, 1});
    file.text("/time", "units", units);
    file.doubles("/force", {1, 2, 3});
    if (*key != '\0') file.text("/", key, start);
    return imported(file.bytes()).started;
  };
  EXPECT_EQ(started("ms since 2021-03-12 10:11:12", "", ""), "2021-03-12T10:11:12");
  EXPECT_EQ(started("seconds since 1970-01-01 00:00:00", "", ""), "");
  EXPECT_EQ(started("s", "start_time", "2021-03-12T10:11:12Z"), "2021-03-12T10:11:12Z");
  EXPECT_EQ(started("s", "time_coverage_start", "2021-03-12T10:11:12Z"), "2021-03-12T10:11:12Z");
  EXPECT_EQ(started("s", "start_time", "0.5"), "");
}

TEST(Hdf5Facts, StartsThatDifferAreToldOf) {
  const Hdf5File file;
  for (const auto& [group, second] : {std::pair{"/a", "12"}, {"/b", "42"}}) {
    file.group(group);
    file.doubles(std::string(group) + "/time", {0, 0.5, 1});
    file.text(std::string(group) + "/time", "units",
              std::string("s since 2021-03-12 10:11:") + second);
    file.doubles(std::string(group) + "/force", {1, 2, 3});
  }
  const Record record = imported(file.bytes());
  EXPECT_EQ(record.started, "2021-03-12T10:11:12");
  EXPECT_THAT(record.warnings,
              Contains("channels were started at different times (the first at "
                       "2021-03-12T10:11:12, another at 2021-03-12T10:11:42): each counts its "
                       "time from its own start"));
}

TEST(Hdf5Facts, IntegersMayCountNanosecondsFrom1970) {
  const Hdf5File file;
  file.doubles("/force", {1, 2, 3});
  const std::int64_t first = 1709294400000000000;
  file.data<std::int64_t>("/timestamps", {3}, {first, first + 100000, first + 200000},
                          H5T_NATIVE_INT64, H5T_STD_I64LE);
  const auto record = imported(file.bytes());
  EXPECT_DOUBLE_EQ(record.channels.at(0).clock.interval, 1e-4);
  EXPECT_THAT(record.warnings, testing::Contains(HasSubstr("its numbers count ns since 1970")));
}

TEST(Hdf5Columns, HaveNoUnitsWhereTheirListHasAnotherLength) {
  const Hdf5File file;
  std::vector<double> table(600, 1.0);
  file.data<double>("/data", {200, 3}, table, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
  file.texts("/data", "units", {"N", "m/s"});
  file.number("/data", "dt", 1.0);
  const Record record = imported(file.bytes());
  for (const Channel& channel : record.channels) EXPECT_EQ(channel.unit, "");
  EXPECT_THAT(record.warnings,
              ElementsAre("'/data': its attribute 'units' lists 2 units, not 3: none is used"));
}

TEST(Hdf5Clock, StatedTwiceWithTwoValuesIsToldOf) {
  const Hdf5File file;
  file.doubles("/force", {1, 2, 3});
  file.number("/force", "dt", 1e-3);
  file.number("/force", "fs", 500.0);
  file.doubles("/velocity", {1, 2, 3});
  file.number("/velocity", "dt", 1e-3);
  file.number("/velocity", "fs", 1000.0);
  const Record record = imported(file.bytes());
  EXPECT_EQ(record.channels[0].clock.interval, 1e-3);
  EXPECT_THAT(record.warnings,
              ElementsAre("'/force': one attribute says that samples are 0.001 s apart, that of "
                          "its rate 0.002 s: the first is used"));
}

TEST(Hdf5Clock, OfADataSetThatContradictsTheTimesBesideItIsToldOf) {
  const Hdf5File file;
  file.doubles("/force", {1, 2, 3});
  file.number("/force", "dt", 1e-3);
  file.doubles("/time", {0, 0.002, 0.004});
  file.text("/time", "units", "s");
  const Record record = imported(file.bytes());
  EXPECT_EQ(record.channels[0].clock.interval, 1e-3);
  EXPECT_THAT(record.warnings,
              ElementsAre("'/force': its attributes say that samples are 0.001 s apart, what "
                          "stands beside it 0.002 s: its attributes are used"));
}

// A double holds such a count to 256 ns.
TEST(Hdf5Clock, OfLargeIntegersIsTakenFromTheirFirst) {
  for (const bool uneven : {false, true}) {
    const Hdf5File file;
    std::vector<std::int64_t> counts;
    for (std::int64_t i = 0; i < 8; ++i)
      counts.push_back(1709290000000000000 + 100 * i + (uneven && i > 4 ? 30 : 0));
    file.data<std::int64_t>("/time", {8}, counts, H5T_NATIVE_INT64, H5T_STD_I64LE);
    file.text("/time", "units", "ns");
    file.doubles("/force", {1, 2, 3, 4, 5, 6, 7, 8});
    const Record record = imported(file.bytes());
    const Channel& force = record.channels[0];
    EXPECT_EQ(force.clock.start, 0.0);
    EXPECT_THAT(record.warnings, Contains("'/time' begins at 1709290000.000 s: times are told from "
                                          "there, since a double does not hold them"));
    EXPECT_EQ(record.started, "2024-03-01T10:46:40Z");
    if (!uneven) {
      EXPECT_DOUBLE_EQ(force.clock.interval, 1e-7);
      continue;
    }
    ASSERT_EQ(force.clock.times.size(), 8U);
    EXPECT_DOUBLE_EQ(force.clock.times[7], 7.3e-7);
    ImportOptions options;
    options.from = 3.5e-7;
    options.channels = {"/force"};
    const Record part = imported(file.bytes(), options);
    ASSERT_EQ(part.channels[0].clock.times.size(), 4U);
    EXPECT_DOUBLE_EQ(part.channels[0].clock.times[1], 5.3e-7);
  }
}

TEST(Hdf5Clock, MayBeStatedWithItsUnit) {
  for (const auto& [key, text] :
       {std::pair{"fs", "51.2 kHz"}, std::pair{"sample_rate", "51200"},
        std::pair{"SamplingFrequency", "51200"}, std::pair{"SamplingInterval", "19.53125 us"},
        std::pair{"dt", "19.53125 us"}}) {
    const Hdf5File file;
    file.doubles("/force", {1, 2, 3});
    file.text("/force", key, text);
    EXPECT_NEAR(imported(file.bytes()).channels[0].clock.interval, 1.0 / 51200.0, 1e-18) << text;
  }
  const Hdf5File file;
  file.doubles("/force", {1, 2, 3});
  file.number("/force", "dt", 2.0);
  file.text("/force", "dt_units", "ms");
  EXPECT_EQ(imported(file.bytes()).channels[0].clock.interval, 0.002);
}

// Numbers and times beside the data, whose unit the file states or their name ends with.
TEST(Hdf5Clock, OfOtherDataSetsCountsTheirUnits) {
  {
    const Hdf5File file;
    file.doubles("/force", {1, 2, 3});
    file.doubles("/time_us", {0, 50, 100});
    EXPECT_DOUBLE_EQ(imported(file.bytes()).channels[0].clock.interval, 5e-5);
  }
  {
    const Hdf5File file;
    file.doubles("/force", {1, 2, 3});
    file.data<double>("/dt", {}, {50}, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
    file.text("/dt", "units", "us");
    EXPECT_DOUBLE_EQ(imported(file.bytes()).channels[0].clock.interval, 5e-5);
  }
  {
    const Hdf5File file;
    file.doubles("/force", {1, 2, 3});
    file.data<double>("/fs", {}, {20}, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
    file.text("/fs", "units", "kHz");
    EXPECT_DOUBLE_EQ(imported(file.bytes()).channels[0].clock.interval, 5e-5);
  }
}

// Single numbers are facts about the recording, and no channels.
TEST(Hdf5Units, ThatAreStatedReplaceThoseOfTheFile) {
  const Hdf5File file;
  file.doubles("/force", {1, 2, 3});
  file.text("/force", "units", "N");
  file.data<double>("/gain", {}, {2.5}, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
  file.doubles("/time", {0, 1, 2});
  file.doubles("/way [mm]", {1, 2, 3});
  ImportOptions options;
  options.units = {"kN", "ms", ""};
  const Record record = imported(file.bytes(), options);
  ASSERT_EQ(record.channels.size(), 3U);
  EXPECT_EQ(record.channels[0].unit, "kN");
  EXPECT_EQ(record.channels[0].quantity, datasets::Quantity::force);
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 1e-3);
  EXPECT_EQ(record.channels[2].unit, "mm");
  EXPECT_EQ(record.attributes.at("/gain"), "2.5");
  EXPECT_THAT(record.warnings, IsEmpty());
  options.units = {"kN"};
  EXPECT_EQ(import_error(file.bytes(), options),
            "FILE: 1 unit is stated but the file has 3 channels: state one for each, or nothing "
            "between two commas to leave what the file says");
}

TEST(Hdf5Units, MayBeStatedOfMatFilesOfVersion73) {
  const Hdf5File file(512);
  file.data<double>("/dt", {1, 1}, {20}, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
  file.data<double>("/force", {1, 3}, {1, 2, 3}, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
  ImportOptions options;
  options.units = {"us", "kN"};
  const Record record = imported(tests::mat73_bytes(file), options, ".mat");
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_EQ(record.channels[1].unit, "kN");
  EXPECT_DOUBLE_EQ(record.channels[1].clock.interval, 2e-5);
}

// Where only its root, behind 64 KiB, tells that a file is ours.
TEST(Hdf5Units, CannotBeStatedOfOurOwnFiles) {
  const Hdf5File file;
  file.text("/", "format", "impactrig-recording");
  ImportOptions options;
  options.format = "hdf5";
  options.units = {"kN"};
  EXPECT_EQ(import_error(file.bytes(), options),
            "FILE: --units is not for impactrig's own HDF5; a map states the units of its channels "
            "(--suggest-map, --map)");
}

// What is said of numbers as they are stored is said of the unit they are taken in.
TEST(Hdf5Units, ThatAreStatedAreThoseOfWarningsToo) {
  const Hdf5File file;
  file.doubles("/scaled", {1, 2, 3});
  file.text("/scaled", "units", "N");
  file.number("/scaled", "gain", 10.0);
  file.doubles("/packed", {1, 2, 3});
  file.number("/packed", "scale_factor", 0.0);
  for (const std::string name : {"/scaled", "/packed"}) file.number(name, "dt", 1.0);
  ImportOptions options;
  options.units = {"m/s", "V"};
  const Record record = imported(file.bytes(), options);
  EXPECT_EQ(record.channels[0].unit, "m/s");
  EXPECT_THAT(record.warnings,
              ElementsAre("'/packed': its attribute 'scale_factor' is 0: its numbers are taken in "
                          "m/s as they are stored",
                          "'/scaled': its attribute 'gain' is not applied: its numbers are taken "
                          "in V as they are stored"));
}

TEST(Hdf5Texts, AreFactsAboutTheRecording) {
  const Hdf5File file;
  file.group("/entry");
  file.text_data("/entry/title", "shot 7");
  file.text_data("/entry/start_time", "2024-03-01T12:00:00Z");
  file.doubles("/entry/force [N]", {1, 2, 3});
  file.number("/entry/force [N]", "fs", 10.0);
  const Record record = imported(file.bytes());
  EXPECT_EQ(record.title, "shot 7");
  EXPECT_EQ(record.started, "2024-03-01T12:00:00Z");
  EXPECT_EQ(record.attributes.at("/entry/title"), "shot 7");
  EXPECT_EQ(record.channels[0].unit, "N");
  EXPECT_THAT(record.warnings, IsEmpty());
}

}  // namespace
}  // namespace impactrig::acquisition
