// SPDX-License-Identifier: BSD-3-Clause

#include <gmock/gmock.h>

#include <cmath>

#include "models/contact/elastic_law.hpp"
#include "tests/models/law_names.hpp"

namespace {

using namespace impactrig::models;
using impactrig::tests::names_of;

Contact geometry(int number) {
  Contact contact;
  if (number == 0) {  // Shen et al.: aluminium bar in a groove
    contact.counterface = Counterface::groove;
    contact.radius = 0.015;
    contact.counter_radius = 0.0175;
    contact.length = 0.02;
    contact.modulus = contact.counter_modulus = 6.8952e10;
    contact.poisson_ratio = contact.counter_poisson_ratio = 0.3;
  } else if (number == 1) {  // steel on a bronze cylinder
    contact.counterface = Counterface::cylinder;
    contact.radius = 0.01;
    contact.counter_radius = 0.025;
    contact.length = 0.03;
    contact.modulus = 2.06e11;
    contact.counter_modulus = 1.1e11;
    contact.poisson_ratio = 0.3;
    contact.counter_poisson_ratio = 0.34;
  } else {  // pin with little clearance
    contact.counterface = Counterface::groove;
    contact.radius = 0.00995;
    contact.counter_radius = 0.01;
    contact.length = 0.015;
    contact.modulus = contact.counter_modulus = 2.07e11;
    contact.poisson_ratio = contact.counter_poisson_ratio = 0.29;
  }
  return contact;
}

LogarithmicContact<> goldsmith(int number, int exponent) {
  Contact contact = geometry(number);
  contact.exponent = exponent;
  return std::get<LogarithmicContact<>>(elastic_law(contact));
}

// Check values contact_log_laws of the project's reference pages, agreement 1e-10 stated there.
struct Check {
  int geometry, exponent;
  double compliance, limit_force, force, penetration, stiffness, energy;
};

constexpr Check checks[] = {
    {0, 1, 4.200922328971596e-10, 22670758414.476566, 0.001, 1.333880934236132e-11,
     77407066.93448742, 6.56438161295637e-15},  //
    {0, 1, 4.200922328971596e-10, 22670758414.476566, 1.0, 1.0436915002906573e-08,
     99832054.83020246, 5.113434443228996e-09},  //
    {0, 1, 4.200922328971596e-10, 22670758414.476566, 50.0, 4.3967522617056027e-07,
     119425625.45652577, 1.072932300870328e-05},  //
    {0, 1, 4.200922328971596e-10, 22670758414.476566, 1000.0, 7.535020663451824e-06,
     140549551.51840398, 0.0036624872735016223},  //
    {0, 1, 4.200922328971596e-10, 22670758414.476566, 5000.0, 3.42945414855402e-05,
     155308055.08769518, 0.08311077725824326},  //
    {0, 3, 4.200922328971596e-10, 9068303.365790628, 0.001, 1.0051988383370586e-11,
     103821717.38332625, 4.920971133461003e-15},  //
    {0, 3, 4.200922328971596e-10, 9068303.365790628, 1.0, 7.150094043915837e-09, 148588370.11941847,
     3.470023963733629e-09},  //
    {0, 3, 4.200922328971596e-10, 9068303.365790628, 50.0, 2.7533417822102354e-07,
     196595310.0660289, 6.620796809964864e-06},  //
    {0, 3, 4.200922328971596e-10, 9068303.365790628, 1000.0, 4.24819970446109e-06,
     261225685.9109186, 0.002019076794006255},  //
    {0, 3, 4.200922328971596e-10, 9068303.365790628, 5000.0, 1.786043669058653e-05,
     317259375.92474675, 0.04202551527085908},  //
    {1, 1, 1.3217792270554872e-10, 1059178394805.5869, 0.001, 4.705041011877618e-12,
     218681377.61829492, 2.3194760252624216e-15},  //
    {1, 1, 1.3217792270554872e-10, 1059178394805.5869, 1.0, 3.791988268543472e-09,
     273238202.3940772, 1.8629496535953488e-09},  //
    {1, 1, 1.3217792270554872e-10, 1059178394805.5869, 50.0, 1.6374525970548308e-07,
     318194966.8681299, 4.0110202909461095e-06},  //
    {1, 1, 1.3217792270554872e-10, 1059178394805.5869, 1000.0, 2.878935525209325e-06,
     364065616.5249024, 0.0014064232819282754},  //
    {1, 1, 1.3217792270554872e-10, 1059178394805.5869, 5000.0, 1.3331016826101149e-05,
     394629029.0627997, 0.03250143004834319},  //
    {1, 3, 1.3217792270554872e-10, 953260555.3250281, 0.001, 3.778061934448634e-12,
     274281901.6674925, 1.85598648654793e-15},  //
    {1, 3, 1.3217792270554872e-10, 953260555.3250281, 1.0, 2.8650091911144875e-09,
     365920871.7200468, 1.3994601148808565e-09},  //
    {1, 3, 1.3217792270554872e-10, 953260555.3250281, 50.0, 1.1739630583403387e-07,
     451314821.205367, 2.8522964441598787e-06},  //
    {1, 3, 1.3217792270554872e-10, 953260555.3250281, 1000.0, 1.9519564477803403e-06,
     549517419.9612564, 0.0009429337432137831},  //
    {1, 3, 1.3217792270554872e-10, 953260555.3250281, 5000.0, 8.69612143895623e-06,
     622259582.3778077, 0.020914191580480895},  //
    {2, 1, 1.877874555592489e-10, 2675964490.3731036, 0.001, 5.561387651864167e-12,
     186094976.08095893, 2.7337469620422718e-15},  //
    {2, 1, 1.877874555592489e-10, 2675964490.3731036, 1.0, 4.264197864398142e-09,
     245313866.78625312, 2.085152068309259e-09},  //
    {2, 1, 1.877874555592489e-10, 2675964490.3731036, 50.0, 1.7647845090597725e-07,
     299241581.5574292, 4.294594112924901e-06},  //
    {2, 1, 1.877874555592489e-10, 2675964490.3731036, 1000.0, 2.9670080769321168e-06,
     359813104.5480024, 0.0014365571745762462},  //
    {2, 1, 1.877874555592489e-10, 2675964490.3731036, 5000.0, 1.3323879132377638e-05,
     403716065.7440162, 0.032136026233698795},  //
    {2, 3, 1.877874555592489e-10, 602092.0103339482, 0.001, 3.98408379051551e-12,
     263414631.46383214, 1.945095031367943e-15},  //
    {2, 3, 1.877874555592489e-10, 602092.0103339482, 1.0, 2.6868940030494845e-09, 400143003.5082997,
     1.29650013763493e-09},  //
    {2, 3, 1.877874555592489e-10, 602092.0103339482, 50.0, 9.761325783854435e-08, 566739947.6419091,
     2.3229642862390783e-06},  //
    {2, 3, 1.877874555592489e-10, 602092.0103339482, 1000.0, 1.3897042155834595e-06,
     832004372.7319825, 0.0006479052439019175},  //
    {2, 3, 1.877874555592489e-10, 602092.0103339482, 5000.0, 5.437359825634352e-06,
     1111500742.055222, 0.012419727966840575},  //
};

TEST(Goldsmith, AgreesWithTheCheckValuesOfThreeGeometriesAndBothExponents) {
  for (const Check& check : checks) {
    SCOPED_TRACE(testing::Message() << "geometry " << check.geometry << ", exponent "
                                    << check.exponent << ", force " << check.force);
    const LogarithmicContact<> law = goldsmith(check.geometry, check.exponent);
    EXPECT_NEAR(law.compliance / check.compliance, 1.0, 1e-12);
    EXPECT_NEAR(law.limit_force / check.limit_force, 1.0, 1e-10);
    EXPECT_NEAR(law.force(check.penetration) / check.force, 1.0, 1e-12);
    EXPECT_NEAR(law.stiffness(check.penetration) / check.stiffness, 1.0, 1e-10);
    EXPECT_NEAR(law.energy(check.penetration) / check.energy, 1.0, 1e-10);
  }
}

TEST(Goldsmith, InverseRoundTripsOverThirtyDecadesOfForce) {
  for (int exponent : {1, 3}) {
    const LogarithmicContact<> law = goldsmith(2, exponent);
    for (double part = 1e-30; part < 0.5; part *= 1.7) {
      const double f = part * law.limit_force;
      const double penetration = law.compliance * f * (1.0 - std::log(part));
      // ln part is good to one rounding of itself: 69 at 1e-30
      EXPECT_NEAR(law.force(penetration) / f, 1.0, 2e-14) << "f/f* = " << part;
    }
  }
}

TEST(Goldsmith, InverseHoldsUpToTheLimitWhereItIsIllConditioned) {
  const LogarithmicContact<> law = goldsmith(0, 3);
  for (double part = 0.5; part < 0.9; part += 0.003) {
    const double f = part * law.limit_force;
    const double penetration = law.compliance * f * (1.0 - std::log(part));
    // rounding of δ is amplified by u / (u − 1), 10.5 at 0.9 f*
    EXPECT_NEAR(law.force(penetration) / f, 1.0, 1e-14) << "f/f* = " << part;
  }
}

/// Central differences with one Richardson step: error of order h⁴.
template <typename Function>
double derivative(const Function& f, double x, double h) {
  const auto central = [&](double step) { return (f(x + step) - f(x - step)) / (2.0 * step); };
  return (4.0 * central(0.5 * h) - central(h)) / 3.0;
}

TEST(Goldsmith, ForceIsTheDerivativeOfTheEnergyOnBothSidesOfTheLimit) {
  for (int exponent : {1, 3}) {
    const LogarithmicContact<> law = goldsmith(0, exponent);
    const double limit = law.limit_penetration();
    for (double x : {1e-12, 1e-9, 1e-6, 1e-5, 0.3 * limit, 0.9 * limit, 1.1 * limit, 3.0 * limit})
      EXPECT_NEAR(derivative([&](double d) { return law.energy(d); }, x, 2e-3 * x) / law.force(x),
                  1.0, 2e-9)
          << "penetration " << x;
  }
}

TEST(Goldsmith, StiffnessIsTheDerivativeOfTheForceOnBothSidesOfTheLimit) {
  for (int exponent : {1, 3}) {
    const LogarithmicContact<> law = goldsmith(0, exponent);
    const double limit = law.limit_penetration();
    for (double x : {1e-12, 1e-9, 1e-6, 1e-5, 0.3 * limit, 0.9 * limit, 1.1 * limit, 3.0 * limit})
      EXPECT_NEAR(
          derivative([&](double d) { return law.force(d); }, x, 2e-3 * x) / law.stiffness(x), 1.0,
          2e-9)
          << "penetration " << x;
  }
}

TEST(Goldsmith, GoesOnAlongItsTangentBeyondNineTenthsOfTheLimitForce) {
  const LogarithmicContact<> law = goldsmith(2, 3);
  const double limit = law.limit_penetration();
  EXPECT_NEAR(limit, law.compliance * 0.9 * law.limit_force * (1.0 - std::log(0.9)), 1e-15 * limit);
  EXPECT_NEAR(law.force(limit) / (0.9 * law.limit_force), 1.0, 1e-14);
  const double tangent = 1.0 / (law.compliance * std::log(1.0 / 0.9));
  for (double beyond : {1e-9, 0.01, 1.0, 100.0}) {
    const double x = limit * (1.0 + beyond);
    EXPECT_NEAR(law.force(x) / (0.9 * law.limit_force + tangent * (x - limit)), 1.0, 1e-13);
    EXPECT_NEAR(law.stiffness(x) / tangent, 1.0, 1e-13);
    EXPECT_NEAR(law.energy(x) / (law.energy(limit) +
                                 (x - limit) * 0.5 * (0.9 * law.limit_force + law.force(x))),
                1.0, 1e-13);
  }
  EXPECT_NEAR(law.stiffness(limit * (1.0 - 1e-9)) / tangent, 1.0, 1e-7);
}

TEST(Goldsmith, GivesNothingWithoutPenetration) {
  const LogarithmicContact<> law = goldsmith(0, 1);
  for (double gap : {0.0, -1e-300, -1e-6, -1.0}) {
    EXPECT_EQ(law.force(gap), 0.0);
    EXPECT_EQ(law.energy(gap), 0.0);
    EXPECT_EQ(law.stiffness(gap), 0.0);
  }
}

TEST(Goldsmith, ScaledContactHasTheFactorInForceEnergyAndStiffnessAtEveryPenetration) {
  const LogarithmicContact<> law = goldsmith(2, 3);
  for (double factor : {0.01, 0.7, 3.0, 250.0}) {
    const LogarithmicContact<> other = law.scaled(factor);
    EXPECT_NEAR(other.limit_penetration() / law.limit_penetration(), 1.0, 1e-15);
    for (double x : {1e-15, 1e-8, 1e-5, 2.0 * law.limit_penetration()}) {
      EXPECT_NEAR(other.force(x) / law.force(x), factor, 1e-14 * factor);
      EXPECT_NEAR(other.energy(x) / law.energy(x), factor, 1e-14 * factor);
      EXPECT_NEAR(other.stiffness(x) / law.stiffness(x), factor, 1e-13 * factor);
    }
  }
}

TEST(Goldsmith, WithExponentThreeDoesNotDependOnTheUnitOfLength) {
  // the same contact with lengths in millimetres and moduli in N/mm²
  Contact metres = geometry(0);
  metres.exponent = 3;
  Contact millimetres = metres;
  for (double* length : {&millimetres.radius, &millimetres.counter_radius, &millimetres.length})
    *length *= 1e3;
  for (double* modulus : {&millimetres.modulus, &millimetres.counter_modulus}) *modulus *= 1e-6;
  const LogarithmicContact<> a = std::get<LogarithmicContact<>>(elastic_law(metres));
  const LogarithmicContact<> b = std::get<LogarithmicContact<>>(elastic_law(millimetres));
  EXPECT_NEAR(b.force(1e3 * 7e-6) / a.force(7e-6), 1.0, 1e-13);
  // and with exponent 1 it does: 7.535 µm against 1.731 µm at 1 kN for this contact
  metres.exponent = millimetres.exponent = 1;
  const LogarithmicContact<> c = std::get<LogarithmicContact<>>(elastic_law(metres));
  const LogarithmicContact<> d = std::get<LogarithmicContact<>>(elastic_law(millimetres));
  EXPECT_NEAR(c.force(7.535020663451824e-6), 1000.0, 1e-6);
  EXPECT_NEAR(d.force(1.731e-3), 1000.0, 1.0);
}

TEST(LinearContact, IsHookesSpringWhichOnlyPushes) {
  const PowerContact<> law{4e6, 1.0};
  EXPECT_EQ(law.force(2e-6), 8.0);
  EXPECT_EQ(law.energy(2e-6), 8e-6);
  EXPECT_EQ(law.stiffness(2e-6), 4e6);
  EXPECT_EQ(law.scaled(2.5).force(2e-6), 20.0);
  EXPECT_EQ(law.force(-2e-6), 0.0);
  EXPECT_EQ(law.energy(-2e-6), 0.0);
  EXPECT_EQ(law.stiffness(-2e-6), 0.0);
  EXPECT_TRUE(std::isinf(law.limit_penetration()));
}

TEST(ElasticLaws, ApplyTheStiffnessFactor) {
  Contact contact = geometry(0);
  const ElasticLaw plain = elastic_law(contact);
  contact.stiffness_factor = 1.7;
  const ElasticLaw stiffer = elastic_law(contact);
  EXPECT_NEAR(std::get<LogarithmicContact<>>(stiffer).force(1e-5) /
                  std::get<LogarithmicContact<>>(plain).force(1e-5),
              1.7, 1e-14);
  contact.law = "linear";
  contact.stiffness = 1e6;
  EXPECT_NEAR(std::get<PowerContact<>>(elastic_law(contact)).force(1.0), 1.7e6, 1e-9);
}

TEST(ElasticLaws, KnowTheRelativeCurvatureOfEveryCounterface) {
  Contact contact = geometry(0);
  EXPECT_NEAR(relative_curvature(contact), 0.0025 / (0.015 * 0.0175), 1e-12);
  contact.counterface = Counterface::cylinder;
  EXPECT_NEAR(relative_curvature(contact), 0.0325 / (0.015 * 0.0175), 1e-12);
  contact.counterface = Counterface::plane;
  EXPECT_NEAR(relative_curvature(contact), 1.0 / 0.015, 1e-12);
}

TEST(ElasticLaws, EveryListedNameCanBeMadeAndAnUnknownOneListsThem) {
  Contact contact = geometry(0);
  contact.stiffness = 1e6;
  for (const ElasticLawEntry& entry : elastic_laws()) {
    contact.law = entry.text.name;
    const ElasticLaw law = elastic_law(contact);
    EXPECT_GT(std::visit([](const auto& l) { return l.force(1e-6); }, law), 0.0) << entry.text.name;
    EXPECT_FALSE(entry.text.description.empty());
    EXPECT_FALSE(entry.text.source.empty());
  }
  contact.law = "gold smith";
  EXPECT_THAT([&] { elastic_law(contact); },
              testing::ThrowsMessage<std::invalid_argument>(
                  "contact.law: there is no elastic law 'gold smith'; known are " +
                  names_of(elastic_laws())));
}

}  // namespace
