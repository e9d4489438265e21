// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "acquisition/channel_map.hpp"
#include "acquisition/conditioning/background.hpp"
#include "acquisition/conditioning/condition.hpp"
#include "acquisition/conditioning/samples.hpp"
#include "acquisition/importers/column_heads.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Quantity;
using datasets::Record;

namespace {

/// A text between quotes, as TOML has it.
std::string in_quotes(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F)
      out += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
    else
      out += c;
  }
  return out + "\"";
}

/// A text within a comment: on one line.
std::string on_one_line(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < 0x20 || c == 0x7F; }, ' ');
  return text;
}

std::string which(const Record& record, std::size_t index) {
  const std::string& name = record.channels[index].name;
  const bool is_no_name = name.empty() || name.find_first_of("*?") != std::string::npos ||
                          std::ranges::count(record.channels, name, &Channel::name) > 1;
  return is_no_name ? fmt::format("index = {}  # {}\n", index, on_one_line(name))
                    : fmt::format("match = {}\n", in_quotes(name));
}

/// Comments for what is to be stated of volts and coulombs, and of what may be either.
std::string electrical(std::string_view name, std::string_view unit) {
  const Quantity named = quantity_of_first_word(name);
  const Quantity quantity = named == Quantity::unknown ? Quantity::force : named;
  std::string example = sensitivity_example(unit, quantity);
  if (example.empty()) example = sensitivity_example("V", quantity);
  std::string text = fmt::format("# role = {}\n", in_quotes(datasets::name(quantity)));
  text += fmt::format("# sensitivity = \"{}\"\n", example);
  if (quantity == Quantity::force && datasets::conversion(unit, "V"))
    text += "# sensitivity = \"4 pC/N\"  # behind a charge amplifier of\n# gain = \"1 mV/pC\"\n";
  return text;
}

/// Unit, role and sensitivity of a channel; those that have to be stated first are comments.
std::string what(const Channel& channel) {
  const std::string_view si = datasets::si_unit(channel.quantity);
  const std::string role = fmt::format("role = {}\n", in_quotes(datasets::name(channel.quantity)));
  const bool is_electrical =
      channel.quantity == Quantity::voltage || channel.quantity == Quantity::charge;
  const bool is_physical = !si.empty() && !is_electrical;
  if (channel.unit.starts_with("FS"))
    return "# full_scale = \"10 V\"  # the file holds parts of full scale\n" +
           electrical(channel.name, "");
  if (channel.unit.empty())
    return is_physical ? fmt::format("# unit = \"{}\"  # the file states none\n# {}", si, role)
                       : "# unit = \"V\"  # the file states none\n" + electrical(channel.name, "");
  const std::string unit = fmt::format("unit = {}", in_quotes(channel.unit));
  if (!unit_of_weight(channel.unit, Quantity::force).empty())
    return unit +
           "  # a mass; \"kgf\" where its weight is meant, \"kilo-g\" for 1000 g\n# role = "
           "\"force\"\n";
  if (is_physical && datasets::conversion(channel.unit, si)) return unit + "\n" + role;
  if (is_electrical) return unit + "\n" + electrical(channel.name, channel.unit);
  const bool understood = datasets::quantity_of_unit(channel.unit) != Quantity::unknown;
  return unit + (understood ? "\n" : "  # not understood: state another\n") +
         (is_physical ? "# " + role : electrical(channel.name, ""));
}

/// The impact that its trigger shows most of, of the channels as they stand.
std::optional<datasets::Impact> largest_impact(const Record& record) {
  try {
    std::vector<datasets::Impact> impacts = find_impacts(record);
    const auto size = [](const datasets::Impact& impact) { return std::abs(impact.peak); };
    const auto largest = std::ranges::max_element(impacts, {}, size);
    if (largest != impacts.end()) return std::move(*largest);
  } catch (const std::exception&) {
    // no clock, no unit, nothing in it: the draft says nothing of polarity
  }
  return std::nullopt;
}

/// The value furthest from 0 from touch on, further contacts included.
double largest_from_touch(const datasets::Impact& impact, const datasets::ImpactSignal& signal) {
  double largest = 0.0;
  for (std::size_t i = 0; i < signal.values.size(); ++i)
    if (signal.time(i) >= impact.start && std::abs(signal.values[i]) > std::abs(largest))
      largest = signal.values[i];
  return largest;
}

/// The way that a displacement goes from its window's beginning to touch.
double way_to_touch(const datasets::Impact& impact, const datasets::ImpactSignal& signal) {
  const auto touch = static_cast<std::size_t>(
      std::max(0.0, std::round((impact.start - signal.start) / signal.interval)));
  return signal.values[std::min(touch, signal.values.size() - 1)] - signal.values.front();
}

/// How a channel moves in an impact in the sense that is to be positive; 0 where it tells nothing
/// that its noise would not.
double sense_in(const datasets::Impact& impact, const Channel& channel) {
  constexpr double beyond_noise = 5.0;
  const auto told = [&](const std::optional<datasets::ImpactSignal>& signal, double value) {
    const bool is_it = signal && signal->channel == channel.name;
    return is_it && std::abs(value) > beyond_noise * signal->noise ? value : 0.0;
  };
  switch (channel.quantity) {
    case Quantity::force:
      return told(impact.force, impact.force ? largest_from_touch(impact, *impact.force) : 0.0);
    case Quantity::velocity:
      return told(impact.velocity, impact.approach_velocity);
    case Quantity::displacement:
      return told(impact.displacement,
                  impact.displacement ? way_to_touch(impact, *impact.displacement) : 0.0);
    default:
      return 0.0;
  }
}

/// Of volts and such, whose role is not known: how far below the usual a pulse in it goes; 0 where
/// it shows none, as a velocity does that is another one afterwards.
double pulse_below(const Channel& channel) {
  constexpr double seen = 0.2, most = 0.1;  // of the pulse's height, of the samples
  std::vector<double> values;
  if (!channel.complex()) values = channel.values();
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  if (values.empty()) return 0.0;
  const double departure = largest_departure(values);
  const double usual = median(values);
  const auto away = std::ranges::count_if(
      values, [&](double value) { return std::abs(value - usual) > seen * std::abs(departure); });
  const bool is_pulse = static_cast<double>(away) < most * static_cast<double>(values.size());
  return is_pulse ? std::max(0.0, -departure) : 0.0;
}

std::string polarity(const Channel& channel, const std::optional<datasets::Impact>& impact) {
  const bool is_force = channel.quantity == Quantity::force;
  const bool is_told = is_force || channel.quantity == Quantity::velocity ||
                       channel.quantity == Quantity::displacement;
  const double sense = is_told && impact ? sense_in(*impact, channel) : 0.0;
  if (sense < 0.0)
    return fmt::format("polarity = -1  # in the impact at {:.6g} s {}\n", impact->start,
                       is_force ? "it pulls; what presses counts positive"
                                : "the bar moves away; closer counts positive");
  if (sense > 0.0)
    return fmt::format("# polarity = 1  # as the impact at {:.6g} s shows it\n", impact->start);
  if (is_told) return "# polarity = -1  # where it is upside down: no impact tells it here\n";
  const double below = pulse_below(channel);
  if (!(below > 0.0)) return "# polarity = -1  # where it is upside down\n";
  return fmt::format("# polarity = -1  # as a pulse would ask for that goes {:.4g} {} down\n",
                     below, on_one_line(channel.unit));
}

/// A number beside the samples of others, as a MAT-file's sample rate.
bool is_one_value(const Record& record, const Channel& channel) {
  const auto has_many = [](const Channel& other) { return other.size() > 1; };
  return channel.size() == 1 && std::ranges::any_of(record.channels, has_many);
}

}  // namespace

std::string suggested_map(const Record& record) {
  std::string text = fmt::format(
      "# What the channels of {} are. Complete it and give it to `impactrig import --map`.\n"
      "# Keys of a channel: match (name, or a pattern with * and ?) or index (from 0); name;\n"
      "# role (force, velocity, displacement, acceleration, ...); unit of the recorded numbers;\n"
      "# sensitivity (\"4 pC/N\", \"125 mm/s/V\") and gain (\"1 mV/pC\") where volts or coulombs "
      "are\n"
      "# recorded; full_scale = \"10 V\" in place of unit where parts of full scale are; polarity "
      "= -1;\n"
      "# position = \"0.69 m\" from the hinge; delay = \"2(1) us\". Steps of conditioning may\n"
      "# follow: [[conditioning]] with channel = \"velocity\" and step = \"dropouts\", ...\n\n",
      on_one_line(record.provenance.source_file));
  for (const std::string& warning : record.warnings)
    text += fmt::format("# warning: {}\n", on_one_line(warning));
  text += "others = \"drop\"  # or \"keep\": channels that are not named here\n";
  const std::optional<datasets::Impact> impact = largest_impact(record);
  for (const Channel& channel : record.channels)
    if (is_one_value(record, channel))
      text += fmt::format("# '{}' is one value, no channel\n", on_one_line(channel.name));
  for (std::size_t i = 0; i < record.channels.size(); ++i) {
    if (is_one_value(record, record.channels[i])) continue;
    text += "\n[[channels]]\n" + which(record, i) + what(record.channels[i]) +
            polarity(record.channels[i], impact) + "# delay = \"0(1) us\"\n";
  }
  return text;
}

}  // namespace impactrig::acquisition
