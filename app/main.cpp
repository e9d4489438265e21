// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <exception>
#include <new>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/program.hpp"
#include "datasets/input_error.hpp"
#include "datasets/record.hpp"
#include "fitting/solver_options.hpp"

namespace impactrig::app {
namespace {

std::vector<std::string> typed;

int say(int code, const char* sentence) {
  fmt::print(stderr, "impactrig: error: {}\n", sentence);
  return code;
}

/// Runs the subcommand that was asked for; every kind of failure has its exit code.
int run(CLI::App& program, int argc, char** argv) {
  try {
    program.parse(argc, argv);
    return done;
  } catch (const CLI::ParseError& error) {
    return error.get_exit_code() == 0 ? program.exit(error) : (program.exit(error), wrong_usage);
  } catch (const Exit& exit) {
    return exit.code;
  } catch (const datasets::InputError& error) {
    return say(invalid_input, error.what());
  } catch (const datasets::FileError& error) {
    return say(file_error, error.what());
  } catch (const std::invalid_argument& error) {
    return say(invalid_input, error.what());
  } catch (const std::runtime_error& error) {
    return say(gate_failed, error.what());
  } catch (const std::bad_alloc&) {
    return say(internal_error, "out of memory");
  } catch (const std::exception& error) {
    return say(
        internal_error,
        fmt::format(
            "{}. This is a fault of the program; please report it with the command you typed.",
            error.what())
            .c_str());
  }
}

}  // namespace

const std::vector<std::string>& command_line() {
  return typed;
}

void set_command_line(int argc, char** argv) {
  typed.assign(argv, argv + argc);
}

void add_quiet(CLI::App& command, CommonOptions& options) {
  command.add_flag("-q,--quiet", options.quiet, "Nothing on stderr but errors");
}

void add_json(CLI::App& command, CommonOptions& options) {
  command.add_flag("--json", options.json, "One JSON document on stdout");
}

void add_set(CLI::App& command, CommonOptions& options) {
  command
      .add_option("--set", options.overrides,
                  "Override a key of the rig file: beam.length=\"0.9 m\"")
      ->take_all()
      ->expected(1);
}

void add_force(CLI::App& command, CommonOptions& options) {
  command.add_flag("-f,--force", options.force, "Overwrite files that exist");
}

std::vector<std::pair<std::string, std::string>> split_overrides(
    const std::vector<std::string>& overrides) {
  std::vector<std::pair<std::string, std::string>> pairs;
  for (const std::string& text : overrides) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
      throw CLI::ValidationError(
          "--set",
          fmt::format("expected key=value, for example beam.length=\"0.9 m\", found {}", text));
    pairs.emplace_back(text.substr(0, equals), text.substr(equals + 1));
  }
  return pairs;
}

std::vector<std::string> split_names(const std::string& text) {
  std::vector<std::string> names;
  std::istringstream stream(text);
  for (std::string name; std::getline(stream, name, ',');)
    if (const std::size_t first = name.find_first_not_of(' '); first != std::string::npos)
      names.push_back(name.substr(first, name.find_last_not_of(' ') - first + 1));
  return names;
}

}  // namespace impactrig::app

int main(int argc, char** argv) {
  impactrig::fitting::silence_solver();
  using namespace impactrig::app;
  set_command_line(argc, argv);
  CLI::App program{
      "impactrig: from the recording of an impact to restitution, contact stiffness and a "
      "report\n\n"
      "  impactrig validate shot.uff --rig rig.toml -o report.html    the whole job\n"
      "  impactrig demo                                               the same on the shipped "
      "example",
      "impactrig"};
  program.set_version_flag("--version", impactrig::datasets::program_version());
  program.require_subcommand(1);
  add_validate(program);
  add_demo(program);
  add_import(program);
  add_inspect(program);
  add_simulate(program);
  add_fit(program);
  add_campaign(program);
  add_compare(program);
  add_report(program);
  add_acquire(program);
  add_laws(program);
  add_lists(program);
  return run(program, argc, argv);
}
