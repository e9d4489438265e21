// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace impactrig::acquisition {

struct Thermocouple;

/// The thermocouple of a letter-designated type, "B", "E", "J", "K", "N", "R", "S" or "T"; null for
/// any other.
const Thermocouple* thermocouple(std::string_view type);

/// The reference function E(T): voltage of a thermocouple whose cold junction is at 0 °C.
///
/// `celsius` is the temperature [°C, ITS-90], the result in mV. NaN outside of the range that the
/// reference function is stated for: 0 to 1820 °C (B), -270 to 1000 (E), -210 to 1200 (J), -270 to
/// 1372 (K), -270 to 1300 (N), -50 to 1768.1 (R, S), -270 to 400 (T).
///
/// Source: [BurnsEtAl1993], its tables in machine-readable form: NIST Standard Reference
/// Database 60 (ITS-90 Thermocouple Database).
double thermoelectric_voltage(const Thermocouple& type, double celsius);

/// The temperature [°C] at which that voltage [mV] arises.
///
/// By the source's approximate inverse functions, which differ from the inverse of E by 0.06 °C at
/// most (B below 700 °C 0.03, T 0.04, K 0.06); where it states none (below -200 °C, B below 250 °C,
/// the last digits at the upper end) E itself is inverted to rounding. NaN outside of E's range. E
/// of type B falls to -2.6 µV at 21 °C: what it rises through again is read as the warmer side.
double thermoelectric_temperature(const Thermocouple& type, double millivolts);

}  // namespace impactrig::acquisition
