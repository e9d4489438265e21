// SPDX-License-Identifier: BSD-3-Clause
#include "reports/text.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "reports/direct_wording.hpp"
#include "reports/report_data.hpp"
#include "tests/reports/example_report.hpp"

namespace {

using namespace impactrig;
using testing::HasSubstr;
using testing::Not;

TEST(FitText, EndsWithWhyItDidNotConverge) {
  reports::ReportData data = tests::example_report();
  EXPECT_THAT(reports::to_text(data), Not(HasSubstr("did not converge")));
  data.fit.termination = "stopped after 61 iterations without converging";
  EXPECT_THAT(
      reports::to_text(data),
      testing::EndsWith("\nwarning: The fit did not converge: stopped after 61 iterations "
                        "without converging. Values and intervals are provisional. Start "
                        "nearer to the answer (--set), or free fewer parameters (--free).\n"));
}

TEST(FitText, SaysOfWhichRecordingItSpeaks) {
  const reports::ReportData one = tests::example_report(), three = tests::example_report(3);
  EXPECT_THAT(reports::to_text(one), HasSubstr("\nRestitution: four different numbers"));
  EXPECT_THAT(reports::to_text(one), HasSubstr("\nResiduals\n  force "));
  const std::string text = reports::to_text(three);
  for (const datasets::Impact& impact : three.fit.impacts)
    EXPECT_THAT(text, testing::ContainsRegex("\n  " + impact.recording + ": force  +[0-9.]+ N"))
        << text;
  EXPECT_THAT(text, HasSubstr("\nRestitution of " + three.fit.impacts[0].recording + ": four"));
}

TEST(FitText, SaysWhatIsNotIdentifiable) {
  reports::ReportData data = tests::example_report();
  constexpr double not_known = std::numeric_limits<double>::quiet_NaN();
  fitting::Parameter& e = data.fit.parameters[0];
  e.identifiable = false;
  e.std_error = e.mesh_shift = e.mesh_error = e.ci95[0] = e.ci95[1] = not_known;
  data.fit.restitution["law"].ci95 = data.fit.restitution["kinetic"].ci95 = e.ci95;
  data.fit.bootstrap = fitting::Bootstrap{.draws = 40};
  data.fit.bootstrap->parameters = {
      {.name = e.name, .bias = not_known, .std_error = not_known, .ci95 = e.ci95}};
  const std::string text = reports::to_text(data);
  EXPECT_THAT(text, testing::ContainsRegex("contact.restitution +0.512   not identifiable"));
  EXPECT_THAT(text, HasSubstr("  law            0.512   not identifiable   in the damping law\n"));
  EXPECT_THAT(text, testing::ContainsRegex("kinetic +[0-9.]+   not identifiable"));
  EXPECT_THAT(text, HasSubstr("  contact.restitution             not identifiable\n"));
  EXPECT_THAT(text, Not(testing::ContainsRegex("[^a-z]nan[^a-z]")));
  EXPECT_THAT(reports::to_html(data), Not(testing::ContainsRegex("[>( ]nan[<) ]")));
  EXPECT_THAT(reports::to_html(data), HasSubstr("is 0.5120; these data cannot tell it."));
}

TEST(FitText, SetsTheModelAgainstWhatTheRecordShows) {
  const std::string text = reports::to_text(tests::example_report());
  EXPECT_THAT(text, HasSubstr("Read directly from the record, without a model\n  kinematic  "));
  EXPECT_THAT(text, HasSubstr("(mostly relative delay)"));
  EXPECT_THAT(text, HasSubstr("is outside the direct interval"));
}

// A damper that would pull gives no force: the record shows its end, 20 us before the surfaces
// part.
TEST(FitText, SetsTheSpeedAtTheForcesEndAgainstTheRecords) {
  reports::ReportData data = tests::example_report();
  models::Simulation& run = data.fit.predictions.front();
  const std::string as_is = reports::direct_explanation(data.fit, 0);
  EXPECT_THAT(as_is, Not(HasSubstr("before its surfaces part")));
  models::History& h = run.history;
  const auto parted = static_cast<std::size_t>((run.episodes.front().end - h.start) / h.interval);
  for (std::size_t k = parted - 20; k <= parted; ++k) h.force[k] = 0.0;
  const double speed = -0.5 * (h.velocity[parted - 21] + h.velocity[parted - 20]);
  const auto pairs = reports::direct_pairs(data.fit, 0);
  EXPECT_DOUBLE_EQ(pairs[0].fitted, speed / run.episodes.front().approach_velocity);
  EXPECT_THAT(reports::direct_explanation(data.fit, 0),
              HasSubstr("The model's force ends 21\u00A0\u00B5s before its surfaces part"));
  // a record of that force is as long as the model has it
  const double force_ends = h.start + h.interval * (static_cast<double>(parted) - 20.5);
  data.fit.impacts[0].end = data.fit.impacts[0].start + force_ends - run.episodes.front().start;
  EXPECT_THAT(
      reports::to_html(data),
      testing::ContainsRegex("Duration of the first contact[^\n]*predicted [^(]*\\([+-]?0[.]0"));
}

// The model's mean speed away is minus that of its velocity over the same stretch.
TEST(FitText, SetsTheReboundOfADisplacementAloneBesideTheModels) {
  reports::ReportData data = tests::example_report();
  const models::Simulation& run = data.fit.predictions.front();
  const models::History& h = run.history;
  datasets::Impact& impact = data.fit.impacts.front();
  const auto first = static_cast<std::size_t>((1e-3 - h.start) / h.interval), last = first + 500;
  ASSERT_LT(last, h.velocity.size());
  const auto since_touch = [&h](std::size_t k) {
    return h.start + h.interval * static_cast<double>(k);
  };
  // the fit has another touch than the displacement alone
  const double touch = impact.start + 52e-6;
  std::erase_if(data.fit.parameters, [](const auto& p) { return p.name == "impact.time"; });
  fitting::Parameter time = data.fit.parameters.front();
  time.name = "impact.time";
  time.value = touch;
  data.fit.parameters.push_back(time);
  impact.rebound = datasets::Rebound{.approach_error = 0.002,
                                     .from = touch + since_touch(first),
                                     .to = touch + since_touch(last),
                                     .velocity = 0.05,
                                     .velocity_error = 0.004,
                                     .restitution = 0.11,
                                     .restitution_error = 0.01,
                                     .absent = {}};
  double mean = 0.0;
  for (std::size_t k = first; k < last; ++k)
    mean -= 0.5 * (h.velocity[k] + h.velocity[k + 1]) / 500.0;
  auto pairs = reports::direct_pairs(data.fit, 0);
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_EQ(pairs[0].fitted, run.episodes.front().approach_velocity);
  EXPECT_NEAR(pairs[1].fitted, mean / run.episodes.front().approach_velocity, 1e-4);
  EXPECT_EQ(pairs[1].direct.value, 0.11);
  impact.force.reset();  // its peak is none in N
  const std::string text = reports::to_text(data);
  EXPECT_THAT(text, testing::ContainsRegex("first touch at [^\n]* s, back there after"));
  EXPECT_THAT(text, HasSubstr("\n  mean rebound over approach "));
  EXPECT_THAT(text, HasSubstr("there is no direct kinematic, kinetic or energetic restitution."));
  const std::string page = reports::to_html(data);
  EXPECT_THAT(page, HasSubstr("Speed of approach"));
  EXPECT_THAT(page, testing::ContainsRegex("Duration of the first contact[^\n]*not measured"));

  impact.rebound->to = touch + since_touch(h.velocity.size() + 5);
  EXPECT_TRUE(std::isnan(reports::direct_pairs(data.fit, 0)[1].fitted));
  EXPECT_THAT(reports::direct_explanation(data.fit, 0), HasSubstr("its history ends before"));
  impact.rebound->absent = "The bar is struck again.";
  EXPECT_THAT(reports::direct_explanation(data.fit, 0),
              HasSubstr("No mean rebound over approach: The bar is struck again."));
}

// e = 1 of a law without damping, or an e beside a stated coefficient, decides nothing.
TEST(RestitutionText, SaysWhereTheLawTakesNone) {
  reports::ReportData data = tests::example_report();
  models::Contact& contact = data.fit.rig.rig.contact;
  contact.restitution = data.fit.predictions.front().restitution.law = 0.5;
  const auto simulated = [&] {
    return reports::to_text(data.fit.predictions.front(), data.fit.rig.rig);
  };
  EXPECT_THAT(simulated(), HasSubstr(", e = 0.5\n"));
  EXPECT_THAT(simulated(), HasSubstr("restitution       law 0.5, kinematic "));
  EXPECT_THAT(reports::to_text(data), HasSubstr("in the damping law\n"));
  const auto expect_unused = [&] {
    EXPECT_THAT(simulated(), Not(HasSubstr("e = 0.5")));
    EXPECT_THAT(simulated(), HasSubstr("restitution       law not used by this law, kinematic "));
    EXPECT_THAT(reports::to_text(data), HasSubstr("not used by this law\n"));
    EXPECT_THAT(reports::to_text(data), Not(HasSubstr("in the damping law")));
  };
  contact.damping = "none";
  expect_unused();
  contact.damping = "kuwabara-kono";
  EXPECT_THAT(simulated(), HasSubstr("law 0.5, kinematic "));
  contact.relaxation_time = 1e-6;
  expect_unused();
  contact.relaxation_time.reset();
  contact.damping = "viscous";
  contact.viscous = 300.0;
  expect_unused();
}

// Of a stop that gives way some of it is there.
TEST(Text, EnergyIsAllAccountedFor) {
  models::Simulation run = tests::example_report().fit.predictions.front();
  run.energy = {.initial = 2.0,
                .dissipated = 0.4,
                .damped = 0.2,
                .stop = 0.6,
                .rigid_rotation = 0.8,
                .vibration = -1e-9};
  EXPECT_THAT(
      reports::to_text(run, tests::example_report().fit.rig.rig),
      testing::HasSubstr("2 J: 20.00 % lost in the contact, 10.00 % damped in bar, hinge and "
                         "stop, 0.00 % in vibration, 30.00 % in the stop, 40.00 % in "
                         "rotation; "));
}

// A bar laid on its stop has none at touch: what its weight sets free is what parts are of.
TEST(Text, EnergyOfASlowTouchIsWhatItsWeightSetsFree) {
  models::Simulation run = tests::example_report().fit.predictions.front();
  run.energy = {.initial = 1e-18,
                .kinetic = 0.5e-3,
                .elastic = 1e-3,
                .dissipated = 0.5e-3,
                .vibration = 1e-3,
                .imbalance = 2e12};
  EXPECT_THAT(reports::to_text(run, tests::example_report().fit.rig.rig),
              testing::HasSubstr("energy            1e-18 J at touch, in play 0.002 J: 25.00 % "
                                 "lost in the contact, 50.00 % in vibration, 0.00 % in rotation; "
                                 "imbalance 1.0e-03\n"));
}

// Of a contact that has not ended there is no end, speed or restitution yet.
TEST(Text, AContactThatLastsShowsNoEnd) {
  models::Simulation run = tests::example_report().fit.predictions.front();
  ASSERT_FALSE(run.episodes.empty());
  models::Episode& last = run.episodes.back();
  last.open = true;
  last.separation_velocity = run.restitution.kinematic = run.restitution.kinetic =
      run.restitution.energetic = std::numeric_limits<double>::quiet_NaN();
  const std::string text = reports::to_text(run, tests::example_report().fit.rig.rig);
  EXPECT_THAT(text, Not(HasSubstr("nan")));
  EXPECT_THAT(text, HasSubstr(", kinematic -, kinetic -, energetic -\n"));
  EXPECT_THAT(text,
              testing::ContainsRegex("\n +[0-9.e-]+ +- +[0-9.e-]+ +[0-9.e-]+ +[0-9.e-]+ +-\n"));
}

}  // namespace
