// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/units.hpp"

#include <fmt/format.h>
#include <udunits2.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "datasets/unit_spelling.hpp"

namespace impactrig::datasets {

namespace {

struct QuantityText {
  Quantity quantity;
  std::string_view name;
  std::string_view si_unit;
};

constexpr std::array<QuantityText, 14> quantity_texts{{
    {Quantity::force, "force", "N"},                    //
    {Quantity::velocity, "velocity", "m/s"},            //
    {Quantity::displacement, "displacement", "m"},      //
    {Quantity::acceleration, "acceleration", "m/s^2"},  //
    {Quantity::voltage, "voltage", "V"},                //
    {Quantity::charge, "charge", "C"},                  //
    {Quantity::pressure, "pressure", "Pa"},             //
    {Quantity::strain, "strain", "1"},                  //
    {Quantity::angle, "angle", "rad"},                  //
    {Quantity::temperature, "temperature", "K"},        //
    {Quantity::time, "time", "s"},                      //
    {Quantity::frequency, "frequency", "Hz"},           //
    {Quantity::other, "other", ""},                     //
    {Quantity::unknown, "unknown", ""},                 //
}};

const QuantityText& text_of(Quantity quantity) {
  return *std::ranges::find(quantity_texts, quantity, &QuantityText::quantity);
}

// --- UDUNITS-2 -----------------------------------------------------------------------------------

/// UDUNITS-2 keeps its status in globals: one thread at a time.
std::mutex& library_mutex() {
  static std::mutex mutex;
  return mutex;
}

struct FreeUnit {
  void operator()(ut_unit* unit) const { ut_free(unit); }
};

struct FreeConverter {
  void operator()(cv_converter* converter) const { cv_free(converter); }
};

using Unit = std::unique_ptr<ut_unit, FreeUnit>;

/// The library's own unit database, read once and kept for the life of the program.
ut_system* unit_system() {
  static ut_system* const system = [] {
    ut_set_error_message_handler(ut_ignore);
    ut_system* read = ut_read_xml(nullptr);
    if (read == nullptr)
      throw std::runtime_error(
          "UDUNITS-2 cannot read its unit database; set UDUNITS2_XML_PATH to its udunits2.xml");
    return read;
  }();
  return system;
}

Unit parsed(std::string_view text) {
  if (text.empty()) return nullptr;
  return Unit(ut_parse(unit_system(), std::string(text).c_str(), UT_UTF8));
}

/// What a unit may stand for: as UDUNITS-2 reads it, and with masses taken for accelerations and
/// forces.
struct Readings {
  Unit plain;
  Unit weight;  ///< null where no word of it is a mass

  std::array<const ut_unit*, 2> both() const { return {plain.get(), weight.get()}; }
};

Readings readings_of(std::string_view unit) {
  for (const std::string& candidate : spellings_of(unit)) {
    const std::string weight = with_weights_for_masses(candidate);
    Readings readings{parsed(candidate), weight == candidate ? nullptr : parsed(weight)};
    if (readings.plain || readings.weight) return readings;
  }
  return {};
}

bool has_angle(const ut_unit* unit) {
  std::array<char, 256> definition{};
  const int length =
      ut_format(unit, definition.data(), definition.size(), UT_ASCII | UT_DEFINITION);
  if (length < 0 || length >= static_cast<int>(definition.size())) return false;
  return std::string_view(definition.data()).find("rad") != std::string_view::npos;
}

/// None where the dimensions differ or where the relation is no straight line (levels; s to Hz,
/// which UDUNITS-2 inverts).
std::optional<UnitConversion> affine(const ut_unit* from, const ut_unit* to) {
  const std::unique_ptr<cv_converter, FreeConverter> converter(
      ut_get_converter(const_cast<ut_unit*>(from), const_cast<ut_unit*>(to)));
  if (!converter) return std::nullopt;
  const auto at = [&](double x) { return cv_convert_double(converter.get(), x); };
  const double bend = (at(2.0) - at(1.0)) - (at(1.0) - at(0.0));
  const double size = std::max({std::abs(at(0.0)), std::abs(at(1.0)), std::abs(at(2.0))});
  if (!std::isfinite(size) || !(std::abs(bend) <= 1e-12 * size)) return std::nullopt;
  const double offset = at(0.0);
  // Far out the offset of a temperature no longer costs digits of the factor.
  const double far = 0x1p60;
  return UnitConversion{offset == 0.0 ? at(1.0) : (at(far) - offset) / far, offset};
}

/// UDUNITS-2 drops the radian, so that 1 rad/s would become 1 Hz. A torsional stiffness may drop
/// it.
std::optional<UnitConversion> conversion_of(const ut_unit* from, const ut_unit* to) {
  if (from == nullptr || to == nullptr) return std::nullopt;
  const std::optional<UnitConversion> result = affine(from, to);
  if (!result || has_angle(from) == has_angle(to)) return result;
  const bool pure = affine(from, parsed("Hz").get()) || affine(from, parsed("1").get());
  return pure ? std::nullopt : result;
}

Quantity quantity_of(const ut_unit* unit) {
  for (const QuantityText& entry : quantity_texts) {
    if (entry.si_unit.empty() || entry.quantity == Quantity::strain) continue;
    const Unit si = parsed(entry.si_unit);
    if (has_angle(unit) == has_angle(si.get()) && affine(unit, si.get())) return entry.quantity;
  }
  return Quantity::other;
}

Quantity quantity_of(const Readings& readings) {
  if (!readings.plain && !readings.weight) return Quantity::unknown;
  if (readings.weight) {
    const Quantity quantity = quantity_of(readings.weight.get());
    if (quantity != Quantity::other || !readings.plain) return quantity;
  }
  return quantity_of(readings.plain.get());
}

/// "MSEC", "Msec" and "Ms": nobody records in millions of seconds. "PC" is no million of billions
/// of coulombs.
bool has_senseless_prefix(std::string_view unit, const Readings& readings) {
  if (!readings.plain || (unit.front() != 'M' && unit.front() != 'P')) return false;
  constexpr double senseless = 1e6;
  const Unit si = parsed(unit.front() == 'M' ? "s" : "C");
  const auto size = affine(readings.plain.get(), si.get());
  return size && size->factor >= senseless;
}

/// The readings of a unit, or in small letters where it has none in its capitals and these make it
/// one of motion, force or pressure.
Readings understood_readings(std::string_view unit) {
  Readings readings = readings_of(unit);
  if (readings.plain || readings.weight) {
    if (!has_senseless_prefix(unit, readings)) return readings;
    std::string small(unit);
    std::ranges::transform(small, small.begin(), [](char c) {
      return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    });
    if (unit.front() == 'P') small = "p" + std::string(unit.substr(1));
    Readings other = readings_of(small);
    return other.plain ? std::move(other) : std::move(readings);
  }
  Readings small = readings_of(in_small_letters(unit));
  const Quantity quantity = quantity_of(small);
  const bool plausible = quantity == Quantity::force || quantity == Quantity::velocity ||
                         quantity == Quantity::displacement || quantity == Quantity::pressure ||
                         quantity == Quantity::acceleration;
  return plausible ? std::move(small) : std::move(readings);
}

}  // namespace

std::string_view name(Quantity quantity) {
  return text_of(quantity).name;
}

std::string_view si_unit(Quantity quantity) {
  return text_of(quantity).si_unit;
}

std::optional<Quantity> quantity_named(std::string_view name) {
  const auto found = std::ranges::find(quantity_texts, name, &QuantityText::name);
  if (found == quantity_texts.end()) return std::nullopt;
  return found->quantity;
}

std::optional<UnitConversion> conversion(std::string_view from, std::string_view to) {
  const std::lock_guard lock(library_mutex());
  const Readings source = understood_readings(from);
  const Readings target = understood_readings(to);
  for (const ut_unit* target_unit : target.both())
    for (const ut_unit* source_unit : source.both())
      if (const auto result = conversion_of(source_unit, target_unit)) return result;
  return std::nullopt;
}

Quantity quantity_of_unit(std::string_view unit) {
  const std::lock_guard lock(library_mutex());
  if (is_strain(unit)) return Quantity::strain;
  return quantity_of(understood_readings(unit));
}

}  // namespace impactrig::datasets
