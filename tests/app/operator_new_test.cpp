// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <numeric>
#include <thread>
#include <vector>

#include "acquisition/conditioning/steps.hpp"
#include "acquisition/disk_memory.hpp"
#include "datasets/input_error.hpp"
#include "tests/acquisition/scene.hpp"

namespace impactrig::app {
namespace {

using acquisition::DiskMemory;
using acquisition::NoRoomOnDisk;
using datasets::ConditioningStep;
using datasets::Record;
using namespace tests;

double most_megabytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

// 640 MB in two arrays.
TEST(DiskMemory, HoldsMoreThanItTakesOfMemory) {
  const DiskMemory disk("long.wav");
  std::vector<double> values(40'000'000);
  std::iota(values.begin(), values.end(), 0.0);
  std::vector<double> turned = values;
  std::ranges::reverse(turned);
  for (std::size_t i = 0; i < values.size(); ++i)
    ASSERT_EQ(values[i] + turned[i], static_cast<double>(values.size() - 1));
  EXPECT_LT(most_megabytes(), 256.0);
}

TEST(DiskMemory, ArraysOutliveIt) {
  std::vector<double> values;
  {
    const DiskMemory disk("long.wav");
    values.assign(1'000'000, 1.0);
  }
  const DiskMemory another("long.wav");
  const std::vector<double> more(1'000'000, 2.0);
  values.insert(values.end(), more.begin(), more.end());
  EXPECT_EQ(std::accumulate(values.begin(), values.end(), 0.0), 3e6);
}

// While one thread makes and drops arrays, pages of the other's are given back.
TEST(DiskMemory, ServesSeveralThreads) {
  const DiskMemory disk("long.wav");
  const auto work = [] {
    for (int round = 1; round <= 50; ++round) {
      std::vector<int> values(100'000, round);
      ASSERT_EQ(std::accumulate(values.begin(), values.end(), 0), 100'000 * round);
    }
  };
  std::jthread other(work);
  work();
}

TEST(DiskMemory, OnAFullDiskSaysSo) {
  const DiskMemory disk("long.wav");
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit little = before;
  little.rlim_cur = 1 << 20;
  ::setrlimit(RLIMIT_FSIZE, &little);
  int error = 0;
  try {
    std::vector<double>(1'000'000);
  } catch (const NoRoomOnDisk& full) {
    error = full.error();
  }
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(error, EFBIG);
}

/// 0.1 s around an impact: every array is large enough for the disk.
Record shot() {
  const Sampling at{.start = -0.05, .interval = 1e-6, .samples = 100'000};
  const auto hum = [](double t) { return 3.0 * std::sin(2.0 * std::numbers::pi * 50.0 * t); };
  auto force = sampled(at, [&](double t) { return half_sine(t, 1500.0, 200e-6) + 12.0 + hum(t); });
  add_noise(force, 2.0, 1);
  auto velocity = sampled(at, [](double t) {
    const double done = std::clamp(t / 200e-6, 0.0, 1.0);
    return 0.44 - 0.32 * (1.0 - std::cos(std::numbers::pi * done));
  });
  add_noise(velocity, 1e-3, 2);
  std::fill_n(velocity.begin() + 20'000, 40, 0.0);
  return record_of({force_of(at, force), velocity_of(at, velocity)});
}

std::vector<ConditioningStep> every_step() {
  const datasets::TimeSpan quiet{-0.045, -0.001};
  return {{"Velocity", datasets::RepairDropouts{}},
          {"Force", datasets::RemoveBaseline{}},
          {"Force", datasets::RemoveDrift{}},
          {"Force", datasets::RemoveHum{}},
          {"Force", datasets::RemoveDecay{{quiet}, 0.02}},
          {"Force", datasets::UndoLowCut{0.3, quiet}},
          {"Velocity", datasets::AlignTo{"Force"}},
          {"*", datasets::LowPass{50e3, 4}},
          {"Velocity", datasets::Integrate{"way", {}, {}}},
          {"Velocity", datasets::Differentiate{"slope"}},
          {"way", datasets::Resample{437e3}}};
}

/// The record after each step.
std::vector<Record> after_each_step() {
  std::vector<Record> records{shot()};
  for (const ConditioningStep& step : every_step()) {
    records.push_back(records.back());
    acquisition::apply_steps({{step}}, records.back());
  }
  return records;
}

TEST(DiskMemory, EveryStepComesOutAsInMemory) {
  const std::vector<Record> in_memory = after_each_step();
  const DiskMemory disk("shot.csv");
  const std::vector<Record> on_disk = after_each_step();
  for (std::size_t i = 0; i < in_memory.size(); ++i) {
    SCOPED_TRACE(i);
    EXPECT_EQ(on_disk[i].warnings, in_memory[i].warnings);
    ASSERT_EQ(on_disk[i].channels.size(), in_memory[i].channels.size());
    for (std::size_t c = 0; c < on_disk[i].channels.size(); ++c) {
      const datasets::Channel& here = on_disk[i].channels[c];
      const datasets::Channel& there = in_memory[i].channels[c];
      EXPECT_TRUE(here.values() == there.values()) << here.name;
      EXPECT_TRUE(here.valid == there.valid) << here.name;
      EXPECT_EQ(here.clock.start, there.clock.start);
    }
    if (i == 0) continue;
    EXPECT_GT(on_disk[i].provenance.edits.size(), on_disk[i - 1].provenance.edits.size());
    EXPECT_EQ(on_disk[i].provenance.edits.back().parameters,
              in_memory[i].provenance.edits.back().parameters);
  }
}

}  // namespace
}  // namespace impactrig::app
