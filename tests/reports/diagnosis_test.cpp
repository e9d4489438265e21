// SPDX-License-Identifier: BSD-3-Clause
#include "reports/diagnosis.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "datasets/input_error.hpp"
#include "reports/text.hpp"
#include "reports/verdict.hpp"
#include "tests/reports/example_report.hpp"

namespace impactrig {
namespace {

using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::ordered_json;

/// A channel whose diagnostics are made up, to the last number.
fitting::ChannelFit made_up() {
  fitting::ChannelFit out;
  out.quantity = "force";
  out.unit = "N";
  fitting::ChannelDiagnostics found;
  found.judged = true;
  found.sentence = "The force's residuals are odd; look again.";
  found.discrepancy.significant = true;
  found.discrepancy.length = 40e-6;
  found.discrepancy.rms = 3.14;
  found.discrepancy.largest = -12.34;
  found.discrepancy.largest_error = 0.56;
  found.discrepancy.largest_time = 80e-6;
  out.diagnostics = found;
  return out;
}

TEST(Diagnosis, SaysHowMuchTheModelLeavesOutAndWhen) {
  EXPECT_EQ(
      reports::discrepancy_sentence(made_up()),
      "The model leaves out of the force up to −12.34 ± 0.56 N, 80.0\u00a0µs after touch, and "
      "3.1\u00a0N (rms) over the fitted time; what is left out changes within some "
      "40\u00a0µs.");
}

TEST(Diagnosis, SaysThatNothingStandsOut) {
  fitting::ChannelFit channel = made_up();
  channel.diagnostics->discrepancy = {};
  EXPECT_EQ(reports::discrepancy_sentence(channel),
            "No smooth part of the force that the model leaves out stands out of the noise.");
  channel.diagnostics->coarse = true;
  EXPECT_EQ(reports::discrepancy_sentence(channel), "");
  channel.diagnostics.reset();
  EXPECT_EQ(reports::discrepancy_sentence(channel), "");
}

TEST(Diagnosis, IsThatOfTheWorstChannel) {
  fitting::Fit fit;
  fit.channels = {made_up(), made_up()};
  EXPECT_EQ(reports::diagnosis_summary(fit),
            "What is left of every channel is what its noise before touch leads to expect.");
  EXPECT_FALSE(reports::any_unsound(fit));
  for (fitting::ChannelFit& channel : fit.channels) channel.diagnostics->sound = false;
  fit.channels[0].diagnostics->phases = {{"compression", 100, 2.0, 2.0, 1e-9}};
  fit.channels[1].diagnostics->phases = {{"compression", 100, 3.0, 3.0, 1e-9}};
  fit.channels[1].diagnostics->sentence = "Worse.";
  EXPECT_EQ(reports::diagnosis_summary(fit), "Worse.");
  EXPECT_TRUE(reports::any_unsound(fit));
  fit.channels[0].diagnostics.reset();
  fit.channels[1].diagnostics->sound = true;
  EXPECT_EQ(reports::diagnosis_summary(fit), "");  // not every channel was judged
}

TEST(Diagnosis, IsInVerdictTextAndPage) {
  reports::ReportData data = tests::example_report();
  const std::string sentence = "The force's residuals are odd; look again.";
  data.fit.channels[0].diagnostics->sound = false;
  data.fit.channels[0].diagnostics->sentence = sentence;
  data.fit.channels[0].diagnostics->phases[1].ratio = 1e3;
  EXPECT_THAT(reports::verdict(data.fit).sentence, HasSubstr(sentence));
  EXPECT_EQ(reports::verdict(data.fit).headline,
            "Explained to about the noise, but for a small part that is none");
  EXPECT_THAT(reports::to_text(data), HasSubstr(sentence));
  EXPECT_THAT(reports::to_html(data), HasSubstr("Where the model fails</h3>"));
  for (fitting::ChannelFit& channel : data.fit.channels) channel.diagnostics.reset();
  EXPECT_THAT(reports::verdict(data.fit).headline, "Explained to within the noise");
  EXPECT_THAT(reports::to_html(data), Not(HasSubstr("Where the model fails</h3>")));
}

TEST(Diagnosis, DrawsACurveOnlyWhereThereIsOne) {
  reports::ReportData data = tests::example_report();
  const char* const curve = "left out by the model";
  ASSERT_TRUE(data.fit.channels[0].diagnostics->discrepancy.significant);
  EXPECT_THAT(reports::html_diagnostics(data.fit), HasSubstr(curve));
  for (fitting::ChannelFit& channel : data.fit.channels) channel.diagnostics->discrepancy = {};
  EXPECT_THAT(reports::html_diagnostics(data.fit), Not(HasSubstr(curve)));
}

TEST(Diagnosis, LeavesPicturesOfManySoundChannelsOut) {
  reports::ReportData data = tests::example_report(5);
  for (fitting::ChannelFit& channel : data.fit.channels) channel.diagnostics->sound = true;
  data.fit.channels[3].diagnostics->sound = false;
  const std::string page = reports::html_diagnostics(data.fit);
  EXPECT_THAT(page, HasSubstr("pictures of 9 more channels are left out"));
}

TEST(DiagnosticsJson, HasTheNamesThatScriptsRelyOn) {
  const Json json = Json::parse(reports::to_json(tests::example_report()));
  const Json& found = json["channels"][0]["diagnostics"];
  for (const char* name : {"judged", "sound", "level", "p_value", "noise", "phases", "whiteness",
                           "normality", "longest_run", "structures", "discrepancy", "sentence"})
    EXPECT_TRUE(found.contains(name)) << name;
  EXPECT_EQ(found["phases"][1]["phase"], "compression");
  EXPECT_EQ(found["structures"][0]["kind"], "delay");
  EXPECT_TRUE(found["structures"][4].contains("frequency_hz"));
  EXPECT_EQ(found["discrepancy"]["time_s"].size(), found["discrepancy"]["mean"].size());
}

// What went out comes back: every number of an example that has them all.
TEST(DiagnosticsJson, ComesBackAsItWentOut) {
  const reports::ReportData data = tests::example_report();
  const reports::ReportData back = reports::report_from_json(reports::to_json(data), "fit.json");
  const auto &before = *data.fit.channels[1].diagnostics,
             &after = *back.fit.channels[1].diagnostics;
  EXPECT_EQ(after.sound, before.sound);
  EXPECT_EQ(after.noise_correlation, before.noise_correlation);
  ASSERT_EQ(after.phases.size(), before.phases.size());
  EXPECT_EQ(after.phases[2].p_value, before.phases[2].p_value);
  EXPECT_EQ(after.whiteness.before, before.whiteness.before);
  EXPECT_EQ(after.normality.quantiles, before.normality.quantiles);
  EXPECT_EQ(after.run.to, before.run.to);
  ASSERT_EQ(after.structures.size(), before.structures.size());
  EXPECT_EQ(after.structures[4].frequency, before.structures[4].frequency);
  EXPECT_EQ(after.discrepancy.error, before.discrepancy.error);
  EXPECT_EQ(after.sentence, before.sentence);
}

TEST(DiagnosticsJson, MayBeMissingInAnOlderFile) {
  Json json = Json::parse(reports::to_json(tests::example_report()));
  for (Json& channel : json["channels"]) channel.erase("diagnostics");
  const reports::ReportData back = reports::report_from_json(json.dump(), "fit.json");
  EXPECT_FALSE(back.fit.channels[0].diagnostics.has_value());
}

TEST(DiagnosticsJson, RefusesACurveOfUnequalLengths) {
  Json json = Json::parse(reports::to_json(tests::example_report()));
  json["channels"][0]["diagnostics"]["discrepancy"]["mean"].push_back(1.0);
  try {
    reports::report_from_json(json.dump(), "fit.json");
    FAIL() << "accepted";
  } catch (const datasets::InputError& error) {
    EXPECT_STREQ(
        error.what(),
        "fit.json: /channels/0/diagnostics/discrepancy: time_s, mean and std_error must be "
        "of one length");
  }
}

}  // namespace
}  // namespace impactrig
