// SPDX-License-Identifier: BSD-3-Clause
// The check values beside the project, all of them; skipped where they are absent. The other tests
// of the laws have copies of those they need.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "models/contact/damping/exact.hpp"
#include "models/contact/elastic/hertz_point.hpp"
#include "models/contact/free_impact.hpp"
#include "models/simulation.hpp"
#include "tests/support/places.hpp"

namespace {

using namespace impactrig::models;
using nlohmann::json;

/// Null where the check values are absent.
json checks(const std::string& name) {
  std::ifstream file(impactrig::tests::shared_dir + "/reference/checks/" + name);
  return file ? json::parse(file) : json();
}

Contact contact_of(const json& geometry) {
  Contact contact;
  contact.position = 0.69;
  contact.counterface = geometry["internal"] ? Counterface::groove : Counterface::cylinder;
  contact.radius = geometry["R1"];
  contact.counter_radius = geometry["R2"];
  contact.length = geometry["L"];
  contact.modulus = geometry["E1"];
  contact.poisson_ratio = geometry["nu1"];
  contact.counter_modulus = geometry["E2"];
  contact.counter_poisson_ratio = geometry["nu2"];
  return contact;
}

const std::map<std::string, std::string> elastic_names = {
    {"goldsmith_m1", "goldsmith"},
    {"dubowsky_freudenstein_m3", "dubowsky-freudenstein"},
    {"johnson", "johnson"},
    {"esdu78035", "esdu-78035"},
    {"radzimovsky_k160", "radzimovsky-1.60"},
    {"radzimovsky_fullwidth", "radzimovsky"},
    {"hertz_point_R_equiv", "hertz-point"},
};

const std::map<std::string, std::string> damping_names = {
    {"elastic", "none"},
    {"hunt_crossley_1975", "hunt-crossley"},
    {"herbert_mcwhannell_1977", "herbert-mcwhannell"},
    {"lee_wang_1983", "lee-wang"},
    {"lankarani_nikravesh_1990", "lankarani-nikravesh"},
    {"gonthier_2004_closed", "gonthier"},
    {"zhiying_qishao_2006", "zhiying-qishao"},
    {"flores_2011", "flores"},
    {"hu_guo_2015", "hu-guo"},
    {"carvalho_martins_2019_rational", "carvalho-martins"},
    {"safaeifar_farshidianfar_2020", "safaeifar-farshidianfar"},
    {"exact", "exact"},
};

/// Largest relative deviation, told at the end of a test.
class Deviation {
 public:
  explicit Deviation(double bound) : bound_(bound) {}

  void add(double found, double expected, double floor = 0.0) {
    const double off = std::abs(found - expected) / std::max(std::abs(expected), floor);
    worst_ = std::max(worst_, off);
    EXPECT_LE(off, bound_) << found << " instead of " << expected;
  }

  ~Deviation() { testing::Test::RecordProperty("worst", fmt::format("{:.2g}", worst_)); }

 private:
  double bound_, worst_ = 0.0;
};

TEST(CheckValues, OfTheLogarithmicLaws) {
  const json file = checks("contact_log_laws.json");
  if (file.is_null()) GTEST_SKIP() << "no check values beside the project";
  Deviation deviation(file["rtol"]);
  for (const json& check : file["cases"]) {
    SCOPED_TRACE(check["id"]);
    Contact contact = contact_of(file["geometries"][check["geometry"].get<std::string>()]);
    contact.law = elastic_names.at(check["law"]);
    const auto law = std::get<LogarithmicContact<>>(elastic_law(contact));
    deviation.add(law.compliance, check["A"]);
    deviation.add(law.limit_force, check["f_star"]);
    for (const json& point : check["points"]) {
      deviation.add(law.penetration(point["f"]), point["delta"]);
      deviation.add(law.force(point["delta"]), point["f"]);
      deviation.add(law.stiffness(point["delta"]), point["df_ddelta"]);
      deviation.add(law.energy(point["delta"]), point["energy"]);
      deviation.add(law.penetration_storing(point["energy"]), point["delta"]);
    }
  }
}

TEST(CheckValues, OfTheOtherLaws) {
  const json file = checks("contact_other_laws.json");
  if (file.is_null()) GTEST_SKIP() << "no check values beside the project";
  Deviation deviation(file["rtol"]);
  for (const json& check : file["cases"]) {
    const std::string name = check["law"];
    SCOPED_TRACE(check.dump());
    Contact contact;
    if (check.contains("geometry"))
      contact = contact_of(file["geometries"][check["geometry"].get<std::string>()]);
    if (name == "liu_2007" || name == "hertz_point_R_equiv") {
      contact.law = name == "liu_2007" ? "liu" : "hertz-point";
      const ElasticLaw law = elastic_law(contact);
      deviation.add(elastic_force(law, check["delta"]), check["f"]);
      deviation.add(force_and_stiffness(law, check["delta"]).stiffness, check["df_ddelta"]);
      deviation.add(penetration_at(law, check["f"]), check["delta"]);
      if (check.contains("K")) deviation.add(std::get<PowerContact<>>(law).factor, check["K"]);
    } else if (name == "palmgren") {
      contact.law = name;
      const ElasticLaw law = elastic_law(contact);
      deviation.add(penetration_at(law, check["f"]), check["delta"]);
      deviation.add(force_and_stiffness(law, check["delta"]).stiffness, check["df_ddelta"]);
    } else if (name == "pereira_2015_internal") {
      contact.law = "pereira";
      contact.radius = 0.01;
      contact.counter_radius = 0.01 + 1e-3 * check["dR_mm"].get<double>();
      contact.length = 1e-3 * check["L_mm"].get<double>();
      // two equal sides of ν = 0: E* = E / 2
      contact.modulus = contact.counter_modulus = 2e6 * check["Estar_MPa"].get<double>();
      const auto law = std::get<PowerContact<>>(elastic_law(contact));
      deviation.add(law.power, check["n"]);
      const double depth = 1e-3 * check["delta_mm"].get<double>();
      deviation.add(law.force(depth), check["f_N"]);
      deviation.add(law.stiffness(depth), 1e3 * check["df_ddelta_N_per_mm"].get<double>());
    } else if (name == "persson_identical_materials") {
      // a pin of R and R + ΔR with E* L ΔR = 1 N
      const PerssonContact<> law{1.0, 1e-5};
      const double half_angle = check["half_angle_deg"].get<double>() * std::numbers::pi / 180.0;
      const double depth = 1e-5 * (1.0 / std::cos(half_angle) - 1.0);
      const double limit = law.limit_penetration();
      if (depth < limit) deviation.add(law.force(depth), check["q_over_EstardR"]);
    } else if (name == "persson_identical_materials_limit") {
      // the range used ends at 0.9 of b² there
      const PerssonContact<> law{1.0, 1e-5};
      const double x = law.limit_penetration() / (2e-5 + law.limit_penetration());
      deviation.add(x / 0.9, std::pow(check["b_limit"].get<double>(), 2));
    } else if (name == "hertz_half_width") {
      contact.law = "johnson";
      deviation.add(half_width(contact, check["f"]), check["a"]);
    } else {
      ADD_FAILURE() << "a check of an unknown law";
    }
  }
}

TEST(CheckValues, OfTheProportionalDampingLaws) {
  const json file = checks("restitution_map_proportional.json");
  if (file.is_null()) GTEST_SKIP() << "no check values beside the project";
  Deviation deviation(file["rtol"]);
  for (const json& check : file["cases"]) {
    SCOPED_TRACE(check["law"]);
    const DampingLaw& law = damping_law(damping_names.at(check["law"]));
    for (std::size_t i = 0; i < check["e_in"].size(); ++i) {
      const double d = law.factor(check["e_in"][i]);
      deviation.add(d, check["d"][i], 1e-6);
      deviation.add(free_rebound_ratio(d), check["e_out"][i]);
    }
  }
}

/// Rebound of a mass of 0.7 kg at 0.441 m/s.
double rebound(Contact contact, const std::string& damping, double e, bool may_pull) {
  contact.damping = damping;
  contact.restitution = e;
  contact.tension = may_pull ? Tension::allow : Tension::clip;
  ContactForce force(contact, 0.7);
  force.begin_episode(0.441);
  return free_impact(force, 0.7, 0.441).rebound_ratio;
}

TEST(CheckValues, OfTheOtherDampingLaws) {
  const json file = checks("restitution_map_other.json");
  if (file.is_null()) GTEST_SKIP() << "no check values beside the project";
  Deviation deviation(file["rtol"]);
  const json geometry = checks("contact_log_laws.json")["geometries"]["G1_paper_internal"];
  Contact goldsmith = contact_of(geometry), hertz = goldsmith, linear = goldsmith;
  hertz.law = "hertz-point";
  linear.law = "linear";
  linear.stiffness = 1e8;

  struct Case {
    const char* key;
    const Contact& contact;
    const char* damping;
    bool may_pull;
  };

  for (const Case& c : {Case{"kv_linear_delta", linear, "viscous", true},
                        {"kv_linear_force", linear, "viscous", false},
                        {"tsuji_antypov_delta", hertz, "tsuji", true},
                        {"tsuji_antypov_force", hertz, "tsuji", false},
                        {"tsuji_marshall_delta", hertz, "tsuji-marshall", true},
                        {"tsuji_marshall_force", hertz, "tsuji-marshall", false},
                        {"tsuji_tangent_delta", hertz, "tangent", true},
                        {"tsuji_tangent_force", hertz, "tangent", false},
                        {"jankowski", hertz, "jankowski", true},
                        {"gold_tan_delta", goldsmith, "tangent", true},
                        {"gold_tan_force", goldsmith, "tangent", false},
                        {"mismatch_exact", goldsmith, "hertz-hysteresis", false},
                        {"implicit_HM", goldsmith, "herbert-mcwhannell-implicit", false},
                        {"implicit_LN", goldsmith, "lankarani-nikravesh-implicit", false}}) {
    SCOPED_TRACE(c.key);
    const json& values = file["values"][c.key];
    ASSERT_EQ(values.size(), file["e_in"].size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (values[i].is_null()) continue;
      deviation.add(rebound(c.contact, c.damping, file["e_in"][i], c.may_pull), values[i]);
    }
  }
}

/// A rigid bar without weight whose point before the stop has a mass.
Rig rigid_bar(const Contact& contact, double mass, double speed) {
  Rig rig;
  rig.beam.length = 1.0;
  rig.beam.area = 1e-4;
  rig.beam.second_moment = 1e-9;
  rig.beam.youngs_modulus = 2e11;
  rig.contact = contact;
  rig.beam.density = 3.0 * mass * contact.position * contact.position / rig.beam.area;
  rig.start.velocity = speed;
  rig.gravity = 0.0;
  return rig;
}

TEST(CheckValues, OfFreeImpactsBothWays) {
  const json file = checks("free_impact.json");
  if (file.is_null()) GTEST_SKIP() << "no check values beside the project";
  Deviation deviation(file["rtol"]);
  for (const json& check : file["cases"]) {
    SCOPED_TRACE(check["id"]);
    const double mass = check["m"], speed = check["v0"];
    Contact contact = contact_of(file["geometry"]);
    contact.law = elastic_names.at(check["law"]);
    contact.damping = damping_names.at(check["damping"]);
    contact.restitution = check["e_in"];

    ContactForce force(contact, mass);
    force.begin_episode(speed);
    const FreeImpact alone = free_impact(force, mass, speed);
    deviation.add(force.damping_factor(), check["d"], 1e-6);
    deviation.add(alone.rebound_ratio, check["e_newton"]);
    deviation.add(alone.duration, check["t_contact"]);
    deviation.add(alone.max_penetration, check["delta_max"]);

    const Rig rig = rigid_bar(contact, mass, speed);
    ASSERT_NEAR(rig.effective_mass(0), mass, 1e-14);
    Solver solver;
    solver.model = BeamModel::rigid;
    solver.accuracy = 1e-9;
    solver.duration = 1.0;
    const Simulation bar = simulate(rig, solver);
    const Episode& first = bar.episodes.front();
    deviation.add(bar.restitution.kinematic, check["e_newton"]);
    deviation.add(bar.restitution.kinetic, check["e_newton"]);
    deviation.add(bar.restitution.energetic, check["e_newton"]);
    deviation.add(first.end, check["t_contact"]);
    deviation.add(first.max_penetration, check["delta_max"]);
    deviation.add(first.peak_force, check["f_max"]);
    deviation.add(first.peak_time, check["t_f_max"]);
    deviation.add(first.impulse, check["impulse"]);
    deviation.add(first.dissipated, check["energy_loss"], 0.01 * 0.5 * mass * speed * speed);
  }
}

}  // namespace
