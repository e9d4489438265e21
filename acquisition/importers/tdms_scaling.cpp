// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/tdms_scaling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "acquisition/importers/text_file.hpp"
#include "acquisition/importers/thermocouples.hpp"
#include "acquisition/importers/time_axis.hpp"

namespace impactrig::acquisition {

std::string iso_text(const TdmsTime& time) {
  if (time.seconds == 0 && time.fraction == 0) return {};
  constexpr std::int64_t from_1904_to_1970 = 2082844800;
  if (time.seconds < std::numeric_limits<std::int64_t>::min() + from_1904_to_1970) return {};
  std::int64_t seconds = time.seconds - from_1904_to_1970;
  std::uint64_t micros = ((time.fraction >> 32) * 1000000 + (std::uint64_t{1} << 31)) >> 32;
  if (micros == 1000000) {
    if (seconds == std::numeric_limits<std::int64_t>::max()) return {};
    micros = 0;
    ++seconds;
  }
  std::string text = iso_utc(seconds, static_cast<std::uint32_t>(micros));
  if (!time.utc && text.ends_with('Z')) text.pop_back();
  return text;
}

std::string text_of(const TdmsProperty& property) {
  if (const auto* const text = std::get_if<std::string>(&property)) return *text;
  if (const auto* const time = std::get_if<TdmsTime>(&property)) return iso_text(*time);
  if (const auto* const number = std::get_if<double>(&property)) return fmt::format("{}", *number);
  if (const auto* const number = std::get_if<std::int64_t>(&property))
    return fmt::format("{}", *number);
  return fmt::format("{}", std::get<std::uint64_t>(property));
}

std::string text_of(const TdmsProperties& properties, const std::string& name) {
  const auto found = properties.find(name);
  return found == properties.end() ? std::string() : text_of(found->second);
}

std::optional<double> number_of(const TdmsProperty& property) {
  if (const auto* const number = std::get_if<double>(&property)) return *number;
  if (const auto* const number = std::get_if<std::int64_t>(&property))
    return static_cast<double>(*number);
  if (const auto* const number = std::get_if<std::uint64_t>(&property))
    return static_cast<double>(*number);
  return std::nullopt;
}

std::optional<double> number_of(const TdmsProperties& properties, const std::string& name) {
  const auto found = properties.find(name);
  return found == properties.end() ? std::nullopt : number_of(found->second);
}

namespace {

using Others = std::span<const std::vector<double>>;

/// Scales that one channel may chain, each counted as often as it is used.
constexpr int most_stages = 64;

/// Why a scale cannot be applied.
struct Unsupported {
  std::string why;
};

/// What has been made of the raw numbers so far: a straight line, or anything.
struct Stage {
  double scale = 1.0;
  double offset = 0.0;
  TdmsFunction function{};  // behind it scale and offset are not used

  /// This stage as a function.
  TdmsFunction as_function() const {
    if (function) return function;
    return [scale = scale, offset = offset](std::span<double> x, Others) {
      for (double& value : x) value = scale * value + offset;
    };
  }

  /// This stage, then `next`.
  Stage then(TdmsFunction next) const {
    Stage both;
    if (!function && scale == 1.0 && offset == 0.0)
      both.function = std::move(next);
    else
      both.function = [first = as_function(), next = std::move(next)](std::span<double> x,
                                                                      Others others) {
        first(x, others);
        next(x, others);
      };
    return both;
  }

  Stage then_linear(double slope, double intercept) const {
    if (function)
      return then([slope, intercept](std::span<double> x, Others) {
        for (double& value : x) value = slope * value + intercept;
      });
    return {scale * slope, offset * slope + intercept, {}};
  }
};

/// A function of one number, for all.
template <typename Each>
TdmsFunction for_each_number(Each each) {
  return [each](std::span<double> x, Others) {
    for (double& value : x) value = each(value);
  };
}

// Codes of NI-DAQmx (NIDAQmx.h), as properties state them.
constexpr double voltage_excitation = 10322;
constexpr double current_excitation = 10134;

/// The resistance of a sensor without its wires, by 2, 3 or 4 wires: 4 carry no current; with 3 one
/// wire remains; with 2 and a current both do.
double without_wires(double resistance, bool by_current, double wires, double wire_resistance) {
  if (wires == 3) return resistance - wire_resistance;
  if (wires == 2 && by_current) return resistance - 2.0 * wire_resistance;
  return resistance;
}

/// Whether finite numbers increase, or decrease, throughout.
bool goes_one_way(const std::vector<double>& x) {
  if (!std::ranges::all_of(x, [](double value) { return std::isfinite(value); })) return false;
  return std::ranges::adjacent_find(x, std::ranges::greater_equal{}) == x.end() ||
         std::ranges::adjacent_find(x, std::ranges::less_equal{}) == x.end();
}

class Chain {
 public:
  explicit Chain(const TdmsProperties& properties) : properties_(properties) {}

  TdmsScaling scaling() {
    TdmsScaling result;
    const std::optional<std::uint32_t> last = last_scale();
    if (!last) return result;
    try {
      const Stage stage = stage_of(*last);
      if (!std::isfinite(stage.scale) || !std::isfinite(stage.offset))
        throw Unsupported{"its scales are not finite"};
      result.scale = stage.scale;
      result.offset = stage.offset;
      result.function = stage.function;
      result.source = source_.value_or(TdmsScaling::raw_data);
      result.others = others_;
    } catch (const Unsupported& unsupported) {
      result.problem = unsupported.why;
    }
    result.what = what_;
    result.note = note_;
    return result;
  }

 private:
  std::string key(std::uint32_t index, std::string_view name) const {
    return fmt::format("NI_Scale[{}]_{}", index, name);
  }

  std::optional<std::uint32_t> last_scale() const {
    const auto status = properties_.find("NI_Scaling_Status");
    if (status != properties_.end() && text_of(status->second) == "scaled") return std::nullopt;
    if (const auto stated = number_of(properties_, "NI_Number_Of_Scales")) {
      if (!(*stated >= 1.0) || *stated > 4294967295.0) return std::nullopt;
      return static_cast<std::uint32_t>(*stated) - 1;
    }
    std::optional<std::uint32_t> last;
    constexpr std::string_view begin = "NI_Scale[";
    for (auto at = properties_.lower_bound(std::string(begin));
         at != properties_.end() && at->first.starts_with(begin); ++at) {
      std::uint32_t index = 0;
      const char* const first = at->first.data() + begin.size();
      const char* const end = at->first.data() + at->first.size();
      const auto [stop, error] = std::from_chars(first, end, index);
      if (error == std::errc{} && std::string_view(stop, end) == "]_Scale_Type")
        last = std::max(last.value_or(0), index);
    }
    return last;
  }

  double needed(std::uint32_t index, std::string_view name) const {
    const auto value = number_of(properties_, key(index, name));
    if (!value) throw Unsupported{fmt::format("its scale {} states no {}", index, name)};
    return *value;
  }

  double stated(std::uint32_t index, std::string_view name, double otherwise) const {
    return number_of(properties_, key(index, name)).value_or(otherwise);
  }

  std::vector<double> list(std::uint32_t index, std::string_view name, double otherwise) const {
    const double size = stated(index, fmt::format("{}_Size", name), otherwise);
    std::vector<double> numbers;  // grows by what is there, not by what is announced
    for (std::uint32_t i = 0; i < size; ++i)
      numbers.push_back(needed(index, fmt::format("{}[{}]", name, i)));
    return numbers;
  }

  Stage input_of(std::uint32_t index, std::string_view name) {
    const double source = stated(index, name, TdmsScaling::raw_data);
    if (source == TdmsScaling::raw_data) return raw(TdmsScaling::raw_data);
    if (!(source >= 0.0) || source > 4294967295.0)
      throw Unsupported{fmt::format("its scale {} states a source of {}", index, source)};
    return stage_of(static_cast<std::uint32_t>(source));
  }

  /// The numbers of a raw signal: the first that is asked for is changed in place, others (the cold
  /// junction of a thermocouple) stand beside it.
  Stage raw(std::uint32_t source) {
    if (!source_) source_ = source;
    if (*source_ == source) return {};
    const auto known = std::ranges::find(others_, source);
    const auto which = static_cast<std::size_t>(known - others_.begin());
    if (known == others_.end()) others_.push_back(source);
    Stage stage;
    stage.function = [which](std::span<double> x, Others others) {
      std::ranges::copy(others[which], x.begin());
    };
    return stage;
  }

  /// What scale `index` and all before it make of the raw numbers.
  Stage stage_of(std::uint32_t index) {
    if (++stages_ > most_stages)
      throw Unsupported{"its scales are chained in a circle, or too long"};
    const auto type = properties_.find(key(index, "Scale_Type"));
    if (type == properties_.end()) return raw(index);  // the scaler of raw data with this id
    const std::string name = text_of(type->second);
    const Stage result = stage_named(name, index);
    if (name != "AdvancedAPI") what_ += (what_.empty() ? "" : ", ") + to_utf8(name);
    return result;
  }

  Stage stage_named(const std::string& name, std::uint32_t index) {
    if (name == "Linear") {
      const Stage input = input_of(index, "Linear_Input_Source");
      const double slope = needed(index, "Linear_Slope");
      return input.then_linear(slope, needed(index, "Linear_Y_Intercept"));
    }
    if (name == "Polynomial") return polynomial(index);
    if (name == "Table") return table(index);
    if (name == "RTD") return resistance_thermometer(index);
    if (name == "Thermistor") return thermistor(index);
    if (name == "Thermocouple") return thermocouple_scale(index);
    if (name == "Strain") return strain(index);
    if (name == "Add") return sum(index, "Add", 1.0);
    // the right operand is the minuend: so NI's own plug-in for Excel shows it
    if (name == "Subtract") return sum(index, "Subtract", -1.0);
    if (name == "AdvancedAPI") return input_of(index, "AdvancedAPI_Input_Source");
    throw Unsupported{fmt::format("its scale {} is of the type '{}', which is not supported", index,
                                  to_utf8(name))};
  }

  Stage polynomial(std::uint32_t index) {
    const Stage input = input_of(index, "Polynomial_Input_Source");
    const std::vector<double> c = list(index, "Polynomial_Coefficients", 4);
    if (c.empty()) return input.then_linear(0.0, 0.0);
    if (c.size() <= 2) return input.then_linear(c.size() == 2 ? c[1] : 0.0, c[0]);
    return input.then(for_each_number([c](double x) {
      double y = 0.0;
      for (std::size_t i = c.size(); i-- > 0;) y = y * x + c[i];
      return y;
    }));
  }

  /// Straight lines between the points of a table, its ends beyond them. The numbers of the file
  /// are looked up among the side that goes one way: the pre-scaled values where both do. So the
  /// names and NI-DAQmx's table scales have it; but the tables of thermocouple modules, and npTDMS
  /// before 1.11, have volts as "scaled" and degrees as "pre-scaled" values.
  Stage table(std::uint32_t index) {
    const Stage input = input_of(index, "Table_Input_Source");
    std::vector<double> x = list(index, "Table_Pre_Scaled_Values", 0);
    std::vector<double> y = list(index, "Table_Scaled_Values", 0);
    if (x.size() != y.size() || x.empty())
      throw Unsupported{
          fmt::format("its scale {} is a table of {} to {} values", index, x.size(), y.size())};
    const bool against_names = !goes_one_way(x);
    if (against_names) std::swap(x, y);
    if (!goes_one_way(x))
      throw Unsupported{fmt::format("its scale {} is a table that goes back and forth", index)};
    note_ = fmt::format(
        "its scale {} is a table, which is read from its {} to its {}: files of "
        "thermocouple modules have tables the other way round",
        index, against_names ? "scaled values" : "pre-scaled values",
        against_names ? "pre-scaled ones" : "scaled ones");
    if (x.front() > x.back()) {
      std::ranges::reverse(x);
      std::ranges::reverse(y);
    }
    return input.then(for_each_number([x, y](double value) {
      if (std::isnan(value)) return value;
      const auto above = std::ranges::upper_bound(x, value);
      if (above == x.begin()) return y.front();
      if (above == x.end()) return y.back();
      const auto i = static_cast<std::size_t>(above - x.begin());
      return y[i - 1] + (y[i] - y[i - 1]) * (value - x[i - 1]) / (x[i] - x[i - 1]);
    }));
  }

  /// Volts to °C by R = R₀ (1 + A T + B T² + C (T − 100) T³), C only below 0 °C.
  /// Source: Callendar and Van Dusen, as in IEC 60751.
  Stage resistance_thermometer(std::uint32_t index) {
    const Stage input = input_of(index, "RTD_Input_Source");
    const double current = needed(index, "RTD_Current_Excitation");
    const double r0 = needed(index, "RTD_R0_Nominal_Resistance");
    const double a = needed(index, "RTD_A");
    const double b = needed(index, "RTD_B");
    const double c = needed(index, "RTD_C");
    const double wire = stated(index, "RTD_Lead_Wire_Resistance", 0.0);
    const double wires = stated(index, "RTD_Resistance_Configuration", 4);
    return input.then(for_each_number([=](double volts) {
      const double ratio = without_wires(volts / current, true, wires, wire) / r0;
      const auto warm = [=](double r) {
        return b == 0.0 ? (r - 1.0) / a : (-a + std::sqrt(a * a - 4.0 * b * (1.0 - r))) / (2.0 * b);
      };
      double t = warm(ratio);
      if (!(ratio < 1.0)) return t;
      for (int i = 0; i < 8; ++i) {  // Newton from the curve without C, 2.4 K off at -200 °C
        const double f = 1.0 + t * (a + t * (b + c * (t - 100.0) * t)) - ratio;
        const double slope = a + t * (2.0 * b + c * t * (4.0 * t - 300.0));
        t -= f / slope;
      }
      return t;
    }));
  }

  /// Volts to temperature by 1/T = A + B ln R + C (ln R)³, less the offset (273.15 K makes °C).
  /// Source: Steinhart and Hart, Deep-Sea Research 15 (1968).
  Stage thermistor(std::uint32_t index) {
    const Stage input = input_of(index, "Thermistor_Input_Source");
    const double type = needed(index, "Thermistor_Excitation_Type");
    const double excitation = needed(index, "Thermistor_Excitation_Value");
    const double wires = stated(index, "Thermistor_Resistance_Configuration", 4);
    const double reference = stated(index, "Thermistor_R1_Reference_Resistance", 0.0);
    const double wire = stated(index, "Thermistor_Lead_Wire_Resistance", 0.0);
    const double a = needed(index, "Thermistor_A");
    const double b = needed(index, "Thermistor_B");
    const double c = needed(index, "Thermistor_C");
    const double offset = stated(index, "Thermistor_Temperature_Offset", 0.0);
    if (type != voltage_excitation && type != current_excitation)
      throw Unsupported{fmt::format("its scale {} states an excitation of type {}", index, type)};
    const bool by_current = type == current_excitation;
    return input.then(for_each_number([=](double volts) {
      const double measured =
          by_current ? volts / excitation : reference / (excitation / volts - 1.0);
      const double log_r = std::log(without_wires(measured, by_current, wires, wire));
      return 1.0 / (a + log_r * (b + log_r * log_r * c)) - offset;
    }));
  }

  /// Microvolts of a thermocouple whose cold junction is at 0 °C to °C; or back, as the voltage of
  /// a cold junction is added to that of a thermocouple.
  Stage thermocouple_scale(std::uint32_t index) {
    constexpr auto codes = std::to_array<std::pair<double, const char*>>({{10047, "B"},
                                                                          {10055, "E"},
                                                                          {10072, "J"},
                                                                          {10073, "K"},
                                                                          {10077, "N"},
                                                                          {10082, "R"},
                                                                          {10085, "S"},
                                                                          {10086, "T"}});
    const Stage input = input_of(index, "Thermocouple_Input_Source");
    const double code = needed(index, "Thermocouple_Thermocouple_Type");
    const auto known = std::ranges::find(codes, code, &std::pair<double, const char*>::first);
    if (known == codes.end())
      throw Unsupported{
          fmt::format("its scale {} is a thermocouple of the unknown type {}", index, code)};
    const Thermocouple& type = *thermocouple(known->second);
    const double direction = stated(index, "Thermocouple_Scaling_Direction", 0.0);
    if (direction != 0.0 && direction != 1.0)
      throw Unsupported{fmt::format("its scale {} is a thermocouple scale of the direction {}",
                                    index, direction)};
    if (direction == 1.0)
      return input.then(for_each_number(
          [&type](double celsius) { return 1e3 * thermoelectric_voltage(type, celsius); }));
    return input.then(for_each_number([&type](double microvolts) {
      return thermoelectric_temperature(type, 1e-3 * microvolts);
    }));
  }

  /// Volts across a Wheatstone bridge to strain. With r = (V − V_initial)/V_excitation, gauge
  /// factor G and Poisson's ratio ν the bridges of NI's measuring devices give:
  ///   full I    r = −ε G
  ///   full II   r = −ε G (1 + ν) / 2
  ///   full III  r = −ε G (1 + ν) / (2 + ε G (1 − ν))
  ///   half I    r = −ε G (1 + ν) / (4 + 2 ε G (1 − ν))
  ///   half II   r = −ε G / 2
  ///   quarter   r = −ε G / (4 + 2 ε G)
  /// Half and quarter bridges lose 1/(1 + R_wire/R_gauge) of their gauge factor.
  Stage strain(std::uint32_t index) {
    const Stage input = input_of(index, "Strain_Input_Source");
    const double bridge = needed(index, "Strain_Configuration");
    const double poisson = stated(index, "Strain_Poisson_Ratio", 0.0);
    const double gauge = stated(index, "Strain_Gage_Resistance", 0.0);
    const double wire = stated(index, "Strain_Lead_Wire_Resistance", 0.0);
    const double initial = stated(index, "Strain_Initial_Bridge_Voltage", 0.0);
    const double factor = needed(index, "Strain_Gage_Factor");
    const double gain = stated(index, "Strain_Bridge_Shunt_Calibration_Gain_Adjustment", 1.0);
    const double excitation = needed(index, "Strain_Voltage_Excitation");
    const double wires = wire == 0.0 ? 1.0 : 1.0 + wire / gauge;
    const Stage ratio = input.then_linear(1.0 / excitation, -initial / excitation);
    const double plus = 1.0 + poisson;
    const double minus = 1.0 - poisson;
    switch (bridge >= 0.0 && bridge < 1e6 ? static_cast<int>(bridge) : 0) {
      case 10183:  // full bridge I
        return ratio.then_linear(-gain / factor, 0.0);
      case 10184:  // full bridge II
        return ratio.then_linear(-2.0 * gain / (factor * plus), 0.0);
      case 10185:  // full bridge III
        return ratio.then(for_each_number(
            [=](double r) { return -2.0 * gain * r / (factor * (plus + r * minus)); }));
      case 10188:  // half bridge I
        return ratio.then(for_each_number([=](double r) {
          return -4.0 * gain * wires * r / (factor * (plus + 2.0 * r * minus));
        }));
      case 10189:  // half bridge II
        return ratio.then_linear(-2.0 * gain * wires / factor, 0.0);
      case 10271:  // quarter bridge I
      case 10272:  // quarter bridge II
        return ratio.then(for_each_number(
            [=](double r) { return -4.0 * gain * wires * r / (factor * (1.0 + 2.0 * r)); }));
      default:
        throw Unsupported{
            fmt::format("its scale {} is a strain bridge of the unknown type {}", index, bridge)};
    }
  }

  Stage sum(std::uint32_t index, std::string_view name, double sign_of_left) {
    const Stage left = input_of(index, fmt::format("{}_Left_Operand_Input_Source", name));
    const Stage right = input_of(index, fmt::format("{}_Right_Operand_Input_Source", name));
    if (!left.function && !right.function)
      return {
          right.scale + sign_of_left * left.scale, right.offset + sign_of_left * left.offset, {}};
    Stage both;
    both.function = [sign_of_left, left = left.as_function(), right = right.as_function()](
                        std::span<double> x, Others others) {
      std::vector<double> copy(x.begin(), x.end());
      left(copy, others);
      right(x, others);
      for (std::size_t i = 0; i < x.size(); ++i) x[i] += sign_of_left * copy[i];
    };
    return both;
  }

  const TdmsProperties& properties_;
  std::optional<std::uint32_t> source_;
  std::vector<std::uint32_t> others_;
  std::string what_;
  std::string note_;
  int stages_ = 0;
};

}  // namespace

TdmsScaling tdms_scaling(const TdmsProperties& properties) {
  return Chain(properties).scaling();
}

bool states_scales(const TdmsProperties& properties) {
  if (properties.contains("NI_Number_Of_Scales")) return true;
  const auto at = properties.lower_bound("NI_Scale[");
  return at != properties.end() && at->first.starts_with("NI_Scale[");
}

}  // namespace impactrig::acquisition
