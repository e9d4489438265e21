// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace impactrig::datasets {

/// A number of so many significant digits for a sentence, without an exponent from 0.0001 up to a
/// million: "1500" where {:.2g} has "1.5e+03".
std::string figures(double value, int digits);

/// A fraction with two significant digits: "100 %", "0.34 %".
std::string percent(double fraction);

}  // namespace impactrig::datasets
