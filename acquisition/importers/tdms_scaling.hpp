// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace impactrig::acquisition {

/// LabVIEW's time stamp: seconds since 1904-01-01 00:00 UTC and 2^-64 parts of a second.
struct TdmsTime {
  std::int64_t seconds = 0;
  std::uint64_t fraction = 0;
  bool utc = true;  ///< false: of a zone that is not stated

  friend bool operator==(const TdmsTime&, const TdmsTime&) = default;
};

/// "2016-12-15T22:35:21.068614Z" (to the microsecond), without Z where the zone is not stated; ""
/// for a time that was not set (all zero) or has no calendar date.
std::string iso_text(const TdmsTime& time);

/// The value of a property, and how it is told.
using TdmsProperty = std::variant<std::string, double, std::int64_t, std::uint64_t, TdmsTime>;
using TdmsProperties = std::map<std::string, TdmsProperty>;

std::string text_of(const TdmsProperty& property);
std::string text_of(const TdmsProperties& properties, const std::string& name);  ///< "" = none
std::optional<double> number_of(const TdmsProperty& property);
std::optional<double> number_of(const TdmsProperties& properties, const std::string& name);

/// Changes numbers in place; beside them stand those of other raw signals, one list a signal.
using TdmsFunction = std::function<void(std::span<double>, std::span<const std::vector<double>>)>;

/// What the properties of a channel make of its raw numbers.
struct TdmsScaling {
  /// Source of a scale that is the raw data themselves, not another scale.
  static constexpr std::uint32_t raw_data = 0xFFFFFFFF;

  double scale = 1.0;
  double offset = 0.0;
  TdmsFunction function{};              ///< instead of scale and offset where set
  std::uint32_t source = raw_data;      ///< scale id of the raw numbers it starts from (DAQmx)
  std::vector<std::uint32_t> others{};  ///< those of the raw numbers that `function` needs beside
  std::string what;     ///< the scales in their order, "Linear, Polynomial"; "" none
  std::string note;     ///< what its user should know of one that is applied; "" nothing
  std::string problem;  ///< why it cannot be applied: "its scale 2 is of the type ..."; "" it can
};

/// The scaling that a channel's properties state (NI_Number_Of_Scales, NI_Scale[i]_...), or else
/// those of its group or file. Scales: Linear, Polynomial, Table, RTD, Thermistor, Thermocouple,
/// Strain, Add and Subtract, AdvancedAPI (nothing).
TdmsScaling tdms_scaling(const TdmsProperties& properties);

/// True when the properties state scales.
bool states_scales(const TdmsProperties& properties);

}  // namespace impactrig::acquisition
