// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "acquisition/random_stream.hpp"

namespace impactrig::bench {

/// Of 1 to 50 elements or 1 to 40 modes; of ANCF elements whose number the rig file leaves open; or
/// of 40 to 1000 elements or 40 to 120 modes, at accuracies of 1e-7 to 1e-10.
enum class Meshes { coarse, open, fine };

/// Draws the text of a rig file from a seed and a scene's number.
class SceneText {
 public:
  /// A bar against its stop: "impact", "to the end", "bounces" or "grazing".
  static SceneText with_stop(std::uint64_t seed, long number, Meshes meshes);

  /// A bar alone: "swing" or "spin-up", whose hinge is turned as stated.
  static SceneText without_stop(std::uint64_t seed, long number, Meshes meshes);

  std::string_view family() const { return family_; }

  /// Such a stop is the only one.
  bool stop_gives_way() const { return gives_way_; }

  const std::string& text() const { return text_; }

  /// Chance in [0, 1) for what is drawn when the text has been read.
  double uniform() { return random_.uniform(); }

 private:
  SceneText(std::uint64_t seed, const std::string& name, Meshes meshes)
      : random_(seed, name),
        features_(seed, "features of " + name),
        meshes_(meshes) {}

  static double spread_of(acquisition::RandomStream& random, double low, double high) {
    return std::exp(random.uniform(std::log(low), std::log(high)));
  }

  double spread(double low, double high) { return spread_of(random_, low, high); }

  bool chance(double p) { return random_.uniform() < p; }

  bool featured(double p) { return features_.uniform() < p; }

  double feature(double low, double high) { return spread_of(features_, low, high); }

  int choice(int n) { return static_cast<int>(random_.uniform(0.0, n)); }

  template <typename... Args>
  void add(fmt::format_string<Args...> form, Args&&... args) {
    text_ += fmt::format(form, std::forward<Args>(args)...) + "\n";
  }

  bool grazing() const { return family_ == "grazing"; }

  bool spins_up() const { return family_ == "spin-up"; }

  void draw_beam();
  std::string draw_section();
  void draw_segments();
  void draw_masses();
  void draw_hinge(double friction);
  void draw_stop();
  void draw_contact();
  void draw_elastic_law(int face, double line);
  void draw_damping();
  void draw_start();
  void set_moving(std::optional<double> angle, double speed, double gravity,
                  double chance_of_friction);
  void draw_swing();
  void draw_rotation();
  void draw_environment(double gravity);
  void draw_solver();
  void draw_elements(double fewest, double most, double most_beyond);

  acquisition::RandomStream random_, features_;
  Meshes meshes_;
  std::string_view family_;
  std::string text_;
  double length_ = 0.0, radius_ = 0.0, modulus_ = 0.0;
  double mass_ = 0.0;     // of a round bar
  double slowest_ = 0.0;  // [rad/s]
  bool at_tip_ = false, gives_way_ = false;
};

}  // namespace impactrig::bench
