// SPDX-License-Identifier: BSD-3-Clause
// A number for every law, so that a wrong constant in any of them is found wherever the project is
// built. The depths are those of the reference pages' check values (contact_log_laws,
// contact_other_laws), and where these have none, of the printed formulas, worked out with 40
// digits apart from this code: the logarithmic laws from half or full width, Persson's from its
// angle. Factors and rebounds are the check values restitution_map_proportional and
// restitution_map_other, damping ratios their formulas with 40 digits.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "models/contact/damping/exact.hpp"
#include "models/contact/elastic_law.hpp"
#include "models/contact/free_impact.hpp"
#include "tests/models/scenes.hpp"

namespace {

using namespace impactrig::models;

enum class Pair {
  paper,     ///< aluminium bar in its groove, Shen et al.
  cylinder,  ///< steel on a bronze cylinder
  plane      ///< the same bar on a bronze plate of 40 mm
};

Contact contact_of(Pair pair, std::string_view law) {
  Contact contact = impactrig::tests::paper_rig().contact;
  contact.law = law;
  contact.stiffness = law == "linear" ? 1e8 : 1.6e10;
  contact.power = 1.5;
  if (pair == Pair::paper) return contact;
  contact.counterface = pair == Pair::cylinder ? Counterface::cylinder : Counterface::plane;
  contact.radius = 0.01;
  contact.counter_radius = 0.025;
  contact.counter_depth = 0.04;
  contact.length = 0.03;
  contact.modulus = 2.06e11;
  contact.counter_modulus = 1.1e11;
  contact.poisson_ratio = 0.3;
  contact.counter_poisson_ratio = 0.34;
  return contact;
}

struct Depth {
  std::string_view law;
  Pair pair;
  double at_one_kilonewton;  // [m]
};

constexpr Depth depths[] = {
    {"goldsmith", Pair::paper, 7.535020663451824e-06},
    {"goldsmith", Pair::cylinder, 2.878935525209325e-06},
    {"goldsmith", Pair::plane, 2.834461323924642e-06},
    {"dubowsky-freudenstein", Pair::paper, 4.24819970446109e-06},
    {"dubowsky-freudenstein", Pair::cylinder, 1.9519564477803403e-06},
    {"dubowsky-freudenstein", Pair::plane, 1.907482246495658e-06},
    {"esdu-78035", Pair::paper, 4.653622693006432e-06},
    {"esdu-78035", Pair::cylinder, 1.9658827818751775e-06},
    {"johnson", Pair::paper, 3.813438227212113e-06},
    {"johnson", Pair::cylinder, 1.7015269364640798e-06},
    {"johnson", Pair::plane, 1.695561005023385e-06},
    {"radzimovsky", Pair::paper, 3.931220455091783e-06},
    {"radzimovsky", Pair::cylinder, 1.738585965395418e-06},
    {"radzimovsky-1.60", Pair::paper, 4.22018156035317e-06},
    {"radzimovsky-1.60", Pair::cylinder, 1.8295047580918301e-06},
    {"radzimovsky-half-width", Pair::paper, 4.513591948707379e-06},
    {"radzimovsky-half-width", Pair::cylinder, 1.921823474306661e-06},
    {"liu", Pair::paper, 1.525646281329378e-05},
    {"palmgren", Pair::paper, 4.693174161143753e-06},
    {"palmgren", Pair::cylinder, 1.72626966986099e-06},
    {"brandlein", Pair::paper, 1.751759437244161e-06},
    {"brandlein", Pair::cylinder, 1.266489106413639e-06},
    {"pereira", Pair::paper, 3.675031687121219e-06},
    {"pereira", Pair::cylinder, 1.620035612151044e-06},
    {"persson", Pair::paper, 8.401138985128246e-07},
    {"lankarani-nikravesh-cylinder", Pair::paper, 1.574901312368591e-05},
    {"hertz-point", Pair::paper, 1.551174855019891e-05},
    {"hertz-point", Pair::cylinder, 2.303404551188572e-05},
    {"linear", Pair::paper, 1e-5},
};

TEST(ElasticConstants, PressAsDeepAtOneKilonewtonAsTheReferenceSays) {
  for (const Depth& row : depths) {
    SCOPED_TRACE(testing::Message() << row.law << ", pair " << static_cast<int>(row.pair));
    const ElasticLaw law = elastic_law(contact_of(row.pair, row.law));
    EXPECT_NEAR(penetration_at(law, 1000.0) / row.at_one_kilonewton, 1.0, 1e-13);
    EXPECT_NEAR(elastic_force(law, row.at_one_kilonewton) / 1000.0, 1.0, 1e-13);
  }
}

// Pereira's other branch, of small clearances: check value of contact_other_laws, ΔR = 0.1 mm.
TEST(ElasticConstants, OfPereirasSmallClearances) {
  Contact contact = contact_of(Pair::paper, "pereira");
  contact.counter_radius = contact.radius + 1e-4;
  const ElasticLaw law = elastic_law(contact);
  EXPECT_NEAR(elastic_force(law, 5e-6) / 2366.636701811995, 1.0, 1e-10);
}

TEST(ElasticConstants, AreHeldForEveryLaw) {
  for (const ElasticLawEntry& law : elastic_laws())
    EXPECT_TRUE(std::ranges::count(depths, law.text.name, &Depth::law) > 0)
        << law.text.name << " has no number here";
}

TEST(HalfWidth, OfThePapersContactAtOneKilonewton) {
  EXPECT_NEAR(half_width(contact_of(Pair::paper, "johnson"), 1000.0) / 0.00042004611391703995, 1.0,
              1e-13);
}

/// Of a mass of 0.7 kg at 0.441 m/s.
double rebound(const Contact& contact) {
  ContactForce force(contact, 0.7);
  force.begin_episode(0.441);
  return free_impact(force, 0.7, 0.441).rebound_ratio;
}

/// d or ζ at a restitution, and what a free impact of 0.7 kg at 0.441 m/s rebounds with beside
/// an elastic law.
struct Damping {
  std::string_view law, beside;
  Tension tension;
  double restitution, factor, rebound;
};

constexpr Tension clip = Tension::clip, allow = Tension::allow;

constexpr Damping dampings[] = {
    {"none", "goldsmith", clip, 0.5, 0.0, 1.0},                                               //
    {"none", "goldsmith", clip, 0.8, 0.0, 1.0},                                               //
    {"lankarani-nikravesh", "goldsmith", clip, 0.5, 0.5625, 0.7252411140101973},              //
    {"lankarani-nikravesh", "goldsmith", clip, 0.8, 0.27, 0.8471022797876164},                //
    {"exact", "goldsmith", clip, 0.5, 1.4327505332713744, 0.5},                               //
    {"exact", "goldsmith", clip, 0.8, 0.37314620336505366, 0.8},                              //
    {"hunt-crossley", "goldsmith", clip, 0.5, 0.75, 0.662962200001546},                       //
    {"hunt-crossley", "goldsmith", clip, 0.8, 0.3, 0.8328697922656016},                       //
    {"herbert-mcwhannell", "goldsmith", clip, 0.5, 1.0, 0.5936242600400401},                  //
    {"herbert-mcwhannell", "goldsmith", clip, 0.8, 0.35714285714285704, 0.8069800661849895},  //
    {"lee-wang", "goldsmith", clip, 0.5, 0.375, 0.7991987821935678},                          //
    {"lee-wang", "goldsmith", clip, 0.8, 0.15, 0.9090157413492024},                           //
    {"gonthier", "goldsmith", clip, 0.5, 1.5, 0.4877412560153485},                            //
    {"gonthier", "goldsmith", clip, 0.8, 0.45, 0.7679997890784758},                           //
    {"zhiying-qishao", "goldsmith", clip, 0.5, 1.5290335285082128, 0.48260802056123026},      //
    {"zhiying-qishao", "goldsmith", clip, 0.8, 0.4027926683631428, 0.787364919124652},        //
    {"flores", "goldsmith", clip, 0.5, 1.6, 0.4704447793267395},                              //
    {"flores", "goldsmith", clip, 0.8, 0.4, 0.7885391259070652},                              //
    {"hu-guo", "goldsmith", clip, 0.5, 1.5, 0.4877412560153485},                              //
    {"hu-guo", "goldsmith", clip, 0.8, 0.375, 0.7991987821935679},                            //
    {"carvalho-martins", "goldsmith", clip, 0.5, 1.4318181818181819, 0.5001736883638876},     //
    {"carvalho-martins", "goldsmith", clip, 0.8, 0.373170731707317, 0.7999893888976248},      //
    {"safaeifar-farshidianfar", "goldsmith", clip, 0.5, 1.25, 0.536160360182188},             //
    {"safaeifar-farshidianfar", "goldsmith", clip, 0.8, 0.3125, 0.827073013253193},           //
    // Hunt and Crossley's d at the first contact's speed
    {"marhefka-orin", "goldsmith", clip, 0.5, 0.75, 0.662962200001546},                      //
    {"marhefka-orin", "goldsmith", clip, 0.8, 0.3, 0.8328697922656016},                      //
    {"lankarani-nikravesh-implicit", "goldsmith", clip, 0.5, 0.5625, 0.703257409549761},     //
    {"lankarani-nikravesh-implicit", "goldsmith", clip, 0.8, 0.27, 0.8437326195376342},      //
    {"herbert-mcwhannell-implicit", "goldsmith", clip, 0.6, 0.7894736842105264, 0.6},        //
    {"herbert-mcwhannell-implicit", "goldsmith", clip, 0.8, 0.35714285714285704, 0.8},       //
    {"viscous", "linear", clip, 0.5, 0.2154537619662468, 0.5502831696276165},                //
    {"viscous", "linear", clip, 0.8, 0.07085030019536806, 0.8080993352546171},               //
    {"viscous", "linear", allow, 0.5, 0.2154537619662468, 0.5},                              //
    {"viscous", "linear", allow, 0.8, 0.07085030019536806, 0.8},                             //
    {"tsuji", "hertz-point", clip, 0.5, 0.2154537619662468, 0.550283169667643},              //
    {"tsuji", "hertz-point", clip, 0.8, 0.07085030019536806, 0.8080993353076709},            //
    {"tsuji-marshall", "hertz-point", allow, 0.5, 0.2155032932698622, 0.49991645210594104},  //
    {"tsuji-marshall", "hertz-point", allow, 0.8, 0.07128038161835475, 0.798911588250883},   //
    {"tsuji-exact", "hertz-point", clip, 0.5, 0.2552756376486518, 0.5},                      //
    {"tsuji-exact", "hertz-point", clip, 0.8, 0.07435509709764061, 0.8},                     //
    {"tangent", "hertz-point", clip, 0.5, 0.2154537619662468, 0.5234632311593433},           //
    {"tangent", "hertz-point", clip, 0.8, 0.07085030019536806, 0.7925744148046289},          //
    {"tangent", "goldsmith", allow, 0.5, 0.2154537619662468, 0.4946965843369961},            //
    {"tangent", "goldsmith", allow, 0.8, 0.07085030019536806, 0.7973400876619543},           //
    {"jankowski", "hertz-point", clip, 0.5, 0.6818152877577169, 0.494587797266753},          //
    {"jankowski", "hertz-point", clip, 0.8, 0.1753730096703566, 0.7989438436709873},         //
    {"hertz-hysteresis", "goldsmith", clip, 0.5, 1.4327505332713744, 0.6949218065087683},    //
    {"hertz-hysteresis", "goldsmith", clip, 0.8, 0.37314620336505366, 0.8932369872893431},   //
    // its τ is found for the rebound; 1 − e only begins the search
    {"kuwabara-kono", "goldsmith", clip, 0.5, 0.5, 0.5},  //
    {"kuwabara-kono", "goldsmith", clip, 0.8, 0.2, 0.8},  //
};

TEST(DampingConstants, AreThoseOfTheReferenceAndReboundAsItSays) {
  for (const Damping& row : dampings) {
    SCOPED_TRACE(testing::Message()
                 << row.law << " beside " << row.beside << ", e " << row.restitution);
    EXPECT_NEAR(damping_law(row.law).factor(row.restitution), row.factor, 1e-12 * row.factor);
    Contact contact = contact_of(Pair::paper, row.beside);
    contact.damping = row.law;
    contact.restitution = row.restitution;
    contact.tension = row.tension;
    EXPECT_NEAR(rebound(contact) / row.rebound, 1.0, 2e-6);
  }
}

TEST(DampingConstants, AreHeldForEveryLaw) {
  for (const DampingLaw& law : damping_laws())
    EXPECT_TRUE(std::ranges::count(dampings, law.text.name, &Damping::law) > 0)
        << law.text.name << " has no number here";
}

// β = (3/2) A (K/m)^(2/5) v^(1/5) = 0.05 beside Hertz's spring: the reference pages' simulation,
// whose series in β is 0.944472 without and 0.944323 with tension.
TEST(DampingConstants, OfAViscoelasticSphere) {
  Contact contact = contact_of(Pair::paper, "hertz-point");
  contact.damping = "kuwabara-kono";
  const double stiffness = 16368499363.978703;
  contact.relaxation_time = 0.05 / (1.5 * std::pow(stiffness / 0.7, 0.4) * std::pow(0.441, 0.2));
  contact.tension = clip;
  EXPECT_NEAR(rebound(contact), 0.944397, 1e-6);
  contact.tension = allow;
  EXPECT_NEAR(rebound(contact), 0.944260, 1e-6);
}

}  // namespace
