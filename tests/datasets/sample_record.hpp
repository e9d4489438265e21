// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "datasets/record.hpp"

namespace tests {

/// A record with every field filled, small enough to be read with the eye.
inline impactrig::datasets::Record sample_record() {
  using namespace impactrig::datasets;
  Record record;
  record.title = "Beam on groove, shot 7";
  record.started = "2006-05-04T10:11:12+08:00";
  record.warnings = {"Two samples are clipped.", "Zeit läuft rückwärts"};
  record.attributes = {{"operator", "Li 李"}, {"empty", ""}, {"a/b @ c", "1\n2"}};
  record.provenance = {"shot 7.uff", 123456789012ULL,   std::string(64, 'a'),
                       "uff58b",     program_version(), {}};
  record.provenance.edits = {{"remove baseline", "Force", {{"offset", "0.012 V"}}},
                             {"remove delay", "", {}}};

  Channel force;
  force.name = "Force";
  force.quantity = Quantity::force;
  force.unit = "kN";
  force.clock = {-1e-4, 1e-6, {}};
  std::vector<std::int16_t> counts;
  for (int i = 0; i < 2000; ++i)
    counts.push_back(static_cast<std::int16_t>(
        i < 100 || i > 300 ? i % 3
                           : std::lround(30000 * std::sin(std::numbers::pi * (i - 100) / 200))));
  force.raw = counts;
  force.scale = 5e-5;
  force.offset = 0.001;
  force.valid.assign(counts.size(), 1);
  force.valid[5] = 0;
  force.calibration = Calibration{4e-3, 2e-5, "V", "N", "certificate 12, 2005-11-30"};
  force.delay = Delay{2.3e-6, 1e-7, true};
  force.attributes = {{"serial", "2626-1"}, {"Überlast", "nein"}};

  Channel velocity;
  velocity.name = "Velocity / beam";
  velocity.quantity = Quantity::velocity;
  velocity.unit = "m/s";
  velocity.clock = {0.0, 1.5e-6, {0.0, 1e-6, 3e-6}};
  velocity.raw = std::vector<float>{0.441F, 0.440F, std::numeric_limits<float>::infinity()};
  velocity.delay = Delay{4e-7, 0.0, false};

  Channel spectrum;
  spectrum.name = "H1";
  spectrum.quantity = Quantity::other;
  spectrum.unit = "(m/s)/N";
  spectrum.clock = {0.0, 0.5, {}};
  spectrum.raw = std::vector<double>{1.0, -0.0, 3e-310};
  spectrum.imaginary = {0.5, std::numeric_limits<double>::quiet_NaN(), -1.0};

  record.channels = {force, velocity, spectrum};
  return record;
}

}  // namespace tests
