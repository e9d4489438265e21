// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/rig_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <variant>

#include "fitting/conditioning_keys.hpp"
#include "fitting/fit_keys.hpp"
#include "fitting/rig_file_contact.hpp"
#include "fitting/rig_file_remarks.hpp"
#include "fitting/sensor_keys.hpp"
#include "fitting/toml_reader.hpp"
#include "models/mesh_error.hpp"

namespace impactrig::fitting {
namespace {

using datasets::InputError;
using datasets::Sensor;

constexpr int default_elements = 16;
constexpr double default_accuracy = 1e-4;  // without a [solver] table: what a mesh can hold

/// A section with its numbers, which a shape makes or the file states.
struct ReadSection {
  Section<> section;
  SectionNumbers<> numbers;
};

ReadSection read_section(TableReader table, double poisson_ratio) {
  ReadSection read;
  Section<>& section = read.section;
  const std::vector<std::string_view> shapes = {"circle", "rectangle", "tube"};
  if (const auto shape = table.choice("shape", shapes))
    section.shape = static_cast<SectionShape>(*shape);
  switch (section.shape) {
    case SectionShape::stated:
      read.numbers.area = table.required_quantity("area", "m^2", "706.9 mm^2");
      read.numbers.second_moment = table.required_quantity("second_moment", "m^4", "39761 mm^4");
      break;
    case SectionShape::circle:
      section.radius = table.required_quantity("radius", "m", "15 mm");
      break;
    case SectionShape::rectangle:
      section.width = table.required_quantity("width", "m", "40 mm");
      section.height = table.required_quantity("height", "m", "10 mm");
      break;
    case SectionShape::tube:
      section.radius = table.required_quantity("radius", "m", "15 mm");
      section.wall = table.required_quantity("wall", "m", "2 mm");
      if (!(section.wall > 0.0 && section.wall < section.radius))
        table.refuse("wall",
                     fmt::format("must lie between 0 and the radius of {:g} m, found {:g} m",
                                 section.radius, section.wall));
      break;
  }
  if (section.shape != SectionShape::stated) read.numbers = section.numbers(poisson_ratio);
  table.finish();
  return read;
}

/// As stated, or as the shape has it.
double read_shear_coefficient(TableReader& table, ReadSection& read) {
  const auto coefficient = table.number("shear_coefficient");
  if (!coefficient && read.numbers.shear_coefficient == 0.0)
    table.refuse("shear_coefficient",
                 "is missing; area and second moment do not say how the section shears, state it, "
                 "for example shear_coefficient = 0.85");
  read.section.shear_coefficient_stated = coefficient.has_value();
  return coefficient.value_or(read.numbers.shear_coefficient);
}

/// A bar of segments: the section of each, in their order.
std::vector<Section<>> read_segments(TableReader& table, models::Beam& beam) {
  std::vector<Section<>> sections;
  for (TableReader& inner : table.tables("segments")) {
    models::BeamSegment segment{.length = inner.required_quantity("length", "m", "0.3 m")};
    auto section = inner.table("section");
    if (!section)
      inner.refuse("section",
                   "is missing; add section = { shape = \"circle\", radius = \"15 mm\" }");
    ReadSection read = read_section(*section, beam.poisson_ratio);
    segment.area = read.numbers.area;
    segment.second_moment = read.numbers.second_moment;
    if (beam.shears()) segment.shear_coefficient = read_shear_coefficient(inner, read);
    sections.push_back(read.section);
    if (const auto modulus = inner.quantity("youngs_modulus", "Pa"))
      segment.youngs_modulus = modulus->value;
    if (const auto density = inner.quantity("density", "kg/m^3")) segment.density = density->value;
    inner.finish();
    beam.segments.push_back(segment);
    beam.length += segment.length;
  }
  // to the digits a rig file has: 0.1 m and 0.2 m are 0.3 m
  beam.length = std::stod(fmt::format("{:.14g}", beam.length));
  for (const char* key : {"length", "section", "area", "second_moment", "shear_coefficient"})
    if (table.has(key))
      table.refuse(key, "beam.segments say this of each segment; keep one of the two");
  return sections;
}

std::vector<Section<>> read_uniform(TableReader& table, models::Beam& beam) {
  beam.length = table.required_quantity("length", "m", "0.8 m");
  ReadSection read;
  if (auto inner = table.table("section")) {
    read = read_section(*inner, beam.poisson_ratio);
  } else if (table.has("area") || table.has("second_moment")) {
    read.numbers.area = table.required_quantity("area", "m^2", "706.9 mm^2");
    read.numbers.second_moment = table.required_quantity("second_moment", "m^4", "39761 mm^4");
  } else {
    table.refuse("section", "is missing; add section = { shape = \"circle\", radius = \"15 mm\" }");
  }
  beam.area = read.numbers.area;
  beam.second_moment = read.numbers.second_moment;
  if (beam.shears())
    beam.shear_coefficient = read_shear_coefficient(table, read);
  else if (table.has("shear_coefficient"))
    table.refuse("shear_coefficient",
                 "a bar of Euler-Bernoulli's theory does not shear; add theory = \"timoshenko\"");
  return {read.section};
}

/// The section of each segment, of a uniform bar its only one.
std::vector<Section<>> read_beam(TableReader& table, models::Rig& rig) {
  rig.beam.poisson_ratio = table.number("poisson_ratio").value_or(rig.beam.poisson_ratio);
  if (const auto theory = table.choice("theory", {"euler-bernoulli", "timoshenko"}))
    rig.beam.theory = static_cast<models::BeamTheory>(*theory);
  std::vector<Section<>> sections =
      table.has("segments") ? read_segments(table, rig.beam) : read_uniform(table, rig.beam);
  rig.beam.youngs_modulus = table.required_quantity("youngs_modulus", "Pa", "68.952 GPa");
  rig.beam.density = table.required_quantity("density", "kg/m^3", "2766.7 kg/m^3");
  if (auto damping = table.table("damping")) {
    if (const auto mass = damping->quantity("mass", "1/s")) rig.beam.damping.mass = mass->value;
    if (const auto stiffness = damping->quantity("stiffness", "s"))
      rig.beam.damping.stiffness = stiffness->value;
    damping->finish();
  }
  for (TableReader& lump : table.tables("masses")) {
    rig.beam.masses.push_back({.position = lump.required_quantity("position", "m", "0.8 m"),
                               .mass = lump.required_quantity("mass", "kg", "0.1 kg")});
    lump.finish();
  }
  table.finish();
  return sections;
}

/// 0 where it is not round.
std::vector<double> surface_radii(const std::vector<Section<>>& sections) {
  std::vector<double> radii;
  for (const Section<>& section : sections) radii.push_back(section.radius);
  return radii;
}

void read_hinge(TableReader& table, models::Hinge& hinge) {
  if (const auto spring = table.quantity("spring", "N.m/rad")) hinge.spring = spring->value;
  if (const auto viscous = table.quantity("viscous", "N.m.s/rad")) hinge.viscous = viscous->value;
  if (const auto friction = table.quantity("friction", "N.m")) hinge.friction = friction->value;
  if (auto rotation = table.table("rotation")) {
    const double time = rotation->quantity("time", "s").value_or(datasets::UncertainValue{}).value;
    hinge.rotation = {.rate = rotation->required_quantity("rate", "rad/s", "6 rad/s"),
                      .time = time};
    rotation->finish();
  }
  table.finish();
}

models::Stop read_stop(TableReader& table) {
  models::Stop stop{.mass = table.required_quantity("mass", "kg", "0.05 kg"),
                    .stiffness = table.required_quantity("stiffness", "N/m", "2e8 N/m")};
  if (const auto viscous = table.quantity("viscous", "N.s/m")) stop.viscous = viscous->value;
  table.finish();
  return stop;
}

void read_start(TableReader& table, models::Start& start) {
  const auto velocity = table.quantity("velocity", "m/s");
  const auto angle = table.quantity("release_angle", "rad");
  if (velocity && angle)
    table.refuse("release_angle", "start.velocity is stated too; keep one of the two");
  if (!velocity && !angle)
    table.refuse(
        "velocity",
        "is missing; add velocity = \"0.441 m/s\" (at first touch) or release_angle = \"12 deg\"");
  if (velocity) start.velocity = velocity->value;
  if (angle) start.release_angle = angle->value;
  table.finish();
}

std::optional<int> read_modes(TableReader& table, std::string_view key, int fewest) {
  const std::optional<int> modes = table.integer(key);
  if (modes && !(*modes >= fewest && *modes <= models::Solver::most_modes))
    table.refuse(key, fmt::format("must lie between {} and {}, found {}", fewest,
                                  models::Solver::most_modes, *modes));
  return modes;
}

/// [hinge to struck point, struck point to tip].
std::array<int, 2> elements_of(const TableReader& table, const std::vector<int>& stated,
                               const models::Rig& rig) {
  if (stated.size() == 1 && stated.front() < 1)
    table.refuse("elements", fmt::format("must be at least 1, found {}", stated.front()));
  if (stated.size() == 1) return models::split_elements(stated.front(), rig);
  if (stated.size() != 2)
    table.refuse(
        "elements",
        "expected one number, or two as in [14, 2]: hinge to struck point, struck point to tip");
  if (!rig.has_stop() && stated[1] != 0)
    table.refuse("elements", fmt::format("[contact] is missing: without it no point of the bar is "
                                         "struck, and the second number must be 0, found {}",
                                         stated[1]));
  return {stated[0], stated[1]};
}

void read_solver(TableReader& table, RigFile& file) {
  models::Solver& solver = file.solver;
  if (const auto model = table.choice("model", {"rigid", "hybrid", "ancf"})) {
    solver.model = static_cast<models::BeamModel>(*model);
    file.mesh_stated = solver.model != models::BeamModel::ancf;
  }
  if (const auto elements = table.integers("elements")) {
    file.mesh_stated = true;
    solver.elements = elements_of(table, *elements, file.rig);
  }
  const std::optional<int> modes = read_modes(table, "modes", 1);
  file.modes_stated = modes.has_value();
  solver.modes = modes.value_or(solver.modes);
  solver.axial_modes = read_modes(table, "axial_modes", 0).value_or(solver.axial_modes);
  if (const auto basis = table.choice("basis", {"cantilever", "pinned-free"}))
    solver.basis = static_cast<models::Basis>(*basis);
  if (const auto accuracy = table.number("accuracy")) solver.accuracy = *accuracy;
  if (const auto duration = table.quantity("duration", "s")) solver.duration = duration->value;
  if (const auto limit = table.quantity("time_limit", "s")) solver.time_limit = limit->value;
  table.finish();
}

std::optional<datasets::BandLimit> read_cut(TableReader& table, std::string_view key, int order) {
  const auto frequency = table.quantity(key, "Hz");
  if (!frequency) return std::nullopt;
  if (!(frequency->value > 0.0)) table.refuse(key, "must be greater than zero");
  return datasets::BandLimit{frequency->value, order};
}

int read_order(TableReader& table) {
  const int order = table.integer("order").value_or(1);
  if (order < 1 || order > 8)
    table.refuse("order", fmt::format("must lie between 1 and 8, found {}", order));
  return order;
}

/// A place as the end or a joint of the bar, where only the rounding of units or of a sum of
/// segments lies between: "69 cm" on a bar of 0.35 m and 0.34 m.
double on_bar(double place, const models::Beam& beam) {
  const auto same = [&](double end) { return std::abs(place - end) <= 1e-12 * beam.length; };
  if (same(beam.length)) return beam.length;
  double joint = 0.0;
  for (const models::BeamSegment& segment : beam.segments)
    if (same(joint += segment.length)) return joint;
  return place;
}

void put_on_bar(models::Rig& rig) {
  rig.contact.position = on_bar(rig.contact.position, rig.beam);
  for (models::LumpedMass& lump : rig.beam.masses) lump.position = on_bar(lump.position, rig.beam);
  for (models::FurtherStop& stop : rig.further_stops)
    stop.contact.position = on_bar(stop.contact.position, rig.beam);
}

Sensor read_sensor(TableReader& table, datasets::Quantity quantity, const models::Rig& rig) {
  Sensor sensor;
  sensor.quantity = quantity;
  sensor.channel = table.name_or_index("channel").value_or("");
  if (table.has("sensitivity"))
    sensor.sensitivity = read_sensitivity(table, datasets::si_unit(quantity), sensor.recorded_unit);
  const int order = read_order(table);
  sensor.low_cut = read_cut(table, "low_cut", order);
  sensor.high_cut = read_cut(table, "high_cut", order);
  if (auto amplifier = table.table("amplifier")) {
    if (amplifier->has("gain")) {
      if (!sensor.sensitivity) refuse_gain_without_sensitivity(*amplifier);
      sensor.sensitivity = with_gain(*amplifier, *sensor.sensitivity, sensor.recorded_unit);
      sensor.recorded_unit = "V";
    }
    const int amplifier_order = read_order(*amplifier);
    if (amplifier->has("low_cut"))
      sensor.low_cut = read_cut(*amplifier, "low_cut", amplifier_order);
    if (amplifier->has("high_cut"))
      sensor.high_cut = read_cut(*amplifier, "high_cut", amplifier_order);
    amplifier->finish();
  }
  if (auto resonance = table.table("resonance")) {
    sensor.resonance = {.frequency = resonance->required_quantity("frequency", "Hz", "45 kHz"),
                        .quality = resonance->number("quality").value_or(20.0)};
    if (!(sensor.resonance->frequency > 0.0))
      resonance->refuse("frequency", "must be greater than zero");
    if (!(sensor.resonance->quality > 0.5))
      resonance->refuse("quality", "must be greater than 0.5");
    resonance->finish();
  }
  if (const auto polarity = table.integer("polarity")) {
    if (*polarity != 1 && *polarity != -1)
      table.refuse("polarity", fmt::format("must be 1 or -1, found {}", *polarity));
    sensor.polarity = *polarity;
  }
  if (quantity == datasets::Quantity::force && table.has("position"))
    table.refuse("position",
                 "a force sensor measures what is between bar and stop: it has no place "
                 "on the bar; leave it out");
  if (const auto position = table.quantity("position", "m")) {
    sensor.position = on_bar(position->value, rig.beam);
    if (!(sensor.position > 0.0 && sensor.position <= rig.beam.length))
      table.refuse("position", fmt::format("{:g} m from the hinge is not on the bar of {:g} m",
                                           sensor.position, rig.beam.length));
  }
  if (const auto range = table.quantity("range", datasets::si_unit(quantity)))
    sensor.range = range->value;
  sensor.delay = read_delay(table);
  table.finish();
  return sensor;
}

void read_sensors(TableReader& table, RigFile& file) {
  if (auto t = table.table("force"))
    file.force = read_sensor(*t, datasets::Quantity::force, file.rig);
  if (auto t = table.table("velocity"))
    file.velocity = read_sensor(*t, datasets::Quantity::velocity, file.rig);
  if (auto t = table.table("displacement"))
    file.displacement = read_sensor(*t, datasets::Quantity::displacement, file.rig);
  table.finish();
}

/// 2 of "2", as lists of tables count them in keys; none of other words.
std::optional<std::size_t> table_number(std::string_view key) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), number);
  return error == std::errc{} && end == key.data() + key.size() && number > 0
             ? std::optional(number)
             : std::nullopt;
}

/// Puts `beam.length = "0.9 m"` or `contacts.1.gap = "1 mm"` into the document, making tables on
/// the way, but none of a list.
void apply_override(toml::table& root, const Override& override) {
  const auto& [name, value] = override;
  const auto refuse = [&](const std::string& problem) {
    throw InputError({.file = "--set " + name}, problem);
  };
  toml::table* table = &root;
  toml::array* list = nullptr;  // whose table is to be told next
  std::string_view rest = name;
  for (std::size_t dot = rest.find('.'); dot != std::string_view::npos; dot = rest.find('.')) {
    const std::string_view key = rest.substr(0, dot);
    const std::string_view before = std::string_view(name).substr(0, name.size() - rest.size());
    rest.remove_prefix(dot + 1);
    toml::node* next = nullptr;
    if (list) {
      const auto number = table_number(key);
      next = number && *number <= list->size() ? list->get(*number - 1) : nullptr;
      if (!next)
        refuse(fmt::format("the rig file has {} [[{}]], counted from 1 here: there is no '{}'",
                           list->size(), before.substr(0, before.size() - 1), key));
      list = nullptr;
    } else {
      next = table->get(key);
      if (!next && table_number(rest.substr(0, rest.find('.'))))
        refuse(fmt::format("the rig file has no [[{}{}]]", before, key));
      if (!next) next = &table->insert(key, toml::table{}).first->second;
    }
    list = next->is_array_of_tables() ? next->as_array() : nullptr;
    table = next->as_table();
    if (!table && !list) refuse(fmt::format("{} is a value, not a table", key));
  }
  if (list)
    refuse(fmt::format("names no key of one of the tables of a list, as {}1.{} does",
                       std::string_view(name).substr(0, name.size() - rest.size()),
                       table_number(rest) ? "KEY" : rest));
  if (rest.empty())
    throw InputError({.file = "--set " + name},
                     "expected key=value, for example beam.length=\"0.9 m\"");
  try {
    toml::table parsed = toml::parse("value = " + value);
    table->insert_or_assign(rest, std::move(*parsed.get("value")));
  } catch (const toml::parse_error&) {
    table->insert_or_assign(rest, value);  // the shell took the quotes: a text
  }
}

void leave_out(toml::table& root, std::string_view name) {
  const std::size_t dot = name.rfind('.');
  toml::table* const table =
      dot == std::string_view::npos ? &root : root.at_path(name.substr(0, dot)).as_table();
  if (table) table->erase(name.substr(dot == std::string_view::npos ? 0 : dot + 1));
}

/// "contacts[0].gap" of "contacts.1.gap", as toml++ has it.
std::string with_indices(std::string_view key) {
  std::string path;
  while (!key.empty()) {
    const std::string_view word = key.substr(0, key.find('.'));
    key.remove_prefix(std::min(word.size() + 1, key.size()));
    if (const auto number = table_number(word))
      path += fmt::format("[{}]", *number - 1);
    else
      path += fmt::format("{}{}", path.empty() ? "" : ".", word);
  }
  return path;
}

/// Where a value that models::validate() refused stands: its message begins with the key.
datasets::SourcePosition position_of(const toml::table& document, const std::string& path,
                                     const std::set<std::string>& overridden,
                                     std::string_view message) {
  const std::string key(message.substr(0, message.find_first_of(": ")));
  if (const auto override = overriding_key(key, overridden)) return {.file = "--set " + *override};
  datasets::SourcePosition where{.file = path};
  if (const toml::node* node = document.at_path(with_indices(key)).node()) {
    where.line = node->source().begin.line;
    where.column = node->source().begin.column;
  }
  return where;
}

void read_environment(TableReader& environment, RigFile& file) {
  if (const auto gravity = environment.quantity("gravity", "m/s^2"))
    file.rig.gravity = gravity->value;
  if (const auto direction = environment.quantity("gravity_direction", "rad"))
    file.rig.gravity_direction = direction->value;
  if (const auto mains = environment.quantity("mains_frequency", "Hz")) {
    if (!(mains->value > 0.0)) environment.refuse("mains_frequency", "must be greater than zero");
    file.mains_frequency = mains->value;
  }
  environment.finish();
}

/// Hum is of the mains unless its step says otherwise.
std::vector<datasets::ConditioningStep> read_steps(TableReader& root, double mains_frequency) {
  std::vector<datasets::ConditioningStep> steps = read_conditioning(root);
  for (datasets::ConditioningStep& step : steps)
    if (auto* const hum = std::get_if<datasets::RemoveHum>(&step.action); hum && !hum->frequency)
      hum->frequency = mains_frequency;
  return steps;
}

TableReader required_table(TableReader& root, std::string_view key) {
  auto table = root.table(key);
  if (!table) root.refuse(key, fmt::format("the table [{}] is missing", key));
  return *table;
}

}  // namespace

RigFile parse_rig_file(const std::string& text, const std::string& path,
                       const std::vector<Override>& overrides,
                       const std::vector<std::string>& without) {
  RigFile file;
  file.path = path;
  toml::table document;
  try {
    document = toml::parse(text, path);
  } catch (const toml::parse_error& error) {
    throw InputError(
        {.file = path, .line = error.source().begin.line, .column = error.source().begin.column},
        fmt::format("not a TOML file: {}{}", error.description(),
                    error.description().find("redefine") != std::string_view::npos
                        ? "; a table and a key stand once in a file, lists of tables are [[name]]"
                        : ""));
  }
  for (const std::string& key : without) leave_out(document, key);
  std::set<std::string> overridden;
  for (const Override& override : overrides) {
    apply_override(document, override);
    overridden.insert(override.first);
  }
  std::ostringstream resolved;
  resolved << document;
  file.text = overrides.empty() && without.empty() ? text : resolved.str() + "\n";
  file.sha256 = datasets::sha256_of(file.text);

  TableReader root(document, path, "", overridden);
  root.integer("schema");
  root.text("title");
  TableReader beam = required_table(root, "beam");
  file.sections = read_beam(beam, file.rig);
  const std::vector<double> radii = surface_radii(file.sections);
  if (auto contact = root.table("contact")) {
    read_contact(*contact, file.rig.beam, radii, file.rig.contact);
  } else {
    file.rig.contact.law = file.rig.contact.damping = "none";
    file.rig.contact.position = file.rig.beam.length;
  }
  FurtherStops further = read_further_stops(root, file.rig.beam, radii);
  file.rig.further_stops = std::move(further.stops);
  file.inherited = std::move(further.inherited);
  put_on_bar(file.rig);
  if (auto hinge = root.table("hinge")) read_hinge(*hinge, file.rig.hinge);
  if (auto stop = root.table("stop")) file.rig.stop = read_stop(*stop);
  if (!file.rig.hinge.rotation || root.has("start")) {
    TableReader start = required_table(root, "start");
    read_start(start, file.rig.start);
  }
  if (auto environment = root.table("environment")) read_environment(*environment, file);
  file.solver.elements = models::split_elements(default_elements, file.rig);
  if (auto solver = root.table("solver"))
    read_solver(*solver, file);
  else
    file.solver.accuracy = default_accuracy;
  if (auto sensors = root.table("sensors")) read_sensors(*sensors, file);
  file.conditioning = read_steps(root, file.mains_frequency);
  if (auto fit = root.table("fit")) file.fit = read_fit(*fit);
  root.finish();
  file.remarks = remarks_on(document, file);
  try {
    models::validate(file.rig, file.solver);
  } catch (const std::invalid_argument& error) {
    throw InputError(position_of(document, path, overridden, error.what()), error.what());
  }
  return file;
}

const std::optional<datasets::Sensor>& sensor_of(const RigFile& rig, datasets::Quantity quantity) {
  if (quantity == datasets::Quantity::force) return rig.force;
  if (quantity == datasets::Quantity::velocity) return rig.velocity;
  return rig.displacement;
}

RigFile read_rig_file(const std::string& path, const std::vector<Override>& overrides,
                      const std::vector<std::string>& without) {
  if (std::filesystem::is_directory(path))
    throw datasets::FileError(path, "is a folder, not a rig file");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw datasets::FileError(path, "cannot be opened; is the name right?");
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) throw datasets::FileError(path, "cannot be read");
  return parse_rig_file(text.str(), path, overrides, without);
}

}  // namespace impactrig::fitting
