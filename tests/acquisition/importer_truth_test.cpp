// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "acquisition/importer.hpp"
#include "acquisition/statistics.hpp"
#include "datasets/input_error.hpp"

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

std::string test_name(std::string name) {
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  return name;
}

TEST_P(Recording, AgreesWithAnotherReader) {
  EXPECT_EQ(record_.provenance.sha256, truth_["sha256"]);
  EXPECT_EQ(record_.provenance.bytes, truth_["bytes"]);
  const json& channels = truth_["channels"];
  ASSERT_EQ(record_.channels.size(), truth_["n_channels"].get<std::size_t>());
  ASSERT_EQ(record_.channels.size(), channels.size());
  double worst_sum = 0.0;
  double worst_squares = 0.0;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const json& expected = channels[c];
    const datasets::Channel& channel = record_.channels[c];
    SCOPED_TRACE(channel.name);
    if (expected["name"] != "NONE") {
      EXPECT_EQ(channel.name, expected["name"]);
    }
    ASSERT_EQ(channel.size(), expected["n_samples"].get<std::size_t>());
    if (channel.size() == 0) continue;
    if (expected.contains("group") && channel.attributes.contains("group")) {
      EXPECT_EQ(channel.attributes.at("group"), expected["group"]);
    }
    if (expected.value("non_numeric", false)) continue;  // the reader has texts or dates
    EXPECT_EQ(channel.unit, expected["unit"].is_null() ? "" : expected["unit"].get<std::string>());
    const ChannelStatistics figures = statistics(channel);
    EXPECT_EQ(figures.invalid, expected["n_nan"].get<std::size_t>());
    if (expected.value("complex", false)) {
      EXPECT_LT(relative(figures.complex_sum.real(), expected["sum_re"]), 1e-9);
      EXPECT_LT(relative(figures.complex_sum.imag(), expected["sum_im"]), 1e-9);
      EXPECT_LT(relative(figures.sum_abs2, expected["sum_abs2"]), 1e-9);
      worst_squares = std::max(worst_squares, relative(figures.sum_abs2, expected["sum_abs2"]));
      continue;
    }
    if (expected["first"][0].is_number()) {
      EXPECT_EQ(figures.first, expected["first"][0].get<double>());
    }
    if (expected["last"].back().is_number()) {
      EXPECT_EQ(figures.last, expected["last"].back().get<double>());
    }
    EXPECT_EQ(figures.min, expected["min"].get<double>());
    EXPECT_EQ(figures.max, expected["max"].get<double>());
    EXPECT_LT(relative(figures.sum, expected["sum"]), 1e-9);
    EXPECT_LT(relative(figures.sum_of_squares, expected["sum_sq"]), 1e-9);
    EXPECT_LT(relative(figures.mean, expected["mean"]), 1e-9);
    EXPECT_LT(relative(figures.rms, expected["rms"]), 1e-9);
    worst_sum = std::max(worst_sum, relative(figures.sum, expected["sum"]));
    worst_squares = std::max(worst_squares, relative(figures.sum_of_squares, expected["sum_sq"]));
    if (expected.contains("dt")) {
      EXPECT_EQ(channel.clock.interval, expected["dt"].get<double>());
    }
    if (expected.contains("t0")) {
      EXPECT_EQ(channel.clock.start, expected["t0"].get<double>());
    }
    if (expected.contains("start_time") && expected["start_time"].is_string()) {
      const auto started = expected["start_time"].get<std::string>();  // with six decimals
      EXPECT_EQ(record_.started.substr(0, 19), started.substr(0, 19));
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
        "polytec_ascii/time_velocity_clipboard.txt", "mdf4/test_batch_cut_0.mf4",
        "tdms/example_no_waveform.tdms", "tdms/offshore_accel_1.tdms", "tdms/raw1_scaled.tdms",
        "tdms/raw_timestamps.tdms", "tdms_scenarios/daqmx_mixed_channel_widths.tdms",
        "tdms_scenarios/daqmx_multiple_raw_data_buffers.tdms",
        "tdms_scenarios/daqmx_single_channel_i16.tdms", "tdms_scenarios/daqmx_two_channel_i16.tdms",
        "tdms_scenarios/scn_add_new_channel.tdms", "tdms_scenarios/scn_chunked_segment.tdms",
        "tdms_scenarios/scn_complex_data.tdms", "tdms_scenarios/scn_float_data.tdms",
        "tdms_scenarios/scn_incomplete_last_segment.tdms",
        "tdms_scenarios/scn_increase_channel_size.tdms",
        "tdms_scenarios/scn_no_metadata_segment.tdms", "tdms_scenarios/scn_scaled_data.tdms",
        "tdms_scenarios/scn_single_segment_with_one_channel.tdms",
        "tdms_scenarios/scn_single_segment_with_two_channels.tdms",
        "tdms_scenarios/scn_single_segment_with_two_channels_interleaved.tdms",
        "tdms_scenarios/scn_timestamp_data.tdms"),
    [](const auto& instance) { return test_name(instance.param); });

/// The recordings of a folder that are to be read, or those that are to be refused.
std::vector<std::string> recordings_in(const char* folder, const std::string& expected) {
  std::vector<std::string> files;
  if (!fs::exists(recordings / folder)) return files;
  for (const auto& entry : fs::directory_iterator(recordings / folder)) {
    json truth;
    const fs::path beside = entry.path().string() + ".truth.json";
    if (!fs::exists(beside)) continue;
    std::ifstream(beside) >> truth;
    if (truth["expect"] == expected)
      files.push_back((fs::path(folder) / entry.path().filename()).string());
  }
  std::ranges::sort(files);
  return files;
}

TEST(RefusedRecordings, OfTdmsSayWhy) {
  for (const std::string& file : recordings_in("tdms_scenarios", "error"))
    EXPECT_THROW(import_recording((recordings / file).string()), datasets::InputError) << file;
}

}  // namespace
}  // namespace impactrig::acquisition
