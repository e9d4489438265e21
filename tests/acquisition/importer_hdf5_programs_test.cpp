// SPDX-License-Identifier: BSD-3-Clause
// HDF5 files in which a program says in words of its own when and in what its numbers were taken.
#include <gmock/gmock.h>
#include <hdf5.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "acquisition/importer.hpp"
#include "tests/acquisition/hdf5_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Channel;
using datasets::Quantity;
using datasets::Record;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using tests::Hdf5File;
using tests::imported;

/// The attributes of a channel of a Keysight Infiniium, as its help lists them.
void keysight_channel(const Hdf5File& file, const std::string& path, double segments) {
  file.group(path);
  file.number(path, "XInc", 5e-10);
  file.number(path, "XOrg", -2e-5);
  file.text(path, "XUnits", "Second");
  file.number(path, "YInc", 0.25);
  file.number(path, "YOrg", 1.5);
  file.text(path, "YUnits", "Volt");
  file.number(path, "NumSegments", segments);
}

TEST(Hdf5OfKeysight, HasItsTimesAndVoltsAtTheGroup) {
  const Hdf5File file;
  file.group("/Waveforms");
  keysight_channel(file, "/Waveforms/Channel 1", 0.0);
  file.data<std::int16_t>("/Waveforms/Channel 1/Channel 1Data", {4}, {0, 1, -2, 4},
                          H5T_NATIVE_INT16, H5T_STD_I16LE);
  keysight_channel(file, "/Waveforms/Memory 1", 0.0);
  file.data<float>("/Waveforms/Memory 1/Memory 1Data", {3}, {0.5F, 2.0F, -1.0F}, H5T_NATIVE_FLOAT,
                   H5T_IEEE_F32LE);
  const Record record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 2U);
  for (const Channel& channel : record.channels) {
    EXPECT_EQ(channel.clock.interval, 5e-10);
    EXPECT_EQ(channel.clock.start, -2e-5);
    EXPECT_EQ(channel.unit, "Volt");
    EXPECT_EQ(channel.quantity, Quantity::voltage);
  }
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1.5, 1.75, 1.0, 2.5));  // levels
  EXPECT_THAT(record.channels[1].values(), ElementsAre(0.5, 2.0, -1.0));       // volts already
  EXPECT_THAT(record.warnings, IsEmpty());
}

TEST(Hdf5OfKeysight, HasAnOriginForEachSegment) {
  const Hdf5File file;
  file.group("/Waveforms");
  keysight_channel(file, "/Waveforms/Channel 2", 2.0);
  for (const int segment : {1, 2}) {
    const std::string path =
        "/Waveforms/Channel 2/Channel 2 Seg" + std::to_string(segment) + "Data";
    file.data<std::int16_t>(path, {2}, {2, 4}, H5T_NATIVE_INT16, H5T_STD_I16LE);
    file.number(path, "SegmentedXOrg", -2e-5 - 1e-10 * segment);
    file.number(path, "SegmentedTimeTag", 0.01 * segment);
  }
  const Record record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_EQ(record.channels[0].clock.start, -2e-5 - 1e-10);
  EXPECT_EQ(record.channels[1].clock.start, -2e-5 - 2e-10);
  EXPECT_EQ(record.channels[1].clock.interval, 5e-10);
  EXPECT_EQ(record.channels[1].attributes.at("SegmentedTimeTag"), "0.02");
}

TEST(Hdf5OfKeysight, IsNoRecordOverTimeWhereItsUnitIsAnother) {
  const Hdf5File file;
  file.group("/Waveforms");
  file.group("/Waveforms/Function 1");
  file.number("/Waveforms/Function 1", "XInc", 1e3);
  file.number("/Waveforms/Function 1", "XOrg", 0.0);
  file.text("/Waveforms/Function 1", "XUnits", "Hertz");
  file.doubles("/Waveforms/Function 1/Function 1Data", {1.0, 2.0, 3.0});
  EXPECT_EQ(imported(file.bytes()).channels.at(0).clock.interval, 0.0);
}

// A row for the numbers, then one a dimension, each of step and start.
TEST(Hdf5OfIgor, HasScalingAndUnitsOfWaves) {
  const Hdf5File file;
  file.doubles("/force", {1.0, 2.0, 3.0});
  file.numbers("/force", "IGORWaveScaling", {0.0, 0.0, 0.02, -1.0});
  file.texts("/force", "IGORWaveUnits", {"N", "ms"});
  file.data<double>("/shots", {2, 3}, {1.0, 2.0, 3.0, 4.0, 5.0, 6.0}, H5T_NATIVE_DOUBLE,
                    H5T_IEEE_F64LE);
  file.numbers("/shots", "IGORWaveScaling", {0.0, 0.0, 1.0, 0.0, 1e-5, 2e-3});
  file.texts("/shots", "IGORWaveUnits", {"m/s", "", "s"});
  file.doubles("/bare", {1.0, 2.0});
  file.numbers("/bare", "IGORWaveScaling", {0.0, 0.0, 1e-4, 0.0});
  const Record record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 4U);
  const auto channel = [&](const std::string& name) {
    return *std::ranges::find(record.channels, name, &Channel::name);
  };
  EXPECT_DOUBLE_EQ(channel("/force").clock.interval, 2e-5);
  EXPECT_DOUBLE_EQ(channel("/force").clock.start, -1e-3);
  EXPECT_EQ(channel("/force").unit, "N");
  EXPECT_EQ(channel("/shots:2").clock.interval, 1e-5);
  EXPECT_EQ(channel("/shots:2").clock.start, 2e-3);
  EXPECT_EQ(channel("/shots:2").unit, "m/s");
  EXPECT_THAT(channel("/shots:2").values(), ElementsAre(4.0, 5.0, 6.0));
  EXPECT_EQ(channel("/bare").clock.interval, 1e-4);
  EXPECT_EQ(channel("/bare").unit, "");
}

TEST(Hdf5OfIgor, HasNoTimesWhereAWaveWasNotScaledOrIsOverSomethingElse) {
  const Hdf5File file;
  file.doubles("/points", {1.0, 2.0, 3.0});
  file.numbers("/points", "IGORWaveScaling", {0.0, 0.0, 1.0, 0.0});
  file.doubles("/profile", {1.0, 2.0, 3.0, 4.0});
  file.numbers("/profile", "IGORWaveScaling", {0.0, 0.0, 0.5, 0.0});
  file.texts("/profile", "IGORWaveUnits", {"N", "mm"});
  file.doubles("/torn", {1.0, 2.0});
  file.numbers("/torn", "IGORWaveScaling", {0.0, 0.0, 0.5});
  const Record record = imported(file.bytes());
  ASSERT_EQ(record.channels.size(), 3U);
  for (const Channel& channel : record.channels)
    EXPECT_EQ(channel.clock.interval, 0.0) << channel.name;
}

/// As Octave's `save -hdf5` keeps a variable.
void octave_variable(const Hdf5File& file, const std::string& path, const std::string& type) {
  file.group(path);
  file.number(path, "OCTAVE_NEW_FORMAT", 1.0);
  file.text_data(path + "/type", type);
}

TEST(Hdf5OfOctave, HasTheNamesOfItsVariables) {
  const Hdf5File file;
  octave_variable(file, "/t", "matrix");
  file.data<double>("/t/value", {1, 3}, {0.0, 1e-5, 2e-5}, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
  octave_variable(file, "/F", "float matrix");
  file.data<double>("/F/value", {1, 3}, {1.0, 2.0, 3.0}, H5T_NATIVE_DOUBLE, H5T_IEEE_F32LE);
  octave_variable(file, "/name", "sq_string");
  file.data<char>("/name/value", {4, 1}, {'s', 'h', 'o', 't'}, H5T_NATIVE_CHAR, H5T_STD_I8LE);
  octave_variable(file, "/run", "scalar struct");
  file.group("/run/value");
  octave_variable(file, "/run/value/v", "matrix");
  file.doubles("/run/value/v/value", {1.0, 2.0});
  octave_variable(file, "/run/value/fs", "scalar");
  file.data<double>("/run/value/fs/value", {}, {1e4}, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
  const Record record = imported(file.bytes());
  std::vector<std::string> names;
  for (const Channel& channel : record.channels) names.push_back(channel.name);
  EXPECT_THAT(names, ElementsAre("/F", "/run/v", "/t"));
  EXPECT_EQ(record.channels.at(0).clock.interval, 1e-5);
  EXPECT_EQ(record.channels.at(1).clock.interval, 1e-4);
  EXPECT_THAT(record.warnings, testing::Contains(HasSubstr("'/name' (text)")));
  EXPECT_FALSE(record.attributes.contains("/t/type"));
}

TEST(Hdf5OfTektronix, HasSpacingAndStartTimeBesideTheData) {
  const Hdf5File file;
  file.doubles("/Data", {1.0, 2.0, 3.0});
  file.doubles("/Spacing", {1e-8});
  // alone it may be that of a grid
  EXPECT_EQ(imported(file.bytes()).channels.at(0).clock.interval, 0.0);
  file.doubles("/StartTime", {-8e-6});
  const Record record = imported(file.bytes());
  EXPECT_EQ(record.channels.at(0).clock.interval, 1e-8);
  EXPECT_EQ(record.channels.at(0).clock.start, -8e-6);
  EXPECT_THAT(record.warnings, Each(Not(HasSubstr("neither times nor"))));
}

}  // namespace
}  // namespace impactrig::acquisition
