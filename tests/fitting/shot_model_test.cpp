// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/shot_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/fitting/fast_fit.hpp"

namespace impactrig::fitting {
namespace {

using tests::hybrid_rig;
using tests::synthetic_shot;

constexpr std::optional<Shown::Curve> Shown::*channels[] = {&Shown::force, &Shown::velocity};

/// Largest difference of a channel.
double distance(const Shown& a, const Shown& b, std::optional<Shown::Curve> Shown::*channel) {
  const std::vector<double>&x = (a.*channel)->values, &y = (b.*channel)->values;
  EXPECT_EQ(x.size(), y.size());
  double largest = 0.0;
  for (std::size_t k = 0; k < std::min(x.size(), y.size()); ++k)
    largest = std::max(largest, std::abs(x[k] - y[k]));
  return largest;
}

/// At 8 m/s small motion leaves out what a quiet record shows.
RigFile fast_rig(const std::vector<Override>& more = {}) {
  std::vector<Override> all = {{"start.velocity", "\"8 m/s\""}, {"solver.accuracy", "1e-9"}};
  all.insert(all.end(), more.begin(), more.end());
  return hybrid_rig("1.5 ms", all);
}

ShotModel model_of(const RigFile& rig, models::Motion motion) {
  static const datasets::Impact impact =
      synthetic_shot(fast_rig(), {.velocity = 8.0, .duration = 1.6e-3});
  ShotModel model(rig, impact, 1e-4, 1.5e-3, 1e-6);
  model.set_motion(motion);
  return model;
}

// What is learned at one place is left as it is at others: it changes there by little of itself.
TEST(ShotModel, ShowsTheFullEquationsByWhatItLearned) {
  const RigFile rig = fast_rig();
  const ShotModel small = model_of(rig, models::Motion::small);
  const ShotModel full = model_of(rig, models::Motion::full);
  ShotModel learned = small;
  ASSERT_TRUE(learned.learn_full_motion(rig.rig, small.chains()));
  models::Rig other = rig.rig;
  other.contact.restitution += 0.001;
  other.contact.stiffness_factor *= 1.001;
  other.start.velocity *= 1.001;
  for (const auto channel : channels) {
    const auto distances = [&](const models::Rig& at) {
      const Shown truth = full.predict(at, full.chains());
      return std::array{distance(small.predict(at, small.chains()), truth, channel),
                        distance(learned.predict(at, learned.chains()), truth, channel)};
    };
    const auto [left_out, rounding] = distances(rig.rig);
    EXPECT_GT(left_out, 0.0);
    EXPECT_LT(rounding, 1e-9 * left_out);
    const auto [left_out_there, left] = distances(other);
    EXPECT_LT(left, 0.15 * left_out_there);
  }
  EXPECT_EQ(learned.motion(), models::Motion::small);
  EXPECT_EQ(learned.as_learned().motion(), models::Motion::full);
  EXPECT_EQ(small.as_learned().motion(), models::Motion::small);
  learned.forget_full_motion();
  EXPECT_EQ(distance(learned.predict(other, small.chains()), small.predict(other, small.chains()),
                     &Shown::force),
            0.0);
}

// The force of a damper jumps at touch; a low-pass alone makes it go on.
TEST(ShotModel, LearnsNothingOfAForceThatJumps) {
  const RigFile rig = fast_rig({{"contact.damping", "viscous"}});
  ShotModel small = model_of(rig, models::Motion::small);
  SensorChains chains = small.chains();
  chains.force.reset();
  EXPECT_FALSE(small.learn_full_motion(rig.rig, chains));
  EXPECT_EQ(small.as_learned().motion(), models::Motion::small);
}

}  // namespace
}  // namespace impactrig::fitting
