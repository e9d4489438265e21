// SPDX-License-Identifier: BSD-3-Clause
#include "app/files.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <system_error>
#include <utility>

#include "acquisition/exporter.hpp"
#include "datasets/input_error.hpp"

namespace impactrig::app {
namespace fs = std::filesystem;

namespace {

/// Of a file by its device and number there, which all its paths and links have in common.
using FileIdentity = std::pair<dev_t, ino_t>;

std::optional<FileIdentity> identity_of(const std::string& path) {
  struct stat facts = {};
  if (::stat(path.c_str(), &facts) != 0) return std::nullopt;
  return FileIdentity(facts.st_dev, facts.st_ino);
}

}  // namespace

// By a map: a campaign has thousands of outputs and inputs, and std::filesystem::equivalent would
// look at each pair.
void refuse_inputs(const std::vector<std::string>& outputs,
                   const std::vector<std::string>& inputs) {
  std::map<FileIdentity, std::string> read;
  for (const std::string& input : inputs)
    if (const auto identity = identity_of(input)) read.emplace(*identity, input);
  for (const std::string& output : outputs) {
    if (output.empty() || output == "-") continue;
    // what is written has the other name until it is complete
    for (const std::string& path : {output, output + ".part"}) {
      const auto identity = identity_of(path);
      const auto found = identity ? read.find(*identity) : read.end();
      if (found == read.end()) continue;
      throw datasets::FileError(
          path, fmt::format("is read by this command{}, and not even --force writes over it; "
                            "choose another name",
                            found->second == path ? "" : ", as " + found->second));
    }
  }
}

void check_output(const std::string& path, bool force) {
  if (path == "-") return;
  std::error_code ignored;
  const fs::path folder = fs::path(path).parent_path();
  if (!folder.empty() && !fs::is_directory(folder, ignored))
    throw datasets::FileError(path, "cannot be written: its folder does not exist");
  if (fs::is_directory(path, ignored))
    throw datasets::FileError(path, "cannot be written: it is a folder");
  if (!force && fs::exists(path, ignored))
    throw datasets::FileError(path,
                              "exists already; choose another name or add --force to overwrite it");
}

void check_ending(const std::string& path) {
  const std::string ending = fs::path(path).extension().string();
  std::string known;
  for (const acquisition::Exporter& exporter : acquisition::exporters()) {
    known += fmt::format("{}{}", known.empty() ? "" : " ", exporter.endings);
  }
  if (ending.empty() || (" " + known + " ").find(" " + ending + " ") == std::string::npos)
    throw CLI::ValidationError(
        "-o", fmt::format("'{}' ends in no format that is written; known are {}", path, known));
}

void export_and_tell(const datasets::Record& record, const std::string& path, bool quiet) {
  const std::vector<std::string> warnings = acquisition::export_recording(record, path);
  if (quiet) return;
  for (const std::string& warning : warnings) fmt::print(stderr, "warning: {}\n", warning);
}

void write_output(const std::string& path, std::string_view content, bool force) {
  if (path == "-") {
    std::fwrite(content.data(), 1, content.size(), stdout);
    return;
  }
  std::error_code failure;
  if (fs::exists(path, failure) && !force && read_text(path) == content) return;
  check_output(path, force);
  const std::string part = path + ".part";
  {
    std::ofstream stream(part, std::ios::binary);
    stream.write(content.data(), static_cast<std::streamsize>(content.size()));
    stream.flush();
    if (!stream) {
      fs::remove(part, failure);
      throw datasets::FileError(path,
                                "cannot be written; is there space, and may you write there?");
    }
  }
  fs::rename(part, path, failure);
  if (failure) throw datasets::FileError(path, "cannot be written: " + failure.message());
}

std::string read_text(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw datasets::FileError(path, "cannot be opened; is the name right?");
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) throw datasets::FileError(path, "cannot be read");
  return text.str();
}

}  // namespace impactrig::app
