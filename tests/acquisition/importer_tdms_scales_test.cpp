// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cmath>

#include "tests/acquisition/tdms_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using tests::imported;
using tests::TdmsParts;
using Shorts = std::vector<std::int16_t>;

const TdmsParts little;

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

TEST(TdmsScales, APolynomialFollowsItsDefinition) {
  const auto cubic = scale(0, "Polynomial",
                           {{"Coefficients_Size", 4},
                            {"Coefficients[0]", 1},
                            {"Coefficients[1]", -2},
                            {"Coefficients[2]", 0},
                            {"Coefficients[3]", 3}});
  EXPECT_THAT(scaled(cubic, {0, 1, -2}).channels.at(0).values(), ElementsAre(1, 2, -19));
}

std::vector<std::string> table_scale(const std::vector<double>& pre_scaled,
                                     const std::vector<double>& scaled_values) {
  std::vector<std::pair<std::string, double>> parameters = {
      {"Pre_Scaled_Values_Size", static_cast<double>(pre_scaled.size())},
      {"Scaled_Values_Size", static_cast<double>(scaled_values.size())}};
  for (std::size_t i = 0; i < pre_scaled.size(); ++i)
    parameters.emplace_back("Pre_Scaled_Values[" + std::to_string(i) + "]", pre_scaled[i]);
  for (std::size_t i = 0; i < scaled_values.size(); ++i)
    parameters.emplace_back("Scaled_Values[" + std::to_string(i) + "]", scaled_values[i]);
  return scale(0, "Table", parameters);
}

// The numbers of npTDMS's tests of it (1.11).
TEST(TdmsScales, ATableLeadsFromPreScaledToScaledValues) {
  const auto record = scaled(table_scale({1, 2, 3}, {2, 4, 8}), {0.5, 1, 1.5, 2.5, 3, 3.5});
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(2, 2, 3, 6, 8, 8));
  EXPECT_THAT(record.warnings,
              Contains("'a': its scale 0 is a table, which is read from its pre-scaled values to "
                       "its scaled ones: files of thermocouple modules have tables the other way "
                       "round"));
  // falling inputs; the outputs may go back and forth
  EXPECT_THAT(
      scaled(table_scale({4, 2, 0}, {40, 10, 20}), {-1, 0, 1, 2, 3, 4, 9}).channels.at(0).values(),
      ElementsAre(20, 20, 15, 10, 25, 40, 40));
}

TEST(TdmsScales, ATableWhoseScaledValuesAloneGoOneWayLeadsFromThem) {
  const auto record = scaled(table_scale({40, 10, 20}, {4, 2, 0}), {-1, 1, 3, 9});
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(20, 15, 25, 40));
  EXPECT_THAT(record.warnings,
              Contains(HasSubstr("from its scaled values to its pre-scaled ones")));
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

// Voltages [mV] of the tables of NIST Monograph 175 at 100 °C; the error of the approximate inverse
// is 0.06 K at most, the last digit of a table (0.5 µV) another 0.08 K of type S.
TEST(TdmsScales, AThermocoupleFollowsItsTable) {
  const std::vector<std::pair<double, double>> types = {
      {10047, 0.033}, {10055, 6.319}, {10072, 5.269}, {10073, 4.096},
      {10077, 2.774}, {10082, 0.647}, {10085, 0.646}, {10086, 4.279}};
  for (const auto& [code, millivolts] : types) {
    const auto celsius =
        scaled(scale(0, "Thermocouple", {{"Thermocouple_Type", code}}), {1e3 * millivolts});
    // type B: 0.9 µV/K
    EXPECT_NEAR(celsius.channels.at(0).value(0), 100, code == 10047 ? 0.6 : 0.14) << code;
    EXPECT_EQ(celsius.channels.at(0).attributes.at("scales"), "Thermocouple");
    const auto back = scaled(
        scale(0, "Thermocouple", {{"Thermocouple_Type", code}, {"Scaling_Direction", 1}}), {100});
    EXPECT_NEAR(back.channels.at(0).value(0), 1e3 * millivolts, 0.5) << code;
  }
}

TEST(TdmsScales, AThermocoupleOutsideOfItsRangeGivesMarkedSamples) {
  const auto record =
      scaled(scale(0, "Thermocouple", {{"Thermocouple_Type", 10073}}), {1000, 60000, -7000});
  EXPECT_THAT(record.channels.at(0).valid, ElementsAre(1, 0, 0));
}

// The chain that NI-DAQmx writes of a module with a built-in cold junction: two raw signals, the
// thermocouple's in counts of volts and the cold junction's sensor in counts of °C.
TEST(TdmsScales, OfAThermocoupleAddTheVoltageOfItsColdJunction) {
  auto chain = scale(2, "Linear", {{"Slope", 1.0}, {"Y_Intercept", 0}, {"Input_Source", 0}});
  chain =
      joined(chain, scale(3, "Linear", {{"Slope", 0.5}, {"Y_Intercept", 1}, {"Input_Source", 1}}));
  chain = joined(
      chain, scale(4, "Thermocouple",
                   {{"Thermocouple_Type", 10073}, {"Scaling_Direction", 1}, {"Input_Source", 3}}));
  chain = joined(
      chain,
      scale(5, "Add", {{"Left_Operand_Input_Source", 2}, {"Right_Operand_Input_Source", 4}}));
  chain = joined(
      chain, scale(6, "Thermocouple",
                   {{"Thermocouple_Type", 10073}, {"Scaling_Direction", 0}, {"Input_Source", 5}}));
  chain.push_back(little.property("unit_string", "Deg C"));
  chain.push_back(little.property("wf_increment", 1.0));
  // type K: 4096 µV at 100 °C, 1000 µV at 25 °C (48 counts), 798 µV at 20 °C (38 counts)
  const auto record = imported(little.segment(
      {little.channel("a", little.daqmx_index(3, {{3, 0, 0, 0}, {3, 0, 2, 1}}, {4}), chain)},
      little.numbers(Shorts{3096, 48, 3298, 38, -1000, 48}), 0x80));
  EXPECT_TRUE(record.warnings.empty()) << record.warnings.front();
  EXPECT_EQ(record.channels.at(0).unit, "Deg C");
  EXPECT_EQ(record.channels.at(0).attributes.at("scales"),
            "Linear, Linear, Thermocouple, Add, Thermocouple");
  const auto values = record.channels.at(0).values();
  EXPECT_NEAR(values[0], 100, 0.06);
  EXPECT_NEAR(values[1], 100, 0.06);
  EXPECT_NEAR(values[2], 0, 0.06);
}

// As TdmsScales.OfAThermocoupleAddTheVoltageOfItsColdJunction, without the thermocouple: exact.
TEST(TdmsScales, SumAndDifferenceJoinTwoRawSignals) {
  const auto two_signals = [](const std::string& name, std::uint32_t left, std::uint32_t right,
                              std::uint32_t second) {
    return imported(little.segment(
        {little.channel("a", little.daqmx_index(2, {{3, 0, 0, 0}, {3, 0, 2, second}}, {4}),
                        joined(scale(2, name,
                                     {{"Left_Operand_Input_Source", left},
                                      {"Right_Operand_Input_Source", right}}),
                               {little.property("wf_increment", 1.0)}))},
        little.numbers(Shorts{1, 20, 3, 40}), 0x80));
  };
  EXPECT_THAT(two_signals("Add", 0, 1, 1).channels.at(0).values(), ElementsAre(21, 43));
  EXPECT_THAT(two_signals("Subtract", 0, 1, 1).channels.at(0).values(), ElementsAre(19, 37));
  EXPECT_THAT(two_signals("Subtract", 1, 0, 1).channels.at(0).values(), ElementsAre(-19, -37));
  EXPECT_THAT(two_signals("Add", 0, 1, 5).warnings,
              Contains("'a' is read unscaled, without its unit: its scales need the raw signal 1, "
                       "which is not there"));
}

// The signals lie in buffers one behind the other: a file that is cut has less of the second.
TEST(TdmsScales, OfACutFileJoinWhatIsThereOfBothSignals) {
  const auto properties =
      joined(scale(2, "Add", {{"Left_Operand_Input_Source", 0}, {"Right_Operand_Input_Source", 1}}),
             {little.property("wf_increment", 1.0)});
  const std::string whole = little.segment(
      {little.channel("a", little.daqmx_index(3, {{3, 0, 0, 0}, {3, 1, 0, 1}}, {2, 2}),
                      properties)},
      little.numbers(Shorts{1, 2, 3, 10, 20, 30}), 0x80);
  EXPECT_THAT(imported(whole).channels.at(0).values(), ElementsAre(11, 22, 33));
  const auto cut = imported(whole.substr(0, whole.size() - 3)).channels.at(0);
  EXPECT_EQ(cut.attributes.at("scales"), "Add");
  for (std::size_t i = 0; i < cut.size(); ++i)
    EXPECT_EQ(cut.value(i), 11.0 * static_cast<double>(i + 1));
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
  EXPECT_EQ(told(scale(0, "Reciprocal", {})),
            "its scale 0 is of the type 'Reciprocal', which is not supported");
  EXPECT_EQ(told(scale(0, "Thermocouple", {})),
            "its scale 0 states no Thermocouple_Thermocouple_Type");
  EXPECT_EQ(told(scale(0, "Thermocouple", {{"Thermocouple_Type", 10048}})),
            "its scale 0 is a thermocouple of the unknown type 10048");
  EXPECT_EQ(
      told(scale(0, "Thermocouple", {{"Thermocouple_Type", 10073}, {"Scaling_Direction", 2}})),
      "its scale 0 is a thermocouple scale of the direction 2");
  EXPECT_EQ(told(scale(2, "Linear", {{"Slope", 2}})), "its scale 2 states no Linear_Y_Intercept");
  EXPECT_EQ(told(scale(0, "Linear", {{"Slope", 2}, {"Y_Intercept", 1}, {"Input_Source", 0}})),
            "its scales are chained in a circle, or too long");
  EXPECT_EQ(told(scale(0, "Linear", {{"Slope", NAN}, {"Y_Intercept", 1}})),
            "its scales are not finite");
  EXPECT_EQ(told(scale(0, "Linear", {{"Slope", 1}, {"Y_Intercept", 1}, {"Input_Source", -3}})),
            "its scale 0 states a source of -3");
  EXPECT_EQ(
      told(scale(2, "Add", {{"Left_Operand_Input_Source", 0}, {"Right_Operand_Input_Source", 1}})),
      "its scale 1 is announced and not there");
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

TEST(TdmsScales, ThatAreAnnouncedAndNotThereLeaveTheRawNumbersWithoutUnit) {
  const std::string begin = "'a' is read unscaled, without its unit 'N': ";
  const auto announced = [](std::uint32_t number, const std::vector<std::string>& there) {
    return scaled(joined({little.property("NI_Number_Of_Scales", number),
                          little.property("NI_Scaling_Status", "unscaled")},
                         there),
                  {5});
  };
  const auto line = scale(0, "Linear", {{"Slope", 2}, {"Y_Intercept", 1}});
  const auto last = announced(3, line);
  EXPECT_THAT(last.channels.at(0).values(), ElementsAre(5));
  EXPECT_EQ(last.channels[0].unit, "");
  EXPECT_THAT(last.warnings, ElementsAre(begin + "its scale 2 is announced and not there"));
  const auto between = announced(
      3, joined(line, scale(2, "Linear", {{"Slope", 2}, {"Y_Intercept", 1}, {"Input_Source", 1}})));
  EXPECT_THAT(between.channels.at(0).values(), ElementsAre(5));
  EXPECT_THAT(between.warnings, ElementsAre(begin + "its scale 1 is announced and not there"));
  EXPECT_THAT(announced(1, {}).warnings,
              ElementsAre(begin + "its scale 0 is announced and not there"));
  EXPECT_THAT(announced(0, {}).warnings, ElementsAre());
}

TEST(TdmsScales, OfDaqmxThatBeginElsewhereLeaveTheRawNumbersWithoutUnit) {
  const auto read = [](const std::vector<std::string>& properties) {
    return imported(little.segment(
        {little.channel("a", little.daqmx_index(2, {{3, 0, 0, 0}}, {2}), properties)},
        little.numbers(Shorts{1, 2}), 0x80));
  };
  const std::vector<std::string> unit = {little.property("unit_string", "N")};
  const auto record = read(
      joined(unit, scale(2, "Linear", {{"Slope", 10}, {"Y_Intercept", 0}, {"Input_Source", 1}})));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(1, 2));
  EXPECT_EQ(record.channels[0].unit, "");
  EXPECT_EQ(record.warnings.at(0),
            "'a' is read unscaled, without its unit 'N': its scales begin with the raw signal 1, "
            "which is not there");
  EXPECT_EQ(read(joined(unit, {little.property("NI_Number_Of_Scales", 1U)})).channels[0].unit, "N");
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

}  // namespace
}  // namespace impactrig::acquisition
