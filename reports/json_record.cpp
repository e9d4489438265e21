// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/record.hpp"

#include "reports/json_parts.hpp"

namespace impactrig::reports {

namespace {

datasets::Quantity quantity_from(const JsonReader& json) {
  const std::string name = json.text();
  const auto quantity = datasets::quantity_named(name);
  if (!quantity) json.fail("expected a quantity, found \"" + name + "\"");
  return *quantity;
}

/// All of a signal but its samples; those that were compared with the model are in "curves".
Json signal_json(const std::optional<datasets::ImpactSignal>& signal) {
  if (!signal) return nullptr;
  return {{"quantity", std::string(datasets::name(signal->quantity))},
          {"channel", signal->channel},
          {"start_s", signal->start},
          {"interval_s", signal->interval},
          {"noise", signal->noise},
          {"noise_correlation", signal->noise_correlation},
          {"baseline", signal->baseline},
          {"quantum", signal->quantum},
          {"gain_uncertainty", signal->gain_uncertainty},
          {"delay_s", signal->delay},
          {"delay_uncertainty_s", signal->delay_uncertainty}};
}

std::optional<datasets::ImpactSignal> signal_from(const JsonReader& impact,
                                                  const std::string& key) {
  if (!impact.has(key)) return std::nullopt;
  const JsonReader json = impact[key];
  datasets::ImpactSignal signal;
  signal.quantity = quantity_from(json["quantity"]);
  signal.channel = json["channel"].text();
  signal.start = json["start_s"].number();
  signal.interval = json["interval_s"].number();
  signal.noise = json["noise"].number();
  signal.noise_correlation = json["noise_correlation"].number();
  signal.baseline = json["baseline"].number();
  signal.quantum = json["quantum"].number();
  signal.gain_uncertainty = json["gain_uncertainty"].number();
  signal.delay = json["delay_s"].number();
  signal.delay_uncertainty = json["delay_uncertainty_s"].number();
  return signal;
}

datasets::ImpactFlag flag_from(const JsonReader& json) {
  const std::string name = json.text();
  if (const auto flag = datasets::flag_named(name)) return *flag;
  json.fail("no flag of an impact is called \"" + name + "\"");
}

Json channel_json(const datasets::Channel& channel, std::size_t samples) {
  Json json = {{"name", channel.name},
               {"quantity", std::string(datasets::name(channel.quantity))},
               {"unit", channel.unit},
               {"samples", samples},
               {"sample_rate_hz", 1.0 / channel.clock.interval},
               {"interval_s", channel.clock.interval},
               {"start_s", channel.clock.start},
               {"scale", channel.scale},
               {"offset", channel.offset},
               {"calibration", nullptr},
               {"delay", nullptr},
               {"attributes", channel.attributes}};
  if (channel.calibration)
    json["calibration"] = {{"sensitivity", channel.calibration->sensitivity},
                           {"uncertainty", channel.calibration->uncertainty},
                           {"recorded_unit", channel.calibration->recorded_unit},
                           {"physical_unit", channel.calibration->physical_unit},
                           {"source", channel.calibration->source}};
  if (channel.delay)
    json["delay"] = {{"value_s", channel.delay->value},
                     {"uncertainty_s", channel.delay->uncertainty},
                     {"removed", channel.delay->removed}};
  return json;
}

datasets::Channel channel_from(const JsonReader& json) {
  datasets::Channel channel;
  channel.name = json["name"].text();
  channel.quantity = quantity_from(json["quantity"]);
  channel.unit = json["unit"].text();
  channel.clock.interval = json["interval_s"].number();
  channel.clock.start = json["start_s"].number();
  channel.scale = json["scale"].number();
  channel.offset = json["offset"].number();
  channel.attributes = json["attributes"].text_map();
  if (json.has("calibration")) {
    const JsonReader calibration = json["calibration"];
    channel.calibration = datasets::Calibration{
        calibration["sensitivity"].number(), calibration["uncertainty"].number(),
        calibration["recorded_unit"].text(), calibration["physical_unit"].text(),
        calibration["source"].text()};
  }
  if (json.has("delay"))
    channel.delay =
        datasets::Delay{json["delay"]["value_s"].number(), json["delay"]["uncertainty_s"].number(),
                        json["delay"]["removed"].boolean()};
  return channel;
}

Json source_json(const datasets::Provenance& provenance) {
  Json edits = Json::array();
  for (const datasets::Edit& edit : provenance.edits)
    edits.push_back(
        {{"what", edit.what}, {"channel", edit.channel}, {"parameters", edit.parameters}});
  return {{"source_file", provenance.source_file}, {"bytes", provenance.bytes},
          {"sha256", provenance.sha256},           {"importer", provenance.importer},
          {"program", provenance.program},         {"edits", edits}};
}

datasets::Provenance source_from(const JsonReader& json) {
  datasets::Provenance provenance;
  provenance.source_file = json["source_file"].text();
  provenance.bytes = json["bytes"].count();
  provenance.sha256 = json["sha256"].text();
  provenance.importer = json["importer"].text();
  provenance.program = json["program"].text();
  const JsonReader edits = json["edits"];
  for (std::size_t i = 0; i < edits.size(); ++i) {
    const JsonReader edit = edits.element(i);
    provenance.edits.push_back(
        {edit["what"].text(), edit["channel"].text(), edit["parameters"].text_map()});
  }
  return provenance;
}

datasets::Rebound rebound_from(const JsonReader& json) {
  const double approach_error = json["approach_std_error_m_s"].number();
  if (json.has("absent"))
    return {.approach_error = approach_error, .absent = json["absent"].text()};
  return {.approach_error = approach_error,
          .from = json["from_s"].number(),
          .to = json["to_s"].number(),
          .velocity = json["velocity_m_s"].number(),
          .velocity_error = json["velocity_std_error_m_s"].number(),
          .restitution = json["restitution"].number(),
          .restitution_error = json["restitution_std_error"].number(),
          .absent = {}};
}

}  // namespace

Json rebound_json(const datasets::Rebound& rebound) {
  Json json = {{"approach_std_error_m_s", rebound.approach_error}};
  if (!rebound.absent.empty()) {
    json["absent"] = rebound.absent;
    return json;
  }
  json["from_s"] = rebound.from;
  json["to_s"] = rebound.to;
  json["velocity_m_s"] = rebound.velocity;
  json["velocity_std_error_m_s"] = rebound.velocity_error;
  json["restitution"] = rebound.restitution;
  json["restitution_std_error"] = rebound.restitution_error;
  json["restitution_ci95"] = rebound.restitution_ci95();
  return json;
}

Json impact_json(const datasets::Impact& impact) {
  Json flags = Json::array();
  for (const datasets::ImpactFlag flag : impact.flags)
    flags.push_back(std::string(datasets::name(flag)));
  Json json = {{"recording", impact.recording},
               {"start_s", impact.start},
               {"flags", flags},
               {"end_s", impact.end},
               {"peak", impact.peak},
               {"peak_time_s", impact.peak_time},
               {"width_s", impact.width},
               {"impulse", impact.impulse},
               {"approach_velocity_m_s", impact.approach_velocity},
               {"force", signal_json(impact.force)},
               {"velocity", signal_json(impact.velocity)},
               {"displacement", signal_json(impact.displacement)}};
  if (impact.rebound) json["rebound"] = rebound_json(*impact.rebound);
  return json;
}

datasets::Impact impact_from(const JsonReader& json) {
  datasets::Impact impact;
  impact.recording = json["recording"].text();
  impact.start = json["start_s"].number();
  impact.end = json["end_s"].number();
  impact.peak = json["peak"].number();
  impact.peak_time = json["peak_time_s"].number();
  impact.width = json["width_s"].number();
  impact.impulse = json["impulse"].number();
  impact.approach_velocity = json["approach_velocity_m_s"].number();
  impact.force = signal_from(json, "force");
  impact.velocity = signal_from(json, "velocity");
  impact.displacement = signal_from(json, "displacement");
  if (json.has("rebound")) impact.rebound = rebound_from(json["rebound"]);
  const JsonReader flags = json["flags"];
  for (std::size_t i = 0; i < flags.size(); ++i)
    impact.flags.push_back(flag_from(flags.element(i)));
  return impact;
}

Json record_json(const datasets::Record& record, const std::vector<std::size_t>& counts) {
  Json channels = Json::array();
  for (std::size_t c = 0; c < record.channels.size(); ++c) {
    const datasets::Channel& channel = record.channels[c];
    const bool known = channel.size() == 0 && c < counts.size();
    channels.push_back(channel_json(channel, known ? counts[c] : channel.size()));
  }
  return {{"title", record.title},       {"started", record.started},
          {"channels", channels},        {"provenance", source_json(record.provenance)},
          {"warnings", record.warnings}, {"attributes", record.attributes}};
}

datasets::Record record_from(const JsonReader& json, std::vector<std::size_t>& counts) {
  datasets::Record record;
  record.title = json["title"].text();
  record.started = json["started"].text();
  const JsonReader channels = json["channels"];
  for (std::size_t c = 0; c < channels.size(); ++c) {
    record.channels.push_back(channel_from(channels.element(c)));
    counts.push_back(channels.element(c)["samples"].count());
  }
  record.provenance = source_from(json["provenance"]);
  record.warnings = json["warnings"].texts();
  record.attributes = json["attributes"].text_map();
  return record;
}

Json provenance_json(const ResultProvenance& provenance) {
  Json inputs = Json::array();
  for (const InputFile& input : provenance.inputs)
    inputs.push_back({{"name", input.name}, {"bytes", input.bytes}, {"sha256", input.sha256}});
  return {{"tool", provenance.tool},
          {"version", provenance.version},
          {"git", provenance.git},
          {"build", provenance.build},
          {"command", provenance.command},
          {"config", provenance.config},
          {"config_sha256", provenance.config_sha256},
          {"inputs", inputs},
          {"started", provenance.started},
          {"wall_s", provenance.wall_s},
          {"host", provenance.host},
          {"result_key", provenance.result_key}};
}

ResultProvenance provenance_from(const JsonReader& json) {
  ResultProvenance provenance;
  provenance.tool = json["tool"].text();
  provenance.version = json["version"].text();
  provenance.git = json["git"].text();
  provenance.build = json["build"].text();
  provenance.command = json["command"].texts();
  provenance.config = json["config"].text();
  provenance.config_sha256 = json["config_sha256"].text();
  const JsonReader inputs = json["inputs"];
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const JsonReader input = inputs.element(i);
    provenance.inputs.push_back(
        {input["name"].text(), input["bytes"].count(), input["sha256"].text()});
  }
  provenance.started = json["started"].text();
  provenance.wall_s = json["wall_s"].number();
  provenance.host = json["host"].text();
  provenance.result_key = json["result_key"].text();
  return provenance;
}

}  // namespace impactrig::reports
