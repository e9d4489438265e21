// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "datasets/input_error.hpp"
#include "reports/json_parts.hpp"
#include "reports/report_data.hpp"

namespace impactrig::reports {

namespace {

constexpr const char* schema = "impactrig/fit/1";

Json parameter_json(const fitting::Parameter& parameter) {
  return {{"name", parameter.name},
          {"value", parameter.value},
          {"unit", parameter.unit},
          {"std_error", parameter.std_error},
          {"ci95", pair_json(parameter.ci95)},
          {"initial", parameter.initial},
          {"at_bound", parameter.at_bound},
          {"contradicts_prior", parameter.contradicts_prior},
          {"mesh_shift", parameter.mesh_shift},
          {"mesh_error", parameter.mesh_error},
          {"lower", parameter.lower},
          {"upper", parameter.upper},
          {"prior", parameter.prior ? pair_json(*parameter.prior) : Json(nullptr)},
          {"nuisance", parameter.nuisance},
          {"identifiable", parameter.identifiable},
          {"scale", parameter.by_logarithm ? "log" : "linear"},
          {"tied_to", parameter.tied_to.empty() ? Json(nullptr) : Json(parameter.tied_to)}};
}

/// Fits were stored with zeros for what is not identifiable: as if it were perfectly known.
void forget_interval(fitting::Parameter& parameter) {
  parameter.std_error = parameter.mesh_shift = parameter.mesh_error = parameter.ci95[0] =
      parameter.ci95[1] = std::numeric_limits<double>::quiet_NaN();
}

fitting::Parameter parameter_from(const JsonReader& json) {
  constexpr double mesh_error_once = 1.1;  // of fits that were kept without it
  constexpr double infinity = std::numeric_limits<double>::infinity();
  fitting::Parameter parameter;
  parameter.name = json["name"].text();
  parameter.unit = json["unit"].text();
  parameter.value = json["value"].number();
  parameter.std_error = json["std_error"].number();
  parameter.ci95 = json["ci95"].pair();
  parameter.initial = json["initial"].number();
  parameter.lower = json["lower"].number_or(-infinity);
  parameter.upper = json["upper"].number_or(infinity);
  parameter.at_bound = json["at_bound"].boolean();
  if (json.has("contradicts_prior"))
    parameter.contradicts_prior = json["contradicts_prior"].boolean();
  if (json.states("mesh_shift")) parameter.mesh_shift = json["mesh_shift"].number();
  parameter.mesh_error = json.states("mesh_error")
                             ? json["mesh_error"].number()
                             : mesh_error_once * std::abs(parameter.mesh_shift);
  parameter.identifiable = json["identifiable"].boolean();
  if (!parameter.identifiable) forget_interval(parameter);
  parameter.nuisance = json["nuisance"].boolean();
  if (json.has("scale")) parameter.by_logarithm = json["scale"].text() == "log";
  if (json.has("tied_to")) parameter.tied_to = json["tied_to"].text();
  if (json.has("prior")) parameter.prior = json["prior"].pair();
  return parameter;
}

Json correlations_json(const Eigen::MatrixXd& correlations) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < correlations.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < correlations.cols(); ++j) row.push_back(correlations(i, j));
    rows.push_back(std::move(row));
  }
  return rows;
}

Eigen::MatrixXd correlations_from(const JsonReader& json, std::size_t parameters) {
  if (json.size() != 0 && json.size() != parameters)
    json.fail(fmt::format("expected {} rows, one a parameter, found {}", parameters, json.size()));
  const auto n = static_cast<Eigen::Index>(json.size());
  Eigen::MatrixXd correlations(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const JsonReader row = json.element(static_cast<std::size_t>(i));
    const std::vector<double> numbers = row.numbers();
    if (numbers.size() != json.size())
      row.fail(fmt::format("expected {} numbers, found {}", json.size(), numbers.size()));
    for (Eigen::Index j = 0; j < n; ++j) correlations(i, j) = numbers[static_cast<std::size_t>(j)];
  }
  return correlations;
}

/// "force"; "force[2]" for the second of several recordings.
std::string channel_name(const fitting::Fit& fit, const fitting::ChannelFit& channel) {
  return fit.impacts.size() < 2 ? channel.quantity
                                : fmt::format("{}[{}]", channel.quantity, channel.recording + 1);
}

void add_channels(Json& json, const fitting::Fit& fit) {
  json["channels"] = Json::array();
  for (const fitting::ChannelFit& channel : fit.channels)
    json["channels"].push_back(
        {{"name", channel_name(fit, channel)},
         {"residual_rms", channel.residual_rms},
         {"unit", channel.unit},
         {"noise", channel.noise},
         {"quantity", channel.quantity},
         {"channel", channel.channel},
         {"recording", channel.recording},
         {"diagnostics",
          channel.diagnostics ? diagnostics_json(*channel.diagnostics) : Json(nullptr)}});
}

void add_curves(Json& json, const fitting::Fit& fit) {
  json["curves"] = Json::array();
  for (const fitting::ChannelFit& channel : fit.channels) {
    json["curves"].push_back({{"name", channel_name(fit, channel)},
                              {"unit", channel.unit},
                              {"time_s", channel.time},
                              {"measured", channel.measured},
                              {"model", channel.model},
                              {"used", channel.used}});
    if (channel.every > 1) json["curves"].back()["every"] = channel.every;
  }
}

fitting::ChannelFit channel_from(const JsonReader& json, const JsonReader& curve,
                                 const JsonReader& metrics, std::size_t recordings) {
  fitting::ChannelFit channel;
  channel.quantity = json["quantity"].text();
  channel.channel = json["channel"].text();
  channel.unit = json["unit"].text();
  channel.recording = static_cast<int>(json["recording"].integer());
  if (channel.recording < 0 || static_cast<std::size_t>(channel.recording) >= recordings)
    json["recording"].fail(fmt::format("expected the index of one of {} impacts, found {}",
                                       recordings, channel.recording));
  channel.residual_rms = json["residual_rms"].number();
  channel.noise = json["noise"].number();
  if (json.has("diagnostics")) channel.diagnostics = diagnostics_from(json["diagnostics"]);
  channel.time = curve["time_s"].numbers();
  channel.measured = curve["measured"].numbers();
  channel.model = curve["model"].numbers();
  for (const double used : curve["used"].numbers()) channel.used.push_back(used != 0.0 ? 1 : 0);
  if (curve.has("every")) {
    const long every = curve["every"].integer();
    if (every < 1) curve["every"].fail(fmt::format("expected 1 or more, found {}", every));
    channel.every = static_cast<std::size_t>(every);
  }
  const std::size_t samples = channel.time.size();
  if (channel.measured.size() != samples || channel.model.size() != samples ||
      channel.used.size() != samples)
    curve.fail(fmt::format(
        "time_s, measured, model and used must be of one length, found {}, {}, {} and {}", samples,
        channel.measured.size(), channel.model.size(), channel.used.size()));
  const std::string name = json["name"].text();
  if (metrics.has(name)) channel.metrics = metrics[name].number_map();
  return channel;
}

Json goodness_json(const fitting::Goodness& goodness) {
  return {
      {"chi2", goodness.chi2},
      {"dof", goodness.dof},
      {"unknowns", goodness.unknowns},
      {"aicc", goodness.aicc},
      {"bic", goodness.bic},
      {"reduced_chi2",
       goodness.dof > 0 ? Json(goodness.chi2 / static_cast<double>(goodness.dof)) : Json(nullptr)}};
}

Json predictions_json(const fitting::Fit& fit) {
  Json predictions = Json::array();
  for (const models::Simulation& prediction : fit.predictions) {
    Json json = simulation_json(prediction, fit.rig.rig.contact);
    json["history"] = history_json(prediction.history);
    predictions.push_back(std::move(json));
  }
  return predictions;
}

/// The four of the design page in its order, then whatever else there is.
void add_restitution(Json& json, const fitting::Fit& fit) {
  Json& restitution = json["restitution"] = Json::object();
  for (const auto* key : {"law", "kinematic", "kinetic", "energetic"})
    if (fit.restitution.count(key) != 0) restitution[key] = nullptr;
  for (const auto& [key, estimate] : fit.restitution)
    restitution[key] = {{"value", estimate.value}, {"ci95", pair_json(estimate.ci95)}};
}

Json report_json(const ReportData& data) {
  const fitting::Fit& fit = data.fit;
  Json json;
  json["schema"] = schema;
  json["title"] = data.title;
  json["parameters"] = Json::array();
  for (const fitting::Parameter& parameter : fit.parameters)
    json["parameters"].push_back(parameter_json(parameter));
  json["correlations"] = correlations_json(fit.correlations);
  json["not_identifiable"] = fit.not_identifiable;
  json["identifiability"] = identifiability_json(fit.identifiability);
  add_channels(json, fit);
  json["loss"] = fitting::name(fit.loss);
  json["goodness"] = goodness_json(fit.goodness);
  json["metrics"] = Json::object();
  for (const fitting::ChannelFit& channel : fit.channels)
    json["metrics"][channel_name(fit, channel)] = channel.metrics;
  add_restitution(json, fit);
  json["profiles"] = Json::array();
  for (const fitting::Profile& profile : fit.profiles)
    json["profiles"].push_back(profile_json(profile));
  json["bootstrap"] = fit.bootstrap ? bootstrap_json(*fit.bootstrap) : Json(nullptr);
  json["models"] = data.models ? models_json(*data.models) : Json(nullptr);
  json["impacts"] = Json::array();
  for (const datasets::Impact& impact : fit.impacts) json["impacts"].push_back(impact_json(impact));
  json["direct_restitution"] = Json::array();
  for (std::size_t r = 0; r < fit.direct.size(); ++r)
    json["direct_restitution"].push_back(
        direct_json(fit.direct[r], r < fit.impacts.size() ? fit.impacts[r].recording : ""));
  json["window_s"] = fit.window;
  json["termination"] = fit.termination;
  json["warnings"] = fit.warnings;
  json["iterations"] = fit.iterations;
  json["simulations"] = fit.simulations;
  json["fit_s"] = fit.seconds;
  json["judging_s"] = fit.judging_seconds;
  json["predictions"] = predictions_json(fit);
  json["rig"] = rig_json(fit.rig);
  json["records"] = Json::array();
  for (std::size_t r = 0; r < data.records.size(); ++r)
    json["records"].push_back(record_json(data.records[r], r < data.sample_counts.size()
                                                               ? data.sample_counts[r]
                                                               : std::vector<std::size_t>{}));
  json["provenance"] = provenance_json(data.provenance);
  add_curves(json, fit);
  return json;
}

/// One member a line, and one line an element where the elements are objects: a reader finds his
/// way, a line-wise diff makes sense, and curves stay short.
std::string laid_out(const Json& json) {
  std::string out = "{";
  for (const auto& [key, value] : json.items()) {
    out += out.size() == 1 ? "\n" : ",\n";
    out += dumped(Json(key)) + ": ";
    const bool lines = value.is_array() && !value.empty() && value[0].is_object();
    if (!lines) {
      out += dumped(value);
      continue;
    }
    for (std::size_t i = 0; i < value.size(); ++i)
      out += (i == 0 ? "[\n  " : ",\n  ") + dumped(value[i]);
    out += "\n]";
  }
  return out + "\n}\n";
}

Json parsed(const std::string& text, const std::string& file_name) {
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    const std::size_t byte = error.byte > 0 ? error.byte - 1 : 0;  // theirs counts from 1
    datasets::SourcePosition where{file_name, 1, 1, byte};
    for (std::size_t i = 0; i < byte && i < text.size(); ++i) {
      ++where.column;
      if (text[i] == '\n') {
        ++where.line;
        where.column = 1;
      }
    }
    throw datasets::InputError(where, byte >= text.size()
                                          ? "the JSON ends before it is complete; was the file cut "
                                            "short?"
                                          : "this is not JSON; expected what impactrig fit --json "
                                            "writes");
  } catch (const Json::exception&) {
    throw datasets::InputError({file_name, 0, 0, {}}, "a number does not fit a double");
  }
}

fitting::Loss loss_from(const JsonReader& json) {
  try {
    return fitting::loss_named(json.text());
  } catch (const std::invalid_argument& error) {
    json.fail(error.what());
  }
}

fitting::Fit fit_from(const JsonReader& json) {
  fitting::Fit fit;
  const JsonReader parameters = json["parameters"];
  for (std::size_t i = 0; i < parameters.size(); ++i)
    fit.parameters.push_back(parameter_from(parameters.element(i)));
  fit.correlations = correlations_from(json["correlations"], fit.parameters.size());
  fit.not_identifiable = json["not_identifiable"].texts();
  if (json.has("identifiability"))
    fit.identifiability = identifiability_from(json["identifiability"]);
  const JsonReader impacts = json["impacts"];
  for (std::size_t i = 0; i < impacts.size(); ++i)
    fit.impacts.push_back(impact_from(impacts.element(i)));
  if (json.has("direct_restitution")) {
    const JsonReader direct = json["direct_restitution"];
    for (std::size_t i = 0; i < direct.size(); ++i)
      fit.direct.push_back(direct_from(direct.element(i)));
  }
  const JsonReader channels = json["channels"], curves = json["curves"];
  if (channels.size() != curves.size())
    curves.fail(
        fmt::format("expected {} curves, one a channel, found {}", channels.size(), curves.size()));
  for (std::size_t i = 0; i < channels.size(); ++i)
    fit.channels.push_back(
        channel_from(channels.element(i), curves.element(i), json["metrics"], fit.impacts.size()));
  const JsonReader goodness = json["goodness"];
  fit.goodness = {
      .chi2 = goodness["chi2"].number(),
      .dof = goodness["dof"].integer(),
      .aicc = goodness["aicc"].number(),
      .bic = goodness["bic"].number(),
      .unknowns = goodness.has("unknowns") ? static_cast<int>(goodness["unknowns"].integer()) : 0};
  const JsonReader restitution = json["restitution"];
  for (const std::string& key : restitution.keys())
    fit.restitution[key] = {restitution[key]["value"].number(), restitution[key]["ci95"].pair()};
  if (json.has("profiles"))
    for (std::size_t i = 0; i < json["profiles"].size(); ++i)
      fit.profiles.push_back(profile_from(json["profiles"].element(i)));
  if (json.has("bootstrap")) fit.bootstrap = bootstrap_from(json["bootstrap"]);
  const JsonReader predictions = json["predictions"];
  for (std::size_t i = 0; i < predictions.size(); ++i) {
    fit.predictions.push_back(simulation_from(predictions.element(i)));
    fit.predictions.back().history = history_from(predictions.element(i)["history"]);
  }
  fit.rig = rig_from(json["rig"]);
  if (json.has("window_s")) fit.window = json["window_s"].number();
  fit.termination = json["termination"].text();
  fit.iterations = static_cast<int>(json["iterations"].integer());
  fit.simulations = json["simulations"].integer();
  fit.seconds = json["fit_s"].number();
  if (json.has("judging_s")) fit.judging_seconds = json["judging_s"].number();
  if (json.has("loss")) fit.loss = loss_from(json["loss"]);
  fit.warnings = json["warnings"].texts();
  return fit;
}

}  // namespace

std::string dumped(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string to_json(const ReportData& data) {
  return laid_out(report_json(data));
}

ReportData report_from_json(const std::string& text, const std::string& file_name) {
  const Json document = parsed(text, file_name);
  const JsonReader json(document, file_name);
  if (!json.has("schema"))
    json.fail(
        fmt::format("not a fit of impactrig: the member \"schema\" is missing; expected "
                    "\"{}\", as impactrig fit --json writes it",
                    schema));
  if (const std::string found = json["schema"].text(); found != schema)
    json["schema"].fail(fmt::format("expected \"{}\", found \"{}\"", schema, found));
  ReportData data;
  data.title = json["title"].text();
  data.fit = fit_from(json);
  const JsonReader records = json["records"];
  for (std::size_t r = 0; r < records.size(); ++r)
    data.records.push_back(record_from(records.element(r), data.sample_counts.emplace_back()));
  if (json.has("models")) data.models = models_from(json["models"]);
  data.provenance = provenance_from(json["provenance"]);
  return data;
}

}  // namespace impactrig::reports
