// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "bench/scene_text.hpp"
#include "fitting/rig_file.hpp"

namespace impactrig::bench {

inline constexpr std::array scene_families = {"impact",  "to the end", "bounces",
                                              "grazing", "swing",      "spin-up"};

struct Scene {
  long number = 0;
  std::string family;
  bool without_stop = false;
  std::string toml;
  std::string refusal;  ///< by the reader of rig files; then no more is drawn
  fitting::RigFile file;
  double contact_time = 0.0;  ///< of a rigid bar on the elastic law, roughly [s]
  double periods = 0.0;       ///< of the fastest vibration within the duration, roughly
  double predicted = 0.0;     ///< what a step for each of them costs, roughly [s]
};

/// The scene that a seed and its number determine: against a stop, or one of those without.
Scene draw_scene(std::uint64_t seed, long number, bool without_stop,
                 Meshes meshes = Meshes::coarse);

}  // namespace impactrig::bench
