// SPDX-License-Identifier: BSD-3-Clause
#include "app/comparison_texts.hpp"

#include <fmt/format.h>

#include <cmath>

#include "datasets/record.hpp"
#include "reports/numbers.hpp"

namespace impactrig::app {
namespace {

using nlohmann::ordered_json;
using reports::percent;
using reports::quantity;
using reports::significant;

ordered_json number(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

ordered_json numbers(const std::vector<double>& values) {
  ordered_json list = ordered_json::array();
  for (const double value : values) list.push_back(number(value));
  return list;
}

template <typename Triple>
ordered_json triple_json(const Triple& triple) {
  return {{"magnitude", number(triple.magnitude)},
          {"phase", number(triple.phase)},
          {"comprehensive", number(triple.comprehensive)}};
}

ordered_json iso_json(const fitting::Comparison& metrics, double interval) {
  if (!metrics.iso18571) return nullptr;
  const fitting::Iso18571& iso = *metrics.iso18571;
  return {{"corridor", number(iso.corridor)},
          {"phase", number(iso.phase)},
          {"magnitude", number(iso.magnitude)},
          {"slope", number(iso.slope)},
          {"rating", number(iso.rating)},
          {"grade", fitting::iso18571_grade(iso.rating)},
          {"shift_samples", iso.shift},
          {"shift_s", number(interval * static_cast<double>(iso.shift))},
          {"correlation", number(iso.correlation)},
          {"magnitude_error", number(iso.magnitude_error)},
          {"slope_error", number(iso.slope_error)},
          {"path_length", iso.path_length}};
}

ordered_json cora_json(const fitting::Comparison& metrics, double interval) {
  if (!metrics.cora) return nullptr;
  const fitting::Cora& cora = *metrics.cora;
  return {{"corridor", number(cora.corridor)},
          {"progression", number(cora.progression)},
          {"phase", number(cora.phase)},
          {"size", number(cora.size)},
          {"cross_correlation", number(cora.cross_correlation)},
          {"rating", number(cora.rating)},
          {"shift_samples", cora.shift},
          {"shift_s", number(interval * static_cast<double>(cora.shift))}};
}

ordered_json metrics_json(const ComparisonResult& result) {
  const fitting::Comparison& m = result.metrics;
  const double interval = result.pair.interval;
  ordered_json json;
  json["sprague_geers"] = triple_json(m.sprague_geers);
  json["geers_1984"] = triple_json(m.geers_1984);
  json["russell"] = triple_json(m.russell);
  json["knowles_gear"] = triple_json(m.knowles_gear);
  json["knowles_gear"]["arrival_measured_s"] = number(m.knowles_gear.arrival_measured);
  json["knowles_gear"]["arrival_predicted_s"] = number(m.knowles_gear.arrival_computed);
  json["theil_u"] = number(m.theil_u);
  json["whang"] = number(m.whang);
  json["zilliacus"] = number(m.zilliacus);
  json["rss_factor"] = number(m.rss_factor);
  json["weighted_integrated_factor"] = number(m.weighted_integrated_factor);
  json["nrmse"] = number(m.error.of_peak);
  json["nrmse_divisor"] = "max |measured|";
  json["nrmse_absmax"] = number(m.error.of_peak);
  json["nrmse_range"] = number(m.error.of_range);
  json["nrmse_rms"] = number(m.error.of_rms);
  json["rmse"] = number(m.error.rmse);
  json["correlation"] = number(m.correlation);
  json["r_squared"] = number(m.r_squared);
  json["peak_ratio"] = number(m.computed.peak / m.measured.peak);
  json["impulse_ratio"] = number(result.impulse_ratio);
  json["anova"] = {{"mean", number(m.residuals.mean)},
                   {"std", number(m.residuals.deviation)},
                   {"t", number(m.residuals.t)},
                   {"lag1_autocorrelation", number(m.residuals.lag1)},
                   {"effective_samples", number(m.residuals.effective_samples)},
                   {"t_effective", number(m.residuals.t_effective)}};
  json["iso18571"] = iso_json(m, interval);
  json["cora"] = cora_json(m, interval);
  json["roadside_accepted"] = fitting::roadside_accepts(m.sprague_geers, m.residuals);
  return json;
}

ordered_json scalar_json(const ComparedScalar& scalar, double coverage_factor) {
  ordered_json json = {{"unit", scalar.unit},
                       {"measured", number(scalar.measured)},
                       {"predicted", number(scalar.predicted)},
                       {"error", number(scalar.error())},
                       {"relative_error", number(scalar.error() / scalar.measured)}};
  if (!scalar.shots.empty()) {
    json["shots"] = numbers(scalar.shots);
    json["area_metric"] = number(scalar.area);
  }
  if (scalar.has_uncertainty)
    json["validation"] = {{"error", number(scalar.validation.error)},
                          {"u_num", number(scalar.uncertainty.numerical)},
                          {"u_input", number(scalar.uncertainty.input)},
                          {"u_data", number(scalar.uncertainty.data)},
                          {"u_val", number(scalar.validation.uncertainty)},
                          {"coverage_factor", number(coverage_factor)},
                          {"low", number(scalar.validation.low)},
                          {"high", number(scalar.validation.high)},
                          {"verdict", fitting::name(scalar.validation.verdict)}};
  return json;
}

ordered_json file_json(const ComparedFile& file) {
  return {{"file", file.file},
          {"format", file.format},
          {"channel", file.channel},
          {"unit", file.unit},
          {"sha256", file.sha256}};
}

/// A unit for the terminal: none stated reads as nothing.
std::string in(const std::string& unit) {
  return unit.empty() ? "no unit stated" : unit;
}

class Table {
 public:
  void row(const std::string& name, const std::string& value, const std::string& says) {
    text_ += fmt::format("  {:<34}{:>12}   {}\n", name, value, says);
  }

  void title(const std::string& title) { text_ += "\n" + title + "\n"; }

  void line(const std::string& line) { text_ += "  " + line + "\n"; }

  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// As a terminal and a search in it take it: plain minus signs and spaces.
std::string plain(std::string text) {
  const auto replace = [&](const std::string& from, const char* to) {
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos;)
      text.replace(at, from.size(), to);
  };
  replace("\u2212", "-");
  replace("\u00a0", " ");
  replace("\u202f", " ");
  return text;
}

/// A dimensionless number with three digits, or why there is none.
std::string shown(double value) {
  return std::isfinite(value) ? plain(significant(value, 3)) : "-";
}

std::string shown(double value, const std::string& unit) {
  return std::isfinite(value) ? plain(quantity(value, unit, 4)) : "-";
}

std::string graded(double score) {
  return std::string(fitting::iso18571_grade(score));
}

std::string shift_text(std::ptrdiff_t samples, double interval) {
  if (samples == 0) return "best without a shift";
  return fmt::format("best when moved {} by {} ({} sample{})", samples > 0 ? "earlier" : "later",
                     shown(interval * static_cast<double>(std::abs(samples)), "s"),
                     std::abs(samples), std::abs(samples) == 1 ? "" : "s");
}

void add_scalars(const ComparisonResult& result, Table& table) {
  table.title(fmt::format("{:<16}{:>14} {:>14}    {}", "The pulse",
                          result.repeats.empty() ? "measured" : "mean of shots", "predicted",
                          "E = predicted - measured"));
  for (const ComparedScalar& s : result.scalars) {
    std::string error = shown(s.error(), s.unit);
    const double relative = s.error() / std::abs(s.measured);
    if (s.key != "peak_time" && std::isfinite(relative))
      error += fmt::format(" ({}{})", relative > 0.0 ? "+" : "", plain(percent(relative)));
    table.line(fmt::format("{:<14}{:>14} {:>14}    {}", s.title, shown(s.measured, s.unit),
                           shown(s.predicted, s.unit), error));
    if (!s.shots.empty())
      table.line(
          fmt::format("{:<14}{} shots, area metric {}", "", s.shots.size(), shown(s.area, s.unit)));
    if (s.has_uncertainty)
      table.line(fmt::format("{:<14}u_val {}, model error from {} to {} (k = {:g}): {}", "",
                             shown(s.validation.uncertainty, s.unit),
                             shown(s.validation.low, s.unit), shown(s.validation.high, s.unit),
                             result.coverage_factor, fitting::name(s.validation.verdict)));
  }
}

void add_errors(const ComparisonResult& result, Table& table) {
  const fitting::Comparison& m = result.metrics;
  table.title("Errors (0: none)");
  table.row("Sprague-Geers magnitude M", shown(m.sprague_geers.magnitude),
            "> 0: the prediction is larger");
  table.row("Sprague-Geers phase P", shown(m.sprague_geers.phase),
            "0.5: a quarter of a period off");
  table.row("Sprague-Geers comprehensive C", shown(m.sprague_geers.comprehensive),
            "sqrt(M^2 + P^2)");
  table.row("Geers 1984 M, P, C", shown(m.geers_1984.magnitude),
            fmt::format("{}, {}", shown(m.geers_1984.phase), shown(m.geers_1984.comprehensive)));
  table.row("Russell M, P, C", shown(m.russell.magnitude),
            fmt::format("{}, {}", shown(m.russell.phase), shown(m.russell.comprehensive)));
  table.row("Knowles-Gear M, P, C", shown(m.knowles_gear.magnitude),
            fmt::format("{}, {}; shape with arrivals aligned, arrival", shown(m.knowles_gear.phase),
                        shown(m.knowles_gear.comprehensive)));
  table.row("Theil's inequality U", shown(m.theil_u), "1: nothing in common");
  table.row("Whang's inequality", shown(m.whang), "1: nothing in common");
  table.row("Zilliacus", shown(m.zilliacus), "sum |c - m| / sum |m|");
  table.row("Weighted integrated factor", shown(m.weighted_integrated_factor),
            "1: nothing in common");
  table.row("RMSE", shown(m.error.rmse, result.pair.unit), "root of the mean square");
  table.row("NRMSE of the peak", shown(m.error.of_peak), "RMSE / max |measured|");
  table.row("NRMSE of the range", shown(m.error.of_range), "RMSE / (max - min) of the measured");
  table.row("NRMSE of the RMS", shown(m.error.of_rms), "RMSE / RMS of the measured");
  table.row("Residual, mean", shown(m.residuals.mean), "(measured - predicted) / max |measured|");
  table.row("Residual, standard deviation", shown(m.residuals.deviation),
            std::isfinite(m.residuals.effective_samples)
                ? fmt::format("as {} independent samples; t = {}",
                              shown(m.residuals.effective_samples), shown(m.residuals.t_effective))
                : "");
}

void add_agreement(const ComparisonResult& result, Table& table) {
  const fitting::Comparison& m = result.metrics;
  table.title("Agreement (1: complete)");
  table.row("Correlation (Pearson)", shown(m.correlation), "blind to scale and offset");
  table.row("R^2", shown(m.r_squared), "1 - squares of the error / of the measured about its mean");
  if (m.iso18571) {
    table.row("ISO/TS 18571 corridor Z", shown(m.iso18571->corridor), graded(m.iso18571->corridor));
    table.row(
        "ISO/TS 18571 phase", shown(m.iso18571->phase),
        graded(m.iso18571->phase) + "; " + shift_text(m.iso18571->shift, result.pair.interval));
    table.row("ISO/TS 18571 magnitude", shown(m.iso18571->magnitude),
              graded(m.iso18571->magnitude));
    table.row("ISO/TS 18571 slope", shown(m.iso18571->slope), graded(m.iso18571->slope));
    table.row("ISO/TS 18571 rating R", shown(m.iso18571->rating),
              graded(m.iso18571->rating) + " (> 0.94 excellent, > 0.8 good, > 0.58 fair)");
  }
  if (m.cora)
    table.row("CORA rating", shown(m.cora->rating),
              fmt::format("corridor {}, progression {}, phase {}, size {}", shown(m.cora->corridor),
                          shown(m.cora->progression), shown(m.cora->phase), shown(m.cora->size)));
}

}  // namespace

ordered_json to_json(const ComparisonResult& result) {
  const acquisition::PairedHistories& pair = result.pair;
  ordered_json json = {
      {"schema", "impactrig/compare/1"},
      {"program", datasets::program_version()},
      {"measured", file_json(result.measured)},
      {"predicted", file_json(result.predicted)},
      {"samples", result.metrics.samples},
      {"unit", pair.unit},
      {"from_s", pair.start},
      {"to_s", pair.end()},
      {"interval_s", pair.interval},
      {"sample_rate_hz", 1.0 / pair.interval},
      {"shift_s", result.shift},
      {"resampled", pair.measured_resampled || pair.predicted_resampled},
      {"measured_resampled", pair.measured_resampled},
      {"predicted_resampled", pair.predicted_resampled},
      {"bridged", {{"measured", pair.measured_bridged}, {"predicted", pair.predicted_bridged}}},
      {"metrics", metrics_json(result)}};
  ordered_json& scalars = json["scalars"] = ordered_json::object();
  for (const ComparedScalar& scalar : result.scalars)
    scalars[scalar.key] = scalar_json(scalar, result.coverage_factor);
  if (!result.repeats.empty()) {
    ordered_json& repeats = json["repeats"];
    repeats["shots"] = result.repeats.size() + 1;
    for (const ComparedFile& file : result.repeats) repeats["files"].push_back(file_json(file));
    repeats["chi2_per_sample"] = number(result.scatter.chi2_per_sample);
    repeats["coverage"] = {
        {"coverage_factor", result.coverage_factor},
        {"fraction", number(result.scatter.coverage.fraction)},
        {"effective_samples", number(result.scatter.coverage.effective_samples)},
        {"ci95", {number(result.scatter.coverage.low), number(result.scatter.coverage.high)}}};
  }
  json["warnings"] = result.warnings;
  return json;
}

std::string to_text(const ComparisonResult& result) {
  const acquisition::PairedHistories& pair = result.pair;
  std::string text = fmt::format(
      "Measured   {}: {} ({})\nPredicted  {}: {} ({}){}\nWindow     {:.6g} s to {:.6g} s, {} "
      "samples "
      "{:.6g} s apart{}\n",
      result.measured.file, result.measured.channel, in(result.measured.unit),
      result.predicted.file, result.predicted.channel, in(result.predicted.unit),
      result.shift != 0.0 ? fmt::format(", moved by {:.6g} s", result.shift) : "", pair.start,
      pair.end(), result.metrics.samples, pair.interval,
      pair.measured_resampled    ? ", both resampled"
      : pair.predicted_resampled ? ", the prediction resampled to the measured instants"
                                 : "");
  Table table;
  add_scalars(result, table);
  if (!result.repeats.empty()) {
    table.title(fmt::format("{} shots", result.repeats.size() + 1));
    table.row("chi^2 a sample", shown(result.scatter.chi2_per_sample),
              "of the prediction against the shots' mean");
    table.row(fmt::format("Inside mean +- {:g} s", result.coverage_factor),
              plain(percent(result.scatter.coverage.fraction)),
              std::isfinite(result.scatter.coverage.low)
                  ? fmt::format("95 %: {} to {}, as {} independent samples",
                                plain(percent(result.scatter.coverage.low)),
                                plain(percent(result.scatter.coverage.high)),
                                shown(result.scatter.coverage.effective_samples))
                  : "");
  }
  add_errors(result, table);
  add_agreement(result, table);
  text += table.text();
  text += fmt::format(
      "\nRoadside practice (M, P, C up to 0.4, mean residual up to 0.05, its deviation up to 0.35) "
      "would {} this.\n",
      fitting::roadside_accepts(result.metrics.sprague_geers, result.metrics.residuals)
          ? "accept"
          : "not accept");
  return text;
}

}  // namespace impactrig::app
