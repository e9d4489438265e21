// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/thermocouples.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace impactrig::acquisition {
namespace {

struct Table {
  const char* type;
  double inverse_from;   ///< [°C] from here on the source states an inverse
  double inverse_error;  ///< [°C] its greatest error, as the source states it
  std::vector<std::pair<double, double>> rows;  ///< °C, mV
};

// Rows of the tables of NIST Monograph 175, of which the first and the last are the ends.
const std::vector<Table> tables = {
    {"B",
     250,
     0.03,
     {{0, 0.000},
      {200, 0.178},
      {400, 0.787},
      {600, 1.792},
      {800, 3.154},
      {1000, 4.834},
      {1200, 6.786},
      {1400, 8.956},
      {1600, 11.263},
      {1800, 13.591},
      {1820, 13.820}}},
    {"E",
     -200,
     0.03,
     {{-270, -9.835},
      {-200, -8.825},
      {0, 0.000},
      {200, 13.421},
      {400, 28.946},
      {600, 45.093},
      {800, 61.017},
      {1000, 76.373}}},
    {"J",
     -210,
     0.05,
     {{-210, -8.095},
      {-200, -7.890},
      {0, 0.000},
      {200, 10.779},
      {400, 21.848},
      {600, 33.102},
      {800, 45.494},
      {1000, 57.953},
      {1200, 69.553}}},
    {"K",
     -200,
     0.06,
     {{-270, -6.458},
      {-200, -5.891},
      {0, 0.000},
      {200, 8.138},
      {400, 16.397},
      {600, 24.905},
      {800, 33.275},
      {1000, 41.276},
      {1200, 48.838},
      {1372, 54.886}}},
    {"N",
     -200,
     0.04,
     {{-270, -4.345},
      {-200, -3.990},
      {0, 0.000},
      {200, 5.913},
      {400, 12.974},
      {600, 20.613},
      {800, 28.455},
      {1000, 36.256},
      {1200, 43.846},
      {1300, 47.513}}},
    {"R",
     -50,
     0.02,
     {{-50, -0.226},
      {0, 0.000},
      {200, 1.469},
      {400, 3.408},
      {600, 5.583},
      {800, 7.950},
      {1000, 10.506},
      {1200, 13.228},
      {1400, 16.040},
      {1600, 18.849},
      {1768, 21.101}}},
    {"S",
     -50,
     0.02,
     {{-50, -0.236},
      {0, 0.000},
      {200, 1.441},
      {400, 3.259},
      {600, 5.239},
      {800, 7.345},
      {1000, 9.587},
      {1200, 11.951},
      {1400, 14.373},
      {1600, 16.777},
      {1768, 18.693}}},
    {"T", -200, 0.04, {{-270, -6.258}, {-200, -5.603}, {0, 0.000}, {200, 9.288}, {400, 20.872}}},
};

const Thermocouple& of(const char* type) {
  return *thermocouple(type);
}

TEST(Thermocouples, HaveTheVoltagesOfThePublishedTables) {
  for (const Table& table : tables)
    for (const auto& [celsius, millivolts] : table.rows)
      // half of the last printed digit, and rounding's share where the digits end in 5
      EXPECT_NEAR(thermoelectric_voltage(of(table.type), celsius), millivolts, 0.5e-3 + 1e-9)
          << table.type << " at " << celsius;
}

TEST(Thermocouples, ReadTheirOwnVoltagesWithinTheErrorThatTheSourceStates) {
  for (const Table& table : tables) {
    const double top = table.rows.back().first;
    for (double t = table.inverse_from; t <= top; t += 0.37) {
      const double back =
          thermoelectric_temperature(of(table.type), thermoelectric_voltage(of(table.type), t));
      ASSERT_NEAR(back, t, table.inverse_error) << table.type;
    }
  }
}

// Where the source states no inverse, E itself is inverted. The terms of E reach 300 V (type T at
// -270 °C): their rounding leaves 2e-11 mV, seen through a slope of 1e-3 mV/K.
TEST(Thermocouples, BelowTheStatedInverseInvertTheReferenceFunction) {
  for (const Table& table : tables) {
    const double bottom = std::max(table.rows.front().first, *table.type == 'B' ? 30.0 : -270.0);
    for (double t = bottom; t < table.inverse_from - 0.1; t += 0.37) {
      const double voltage = thermoelectric_voltage(of(table.type), t);
      ASSERT_NEAR(thermoelectric_temperature(of(table.type), voltage), t, 1e-7) << table.type;
    }
  }
}

TEST(Thermocouples, SayNothingOutsideOfTheirRange) {
  for (const Table& table : tables) {
    const Thermocouple& type = of(table.type);
    EXPECT_TRUE(std::isnan(thermoelectric_voltage(type, table.rows.front().first - 0.001)));
    EXPECT_TRUE(std::isnan(thermoelectric_voltage(type, table.rows.back().first + 1.0)));
    EXPECT_TRUE(std::isnan(thermoelectric_temperature(type, table.rows.front().second - 0.01)));
    EXPECT_TRUE(std::isnan(thermoelectric_temperature(type, table.rows.back().second + 0.01)));
    EXPECT_TRUE(std::isnan(thermoelectric_temperature(type, NAN)));
    EXPECT_TRUE(std::isnan(thermoelectric_voltage(type, INFINITY)));
  }
  // type B falls to -2.585 µV before it rises
  EXPECT_NEAR(thermoelectric_temperature(of("B"), -2.58e-3), 21.0, 2.0);
  EXPECT_TRUE(std::isnan(thermoelectric_temperature(of("B"), -2.59e-3)));
  EXPECT_NEAR(thermoelectric_temperature(of("B"), 0.0), 42.0, 0.5);
}

TEST(Thermocouples, OfOtherLettersAreNone) {
  EXPECT_EQ(thermocouple("C"), nullptr);
  EXPECT_EQ(thermocouple(""), nullptr);
}

}  // namespace
}  // namespace impactrig::acquisition
