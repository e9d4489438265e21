// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <future>
#include <optional>

#include "acquisition/channel_map.hpp"
#include "acquisition/conditioning/average_shots.hpp"
#include "acquisition/conditioning/steps.hpp"
#include "acquisition/disk_memory.hpp"
#include "acquisition/exporter.hpp"
#include "acquisition/importer.hpp"
#include "acquisition/recording_spool.hpp"
#include "app/channel_map_file.hpp"
#include "app/conditioning_limit.hpp"
#include "app/files.hpp"
#include "app/import_options.hpp"
#include "app/program.hpp"
#include "app/progress.hpp"
#include "datasets/input_error.hpp"
#include "datasets/record_writer.hpp"

namespace impactrig::app {
namespace {

struct Options {
  std::vector<std::string> files;
  std::string output;
  std::string map;
  bool suggest_map = false;
  bool average = false;
  DetectionArguments detection;
  ImportArguments reading;
  CommonOptions common;
};

/// Recordings of up to so many samples are held in memory, where HDF5 compresses them.
constexpr std::uint64_t most_held = std::uint64_t{1} << 20;

/// A draft of a map looks at recordings of up to so many samples for what is upside down.
constexpr std::uint64_t most_looked_at = std::uint64_t{1} << 23;

bool is_hdf5(const std::string& path) {
  return path.ends_with(".h5") || path.ends_with(".hdf5");
}

/// A recording to import.
struct Input {
  std::string path;
  std::unique_ptr<acquisition::RecordingReader> reader;
  acquisition::Selection wanted;
};

std::vector<Input> open_inputs(const Options& options, const acquisition::ChannelMap& map) {
  const acquisition::ImportOptions reading = import_options(options.reading);
  std::vector<Input> inputs;
  for (const std::string& path : options.files) {
    Input input{path, acquisition::open_recording(path, reading), {}};
    if (!options.map.empty()) input.reader = acquisition::mapped(std::move(input.reader), map);
    const acquisition::RecordingHead& head = input.reader->head();
    if (head.record.channels.empty())
      throw datasets::InputError(
          {.file = path},
          "there are no recordings in this file; `impactrig inspect` shows what it holds");
    input.wanted = acquisition::selection_of(head, reading);
    inputs.push_back(std::move(input));
  }
  return inputs;
}

std::uint64_t samples_of(const std::vector<Input>& inputs) {
  std::uint64_t samples = 0;
  for (const Input& input : inputs) samples += app::samples_of(input.reader->head(), input.wanted);
  return samples;
}

constexpr std::string_view joined = "join recording";

/// Channels of two files may have one name: what was done to which, the file tells.
void name_file(datasets::Record& record) {
  const std::string key(datasets::recorded_in);
  const std::string file = record.provenance.source_file;
  for (datasets::Channel& channel : record.channels) channel.attributes.try_emplace(key, file);
  for (datasets::Edit& edit : record.provenance.edits)
    if (edit.what != joined) edit.parameters.try_emplace(key, file);
}

/// Several files become one record with the channels of all, in order; the first one's provenance
/// and attributes lead.
void join(datasets::Record&& next, datasets::Record& record) {
  if (record.channels.empty()) {
    record = std::move(next);
    return;
  }
  name_file(record);
  name_file(next);
  record.provenance.edits.push_back({std::string(joined),
                                     "",
                                     {{"file", next.provenance.source_file},
                                      {"sha256", next.provenance.sha256},
                                      {"channels", std::to_string(next.channels.size())}}});
  for (datasets::Edit& edit : next.provenance.edits)
    record.provenance.edits.push_back(std::move(edit));
  if (next.started != record.started && !next.started.empty() && !record.started.empty())
    record.warnings.push_back(
        fmt::format("{} started at {}, the first file at {}: their times are not put on one axis",
                    next.provenance.source_file, next.started, record.started));
  for (datasets::Channel& channel : next.channels) {
    // what the head of another file says is its channels' alone
    for (const auto& [name, value] : next.attributes)
      if (const auto here = record.attributes.find(name);
          here == record.attributes.end() || here->second != value)
        channel.attributes.try_emplace(name, value);
    record.channels.push_back(std::move(channel));
  }
  for (std::string& warning : next.warnings) record.warnings.push_back(std::move(warning));
}

/// One of several recordings' samples on their way to where all go.
class Onward final : public acquisition::SampleSink {
 public:
  Onward(acquisition::SampleSink& next, Progress& progress, std::size_t first_channel)
      : next_(next),
        progress_(progress),
        first_(first_channel) {}

  void take(std::size_t channel, const acquisition::SampleBlock& block) override {
    next_.take(first_ + channel, block);
    progress_.add(block.size());
  }

  void take_times(std::size_t channel, std::span<const double> times) override {
    next_.take_times(first_ + channel, times);
  }

 private:
  acquisition::SampleSink& next_;
  Progress& progress_;
  std::size_t first_;
};

/// Samples on their way to our HDF5.
class ToHdf5 final : public acquisition::SampleSink {
 public:
  explicit ToHdf5(datasets::RecordWriter& writer) : writer_(writer) {}

  void take(std::size_t channel, const acquisition::SampleBlock& block) override {
    writer_.append(channel, block.raw, block.imaginary, block.valid);
  }

  void take_times(std::size_t channel, std::span<const double> times) override {
    writer_.append_times(channel, times);
  }

 private:
  datasets::RecordWriter& writer_;
};

std::vector<std::string> names_of_channels(const std::vector<Input>& inputs) {
  std::vector<std::string> names;
  for (const Input& input : inputs)
    for (const std::size_t index :
         acquisition::selected_channels(input.reader->head(), input.wanted))
      names.push_back(input.reader->head().record.channels[index].name);
  return names;
}

/// Reads all recordings to `sink` block by block.
datasets::Record read_by_blocks(const Options& options, std::vector<Input>& inputs,
                                acquisition::SampleSink& sink) {
  Progress progress("importing", samples_of(inputs), options.common.quiet);
  datasets::Record record;
  for (Input& input : inputs) {
    auto sha256 = std::async(std::launch::async, acquisition::sha256_of_recording, input.path);
    Onward onward(sink, progress, record.channels.size());
    datasets::Record next = acquisition::read_window(*input.reader, input.wanted, onward);
    next.provenance.sha256 = sha256.get();
    join(std::move(next), record);
  }
  return record;
}

/// Samples go from the files to ours block by block.
datasets::Record import_to_hdf5(const Options& options, std::vector<Input>& inputs) {
  datasets::RecordWriter writer(options.output, names_of_channels(inputs));
  ToHdf5 sink(writer);
  datasets::Record record = read_by_blocks(options, inputs, sink);
  writer.finish(record);
  return record;
}

/// Other formats need to know how many samples there are, or all channels at a time: samples go by
/// way of the disk.
datasets::Record import_by_disk(const Options& options, std::vector<Input>& inputs) {
  acquisition::RecordingSpool spool(options.output, names_of_channels(inputs).size());
  datasets::Record record = read_by_blocks(options, inputs, spool);
  for (std::string& warning : acquisition::export_recording(record, spool.finish(), options.output))
    record.warnings.push_back(std::move(warning));
  return record;
}

/// A shot counts once in a mean.
void refuse_same_file(const std::vector<datasets::Record>& records) {
  const datasets::Provenance& last = records.back().provenance;
  for (std::size_t i = 0; i + 1 < records.size(); ++i)
    if (records[i].provenance.sha256 == last.sha256)
      throw datasets::InputError({.file = last.source_file},
                                 fmt::format("is the same recording as {}; name each once",
                                             records[i].provenance.source_file));
}

/// Returns what is left of the record: all but its samples.
datasets::Record write_by_blocks(datasets::Record&& record, const std::string& path) {
  std::vector<std::string> names;
  for (const datasets::Channel& channel : record.channels) names.push_back(channel.name);
  datasets::RecordWriter writer(path, names);
  ToHdf5 sink(writer);
  datasets::Record head = acquisition::reader_of(std::move(record))->read({}, sink);
  writer.finish(head);
  return head;
}

/// All samples at hand, which `steps` and means need.
datasets::Record import_at_once(const Options& options, std::vector<Input>& inputs,
                                const std::vector<datasets::ConditioningStep>& steps) {
  const bool many = samples_of(inputs) > most_held;
  std::optional<acquisition::DiskMemory> on_disk;
  if (many) on_disk.emplace(options.output);
  Progress progress("importing", inputs.size() * (1 + steps.size()), options.common.quiet);
  const auto forward = [&progress] { progress.add(1); };
  std::vector<datasets::Record> records;
  for (Input& input : inputs) {
    auto sha256 = std::async(std::launch::async, acquisition::sha256_of_recording, input.path);
    records.push_back(acquisition::read_into_memory(*input.reader, input.wanted));
    records.back().provenance.sha256 = sha256.get();
    forward();
    acquisition::apply_steps(steps, records.back(), {}, detection_options(options.detection),
                             forward);
    if (options.average) refuse_same_file(records);
  }
  datasets::Record record;
  if (options.average)
    record = acquisition::average_shots(std::move(records), detection_options(options.detection));
  else
    for (datasets::Record& next : records) join(std::move(next), record);
  records.clear();
  if (many && is_hdf5(options.output)) return write_by_blocks(std::move(record), options.output);
  for (std::string& warning : acquisition::export_recording(record, options.output))
    record.warnings.push_back(std::move(warning));
  return record;
}

datasets::Record import_inputs(const Options& options, std::vector<Input>& inputs,
                               const std::vector<datasets::ConditioningStep>& steps) {
  const bool whole = options.average || !steps.empty();
  try {
    if (whole || samples_of(inputs) <= most_held) return import_at_once(options, inputs, steps);
  } catch (const acquisition::NoRoomOnDisk& full) {
    acquisition::refuse_to_keep(options.output, full.error());
  }
  return is_hdf5(options.output) ? import_to_hdf5(options, inputs)
                                 : import_by_disk(options, inputs);
}

/// A draft of the map of the files' channels, on stdout or in a file.
void suggest_map(const Options& options) {
  acquisition::ImportOptions reading = import_options(options.reading);
  reading.require_clock = false;
  const auto reader = acquisition::open_recording(options.files.front(), reading);
  datasets::Record record = reader->head().record;
  if (record.channels.empty())
    throw datasets::InputError(
        {.file = options.files.front()},
        fmt::format("has no channels to map{}{}", record.warnings.empty() ? "" : ": ",
                    fmt::join(record.warnings, "; ")));
  try {
    if (app::samples_of(reader->head(), {}) <= most_looked_at)
      record = acquisition::read_into_memory(*reader, {});
  } catch (const datasets::InputError&) {
    // one channel that cannot be read, perhaps: the map may be there to leave it out
  }
  write_output(options.output.empty() ? "-" : options.output, acquisition::suggested_map(record),
               options.common.force);
}

std::vector<std::string> inputs_of(const Options& options) {
  std::vector<std::string> inputs = options.files;
  if (!options.map.empty()) inputs.push_back(options.map);
  return inputs;
}

void import(const Options& options) {
  refuse_inputs({options.output}, inputs_of(options));
  if (options.suggest_map) return suggest_map(options);
  if (options.output.empty()) throw CLI::RequiredError("--output");
  check_output(options.output, options.common.force);
  check_ending(options.output);
  acquisition::ChannelMap map;
  if (!options.map.empty()) map = read_channel_map(options.map);
  std::vector<Input> inputs = open_inputs(options, map);
  const datasets::Record record = import_inputs(options, inputs, map.conditioning);
  if (options.common.quiet) return;
  for (const std::string& warning : record.warnings) fmt::print(stderr, "warning: {}\n", warning);
  fmt::print(stderr, "recording of {} channel(s) written to {}\n", record.channels.size(),
             options.output);
}

}  // namespace

void add_import(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand(
      "import", "Convert recordings of any format to our HDF5 (or .mat, .uff, .csv)");
  command->add_option("file", options->files, "Recordings")->required();
  command->add_option("-o,--output", options->output, "Result; its ending says the format");
  command
      ->add_option("--map", options->map,
                   "What the channels are: names, roles, units, sensitivities (TOML)")
      ->check(CLI::ExistingFile);
  command->add_flag("--suggest-map", options->suggest_map,
                    "Write a draft of such a map, to stdout or to -o, and import nothing");
  command->add_flag(
      "--average", options->average,
      "Files are repeated shots: write their mean, laid on each other by the trigger, "
      "and their standard deviation");
  add_detection_arguments(*command, options->detection);
  add_selection_arguments(*command, options->reading);
  add_import_arguments(*command, options->reading);
  add_quiet(*command, options->common);
  add_force(*command, options->common);
  command->callback([options] { import(*options); });
}

}  // namespace impactrig::app
