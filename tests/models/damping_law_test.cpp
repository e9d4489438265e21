// SPDX-License-Identifier: BSD-3-Clause
#include "models/contact/damping_law.hpp"
#include "models/contact/damping/exact.hpp"

#include <gmock/gmock.h>

#include <boost/math/special_functions/lambert_w.hpp>
#include <cmath>
#include <stdexcept>

#include "tests/models/law_names.hpp"

namespace {

using namespace impactrig::models;
using impactrig::tests::names_of;

// d(e) of the Lankarani-Nikravesh factor and the e_out it gives, and d(e) of the exact law: check
// values restitution_map_proportional of the project's reference pages, agreement 1e-8 stated
// there.
struct Row {
  double restitution, factor, rebound, exact_factor;
};

constexpr Row table[] = {
    {0.1, 0.7425, 0.6652654067551504, 9.998159397495668},    //
    {0.2, 0.72, 0.6722624889615205, 4.9191667157907855},     //
    {0.3, 0.6825, 0.6842246057494477, 3.0870819811296246},   //
    {0.4, 0.63, 0.7016347276735007, 2.082498164147007},      //
    {0.5, 0.5625, 0.7252411140101973, 1.4327505332713744},   //
    {0.6, 0.48, 0.7561486806594477, 0.9748717108132654},     //
    {0.7, 0.3825, 0.7959725953653285, 0.6348282812664174},   //
    {0.8, 0.27, 0.8471022797876164, 0.37314620336505366},    //
    {0.9, 0.1425, 0.9131766778055811, 0.16648195068530772},  //
};

TEST(DampingLaws, GiveTheTabulatedFactorsAndRebounds) {
  for (const Row& row : table) {
    const double d = damping_law("lankarani-nikravesh").factor(row.restitution);
    EXPECT_NEAR(d, row.factor, 1e-15);
    EXPECT_NEAR(free_rebound_ratio(d), row.rebound, 1e-12);
    EXPECT_NEAR(damping_law("exact").factor(row.restitution), row.exact_factor,
                1e-12 * row.exact_factor);
    EXPECT_EQ(damping_law("none").factor(row.restitution), 0.0);
  }
}

TEST(DampingLaws, WithoutLossAreAllWithoutDamping) {
  for (const DampingLaw& law : damping_laws()) {
    // a fitted polynomial ends with 2e-4 of critical damping
    const double most = law.text.name == "tsuji-marshall" ? 2e-4 : 0.0;
    EXPECT_GE(law.factor(1.0), 0.0) << law.text.name;
    EXPECT_LE(law.factor(1.0), most) << law.text.name;
    EXPECT_FALSE(law.text.description.empty());
    EXPECT_FALSE(law.text.source.empty());
  }
  EXPECT_EQ(free_rebound_ratio(0.0), 1.0);
}

TEST(ExactDampingFactor, SolvesItsEquation) {
  // rounding of e d is amplified by 1 / (1 − e d), 5e4 at e = 0.08
  for (double e = 0.08; e < 0.99; e += 0.001) {
    const double d = exact_damping_factor(e);
    EXPECT_NEAR(d * (1.0 + e), std::log1p(d) - std::log1p(-e * d), 1e-15 / (1.0 - e * d))
        << "e = " << e;
  }
}

TEST(ExactDampingFactor, RoundTripsWithTheFreeReboundFromFiveThousandthsToOne) {
  double worst = 0.0;
  for (double e = 0.005; e <= 1.0; e += 0.00097)
    worst = std::max(worst, std::abs(free_rebound_ratio(exact_damping_factor(e)) / e - 1.0));
  for (double loss = 1e-12; loss < 1e-2; loss *= 1.9) {
    // near e = 1 it is the loss which matters
    const double e = 1.0 - loss;
    const double back = free_rebound_ratio(exact_damping_factor(e));
    EXPECT_NEAR(back, e, 1e-13 * loss + 3e-16) << "1 - e = " << loss;
  }
  EXPECT_LT(worst, 2e-12);
}

TEST(ExactDampingFactor, HasNoJumpWhereItsMethodChanges) {
  for (double e : {0.2, 1.0 - 1e-3}) {
    const double below = exact_damping_factor(e - 1e-13);
    const double above = exact_damping_factor(e + 1e-13);
    // slope of d is −1/e² near 0 and −3/2 near 1
    EXPECT_NEAR((below - above) / above, 2e-13 / e * (e > 0.5 ? 1.5 / above : 1.0), 1e-11);
  }
}

TEST(ExactDampingFactor, TendsToThreeHalvesOfTheLossAndToOneOverE) {
  for (double part : {1e-3, 1e-5, 1e-8}) {
    const double e = 1.0 - part;
    const double loss = 1.0 - e;  // as rounded
    EXPECT_NEAR(exact_damping_factor(e) / (1.5 * loss), 1.0, 1.01 * loss);
  }
  for (double e : {0.001, 0.01, 0.02}) EXPECT_NEAR(exact_damping_factor(e) * e, 1.0, 1e-14);
}

TEST(FreeReboundRatio, AgreesWithTheLambertFunction) {
  // e = (1 + W₀(−(1 + d) exp(−(1 + d)))) / d, other side of the same equation; near d = 0 the
  // argument is at the branch point and this form loses half the digits.
  for (double d = 0.2; d < 30.0; d *= 1.1) {
    const double w = boost::math::lambert_w0(-(1.0 + d) * std::exp(-(1.0 + d)));
    EXPECT_NEAR(free_rebound_ratio(d), (1.0 + w) / d, 1e-13) << "d = " << d;
  }
}

TEST(FreeReboundRatio, FallsFromOneLikeOneMinusTwoThirdsOfTheFactor) {
  for (double d : {1e-9, 1e-6, 1e-4})
    EXPECT_NEAR((1.0 - free_rebound_ratio(d)) / (2.0 / 3.0 * d), 1.0, d + 3e-16 / d) << "d = " << d;
  double before = 1.0;
  for (double d = 1e-5; d < 1e4; d *= 1.3) {
    const double e = free_rebound_ratio(d);
    EXPECT_LT(e, before);
    EXPECT_LE(e * d, 1.0);
    before = e;
  }
}

TEST(DampingLaws, RefuseWhatHasNoMeaning) {
  using testing::ThrowsMessage;
  EXPECT_THAT([] { damping_law("exakt"); },
              ThrowsMessage<std::invalid_argument>(
                  "contact.damping: there is no damping law 'exakt'; known are " +
                  names_of(damping_laws())));
  EXPECT_THAT(
      [] { exact_damping_factor(0.0); },
      ThrowsMessage<std::invalid_argument>("exact_damping_factor: e = 0 is outside (0, 1]"));
  EXPECT_THAT(
      [] { exact_damping_factor(1.5); },
      ThrowsMessage<std::invalid_argument>("exact_damping_factor: e = 1.5 is outside (0, 1]"));
  EXPECT_THROW(exact_damping_factor(std::nan("")), std::invalid_argument);
  EXPECT_THAT([] { free_rebound_ratio(-0.5); },
              ThrowsMessage<std::invalid_argument>("free_rebound_ratio: d = -0.5 is negative"));
  EXPECT_THROW(free_rebound_ratio(std::nan("")), std::invalid_argument);
}

}  // namespace
