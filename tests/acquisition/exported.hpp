// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <filesystem>
#include <limits>
#include <random>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "acquisition/exporter.hpp"
#include "datasets/input_error.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition::tests {

/// A path for the running test's output; the file is removed.
class OutputPath {
 public:
  explicit OutputPath(const std::string& ending)
      : path_(testing::TempDir() + "impactrig_out_" + WrittenFile::test_name() +
              std::to_string(getpid()) + ending) {}

  ~OutputPath() { std::filesystem::remove(path_); }

  OutputPath(const OutputPath&) = delete;
  OutputPath& operator=(const OutputPath&) = delete;

  operator const std::string&() const { return path_; }

  std::string part() const { return path_ + ".part"; }

  bool exists() const { return std::filesystem::exists(path_); }

 private:
  std::string path_;
};

/// Two channels of one clock, with samples of every magnitude.
inline datasets::Record example(std::size_t n = 500) {
  datasets::Record record;
  record.started = "2020-04-30T19:12:52";
  std::mt19937_64 random(5);
  for (const auto& [name, unit, quantity] :
       {std::tuple{"Force", "N", datasets::Quantity::force},
        std::tuple{"Velocity, laser", "mm/s", datasets::Quantity::velocity}}) {
    datasets::Channel channel;
    channel.name = name;
    channel.unit = unit;
    channel.quantity = quantity;
    channel.clock.start = -1e-3;
    channel.clock.interval = 1e-6;
    std::vector<double> samples(n);
    for (double& sample : samples) {
      do {
        sample = std::bit_cast<double>(random());
      } while (!std::isfinite(sample));
    }
    if (n > 2) {
      samples[1] = -0.0;
      samples[2] = std::numeric_limits<double>::denorm_min();
    }
    channel.raw = std::move(samples);
    record.channels.push_back(std::move(channel));
  }
  return record;
}

inline datasets::Record round_trip(const datasets::Record& record, const std::string& ending) {
  const OutputPath path(ending);
  export_recording(record, path);
  EXPECT_FALSE(std::filesystem::exists(path.part()));
  ImportOptions options;
  options.require_clock = false;
  return import_recording(path, options);
}

inline std::vector<std::string> export_warnings(const datasets::Record& record,
                                                const std::string& ending) {
  const OutputPath path(ending);
  return export_recording(record, path);
}

inline void expect_same_samples(const datasets::Channel& a, const datasets::Channel& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::isnan(a.value(i)) && std::isnan(b.value(i))) continue;
    ASSERT_EQ(std::bit_cast<std::uint64_t>(a.value(i)), std::bit_cast<std::uint64_t>(b.value(i)))
        << i;
  }
  EXPECT_EQ(a.imaginary, b.imaginary);
}

inline void expect_same_head(const datasets::Channel& a, const datasets::Channel& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.unit, b.unit);
  EXPECT_EQ(a.quantity, b.quantity);
  EXPECT_EQ(a.clock.start, b.clock.start);
  EXPECT_EQ(a.clock.interval, b.clock.interval);
  EXPECT_EQ(a.clock.times, b.clock.times);
}

inline std::string export_error(const datasets::Record& record, const std::string& ending,
                                std::string_view format = {}) {
  const OutputPath path(ending);
  try {
    export_recording(record, path, format);
  } catch (const datasets::FileError& error) {
    EXPECT_FALSE(path.exists());
    EXPECT_FALSE(std::filesystem::exists(path.part()));
    std::string text = error.what();
    return text.replace(0, static_cast<const std::string&>(path).size(), "OUT");
  }
  return {};
}

}  // namespace impactrig::acquisition::tests
