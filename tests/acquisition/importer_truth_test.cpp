// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "acquisition/importer.hpp"
#include "acquisition/statistics.hpp"

namespace impactrig::acquisition {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const fs::path recordings = fs::path(IMPACTRIG_SHARED_DIR) / "recordings";

/// Third-party recordings, each with the answer of another reader beside it (X.truth.json).
class Recording : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    file_ = recordings / GetParam();
    if (!fs::exists(file_)) GTEST_SKIP() << "no recordings at " << recordings;
    std::ifstream(file_.string() + ".truth.json") >> truth_;
    ImportOptions options;
    options.require_clock = false;
    record_ = import_recording(file_.string(), options);
  }

  fs::path file_;
  json truth_;
  datasets::Record record_;
};

double relative(double value, double expected) {
  return expected == 0.0 ? std::abs(value) : std::abs(value / expected - 1.0);
}

/// Where the other reader computes in single precision, or prints nine decimals, as
/// shared/recordings/README.md says.
double tolerance_of(const json& truth) {
  return truth["format"] == "scope" || truth["format"] == "imc" ? 1e-6 : 1e-9;
}

/// The other reader knows no samples that are not valid, other than those that are no numbers.
datasets::Channel with_marked_samples(datasets::Channel channel) {
  channel.valid.clear();
  return channel;
}

/// "NONE" and "" say nothing; where the other reader makes a name up, the file's own is beside it.
std::string expected_name(const json& expected) {
  if (expected.contains("cn_key_name_in_file_order")) return expected["cn_key_name_in_file_order"];
  return expected["name"] == "NONE" ? "" : expected["name"].get<std::string>();
}

TEST_P(Recording, AgreesWithAnotherReader) {
  EXPECT_EQ(record_.provenance.sha256, truth_["sha256"]);
  EXPECT_EQ(record_.provenance.bytes, truth_["bytes"]);
  const json& channels = truth_["channels"];
  const double tolerance = tolerance_of(truth_);
  const bool exact = tolerance < 1e-6;
  ASSERT_EQ(record_.channels.size(), truth_["n_channels"].get<std::size_t>());
  ASSERT_EQ(record_.channels.size(), channels.size());
  double worst_sum = 0.0;
  double worst_squares = 0.0;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const json& expected = channels[c];
    const datasets::Channel& channel = record_.channels[c];
    SCOPED_TRACE(channel.name);
    if (!expected_name(expected).empty()) {
      EXPECT_EQ(channel.name, expected_name(expected));
    }
    ASSERT_EQ(channel.size(), expected["n_samples"].get<std::size_t>());
    if (channel.size() == 0) continue;
    EXPECT_EQ(channel.unit, expected["unit"]);
    const bool marks = truth_["format"] == "catman";
    const ChannelStatistics figures = statistics(marks ? with_marked_samples(channel) : channel);
    EXPECT_EQ(figures.invalid, expected["n_nan"].get<std::size_t>());
    // relative to the largest sample
    const double largest =
        std::max(std::abs(expected["min"].get<double>()), std::abs(expected["max"].get<double>()));
    const double close = exact ? 0.0 : tolerance * largest;
    EXPECT_NEAR(figures.first, expected["first"][0].get<double>(), close);
    EXPECT_NEAR(figures.last, expected["last"].back().get<double>(), close);
    EXPECT_NEAR(figures.min, expected["min"].get<double>(), close);
    EXPECT_NEAR(figures.max, expected["max"].get<double>(), close);
    EXPECT_LT(relative(figures.sum, expected["sum"]), tolerance);
    EXPECT_LT(relative(figures.sum_of_squares, expected["sum_sq"]), tolerance);
    EXPECT_LT(relative(figures.mean, expected["mean"]), tolerance);
    EXPECT_LT(relative(figures.rms, expected["rms"]), tolerance);
    worst_sum = std::max(worst_sum, relative(figures.sum, expected["sum"]));
    worst_squares = std::max(worst_squares, relative(figures.sum_of_squares, expected["sum_sq"]));
    const double close_time = exact ? 0.0 : 1e-6;
    if (expected.contains("dt")) {
      EXPECT_LE(relative(channel.clock.interval, expected["dt"]), close_time);
    }
    if (expected.contains("t0")) {
      EXPECT_EQ(channel.clock.start, expected["t0"].get<double>());
    }
    if (expected.contains("x_first")) {
      EXPECT_EQ(channel.clock.start, expected["x_first"].get<double>());
    }
    if (expected.contains("x_step_mean")) {
      EXPECT_LT(relative(channel.clock.interval, expected["x_step_mean"]),
                exact ? 1e-12 : close_time);
      EXPECT_EQ(channel.clock.uniform(), expected["x_uniform_1e-3"].get<bool>());
    }
  }
  RecordProperty("channels", static_cast<int>(channels.size()));
  RecordProperty("worst_sum", fmt::format("{:.1e}", worst_sum));
  RecordProperty("worst_squares", fmt::format("{:.1e}", worst_squares));
}

INSTANTIATE_TEST_SUITE_P(
    Shared, Recording,
    testing::Values("uff/binary8byte.uff", "uff/catman_time_history.uff", "uff/header_1858.uff",
                    "uff/mps_first_set_fixed.uff", "uff/sample_58_ascii.uff",
                    "uff/sample_58b_bin.uff", "uff/testlab_161_164_18_15_82.uff",
                    "text/drop_tower_accel_1.csv", "text/rigol_ds1054z.csv",
                    "text/rigol_ds1102d.csv", "text/rigol_ds1102e.csv", "text/shock_base.txt",
                    "text/tek_mso64.csv", "polytec_ascii/time_ref1_voltage.txt",
                    "polytec_ascii/time_velocity_clipboard.txt", "scope/bin_DHO824-ch1.bin",
                    "scope/bin_MSO5000-A.bin", "scope/bin_agilent_1.bin", "scope/bin_agilent_4.bin",
                    "scope/tek_analog_waveform.wfm", "scope/tek_golden_analog.wfm",
                    "scope/trc_lecroy_3.trc", "scope/trc_lecroy_4.trc", "scope/wfm_DS1054Z-A.wfm",
                    "scope/wfm_DS1102D-A.wfm", "catman/job_4byte.bin", "imc/datasetA_1.raw",
                    "imc/datasetA_21.raw"),
    [](const auto& instance) {
      std::string name = instance.param;
      for (char& c : name)
        if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
      return name;
    });

}  // namespace
}  // namespace impactrig::acquisition
