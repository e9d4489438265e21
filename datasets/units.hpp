// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace impactrig::datasets {

/// What a channel measures. `other` has a unit that is none of these; `unknown` has no unit we
/// could read.
enum class Quantity {
  force,
  velocity,
  displacement,
  acceleration,
  voltage,
  charge,
  pressure,
  strain,
  angle,
  temperature,
  time,
  frequency,
  other,
  unknown
};

std::string_view name(Quantity quantity);     ///< "force"
std::string_view si_unit(Quantity quantity);  ///< "N"; "" for other and unknown
std::optional<Quantity> quantity_named(std::string_view name);

/// An affine conversion: si = factor * value + offset.
struct UnitConversion {
  double factor = 1.0;
  double offset = 0.0;
};

/// The conversion from one unit to another, or none when a unit is not understood or the dimensions
/// differ. Units are UDUNITS-2's ("mm/s", "pC/N", "m s^-2"), and besides laboratory spellings
/// ("Volt", "Newtons", "m/s²", "ms-2", "kg (kilo-g)", "[ m/s ]", "Nm"). "g" and "G" are standard
/// gravity where the other unit makes it so (UDUNITS-2: gram), alone, as "mg" or within "mV/g";
/// likewise "lb" and "Pounds" are a force. Refused although UDUNITS-2 takes them: s to Hz (it
/// inverts), rad/s to Hz and rad to 1 (it drops the radian), levels, fractional exponents ("m^0.5"
/// is 5 to it).
std::optional<UnitConversion> conversion(std::string_view from, std::string_view to);

/// The quantity a unit belongs to. "g" is taken for standard gravity and "lb" for a force, since no
/// recording is of mass. A unit that is understood but is none of ours, a plain "1" or "%" among
/// them, gives `other`; one that is not understood, or empty, `unknown`.
Quantity quantity_of_unit(std::string_view unit);

/// A number with its standard uncertainty (0: none stated).
struct UncertainValue {
  double value = 0.0;
  double uncertainty = 0.0;
};

/// Reads "0.69 m", "68.952 GPa", "2700(20) kg/m^3" (uncertainty in the last digits), "1.6e10(2e8)
/// N/m", "69.0 ± 0.7 GPa", "69.0 +- 0.7 GPa", "0.3" or "30 %" (where `unit` is "1") and converts to
/// `unit`. A bare number where a unit is meant is refused. Throws std::invalid_argument with a
/// sentence that shows a correct example: 0.69 has no unit; a length is needed here, for example
/// "0.69 m".
UncertainValue parse_quantity(std::string_view text, std::string_view unit);

}  // namespace impactrig::datasets
