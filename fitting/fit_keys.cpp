// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/fit_keys.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <stdexcept>

#include "fitting/parameters.hpp"

namespace impactrig::fitting {
namespace {

/// A plain number where there is no unit, else a quantity in quotes.
std::optional<double> value_of(TableReader& table, std::string_view key, const std::string& unit) {
  if (unit == "1" && table.has(key) && table.raw().get(key)->is_number()) return table.number(key);
  const auto value = table.quantity(key, unit);
  return value ? std::optional(value->value) : std::nullopt;
}

/// A text, which has room for the uncertainty; also where there is no unit.
void read_prior(TableReader& table, const std::string& unit, ParameterSetting& setting) {
  const bool bare = unit == "1" && table.has("prior") && table.raw().get("prior")->is_number();
  const auto prior = bare ? std::nullopt : table.quantity("prior", unit);
  if (bare || (prior && !(prior->uncertainty > 0.0)))
    table.refuse("prior", fmt::format("needs its standard uncertainty, for example \"{}\"",
                                      unit == "1" ? "1.0 +- 0.1" : "1.0 +- 0.1 " + unit));
  if (prior) setting.prior = {prior->value, prior->uncertainty};
}

/// Both sides of a tie have one unit: its factor is a plain number.
void refuse_other_unit(const std::string& name, const std::string& to) {
  const std::string unit = unit_of(name), other = unit_of(to);
  const auto named = [](const std::string& of) { return of == "1" ? "no unit" : "the unit " + of; };
  if (unit != other)
    throw std::invalid_argument(
        fmt::format("'{}' has {} and '{}' {}; a tie is between numbers of one unit", name,
                    named(unit), to, named(other)));
}

void read_setting(TableReader& table, const std::string& name, FitOptions& options) {
  const std::string unit = unit_of(name);
  ParameterSetting& setting = options.setting(name);
  setting.initial = value_of(table, "initial", unit);
  setting.lower = value_of(table, "lower", unit);
  setting.upper = value_of(table, "upper", unit);
  read_prior(table, unit, setting);
  if (const auto shared = table.flag("shared")) try {
      choose_shared(name, *shared, options);
    } catch (const std::invalid_argument& error) {
      table.refuse("shared", error.what());
    }
  setting.fixed = table.flag("fixed").value_or(false);
  setting.by_logarithm = table.choice("scale", {"linear", "log"}).value_or(0) == 1;
  if (const auto to = table.text("tied_to")) {
    try {
      refuse_other_unit(name, *to);
    } catch (const std::invalid_argument& error) {
      table.refuse("tied_to", error.what());
    }
    setting.tie = Tie{.to = *to,
                      .factor = table.number("factor").value_or(1.0),
                      .offset = value_of(table, "offset", unit).value_or(0.0)};
  } else if (table.has("factor") || table.has("offset")) {
    table.refuse(table.has("factor") ? "factor" : "offset", "needs tied_to");
  }
  table.finish();
}

/// A table is a parameter's where its dotted name is one, else the way to some.
void read_settings(TableReader& table, const std::string& path, FitOptions& options) {
  for (const auto& [key, node] : table.raw()) {
    if (path.empty() && !node.is_table()) continue;
    const std::string name =
        path.empty() ? std::string(key.str()) : fmt::format("{}.{}", path, key.str());
    const toml::table* inner = node.as_table();
    bool leads_on = false;
    if (inner)
      for (const auto& [below, value] : *inner) leads_on = leads_on || value.is_table();
    if (leads_on) {
      TableReader next = *table.table(key.str());
      read_settings(next, name, options);
      continue;
    }
    try {
      unit_of(name);
    } catch (const std::invalid_argument& error) {
      table.refuse(key.str(), error.what());
    }
    TableReader setting = *table.table(key.str());
    read_setting(setting, name, options);
  }
}

/// Parts of "name=rest".
std::pair<std::string, std::string_view> split(std::string_view text, std::string_view example) {
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos || equals == 0 || equals + 1 == text.size())
    throw std::invalid_argument(fmt::format("expected {}, found \"{}\"", example, text));
  return {std::string(text.substr(0, equals)), text.substr(equals + 1)};
}

}  // namespace

void choose_channels(const std::vector<std::string>& names, FitOptions& options) {
  options.use_force = options.use_velocity = options.use_displacement = false;
  options.channels_stated = true;
  for (const std::string& name : names) {
    if (name != "force" && name != "velocity" && name != "displacement")
      throw std::invalid_argument("expected force, velocity or displacement, found " + name);
    (name == "force"      ? options.use_force
     : name == "velocity" ? options.use_velocity
                          : options.use_displacement) = true;
  }
}

void choose_shared(const std::string& name, bool shared, FitOptions& options) {
  unit_of(name);
  if (const auto [key, recording] = parameter_key(name); recording > 0)
    throw std::invalid_argument(
        fmt::format("'{}' is one recording's; whether all share it is said of {}", name, key));
  if (name == "impact.time" && shared)
    throw std::invalid_argument(
        "'impact.time' cannot be shared: each recording has a time axis of its own");
  options.setting(name).shared = shared;
}

FitOptions read_fit(TableReader& table) {
  FitOptions options;
  options.free = table.texts("free").value_or(std::vector<std::string>{});
  for (const std::string& name : options.free) try {
      unit_of(name);
    } catch (const std::invalid_argument& error) {
      table.refuse("free", error.what());
    }
  if (const auto channels = table.texts("channels")) try {
      choose_channels(*channels, options);
    } catch (const std::invalid_argument& error) {
      table.refuse("channels", error.what());
    }
  if (const auto window = table.quantity("window", "s")) {
    if (!(window->value > 0.0)) table.refuse("window", "must be greater than zero");
    options.window = window->value;
  }
  if (const auto limit = table.quantity("time_limit", "s")) {
    if (!(limit->value > 0.0)) table.refuse("time_limit", "must be greater than zero");
    options.time_limit = limit->value;
  }
  const auto losses = loss_names();
  if (const auto loss = table.choice("loss", {losses.begin(), losses.end()}))
    options.loss = static_cast<Loss>(*loss);
  options.profile = table.flag("profile").value_or(false);
  if (const auto draws = table.integer("bootstrap")) {
    if (*draws < 0 || *draws == 1) table.refuse("bootstrap", "must be 0, or 2 and more");
    options.bootstrap = *draws;
  }
  if (const auto kind = table.choice("bootstrap_kind", {"parametric", "residual"}))
    options.bootstrap_kind = static_cast<BootstrapKind>(*kind);
  if (const auto seed = table.integer("seed")) {
    if (*seed < 0) table.refuse("seed", "must not be negative");
    options.seed = static_cast<std::uint64_t>(*seed);
  }
  read_settings(table, "", options);
  table.finish();
  return options;
}

void read_prior(std::string_view text, FitOptions& options) {
  const auto [name, value] = split(text, "NAME=VALUE +- UNCERTAINTY");
  const datasets::UncertainValue prior =
      datasets::parse_quantity(std::string(value), unit_of(name));
  if (!(prior.uncertainty > 0.0))
    throw std::invalid_argument(fmt::format(
        "the prior of {} needs its standard uncertainty, for example \"1.0 +- 0.1\"", name));
  options.setting(name).prior = {prior.value, prior.uncertainty};
}

void read_bounds(std::string_view text, FitOptions& options) {
  const auto [name, range] = split(text, "NAME=LOW:HIGH");
  const std::size_t colon = range.find(':');
  if (colon == std::string_view::npos || range.size() == 1)
    throw std::invalid_argument(fmt::format("expected LOW:HIGH, found \"{}\"", range));
  const std::string unit = unit_of(name);
  ParameterSetting& setting = options.setting(name);
  if (const std::string low(range.substr(0, colon)); !low.empty())
    setting.lower = datasets::parse_quantity(low, unit).value;
  if (const std::string high(range.substr(colon + 1)); !high.empty())
    setting.upper = datasets::parse_quantity(high, unit).value;
}

void read_tie(std::string_view text, FitOptions& options) {
  const auto [name, line] = split(text, "NAME=FACTOR*OTHER");
  unit_of(name);
  const std::size_t star = line.find('*');
  Tie tie{.to = std::string(star == std::string_view::npos ? line : line.substr(star + 1))};
  if (star != std::string_view::npos) {
    const auto [end, error] = std::from_chars(line.data(), line.data() + star, tie.factor);
    if (error != std::errc{} || end != line.data() + star || !std::isfinite(tie.factor))
      throw std::invalid_argument(
          fmt::format("expected a number before the *, found \"{}\"", line.substr(0, star)));
  }
  refuse_other_unit(name, tie.to);
  options.setting(name).tie = tie;
}

}  // namespace impactrig::fitting
