// SPDX-License-Identifier: BSD-3-Clause
//
// Fits of what has been through filters after it was sampled.
#include "fitting/filtered_samples.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "datasets/zero_phase_low_pass.hpp"
#include "fitting/fit.hpp"
#include "tests/fitting/fast_fit.hpp"

namespace impactrig::fitting {
namespace {

using datasets::ImpactSignal;
using datasets::LowPass;
using datasets::Resample;
using tests::parameter;

ImpactSignal signal_of(std::vector<datasets::SampleFilter> filters, double interval) {
  ImpactSignal signal;
  signal.channel = "Force";
  signal.interval = interval;
  signal.values.assign(1000, 0.0);
  signal.filters = std::move(filters);
  signal.recorded = {0.0, signal.time(999)};
  return signal;
}

// Half of the rate of what is left is at most what passes.
TEST(FilteredSamples, AreTakenAsFarApartAsTheFilterTiesThem) {
  EXPECT_EQ(every_of(signal_of({}, 1e-6)), 1U);
  for (const auto& [cutoff, every] :
       {std::pair{20e3, 25U}, {50e3, 10U}, {200e3, 3U}, {250e3, 2U}, {400e3, 2U}})
    EXPECT_EQ(every_of(signal_of({{LowPass{cutoff, 4}, 1e-6}}, 1e-6)), every) << cutoff;
  EXPECT_EQ(every_of(signal_of({{Resample{200e3}, 1e-6}}, 5e-6)), 2U);
  EXPECT_EQ(every_of(signal_of({{Resample{4e6}, 1e-6}}, 0.25e-6)), 5U);
  EXPECT_EQ(every_of(signal_of({{LowPass{50e3, 4}, 1e-6}, {Resample{200e3}, 1e-6}}, 5e-6)), 2U);
  EXPECT_EQ(thinning_sentence(signal_of({{LowPass{50e3, 4}, 1e-6}}, 1e-6)),
            "in the fit: of Force one sample in 10, since what its filters pass, up to 5e+04 Hz, "
            "ties those between to these");
}

TEST(FilteredSamples, AreSoundAwayFromWhatWasNotRecorded) {
  ImpactSignal plain = signal_of({}, 1e-6);
  plain.valid.assign(1000, 1);
  plain.valid[500] = 0;
  const auto all_but_one = sound_samples(plain);
  EXPECT_EQ(std::ranges::count(all_but_one, 0), 1);
  EXPECT_EQ(all_but_one[500], 0);

  ImpactSignal filtered = signal_of({{LowPass{200e3, 4}, 1e-6}}, 1e-6);
  filtered.valid = plain.valid;
  const auto near = static_cast<std::size_t>(filtered.filters[0].reach() / 1e-6);
  ASSERT_GT(near, 10U);
  const auto sound = sound_samples(filtered);
  for (std::size_t k = 0; k < 1000; ++k) {
    const bool at_end = k <= near || k >= 999 - near;
    const bool at_gap = k + near >= 500 && k <= 500 + near;
    ASSERT_EQ(sound[k], at_end || at_gap ? 0 : 1) << k;
  }
}

datasets::Impact filtered_shot(const tests::ShotTruth& truth, double cutoff) {
  datasets::Impact impact = tests::synthetic_shot(tests::hybrid_rig(), truth);
  for (auto* signal : {&impact.force, &impact.velocity}) {
    const LowPass action{cutoff, 4};
    (*signal)->values = zero_phase_low_pass((*signal)->values, (*signal)->interval, action);
    (*signal)->filters = {{action, (*signal)->interval}};
    (*signal)->recorded = {(*signal)->start, (*signal)->time((*signal)->values.size() - 1)};
  }
  return impact;
}

// Repeated shots of a known restitution, in white noise and in noise of memory: errors are as large
// as stated, and what is left over is noise.
class FilteredFit : public testing::TestWithParam<double> {};

TEST_P(FilteredFit, StatesItsErrorHonestly) {
  tests::Pulls pulls;
  int judged = 0, unsound = 0;
  for (int i = 0; i < 24; ++i) {
    const tests::ShotTruth truth{.restitution = 0.4 + 0.02 * (i % 20),
                                 .noise_memory = i % 2 == 0 ? 0.0 : 0.9,
                                 .duration = 2.5e-3,
                                 .seed = static_cast<std::uint64_t>(400 + i)};
    const Fit found = fit({filtered_shot(truth, GetParam())}, tests::hybrid_rig());
    pulls.add(tests::pull(found, "contact.restitution", truth.restitution));
    for (const ChannelFit& channel : found.channels) {
      judged += channel.diagnostics->judged ? 1 : 0;
      unsound += channel.diagnostics->sound ? 0 : 1;
    }
  }
  EXPECT_LT(std::abs(pulls.mean()), pulls.mean_bound());
  EXPECT_GT(pulls.mean_square(), pulls.square_bounds()[0]);
  EXPECT_LT(pulls.mean_square(), pulls.square_bounds()[1]);
  EXPECT_EQ(judged, GetParam() > 30e3 ? 48 : 0);  // by 50 quiet samples that tell something
  EXPECT_LE(unsound, 6);  // of 48 at 2.5 %: more in a thousandth of such tests
}

INSTANTIATE_TEST_SUITE_P(Cutoffs, FilteredFit, testing::Values(20e3, 50e3, 200e3, 400e3));

TEST(FilteredSamples, SayThatTheyAreThinned) {
  const Fit found = fit({filtered_shot({.duration = 2.5e-3}, 50e3)}, tests::hybrid_rig());
  for (const ChannelFit& channel : found.channels) {
    EXPECT_EQ(channel.every, 10U);
    std::vector<std::size_t> used;
    for (std::size_t k = 0; k < channel.used.size(); ++k)
      if (channel.used[k] != 0) used.push_back(k);
    for (std::size_t i = 1; i < used.size(); ++i) ASSERT_EQ(used[i] - used[i - 1], 10U);
  }
  EXPECT_THAT(found.predictions.front().skipped,
              testing::IsSupersetOf({testing::StartsWith("in the fit: of force one sample in 10"),
                                     testing::StartsWith("in the fit: of velocity one sample in "
                                                         "10")}));
}

TEST(FilteredSamples, AreRefusedWhereTheFilterReachesOverAllOfTheRecord) {
  EXPECT_THAT([] { fit({filtered_shot({.duration = 1.5e-3}, 2e3)}, tests::hybrid_rig()); },
              testing::ThrowsMessage<std::invalid_argument>(testing::AllOf(
                  testing::StartsWith("force of synthetic went through a filter that reaches "),
                  testing::EndsWith("Filter at a higher cutoff, or leave the step out"))));
}

}  // namespace
}  // namespace impactrig::fitting
