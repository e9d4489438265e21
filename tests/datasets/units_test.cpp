// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/units.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <stdexcept>
#include <thread>
#include <vector>

namespace {

using namespace impactrig::datasets;

/// NaN where there is no conversion, so that a comparison fails.
double factor(std::string_view from, std::string_view to) {
  const auto result = conversion(from, to);
  return result && result->offset == 0.0 ? result->factor : std::nan("");
}

TEST(Quantity, HasANameAndAnSiUnit) {
  EXPECT_EQ(name(Quantity::force), "force");
  EXPECT_EQ(si_unit(Quantity::acceleration), "m/s^2");
  EXPECT_EQ(si_unit(Quantity::other), "");
  for (int i = 0; i <= static_cast<int>(Quantity::unknown); ++i) {
    const auto quantity = static_cast<Quantity>(i);
    EXPECT_EQ(quantity_named(name(quantity)), quantity);
  }
  EXPECT_EQ(quantity_named("torque"), std::nullopt);
}

TEST(Quantity, OfItsSiUnitIsItself) {
  for (int i = 0; i < static_cast<int>(Quantity::other); ++i) {
    const auto quantity = static_cast<Quantity>(i);
    if (quantity == Quantity::strain) continue;  // "1" may be any ratio
    EXPECT_EQ(quantity_of_unit(si_unit(quantity)), quantity) << name(quantity);
  }
}

TEST(Units, ConvertByTheirDefinition) {
  EXPECT_EQ(factor("mm/s", "m/s"), 1e-3);
  EXPECT_DOUBLE_EQ(factor("pC/N", "C/N"), 1e-12);
  EXPECT_DOUBLE_EQ(factor("m s^-2", "m/s^2"), 1.0);
  EXPECT_DOUBLE_EQ(factor("GPa", "Pa"), 1e9);
  EXPECT_DOUBLE_EQ(factor("mm/s/V", "m/(s V)"), 1e-3);
  EXPECT_DOUBLE_EQ(factor("lbf", "N"), 0.45359237 * 9.80665);
  EXPECT_DOUBLE_EQ(factor("in", "m"), 0.0254);
  EXPECT_DOUBLE_EQ(factor("%", "1"), 0.01);
  EXPECT_DOUBLE_EQ(factor("N", "kN"), 1e-3);
}

TEST(Units, AreMultipliedByTheFactorBesideThem) {
  for (const char* spelling :
       {"×1000 N", "× 10³ N", "x10^3 N", "x1000N", "X 1e3 N", "*1000 N", "N × 10³", "N x 10^3",
        "N x1000", "N * 1000", "N (x1000)", "N (×10³)", "N·10^3", "N*1000", "10³ N"})
    EXPECT_DOUBLE_EQ(factor(spelling, "N"), 1e3) << spelling;
  EXPECT_DOUBLE_EQ(factor("s x 1e-6", "s"), 1e-6);
  EXPECT_DOUBLE_EQ(factor("m/s (x 10^-3)", "m/s"), 1e-3);
  EXPECT_DOUBLE_EQ(factor("N (10 V)", "N"), 1.0);  // a range, not a factor
  for (const char* spelling : {"V (x10)", "V x 100", "N (×1)"})
    EXPECT_FALSE(conversion(spelling, "V").has_value()) << spelling;
}

TEST(Units, UnderstandLaboratorySpellings) {
  for (const char* spelling : {"Volt", "Volts", "VOLT", "V", " V ", "[V]", "[ V ]", "VDC"})
    EXPECT_EQ(factor(spelling, "V"), 1.0) << spelling;
  EXPECT_DOUBLE_EQ(factor("KN", "N"), 1e3);
  for (const char* spelling : {"MSEC", "Msec", "MSECS", "Ms", "msec"})
    EXPECT_DOUBLE_EQ(factor(spelling, "s"), 1e-3) << spelling;
  EXPECT_DOUBLE_EQ(factor("PC", "C"), 1e-12);
  EXPECT_DOUBLE_EQ(factor("MN", "N"), 1e6);
  for (const char* spelling : {"ms-1", "ms^-1", "ms\u207b\u00b9", "m s-1"})
    EXPECT_DOUBLE_EQ(factor(spelling, "m/s"), 1.0) << spelling;
  EXPECT_DOUBLE_EQ(factor("kp", "N"), 9.80665);
  EXPECT_DOUBLE_EQ(factor("tf", "N"), 9806.65);
  EXPECT_DOUBLE_EQ(factor("dyn", "N"), 1e-5);
  EXPECT_DOUBLE_EQ(factor("ips", "m/s"), 0.0254);
  EXPECT_DOUBLE_EQ(factor("g's", "m/s2"), 9.80665);
  for (const char* spelling : {"Second", "Seconds", "sec", "s"})
    EXPECT_EQ(factor(spelling, "s"), 1.0) << spelling;
  for (const char* spelling : {"Newtons", "Newton", "NEWTON"})
    EXPECT_EQ(factor(spelling, "N"), 1.0) << spelling;
  for (const char* spelling : {"m/s\u00b2", "m/s2", "m/s^2", "m/s**2", "m s\u207b\u00b2", "m/s/s",
                               "m\u00b7s\u207b\u00b2", "m.s-2", "[ m/s\u00b2 ]", "ms-2",
                               "ms\u207b\u00b2", "m\u00a0s^\u22122", "m/s^2 (peak hold)"})
    EXPECT_DOUBLE_EQ(factor(spelling, "m/s^2"), 1.0) << spelling;
  for (const char* spelling : {"\u00b5m", "\u03bcm", "um"})
    EXPECT_DOUBLE_EQ(factor(spelling, "m"), 1e-6) << spelling;
  EXPECT_DOUBLE_EQ(factor("[ m/s ]", "m/s"), 1.0);
  EXPECT_DOUBLE_EQ(factor("Nm", "J"), 1.0);
  EXPECT_DOUBLE_EQ(factor("kg\u00b7m\u00b2", "kg m^2"), 1.0);
}

// GOST 8.417-2002, tables 1, 3 and 8; GB 3100 to 3102 for the Chinese names
TEST(Units, MayBeginWithAMultiplicationSign) {
  for (const char* spelling :
       {"\u00d710^3 N", "\u00b710\u00b3 N", "\u00d7 10\u00b3 N", "N\u00d710^3"})
    EXPECT_DOUBLE_EQ(factor(spelling, "N"), 1e3) << spelling;
  EXPECT_DOUBLE_EQ(factor("\u00d710\u207b\u00b3 m/s", "m/s"), 1e-3);
}

TEST(Units, OfGForceAreThoseOfAcceleration) {
  for (const char* spelling : {"g-force", "g force", "G-Force", "g_force", "gforce", "g-forces"})
    EXPECT_DOUBLE_EQ(factor(spelling, "m/s^2"), 9.80665) << spelling;
  for (const char* spelling : {"kg-force", "kgf", "lb-force"})
    EXPECT_EQ(quantity_of_unit(spelling), Quantity::force) << spelling;
}

TEST(Units, HaveParenthesesThatPair) {
  EXPECT_DOUBLE_EQ(factor("m/(s^2)", "m/s^2"), 1.0);
  for (const char* spelling : {"s^2)", "m)", "m/(s^2", "(N", "s*s)"})
    EXPECT_EQ(quantity_of_unit(spelling), Quantity::unknown) << spelling;
}

TEST(Units, AreNotMultipliedByRemarks) {
  EXPECT_EQ(factor("N (2%)", "N"), 1.0);
  EXPECT_EQ(factor("N (100)", "N"), 1.0);
  for (const char* remark : {"N(2)", "% mV/N", "mV/N %", "10% V"})
    EXPECT_EQ(quantity_of_unit(remark), Quantity::unknown) << remark;
  EXPECT_DOUBLE_EQ(factor("%/V", "1/V"), 0.01);
  EXPECT_DOUBLE_EQ(factor("mV/(10 g)", "V/(m/s^2)"), 1e-4 / 9.80665);
}

TEST(Units, MayBeRussianOrChinese) {
  EXPECT_DOUBLE_EQ(factor("мс", "s"), 1e-3);
  EXPECT_DOUBLE_EQ(factor("мкс", "s"), 1e-6);
  EXPECT_DOUBLE_EQ(factor("mks", "s"), 1e-6);
  EXPECT_DOUBLE_EQ(factor("кН", "N"), 1e3);
  EXPECT_DOUBLE_EQ(factor("мм/с", "m/s"), 1e-3);
  EXPECT_DOUBLE_EQ(factor("м/с²", "m/s^2"), 1.0);
  EXPECT_DOUBLE_EQ(factor("м/с2", "m/s^2"), 1.0);
  EXPECT_DOUBLE_EQ(factor("Н·м", "N.m"), 1.0);
  EXPECT_DOUBLE_EQ(factor("кгс", "N"), 9.80665);
  EXPECT_DOUBLE_EQ(factor("пКл/Н", "C/N"), 1e-12);
  EXPECT_DOUBLE_EQ(factor("об/мин", "rad/s"), std::numbers::pi / 30.0);
  EXPECT_DOUBLE_EQ(factor("毫米/秒", "m/s"), 1e-3);
  EXPECT_DOUBLE_EQ(factor("千牛", "N"), 1e3);
  EXPECT_EQ(quantity_of_unit("°С"), Quantity::temperature) << "with a Cyrillic letter";
  EXPECT_EQ(quantity_of_unit("время"), Quantity::unknown);
}

TEST(Units, MayBeAsWideAsEastAsianLetters) {
  EXPECT_EQ(factor("Ｎ", "N"), 1.0);
  EXPECT_DOUBLE_EQ(factor("ｍ／ｓ²", "m/s^2"), 1.0);
  EXPECT_DOUBLE_EQ(factor("\u339c", "m"), 1e-3);
  EXPECT_DOUBLE_EQ(factor("\u33a8", "m/s^2"), 1.0);
  EXPECT_DOUBLE_EQ(factor("\u33b2", "s"), 1e-6);
  EXPECT_EQ(quantity_of_unit("\u2103"), Quantity::temperature);
  EXPECT_EQ(conversion("\uff00", "N"), std::nullopt) << "none of them";
}

TEST(Units, MayBeSpelledInCapitals) {
  EXPECT_DOUBLE_EQ(factor("LBF", "N"), 0.45359237 * 9.80665);
  EXPECT_DOUBLE_EQ(factor("IN/SEC", "m/s"), 0.0254);
  EXPECT_DOUBLE_EQ(factor("M/SEC^2", "m/s^2"), 1.0);
  EXPECT_DOUBLE_EQ(factor("MM", "m"), 1e-3);
  EXPECT_DOUBLE_EQ(factor("PSI", "Pa"), factor("psi", "Pa"));
  EXPECT_DOUBLE_EQ(factor("KHz", "Hz"), 1e3);
  for (const char* other : {"NM", "EU", "ADC", "RAW", "DB"})
    EXPECT_EQ(quantity_of_unit(other), Quantity::unknown) << other;
  EXPECT_DOUBLE_EQ(factor("MN", "N"), 1e6) << "as it stands, where that is a unit";
}

TEST(Units, MaySayHowTheyWereDetected) {
  for (const char* spelling : {"g pk", "g-pk", "g rms", "g peak", "g_rms"})
    EXPECT_DOUBLE_EQ(factor(spelling, "m/s^2"), 9.80665) << spelling;
  EXPECT_EQ(quantity_of_unit("V-rms"), Quantity::voltage);
}

TEST(Units, OfUdunitsThatLaboratoriesWriteAsNamesAreNone) {
  for (const char* name : {"force", "Force", "Force (N)", "acc", "Acc", "CH"})
    EXPECT_EQ(quantity_of_unit(name), Quantity::unknown) << name;
  EXPECT_DOUBLE_EQ(factor("Gs", "m/s^2"), 9.80665) << "no gigasecond";
  EXPECT_EQ(quantity_of_unit("Gs"), Quantity::acceleration);
}

TEST(Units, TakeGForGravityWhereTheOtherUnitIsAnAcceleration) {
  EXPECT_DOUBLE_EQ(factor("g", "m/s^2"), 9.80665);
  EXPECT_DOUBLE_EQ(factor("m/s^2", "g"), 1.0 / 9.80665);
  EXPECT_DOUBLE_EQ(factor("G", "m/s^2"), 9.80665);
  EXPECT_DOUBLE_EQ(factor("mg", "m/s^2"), 9.80665e-3);
  EXPECT_DOUBLE_EQ(factor("kg (kilo-g)", "m/s^2"), 9806.65);
  EXPECT_DOUBLE_EQ(factor("mV/g", "V/(m/s^2)"), 1e-3 / 9.80665);
  EXPECT_DOUBLE_EQ(factor("g", "kg"), 1e-3);
  EXPECT_DOUBLE_EQ(factor("g/cm^3", "kg/m^3"), 1e3);
  EXPECT_FALSE(conversion("kg", "m/s^2"));
}

TEST(Units, TakePoundsForAForceWhereTheOtherUnitIsAForce) {
  EXPECT_DOUBLE_EQ(factor("Pounds", "N"), 0.45359237 * 9.80665);
  EXPECT_DOUBLE_EQ(factor("lb", "kg"), 0.45359237);
  EXPECT_FALSE(conversion("kg", "N"));
}

TEST(Units, GiveAnglesEveryDigitOfPi) {
  EXPECT_DOUBLE_EQ(factor("deg", "rad"), std::numbers::pi / 180.0);
  EXPECT_DOUBLE_EQ(factor("\u00b0", "rad"), std::numbers::pi / 180.0);
  EXPECT_DOUBLE_EQ(factor("deg/s", "rad/s"), std::numbers::pi / 180.0);
  EXPECT_DOUBLE_EQ(factor("rpm", "rad/s"), std::numbers::pi / 30.0);
}

TEST(Units, ShiftTemperatures) {
  const auto celsius = conversion("degC", "K");
  ASSERT_TRUE(celsius);
  EXPECT_DOUBLE_EQ(celsius->factor, 1.0);
  EXPECT_DOUBLE_EQ(celsius->offset, 273.15);
  const auto fahrenheit = conversion("degF", "\u00b0C");
  ASSERT_TRUE(fahrenheit);
  EXPECT_DOUBLE_EQ(fahrenheit->factor, 5.0 / 9.0);
  EXPECT_NEAR(212.0 * fahrenheit->factor + fahrenheit->offset, 100.0, 1e-12);
}

TEST(Units, OfAnotherDimensionDoNotConvert) {
  EXPECT_FALSE(conversion("m", "s"));
  EXPECT_FALSE(conversion("V", "N"));
  EXPECT_FALSE(conversion("s", "Hz")) << "UDUNITS-2 would invert the number";
  EXPECT_FALSE(conversion("rad/s", "Hz")) << "UDUNITS-2 would drop the radian";
  EXPECT_FALSE(conversion("deg", "1"));
  EXPECT_FALSE(conversion("lg(re 1 mW)", "W")) << "a level is no factor";
}

TEST(Units, ThatAreNotUnderstoodDoNotConvert) {
  for (const char* nonsense :
       {"", " ", "EU", "n/a", "FS (full scale = 1.0)", "[]", "m^0.5", "N/m^1.11", "m1.5", "m/s 2",
        "m @ 5", "m\n", "dB", "((((", "\xff\xfe", "\u207b"}) {
    EXPECT_FALSE(conversion(nonsense, "m")) << nonsense;
    EXPECT_FALSE(conversion("m", nonsense)) << nonsense;
    EXPECT_EQ(quantity_of_unit(nonsense), Quantity::unknown) << nonsense;
  }
  EXPECT_EQ(quantity_of_unit(std::string_view("m\0s", 3)), Quantity::unknown);
  EXPECT_EQ(quantity_of_unit(std::string(100000, '(')), Quantity::unknown);
}

TEST(Units, TellTheQuantity) {
  const std::vector<std::pair<const char*, Quantity>> cases{
      {"kN", Quantity::force},
      {"Newtons", Quantity::force},
      {"Pounds", Quantity::force},
      {"mm/s", Quantity::velocity},
      {"\u00b5m", Quantity::displacement},
      {"inch", Quantity::displacement},
      {"g", Quantity::acceleration},
      {"G", Quantity::acceleration},
      {"m/s\u00b2", Quantity::acceleration},
      {"kg (kilo-g)", Quantity::acceleration},
      {"mg", Quantity::acceleration},
      {"Volts", Quantity::voltage},
      {"pC", Quantity::charge},
      {"mbar", Quantity::pressure},
      {"psi", Quantity::pressure},
      {"\u00b5m/m", Quantity::strain},
      {"\u00b5\u03b5", Quantity::strain},
      {"ustrain", Quantity::strain},
      {"deg", Quantity::angle},
      {"\u00b0", Quantity::angle},
      {"\u00b0C", Quantity::temperature},
      {"hours", Quantity::time},
      {"kHz", Quantity::frequency},
      {"1/min", Quantity::frequency},
      {"rad/s", Quantity::other},
      {"rpm", Quantity::other},
      {"kg", Quantity::other},
      {"Nm", Quantity::other},
      {"Ohm", Quantity::other},
      {"1", Quantity::other},
      {"%", Quantity::other},
      {"mV/g", Quantity::other},
  };
  for (const auto& [unit, quantity] : cases)
    EXPECT_EQ(name(quantity_of_unit(unit)), name(quantity)) << unit;
}

TEST(Units, CanBeReadByManyThreadsAtOnce) {
  std::vector<std::thread> threads;
  std::vector<int> wrong(4, 0);
  for (std::size_t t = 0; t < wrong.size(); ++t)
    threads.emplace_back([&wrong, t] {
      for (int i = 0; i < 200; ++i)
        if (factor("mm/s", "m/s") != 1e-3 || conversion("m", "nonsense")) ++wrong[t];
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(wrong, testing::Each(0));
}

TEST(UnitsDeathTest, SayWhatToDoWithoutTheirDatabase) {
  testing::GTEST_FLAG(death_test_style) = "threadsafe";  // the database is read once a process
  EXPECT_EXIT(
      {
        setenv("UDUNITS2_XML_PATH", "/absent/udunits2.xml", 1);
        try {
          (void)conversion("m", "m");
        } catch (const std::runtime_error& error) {
          const bool right = std::string(error.what()) ==
                             "UDUNITS-2 cannot read its unit database; set UDUNITS2_XML_PATH to "
                             "its udunits2.xml";
          std::_Exit(right ? 7 : 8);
        }
        std::_Exit(9);
      },
      testing::ExitedWithCode(7), "");
}

void expect_quantity(std::string_view text, std::string_view unit, double value,
                     double uncertainty = 0.0) {
  SCOPED_TRACE(std::string(text));
  const UncertainValue result = parse_quantity(text, unit);
  EXPECT_DOUBLE_EQ(result.value, value);
  EXPECT_DOUBLE_EQ(result.uncertainty, uncertainty);
}

TEST(ParseQuantity, ConvertsToTheUnitAskedFor) {
  expect_quantity("0.69 m", "m", 0.69);
  expect_quantity("  690mm ", "m", 0.69);
  expect_quantity("68.952 GPa", "Pa", 68.952e9);
  expect_quantity("12 deg", "rad", 12.0 * std::numbers::pi / 180.0);
  expect_quantity("12\u00b0", "rad", 12.0 * std::numbers::pi / 180.0);
  expect_quantity("4 pC/N", "C/N", 4e-12);
  expect_quantity("125 mm/s/V", "m/(s V)", 0.125);
  expect_quantity("100 mV/g", "V/(m/s^2)", 0.1 / 9.80665);
  expect_quantity("-1.5e-3 s", "s", -1.5e-3);
  expect_quantity("+.5 s", "s", 0.5);
  expect_quantity("5. s", "s", 5.0);
  expect_quantity("\u22125\u00a0\u00b5s", "s", -5e-6);
  expect_quantity("20 degC", "K", 293.15);
  expect_quantity("3 1/s", "Hz", 3.0);
  expect_quantity("2 g", "m/s^2", 19.6133);
  expect_quantity("0 us", "s", 0.0);
}

TEST(ParseQuantity, TakesPlainNumbersWhereTheyAreMeant) {
  expect_quantity("0.3", "1", 0.3);
  expect_quantity("30 %", "1", 0.3);
  expect_quantity("30%", "1", 0.3);
  expect_quantity("0.50(2)", "1", 0.5, 0.02);
  expect_quantity("0.3 1", "1", 0.3);
}

TEST(ParseQuantity, ReadsPowersOfTen) {
  for (const char* text : {"69\u00d710^9 Pa", "69 \u00d7 10\u2079 Pa", "69\u00b710\u2079 Pa",
                           "69*10^9 Pa", "0.69\u22c510^+11 Pa"})
    expect_quantity(text, "Pa", 69e9);
  expect_quantity("4\u00d710\u207b\u00b3 V/N", "V/N", 4e-3);
  expect_quantity("4.0(2)\u00d710^-3 V/N", "V/N", 4e-3, 0.2e-3);
}

TEST(ParseQuantity, ReadsUncertaintiesInPercent) {
  for (const char* text : {"10 \u00b1 2% mV/N", "10 \u00b1 2 % mV/N", "10 mV/N \u00b1 2 %",
                           "10 mV/N (2%)", "10 mV/N (\u00b12 %)"})
    expect_quantity(text, "V/N", 0.01, 0.0002);
  expect_quantity("-2 \u00b1 50% us", "s", -2e-6, 1e-6);
  expect_quantity("30 \u00b1 2 %", "1", 0.3, 0.02);
}

TEST(ParseQuantity, ReadsUncertainties) {
  expect_quantity("2700(20) kg/m^3", "kg/m^3", 2700.0, 20.0);
  expect_quantity("1.2345(67) V", "mV", 1234.5, 6.7);
  expect_quantity("1.23(4)e3 m", "m", 1230.0, 40.0);
  expect_quantity("2.70(0.02) g/cm^3", "kg/m^3", 2700.0, 20.0);
  expect_quantity("69.0 \u00b1 0.7 GPa", "Pa", 69e9, 0.7e9);
  expect_quantity("69.0\u00b10.7GPa", "Pa", 69e9, 0.7e9);
  expect_quantity("69.0 +- 0.7 GPa", "Pa", 69e9, 0.7e9);
  expect_quantity("69.0 +/- 0.7 GPa", "Pa", 69e9, 0.7e9);
  expect_quantity("(69.0 \u00b1 0.7) GPa", "Pa", 69e9, 0.7e9);
  expect_quantity("20.0 \u00b1 0.5 degC", "K", 293.15, 0.5);
  expect_quantity("69.0 \u00b1 0 GPa", "Pa", 69e9, 0.0);
  expect_quantity("1.6e10(2e8) N/m", "N/m", 1.6e10, 2e8);
  expect_quantity("1.6e7(0.2e6) N/mm", "N/m", 1.6e10, 2e8);
  expect_quantity("16000000000(2e8) N/m", "N/m", 1.6e10, 2e8);
}

std::string refusal(std::string_view text, std::string_view unit) {
  try {
    parse_quantity(text, unit);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ParseQuantity, ShowsACorrectExampleWhereTheUnitIsMissing) {
  EXPECT_EQ(refusal("0.69", "m"),
            "0.69 has no unit; a length is needed here, for example \"0.69 m\"");
  EXPECT_EQ(refusal("2700(20)", "kg/m^3"),
            "2700(20) has no unit; a density is needed here, for example \"2700(20) kg/m^3\"");
  EXPECT_EQ(refusal("12", "rad"),
            "12 has no unit; an angle is needed here, for example \"12 rad\"");
  EXPECT_EQ(refusal("3", "V/N"),
            "3 has no unit; a quantity in V/N is needed here, for example \"3 V/N\"");
}

TEST(ParseQuantity, SaysWhichDimensionItFound) {
  EXPECT_EQ(refusal("0.69 s", "m"),
            "\"0.69 s\" is a time; a length is needed here, for example \"0.69 m\"");
  EXPECT_EQ(refusal("0.3 m", "1"),
            "\"0.3 m\" is a length; a plain number is needed here, for example \"0.3\"");
  EXPECT_EQ(refusal("12 deg", "1"),
            "\"12 deg\" is an angle; a plain number is needed here, for example \"12\"");
  EXPECT_EQ(refusal("3 rad/s", "Hz"),
            "\"3 rad/s\" is an angular velocity; a frequency is needed here, for example \"3 Hz\"");
}

TEST(ParseQuantity, RefusesWhatIsNoQuantity) {
  const std::string tail = "; a length is needed here, for example ";
  EXPECT_EQ(refusal("", "m"), "nothing is given" + tail + "\"1 m\"");
  EXPECT_EQ(refusal("m", "m"), "\"m\" does not begin with a number" + tail + "\"1 m\"");
  EXPECT_EQ(refusal(".", "m"), "\".\" does not begin with a number" + tail + "\"1 m\"");
  EXPECT_EQ(refusal("nan m", "m"), "\"nan m\" does not begin with a number" + tail + "\"1 m\"");
  EXPECT_EQ(refusal("0,69 m", "m"), "\"0,69 m\" has a comma in its number" + tail + "\"1.5 m\"");
  EXPECT_EQ(refusal("1e999 m", "m"),
            "\"1e999 m\" holds a number that does not fit a double" + tail + "\"1 m\"");
  EXPECT_EQ(refusal("1e99999999999 m", "m"),
            "\"1e99999999999 m\" holds a number that does not fit a double" + tail + "\"1 m\"");
  EXPECT_EQ(refusal("1e308 km", "m"), "\"1e308 km\" does not fit a double in m" + tail + "\"1 m\"");
  EXPECT_EQ(refusal("4 m (5)", "m"), "\"m (5)\" is not a unit" + tail + "\"4 m\"");
  EXPECT_EQ(refusal("4(2)% m", "m"), "\"% m\" is not a unit" + tail + "\"4(2) m\"");
  EXPECT_EQ(refusal("4(2) m (3%)", "m"),
            "\"4(2) m (3%)\" has two uncertainties" + tail + "\"1(1) m\"");
  EXPECT_EQ(refusal("0.69 smoot", "m"), "\"smoot\" is not a unit" + tail + "\"0.69 m\"");
  EXPECT_EQ(refusal("0.69 0.7 m", "m"), "\"0.7 m\" is not a unit" + tail + "\"0.69 m\"");
  EXPECT_EQ(refusal("0.69 m 2", "m"), "\"m 2\" is not a unit" + tail + "\"0.69 m\"");
  EXPECT_EQ(refusal("0.69 (20) m", "m"), "\"(20) m\" is not a unit" + tail + "\"0.69 m\"");
  EXPECT_EQ(refusal("0.69(2 m", "m"),
            "\"0.69(2 m\" has no closing parenthesis" + tail + "\"1.00(1) m\"");
  EXPECT_EQ(refusal("(0.69 \u00b1 0.1 m", "m"),
            "\"(0.69 +- 0.1 m\" has no closing parenthesis" + tail + "\"(1 \u00b1 0.1) m\"");
  EXPECT_EQ(refusal("0.69 \u00b1 m", "m"),
            "\"0.69 +- m\" has no number after the \u00b1" + tail + "\"1 \u00b1 0.1 m\"");
  EXPECT_EQ(refusal("0.69 \u00b1 -0.1 m", "m"),
            "\"0.69 +- -0.1 m\" has no number after the \u00b1" + tail + "\"1 \u00b1 0.1 m\"");
  EXPECT_EQ(refusal("0.69(1) \u00b1 0.1 m", "m"),
            "\"0.69(1) +- 0.1 m\" has two uncertainties" + tail + "\"1(1) m\"");
  for (const std::string open : {"1.6e3(2) m", "1.6(2e2)e3 m", "1.6(2)e3(2e2) m"})
    EXPECT_EQ(refusal(open, "m"), "\"" + open + "\" leaves open how large its uncertainty is" +
                                      tail + "\"1.6(2)e3 m\"");
  EXPECT_EQ(
      refusal("0.69 m \u00b1 0.01 m", "m"),
      "\"0.69 m +- 0.01 m\" has its uncertainty behind the unit" + tail + "\"0.69 \u00b1 0.1 m\"");
}

TEST(ParseQuantity, RefusesATargetThatIsNoUnit) {
  EXPECT_EQ(refusal("1 m", "smoot"), "\"smoot\" is not a unit to convert to");
}

}  // namespace
