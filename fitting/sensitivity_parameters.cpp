// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/sensitivity_parameters.hpp"

#include <ceres/jet.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "fitting/parameters.hpp"

namespace impactrig::fitting {
namespace {

/// By one number of a section, or of the bar's material.
using Jet = ceres::Jet<double, 1>;

struct Dimension {
  std::string_view name;
  double Section<>::*of;
  Jet Section<Jet>::*as_jet;
};

constexpr std::array dimensions = {
    Dimension{"radius", &Section<>::radius, &Section<Jet>::radius},
    Dimension{"wall", &Section<>::wall, &Section<Jet>::wall},
    Dimension{"width", &Section<>::width, &Section<Jet>::width},
    Dimension{"height", &Section<>::height, &Section<Jet>::height},
};

constexpr std::string_view poisson_ratio = "beam.poisson_ratio";

struct Spot {
  std::string_view name;
  std::optional<datasets::Sensor> RigFile::*sensor;
  models::Laser laser;
};

constexpr std::array spots = {
    Spot{"sensors.velocity.position", &RigFile::velocity, models::Laser::velocity},
    Spot{"sensors.displacement.position", &RigFile::displacement, models::Laser::displacement},
};

/// The section of segment K, from 1, or of a uniform bar, 0: before the names of its numbers.
std::string section_key(int segment) {
  return segment == 0 ? "beam.section." : fmt::format("beam.segments.{}.section.", segment);
}

/// Those that a fit frees and those that it does not.
std::vector<PhysicalParameter> numbers_of_rigs() {
  const auto fitted = physical_parameters(), stated = stated_parameters();
  std::vector<PhysicalParameter> known(fitted.begin(), fitted.end());
  known.insert(known.end(), stated.begin(), stated.end());
  return known;
}

std::vector<std::string> known_names() {
  std::vector<std::string> names;
  for (const PhysicalParameter& parameter : numbers_of_rigs()) names.emplace_back(parameter.name);
  for (int segment = 0; segment <= most_numbered; ++segment)
    for (const Dimension& dimension : dimensions)
      names.push_back(section_key(segment) + std::string(dimension.name));
  names.emplace_back(poisson_ratio);
  for (const Spot& spot : spots) names.emplace_back(spot.name);
  return names;
}

/// Of what a rig has not, reading makes it; without a stop its contact is none.
bool has(const models::Rig& rig, const PhysicalParameter& parameter) {
  models::Rig copy = rig;
  parameter.of(copy);
  return copy == rig && (rig.has_stop() || !parameter.name.starts_with("contact."));
}

models::RigParameter number_of_rig(std::string_view name) {
  const std::vector<PhysicalParameter> all = numbers_of_rigs();
  return std::ranges::find(all, name, &PhysicalParameter::name)->of;
}

Section<Jet> as_jets(const Section<>& section) {
  Section<Jet> jets;
  jets.shape = section.shape;
  for (const Dimension& dimension : dimensions) jets.*dimension.as_jet = Jet(section.*dimension.of);
  return jets;
}

/// What the slopes of a section's numbers are to the rig.
std::vector<SensitivityParameter::Part> parts_of(const SectionNumbers<Jet>& numbers, int segment,
                                                 bool with_shear_coefficient) {
  const std::string key = section_key(segment);
  const std::string of_bar = key.substr(0, key.rfind("section."));
  std::vector<SensitivityParameter::Part> parts;
  const auto add = [&](const std::string& name, const Jet& number) {
    if (number.v[0] != 0.0) parts.push_back({number_of_rig(name), number.v[0]});
  };
  add(key + "area", numbers.area);
  add(key + "second_moment", numbers.second_moment);
  if (with_shear_coefficient) add(of_bar + "shear_coefficient", numbers.shear_coefficient);
  return parts;
}

/// Whether κ is that of the shape.
bool shape_tells_shear(const RigFile& file, const Section<>& section) {
  return file.rig.beam.shears() && section.shape != SectionShape::stated &&
         !section.shear_coefficient_stated;
}

void add_dimensions(const RigFile& file, int segment, const Section<>& section,
                    std::vector<SensitivityParameter>& to) {
  for (const Dimension& dimension : dimensions) {
    const double size = section.*dimension.of;
    if (size == 0.0) continue;
    Section<Jet> jets = as_jets(section);
    (jets.*dimension.as_jet).v[0] = 1.0;
    to.push_back({section_key(segment) + std::string(dimension.name), "m", size,
                  parts_of(jets.numbers(Jet(file.rig.beam.poisson_ratio)), segment,
                           shape_tells_shear(file, section))});
  }
}

/// Segments by their numbers, from 1; a uniform bar's section by 0.
template <typename Visitor>
void for_each_section(const RigFile& file, const Visitor& visit) {
  const bool uniform = file.rig.beam.segments.empty();
  for (std::size_t i = 0; i < file.sections.size() && i < most_numbered; ++i)
    visit(uniform ? 0 : static_cast<int>(i) + 1, file.sections[i]);
}

/// Of a bar that shears: by its shear modulus and by the sections' shear coefficients.
SensitivityParameter by_poisson_ratio(const RigFile& file) {
  const double value = file.rig.beam.poisson_ratio;
  SensitivityParameter parameter{std::string(poisson_ratio), "1", value, {}};
  parameter.parts.push_back(
      {[](models::Rig& rig) -> double& { return rig.beam.poisson_ratio; }, 1.0});
  for_each_section(file, [&](int segment, const Section<>& section) {
    if (!shape_tells_shear(file, section)) return;
    for (const auto& part : parts_of(as_jets(section).numbers(Jet(value, 0)), segment, true))
      parameter.parts.push_back(part);
  });
  return parameter;
}

/// All that the rig has.
std::vector<SensitivityParameter> numbers_of(const RigFile& file) {
  std::vector<SensitivityParameter> all;
  models::Rig rig = file.rig;
  for (const PhysicalParameter& parameter : numbers_of_rigs())
    if (has(file.rig, parameter))
      all.push_back({std::string(parameter.name),
                     unit_in(rig, parameter),
                     parameter.of(rig),
                     {{parameter.of, 1.0}}});
  for_each_section(file, [&](int segment, const Section<>& section) {
    add_dimensions(file, segment, section, all);
  });
  if (rig.beam.shears()) all.push_back(by_poisson_ratio(file));
  for (const Spot& spot : spots)
    if (const std::optional<datasets::Sensor>& sensor = file.*spot.sensor)
      all.push_back({std::string(spot.name),
                     "m",
                     sensor->position > 0.0 ? sensor->position : file.rig.contact.position,
                     {},
                     spot.laser});
  return all;
}

/// Of numbered ones the first stands for all.
std::string sentence_on_names(const std::string& unknown) {
  std::string known;
  for (const std::string& name : known_names()) {
    const std::size_t digit = name.find_first_of("0123456789");
    if (digit == std::string::npos || name[digit] == '1') known += fmt::format("{}, ", name);
  }
  return fmt::format(
      "'{}' is no number of a rig to differentiate by; they are {}the same of masses and segments "
      "2 to {} and of contacts 2 and 3, or all",
      unknown, known, most_numbered);
}

}  // namespace

std::vector<SensitivityParameter> sensitivity_parameters(const RigFile& file,
                                                         const std::vector<std::string>& names) {
  std::vector<SensitivityParameter> all = numbers_of(file);
  if (names.size() == 1 && names.front() == "all") {
    std::erase_if(all, [](const SensitivityParameter& each) { return each.value == 0.0; });
    return all;
  }
  std::vector<SensitivityParameter> chosen;
  const std::vector<std::string> known = known_names();
  for (const std::string& name : names) {
    if (std::ranges::find(known, name) == known.end())
      throw std::invalid_argument(sentence_on_names(name));
    if (std::ranges::find(chosen, name, &SensitivityParameter::name) != chosen.end())
      throw std::invalid_argument(fmt::format("'{}' is named twice", name));
    const auto found = std::ranges::find(all, name, &SensitivityParameter::name);
    if (found == all.end())
      throw std::invalid_argument(fmt::format("'{}' is nothing that this rig has", name));
    chosen.push_back(*found);
  }
  return chosen;
}

}  // namespace impactrig::fitting
