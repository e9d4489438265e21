// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <limits>
#include <regex>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reports/embedded.hpp"
#include "reports/report_data.hpp"
#include "reports/verdict.hpp"
#include "tests/reports/example_report.hpp"
#include "tests/reports/markup.hpp"

namespace impactrig {
namespace {

using testing::HasSubstr;

constexpr const char* attack = "<script>alert(1)</script>";

std::string without(std::string page, const std::string& from, const std::string& to) {
  for (std::size_t begin = page.find(from); begin != std::string::npos; begin = page.find(from)) {
    const std::size_t end = page.find(to, begin);
    page.erase(begin, end == std::string::npos ? end : end + to.size() - begin);
  }
  return page;
}

/// What a reader sees: no scripts, styles, tags.
std::string visible(const std::string& page) {
  std::string out = without(page.substr(page.find("<body")), "<script", "</script>");
  out = without(out, "<", ">");
  return out;
}

/// HasSubstr that does not print half a megabyte when it fails.
testing::AssertionResult has(const std::string& text, const std::string& piece) {
  if (text.find(piece) != std::string::npos)
    return testing::AssertionSuccess() << "it has: " << piece;
  return testing::AssertionFailure() << "it lacks: " << piece;
}

std::size_t count(const std::string& text, const std::string& piece) {
  std::size_t n = 0;
  for (std::size_t at = text.find(piece); at != std::string::npos; at = text.find(piece, at + 1))
    ++n;
  return n;
}

/// The JSON a script finds in the page.
std::string page_json(const std::string& page) {
  const std::string open = "<script type=\"application/json\" id=\"report\">";
  const std::size_t begin = page.find(open) + open.size();
  return page.substr(begin, page.find("</script>", begin) - begin);
}

void remove_channels(reports::ReportData& data, const std::string& quantity) {
  auto& channels = data.fit.channels;
  channels.erase(std::remove_if(channels.begin(), channels.end(),
                                [&](const auto& c) { return c.quantity == quantity; }),
                 channels.end());
}

TEST(Html, HasEverySection) {
  const std::string page = reports::to_html(tests::example_report());
  for (const char* section : {"measured", "contact", "parameters", "restitution", "goodness",
                              "quality", "reproduce", "provenance"})
    EXPECT_EQ(count(page, "<section id=\"" + std::string(section) + "\""), 1u) << section;
  EXPECT_TRUE(has(page, "<h1>Invented example: bar on groove</h1>"));
  EXPECT_EQ(count(page, "<h1>"), 1u);
  EXPECT_EQ(count(page, "<figure class=\"plot\""), 2u);
  EXPECT_EQ(count(page, "<figure class=\"loop\""), 1u);
  EXPECT_EQ(count(page, "<figure class=\"energy\""), 1u);
  EXPECT_FALSE(std::regex_search(page, std::regex("\\{\\{[a-z_]+\\}\\}")));
}

TEST(Html, IsWellFormed) {
  for (const int recordings : {1, 3})
    EXPECT_EQ(tests::html_problem(reports::to_html(tests::example_report(recordings))), "");
  EXPECT_EQ(tests::html_problem(reports::to_html({})), "");
}

TEST(Html, SaysTheKeyNumbers) {
  const std::string text = visible(reports::to_html(tests::example_report()));
  EXPECT_TRUE(has(text, "95 %: 0.490 to 0.534"));
  EXPECT_TRUE(has(text, "0.512"));
  EXPECT_TRUE(has(text, "440.83"));
  EXPECT_TRUE(has(text, "± 0.011"));
  EXPECT_TRUE(has(text, "at its upper bound of 2.20 µs"));
  EXPECT_TRUE(has(text, "these data cannot tell"));
  EXPECT_TRUE(has(text, "two contacts in all"));
  EXPECT_TRUE(has(text, "1.13 per degree"));
  EXPECT_TRUE(has(text, "Three warnings"));
  EXPECT_TRUE(has(text, "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08"));
  EXPECT_TRUE(has(text, "impactrig validate &#39;shot 17.uff&#39; --rig bench.toml"));
  EXPECT_TRUE(has(text, "take off the known delay, CH2 Vibrometer velocity: delay 2 us"));
}

TEST(Html, NeedsNoOtherFileAndNoNetwork) {
  const std::string page = reports::to_html(tests::example_report());
  // The only addresses: the name space of SVG and the licence in the head of dygraphs.
  std::string rest = without(page, "http://www.w3.org/2000/svg", "svg");
  rest = without(rest, "https://github.com/danvk/dygraphs/blob", "LICENSE.txt");
  EXPECT_FALSE(has(rest, "http:"));
  EXPECT_FALSE(has(rest, "https:"));
  EXPECT_FALSE(has(page, "sourceMappingURL"));
  EXPECT_FALSE(has(page, "@import"));
  EXPECT_FALSE(std::regex_search(page.substr(0, page.find("id=\"report\"")),
                                 std::regex("<(link|img|iframe|script)[^>]*(src|href)=")));
}

TEST(Html, EscapesWhateverComesFromFiles) {
  reports::ReportData data = tests::example_report(2);
  data.title = attack;
  data.fit.parameters[0].name = attack;
  data.fit.parameters[0].unit = attack;
  data.fit.channels[0].channel = std::string("CH1 ") + attack;
  data.fit.channels[0].quantity = attack;
  data.fit.channels[0].unit = attack;
  data.fit.channels[0].metrics[attack] = 1.0;
  data.fit.impacts[0].recording = std::string("a\"b") + attack;
  data.fit.impacts[0].force->channel = attack;
  data.fit.warnings = {attack};
  data.fit.not_identifiable = {attack};
  data.fit.termination = attack;
  data.fit.predictions[0].warnings = {attack};
  data.fit.predictions[0].skipped = {attack};
  data.fit.predictions[0].termination = attack;
  data.fit.rig.path = attack;
  data.fit.rig.rig.contact.law = attack;
  data.fit.rig.rig.contact.damping = attack;
  datasets::Record& record = data.records[0];
  record.title = record.started = attack;
  record.warnings = {attack};
  record.attributes = {{attack, attack}};
  record.channels[0].name = record.channels[0].unit = attack;
  record.channels[0].calibration->source = attack;
  record.channels[0].calibration->recorded_unit = attack;
  record.provenance.source_file = record.provenance.importer = attack;
  record.provenance.edits = {{attack, attack, {{attack, attack}}}};
  data.provenance.tool = data.provenance.version = data.provenance.build = attack;
  data.provenance.git = data.provenance.host = data.provenance.started = attack;
  data.provenance.config = data.provenance.config_sha256 = data.provenance.result_key = attack;
  data.provenance.command = {attack};
  data.provenance.inputs = {{attack, 1, attack}};
  const std::string page = reports::to_html(data);
  EXPECT_FALSE(has(page, attack));
  EXPECT_FALSE(has(page, "alert(1)</script>"));
  EXPECT_EQ(tests::html_problem(page), "");
  EXPECT_TRUE(has(page, "&lt;script&gt;alert(1)&lt;/script&gt;"));
}

TEST(Html, CarriesAllNumbersAsJson) {
  const reports::ReportData data = tests::example_report();
  const std::string page = reports::to_html(data);
  const reports::ReportData back = reports::report_from_json(page_json(page), "report.html");
  EXPECT_EQ(back.fit.parameters[0].value, 0.512);
  ASSERT_EQ(back.fit.channels[0].measured.size(), 3000u);
  double peak = 0.0;
  for (const double f : data.fit.channels[0].model) peak = std::max(peak, std::abs(f));
  for (std::size_t i = 0; i < 3000; ++i)
    ASSERT_NEAR(back.fit.channels[0].model[i], data.fit.channels[0].model[i], 1e-6 * peak);
}

TEST(Html, IsTheSameFromAFileAsFromTheFit) {
  for (const int recordings : {1, 2}) {
    reports::ReportData data = tests::example_report(recordings);
    const std::string page = reports::to_html(data);
    EXPECT_TRUE(page ==
                reports::to_html(reports::report_from_json(reports::to_json(data), "fit.json")));
  }
}

TEST(Html, StaysWellBelowOneMegabyteForAShot) {
  EXPECT_LT(reports::to_html(tests::example_report()).size(), 750'000u);
}

// 400 000 samples a channel; one spike outside the fitted window must survive.
TEST(Html, ThinsALongRecordButKeepsItsExtremes) {
  reports::ReportData data = tests::example_report();
  for (fitting::ChannelFit& channel : data.fit.channels) {
    const std::size_t n = 400'000;
    channel.time.resize(n);
    channel.measured.assign(n, 0.0);
    channel.model.assign(n, 0.0);
    channel.used.assign(n, 0);
    for (std::size_t i = 0; i < n; ++i) {
      channel.time[i] = 1e-6 * static_cast<double>(i);
      channel.measured[i] = 1e-3 * static_cast<double>(i % 7);
    }
    for (std::size_t i = 1000; i < 3000; ++i) channel.used[i] = 1;
    channel.measured[234'567] = 5.0;
  }
  const std::string page = reports::to_html(data);
  EXPECT_LT(page.size(), 2'500'000u);
  const fitting::ChannelFit kept =
      reports::report_from_json(page_json(page), "report.html").fit.channels[0];
  EXPECT_EQ(*std::max_element(kept.measured.begin(), kept.measured.end()), 5.0);
  EXPECT_EQ(std::count(kept.used.begin(), kept.used.end(), 1), 2000);
  EXPECT_TRUE(has(page, "4000 pairs of smallest and largest values"));
}

// Grey is what a fit did not look at, not what lies between two samples that a filter tied.
TEST(Html, ShadesNothingBetweenSamplesThatAreThinned) {
  reports::ReportData data = tests::example_report();
  for (fitting::ChannelFit& channel : data.fit.channels) {
    channel.every = 4;
    for (std::size_t k = 0; k < channel.used.size(); ++k) channel.used[k] = k % 4 == 0 ? 1 : 0;
  }
  const std::string thinned = reports::to_html(data);
  EXPECT_EQ(thinned.find(">not fitted<"), std::string::npos);
  EXPECT_THAT(visible(thinned), testing::HasSubstr(", one in 4"));
  fitting::ChannelFit& force = data.fit.channels[0];
  for (std::size_t k = 0; k < force.used.size(); ++k)
    if (force.time[k] > 0.0 && force.time[k] < 20e-6) force.used[k] = 0;
  EXPECT_NE(reports::to_html(data).find(">not fitted<"), std::string::npos);
}

TEST(Html, WorksWithoutAVelocityChannel) {
  reports::ReportData data = tests::example_report();
  remove_channels(data, "velocity");
  data.fit.impacts[0].velocity.reset();
  const std::string page = reports::to_html(data);
  EXPECT_EQ(tests::html_problem(page), "");
  EXPECT_EQ(count(page, "<figure class=\"plot\""), 1u);
  EXPECT_TRUE(has(page, "No velocity was compared"));
  EXPECT_FALSE(has(page, "No force was compared"));
}

// Beyond the simulated time a model's curve is a mere continuation: not drawn, not subtracted.
TEST(Html, EndsTheModelWhereTheSimulationEnds) {
  reports::ReportData data = tests::example_report();
  data.fit.predictions[0].duration = 0.6e-3;
  EXPECT_EQ(count(reports::to_html(data), " data-until=\"0.0006\""), 2u);
  const auto still = [&](double beyond) {
    for (fitting::ChannelFit& channel : data.fit.channels)
      for (std::size_t i = 0; i < channel.time.size(); ++i)
        if (channel.time[i] > 0.6e-3) channel.model[i] = beyond;
    const std::string page = reports::to_html(data);
    const std::size_t begin = page.find("<div class=\"still\">");
    return page.substr(begin, page.find("</svg>", begin) - begin);
  };
  EXPECT_TRUE(still(100.0) == still(-100.0));
}

TEST(Html, SaysNothingTwiceThatTheFitHasSaid) {
  reports::ReportData data = tests::example_report();
  data.fit.predictions[0].warnings = {"The contact was grazed."};
  const std::string sentence(datasets::sentence(datasets::ImpactFlag::double_hit));
  EXPECT_TRUE(has(reports::to_html(data), "Four warnings"));
  data.fit.warnings = {"folder/shot 17.uff: " + sentence, "The contact was grazed."};
  EXPECT_TRUE(has(reports::to_html(data), "Three warnings"));
  const datasets::Record& record = data.records[0];
  data.fit.warnings.push_back("folder/" + record.provenance.source_file + ": " +
                              record.warnings[0]);
  EXPECT_TRUE(has(reports::to_html(data), "Three warnings"));
}

TEST(Html, WorksWithoutUncertainties) {
  reports::ReportData data = tests::example_report();
  for (fitting::Parameter& parameter : data.fit.parameters) {
    parameter.std_error = 0.0;
    parameter.ci95 = {std::nan(""), std::nan("")};
  }
  for (auto& [key, estimate] : data.fit.restitution) estimate.ci95 = {std::nan(""), std::nan("")};
  data.fit.correlations.resize(0, 0);
  const std::string page = reports::to_html(data);
  EXPECT_TRUE(has(page, "uncertainty could not be estimated"));
  EXPECT_TRUE(has(page, "no interval: could not be estimated"));
  EXPECT_TRUE(has(page, "its uncertainty could not be estimated"));
  EXPECT_TRUE(has(page, "not estimated"));
  EXPECT_FALSE(has(page, "class=\"matrix\""));
  EXPECT_EQ(tests::html_problem(page), "");
}

TEST(Html, NeverSaysNan) {
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  reports::ReportData data = tests::example_report(2);
  for (fitting::Parameter& p : data.fit.parameters)
    p.value = p.std_error = p.initial = p.lower = p.upper = nan;
  data.fit.correlations.setConstant(nan);
  data.fit.goodness = {nan, 100, infinity, nan};
  data.fit.seconds = nan;
  for (auto& [key, estimate] : data.fit.restitution) estimate = {nan, {nan, infinity}};
  for (fitting::ChannelFit& channel : data.fit.channels) {
    channel.noise = channel.residual_rms = nan;
    channel.metrics["nrmse"] = nan;
    channel.measured[100] = nan;
    channel.model[200] = infinity;
  }
  for (models::Simulation& run : data.fit.predictions) {
    run.energy = {nan, nan, nan, nan, nan, nan, nan, nan, nan, nan, nan};
    run.peak_force = nan;
    run.restitution = {nan, nan, nan, nan};
    for (models::Episode& episode : run.episodes) episode.peak_force = episode.impulse = nan;
    run.history.force.assign(run.history.force.size(), nan);
  }
  const std::string page = reports::to_html(data);
  const std::string body = page.substr(page.find("<body"));
  const std::string shown = body.substr(0, body.find("<script"));
  const std::regex word("[^a-z](nan|inf|-nan|infinity)[^a-z]", std::regex::icase);
  std::smatch match;
  EXPECT_FALSE(std::regex_search(shown, match, word)) << match.prefix().str().substr(
      match.prefix().length() > 80 ? static_cast<std::size_t>(match.prefix().length() - 80) : 0);
  EXPECT_EQ(tests::html_problem(page), "");
}

TEST(Html, HasOneBlockForEachRecording) {
  const std::string page = reports::to_html(tests::example_report(3));
  EXPECT_EQ(count(page, "<div class=\"recording\""), 3u);
  EXPECT_EQ(count(page, "<figure class=\"plot\""), 6u);
  EXPECT_EQ(count(page, "<figure class=\"energy\""), 3u);
  for (const char* file : {"shot 17.uff", "shot 18.uff", "shot 19.uff"})
    EXPECT_TRUE(has(page, std::string(">") + file + "</h3>"));
  EXPECT_TRUE(has(page, "One row for each recording"));
  // One flag of three recordings is one warning.
  EXPECT_TRUE(has(page, "shot 17.uff, shot 18.uff, shot 19.uff: flagged double-hit."));
}

TEST(Html, ListsOnlyStrongCorrelationsOfManyParameters) {
  // 20 parameters, each correlated with its neighbours; numbers 0, 1, 2, 8 and 14 are physical.
  const std::string page = reports::to_html(tests::example_report(3));
  EXPECT_TRUE(has(page, "with a parameter of the impact: 7 of 7 pairs shown"));
}

TEST(Html, CopesWithAnEmptyReport) {
  const std::string page = reports::to_html({});
  EXPECT_TRUE(has(page, "Nothing was compared"));
  EXPECT_TRUE(has(page, "Nothing was fitted"));
  EXPECT_TRUE(has(page, "No prediction is stored"));
}

TEST(Html, CopesWithCurvesOfUnequalLength) {
  reports::ReportData data = tests::example_report();
  data.fit.channels[0].model.resize(10);
  data.fit.channels[0].used.clear();
  data.fit.channels[1].time.clear();
  EXPECT_EQ(tests::html_problem(reports::to_html(data)), "");
}

TEST(Html, EmbedsThePlotLibraryItNames) {
  const std::string page = reports::to_html(tests::example_report());
  EXPECT_TRUE(has(page, std::string(reports::embedded::dygraph_min_js.sha256)));
  EXPECT_EQ(reports::embedded::dygraph_min_js.sha256.size(), 64u);
  EXPECT_TRUE(has(page, "Permission is hereby granted, free of charge"));
}

TEST(Verdict, NamesTheGrade) {
  using Grade = reports::Verdict::Grade;
  reports::ReportData data = tests::example_report();
  EXPECT_EQ(reports::verdict(data.fit).grade, Grade::explained);
  data.fit.parameters[0].contradicts_prior = true;
  EXPECT_EQ(reports::verdict(data.fit).grade, Grade::in_shape);
  EXPECT_EQ(reports::verdict(data.fit).headline,
            "Explained to within the noise, but against what is stated");
  EXPECT_THAT(reports::verdict(data.fit).sentence,
              HasSubstr("What is stated of " + data.fit.parameters[0].name + " contradicts"));
  data.fit.parameters[0].contradicts_prior = false;
  data.fit.channels[0].residual_rms = 1.6 * data.fit.channels[0].noise;
  EXPECT_EQ(reports::verdict(data.fit).grade, Grade::in_shape);
  data.fit.channels[1].metrics["sprague_geers_comprehensive"] = 0.21;
  EXPECT_EQ(reports::verdict(data.fit).grade, Grade::not_explained);
  data.fit.termination = "the iteration limit was reached";
  const reports::Verdict open = reports::verdict(data.fit);
  EXPECT_EQ(open.grade, Grade::open);
  EXPECT_THAT(open.sentence, HasSubstr("It ended with: the iteration limit was reached."));
}

TEST(Verdict, SpeaksOfTheFirstThingThatMakesTheRestMeaningless) {
  reports::ReportData data = tests::example_report();
  data.fit.impacts[0].flags = {datasets::ImpactFlag::no_hit};
  EXPECT_EQ(reports::verdict(data.fit).headline, "No impact found");
  data.fit.impacts[0].flags = {datasets::ImpactFlag::implausible};
  EXPECT_EQ(reports::verdict(data.fit).headline, "Impulse and speed do not fit this rig");
  EXPECT_EQ(reports::verdict(fitting::Fit{}).headline, "Nothing was compared");
}

TEST(Verdict, MentionsClippingAndBounds) {
  reports::ReportData data = tests::example_report();
  data.fit.impacts[0].flags = {datasets::ImpactFlag::clipped};
  const std::string sentence = reports::verdict(data.fit).sentence;
  EXPECT_THAT(sentence, HasSubstr("A signal was clipped: peak and impulse are lower limits."));
  EXPECT_THAT(sentence, HasSubstr("One parameter sits at its bound."));
  EXPECT_THAT(sentence, HasSubstr("One parameter cannot be told from these data."));
}

// The first tile is of what the law goes by.
TEST(Page, HeadsWithWhatTheDampingLawGoesBy) {
  reports::ReportData data = tests::example_report();
  const auto heads = [&](const char* text) {
    const std::string page = reports::to_html(data);
    const std::size_t strip = page.find("<dl class=\"strip");
    return has(page.substr(strip, page.find("</dl>", strip) - strip), text);
  };
  EXPECT_TRUE(heads("Restitution e of the contact law"));
  models::Contact& contact = data.fit.rig.rig.contact;
  contact.damping = "viscous";
  contact.viscous = 300.0;
  EXPECT_FALSE(heads("Restitution e of the contact law"));
  EXPECT_TRUE(heads("Contact damping</dt><dd><b>300.0</b>"));
  contact.viscous.reset();
  contact.damping = "none";
  EXPECT_TRUE(heads("the law dissipates nothing"));
}

// Closer than the digits of the value.
TEST(Page, StatesANarrowIntervalByItsHalfWidth) {
  reports::ReportData data = tests::example_report();
  for (fitting::Parameter& p : data.fit.parameters)
    if (p.name == "contact.stiffness_factor") {
      p.value = 1.0;
      p.std_error = 1e-5;
      p.ci95 = {1.0 - 2e-5, 1.0 + 2e-5};
    }
  EXPECT_TRUE(has(visible(reports::to_html(data)), "95 %: ± 2"));
}

// The invented record's kinetic restitution is four standard errors off, the others are not.
TEST(Page, SetsTheModelAgainstWhatTheRecordShowsWithoutOne) {
  reports::ReportData data = tests::example_report();
  const std::string page = reports::to_html(data), text = visible(page);
  EXPECT_TRUE(has(text, "Without a model"));
  EXPECT_TRUE(has(text, "The model&#39;s kinematic and energetic restitution lie within"));
  EXPECT_TRUE(has(text, "kinetic restitution,"));
  EXPECT_TRUE(has(text, "is outside the direct interval"));
  EXPECT_TRUE(has(text, "in the delay between the channels would explain it"));
  EXPECT_TRUE(has(text, "The record is too short."));
  EXPECT_TRUE(has(page, "Contact force over penetration, measured and modelled"));
  EXPECT_TRUE(has(text, "standard uncertainty by source"));
  EXPECT_EQ(reports::to_html(reports::report_from_json(reports::to_json(data), "")), page);
  EXPECT_FALSE(has(text, "what the record's filters took not put back"));
  data.fit.channels[1].every = 10;
  EXPECT_TRUE(has(visible(reports::to_html(data)), "what the record's filters took not put back"));
  data.fit.direct[0].notes = {"The laser points 40 mm from the struck point."};
  EXPECT_TRUE(has(visible(reports::to_html(data)), "What is said above of the record"));
  data.fit.direct.clear();
  EXPECT_FALSE(has(visible(reports::to_html(data)), "Without a model"));
}

}  // namespace

// A measured loop may end before where it begins: the axis goes on to there.
TEST(Html, DrawsAllOfAMeasuredLoop) {
  reports::ReportData data = tests::example_report();
  ASSERT_FALSE(data.fit.direct.empty());
  fitting::Hysteresis& loop = data.fit.direct[0].hysteresis;
  ASSERT_FALSE(loop.penetration.empty());
  const double deepest = std::ranges::max(loop.penetration);
  const auto points_left_of_axis = [&] {
    const std::string page = to_html(data);
    const std::size_t figure = page.find("<figure class=\"loop direct\"");
    const std::string svg = page.substr(figure, page.find("</svg>", figure) - figure);
    std::smatch axis;
    EXPECT_TRUE(std::regex_search(svg, axis, std::regex("<line x1=\"([0-9.]+)\"")));
    const std::regex point("[ML](-?[0-9.]+) ");
    double least = INFINITY;
    for (std::sregex_iterator at(svg.begin(), svg.end(), point), end; at != end; ++at)
      least = std::min(least, std::stod((*at)[1]));
    return least < std::stod(axis[1]);
  };
  loop.penetration.back() = -0.2 * deepest;
  EXPECT_FALSE(points_left_of_axis());
}

// Samples that were left out, a thousand times the noise off, do not set the scale of the others.
TEST(Html, DrawsResidualsByWhatWasFitted) {
  reports::ReportData data = tests::example_report();
  fitting::ChannelFit& force = data.fit.channels[0];
  const auto has_thousands = [&] {
    const std::string page = to_html(data);
    return page.find("\u22121000</text>") != page.npos ||
           page.find("\u22121500</text>") != page.npos;
  };
  for (std::size_t i = 0; i < force.measured.size(); ++i) {
    if (std::abs(force.time[i] - 50e-6) > 20e-6) continue;
    force.measured[i] = force.model[i] - 1500.0 * force.noise;
    force.used[i] = 0;
  }
  EXPECT_FALSE(has_thousands());
  force.used.assign(force.used.size(), 1);
  EXPECT_TRUE(has_thousands());
}

}  // namespace impactrig
