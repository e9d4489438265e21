// SPDX-License-Identifier: BSD-3-Clause
//
// `impactrig compare` as a user or a script sees it, and that its document names its sources.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>

#include "tests/app/command_line.hpp"
#include "tests/support/places.hpp"

namespace {

using impactrig::tests::Outcome;
using impactrig::tests::rig;
using impactrig::tests::samples;
using impactrig::tests::text_of;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

/// Half a sine: [N] or whatever the file says.
double pulse(double t, double height, double start, double width) {
  return t >= start && t <= start + width ? height * std::sin(M_PI * (t - start) / width) : 0.0;
}

double measured(double t) {
  return pulse(t, 4500.0, 50e-6, 220e-6);
}

double predicted(double t) {
  return pulse(t, 4800.0, 60e-6, 200e-6);
}

class Compare : public impactrig::tests::CommandLine {
 protected:
  /// A table of one channel over times `step` apart.
  std::string history(const std::string& name, const std::function<double(double)>& value,
                      const std::string& head = "time [s],Force [N]", double step = 1e-6,
                      int count = 401) const {
    std::string text = head + "\n";
    for (int i = 0; i < count; ++i) text += fmt::format("{},{}\n", step * i, value(step * i));
    return write(name, text);
  }

  std::string shot() const { return history("shot.csv", measured); }

  std::string model() const { return history("model.csv", predicted); }

  json told(const std::string& arguments) {
    const Outcome o = run("compare --json " + arguments);
    EXPECT_EQ(o.code, 0) << arguments << ": " << o.err;
    return json::parse(o.out);
  }

  std::string refused(const std::string& arguments, int code = 3) {
    const Outcome o = run("compare " + arguments);
    EXPECT_EQ(o.code, code) << arguments << ": " << o.err;
    EXPECT_EQ(o.out, "");
    return o.err;
  }
};

double number(const json& value) {
  return value.get<double>();
}

// The pair "haversine_pulse" of the metrics' table, independently computed; text keeps 17 digits.
TEST_F(Compare, TellsTheMetricsOfTwoFiles) {
  const json j = told(shot() + " " + model());
  EXPECT_EQ(j["schema"], "impactrig/compare/1");
  EXPECT_EQ(j["samples"], 401);
  EXPECT_EQ(j["unit"], "N");
  EXPECT_EQ(j["resampled"], false);
  EXPECT_TRUE(j["warnings"].empty());
  const json& m = j["metrics"];
  const auto near = [](const json& found, double wanted) {
    EXPECT_NEAR(number(found), wanted, 1e-9 * std::abs(wanted));
  };
  near(m["sprague_geers"]["magnitude"], 0.01702676186196528);
  near(m["sprague_geers"]["phase"], 0.030307096514232003);
  near(m["sprague_geers"]["comprehensive"], 0.034762490109700846);
  near(m["geers_1984"]["phase"], 0.004529291790084433);
  near(m["geers_1984"]["comprehensive"], 0.017618884857555587);
  near(m["russell"]["magnitude"], 0.0144232806407379);
  near(m["russell"]["comprehensive"], 0.02974543970797637);
  near(m["theil_u"], 0.04832953233145978);
  near(m["whang"], 0.04668756244510931);
  near(m["zilliacus"], 0.09196018870826353);
  near(m["rss_factor"], 0.09748196010082748);
  near(m["weighted_integrated_factor"], 0.09394076781070873);
  near(m["correlation"], 0.9935800586639424);
  near(m["r_squared"], 0.9828876304650903);
  near(m["rmse"], 229.7528583515775);
  near(m["nrmse"], 0.051056190744795005);
  near(m["nrmse_rms"], 0.09748196010082746);
  near(m["anova"]["t"], 4.2384592415450255);
  near(m["peak_ratio"], 1.0666666666666669);
  near(m["impulse_ratio"], 0.9696935091949029);
  EXPECT_EQ(m["nrmse_divisor"], "max |measured|");
  EXPECT_EQ(j["scalars"]["peak"]["error"], 300.0);
  near(j["scalars"]["impulse"]["measured"], 4500e-6 / std::tan(M_PI / 440.0));  // Σ sin
}

TEST_F(Compare, HasTheNamesOfTheDesignPage) {
  const json j = told(shot() + " " + model());
  for (const char* name : {"sprague_geers", "geers_1984", "russell"})
    for (const char* part : {"magnitude", "phase", "comprehensive"})
      EXPECT_TRUE(j["metrics"][name][part].is_number()) << name << " " << part;
  for (const char* name : {"theil_u", "whang", "nrmse", "correlation"})
    EXPECT_TRUE(j["metrics"][name].is_number()) << name;
  for (const char* part : {"corridor", "phase", "magnitude", "slope", "rating"})
    EXPECT_TRUE(j["metrics"]["iso18571"][part].is_number()) << part;
  const json& iso = j["metrics"]["iso18571"];
  EXPECT_NEAR(number(iso["rating"]),
              0.4 * number(iso["corridor"]) +
                  0.2 * (number(iso["phase"]) + number(iso["magnitude"]) + number(iso["slope"])),
              1e-15);
}

TEST_F(Compare, ExplainsItselfInATable) {
  const Outcome o = run("compare " + shot() + " " + model());
  EXPECT_EQ(o.code, 0) << o.err;
  EXPECT_EQ(o.err, "");
  EXPECT_THAT(o.out, HasSubstr("401 samples 1e-06 s apart"));
  EXPECT_THAT(o.out, HasSubstr("RMSE / max |measured|"));
  EXPECT_THAT(o.out, HasSubstr("(+6.7 %)"));
  EXPECT_THAT(o.out, HasSubstr("excellent (> 0.94 excellent, > 0.8 good, > 0.58 fair)"));
  EXPECT_THAT(o.out, HasSubstr("would accept this"));
}

TEST_F(Compare, ReadsWhatSimulateWrites) {
  const std::string quick = " --set solver.model=rigid --set solver.duration=\"0.4 ms\"";
  for (const char* ending : {"h5", "csv"})
    ASSERT_EQ(run("simulate " + rig + quick + " -o " + path(std::string("a.") + ending)).code, 0);
  const json same = told(path("a.h5") + " " + path("a.csv") + " --channel Force");
  EXPECT_EQ(same["metrics"]["nrmse"], 0.0);
  EXPECT_EQ(same["metrics"]["iso18571"]["rating"], 1.0);
  EXPECT_EQ(same["resampled"], false);
  EXPECT_THAT(refused(path("a.h5") + " " + path("a.csv")),
              HasSubstr("a.h5: has 4 channels ('Force', 'Velocity', 'Displacement', "
                        "'Penetration'); choose one with --channel"));
  // the shipped shot is in volts: the rig file knows the sensors
  const std::string example = samples + "shen2007-1.uff " + path("a.h5") + " --channel Force";
  EXPECT_THAT(refused(example), HasSubstr("--rig"));
  const json j = told(example + " --to 300e-6 --rig " + rig);
  EXPECT_EQ(j["unit"], "N");
  EXPECT_EQ(j["resampled"], true);  // the sensor's delay was taken off
  EXPECT_NEAR(number(j["scalars"]["peak"]["measured"]), 2084.0, 1.0);
}

TEST_F(Compare, ConvertsUnitsOrRefuses) {
  const std::string kilo = history(
      "kilo.csv", [](double t) { return 1e-3 * predicted(t); }, "time [s],Force [kN]");
  const json j = told(shot() + " " + kilo);
  EXPECT_EQ(j["predicted"]["unit"], "kN");
  EXPECT_NEAR(number(j["metrics"]["sprague_geers"]["magnitude"]), 0.01702676186196528, 1e-12);
  const std::string speed = history("speed.csv", predicted, "time [s],Velocity [m/s]");
  EXPECT_THAT(refused(shot() + " " + speed),
              HasSubstr("speed.csv: channel 'Velocity' is in 'm/s', the measured 'Force' in 'N'"));
  const std::string bare = history("bare.csv", predicted, "time,force");
  EXPECT_THAT(refused(shot() + " " + bare), HasSubstr("--predicted-units"));
  EXPECT_EQ(told(shot() + " " + bare + " --predicted-units s,N")["unit"], "N");
  EXPECT_EQ(told(bare + " " + bare)["unit"], "");
}

TEST_F(Compare, ResamplesAndSaysSo) {
  const std::string fine = history("fine.csv", predicted, "time [s],Force [N]", 2.5e-7, 1601);
  const Outcome o = run("compare --json " + shot() + " " + fine);
  EXPECT_THAT(o.err, HasSubstr("warning: " + fine +
                               ": 'Force' was resampled by straight lines to "
                               "401 instants 1e-06 s apart; its own step is 2.5e-07 s"));
  const json j = json::parse(o.out);
  EXPECT_EQ(j["resampled"], true);
  EXPECT_EQ(j["measured_resampled"], false);
  EXPECT_THAT(j["warnings"][0].get<std::string>(), HasSubstr("was resampled"));
  // every fourth sample lies on an instant, so that nothing changes
  EXPECT_NEAR(number(j["metrics"]["rmse"]), 229.7528583515775, 1e-6);
  EXPECT_EQ(run("compare -q --json " + shot() + " " + fine).err, "");
}

TEST_F(Compare, CutsAWindowAndMovesThePrediction) {
  const json window = told(shot() + " " + model() + " --from 100e-6 --to 200e-6");
  EXPECT_EQ(window["samples"], 101);
  EXPECT_NEAR(number(window["from_s"]), 100e-6, 1e-15);
  EXPECT_NEAR(number(window["to_s"]), 200e-6, 1e-15);
  const std::string late = history("late.csv", [](double t) { return measured(t - 7e-6); });
  const json as_is = told(shot() + " " + late);
  EXPECT_EQ(as_is["metrics"]["iso18571"]["shift_samples"], 7);
  const json moved = told(shot() + " " + late + " --shift=-7e-6");
  EXPECT_EQ(moved["shift_s"], -7e-6);
  EXPECT_EQ(moved["samples"], 394);
  EXPECT_NEAR(number(moved["metrics"]["rmse"]), 0.0, 1e-9);
  EXPECT_THAT(moved["warnings"][0].get<std::string>(), HasSubstr("is compared from 0 s to"));
}

TEST_F(Compare, SaysWhatIsNotDefined) {
  const std::string level = history("level.csv", [](double) { return 7.0; });
  const Outcome o = run("compare --json " + level + " " + model());
  EXPECT_EQ(o.code, 0);
  EXPECT_THAT(o.err,
              HasSubstr("warning: the measured history is constant: correlation, R^2 and the "
                        "NRMSE of the range are not defined"));
  EXPECT_TRUE(json::parse(o.out)["metrics"]["correlation"].is_null());
  EXPECT_THAT(run("compare " + shot() + " " + level).err,
              HasSubstr("the predicted history is constant: its correlation is not defined"));
  const std::string silent = history("silent.csv", [](double) { return 0.0; });
  EXPECT_THAT(refused(silent + " " + model()),
              HasSubstr("silent.csv: channel 'Force' is zero throughout from 0 s to 0.0004 s"));
  EXPECT_EQ(told(shot() + " " + silent)["metrics"]["sprague_geers"]["magnitude"], -1.0);
}

TEST_F(Compare, RefusesWhatHasNothingInCommon) {
  const std::string far = write("far.csv", "time [s],Force [N]\n1,0\n1.000001,1\n1.000002,2\n");
  EXPECT_THAT(refused(shot() + " " + far), HasSubstr("have no instants in common"));
  EXPECT_THAT(refused(shot() + " " + model() + " --from 1 --to 2"), HasSubstr("shot.csv"));
  EXPECT_THAT(refused(shot() + " " + model() + " --channel Frce"),
              HasSubstr("there is no channel 'Frce', neither here ('Force') nor in"));
  EXPECT_THAT(refused(shot() + " " + model() + " --predicted-channel Frce"),
              HasSubstr("model.csv: there is no channel 'Frce'; the channels are 'Force'"));
  EXPECT_THAT(refused(shot() + " " + path("absent.csv"), 4), HasSubstr("absent.csv"));
  refused(shot(), 2);
  EXPECT_THAT(refused(shot() + " " + model() + " --from 2 --to 1", 2), HasSubstr("--from"));
}

TEST_F(Compare, TakesEachSidesOwnChannel) {
  std::string text = "time [s],Force [N],Model [N]\n";
  for (int i = 0; i < 401; ++i)
    text += fmt::format("{},{},{}\n", 1e-6 * i, measured(1e-6 * i), predicted(1e-6 * i));
  const std::string both = write("both.csv", text);
  EXPECT_THAT(refused(both + " " + model()), HasSubstr("choose one with --channel"));
  EXPECT_THAT(refused(both + " " + both + " --channel Frce"),
              HasSubstr("there is no channel 'Frce'; the channels are 'Force', 'Model'"));
  const double wanted = 229.7528583515775;
  for (const char* choice :
       {" --channel Force --predicted-channel Model", " --channel 0 --predicted-channel 1"})
    EXPECT_NEAR(number(told(both + " " + both + choice)["metrics"]["rmse"]), wanted, 1e-6);
  // a file with one channel needs no name
  EXPECT_NEAR(number(told(both + " " + model() + " --channel Force")["metrics"]["rmse"]), wanted,
              1e-6);
  EXPECT_NEAR(number(told(shot() + " " + both + " --channel Model")["metrics"]["rmse"]), wanted,
              1e-6);
}

TEST_F(Compare, BridgesAndCountsWhatIsNotSound) {
  std::string text = "time [s],Force [N]\n";
  for (int i = 0; i < 401; ++i)
    text += fmt::format("{},{}\n", 1e-6 * i,
                        i == 120 ? std::string("nan") : fmt::format("{}", predicted(1e-6 * i)));
  const Outcome o = run("compare --json " + shot() + " " + write("gap.csv", text));
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_EQ(json::parse(o.out)["bridged"]["predicted"], 1);
  EXPECT_EQ(json::parse(o.out)["bridged"]["measured"], 0);
  EXPECT_THAT(o.err, HasSubstr("was bridged by straight lines"));
}

// E = 300 N, u_val = √(20² + 48² + 45²) with 1 % of each peak.
TEST_F(Compare, ValidatesScalarsWithStatedUncertainties) {
  const std::string both = shot() + " " + model();
  const json j = told(both +
                      " --u-num peak=\"20 N\" --u-input peak=\"1 %\" --u-data peak=\"1 %\" "
                      "--coverage-factor 3");
  const json& peak = j["scalars"]["peak"]["validation"];
  const double u = std::sqrt(20.0 * 20.0 + 48.0 * 48.0 + 45.0 * 45.0);
  EXPECT_NEAR(number(peak["u_val"]), u, 1e-9);
  EXPECT_NEAR(number(peak["low"]), 300.0 - 3.0 * u, 1e-9);
  EXPECT_EQ(peak["verdict"], "model error");
  EXPECT_FALSE(j["scalars"]["impulse"].contains("validation"));
  EXPECT_THAT(run("compare " + both + " --u-data peak=\"400 N\"").out, HasSubstr("within noise"));
  EXPECT_THAT(refused(both + " --u-data peak=60", 2), HasSubstr("60 has no unit"));
  EXPECT_THAT(refused(both + " --u-data pek=60", 2),
              HasSubstr("expected peak, peak_time, impulse"));
  EXPECT_THAT(refused(both + " --u-num peak=\"-1 N\"", 2), HasSubstr("is not negative"));
  EXPECT_THAT(refused(both + " --coverage-factor 0", 2), HasSubstr("greater than zero"));
}

// Peaks 4500, 4600 and 4700 N against 4800 N: mean distance 200, standard error 100 / √3.
TEST_F(Compare, ComparesWithRepeatedShots) {
  const std::string second =
      history("second.csv", [](double t) { return measured(t) * 4600.0 / 4500.0; });
  const std::string third =
      history("third.csv", [](double t) { return measured(t) * 4700.0 / 4500.0; });
  const std::string all = shot() + " " + model() + " --repeat " + second + " --repeat " + third;
  const json j = told(all);
  EXPECT_EQ(j["repeats"]["shots"], 3);
  const json& peak = j["scalars"]["peak"];
  EXPECT_NEAR(number(peak["area_metric"]), 200.0, 1e-9);
  EXPECT_NEAR(number(peak["measured"]), 4600.0, 1e-9);
  EXPECT_NEAR(number(peak["validation"]["u_val"]), 100.0 / std::sqrt(3.0), 1e-9);
  EXPECT_GT(number(j["repeats"]["chi2_per_sample"]), 1.0);
  EXPECT_LT(number(j["repeats"]["coverage"]["fraction"]), 1.0);
  // the waveform metrics stay those of the first shot
  EXPECT_NEAR(number(j["metrics"]["rmse"]), 229.7528583515775, 1e-6);
  EXPECT_THAT(run("compare " + all).out, HasSubstr("3 shots, area metric 200"));
  const std::string brief = history("brief.csv", measured, "time [s],Force [N]", 1e-6, 300);
  EXPECT_THAT(refused(all + " --repeat " + brief),
              HasSubstr("brief.csv: covers 0 s to 0.000299 s of the 0 s to 0.0004 s"));
}

// Copies scatter by nothing, and χ² divided by that.
TEST_F(Compare, RefusesAShotThatIsNamedTwice) {
  const std::string second =
      history("second.csv", [](double t) { return measured(t) * 4600.0 / 4500.0; });
  const std::string copy = history("copy.csv", measured);
  EXPECT_THAT(refused(shot() + " " + model() + " --repeat " + copy),
              HasSubstr("copy.csv: is the same recording as " + shot() + "; name each once"));
  EXPECT_THAT(refused(shot() + " " + model() + " --repeat " + second + " --repeat " + second),
              HasSubstr("second.csv: is the same recording as"));
}

TEST_F(Compare, HelpsWithAnExample) {
  const Outcome o = run("compare --help");
  EXPECT_EQ(o.code, 0);
  EXPECT_THAT(o.out, HasSubstr("impactrig compare shot.uff history.h5"));
  EXPECT_THAT(run("--help").out, HasSubstr("compare"));
}

TEST_F(Compare, ItsDocumentNamesSourcesThatAreInTheBibliography) {
  const std::string document = text_of(impactrig::tests::source_dir + "/docs/metrics.md");
  const std::string bibliography = text_of(impactrig::tests::source_dir + "/docs/references.bib");
  const std::regex key("\\[([A-Z][A-Za-z]*[0-9]+|ASMEVV20)\\](?!\\()");
  int found = 0;
  for (auto i = std::sregex_iterator(document.begin(), document.end(), key);
       i != std::sregex_iterator(); ++i, ++found)
    EXPECT_THAT(bibliography, HasSubstr("{" + (*i)[1].str() + ","));
  EXPECT_GE(found, 10);
}

}  // namespace
