// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <tuple>

#include "tests/acquisition/tdms_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using testing::ElementsAre;
using testing::ElementsAreArray;
using testing::HasSubstr;
using tests::imported;
using tests::TdmsParts;
using Shorts = std::vector<std::int16_t>;

const TdmsParts little;

std::vector<std::string> names(const datasets::Record& record) {
  std::vector<std::string> list;
  for (const datasets::Channel& channel : record.channels) list.push_back(channel.name);
  return list;
}

class TdmsInBothByteOrders : public testing::TestWithParam<bool> {
 protected:
  TdmsParts t_{GetParam()};
};

INSTANTIATE_TEST_SUITE_P(Tdms, TdmsInBothByteOrders, testing::Bool());

TEST_P(TdmsInBothByteOrders, EveryKindOfNumberIsRead) {
  const auto read = [&](std::uint32_t type, const std::string& data) {
    const auto record = imported(t_.segment({t_.channel("a", t_.index(type, 2))}, data));
    EXPECT_EQ(record.warnings.size(), 1U);  // no clock
    return record.channels.at(0).values();
  };
  EXPECT_THAT(read(0x01, t_.numbers(std::vector<std::int8_t>{-128, 127})), ElementsAre(-128, 127));
  EXPECT_THAT(read(0x02, t_.numbers(Shorts{-32768, 5})), ElementsAre(-32768, 5));
  EXPECT_THAT(read(0x03, t_.numbers(std::vector<std::int32_t>{-70000, 5})), ElementsAre(-70000, 5));
  EXPECT_THAT(read(0x04, t_.numbers(std::vector<std::int64_t>{-5000000000, 5})),
              ElementsAre(-5000000000, 5));
  EXPECT_THAT(read(0x05, t_.numbers(std::vector<std::uint8_t>{200, 5})), ElementsAre(200, 5));
  EXPECT_THAT(read(0x06, t_.numbers(std::vector<std::uint16_t>{60000, 5})), ElementsAre(60000, 5));
  EXPECT_THAT(read(0x07, t_.numbers(std::vector<std::uint32_t>{4000000000, 5})),
              ElementsAre(4000000000, 5));
  EXPECT_THAT(read(0x08, t_.numbers(std::vector<std::uint64_t>{10000000000, 5})),
              ElementsAre(10000000000, 5));
  EXPECT_THAT(read(0x09, t_.numbers(std::vector<float>{0.5F, -1e30F})), ElementsAre(0.5, -1e30F));
  EXPECT_THAT(read(0x0A, t_.numbers(std::vector<double>{0.1, -1e300})), ElementsAre(0.1, -1e300));
  EXPECT_THAT(read(0x19, t_.numbers(std::vector<float>{0.5F, 2.0F})), ElementsAre(0.5, 2.0));
  EXPECT_THAT(read(0x1A, t_.numbers(std::vector<double>{0.1, 2.0})), ElementsAre(0.1, 2.0));
  EXPECT_THAT(read(0x21, t_.numbers(std::vector<std::uint8_t>{1, 0})), ElementsAre(1, 0));
}

TEST_P(TdmsInBothByteOrders, AUnitMayStandInOtherProperties) {
  const auto unit = [&](const std::vector<std::string>& properties) {
    return imported(t_.segment({t_.channel("a", t_.index(0x0A, 1), properties)}, t_.number(1.0)))
        .channels.at(0)
        .unit;
  };
  for (const char* name : {"NI_UnitDescription", "Unit", "Units", "units", "Einheit"})
    EXPECT_EQ(unit({t_.property(name, "kN")}), "kN") << name;
  EXPECT_EQ(unit({t_.property("Unit", "kN"), t_.property("unit_string", "N")}), "N");
  EXPECT_EQ(unit({t_.property("Unit", "bar end")}), "");
}

// Of the channel, its group or the file, in words of users.
TEST_P(TdmsInBothByteOrders, ARateMayStandInOtherProperties) {
  const auto index = t_.index(0x0A, 1);
  const auto clock = [&](const std::vector<std::string>& objects) {
    return imported(t_.segment(objects, t_.number(1.0))).channels.at(0).clock.interval;
  };
  const auto of_channel = [&](const std::string& property) {
    return clock({t_.channel("a", index, {property})});
  };
  EXPECT_EQ(of_channel(t_.property("Sampling_Rate", 1000.0)), 1e-3);
  EXPECT_EQ(of_channel(t_.property("Sample Rate [kHz]", 1.0)), 1e-3);
  EXPECT_EQ(of_channel(t_.property("dt_ms", 2.0)), 2e-3);
  EXPECT_EQ(of_channel(t_.property("wf_increment", "0.001")), 1e-3);
  EXPECT_EQ(of_channel(t_.property("fs", "51.2 kHz")), 1.0 / 51200.0);
  EXPECT_EQ(of_channel(t_.property("ts", 1.7e9)), 0.0);  // as often a date
  EXPECT_EQ(of_channel(t_.property("Heart rate", 60.0)), 0.0);
  EXPECT_EQ(clock({t_.object("/'G'", t_.none(), {t_.property("dt", 0.5)}), t_.channel("a", index)}),
            0.5);
  EXPECT_EQ(clock({t_.object("/", t_.none(), {t_.property("Sample Rate", 100.0)}),
                   t_.channel("a", index, {t_.property("wf_increment", 1.0)})}),
            0.01);  // an increment of 1 is what LabVIEW writes where it knows none
  EXPECT_EQ(clock({t_.object("/", t_.none(), {t_.property("Sample Rate", 100.0)}),
                   t_.channel("a", index, {t_.property("wf_increment", 0.25)})}),
            0.25);
}

TEST_P(TdmsInBothByteOrders, ComplexNumbersHaveTwoParts) {
  const auto record = imported(t_.segment(
      {t_.channel("s", t_.index(0x08000C, 2)), t_.channel("d", t_.index(0x10000D, 1))},
      t_.numbers(std::vector<float>{1, 2, 3, 4}) + t_.numbers(std::vector<double>{5, 6})));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(1, 3));
  EXPECT_THAT(record.channels.at(0).imaginary, ElementsAre(2, 4));
  EXPECT_THAT(record.channels.at(1).values(), ElementsAre(5));
  EXPECT_THAT(record.channels.at(1).imaginary, ElementsAre(6));
}

TEST_P(TdmsInBothByteOrders, InterleavedValuesOfDifferentWidthAreTakenApart) {
  std::string data;
  for (int i = 0; i < 3; ++i)
    data += t_.number(static_cast<std::int16_t>(i)) + t_.number(10.0 + i) +
            t_.number(static_cast<std::uint8_t>(100 + i));
  const auto record =
      imported(t_.segment({t_.channel("a", t_.index(2, 1)), t_.channel("b", t_.index(10, 1)),
                           t_.channel("c", t_.index(5, 1))},
                          data, TdmsParts::interleaved));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(0, 1, 2));
  EXPECT_THAT(record.channels.at(1).values(), ElementsAre(10, 11, 12));
  EXPECT_THAT(record.channels.at(2).values(), ElementsAre(100, 101, 102));
}

TEST_P(TdmsInBothByteOrders, ASegmentInheritsWhatItDoesNotState) {
  const std::string first =
      t_.segment({t_.channel("a", t_.index(2, 2)), t_.channel("b", t_.index(2, 1))},
                 t_.numbers(Shorts{1, 2, 11}));
  // two chunks without a list; then b alone; then both again by their indices of before, b first
  const std::string file =
      first + t_.segment({}, t_.numbers(Shorts{3, 4, 12, 5, 6, 13}), TdmsParts::bare) +
      t_.segment({t_.channel("a", t_.none())}, t_.numbers(Shorts{14, 15}), TdmsParts::continued) +
      t_.segment({t_.channel("b", t_.same()), t_.channel("a", t_.same())},
                 t_.numbers(Shorts{16, 7, 8})) +
      t_.segment({t_.channel("c", t_.index(2, 1))}, t_.numbers(Shorts{17, 9, 10, 21}),
                 TdmsParts::continued);
  const auto record = imported(file);
  EXPECT_THAT(names(record), ElementsAre("a", "b", "c"));
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9, 10));
  EXPECT_THAT(record.channels[1].values(), ElementsAre(11, 12, 13, 14, 15, 16, 17));
  EXPECT_THAT(record.channels[2].values(), ElementsAre(21));
}

TEST_P(TdmsInBothByteOrders, DaqmxBuffersAreRowsOfTheirOwnWidth) {
  // two cards: rows of 2 + 1 + 4 bytes, then rows of 2; two chunks
  const std::vector<std::uint32_t> widths = {7, 2};
  std::string data;
  for (int chunk = 0; chunk < 2; ++chunk) {
    for (int i = 0; i < 2; ++i)
      data += t_.number(static_cast<std::int16_t>(-1 - i - 2 * chunk)) +
              t_.number(static_cast<std::uint8_t>(200 + i + 2 * chunk)) +
              t_.number(70000 + i + 2 * chunk);
    for (int i = 0; i < 3; ++i)
      data += t_.number(static_cast<std::uint16_t>(60000 + i + 3 * chunk));
  }
  const auto record =
      imported(t_.segment({t_.channel("a", t_.daqmx_index(2, {{3, 0, 0, 0}}, widths)),
                           t_.channel("b", t_.daqmx_index(2, {{0, 0, 2, 0}}, widths)),
                           t_.channel("c", t_.daqmx_index(2, {{5, 0, 3, 0}}, widths)),
                           t_.channel("d", t_.daqmx_index(3, {{2, 1, 0, 0}}, widths))},
                          data, 0x80));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(-1, -2, -3, -4));
  EXPECT_THAT(record.channels.at(1).values(), ElementsAre(200, 201, 202, 203));
  EXPECT_THAT(record.channels.at(2).values(), ElementsAre(70000, 70001, 70002, 70003));
  EXPECT_THAT(record.channels.at(3).values(),
              ElementsAre(60000, 60001, 60002, 60003, 60004, 60005));
}

// Software-timed tasks: DAQmx indices of plain types, time stamps among them.
TEST_P(TdmsInBothByteOrders, DaqmxRowsMayBeginWithTheirTimeStamp) {
  std::string data;
  for (int i = 0; i < 5; ++i)
    data += t_.time(3600000000 + 2 * i) + t_.number(std::int64_t{7 * i}) + t_.number(0.5 * i);
  const std::vector<std::uint32_t> widths = {32};
  const std::vector<std::string> channels = {
      t_.channel("when", t_.daqmx_index(1, {{0xFFFFFFFF, 0, 0, 0}}, widths, 0x1269, 0x44)),
      t_.channel("count", t_.daqmx_index(1, {{7, 0, 16, 0}}, widths, 0x1269, 0x04)),
      t_.channel("F", t_.daqmx_index(1, {{9, 0, 24, 0}}, widths, 0x1269, 0x0A))};
  const auto record = imported(t_.segment(channels, data));
  ASSERT_EQ(record.channels.size(), 3U);
  EXPECT_THAT(record.channels[0].values(), ElementsAre(0, 2, 4, 6, 8));
  EXPECT_EQ(record.channels[0].unit, "s");
  EXPECT_THAT(record.channels[1].values(), ElementsAre(0, 7, 14, 21, 28));
  EXPECT_THAT(record.channels[2].values(), ElementsAre(0, 0.5, 1, 1.5, 2));
  EXPECT_EQ(record.channels[2].clock.interval, 2.0);
}

TEST_P(TdmsInBothByteOrders, TextsOfOneChannelAloneAreNeverInterleaved) {
  const std::string texts = t_.number(std::uint32_t{2}) + t_.number(std::uint32_t{5}) + "abcde";
  const auto record = imported(
      t_.segment({t_.channel("a", t_.index(2, 2))}, t_.numbers(std::vector<std::int16_t>{1, 2})) +
      t_.segment({t_.channel("note", t_.text_index(2, 13))}, texts, TdmsParts::interleaved));
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1, 2));
}

TEST_P(TdmsInBothByteOrders, DigitalLinesAreBits) {
  for (const std::uint32_t header : {0x126AU, 0x1369U}) {
    const auto record =
        imported(t_.segment({t_.channel("line0", t_.daqmx_index(3, {{0, 0, 0, 0}}, {2}, header)),
                             t_.channel("line11", t_.daqmx_index(3, {{0, 0, 11, 0}}, {2}, header))},
                            t_.numbers(std::vector<std::uint8_t>{1, 8, 254, 247, 3, 255}), 0x80));
    EXPECT_THAT(record.channels.at(0).values(), ElementsAre(1, 0, 1));
    EXPECT_THAT(record.channels.at(1).values(), ElementsAre(1, 0, 1));
  }
}

TEST_P(TdmsInBothByteOrders, TimeStampsAreSecondsSinceTheFirstAndTimeTheOthersOfTheirGroup) {
  const std::uint64_t quarter = std::uint64_t{1} << 62;
  const auto record =
      imported(t_.segment({t_.channel("when", t_.index(0x44, 3)), t_.channel("F", t_.index(2, 3))},
                          t_.time(3600000000, 3 * quarter) + t_.time(3600000001, 1 * quarter) +
                              t_.time(3600000009, 0) + t_.numbers(Shorts{1, 2, 3})));
  const datasets::Channel& when = record.channels.at(0);
  EXPECT_THAT(when.values(), ElementsAre(0.0, 0.5, 8.25));
  EXPECT_EQ(when.unit, "s");
  EXPECT_EQ(when.attributes.at("first time stamp"), "2018-01-28T16:00:00.75Z");
  const datasets::Channel& force = record.channels.at(1);
  EXPECT_THAT(force.clock.times, ElementsAre(0.0, 0.5, 8.25));
  EXPECT_EQ(force.attributes.at("times from"), "when");
  EXPECT_THAT(
      record.warnings,
      ElementsAre("times from 'when': the samples are not evenly spaced (steps differ from their "
                  "mean of 4.125 s by up to 3.62 s): every time is kept",
                  "channels of 'G' state no sample interval: their times are the time stamps in "
                  "'when' (--time-column none leaves them out)"));
}

TEST_P(TdmsInBothByteOrders, AChannelThatIsATimeByNameAndUnitTimesTheOthersOfItsGroup) {
  const auto file = [this](const Shorts& times, std::string_view unit) {
    return t_.segment({t_.channel("Time", t_.index(2, 3), {t_.property("unit_string", unit)}),
                       t_.channel("F", t_.index(2, 3))},
                      t_.numbers(times) + t_.numbers(Shorts{1, 2, 3}));
  };
  const auto record = imported(file({5, 6, 7}, "ms"));
  EXPECT_DOUBLE_EQ(record.channels.at(1).clock.interval, 1e-3);
  EXPECT_DOUBLE_EQ(record.channels[1].clock.start, 5e-3);
  EXPECT_THAT(record.warnings,
              ElementsAre("channels of 'G' state no sample interval: their times are the numbers "
                          "in 'Time' (--time-column none leaves them out)"));
  EXPECT_EQ(imported(file({5, 7, 6}, "ms")).channels.at(1).clock.interval, 0.0);
  EXPECT_EQ(imported(file({5, 6, 7}, "N")).channels.at(1).clock.interval, 0.0);
}

// LabVIEW writes wf_increment = 1 where it knows none: steps of 20 ms were 1 s.
TEST_P(TdmsInBothByteOrders, AChannelOfTimesCountsBeforeAnIncrementOfOne) {
  const auto file = [this](const Shorts& times, std::string_view name, double increment) {
    const std::vector<std::string> clock = {t_.property("wf_increment", increment)};
    return t_.segment(
        {t_.channel(name, t_.index(2, 3), clock), t_.channel("F", t_.index(2, 3), clock)},
        t_.numbers(times) + t_.numbers(Shorts{1, 2, 3}));
  };
  for (const char* name : {"Time (ms)", "Time_ms"}) {
    const auto record = imported(file({5, 25, 45}, name, 1.0));
    EXPECT_DOUBLE_EQ(record.channels.at(1).clock.interval, 20e-3) << name;
    EXPECT_DOUBLE_EQ(record.channels[1].clock.start, 5e-3);
    EXPECT_THAT(record.warnings, testing::Contains(testing::HasSubstr("wf_increment is 1 s")));
  }
  EXPECT_EQ(imported(file({5, 6, 7}, "Time", 1.0)).channels.at(1).clock.interval, 1.0);
  EXPECT_EQ(imported(file({5, 25, 45}, "Time (ms)", 0.5)).channels.at(1).clock.interval, 0.5);
}

TEST_P(TdmsInBothByteOrders, TimesSince1904AreToldOf) {
  const auto record = imported(
      t_.segment({t_.channel("Time", t_.index(10, 3)), t_.channel("F", t_.index(2, 3))},
                 t_.numbers(std::vector<double>{3698388672.0, 3698388673.0, 3698388674.0}) +
                     t_.numbers(Shorts{1, 2, 3})));
  EXPECT_THAT(record.warnings,
              testing::Contains(testing::HasSubstr("which is 2021-03-12T10:11:12Z if it counts")));
}

TEST_P(TdmsInBothByteOrders, TimeStampsYearsApartKeepHalfAMicrosecond) {
  const auto record =
      imported(t_.segment({t_.channel("when", t_.index(0x44, 2))},
                          t_.time(3600000000, 0) + t_.time(3700000000, std::uint64_t{1} << 63)));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(0.0, 100000000.5));
}

TEST_P(TdmsInBothByteOrders, WaveformPropertiesGiveTheClock) {
  const std::uint64_t half = std::uint64_t{1} << 63;
  const auto record = imported(t_.segment(
      {t_.object("/", t_.none(),
                 {t_.property("name", "run 7"), t_.property("Operator", "M\xFCller")}),
       t_.object("/'G'", t_.none(), {t_.property("rig", 3U)}),
       t_.channel("F", t_.index(2, 2),
                  {t_.property("wf_increment", 1e-5), t_.property("wf_start_offset", -0.25),
                   t_.raw_property("wf_start_time", 0x44, t_.time(3600000000, half)),
                   t_.property("unit_string", "kN"),
                   t_.raw_property("armed", 0x21, t_.number(std::uint8_t{1}))}),
       t_.channel("v", t_.index(2, 2),
                  {t_.property("wf_increment", 1e-5),
                   t_.raw_property("wf_start_time", 0x44, t_.time(3600000002, half))})},
      t_.numbers(Shorts{1, 2, 3, 4})));
  EXPECT_EQ(record.title, "run 7");
  EXPECT_EQ(record.started, "2018-01-28T16:00:00.5Z");
  EXPECT_EQ(record.attributes.at("Operator"), "Müller");
  EXPECT_EQ(record.attributes.at("G/rig"), "3");
  const datasets::Channel& force = record.channels.at(0);
  EXPECT_EQ(force.clock.interval, 1e-5);
  EXPECT_EQ(force.clock.start, -0.25);
  EXPECT_EQ(force.unit, "kN");
  EXPECT_EQ(force.quantity, datasets::Quantity::force);
  EXPECT_EQ(force.attributes.at("group"), "G");
  EXPECT_EQ(force.attributes.at("armed"), "true");
  EXPECT_EQ(record.channels.at(1).clock.start, 2.0);
  EXPECT_THAT(
      record.warnings,
      ElementsAre("channels start at different times: time 0 is the start of the earliest"));
}

TEST(Tdms, AChannelsNameMayStateItsUnit) {
  const std::vector<std::pair<std::string, std::string>> names = {
      {"Force (kN)", "kN"}, {"v [m/s]", "m/s"}, {"Untitled (2)", ""}, {"Left (A)", ""}};
  for (const auto& [name, unit] : names)
    EXPECT_EQ(imported(little.segment({little.channel(name, little.index(2, 1), {})},
                                      little.numbers(Shorts{1})))
                  .channels.at(0)
                  .unit,
              unit)
        << name;
  EXPECT_EQ(imported(little.segment({little.channel("Force (kN)", little.index(2, 1),
                                                    {little.property("unit_string", "N")})},
                                    little.numbers(Shorts{1})))
                .channels.at(0)
                .unit,
            "N");
}

TEST(Tdms, TheAbscissaHasAUnit) {
  const auto over = [](const std::string& name, const std::string& unit) {
    std::vector<std::string> properties = {little.property("wf_increment", 2.5),
                                           little.property("wf_start_offset", 10.0)};
    if (!name.empty()) properties.push_back(little.property("wf_xname", name));
    if (!unit.empty()) properties.push_back(little.property("wf_xunit_string", unit));
    return imported(little.segment({little.channel("a", little.index(2, 2), properties)},
                                   little.numbers(Shorts{1, 2})))
        .channels.at(0);
  };
  for (const auto& [name, unit] :
       {std::pair<std::string, std::string>{"", ""}, {"Time", "s"}, {"Time", ""}, {"X", "s"}}) {
    EXPECT_EQ(over(name, unit).clock.interval, 2.5) << name << unit;
    EXPECT_EQ(over(name, unit).clock.start, 10.0) << name << unit;
    EXPECT_FALSE(over(name, unit).attributes.contains("domain")) << name << unit;
  }
  EXPECT_EQ(over("Time", "ms").clock.interval, 2.5e-3);
  EXPECT_EQ(over("Time", "ms").clock.start, 10e-3);
  for (const auto& [name, unit, domain] :
       {std::tuple<std::string, std::string, std::string>{"Frequency", "Hz", "frequency"},
        {"", "kHz", "frequency"},
        {"Frequency", "", "frequency"},
        {"Way", "mm", "Way"},
        {"Time", "mm", "displacement"}}) {
    const datasets::Channel channel = over(name, unit);
    EXPECT_EQ(channel.clock.interval, 0.0) << name << unit;
    EXPECT_EQ(channel.attributes.at("domain"), domain);
    EXPECT_EQ(channel.attributes.at("abscissa unit"), unit);
    EXPECT_EQ(channel.attributes.at("abscissa first"), "10");
    EXPECT_EQ(channel.attributes.at("abscissa increment"), "2.5");
  }
}

TEST(Tdms, SegmentsOfDifferentByteOrderJoin) {
  const TdmsParts big(true);
  const auto record = imported(
      little.segment({little.channel("a", little.index(2, 2))}, little.numbers(Shorts{1, 2})) +
      big.segment({big.channel("a", big.index(2, 2))}, big.numbers(Shorts{3, 4})) +
      big.segment({}, big.numbers(Shorts{5, 6}), TdmsParts::bare));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(1, 2, 3, 4, 5, 6));
}

// Uneven counts, several segments and chunks; every window and choice of channels is a part of the
// whole.
TEST(Tdms, WindowsAndChannelsArePartsOfTheWhole) {
  const std::vector<std::string> clock = {little.property("wf_increment", 0.5)};
  std::string file;
  Shorts all;
  for (int segment = 0; segment < 5; ++segment) {
    std::string data;
    for (int chunk = 0; chunk <= segment % 3; ++chunk)
      for (int channel = 0; channel < 2; ++channel)
        for (int i = 0; i < 3; ++i) {
          const auto value = static_cast<std::int16_t>(100 * segment + 10 * chunk + i);
          if (channel == 0) all.push_back(value);
          data += little.number(static_cast<std::int16_t>(channel == 0 ? value : -value));
        }
    file += little.segment({little.channel("a", little.index(2, 3), clock),
                            little.channel("b", little.index(2, 3), clock)},
                           data);
  }
  const datasets::Record whole = imported(file);
  ASSERT_THAT(whole.channels.at(0).values(), ElementsAreArray(all));
  for (std::size_t first = 0; first < all.size(); first += 2)
    for (std::size_t last = first; last < all.size(); last += 3) {
      ImportOptions options;
      options.from = 0.5 * static_cast<double>(first);
      options.to = 0.5 * static_cast<double>(last);
      options.channels = {"b"};
      const datasets::Record part = imported(file, options);
      ASSERT_EQ(part.channels.size(), 1U);
      EXPECT_EQ(part.channels[0].clock.start, options.from);
      ASSERT_EQ(part.channels[0].size(), last - first + 1);
      for (std::size_t i = 0; i < part.channels[0].size(); ++i)
        EXPECT_EQ(part.channels[0].value(i), -all[first + i]);
    }
}

TEST(Tdms, AWindowOfStatedTimesIsCutByThem) {
  const std::string file = little.segment(
      {little.channel("t", little.index(10, 5), {little.property("unit_string", "ms")}),
       little.channel("F", little.index(2, 5))},
      little.numbers(std::vector<double>{0, 1, 2, 5, 6}) + little.numbers(Shorts{1, 2, 3, 4, 5}));
  ImportOptions options;
  options.time_column = "t";
  options.from = 0.001;
  options.to = 0.005;
  options.channels = {"F"};
  const auto record = imported(file, options);
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(2, 3, 4));
  EXPECT_THAT(record.channels.at(0).clock.times, ElementsAre(0.001, 0.002, 0.005));
}

TEST(Tdms, ChannelsOfOneNameAreToldApartByTheirGroup) {
  const std::string file = little.segment({little.object("/'G1'/'F'", little.index(2, 1)),
                                           little.object("/'G2'/'F'", little.index(2, 1)),
                                           little.object("/'It''s'/'a/b'", little.index(2, 1))},
                                          little.numbers(Shorts{1, 2, 3}));
  const auto record = imported(file);
  EXPECT_THAT(names(record), ElementsAre("F", "F", "a/b"));
  EXPECT_EQ(record.channels.at(2).attributes.at("group"), "It's");
  EXPECT_EQ(record.warnings.at(0),
            "several groups have a channel 'F': state the group too, 'G2/F'");
  ImportOptions options;
  options.channels = {"G2/F"};
  EXPECT_THAT(imported(file, options).channels.at(0).values(), ElementsAre(2));
}

TEST(Tdms, TextsAreSkippedAndTold) {
  const auto record = imported(little.segment(
      {little.channel("notes", little.text_index(2, 13)), little.channel("a", little.index(2, 2))},
      little.number(2U) + little.number(5U) + "abcde" + little.numbers(Shorts{7, 8}) +
          little.number(2U) + little.number(5U) + "fghij" + little.numbers(Shorts{9, 10})));
  EXPECT_THAT(names(record), ElementsAre("a"));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(7, 8, 9, 10));
  EXPECT_EQ(record.warnings.at(0), "'notes' holds 4 texts: it is left out");
}

// Damage.

TEST(Tdms, ACutFileGivesWhatIsThere) {
  const std::string file =
      little.segment(
          {little.channel("a", little.index(2, 2)), little.channel("b", little.index(2, 2))},
          little.numbers(Shorts{1, 2, 11, 12})) +
      little.segment({}, little.numbers(Shorts{3, 4, 13, 14}), TdmsParts::bare);
  const auto cut = imported(file.substr(0, file.size() - 3));
  EXPECT_THAT(cut.channels.at(0).values(), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(cut.channels.at(1).values(), ElementsAre(11, 12));
  EXPECT_EQ(cut.warnings.at(0),
            "the file ends 3 bytes before its last segment does: what is there is read");
  const auto behind_the_head = imported(file.substr(0, file.size() - 8));
  EXPECT_THAT(behind_the_head.channels.at(0).values(), ElementsAre(1, 2));
  EXPECT_EQ(behind_the_head.warnings.at(0),
            "the file ends 8 bytes before its last segment does: what is there is read");
  const auto in_lead_in = imported(file.substr(0, file.size() - 20));
  EXPECT_THAT(in_lead_in.channels.at(0).values(), ElementsAre(1, 2));
  EXPECT_EQ(in_lead_in.warnings.at(0),
            "the file ends within a segment's lead-in: the last 16 bytes are left out");
  EXPECT_THAT(
      imported(file + "garbage, and more of it than a lead-in").warnings.at(0),
      fmt::format("at byte {} no segment begins where one was announced: the last 38 bytes are "
                  "left out",
                  file.size()));
  const std::string next = little.segment({little.channel("a", little.index(2, 2))}, "abcd");
  EXPECT_THAT(imported(file + next.substr(0, 40)).warnings.at(0),
              fmt::format("the file ends within the head of the segment at byte {}: it is left out",
                          file.size()));
  const auto open = imported(file + little.segment({}, little.numbers(Shorts{5, 6, 15}),
                                                   TdmsParts::bare, ~std::uint64_t{0}));
  EXPECT_THAT(open.channels.at(1).values(), ElementsAre(11, 12, 13, 14, 15));
  EXPECT_EQ(open.warnings.at(0),
            "the recording was not closed (aborted?): its last segment is read as far as it goes");
}

TEST(Tdms, ACutChunkOfDaqmxOrInterleavedDataEndsWithAWholeRow) {
  const std::string interleaved = little.segment(
      {little.channel("a", little.index(2, 2)), little.channel("b", little.index(2, 2))},
      little.numbers(Shorts{1, 11, 2, 12}), TdmsParts::interleaved);
  const auto rows = imported(interleaved.substr(0, interleaved.size() - 1));
  EXPECT_THAT(rows.channels.at(0).values(), ElementsAre(1));
  EXPECT_THAT(rows.channels.at(1).values(), ElementsAre(11));
  const std::string daqmx =
      little.segment({little.channel("a", little.daqmx_index(2, {{3, 0, 0, 0}}, {2, 2})),
                      little.channel("b", little.daqmx_index(2, {{3, 1, 0, 0}}, {2, 2}))},
                     little.numbers(Shorts{1, 2, 11, 12}), 0x80);
  const auto buffers = imported(daqmx.substr(0, daqmx.size() - 1));
  EXPECT_THAT(buffers.channels.at(0).values(), ElementsAre(1, 2));
  EXPECT_THAT(buffers.channels.at(1).values(), ElementsAre(11));
}

TEST(Tdms, AClosedSegmentWithAPartOfAChunkSharesItOut) {
  const auto record = imported(little.segment(
      {little.channel("a", little.index(2, 4)), little.channel("b", little.index(2, 2))},
      little.numbers(Shorts{1, 2, 11})));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(1, 2));
  EXPECT_THAT(record.channels.at(1).values(), ElementsAre(11));
  EXPECT_THAT(record.warnings.at(0),
              HasSubstr("are no whole number of chunks of 12 bytes: the last one is read in part"));
}

TEST(Tdms, DataOfNobodyAndUnknownVersionsAreTold) {
  std::string file = little.segment({}, "12345678");
  file[8] = 'x';
  const auto record = imported(file);
  EXPECT_THAT(record.warnings,
              ElementsAre("a segment is of version 4728, known are 4712 and 4713",
                          "8 bytes of raw data from byte 32 on belong to no channel",
                          "no recordings in this file: it has no channel with numbers"));
}

TEST(Tdms, ManySegmentsTakeLittleMemoryAndTime) {
  std::string file = little.segment(
      {little.channel("a", little.index(2, 1)), little.channel("b", little.index(2, 1))},
      little.numbers(Shorts{1, 2}));
  const std::string next = little.segment({}, little.numbers(Shorts{1, 2}), TdmsParts::bare);
  for (int i = 0; i < 100000; ++i) file += next;
  const auto record = imported(file);
  EXPECT_EQ(record.channels.at(1).size(), 100001U);
  EXPECT_EQ(record.channels.at(1).value(100000), 2.0);
}

}  // namespace
}  // namespace impactrig::acquisition
