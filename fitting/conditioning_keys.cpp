// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/conditioning_keys.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace impactrig::fitting {

namespace {

using datasets::ConditioningAction;
using datasets::TimeSpan;

TimeSpan read_span(TableReader& table) {
  TimeSpan span;
  span.begin = table.required_quantity("from", "s", "-1 ms");
  span.end = table.required_quantity("to", "s", "0 ms");
  if (!(span.begin < span.end)) table.refuse("to", "must be later than from");
  table.finish();
  return span;
}

/// quiet = { from = "-1 ms", to = "0 ms" }, or several of these in an array.
std::vector<TimeSpan> read_spans(TableReader& table) {
  std::vector<TimeSpan> spans;
  if (table.has("quiet") && !table.raw().get("quiet")->is_array()) {
    TableReader inner = *table.table("quiet");
    spans.push_back(read_span(inner));
  } else {
    for (TableReader& inner : table.tables("quiet")) spans.push_back(read_span(inner));
  }
  return spans;
}

std::optional<TimeSpan> read_one_span(TableReader& table) {
  const std::vector<TimeSpan> spans = read_spans(table);
  if (spans.size() > 1)
    table.refuse("quiet", fmt::format("names {} stretches; this step takes one", spans.size()));
  return spans.empty() ? std::nullopt : std::optional(spans.front());
}

double positive(TableReader& table, std::string_view key, std::string_view unit,
                std::string_view example) {
  const double value = table.required_quantity(key, unit, example);
  if (!(value > 0.0)) table.refuse(key, "must be greater than zero");
  return value;
}

std::optional<double> optional_positive(TableReader& table, std::string_view key,
                                        std::string_view unit) {
  if (!table.has(key)) return std::nullopt;
  return positive(table, key, unit, "");
}

int integer_within(TableReader& table, std::string_view key, int usual, int least, int most) {
  const int value = table.integer(key).value_or(usual);
  if (value < least || value > most)
    table.refuse(key, fmt::format("must be {} to {}, found {}", least, most, value));
  return value;
}

ConditioningAction read_action(TableReader& table) {
  using namespace datasets;
  const auto step =
      table.choice("step", {"baseline", "drift", "decay", "undo-low-cut", "low-pass", "hum",
                            "dropouts", "align", "resample", "integrate", "differentiate"});
  if (!step) table.required_text("step", "low-pass");
  switch (*step) {
    case 0:
      return RemoveBaseline{read_one_span(table)};
    case 1:
      return RemoveDrift{read_one_span(table)};
    case 2:
      return RemoveDecay{read_spans(table), optional_positive(table, "time_constant", "s")};
    case 3:
      return UndoLowCut{positive(table, "frequency", "Hz", "0.3 Hz"), read_one_span(table)};
    case 4:
      return LowPass{positive(table, "cutoff", "Hz", "100 kHz"),
                     integer_within(table, "order", 4, 1, 8)};
    case 5:
      return RemoveHum{optional_positive(table, "frequency", "Hz"),
                       integer_within(table, "harmonics", 5, 1, 20), read_spans(table)};
    case 6:
      return RepairDropouts{optional_positive(table, "longest", "s").value_or(300e-6)};
    case 7:
      return AlignTo{table.required_text("to", "force"),
                     optional_positive(table, "range", "s").value_or(50e-6)};
    case 8:
      return Resample{positive(table, "rate", "Hz", "1 MHz")};
    case 9: {
      Integrate action{table.text("name").value_or(""), read_one_span(table), std::nullopt};
      if (const auto zero = table.quantity("zero_at", "s")) action.zero_at = zero->value;
      return action;
    }
    default:
      return Differentiate{table.text("name").value_or("")};
  }
}

}  // namespace

std::vector<datasets::ConditioningStep> read_conditioning(TableReader& root) {
  std::vector<datasets::ConditioningStep> steps;
  for (TableReader& table : root.tables("conditioning")) {
    datasets::ConditioningStep step;
    step.channel = table.required_text("channel", "force");
    step.action = read_action(table);
    table.finish();
    steps.push_back(std::move(step));
  }
  return steps;
}

}  // namespace impactrig::fitting
