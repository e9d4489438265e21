// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "acquisition/synthetic.hpp"
#include "datasets/record.hpp"
#include "fitting/rig_file.hpp"

namespace impactrig::bench {

acquisition::SensorSet sensors_of(const fitting::RigFile& rig);

/// "key=value", each. Throws CLI::ValidationError.
std::vector<fitting::Override> overrides(const std::vector<std::string>& assignments);

/// Restitution 0.3 to 0.8, stiffness factor 0.8 to 1.25, speed 0.3 to 0.5 m/s, uniform.
void draw_truth(std::uint64_t seed, models::Rig& rig);

/// How a shot is recorded.
struct Recording {
  double pre_trigger = 0.5e-3;  ///< [s]
  double duration = 4e-3;       ///< in all [s]
  double sample_rate = 1e6;     ///< [Hz]
  double accuracy = 1e-9;       ///< to which the truth is solved
  std::function<acquisition::SyntheticOptions(const acquisition::SensorSet&,
                                              const acquisition::ShownPeaks&)>
      day = acquisition::good_laboratory_day;
  /// What is changed of the laboratory's day, the largest force of the bar [N] being known.
  std::function<void(acquisition::SyntheticOptions&, double)> change = {};
};

/// The rig's own impact through its sensors, and how it was recorded.
struct RecordedShot {
  datasets::Record record;
  acquisition::SyntheticOptions options;
};

/// Throws what models::simulate() and acquisition::synthesise() throw.
RecordedShot record_shot(const fitting::RigFile& rig, const Recording& how);

}  // namespace impactrig::bench
