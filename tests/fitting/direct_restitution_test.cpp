// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/direct_restitution.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "fitting/direct_trial.hpp"
#include "tests/fitting/free_impact.hpp"
#include "tests/fitting/synthetic_shot.hpp"

namespace impactrig::fitting {
namespace {

using datasets::Impact;
using datasets::ImpactFlag;
using testing::DoubleNear;
using testing::HasSubstr;
using tests::free_impact;
using tests::FreeImpact;
using tests::FreeRecording;

/// A rig of which only the sensors matter.
RigFile plain_rig() {
  RigFile rig;
  rig.rig.contact.position = 0.69;
  return rig;
}

double part(const DirectEstimate& estimate, const std::string& source) {
  const auto found = std::ranges::find(estimate.budget, source, &Contribution::source);
  EXPECT_NE(found, estimate.budget.end()) << source;
  return found == estimate.budget.end() ? NAN : found->std_error;
}

bool covers(const DirectEstimate& estimate, double truth) {
  return estimate.ci95[0] <= truth && truth <= estimate.ci95[1];
}

// Kinematic, kinetic and energetic restitution of a rigid body are one number. e, penetration and
// loss: free_impact.json, cases hertz/elastic/e1.0 and hertz/exact/e0.5, whose tolerance is 1e-6;
// the tolerances here are those of 1 MHz and of the
// parabola over 4 % of the contact that rounds the speed's bend at separation.
TEST(DirectRestitution, OfARigidBodyIsOneNumber) {
  for (const auto& [damping, e, depth] :
       {std::tuple{0.0, 1.0, 4.0434357486530645e-05},
        std::tuple{3.248867422384069, 0.5, 3.136019568132677e-05}}) {
    const FreeImpact body{.damping = damping};
    const DirectRestitution direct =
        direct_restitution(free_impact(body, {}, plain_rig()), plain_rig());
    EXPECT_NEAR(direct.kinematic.value, e, 2e-4);
    EXPECT_NEAR(direct.smoothed.value, e, 1e-5);
    EXPECT_NEAR(direct.kinetic.value, e, 1e-4);
    EXPECT_NEAR(direct.energetic.value, e, 1e-4);
    const double energy = 0.5 * body.mass * body.speed * body.speed;
    EXPECT_NEAR(direct.hysteresis.dissipated.value, energy * (1.0 - e * e), 2e-4 * energy);
    EXPECT_NEAR(direct.hysteresis.max_penetration.value, depth, 2.0 * body.speed * 1e-6);
    EXPECT_TRUE(covers(direct.hysteresis.max_penetration, depth));
    EXPECT_NEAR(direct.touch, 1e-3, 2e-6);
    ASSERT_GT(direct.hysteresis.force.size(), 200u);
    EXPECT_NEAR(direct.hysteresis.penetration.back(), 0.0, 2e-6);
  }
}

// The next contact begins a tenth of the first one after it: its rise is no separation. Nor is
// there one where the force dips to a twentieth of its peak.
TEST(DirectRestitution, EndsBeforeTheNextContact) {
  const RigFile rig = plain_rig();
  Impact impact = free_impact({.damping = 3.248867422384069}, {}, rig);
  const DirectRestitution alone = direct_restitution(impact, rig);
  const double duration = alone.separation - alone.touch;
  const double peak = std::ranges::max(impact.force->values);
  const auto with_next = [&](double begin) {
    Impact both = impact;
    for (std::size_t i = 0; i < both.force->values.size(); ++i) {
      const double t = (both.force->time(i) - begin) / duration;
      if (t > 0.0 && t < 1.0) both.force->values[i] += 0.5 * peak * std::sin(std::numbers::pi * t);
    }
    return direct_restitution(both, rig);
  };
  const DirectRestitution followed = with_next(alone.separation + 0.1 * duration);
  EXPECT_NEAR(followed.separation, alone.separation, 2e-6);
  EXPECT_NEAR(followed.kinematic.value, alone.kinematic.value, 1e-3);
  const DirectRestitution dips = with_next(alone.separation - 0.15 * duration);
  EXPECT_FALSE(dips.kinematic.given());
}

// The chain of the paper's rig makes the force ring by 8 % and delays it by 1.8 us, which would
// turn the loop by 8 % of its area; undone, the numbers stay.
TEST(DirectRestitution, SeesThroughTheSensors) {
  const RigFile rig = parse_rig_file(tests::paper_rig, "rig.toml");
  const DirectRestitution direct = direct_restitution(free_impact({}, {}, rig), rig);
  EXPECT_NEAR(direct.kinematic.value, 0.5, 3e-4);
  EXPECT_NEAR(direct.kinetic.value, 0.5, 3e-4);
  EXPECT_NEAR(direct.energetic.value, 0.5, 3e-4);
  EXPECT_GT(part(direct.kinetic, "sensors' chain"), 1e-4);
}

TEST(DirectRestitution, TakesADisplacementWhereThereIsNoVelocity) {
  const DirectRestitution direct =
      direct_restitution(free_impact({}, {.displacement = true}, plain_rig()), plain_rig());
  EXPECT_NEAR(direct.kinematic.value, 0.5, 1e-3);
  EXPECT_NEAR(direct.kinetic.value, 0.5, 2e-3);
  EXPECT_NEAR(direct.energetic.value, 0.5, 2e-3);
  EXPECT_THAT(direct.notes, testing::Contains(HasSubstr("displacement was differentiated")));
}

// Gains cancel in every ratio; the loop's area has both, its width the motion's.
TEST(DirectRestitution, LetsGainsCancelInRatios) {
  Impact impact = free_impact({}, {}, plain_rig());
  impact.force->gain_uncertainty = 0.03;
  impact.velocity->gain_uncertainty = 0.05;
  const DirectRestitution direct = direct_restitution(impact, plain_rig());
  for (const DirectEstimate* e : {&direct.kinematic, &direct.kinetic, &direct.energetic})
    for (const char* source : {"force gain", "motion gain"}) EXPECT_LT(part(*e, source), 1e-12);
  const DirectEstimate& area = direct.hysteresis.dissipated;
  EXPECT_NEAR(part(area, "force gain"), 0.03 * area.value, 1e-9 * area.value);
  EXPECT_NEAR(part(area, "motion gain"), 0.05 * area.value, 1e-9 * area.value);
  EXPECT_LT(part(direct.hysteresis.max_penetration, "force gain"), 1e-12);
}

// u² = e² [(u₁/v₁)² + (u₂/v₂)²] with the variances of a line continued to its end and of a parabola
// at its middle. The formula against the published case of restitution_uncertainty.json first; the
// estimate's own error is 4.5 %, three times which is allowed.
TEST(DirectRestitution, HasTheClosedFormUncertaintyOfASpeedRatio) {
  const auto newton = [](double v1, double u1, double v2, double u2) {
    return v2 / v1 * std::hypot(u1 / v1, u2 / v2);
  };
  ASSERT_NEAR(newton(0.441, 0.002, 0.2205, 0.002), 0.005070448928570952, 1e-12);
  const double sigma = 2e-3;
  const Impact impact = free_impact({}, {.velocity_noise = sigma, .seed = 7}, plain_rig());
  const DirectRestitution direct = direct_restitution(impact, plain_rig());
  // Samples of the line: from three contacts before touch to 2 % of one before it.
  const double contact = impact.end - impact.start;
  const double n = std::floor((2.98 * contact) / 1e-6);
  const double line = sigma * std::sqrt(4.0 / n);
  // Value of a parabola over ±h at its middle, weights w = (1 − |u|³)³: Σ (s₄ − s₂ x²) w y over
  // s₀ s₄ − s₂². The samples lie anywhere about the middle: evenly spread is near enough.
  const double h = 0.03 * contact / 1e-6;
  double s0 = 0.0, s2 = 0.0, s4 = 0.0, squares = 0.0;
  const auto w = [&](double x) { return std::pow(1.0 - std::pow(std::abs(x) / h, 3), 3); };
  for (double x = -std::floor(h); x <= h; x += 1.0) {
    s0 += w(x);
    s2 += w(x) * x * x;
    s4 += w(x) * x * x * x * x;
  }
  for (double x = -std::floor(h); x <= h; x += 1.0)
    squares += std::pow((s4 - s2 * x * x) * w(x) / (s0 * s4 - s2 * s2), 2);
  const double parabola = sigma * std::sqrt(squares);
  const double expected = newton(0.441, line, 0.2205, parabola);
  EXPECT_NEAR(part(direct.kinematic, "motion noise") / expected, 1.0, 3.0 * 0.045);
}

// What a delay error does is what the budget says: a record whose velocity is late by one standard
// uncertainty is off by that row, to first order in the shift's part of the contact.
TEST(DirectRestitution, IsOffByTheDelaysRowWhereAChannelIsLate) {
  const double late = 0.5e-6;
  Impact impact = free_impact({}, {}, plain_rig());
  impact.velocity->delay_uncertainty = 0.3e-6;
  impact.force->delay_uncertainty = 0.4e-6;  // together 0.5 us
  const DirectRestitution right = direct_restitution(impact, plain_rig());
  const DirectRestitution wrong =
      direct_restitution(free_impact({}, {.velocity_late = late}, plain_rig()), plain_rig());
  const auto check = [&](const DirectEstimate& a, const DirectEstimate& b) {
    const double row = part(a, "relative delay");
    EXPECT_GT(row, 1e-4);
    EXPECT_NEAR(std::abs(b.value - a.value) / row, 1.0, 0.03);
    EXPECT_TRUE(covers(a, b.value));
  };
  check(right.kinetic, wrong.kinetic);
  check(right.energetic, wrong.energetic);
  // A speed late by τ adds −τ ∫ F v̇ dt = τ/m ∫ F² dt to the work, to first order.
  double squares = 0.0;
  for (const double f : right.hysteresis.force) squares += f * f * 1e-6;
  const double added = late / FreeImpact{}.mass * squares;
  const DirectEstimate& loop = right.hysteresis.dissipated;
  EXPECT_NEAR((wrong.hysteresis.dissipated.value - loop.value) / added, 1.0, 0.02);
  EXPECT_NEAR(part(loop, "relative delay") / added, 1.0, 0.02);
  EXPECT_LT(part(right.kinematic, "relative delay"), 1e-4);  // of flat speeds
}

// 400 records with noise and delay errors drawn anew: their spread is what the budget's rows for
// noise and delay say, on the mean over 25 other records. Bounds: chi-square of 399 degrees of
// freedom at 99.9 % (0.883 to 1.120), and the rows' own 4.5 % in the part that is noise. The other
// rows stand for what was not drawn.
TEST(DirectRestitution, StatesTheSpreadOfRepeatedRecords) {
  RigFile rig = plain_rig();
  const double delay = 0.05e-6;
  FreeRecording how{.force_noise = 20.0, .velocity_noise = 2e-3, .correlation = 1.5};
  std::mt19937_64 generator(11);
  std::normal_distribution<double> normal(0.0, delay);
  std::vector<ContactPhases> drawn;
  for (int i = 0; i < 400; ++i) {
    how.seed = static_cast<std::uint64_t>(100 + i);
    how.velocity_late = normal(generator);
    drawn.push_back(DirectReading(free_impact({}, how, rig), rig).phases({}));
  }
  std::vector<DirectRestitution> stated;
  for (int i = 0; i < 25; ++i) {
    how.seed = static_cast<std::uint64_t>(1000 + i);
    how.velocity_late = 0.0;
    Impact impact = free_impact({}, how, rig);
    impact.velocity->delay_uncertainty = delay;
    stated.push_back(direct_restitution(impact, rig));
  }
  const auto check = [&](DirectEstimate DirectRestitution::*estimate, const auto& number) {
    double mean = 0.0, squares = 0.0, rows = 0.0;
    for (const ContactPhases& phases : drawn) mean += number(phases) / 400.0;
    for (const ContactPhases& phases : drawn)
      squares += (number(phases) - mean) * (number(phases) - mean) / 399.0;
    for (const DirectRestitution& direct : stated) {
      const DirectEstimate& e = direct.*estimate;
      for (const char* source : {"force noise", "motion noise", "relative delay"})
        rows += part(e, source) * part(e, source) / 25.0;
      double sum = 0.0;
      for (const Contribution& row : e.budget) sum += row.std_error * row.std_error;
      EXPECT_NEAR(e.std_error, std::sqrt(sum), 1e-12);
    }
    EXPECT_GT(std::sqrt(squares / rows), 0.883 * (1.0 - 2.0 * 0.045));
    EXPECT_LT(std::sqrt(squares / rows), 1.120 * (1.0 + 2.0 * 0.045));
    EXPECT_NEAR(mean, 0.5, 2.0 * std::sqrt(rows));
  };
  check(&DirectRestitution::kinematic,
        [](const ContactPhases& p) { return p.rebound / p.approach; });
  check(&DirectRestitution::kinetic,
        [](const ContactPhases& p) { return p.impulse_out / p.impulse_in; });
  check(&DirectRestitution::energetic,
        [](const ContactPhases& p) { return std::sqrt(p.work_out / p.work_in); });
}

// A velocity whose zero is off shifts the ratios; the loop that then does not close shows by how
// much.
TEST(DirectRestitution, KnowsTheVelocitysZeroFromTheLoopThatMustClose) {
  const DirectRestitution direct =
      direct_restitution(free_impact({}, {.velocity_zero = 8e-3}, plain_rig()), plain_rig());
  EXPECT_LT(direct.kinetic.value, 0.49);
  EXPECT_TRUE(covers(direct.kinetic, 0.5)) << direct.kinetic.value;
  EXPECT_TRUE(covers(direct.energetic, 0.5)) << direct.energetic.value;
  EXPECT_TRUE(covers(direct.kinematic, 0.5)) << direct.kinematic.value;
}

TEST(DirectRestitution, SaysWhatCannotBeEstimatedAndWhy) {
  const RigFile rig = plain_rig();
  const Impact whole = free_impact({}, {}, rig);
  const auto why = [&](const auto& change) {
    Impact impact = whole;
    change(impact);
    return direct_restitution(impact, rig);
  };
  const auto no_motion = why([](Impact& i) { i.velocity.reset(); });
  EXPECT_THAT(no_motion.kinetic.absent, HasSubstr("no velocity or displacement"));
  EXPECT_TRUE(std::isnan(no_motion.kinematic.value));
  const auto no_force = why([](Impact& i) { i.force.reset(); });
  EXPECT_THAT(no_force.kinematic.absent, HasSubstr("no force channel"));
  const auto cut = why([](Impact& i) { i.flags = {ImpactFlag::truncated_tail}; });
  EXPECT_THAT(cut.energetic.absent, HasSubstr("ends before the contact does"));
  const auto late = why([](Impact& i) { i.flags = {ImpactFlag::missed_start}; });
  EXPECT_THAT(late.energetic.absent, HasSubstr("begins after first touch"));
  const auto inverted = why([](Impact& i) { i.flags = {ImpactFlag::inverted}; });
  EXPECT_THAT(inverted.energetic.absent, HasSubstr("wrong sign"));
  const auto clipped = why([](Impact& i) { i.flags = {ImpactFlag::clipped}; });
  EXPECT_THAT(clipped.kinetic.absent, HasSubstr("end of its range"));
  EXPECT_NEAR(clipped.kinematic.value, 0.5, 1e-4);  // needs no more of the force than its flanks
  EXPECT_TRUE(clipped.hysteresis.force.empty());
  const auto lost = why([](Impact& i) {
    i.velocity->valid.assign(i.velocity->values.size(), 1);
    i.velocity->valid[1090] = 0;
  });
  EXPECT_THAT(lost.energetic.absent, HasSubstr("within the contact are lost"));
  EXPECT_TRUE(lost.kinematic.given());
  const auto forwards = why([](Impact& i) {
    for (double& v : i.velocity->values) v += 0.5;
  });
  EXPECT_THAT(forwards.kinetic.absent, HasSubstr("does not change its sign"));
  const auto short_record = why([](Impact& i) {
    i.velocity->values.resize(1296);
    i.force->values.resize(1296);
  });
  EXPECT_THAT(short_record.smoothed.absent, HasSubstr("too short after separation"));
  RigFile high_passed = rig;
  high_passed.velocity = datasets::Sensor{};
  high_passed.velocity->low_cut = datasets::BandLimit{100.0, 1};
  EXPECT_THAT(direct_restitution(whole, high_passed).kinematic.absent, HasSubstr("down to 0 Hz"));
}

TEST(DirectRestitution, TellsOfALaserThatPointsElsewhere) {
  RigFile rig = plain_rig();
  rig.velocity = datasets::Sensor{};
  rig.velocity->position = 0.65;
  EXPECT_THAT(
      direct_restitution(free_impact({}, {}, rig), rig).notes,
      testing::ElementsAre(HasSubstr("40 mm from the struck point, so that direct restitution, "
                                     "dissipated energy and penetration are of that spot")));
}

}  // namespace
}  // namespace impactrig::fitting
