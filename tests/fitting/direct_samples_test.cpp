// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "acquisition/conditioning/condition.hpp"
#include "acquisition/importer.hpp"
#include "fitting/direct_restitution.hpp"
#include "models/simulation.hpp"
#include "tests/support/places.hpp"

namespace impactrig::fitting {
namespace {

const std::string samples = impactrig::tests::source_dir + "/datasets/samples/";

/// Noise, hum, drift, offsets, gains and delays of a laboratory day; truth beside each. What the
/// truth file leaves out is what the simulation that made the shot says.
TEST(DirectRestitution, AgreesWithTheTruthOfTheShippedShots) {
  const RigFile rig = read_rig_file(samples + "shen2007.toml");
  for (const char* name : {"1.uff", "2.uff", "3.csv", "4.csv"}) {
    const std::string file = samples + "shen2007-" + name;
    std::ifstream stream(file.substr(0, file.rfind('.')) + ".truth.json");
    const auto truth = nlohmann::json::parse(stream);
    const auto number = [&](const char* key) { return truth[key].get<double>(); };
    models::Rig true_rig = rig.rig;
    true_rig.contact.restitution = number("contact.restitution");
    true_rig.contact.stiffness_factor = number("contact.stiffness_factor");
    true_rig.start.velocity = number("start.velocity");
    models::Solver solver = rig.solver;
    solver.duration = 0.5e-3;
    const models::Simulation run = models::simulate(true_rig, solver);
    ASSERT_NEAR(run.restitution.kinematic, number("kinematic_restitution"), 1e-3) << name;

    const auto record = acquisition::read_into_memory(*acquisition::open_recording(file));
    const auto impacts = acquisition::find_impacts(
        acquisition::condition(record, {rig.force, rig.velocity, rig.displacement}));
    ASSERT_EQ(impacts.size(), 1u) << name;
    const DirectRestitution direct = direct_restitution(impacts[0], rig);
    const auto check = [&](const DirectEstimate& e, double value, double widest) {
      EXPECT_LE(e.ci95[0], value) << name << ": " << e.value << " ± " << e.std_error;
      EXPECT_GE(e.ci95[1], value) << name << ": " << e.value << " ± " << e.std_error;
      EXPECT_LT(e.std_error, widest * value) << name;  // and says something
    };
    check(direct.kinematic, run.restitution.kinematic, 0.2);
    check(direct.kinetic, run.restitution.kinetic, 0.05);
    check(direct.energetic, run.restitution.energetic, 0.05);
    const models::Episode& first = run.episodes.front();
    check(direct.hysteresis.dissipated, first.dissipated, 0.2);
    check(direct.hysteresis.max_penetration, first.max_penetration, 0.05);
  }
}

}  // namespace
}  // namespace impactrig::fitting
