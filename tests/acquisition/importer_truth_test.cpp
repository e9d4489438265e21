// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "acquisition/importer.hpp"
#include "acquisition/importers/number.hpp"
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

TEST_P(Recording, AgreesWithAnotherReader) {
  EXPECT_EQ(record_.provenance.sha256, truth_["sha256"]);
  EXPECT_EQ(record_.provenance.bytes, truth_["bytes"]);
  json channels = json::array();  // texts and structures are listed, but are no channels
  std::size_t without_numbers = 0;
  for (const json& expected : truth_["channels"])
    expected.value("non_numeric", false) ? void(++without_numbers) : channels.push_back(expected);
  ASSERT_EQ(record_.channels.size() + without_numbers, truth_["n_channels"].get<std::size_t>());
  ASSERT_EQ(record_.channels.size(), channels.size());
  double worst_sum = 0.0;
  double worst_squares = 0.0;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const json& expected = channels[c];
    const datasets::Channel& channel = record_.channels[c];
    SCOPED_TRACE(channel.name);
    if (expected["name"] != "NONE") {
      // some readers keep the blanks that a file writes around its names
      EXPECT_EQ(channel.name, trimmed(expected["name"].get<std::string>()));
    }
    ASSERT_EQ(channel.size(), expected["n_samples"].get<std::size_t>());
    if (channel.size() == 0) continue;
    EXPECT_EQ(channel.unit, expected["unit"].is_null() ? "" : expected["unit"]);
    const ChannelStatistics figures = statistics(channel);
    EXPECT_EQ(figures.invalid, expected["n_nan"].get<std::size_t>());
    if (expected.value("complex", false)) {
      EXPECT_LT(relative(figures.complex_sum.real(), expected["sum_re"]), 1e-9);
      EXPECT_NEAR(figures.complex_sum.imag(), expected["sum_im"].get<double>(),
                  1e-9 * expected["sum_abs2"].get<double>());
      EXPECT_LT(relative(figures.sum_abs2, expected["sum_abs2"]), 1e-9);
      continue;
    }
    EXPECT_EQ(figures.first, expected["first"][0].get<double>());
    EXPECT_EQ(figures.last, expected["last"].back().get<double>());
    EXPECT_EQ(figures.min, expected["min"].get<double>());
    EXPECT_EQ(figures.max, expected["max"].get<double>());
    EXPECT_LT(relative(figures.sum, expected["sum"]), 1e-9);
    EXPECT_LT(relative(figures.sum_of_squares, expected["sum_sq"]), 1e-9);
    EXPECT_LT(relative(figures.mean, expected["mean"]), 1e-9);
    EXPECT_LT(relative(figures.rms, expected["rms"]), 1e-9);
    worst_sum = std::max(worst_sum, relative(figures.sum, expected["sum"]));
    worst_squares = std::max(worst_squares, relative(figures.sum_of_squares, expected["sum_sq"]));
    // a stated interval counts only where there are no times
    if (expected.contains("dt") && !expected.contains("x_first")) {
      EXPECT_EQ(channel.clock.interval, expected["dt"].get<double>());
    }
    if (expected.contains("t0")) {
      EXPECT_EQ(channel.clock.start, expected["t0"].get<double>());
    }
    if (expected.contains("x_first")) {
      EXPECT_EQ(channel.clock.start, expected["x_first"].get<double>());
    }
    if (expected.contains("x_step_mean")) {
      EXPECT_LT(relative(channel.clock.interval, expected["x_step_mean"]), 1e-12);
      EXPECT_EQ(channel.clock.uniform(), expected["x_uniform_1e-3"].get<bool>());
    }
  }
  RecordProperty("channels", static_cast<int>(channels.size()));
  RecordProperty("worst_sum", fmt::format("{:.1e}", worst_sum));
  RecordProperty("worst_squares", fmt::format("{:.1e}", worst_squares));
}

INSTANTIATE_TEST_SUITE_P(
    Shared, Recording,
    testing::Values(
        "uff/binary8byte.uff", "uff/catman_time_history.uff", "uff/header_1858.uff",
        "uff/mps_first_set_fixed.uff", "uff/sample_58_ascii.uff", "uff/sample_58b_bin.uff",
        "uff/testlab_161_164_18_15_82.uff", "text/drop_tower_accel_1.csv", "text/rigol_ds1054z.csv",
        "text/rigol_ds1102d.csv", "text/rigol_ds1102e.csv", "text/shock_base.txt",
        "text/tek_mso64.csv", "polytec_ascii/time_ref1_voltage.txt",
        "polytec_ascii/time_velocity_clipboard.txt", "lvm/force_pounds_downsampled.lvm",
        "lvm/hammer_short_decimal_comma.lvm", "lvm/hammer_short_newline_end.lvm",
        "lvm/impact_5kg_headerless.lvm", "lvm/long_three_channels.lvm", "lvm/multi_time_column.lvm",
        "lvm/no_decimal_separator.lvm", "mat/tek_analog.mat", "mat/testcomplex_7.4_GLNX86.mat",
        "mat/testdouble_6.1_SOL2.mat", "mat/testdouble_7.4_GLNX86.mat",
        "mat/testhdf5_7.4_GLNX86.mat", "mat/testmatrix_6.5.1_GLNX86.mat", "wav/living_room_ir.wav",
        "wav/test-44100Hz-2ch-32bit-float-le.wav", "wav/test-44100Hz-le-1ch-4bytes.wav",
        "wav/test-8000Hz-le-2ch-1byteu.wav", "wav/test-8000Hz-le-3ch-5S-24bit.wav"),
    [](const auto& instance) {
      std::string name = instance.param;
      for (char& c : name)
        if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
      return name;
    });

}  // namespace
}  // namespace impactrig::acquisition
