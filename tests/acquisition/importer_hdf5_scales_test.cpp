// SPDX-License-Identifier: BSD-3-Clause
// The scales of dimensions, as netCDF4, xarray and h5py write them.
#include <gmock/gmock.h>

#include <string>
#include <vector>

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
using tests::imported;

const Channel& channel_of(const Record& record, const std::string& name) {
  for (const Channel& channel : record.channels)
    if (channel.name == name) return channel;
  ADD_FAILURE() << "no channel " << name;
  static const Channel none;
  return none;
}

/// The scale of a dimension of eight.
void times(const Hdf5File& file, const std::string& path, double interval,
           const std::string& unit = "s") {
  std::vector<double> values;
  for (int i = 0; i < 8; ++i) values.push_back(interval * i);
  file.doubles(path, values);
  file.scale(path);
  if (!unit.empty()) file.text(path, "units", unit);
}

void signal(const Hdf5File& file, const std::string& path, const std::string& scale,
            const std::string& unit = "N") {
  file.doubles(path, {1, 2, 3, 4, 5, 4, 3, 2});
  file.text(path, "units", unit);
  if (!scale.empty()) file.scales(path, {scale});
}

TEST(Hdf5Scales, GiveEachDataSetItsOwnClock) {
  const Hdf5File file;
  times(file, "/time", 1e-3);
  times(file, "/time_vib", 2e-3);
  signal(file, "/force", "/time");
  signal(file, "/velocity", "/time_vib", "m/s");
  const Record record = imported(file.bytes());
  EXPECT_DOUBLE_EQ(channel_of(record, "/force").clock.interval, 1e-3);
  EXPECT_DOUBLE_EQ(channel_of(record, "/velocity").clock.interval, 2e-3);
  EXPECT_DOUBLE_EQ(channel_of(record, "/time_vib").clock.interval, 2e-3);
  EXPECT_EQ(record.attributes.at("time column"),
            "/time (the scale of a dimension); /time_vib (the scale of a dimension)");
  EXPECT_THAT(record.warnings, IsEmpty());
}

// Any name does where the unit is one of time, in any group.
TEST(Hdf5Scales, NeedNotBeNamedLikeATime) {
  const Hdf5File file;
  file.group("/axes");
  times(file, "/axes/tax", 1.0, "ms");
  signal(file, "/force", "/axes/tax");
  file.doubles("/axes/odd", {0, 1, 3, 4, 6, 7, 8, 9});
  file.text("/axes/odd", "units", "s");
  file.scale("/axes/odd");
  signal(file, "/velocity", "/axes/odd", "m/s");
  const Record record = imported(file.bytes());
  EXPECT_DOUBLE_EQ(channel_of(record, "/force").clock.interval, 1e-3);
  EXPECT_THAT(channel_of(record, "/velocity").clock.times, ElementsAre(0, 1, 3, 4, 6, 7, 8, 9));
  ImportOptions options;
  options.from = 6.0;
  options.to = 8.0;
  options.channels = {"/velocity"};
  EXPECT_THAT(imported(file.bytes(), options).channels[0].values(), ElementsAre(5, 4, 3));
}

TEST(Hdf5Scales, WithoutUnitCountWhereTheirNameIsOneOfTime) {
  const Hdf5File file;
  times(file, "/time", 1e-3, "");
  times(file, "/time2", 2e-3, "");
  signal(file, "/force", "/time");
  signal(file, "/velocity", "/time2", "m/s");
  const Record record = imported(file.bytes());
  EXPECT_DOUBLE_EQ(channel_of(record, "/force").clock.interval, 1e-3);
  EXPECT_DOUBLE_EQ(channel_of(record, "/velocity").clock.interval, 2e-3);
  EXPECT_THAT(record.warnings, ElementsAre(HasSubstr("the time is taken as s, since no unit is "
                                                     "stated: /time (the scale of a dimension); "
                                                     "/time2 (the scale of a dimension)")));
}

// One list of indices says nothing of time; a data set beside it may.
TEST(Hdf5Scales, ThatStateNothingOfTimeAreToldOf) {
  const Hdf5File file;
  file.doubles("/obs", {0, 1, 2, 3, 4, 5, 6, 7});
  file.scale("/obs");
  times(file, "/time", 1e-3);
  signal(file, "/force", "/obs");
  signal(file, "/velocity", "/obs");
  const Record record = imported(file.bytes());
  EXPECT_DOUBLE_EQ(channel_of(record, "/force").clock.interval, 1e-3);
  EXPECT_THAT(record.warnings,
              ElementsAre("'/force' and 1 more stand over '/obs', which states no unit of time: "
                          "the clock is taken from elsewhere (--time-column '/obs' takes that)"));
}

TEST(Hdf5Clock, OfTwoTimesThatContradictEachOtherIsToldOf) {
  const Hdf5File file;
  signal(file, "/force", "");
  file.doubles("/t", {0, 0.002, 0.004, 0.006, 0.008, 0.010, 0.012, 0.014});
  file.doubles("/time", {0, 0.001, 0.002, 0.003, 0.004, 0.005, 0.006, 0.007});
  const Record record = imported(file.bytes());
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 0.002);
  EXPECT_THAT(record.warnings,
              Contains(testing::StartsWith("both '/t' and '/time' claim to be the time of 8 "
                                           "samples: '/t' is used")));
}

TEST(Hdf5Scales, OfFrequencyGiveNoClock) {
  const Hdf5File file;
  times(file, "/time", 1e-3);
  times(file, "/f", 10.0, "Hz");
  signal(file, "/spectrum", "/f");
  file.number("/spectrum", "fs", 1000.0);  // of what it was made from
  signal(file, "/force", "/time");
  const Record record = imported(file.bytes());
  const Channel& spectrum = channel_of(record, "/spectrum");
  EXPECT_EQ(spectrum.clock.interval, 0.0);
  EXPECT_EQ(spectrum.attributes.at("domain"), "frequency");
  EXPECT_EQ(spectrum.attributes.at("abscissa unit"), "Hz");
  EXPECT_EQ(spectrum.attributes.at("abscissa increment"), "10");
  EXPECT_EQ(channel_of(record, "/f").attributes.at("domain"), "frequency");
  EXPECT_DOUBLE_EQ(channel_of(record, "/force").clock.interval, 1e-3);
}

TEST(Hdf5Scales, ThatDoNotIncreaseGiveNoClock) {
  const Hdf5File file;
  times(file, "/time", 1e-3);
  file.doubles("/back", {0, 1, 2, 1, 4, 5, 6, 7});
  file.text("/back", "units", "s");
  file.scale("/back");
  signal(file, "/force", "/back");
  const Record record = imported(file.bytes());
  EXPECT_EQ(channel_of(record, "/force").clock.interval, 0.0);
  EXPECT_THAT(record.warnings,
              Contains("'/back' does not increase throughout: it is not taken as the time"));
}

// Columns lie along the time, also where there are more of them than samples.
TEST(Hdf5Scales, SayWhichDimensionIsTheTime) {
  const Hdf5File file;
  times(file, "/time", 1e-3);
  std::vector<double> table(96);
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = static_cast<double>(i);
  file.data<double>("/stations", {12, 8}, table, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
  file.scales("/stations", {"", "/time"});
  const Record record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 13U);
  const Channel& second = channel_of(record, "/stations:2");
  EXPECT_THAT(second.values(), ElementsAre(8, 9, 10, 11, 12, 13, 14, 15));
  EXPECT_DOUBLE_EQ(second.clock.interval, 1e-3);
}

// The unit that is stated says what a scale holds, as that of the file would.
TEST(Hdf5Scales, HaveTheUnitsThatAreStated) {
  const Hdf5File file;
  times(file, "/axis", 1.0, "");
  signal(file, "/force", "/axis");
  ImportOptions options;
  options.units = {"ms", ""};
  Record record = imported(file.bytes(), options);
  EXPECT_DOUBLE_EQ(channel_of(record, "/force").clock.interval, 1e-3);
  EXPECT_EQ(channel_of(record, "/force").unit, "N");
  EXPECT_THAT(record.warnings, IsEmpty());
  options.units = {"kHz", ""};
  options.require_clock = false;
  record = imported(file.bytes(), options);
  EXPECT_EQ(channel_of(record, "/force").attributes.at("abscissa unit"), "kHz");
}

TEST(Hdf5Scales, YieldToAStatedTimeColumn) {
  const Hdf5File file;
  times(file, "/time", 1e-3);
  times(file, "/other", 5e-3);
  signal(file, "/force", "/time");
  ImportOptions options;
  options.time_column = "/other";
  EXPECT_DOUBLE_EQ(channel_of(imported(file.bytes(), options), "/force").clock.interval, 5e-3);
}

// A scale of another length, a data set that is not there any more, which another may have taken
// the place of, the data set itself.
TEST(Hdf5Scales, ThatCannotBeAreLeftAside) {
  const Hdf5File file;
  times(file, "/time", 1e-3);
  file.doubles("/short", {0, 1, 2});
  file.text("/short", "units", "s");
  file.scale("/short");
  signal(file, "/force", "/short");
  file.text_data("/note", "gone");
  signal(file, "/velocity", "/note");
  H5Ldelete(file.id(), "/note", H5P_DEFAULT);
  signal(file, "/x", "/x");
  const Record record = imported(file.bytes());
  for (const std::string name : {"/force", "/velocity", "/x"})
    EXPECT_DOUBLE_EQ(channel_of(record, name).clock.interval, 1e-3) << name;
}

}  // namespace
}  // namespace impactrig::acquisition
