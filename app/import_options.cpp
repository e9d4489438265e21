// SPDX-License-Identifier: BSD-3-Clause
#include "app/import_options.hpp"

#include "app/program.hpp"
#include "app/quantity_option.hpp"

namespace impactrig::app {
namespace {

/// Between the commas, with empty ones; none of an empty text.
std::vector<std::string> split_units(const std::string& text) {
  std::vector<std::string> units;
  if (text.empty()) return units;
  std::size_t first = 0;
  for (std::size_t comma = text.find(','); comma != std::string::npos;
       comma = text.find(',', first)) {
    units.push_back(text.substr(first, comma - first));
    first = comma + 1;
  }
  units.push_back(text.substr(first));
  return units;
}

}  // namespace

void add_import_arguments(CLI::App& command, ImportArguments& arguments) {
  const char* group = "How to read recordings (detected unless stated)";
  command.add_option("--format", arguments.format, "Format, a name of `impactrig formats`")
      ->group(group);
  command
      .add_option("--encoding", arguments.encoding,
                  "Text: its code page, a name of `iconv -l`, such as CP932 or GB18030")
      ->group(group);
  command.add_option("--delimiter", arguments.delimiter, "Text: , ; | tab or blank")
      ->check(CLI::IsMember({",", ";", "|", "tab", "blank"}))
      ->group(group);
  command.add_option("--decimal", arguments.decimal, "Text: decimal . or ,")
      ->check(CLI::IsMember({".", ","}))
      ->group(group);
  command.add_option("--skip-lines", arguments.skip_lines, "Text: lines before the column names")
      ->check(CLI::Range(0, 1000000000))
      ->group(group);
  command
      .add_option("--time-column", arguments.time_column,
                  "Text: name or index from 0 of the time column, or none")
      ->group(group);
  command
      .add_option("--sample-rate", arguments.sample_rate,
                  "Sample rate [Hz, or as \"51.2 kHz\"], in place of the file's")
      ->transform(with_unit("Hz"))
      ->check(positive)
      ->group(group);
  command
      .add_option("--units", arguments.units,
                  "One unit a column of a text, a channel of .mat, .npy, .tdms and the like, comma "
                  "between, none to leave the file's: s,N,,m/s")
      ->group(group);
}

void add_selection_arguments(CLI::App& command, ImportArguments& arguments) {
  const char* group = "What to read (default: all)";
  command
      .add_option("--channel", arguments.channels, "Channel, by name or index from 0; repeatable")
      ->allow_extra_args(false)
      ->group(group);
  add_window_arguments(command, arguments);
}

void add_window_arguments(CLI::App& command, ImportArguments& arguments) {
  const char* group = "What to read (default: all)";
  command.add_option("--from", arguments.from, "Time of the first sample [s, or as \"5 ms\"]")
      ->transform(with_unit("s"))
      ->group(group);
  command.add_option("--to", arguments.to, "Time of the last sample [s]")
      ->transform(with_unit("s"))
      ->group(group);
}

void add_detection_arguments(CLI::App& command, DetectionArguments& arguments) {
  const char* group = "How impacts are found (from noise and peak unless stated)";
  command
      .add_option("--trigger", arguments.trigger,
                  "Channel to look for impacts in: name or index; default the force, else the "
                  "acceleration, else the velocity, else the displacement")
      ->group(group);
  command
      .add_option("--threshold", arguments.threshold,
                  "Departure that is an impact [N, m/s^2, m/s or m]")
      ->check(positive)
      ->group(group);
  command
      .add_option(
          "--pre-trigger", arguments.pre_trigger,
          "Time kept before first touch, whose noise is judged [s]; default 0.5e-3, half of a long "
          "contact's time, of slow or filtered channels 200 samples")
      ->transform(with_unit("s"))
      ->check(positive)
      ->group(group);
  command
      .add_option("--post-trigger", arguments.post_trigger,
                  "Time kept after first touch; later contacts within it are further hits [s]; "
                  "default 5e-3, and as long after a long contact as that took")
      ->transform(with_unit("s"))
      ->check(positive)
      ->group(group);
}

acquisition::DetectionOptions detection_options(const DetectionArguments& arguments) {
  acquisition::DetectionOptions options;
  options.trigger_channel = arguments.trigger;
  options.threshold = arguments.threshold;
  if (arguments.pre_trigger > 0.0) options.pre_trigger = arguments.pre_trigger;
  if (arguments.post_trigger > 0.0) options.post_trigger = arguments.post_trigger;
  return options;
}

acquisition::ImportOptions import_options(const ImportArguments& arguments) {
  acquisition::ImportOptions options;
  options.format = arguments.format;
  options.encoding = arguments.encoding;
  if (!arguments.delimiter.empty())
    options.delimiter = arguments.delimiter == "tab"     ? '\t'
                        : arguments.delimiter == "blank" ? ' '
                                                         : arguments.delimiter[0];
  if (!arguments.decimal.empty()) options.decimal = arguments.decimal[0];
  if (arguments.skip_lines >= 0) options.skip_lines = arguments.skip_lines;
  if (!arguments.time_column.empty()) options.time_column = arguments.time_column;
  if (arguments.sample_rate > 0.0) options.sample_rate = arguments.sample_rate;
  if (!(arguments.from <= arguments.to))
    throw CLI::ValidationError("--from", "must not be later than --to; both are times in seconds");
  options.channels = arguments.channels;
  options.from = arguments.from;
  options.to = arguments.to;
  options.units = split_units(arguments.units);
  return options;
}

}  // namespace impactrig::app
