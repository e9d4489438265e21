// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "datasets/conditioning.hpp"
#include "datasets/sensor.hpp"
#include "fitting/fit_options.hpp"
#include "fitting/section.hpp"
#include "models/rig.hpp"
#include "models/simulation.hpp"

namespace impactrig::fitting {

/// A rig file: the experiment, how it is measured, how to solve. This room reads it because it is
/// the only one that knows both models and measurements.
struct RigFile {
  std::string path;
  std::string text;    ///< as read, for provenance
  std::string sha256;  ///< of `text`
  models::Rig rig;
  /// Numbers that further stops have as [contact] has them: "contacts.1.restitution".
  std::vector<std::string> inherited = {};
  std::vector<std::string> remarks = {};  ///< of what is stated in vain, or twice
  std::vector<Section<>> sections;        ///< of the bar's segments, of a uniform bar its only one
  models::Solver solver;
  bool mesh_stated = false;   ///< the file names elements, or a model without
  bool mesh_chosen = false;   ///< by choose_mesh(): a fit may take a finer one
  bool modes_stated = false;  ///< the file says how many a hybrid model has
  std::optional<datasets::Sensor> force, velocity, displacement;
  std::vector<datasets::ConditioningStep> conditioning;  ///< what is done to recordings, in order
  double mains_frequency = 50.0;                         ///< of the hum in the recordings [Hz]
  FitOptions fit;  ///< what is fitted to recordings of this rig, and how
};

/// The sensor of a quantity, none where the rig file describes none.
const std::optional<datasets::Sensor>& sensor_of(const RigFile& rig, datasets::Quantity quantity);

/// A key=value of the command line ("beam.length", "0.9 m"); the value may be quoted or not.
using Override = std::pair<std::string, std::string>;

/// Reads a rig file (TOML; docs/rig-file.md) with overrides on top. Unknown keys, missing units,
/// wrong dimensions and values outside their range throw datasets::InputError with line and column;
/// FileError when it cannot be read.
/// Dotted keys `without` are taken as if the file did not state them.
RigFile read_rig_file(const std::string& path, const std::vector<Override>& overrides = {},
                      const std::vector<std::string>& without = {});
RigFile parse_rig_file(const std::string& text, const std::string& path,
                       const std::vector<Override>& overrides = {},
                       const std::vector<std::string>& without = {});

}  // namespace impactrig::fitting
