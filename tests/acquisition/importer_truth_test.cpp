// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "acquisition/importer.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/statistics.hpp"
#include "datasets/input_error.hpp"
#include "tests/acquisition/shared_recordings.hpp"

namespace impactrig::acquisition {
namespace {

using nlohmann::json;

double relative(double value, double expected) {
  return expected == 0.0 ? std::abs(value) : std::abs(value / expected - 1.0);
}

/// Where the other reader computes in single precision, or prints nine decimals, as
/// shared/recordings/README.md says.
double tolerance_of(const json& truth) {
  return truth["format"] == "scope" || truth["format"] == "imc" ? 1e-6 : 1e-9;
}

/// "NONE" and "" say nothing; where the other reader makes a name up, the file's own is beside it;
/// some readers keep the blanks that a file writes around its names.
std::string expected_name(const json& expected) {
  if (expected.contains("cn_key_name_in_file_order")) return expected["cn_key_name_in_file_order"];
  const std::string name = expected["name"];
  return name == "NONE" ? "" : std::string(trimmed(name));
}

/// The channels that other readers list; a MAT-file's texts and structures are none (of structures
/// we read the fields).
std::vector<json> expected_channels(const json& truth) {
  std::vector<json> channels;
  for (const json& expected : truth["channels"])
    if (truth["format"] != "mat" || !expected.value("non_numeric", false))
      channels.push_back(expected);
  return channels;
}

/// The other reader knows no samples that are not valid, other than those that are no numbers.
datasets::Channel with_marked_samples(datasets::Channel channel) {
  channel.valid.clear();
  return channel;
}

void expect_complex(const ChannelStatistics& figures, const json& expected) {
  EXPECT_LT(relative(figures.complex_sum.real(), expected["sum_re"]), 1e-9);
  EXPECT_NEAR(figures.complex_sum.imag(), expected["sum_im"].get<double>(),
              1e-9 * expected["sum_abs2"].get<double>());
  EXPECT_LT(relative(figures.sum_abs2, expected["sum_abs2"]), 1e-9);
}

void expect_real(const ChannelStatistics& figures, const json& expected, double tolerance) {
  // relative to the largest sample; another reader in double precision has the same numbers
  const double largest =
      std::max(std::abs(expected["min"].get<double>()), std::abs(expected["max"].get<double>()));
  const double close = tolerance < 1e-6 ? 0.0 : tolerance * largest;
  if (expected["first"][0].is_number()) {
    EXPECT_NEAR(figures.first, expected["first"][0].get<double>(), close);
  }
  if (expected["last"].back().is_number()) {
    EXPECT_NEAR(figures.last, expected["last"].back().get<double>(), close);
  }
  EXPECT_NEAR(figures.min, expected["min"].get<double>(), close);
  EXPECT_NEAR(figures.max, expected["max"].get<double>(), close);
  EXPECT_LT(relative(figures.sum, expected["sum"]), tolerance);
  EXPECT_LT(relative(figures.sum_of_squares, expected["sum_sq"]), tolerance);
  EXPECT_LT(relative(figures.mean, expected["mean"]), tolerance);
  EXPECT_LT(relative(figures.rms, expected["rms"]), tolerance);
}

void expect_clock(const datasets::SampleClock& clock, const json& expected, double tolerance) {
  // a stated interval counts only where there are no times
  if (expected.contains("dt") && !expected.contains("x_first")) {
    EXPECT_LE(relative(clock.interval, expected["dt"]), tolerance < 1e-6 ? 0.0 : 1e-6);
  }
  if (expected.contains("t0")) {
    EXPECT_EQ(clock.start, expected["t0"].get<double>());
  }
  if (expected.contains("x_first")) {
    EXPECT_EQ(clock.start, expected["x_first"].get<double>());
  }
  if (expected.contains("x_step_mean")) {
    EXPECT_LT(relative(clock.interval, expected["x_step_mean"]), tolerance < 1e-6 ? 1e-12 : 1e-6);
    EXPECT_EQ(clock.uniform(), expected["x_uniform_1e-3"].get<bool>());
  }
}

void expect_channel(const datasets::Channel& channel, const json& expected, const json& truth) {
  SCOPED_TRACE(channel.name);
  const double tolerance = tolerance_of(truth);
  if (!expected_name(expected).empty()) {
    EXPECT_EQ(channel.name, expected_name(expected));
  }
  if (expected.contains("group") && channel.attributes.contains("group")) {
    EXPECT_EQ(channel.attributes.at("group"), expected["group"]);
  }
  ASSERT_EQ(channel.size(), expected["n_samples"].get<std::size_t>());
  if (channel.size() == 0 || expected.value("non_numeric", false)) return;
  EXPECT_EQ(channel.unit, expected["unit"].is_null() ? "" : expected["unit"].get<std::string>());
  const bool marks = truth["format"] == "catman";
  const ChannelStatistics figures = statistics(marks ? with_marked_samples(channel) : channel);
  EXPECT_EQ(figures.invalid, expected["n_nan"].get<std::size_t>());
  if (expected.value("complex", false))
    expect_complex(figures, expected);
  else
    expect_real(figures, expected, tolerance);
  expect_clock(channel.clock, expected, tolerance);
}

/// Third-party recordings, each with the answer of another reader beside it.
class Recording : public testing::TestWithParam<std::string> {};

TEST_P(Recording, AgreesWithAnotherReader) {
  const std::string file = (tests::shared_recordings() / GetParam()).string();
  json truth;
  std::ifstream(file + ".truth.json") >> truth;
  ImportOptions options;
  options.require_clock = false;
  if (truth["expect"] == "error") {
    EXPECT_THROW(import_recording(file, options), datasets::InputError);
    return;
  }
  const datasets::Record record = import_recording(file, options);
  EXPECT_EQ(record.provenance.sha256, truth["sha256"]);
  EXPECT_EQ(record.provenance.bytes, truth["bytes"]);
  const std::vector<json> channels = expected_channels(truth);
  if (channels.empty() && truth["n_channels"] > 0) return;
  ASSERT_EQ(record.channels.size(), channels.size());
  for (std::size_t c = 0; c < channels.size(); ++c)
    expect_channel(record.channels[c], channels[c], truth);
}

INSTANTIATE_TEST_SUITE_P(Shared, Recording, testing::ValuesIn(tests::names_of_shared_recordings()),
                         [](const auto& instance) { return tests::test_name_of(instance.param); });
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Recording);

TEST(SharedRecordings, AreThere) {
  if (tests::names_of_shared_recordings().empty())
    GTEST_SKIP() << "no recordings at " << tests::shared_recordings();
}

}  // namespace
}  // namespace impactrig::acquisition
