// SPDX-License-Identifier: BSD-3-Clause
// What holds for every elastic law, each tested as the type it is.
#include <gmock/gmock.h>

#include <cmath>
#include <type_traits>

#include "models/contact/elastic/brandlein.hpp"
#include "models/contact/elastic/dubowsky_freudenstein.hpp"
#include "models/contact/elastic/esdu_78035.hpp"
#include "models/contact/elastic/goldsmith.hpp"
#include "models/contact/elastic/hertz_point.hpp"
#include "models/contact/elastic/johnson.hpp"
#include "models/contact/elastic/lankarani_nikravesh_cylinder.hpp"
#include "models/contact/elastic/linear.hpp"
#include "models/contact/elastic/liu.hpp"
#include "models/contact/elastic/palmgren.hpp"
#include "models/contact/elastic/pereira.hpp"
#include "models/contact/elastic/persson.hpp"
#include "models/contact/elastic/radzimovsky.hpp"
#include "models/contact/elastic_law.hpp"
#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

using Real = long double;

Contact contact_for(std::string_view law, Counterface counterface) {
  Contact contact = impactrig::tests::paper_rig().contact;
  contact.law = law;
  contact.counterface = counterface;
  contact.counter_modulus = 2.06e11;
  contact.counter_poisson_ratio = 0.28;
  contact.counter_depth = 0.05;
  contact.stiffness = 3.1e9;
  contact.power = 1.3;
  contact.stiffness_factor = 1.2;
  return contact;
}

/// As elastic_law() makes it, in another arithmetic; `name` is multiplied by 1 + `part`.
template <typename Law>
auto precise(const Contact& contact, std::string_view name = "", Real part = 0.0) {
  ContactNumbers<Real> n;
  n.counterface = contact.counterface;
  n.exponent = contact.exponent;
  const auto number = [&](std::string_view key, double value) {
    return Real(value) * (1.0L + (key == name ? part : 0.0L));
  };
  n.radius = number("contact.radius", contact.radius);
  n.counter_radius = number("contact.counterface.radius", contact.counter_radius);
  n.counter_depth = number("contact.counterface.depth", contact.counter_depth);
  n.length = number("contact.length", contact.length);
  n.modulus = number("contact.modulus", contact.modulus);
  n.poisson_ratio = number("contact.poisson_ratio", contact.poisson_ratio);
  n.counter_modulus = number("contact.counter_modulus", contact.counter_modulus);
  n.counter_poisson_ratio = number("contact.counter_poisson_ratio", contact.counter_poisson_ratio);
  n.reference_length = number("contact.reference_length", contact.reference_length.value_or(1.0));
  n.stiffness = number("contact.stiffness", contact.stiffness);
  n.power = number("contact.power", contact.power);
  return Law::make(n).scaled(number("contact.stiffness_factor", contact.stiffness_factor));
}

/// f'(0) of a function of a small part of a number, of the sixth order: to 1e-15 or so.
template <typename Function>
Real slope(Function f) {
  const Real h = 2e-4L;  // a seventh of a radius is the clearance of the groove
  return (45.0L * (f(h) - f(-h)) - 9.0L * (f(2 * h) - f(-2 * h)) + (f(3 * h) - f(-3 * h))) /
         (60.0L * h);
}

template <typename Law>
class EveryElasticLaw : public testing::Test {
 protected:
  /// The counterfaces the law knows.
  std::vector<Counterface> counterfaces() const {
    std::vector<Counterface> known;
    for (const Counterface face :
         {Counterface::groove, Counterface::cylinder, Counterface::plane}) {
      try {
        elastic_law(contact_for(Law::text.name, face));
        known.push_back(face);
      } catch (const std::invalid_argument&) {
      }
    }
    return known;
  }

  static constexpr double depths[] = {1e-12, 1e-9, 3e-7, 1e-5, 2e-4};
};

using Laws = testing::Types<GoldsmithLaw, DubowskyFreudensteinLaw, Esdu78035Law, JohnsonLaw,
                            RadzimovskyLaw, RadzimovskyHandbookLaw, RadzimovskyHalfWidthLaw, LiuLaw,
                            PalmgrenLaw, BrandleinLaw, PereiraLaw, PerssonLaw,
                            LankaraniNikraveshCylinderLaw, HertzPointLaw, LinearLaw>;

struct NameOfLaw {
  template <typename Law>
  static std::string GetName(int) {
    std::string name(Law::text.name);
    std::ranges::replace_if(
        name, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
    return name;
  }
};

TYPED_TEST_SUITE(EveryElasticLaw, Laws, NameOfLaw);

TYPED_TEST(EveryElasticLaw, IsInTheTableWithAllItSaysOfItself) {
  const ElasticLawText& text = elastic_law_entry(TypeParam::text.name).text;
  for (const std::string_view said : {text.description, text.formula, text.validity, text.source})
    EXPECT_FALSE(said.empty());
  EXPECT_FALSE(this->counterfaces().empty());
}

// Energy, force, stiffness and curvature are each the slope of the one before.
TYPED_TEST(EveryElasticLaw, IsTheDerivativeOfItsEnergyAndSoOn) {
  for (const Counterface face : this->counterfaces()) {
    const auto law = precise<TypeParam>(contact_for(TypeParam::text.name, face));
    for (const double x : this->depths) {
      SCOPED_TRACE(x);
      const auto at = [&](Real part) { return Real(x) * (1.0L + part); };
      // Persson's energy is a quadrature in double
      EXPECT_NEAR(double(slope([&](Real p) { return law.energy(at(p)); }) / (x * law.force(x))),
                  1.0, 2e-12);
      EXPECT_NEAR(double(slope([&](Real p) { return law.force(at(p)); }) / (x * law.stiffness(x))),
                  1.0, 1e-13);
      EXPECT_NEAR(double(slope([&](Real p) { return law.stiffness(at(p)); })),
                  double(x * law.curvature(x)), 1e-13 * double(law.stiffness(x)));
    }
  }
}

TYPED_TEST(EveryElasticLaw, InvertsForceAndEnergy) {
  for (const Counterface face : this->counterfaces()) {
    const ElasticLaw law = elastic_law(contact_for(TypeParam::text.name, face));
    for (const double x : this->depths) {
      const ElasticState at = elastic_state(law, x);
      EXPECT_NEAR(penetration_at(law, at.force) / x, 1.0, 2e-15);
      EXPECT_NEAR(penetration_storing(law, at.energy) / x, 1.0, 4e-15);
      EXPECT_EQ(elastic_force(law, x), at.force);
      EXPECT_EQ(force_and_stiffness(law, x).stiffness, at.stiffness);
    }
    const double beyond = 3.0 * limit_penetration(law);
    if (std::isfinite(beyond)) {
      EXPECT_NEAR(penetration_at(law, elastic_force(law, beyond)) / beyond, 1.0, 1e-14);
      EXPECT_NEAR(penetration_storing(law, stored_energy(law, beyond)) / beyond, 1.0, 1e-14);
    }
    EXPECT_EQ(penetration_at(law, 0.0), 0.0);
    EXPECT_EQ(penetration_storing(law, 0.0), 0.0);
    EXPECT_EQ(elastic_force(law, -1e-6), 0.0);
  }
}

// Automatic differentiation against differences in extended precision.
TYPED_TEST(EveryElasticLaw, KnowsItsDerivativesByEveryKey) {
  for (const Counterface face : this->counterfaces()) {
    const Contact contact = contact_for(TypeParam::text.name, face);
    for (const double x : this->depths) {
      const auto here = precise<TypeParam>(contact);
      const std::vector<LawDerivative> derivatives = elastic_derivatives(contact, x);
      ASSERT_FALSE(derivatives.empty());
      for (const LawDerivative& by : derivatives) {
        SCOPED_TRACE(std::string(by.key));
        const auto there = [&](Real part) { return precise<TypeParam>(contact, by.key, part); };
        const Real force = slope([&](Real p) { return there(p).force(x); });
        const Real energy = slope([&](Real p) { return there(p).energy(x); });
        const Real depth = slope([&](Real p) { return there(p).penetration(here.force(x)); });
        EXPECT_NEAR(by.force * by.value, double(force), 1e-12 * double(here.force(x)));
        EXPECT_NEAR(by.energy * by.value, double(energy), 1e-12 * double(here.energy(x)));
        EXPECT_NEAR(by.penetration * by.value, double(depth), 1e-12 * x);
      }
    }
  }
}

// A key that is not among the derivatives changes nothing.
TYPED_TEST(EveryElasticLaw, LeavesNoKeyOut) {
  for (const Counterface face : this->counterfaces()) {
    const Contact contact = contact_for(TypeParam::text.name, face);
    const std::vector<LawDerivative> derivatives = elastic_derivatives(contact, 1e-6);
    const Real here = precise<TypeParam>(contact).force(1e-6);
    for (const char* key :
         {"contact.radius", "contact.counterface.radius", "contact.counterface.depth",
          "contact.length", "contact.modulus", "contact.poisson_ratio", "contact.counter_modulus",
          "contact.counter_poisson_ratio", "contact.reference_length", "contact.stiffness",
          "contact.power", "contact.stiffness_factor"}) {
      const Real there = precise<TypeParam>(contact, key, 1e-2).force(1e-6);
      EXPECT_EQ(there != here,
                std::ranges::find(derivatives, key, &LawDerivative::key) != derivatives.end())
          << key;
    }
  }
}

// f = δ / (A u): relative condition u / (u − 1), of the order of a million near f*.
TEST(LogarithmicContact, InverseIsExactToAFewUnitsTimesItsCondition) {
  const LogarithmicContact<> law{4.2e-10, 9.1e6};
  const LogarithmicContact<Real> exact{4.2e-10, 9.1e6};
  const Real limit = exact.limit_penetration();
  Real worst = 0.0, worst_depth = 0.0;
  for (Real part = 1.0; part > 1e-280L; part /= part > 1e-3L ? 1.0013L : 1.37L) {
    const double x = static_cast<double>(limit * part);
    const Real u = exact.bracket(x), unit = std::numeric_limits<double>::epsilon();
    const Real off = std::abs(law.force(x) / exact.force(x) - 1.0L);
    worst = std::max(worst, off / (unit * u / (u - 1.0L)));
    const double f = static_cast<double>(exact.force(x));
    worst_depth =
        std::max(worst_depth, std::abs(law.penetration(f) / exact.penetration(f) - 1.0L) / unit);
  }
  EXPECT_LT(worst, 4.0);
  EXPECT_LT(worst_depth, 4.0);
}

// The logarithm's root itself, by the residual of δ = A f u in extended precision.
TEST(LogarithmicContact, InverseSolvesItsEquation) {
  const LogarithmicContact<Real> law{4.2e-10, 9.1e6};
  for (Real part = 1.0; part > 1e-300L; part /= part > 1e-3L ? 1.0013L : 17.3L) {
    const Real x = law.limit_penetration() * part;
    const Real f = law.force(x);
    EXPECT_NEAR(double(law.compliance * f * (1.0L + std::log(law.limit_force / f)) / x), 1.0,
                2e-18);
  }
}

// The limits of Persson's relation: Hertz's line near touch, the half angle of 84.83° at the end.
TEST(PerssonContact, BeginsAsALineAndEndsWhereItsAngleDoes) {
  const PerssonContact<> law{1.0, 1e-5};
  EXPECT_NEAR(law.stiffness(1e-14), std::numbers::pi / 2.0 * 1e5, 1e-3);
  // b² of Hertz's parabola: q = π E* ΔR b²
  const double x = 1e-12;
  EXPECT_NEAR(law.force(x) / (std::numbers::pi * x / (2e-5 + x)), 1.0, 1e-6);
  EXPECT_GT(law.force(law.limit_penetration()), 3.0 * law.force(0.5 * law.limit_penetration()));
}

TEST(LiuContact, GoesFromThreeHalvesToOne) {
  const LiuContact<> law{1e9, 1e-5};
  const auto power = [&](double x) { return x * law.stiffness(x) / law.force(x); };
  EXPECT_NEAR(power(1e-12), 1.5, 1e-6);
  EXPECT_NEAR(power(1.0), 1.0, 1e-5);
  EXPECT_NEAR(law.stiffness(1.0), 1e9 / std::sqrt(2.0), 1e4);
}

TEST(PereiraLaw, JoinsItsTwoBranches) {
  Contact contact = contact_for("pereira", Counterface::groove);
  contact.radius = 0.01;
  contact.counter_radius = 0.01 + 0.34954e-3 * (1.0 - 1e-9);
  const double below = elastic_force(elastic_law(contact), 1e-5);
  contact.counter_radius = 0.01 + 0.34954e-3 * (1.0 + 1e-9);
  EXPECT_NEAR(elastic_force(elastic_law(contact), 1e-5) / below, 1.0, 1e-5);
}

// A deep plane is nearly rigid; one whose depth is the other cylinder's diameter nearly that.
TEST(JohnsonLaw, KnowsAPlaneByItsDepth) {
  Contact plane = contact_for("johnson", Counterface::plane);
  const auto depth_at = [&](double depth) {
    plane.counter_depth = depth;
    return penetration_at(elastic_law(plane), 1000.0);
  };
  // each factor e of depth adds 2 σ_2 f / L
  const double sigma = (1.0 - 0.28 * 0.28) / (std::numbers::pi * 2.06e11);
  const double factor = plane.stiffness_factor;
  EXPECT_NEAR(depth_at(0.05 * std::exp(1.0)) - depth_at(0.05),
              2.0 * sigma * 1000.0 / factor / plane.length, 1e-15);
}

TEST(ElasticLaws, RefuseWhatTheyHaveNoFormulaFor) {
  const auto message = [](std::string_view law, Counterface face, double depth) -> std::string {
    Contact contact = contact_for(law, face);
    contact.counter_depth = depth;
    try {
      elastic_law(contact);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message("esdu-78035", Counterface::plane, 0.1),
            "contact.counterface: the law 'esdu-78035' does not know a plane, against which the "
            "approach depends on the depth; take goldsmith, dubowsky-freudenstein, or johnson with "
            "the depth");
  EXPECT_EQ(message("johnson", Counterface::plane, 0.0),
            "contact.counterface.depth: is missing; the law 'johnson' needs the depth of a plane, "
            "down to what holds it, for example { shape = \"plane\", depth = \"30 mm\" }");
  EXPECT_EQ(
      message("persson", Counterface::cylinder, 0.0),
      "contact.counterface: the law 'persson' is for a groove; dubowsky-freudenstein knows every "
      "counterface");
}

TEST(ElasticLimits, NameTheLimitWithItsNumber) {
  Contact contact = impactrig::tests::paper_rig().contact;
  EXPECT_THAT(elastic_limits(contact, 1e-5), IsEmpty());
  // a = 0.42005 mm at 1 kN: 0.15 R_1 at 28.69 kN
  contact.exponent = 3;
  const auto deep = [&](double force) { return penetration_at(elastic_law(contact), force); };
  EXPECT_THAT(elastic_limits(contact, deep(28.6e3)), IsEmpty());
  EXPECT_THAT(elastic_limits(contact, deep(29.46e3)),
              ElementsAre(HasSubstr("the contact's half width is 0.152 of the bar's radius at")));
  contact.law = "liu";  // made for wide contacts
  EXPECT_THAT(elastic_limits(contact, penetration_at(elastic_law(contact), 60e3)), IsEmpty());
  contact.law = "hertz-point";  // √(R_eq δ) = 0.15 R_1 at 48.2 um
  EXPECT_THAT(elastic_limits(contact, 48e-6), IsEmpty());
  EXPECT_THAT(elastic_limits(contact, 48.5e-6),
              ElementsAre(HasSubstr("the contact's radius is 0.15 of the bar's at")));
  contact.law = "pereira";
  EXPECT_THAT(elastic_limits(contact, 1e-6), IsEmpty());
  contact.counter_radius = contact.radius + 11e-3;
  EXPECT_THAT(elastic_limits(contact, 1e-6),
              ElementsAre("the law 'pereira' was fitted to clearances between 0.005 and 10 mm; "
                          "here it is 11 mm"));
  contact = impactrig::tests::paper_rig().contact;
  contact.law = "brandlein";
  EXPECT_THAT(elastic_limits(contact, 1e-6),
              ElementsAre(HasSubstr("steel on steel, E* = 113 GPa; here it is 37.89 GPa")));
  contact.law = "persson";
  EXPECT_THAT(elastic_limits(contact, 1e-6), IsEmpty());
  contact.counter_modulus = 2.06e11;
  EXPECT_THAT(elastic_limits(contact, 1e-6), ElementsAre(HasSubstr("is for one material")));
  contact.law = "goldsmith";
  contact.reference_length = 1e-3;  // f* 2.27e4 N at two moduli of the paper
  contact.counter_modulus = contact.modulus;
  EXPECT_THAT(elastic_limits(contact, penetration_at(elastic_law(contact), 1.2e4)),
              ElementsAre(HasSubstr("rises up to 2.267e+04 N and is no good near that")));
}

// 7.535 um and 1.731 um at 1 kN, 4.248 um with exponent 3: the reference pages' numbers.
TEST(UnitDependence, TellsWhatTheUnitChangesOnceUnlessItIsStated) {
  Contact contact = impactrig::tests::paper_rig().contact;
  contact.reference_length.reset();
  const double depth = penetration_at(elastic_law(contact), 1000.0);
  const std::string told = unit_dependence(contact, depth);
  EXPECT_THAT(told, HasSubstr("1000 N press 7.535 um deep; in millimetres 1.731 um; the "
                              "consistent exponent 3 gives 4.248 um"));
  contact.reference_length = 1.0;
  EXPECT_EQ(unit_dependence(contact, depth), "");
  contact.reference_length.reset();
  contact.exponent = 3;
  EXPECT_EQ(unit_dependence(contact, depth), "");
}

}  // namespace
