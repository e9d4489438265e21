// SPDX-License-Identifier: BSD-3-Clause
#include "reports/json_parts.hpp"

namespace impactrig::reports {

namespace {

Json or_null(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

std::optional<double> if_stated(const JsonReader& json, const std::string& key) {
  if (!json.has(key)) return std::nullopt;
  return json[key].number();
}

Json contact_json(const models::Contact& contact) {
  const char* counterface = contact.counterface == models::Counterface::groove     ? "groove"
                            : contact.counterface == models::Counterface::cylinder ? "cylinder"
                                                                                   : "plane";
  return {{"position_m", contact.position},
          {"counterface", counterface},
          {"radius_m", contact.radius},
          {"counter_radius_m", contact.counter_radius},
          {"counter_depth_m", contact.counter_depth},
          {"length_m", contact.length},
          {"modulus_pa", contact.modulus},
          {"poisson_ratio", contact.poisson_ratio},
          {"counter_modulus_pa", contact.counter_modulus},
          {"counter_poisson_ratio", contact.counter_poisson_ratio},
          {"law", contact.law},
          {"exponent", contact.exponent},
          {"reference_length_m", or_null(contact.reference_length)},
          {"stiffness_n_m", contact.stiffness},
          {"power", contact.power},
          {"stiffness_factor", contact.stiffness_factor},
          {"damping", contact.damping},
          {"restitution", contact.restitution},
          {"restitution_speed_m_s", or_null(contact.restitution_speed)},
          {"viscous_n_s_m", or_null(contact.viscous)},
          {"relaxation_time_s", or_null(contact.relaxation_time)},
          {"effective_mass_kg", or_null(contact.effective_mass)},
          {"tension", contact.tension == models::Tension::clip ? "clip" : "allow"}};
}

models::Contact contact_from(const JsonReader& json) {
  models::Contact contact;
  contact.position = json["position_m"].number();
  const std::string counterface = json["counterface"].text();
  if (counterface == "groove")
    contact.counterface = models::Counterface::groove;
  else if (counterface == "cylinder")
    contact.counterface = models::Counterface::cylinder;
  else if (counterface == "plane")
    contact.counterface = models::Counterface::plane;
  else
    json["counterface"].fail("expected groove, cylinder or plane, found \"" + counterface + "\"");
  contact.radius = json["radius_m"].number();
  contact.counter_radius = json["counter_radius_m"].number();
  contact.length = json["length_m"].number();
  contact.modulus = json["modulus_pa"].number();
  contact.poisson_ratio = json["poisson_ratio"].number();
  contact.counter_modulus = json["counter_modulus_pa"].number();
  contact.counter_poisson_ratio = json["counter_poisson_ratio"].number();
  contact.law = json["law"].text();
  contact.exponent = static_cast<int>(json["exponent"].integer());
  contact.stiffness = json["stiffness_n_m"].number();
  contact.stiffness_factor = json["stiffness_factor"].number();
  contact.damping = json["damping"].text();
  contact.restitution = json["restitution"].number();
  contact.counter_depth = if_stated(json, "counter_depth_m").value_or(0.0);
  contact.power = if_stated(json, "power").value_or(1.0);
  contact.reference_length = if_stated(json, "reference_length_m");
  contact.restitution_speed = if_stated(json, "restitution_speed_m_s");
  contact.viscous = if_stated(json, "viscous_n_s_m");
  contact.relaxation_time = if_stated(json, "relaxation_time_s");
  contact.effective_mass = if_stated(json, "effective_mass_kg");
  if (json.has("tension") && json["tension"].text() == "allow")
    contact.tension = models::Tension::allow;
  return contact;
}

Json band_json(const std::optional<datasets::BandLimit>& band) {
  if (!band) return nullptr;
  return {{"frequency_hz", band->frequency}, {"order", band->order}};
}

std::optional<datasets::BandLimit> band_from(const JsonReader& json, const std::string& key) {
  if (!json.has(key)) return std::nullopt;
  return datasets::BandLimit{json[key]["frequency_hz"].number(),
                             static_cast<int>(json[key]["order"].integer())};
}

/// `struck`: where the bar is [m].
Json sensor_json(const std::optional<datasets::Sensor>& sensor, double struck) {
  if (!sensor) return nullptr;
  Json json = {{"quantity", std::string(datasets::name(sensor->quantity))},
               {"channel", sensor->channel},
               {"sensitivity", nullptr},
               {"sensitivity_uncertainty", nullptr},
               {"recorded_unit", sensor->recorded_unit},
               {"polarity", sensor->polarity},
               {"position_m", sensor->position > 0.0 ? sensor->position : struck},
               {"resonance", nullptr},
               {"low_cut", band_json(sensor->low_cut)},
               {"high_cut", band_json(sensor->high_cut)},
               {"delay_s", sensor->delay.value},
               {"delay_uncertainty_s", sensor->delay.uncertainty},
               {"delay_removed", sensor->delay.removed},
               {"range", sensor->range}};
  if (sensor->sensitivity) {
    json["sensitivity"] = sensor->sensitivity->value;
    json["sensitivity_uncertainty"] = sensor->sensitivity->uncertainty;
  }
  if (sensor->resonance)
    json["resonance"] = {{"frequency_hz", sensor->resonance->frequency},
                         {"quality", sensor->resonance->quality}};
  return json;
}

std::optional<datasets::Sensor> sensor_from(const JsonReader& sensors, const std::string& key) {
  if (!sensors.has(key)) return std::nullopt;
  const JsonReader json = sensors[key];
  datasets::Sensor sensor;
  const std::string quantity = json["quantity"].text();
  const auto named = datasets::quantity_named(quantity);
  if (!named) json["quantity"].fail("expected a quantity, found \"" + quantity + "\"");
  sensor.quantity = *named;
  sensor.channel = json["channel"].text();
  if (json.has("sensitivity"))
    sensor.sensitivity = datasets::UncertainValue{json["sensitivity"].number(),
                                                  json["sensitivity_uncertainty"].number()};
  sensor.recorded_unit = json["recorded_unit"].text();
  sensor.polarity = json["polarity"].number();
  sensor.position = json["position_m"].number();
  if (json.has("resonance"))
    sensor.resonance = datasets::Resonance{json["resonance"]["frequency_hz"].number(),
                                           json["resonance"]["quality"].number()};
  sensor.low_cut = band_from(json, "low_cut");
  sensor.high_cut = band_from(json, "high_cut");
  sensor.delay = {json["delay_s"].number(), json["delay_uncertainty_s"].number(),
                  json["delay_removed"].boolean()};
  sensor.range = json["range"].number();
  return sensor;
}

Json masses_json(const std::vector<models::LumpedMass>& masses) {
  Json json = Json::array();
  for (const models::LumpedMass& lump : masses)
    json.push_back({{"position_m", lump.position}, {"mass_kg", lump.mass}});
  return json;
}

std::vector<models::LumpedMass> masses_from(const JsonReader& json) {
  std::vector<models::LumpedMass> masses;
  for (std::size_t i = 0; i < json.size(); ++i)
    masses.push_back({.position = json.element(i)["position_m"].number(),
                      .mass = json.element(i)["mass_kg"].number()});
  return masses;
}

Json segments_json(const std::vector<models::BeamSegment>& segments) {
  Json json = Json::array();
  const auto maybe = [](const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
  };
  for (const models::BeamSegment& segment : segments)
    json.push_back({{"length_m", segment.length},
                    {"area_m2", segment.area},
                    {"second_moment_m4", segment.second_moment},
                    {"shear_coefficient", segment.shear_coefficient},
                    {"youngs_modulus_pa", maybe(segment.youngs_modulus)},
                    {"density_kg_m3", maybe(segment.density)}});
  return json;
}

std::vector<models::BeamSegment> segments_from(const JsonReader& json) {
  std::vector<models::BeamSegment> segments;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const JsonReader element = json.element(i);
    models::BeamSegment& segment = segments.emplace_back();
    segment.length = element["length_m"].number();
    segment.area = element["area_m2"].number();
    segment.second_moment = element["second_moment_m4"].number();
    segment.shear_coefficient = element["shear_coefficient"].number();
    if (element.has("youngs_modulus_pa"))
      segment.youngs_modulus = element["youngs_modulus_pa"].number();
    if (element.has("density_kg_m3")) segment.density = element["density_kg_m3"].number();
  }
  return segments;
}

Json hinge_json(const models::Hinge& hinge) {
  Json json = {{"spring_n_m_rad", hinge.spring},
               {"viscous_n_m_s_rad", hinge.viscous},
               {"friction_n_m", hinge.friction}};
  if (hinge.rotation)
    json["rotation"] = {{"rate_rad_s", hinge.rotation->rate}, {"time_s", hinge.rotation->time}};
  return json;
}

models::Hinge hinge_from(const JsonReader& json) {
  models::Hinge hinge{.spring = json["spring_n_m_rad"].number(),
                      .viscous = json["viscous_n_m_s_rad"].number()};
  if (json.has("friction_n_m")) hinge.friction = json["friction_n_m"].number();
  if (json.has("rotation"))
    hinge.rotation = {.rate = json["rotation"]["rate_rad_s"].number(),
                      .time = json["rotation"]["time_s"].number()};
  return hinge;
}

Json stop_json(const std::optional<models::Stop>& stop) {
  if (!stop) return nullptr;
  return {{"mass_kg", stop->mass},
          {"stiffness_n_m", stop->stiffness},
          {"viscous_n_s_m", stop->viscous}};
}

models::Stop stop_from(const JsonReader& json) {
  return {.mass = json["mass_kg"].number(),
          .stiffness = json["stiffness_n_m"].number(),
          .viscous = json["viscous_n_s_m"].number()};
}

Json further_stops_json(const std::vector<models::FurtherStop>& stops) {
  Json json = Json::array();
  for (const models::FurtherStop& stop : stops)
    json.push_back(
        {{"side", name(stop.side)}, {"gap_m", stop.gap}, {"contact", contact_json(stop.contact)}});
  return json;
}

std::vector<models::FurtherStop> further_stops_from(const JsonReader& json) {
  std::vector<models::FurtherStop> stops;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const JsonReader element = json.element(i);
    const bool far = element["side"].text() == name(models::StopSide::far);
    stops.push_back({.contact = contact_from(element["contact"]),
                     .side = far ? models::StopSide::far : models::StopSide::near,
                     .gap = element["gap_m"].number()});
  }
  return stops;
}

}  // namespace

Json rig_json(const fitting::RigFile& rig) {
  const models::Beam& beam = rig.rig.beam;
  const models::Start& start = rig.rig.start;
  return {
      {"path", rig.path},
      {"sha256", rig.sha256},
      {"beam",
       {{"length_m", beam.length},
        {"area_m2", beam.area},
        {"second_moment_m4", beam.second_moment},
        {"youngs_modulus_pa", beam.youngs_modulus},
        {"density_kg_m3", beam.density},
        {"theory", name(beam.theory)},
        {"poisson_ratio", beam.poisson_ratio},
        {"shear_coefficient", beam.shear_coefficient},
        {"segments", segments_json(beam.segments)},
        {"masses", masses_json(beam.masses)},
        {"damping", {{"mass_1_s", beam.damping.mass}, {"stiffness_s", beam.damping.stiffness}}}}},
      {"contact", contact_json(rig.rig.contact)},
      {"contacts", further_stops_json(rig.rig.further_stops)},
      {"start",
       {{"velocity_m_s", start.velocity},
        {"release_angle_rad", start.release_angle ? Json(*start.release_angle) : Json(nullptr)}}},
      {"hinge", hinge_json(rig.rig.hinge)},
      {"stop", stop_json(rig.rig.stop)},
      {"gravity_m_s2", rig.rig.gravity},
      {"gravity_direction_rad", rig.rig.gravity_direction},
      {"sensors",
       {{"force", sensor_json(rig.force, rig.rig.contact.position)},
        {"velocity", sensor_json(rig.velocity, rig.rig.contact.position)},
        {"displacement", sensor_json(rig.displacement, rig.rig.contact.position)}}},
      {"solver", solver_json(rig.solver)},
      {"mesh_stated", rig.mesh_stated},
      {"text", rig.text}};
}

fitting::RigFile rig_from(const JsonReader& json) {
  fitting::RigFile rig;
  rig.path = json["path"].text();
  rig.sha256 = json["sha256"].text();
  rig.text = json["text"].text();
  const JsonReader beam = json["beam"];
  rig.rig.beam = {beam["length_m"].number(), beam["area_m2"].number(),
                  beam["second_moment_m4"].number(), beam["youngs_modulus_pa"].number(),
                  beam["density_kg_m3"].number()};
  if (beam.has("damping"))
    rig.rig.beam.damping = {.mass = beam["damping"]["mass_1_s"].number(),
                            .stiffness = beam["damping"]["stiffness_s"].number()};
  if (beam.has("theory")) {
    if (beam["theory"].text() == name(models::BeamTheory::timoshenko))
      rig.rig.beam.theory = models::BeamTheory::timoshenko;
    rig.rig.beam.poisson_ratio = beam["poisson_ratio"].number();
    rig.rig.beam.shear_coefficient = beam["shear_coefficient"].number();
  }
  if (beam.has("segments")) rig.rig.beam.segments = segments_from(beam["segments"]);
  if (beam.has("masses")) rig.rig.beam.masses = masses_from(beam["masses"]);
  rig.rig.contact = contact_from(json["contact"]);
  if (json.has("contacts")) rig.rig.further_stops = further_stops_from(json["contacts"]);
  rig.rig.start.velocity = json["start"]["velocity_m_s"].number();
  if (json["start"].has("release_angle_rad"))
    rig.rig.start.release_angle = json["start"]["release_angle_rad"].number();
  if (json.has("hinge")) rig.rig.hinge = hinge_from(json["hinge"]);
  if (json.has("stop")) rig.rig.stop = stop_from(json["stop"]);
  rig.rig.gravity = json["gravity_m_s2"].number();
  if (json.has("gravity_direction_rad"))
    rig.rig.gravity_direction = json["gravity_direction_rad"].number();
  rig.force = sensor_from(json["sensors"], "force");
  rig.velocity = sensor_from(json["sensors"], "velocity");
  rig.displacement = sensor_from(json["sensors"], "displacement");
  rig.solver = solver_from(json["solver"]);
  rig.mesh_stated = json["mesh_stated"].boolean();
  return rig;
}

}  // namespace impactrig::reports
