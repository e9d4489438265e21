// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "datasets/input_error.hpp"
#include "tests/acquisition/tdms_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using testing::ElementsAre;
using testing::ElementsAreArray;
using testing::HasSubstr;
using tests::import_error;
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
      {little.channel("t", little.index(10, 4), {little.property("unit_string", "ms")}),
       little.channel("F", little.index(2, 4))},
      little.numbers(std::vector<double>{0, 1, 5, 6}) + little.numbers(Shorts{1, 2, 3, 4}));
  ImportOptions options;
  options.time_column = "t";
  options.from = 0.001;
  options.to = 0.005;
  options.channels = {"F"};
  const auto record = imported(file, options);
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(2, 3));
  EXPECT_THAT(record.channels.at(0).clock.times, ElementsAre(0.001, 0.005));
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

// Scales.

datasets::Record scaled(const std::vector<std::string>& properties,
                        const std::vector<double>& raw) {
  auto all = properties;
  all.push_back(little.property("unit_string", "N"));
  all.push_back(little.property("wf_increment", 1.0));
  return imported(little.segment({little.channel("a", little.index(10, raw.size()), all)},
                                 little.numbers(raw)));
}

std::vector<std::string> scale(std::uint32_t index, const std::string& type,
                               const std::vector<std::pair<std::string, double>>& parameters) {
  const std::string prefix = "NI_Scale[" + std::to_string(index) + "]_";
  std::vector<std::string> list = {little.property(prefix + "Scale_Type", type)};
  for (const auto& [name, value] : parameters)
    list.push_back(little.property(prefix + type + "_" + name, value));
  return list;
}

std::vector<std::string> joined(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(TdmsScales, AChainOfStraightLinesLeavesTheNumbersAsTheyAre) {
  const auto properties =
      joined(joined({little.property("NI_Number_Of_Scales", 3U)},
                    scale(1, "Linear", {{"Slope", 2}, {"Y_Intercept", 1}, {"Input_Source", 0}})),
             scale(2, "Linear", {{"Slope", 10}, {"Y_Intercept", -3}, {"Input_Source", 1}}));
  const auto record = scaled(properties, {0, 1, 2});
  EXPECT_EQ(record.channels.at(0).scale, 20.0);
  EXPECT_EQ(record.channels.at(0).offset, 7.0);
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(7, 27, 47));
  EXPECT_EQ(record.channels.at(0).attributes.at("scales"), "Linear, Linear");
  EXPECT_TRUE(record.warnings.empty());
}

TEST(TdmsScales, AreNotAppliedToScaledData) {
  auto properties = scale(0, "Linear", {{"Slope", 2}, {"Y_Intercept", 1}});
  EXPECT_THAT(scaled(properties, {1}).channels.at(0).values(), ElementsAre(3));
  properties.push_back(little.property("NI_Scaling_Status", "unscaled"));
  EXPECT_THAT(scaled(properties, {1}).channels.at(0).values(), ElementsAre(3));
  properties.back() = little.property("NI_Scaling_Status", "scaled");
  EXPECT_THAT(scaled(properties, {1}).channels.at(0).values(), ElementsAre(1));
}

TEST(TdmsScales, OfTheGroupOrTheFileHoldForAChannelWithout) {
  const auto line = scale(0, "Linear", {{"Slope", 2}, {"Y_Intercept", 1}});
  for (const char* const path : {"/", "/'G'"})
    EXPECT_THAT(imported(little.segment({little.object(path, little.none(), line),
                                         little.channel("a", little.index(2, 1))},
                                        little.numbers(Shorts{4})))
                    .channels.at(0)
                    .values(),
                ElementsAre(9))
        << path;
}

TEST(TdmsScales, PolynomialAndTableFollowTheirDefinition) {
  const auto cubic = scale(0, "Polynomial",
                           {{"Coefficients_Size", 4},
                            {"Coefficients[0]", 1},
                            {"Coefficients[1]", -2},
                            {"Coefficients[2]", 0},
                            {"Coefficients[3]", 3}});
  EXPECT_THAT(scaled(cubic, {0, 1, -2}).channels.at(0).values(), ElementsAre(1, 2, -19));
  const auto falling = scale(0, "Table",
                             {{"Pre_Scaled_Values_Size", 3},
                              {"Scaled_Values_Size", 3},
                              {"Pre_Scaled_Values[0]", 4},
                              {"Pre_Scaled_Values[1]", 2},
                              {"Pre_Scaled_Values[2]", 0},
                              {"Scaled_Values[0]", 40},
                              {"Scaled_Values[1]", 10},
                              {"Scaled_Values[2]", 0}});
  EXPECT_THAT(scaled(falling, {-1, 0, 1, 2, 3, 4, 9}).channels.at(0).values(),
              ElementsAre(0, 0, 5, 10, 25, 40, 40));
}

TEST(TdmsScales, SumAndDifferenceJoinScalesOfOneSignal) {
  const auto lines =
      joined(scale(1, "Linear", {{"Slope", 2}, {"Y_Intercept", 0}, {"Input_Source", 0}}),
             scale(2, "Polynomial",
                   {{"Coefficients_Size", 3},
                    {"Coefficients[0]", 0},
                    {"Coefficients[1]", 0},
                    {"Coefficients[2]", 1},
                    {"Input_Source", 0}}));
  const auto add =
      scale(3, "Add", {{"Left_Operand_Input_Source", 1}, {"Right_Operand_Input_Source", 2}});
  const auto subtract =
      scale(3, "Subtract", {{"Left_Operand_Input_Source", 1}, {"Right_Operand_Input_Source", 2}});
  EXPECT_THAT(scaled(joined(lines, add), {3, 5}).channels.at(0).values(), ElementsAre(15, 35));
  EXPECT_THAT(scaled(joined(lines, subtract), {3, 5}).channels.at(0).values(), ElementsAre(3, 15));
}

// The bridge itself, from its four resistors, gives the volts; the scale must find the strain.
TEST(TdmsScales, StrainIsWhatUnbalancesTheBridge) {
  const double G = 2.1;
  const double nu = 0.3;
  const double excitation = 5.0;
  const double initial = 0.001;
  const auto volts = [&](double r1, double r2, double r3, double r4) {
    return (r3 / (r3 + r4) - r2 / (r1 + r2)) * excitation + initial;
  };
  for (const double e : {-3e-3, -1e-6, 0.0, 2e-3}) {
    const double g = e * G;
    const std::vector<std::pair<double, double>> bridges = {
        {10183, volts(1 - g, 1 + g, 1 - g, 1 + g)},
        {10184, volts(1 - nu * g, 1 + nu * g, 1 - g, 1 + g)},
        {10185, volts(1 - nu * g, 1 + g, 1 - nu * g, 1 + g)},
        {10188, volts(1, 1, 1 - nu * g, 1 + g)},
        {10189, volts(1, 1, 1 - g, 1 + g)},
        {10271, volts(1, 1, 1, 1 + g)},
        {10272, volts(1, 1, 1, 1 + g)}};
    for (const auto& [bridge, output] : bridges) {
      const auto record = scaled(scale(0, "Strain",
                                       {{"Configuration", bridge},
                                        {"Poisson_Ratio", nu},
                                        {"Gage_Resistance", 350},
                                        {"Initial_Bridge_Voltage", initial},
                                        {"Gage_Factor", G},
                                        {"Voltage_Excitation", excitation}}),
                                 {output});
      // rounding of volts near 1 mV, seen through 1/(G · 5 V)
      EXPECT_NEAR(record.channels.at(0).value(0), e, 1e-15) << bridge;
    }
  }
}

// Pt100 of IEC 60751: its table has 18.52 Ω at -200 °C, 60.26 at -100, 100 at 0, 138.51 at 100.
TEST(TdmsScales, AResistanceThermometerFollowsItsTable) {
  const auto properties = scale(0, "RTD",
                                {{"Current_Excitation", 1e-3},
                                 {"R0_Nominal_Resistance", 100},
                                 {"A", 3.9083e-3},
                                 {"B", -5.775e-7},
                                 {"C", -4.183e-12},
                                 {"Lead_Wire_Resistance", 0.5},
                                 {"Resistance_Configuration", 2}});
  const auto record = scaled(properties, {0.01952, 0.06126, 0.101, 0.13951});  // 2 wires of 0.5 Ω
  // the table's last digit, 5 mΩ, is 13 mK
  EXPECT_NEAR(record.channels.at(0).value(0), -200, 0.013);
  EXPECT_NEAR(record.channels.at(0).value(1), -100, 0.013);
  EXPECT_NEAR(record.channels.at(0).value(2), 0, 1e-9);
  EXPECT_NEAR(record.channels.at(0).value(3), 100, 0.013);
}

TEST(TdmsScales, AThermistorFollowsSteinhartAndHart) {
  const double a = 1.129e-3;
  const double b = 2.341e-4;
  const double c = 8.767e-8;
  const double log_r = std::log(10000.0);
  const double celsius = 1.0 / (a + b * log_r + c * log_r * log_r * log_r) - 273.15;
  const std::vector<std::pair<std::string, double>> sensor = {
      {"A", a}, {"B", b}, {"C", c}, {"Temperature_Offset", 273.15}};
  auto by_current = sensor;
  by_current.insert(by_current.end(), {{"Excitation_Type", 10134}, {"Excitation_Value", 1e-4}});
  EXPECT_NEAR(scaled(scale(0, "Thermistor", by_current), {1.0}).channels.at(0).value(0), celsius,
              1e-9);
  auto by_voltage = sensor;
  by_voltage.insert(
      by_voltage.end(),
      {{"Excitation_Type", 10322}, {"Excitation_Value", 2.5}, {"R1_Reference_Resistance", 5000}});
  EXPECT_NEAR(
      scaled(scale(0, "Thermistor", by_voltage), {2.5 * 10000 / 15000}).channels.at(0).value(0),
      celsius, 1e-9);
}

TEST(TdmsScales, ThatCannotBeAppliedLeaveTheRawNumbersWithoutUnit) {
  const auto told = [](const std::vector<std::string>& properties) {
    const auto record = scaled(properties, {5});
    EXPECT_THAT(record.channels.at(0).values(), ElementsAre(5));
    EXPECT_EQ(record.channels.at(0).unit, "");
    const std::string begin = "'a' is read unscaled, without its unit 'N': ";
    EXPECT_TRUE(record.warnings.at(0).starts_with(begin)) << record.warnings.at(0);
    return record.warnings.at(0).substr(begin.size());
  };
  EXPECT_EQ(told(scale(0, "Thermocouple", {})),
            "its scale 0 is of the type 'Thermocouple', which is not supported");
  EXPECT_EQ(told(scale(2, "Linear", {{"Slope", 2}})), "its scale 2 states no Linear_Y_Intercept");
  EXPECT_EQ(told(scale(0, "Linear", {{"Slope", 2}, {"Y_Intercept", 1}, {"Input_Source", 0}})),
            "its scales are chained in a circle, or too long");
  EXPECT_EQ(told(scale(0, "Linear", {{"Slope", NAN}, {"Y_Intercept", 1}})),
            "its scales are not finite");
  EXPECT_EQ(told(scale(0, "Linear", {{"Slope", 1}, {"Y_Intercept", 1}, {"Input_Source", -3}})),
            "its scale 0 states a source of -3");
  EXPECT_EQ(
      told(scale(2, "Add", {{"Left_Operand_Input_Source", 0}, {"Right_Operand_Input_Source", 1}})),
      "its scales need more than one raw signal");
  EXPECT_EQ(told(scale(0, "Table", {{"Pre_Scaled_Values_Size", 1}, {"Pre_Scaled_Values[0]", 1}})),
            "its scale 0 is a table of 1 to 0 values");
  EXPECT_EQ(told(scale(0, "Table",
                       {{"Pre_Scaled_Values_Size", 2},
                        {"Scaled_Values_Size", 2},
                        {"Pre_Scaled_Values[0]", 1},
                        {"Pre_Scaled_Values[1]", 1},
                        {"Scaled_Values[0]", 1},
                        {"Scaled_Values[1]", 1}})),
            "its scale 0 is a table that goes back and forth");
  EXPECT_EQ(told(scale(0, "Strain",
                       {{"Configuration", 7}, {"Gage_Factor", 2}, {"Voltage_Excitation", 1}})),
            "its scale 0 is a strain bridge of the unknown type 7");
  EXPECT_EQ(
      told(scale(0, "Thermistor",
                 {{"A", 1}, {"B", 1}, {"C", 1}, {"Excitation_Type", 3}, {"Excitation_Value", 1}})),
      "its scale 0 states an excitation of type 3");
}

TEST(TdmsScales, OfDaqmxChooseTheRawSignalTheyBeginWith) {
  const std::vector<std::string> chain =
      scale(2, "Linear", {{"Slope", 10}, {"Y_Intercept", 0}, {"Input_Source", 1}});
  const std::string index = little.daqmx_index(2, {{3, 0, 0, 0}, {3, 0, 2, 1}}, {4});
  const std::string data = little.numbers(Shorts{1, 2, 3, 4});
  EXPECT_THAT(imported(little.segment({little.channel("a", index, chain)}, data, 0x80))
                  .channels.at(0)
                  .values(),
              ElementsAre(20, 40));
  const auto plain = imported(little.segment({little.channel("a", index)}, data, 0x80));
  EXPECT_THAT(plain.channels.at(0).values(), ElementsAre(1, 3));
  EXPECT_EQ(plain.warnings.at(0),
            "'a' has 2 raw signals and no scale that joins them: the first is read");
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

std::string error_of(const std::vector<std::string>& objects, const std::string& data,
                     std::uint32_t flags = 0) {
  const std::string error = import_error(little.segment(objects, data, flags));
  const std::size_t colon = error.find("): ");
  return colon == std::string::npos ? error : error.substr(colon + 3);
}

TEST(TdmsErrors, NameThePlaceAndWhatWasFound) {
  ImportOptions tdms;
  tdms.format = "tdms";
  EXPECT_EQ(
      import_error("TDSm\x0E"),
      "FILE (byte 5): the file ends within the lead-in of the first segment, after 5 of 28 bytes");
  EXPECT_EQ(import_error(std::string(40, 'x'), tdms),
            "FILE (byte 0): expected a segment, which begins with 'TDSm', found 'xxxx'");
  EXPECT_EQ(import_error(little.segment({}, "1234567", 0, 10, 20)),
            "FILE (byte 28): the raw data of a segment are announced 20 bytes behind its head, the "
            "segment "
            "has 10");
  EXPECT_EQ(import_error(little.segment({}, "", 0, 100, 90)),
            "FILE (byte 32): the file ends within the head of the first segment");
  const std::string channel = little.channel("a", little.index(2, 1));
  EXPECT_EQ(import_error(little.segment({channel}, "ab", 0, {}, 6)),
            "FILE (byte 34): the head of the segment at byte 0 is 34 bytes longer than announced");
  EXPECT_EQ(import_error("TDSh\x0E and so on, an index"),
            "FILE: this is the index of an NI TDMS file (.tdms_index), which is not read: state "
            "the .tdms "
            "file beside it, which holds the samples");
}

TEST(TdmsErrors, OfObjectsNameThem) {
  EXPECT_EQ(error_of({little.object("G", little.none())}, ""),
            "expected the path of a group or channel, found 'G'");
  EXPECT_EQ(error_of({little.object("/'a'/'b'/'c'", little.none())}, ""),
            "expected the path of a group or channel, found '/'a'/'b'/'c''");
  EXPECT_EQ(error_of({little.channel("a", little.same())}, ""),
            "/'G'/'a' refers to an earlier raw data index and there is none");
  EXPECT_EQ(error_of({little.channel("a", little.index(0x77, 1))}, ""),
            "/'G'/'a' has data of the unknown type 0x77");
  EXPECT_EQ(error_of({little.channel("a", little.index(2, 1, 2))}, ""),
            "/'G'/'a' has data of 2 dimensions, 1 is expected");
  EXPECT_EQ(
      error_of({little.channel("a", little.index(0x0B, 1))}, ""),
      "/'G'/'a' has numbers of extended precision, whose width in a file is not published: convert "
      "the channel to double precision with the program that wrote it");
  for (const std::uint64_t count : {std::uint64_t{1} << 63, ~std::uint64_t{0}})
    EXPECT_EQ(error_of({little.channel("a", little.index(2, count))}, "ab"),
              fmt::format("/'G'/'a' announces {} values of 2 bytes in a chunk", count));
  EXPECT_EQ(error_of({little.channel("a", little.text_index(1, std::uint64_t{1} << 50))}, "ab"),
            "/'G'/'a' announces 1125899906842624 bytes of text in a chunk");
  EXPECT_EQ(
      error_of({little.channel("a", little.none(), {little.raw_property("p", 0x4F, "")})}, ""),
      "the property 'p' of /'G'/'a' is of the type 0x4F, which is not read");
}

TEST(TdmsErrors, OfRawDataNameTheChannel) {
  EXPECT_EQ(
      error_of({little.channel("a", little.index(2, 1)), little.channel("b", little.index(2, 2))},
               "abcdef", TdmsParts::interleaved),
      "/'G'/'b' has 2 values in a chunk of interleaved data, the channels before it 1");
  EXPECT_EQ(
      error_of({little.channel("a", little.text_index(1, 6))}, "abcdef", TdmsParts::interleaved),
      "/'G'/'a' has texts among interleaved data");
  const std::string one = little.segment({little.channel("a", little.index(2, 1))}, "ab");
  EXPECT_THAT(
      import_error(one + little.segment({little.channel("a", little.index(3, 1))}, "abcd")),
      HasSubstr("the type of /'G'/'a' changes within the file, from 16-bit integer to 32-bit "
                "integer"));
  EXPECT_THAT(import_error(one + little.segment(
                                     {little.channel("a", little.daqmx_index(1, {{2, 0, 0}}, {2}))},
                                     "ab", 0x80)),
              HasSubstr("the type of /'G'/'a' changes within the file"));
  const TdmsParts big(true);
  EXPECT_THAT(
      import_error(little.segment({little.channel("t", little.index(0x44, 1))}, little.time(1)) +
                   big.segment({}, big.time(2), TdmsParts::bare)),
      HasSubstr("the byte order of the time stamps /'G'/'t' changes within the file"));
}

TEST(TdmsErrors, OfDaqmxDataNameTheChannel) {
  const auto daqmx = [](const std::vector<tests::TdmsScaler>& scalers,
                        const std::vector<std::uint32_t>& widths, std::uint64_t count = 1) {
    return little.daqmx_index(count, scalers, widths);
  };
  const std::string a = little.channel("a", daqmx({{3, 0, 0, 0}}, {4}));
  EXPECT_EQ(error_of({little.channel("a", daqmx({{12, 0, 0, 0}}, {2}))}, "ab", 0x80),
            "/'G'/'a' has a DAQmx scaler of the unknown type 12");
  EXPECT_EQ(error_of({little.channel("a", daqmx({{3, 1, 0, 0}}, {2}))}, "ab", 0x80),
            "/'G'/'a' is in the raw buffer 1 of 1");
  EXPECT_EQ(error_of({little.channel("a", daqmx({{3, 0, 1, 0}}, {2}))}, "ab", 0x80),
            "/'G'/'a' lies in bytes 1 to 2 of the rows of a raw buffer, which have 2");
  EXPECT_EQ(error_of({little.channel("a", daqmx({{3, 0, 0, 0}}, {2}, std::uint64_t{1} << 62))},
                     "ab", 0x80),
            "/'G'/'a' announces 4611686018427387904 values of 2 bytes in a chunk");
  EXPECT_EQ(error_of({a, little.channel("b", daqmx({{3, 0, 0, 0}}, {2}))}, "abcd", 0x80),
            "/'G'/'b' states rows of 2 bytes in the DAQmx raw data, the channels before it 4");
  EXPECT_EQ(error_of({a, little.channel("b", daqmx({{3, 0, 2, 0}}, {4}, 2))}, "abcd", 0x80),
            "/'G'/'b' states 2 rows in a DAQmx raw buffer, the channels before it 1");
  EXPECT_EQ(error_of({a, little.channel("b", little.index(2, 1))}, "abcdef", 0x80),
            "a segment mixes DAQmx raw data with other data");
  std::vector<tests::TdmsScaler> many;
  for (std::uint32_t i = 0; i < 65; ++i) many.push_back({3, 0, 0, i});
  EXPECT_EQ(error_of({little.channel("a", daqmx(many, {2}))}, "ab", 0x80),
            "/'G'/'a' has more than 64 DAQmx scalers");
}

TEST(TdmsErrors, TellOfATimeColumnThatIsNotThere) {
  ImportOptions options;
  options.time_column = "clock";
  EXPECT_EQ(import_error(little.segment({little.channel("a", little.index(2, 1))}, "ab"), options),
            "FILE (byte 0): there is no channel 'clock' to take times from");
}

}  // namespace
}  // namespace impactrig::acquisition
