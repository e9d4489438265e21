// SPDX-License-Identifier: BSD-3-Clause
#include "reports/campaign.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/reports/example_report.hpp"
#include "tests/reports/markup.hpp"

namespace impactrig {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

reports::CampaignShot shot(int number, double e, double error, double speed) {
  reports::CampaignShot out;
  out.file = fmt::format("day/shot {}.uff", number);
  out.name = fmt::format("shot {}.uff", number);
  out.has_report = true;
  out.verdict = {reports::Verdict::Grade::explained, "Explained to within the noise", ""};
  out.converged = true;
  out.numbers.push_back({.name = "contact.restitution",
                         .label = "Restitution e of the contact law",
                         .unit = "1",
                         .value = e,
                         .std_error = error,
                         .ci95 = {e - 2.0 * error, e + 2.0 * error}});
  out.approach_speed = speed;
  out.speed_error = 1e-4;
  out.peak_force = 1900.0;
  out.reduced_chi2 = 1.02;
  return out;
}

/// Four shots on e = 0.5 + 0.1 (v - 0.4), which scatter by far more than 0.001.
reports::Campaign example() {
  reports::Campaign campaign;
  campaign.title = "Four <shots>";
  campaign.shots = {shot(1, 0.480, 0.001, 0.2), shot(2, 0.490, 0.001, 0.3),
                    shot(3, 0.500, 0.001, 0.4), shot(4, 0.510, 0.001, 0.5)};
  campaign.failed = {{"day/broken, \"old\".uff", "<b>has no force</b>"}};
  campaign.provenance.tool = "impactrig";
  reports::summarise(campaign);
  return campaign;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(Campaign, SaysHowMuchMoreTheShotsScatterThanTheirIntervals) {
  const reports::Campaign campaign = example();
  ASSERT_EQ(campaign.quantities.size(), 1U);
  const reports::CampaignQuantity& e = campaign.quantities[0];
  // S² = 5e-4 / 3 of values 0.01 apart; scatter S / 0.001, τ² = S² − 1e-6
  EXPECT_NEAR(e.between.mean, 0.495, 1e-12);
  EXPECT_NEAR(e.between.scatter, std::sqrt(5e-4 / 3.0) / 1e-3, 1e-9);
  EXPECT_THAT(e.sentence, HasSubstr("The shots scatter 13 times as much as each interval says: the "
                                    "restitution itself varies by 0.013 from shot to shot"));
  EXPECT_THAT(e.sentence, HasSubstr(", 2.6\u00a0% of it."));
  // all of it is the trend
  ASSERT_TRUE(e.trend);
  EXPECT_NEAR(e.trend->slope, 0.1, 1e-12);
  EXPECT_THAT(e.trend_sentence, HasSubstr("The restitution rises with approach speed: 0.1"));
}

TEST(Campaign, AMeshErrorWidensTheMeansIntervalAndIsNoScatter) {
  reports::Campaign campaign = example();
  const std::array<double, 2> before = campaign.quantities[0].ci95;
  EXPECT_EQ(before, campaign.quantities[0].between.ci95);
  for (reports::CampaignShot& shot : campaign.shots) {
    shot.numbers[0].mesh_shift = -0.02;
    shot.numbers[0].mesh_error = 0.03;
  }
  reports::summarise(campaign);
  const reports::CampaignQuantity& e = campaign.quantities[0];
  EXPECT_NEAR(e.ci95[0], before[0] - 0.03, 1e-12);
  EXPECT_NEAR(e.ci95[1], before[1] + 0.03, 1e-12);
  EXPECT_THAT(reports::to_text(campaign),
              HasSubstr("A mesh twice as fine would move all shots by about −0.020"));
  EXPECT_THAT(reports::to_text(example()), Not(HasSubstr("A mesh twice as fine")));
}

TEST(Campaign, SaysWhatAVariationMightStillBeWhereShotsAgree) {
  reports::Campaign campaign = example();
  campaign.shots = {shot(1, 0.5001, 0.001, 0.4), shot(2, 0.4985, 0.001, 0.4),
                    shot(3, 0.5012, 0.001, 0.4)};
  reports::summarise(campaign);
  const reports::CampaignQuantity& e = campaign.quantities.at(0);
  EXPECT_THAT(e.sentence, HasSubstr("differ no more than their intervals say"));
  EXPECT_THAT(e.sentence, HasSubstr("then by less than"));
  EXPECT_FALSE(e.trend);
  EXPECT_EQ(e.trend_sentence, "");
  campaign.shots = {shot(1, 0.5, 0.001, 0.4), shot(2, 0.50001, 0.001, 0.4),
                    shot(3, 0.49999, 0.001, 0.4)};
  reports::summarise(campaign);
  EXPECT_THAT(campaign.quantities.at(0).sentence, HasSubstr("such as a calibration"));
}

// The slope of York's line is that through the fitted speeds; those before touch are for the eye.
TEST(Campaign, TrendKnowsThatSpeedsHaveErrors) {
  reports::Campaign campaign = example();
  reports::summarise(campaign);
  ASSERT_TRUE(campaign.quantities.at(0).trend);
  const double exact = campaign.quantities.at(0).trend->slope;
  for (reports::CampaignShot& shot : campaign.shots) {
    shot.fitted_speed = 2.0 * shot.approach_speed;
    shot.speed_error = 1e-3;
  }
  reports::summarise(campaign);
  EXPECT_NEAR(campaign.quantities.at(0).trend->slope, 0.5 * exact, 1e-9);
}

TEST(Campaign, LeavesOutWhatHasNoVerdictOrNoStandardError) {
  reports::Campaign campaign = example();
  campaign.shots[1].verdict.grade = reports::Verdict::Grade::open;
  campaign.shots[2].numbers[0].std_error = 0.0;
  reports::summarise(campaign);
  EXPECT_EQ(campaign.quantities.at(0).left_out, (std::vector<std::size_t>{1, 2}));
  EXPECT_EQ(campaign.quantities.at(0).between.shots, 2U);
  EXPECT_EQ(reports::word(campaign.shots[1]), "fail");
  campaign.shots[3].numbers[0].std_error = 0.0;
  reports::summarise(campaign);
  EXPECT_TRUE(campaign.quantities.empty());
  EXPECT_THAT(reports::to_text(campaign),
              HasSubstr("contact.restitution is not compared: of 4 shots one tells it"));
  EXPECT_THAT(reports::to_json(campaign), HasSubstr("\"not_compared\""));
}

TEST(Campaign, FlagsTurnAPassIntoAWarning) {
  reports::CampaignShot one = shot(1, 0.5, 0.001, 0.4);
  EXPECT_EQ(reports::word(one), "pass");
  one.flags = {"noisy"};
  EXPECT_EQ(reports::word(one), "warn");
  one.flags = {"double-hit", "multiple-hits"};  // which the model explains
  EXPECT_EQ(reports::word(one), "pass");
}

TEST(Campaign, TakesItsRowFromAFit) {
  const reports::ReportData data = tests::example_report();
  const reports::CampaignShot row = reports::campaign_shot(data);
  EXPECT_DOUBLE_EQ(row.reduced_chi2,
                   data.fit.goodness.chi2 / static_cast<double>(data.fit.goodness.dof));
  EXPECT_DOUBLE_EQ(row.peak_force, data.fit.impacts[0].peak);
  EXPECT_DOUBLE_EQ(row.approach_speed, data.fit.impacts[0].approach_velocity);
  ASSERT_NE(row.number("contact.restitution"), nullptr);
  for (const fitting::Parameter& p : data.fit.parameters) {
    const reports::ShotNumber* number = row.number(p.name);
    ASSERT_EQ(number == nullptr, p.nuisance) << p.name;
    if (number == nullptr) continue;
    EXPECT_DOUBLE_EQ(number->value, p.value);
    // what sits at its bound or cannot be told does not count between shots
    EXPECT_EQ(number->std_error > 0.0, p.std_error > 0.0 && p.identifiable && !p.at_bound);
  }
  EXPECT_EQ(row.flags.size(), data.fit.impacts[0].flags.size());
  ASSERT_EQ(data.fit.parameters[2].name, "start.velocity");
  EXPECT_EQ(row.fitted_speed, data.fit.parameters[2].value);
  EXPECT_EQ(row.speed_error, data.fit.parameters[2].std_error);
  EXPECT_EQ(row.number("contact.restitution")->with_speed, data.fit.correlations(0, 2));
  EXPECT_NE(row.number("contact.restitution")->with_speed, 0.0);
}

TEST(Campaign, TableHasOneRowARecordingAndAsManyCellsInEach) {
  const std::vector<std::string> lines = lines_of(reports::to_csv(example()));
  ASSERT_EQ(lines.size(), 6U);
  EXPECT_THAT(lines[0], HasSubstr("contact.restitution [1],contact.restitution std_error [1]"));
  EXPECT_THAT(lines[1], HasSubstr("day/shot 1.uff,pass,Explained to within the noise,0.48,0.001,"));
  const auto commas = [](const std::string& line) {
    return std::count(line.begin(), line.end(), ',');
  };
  for (std::size_t i = 1; i < 5; ++i) EXPECT_EQ(commas(lines[i]), commas(lines[0])) << i;
  EXPECT_THAT(lines[5], testing::StartsWith("\"day/broken, \"\"old\"\".uff\",failed,"));
  EXPECT_EQ(commas(lines[5]), commas(lines[0]) + 1);  // one stands in the name
}

TEST(Campaign, DocumentsAreJsonWithSchemasAndAllNumbers) {
  const reports::Campaign campaign = example();
  const json summary = json::parse(reports::to_json(campaign));
  EXPECT_EQ(summary["schema"], "impactrig/campaign/1");
  EXPECT_EQ(summary["shots"].size(), 4U);
  EXPECT_EQ(summary["shots"][0]["report"], "reports/shot 1.uff.html");
  EXPECT_EQ(summary["quantities"][0]["name"], "contact.restitution");
  EXPECT_EQ(summary["quantities"][0]["mean"].get<double>(), campaign.quantities[0].between.mean);
  EXPECT_NEAR(summary["quantities"][0]["trend"]["slope_per_m_s"].get<double>(), 0.1, 1e-12);
  const json failed = json::parse(reports::failed_json(campaign));
  EXPECT_EQ(failed["schema"], "impactrig/failed/1");
  EXPECT_EQ(failed["failed"][0]["sentence"], "<b>has no force</b>");
}

TEST(Campaign, PageIsWellFormedEscapedAndNeedsNoNetwork) {
  const std::string page = reports::to_html(example());
  EXPECT_EQ(tests::html_problem(page), "");
  EXPECT_THAT(page, HasSubstr("Four &lt;shots&gt;"));
  EXPECT_THAT(page, Not(HasSubstr("<b>has no force")));
  EXPECT_THAT(page, HasSubstr("<a href=\"reports/shot%201.uff.html\">shot 1.uff</a>"));
  EXPECT_THAT(page, HasSubstr("<span class=\"word pass\">pass</span>"));
  EXPECT_THAT(page, HasSubstr("data-value=\"0.48\""));
  for (const char* request : {"src=", "http://", "https://", "@import", "url("})
    EXPECT_EQ(page.find(request), page.find(request) == std::string::npos
                                      ? std::string::npos
                                      : page.find("xmlns=\"http://www.w3.org/2000/svg\"") + 7)
        << request;
}

TEST(Campaign, APageOfNothingButFailuresSaysSo) {
  reports::Campaign campaign = example();
  campaign.shots.clear();
  reports::summarise(campaign);
  const std::string page = reports::to_html(campaign);
  EXPECT_EQ(tests::html_problem(page), "");
  EXPECT_THAT(page, HasSubstr("No recording has a result."));
  EXPECT_THAT(page, HasSubstr("0 of 1 recordings fitted"));
}

TEST(Campaign, LinksAreEncoded) {
  EXPECT_EQ(reports::url_path("a b#1%?ü.uff"), "a%20b%231%25%3F%C3%BC.uff");
}

}  // namespace
}  // namespace impactrig
