// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <string>
#include <variant>

#include "tests/fitting/rig_text.hpp"

namespace impactrig::tests {
namespace {

using namespace fitting;

template <typename Action>
Action only_action(const std::string& lines) {
  const RigFile file =
      parse_rig_file(paper_rig + ("\n[[conditioning]]\nchannel = \"force\"\n" + lines), "rig.toml");
  EXPECT_EQ(file.conditioning.size(), 1U);
  EXPECT_EQ(file.conditioning.at(0).channel, "force");
  return std::get<Action>(file.conditioning.at(0).action);
}

TEST(RigFile, ReadsEveryConditioningStep) {
  using namespace datasets;
  EXPECT_FALSE(only_action<RemoveBaseline>("step = 'baseline'").quiet);
  const auto drift =
      only_action<RemoveDrift>("step = 'drift'\nquiet = { from = '-1 ms', to = '0 s' }");
  ASSERT_TRUE(drift.quiet);
  EXPECT_DOUBLE_EQ(drift.quiet->begin, -1e-3);
  EXPECT_DOUBLE_EQ(drift.quiet->end, 0.0);
  const auto decay = only_action<RemoveDecay>(
      "step = 'decay'\ntime_constant = '0.5 s'\n"
      "quiet = [{ from = '-1 ms', to = '0 s' }, { from = '5 ms', to = '9 ms' }]");
  EXPECT_DOUBLE_EQ(*decay.time_constant, 0.5);
  ASSERT_EQ(decay.quiet.size(), 2U);
  EXPECT_DOUBLE_EQ(decay.quiet[1].end, 9e-3);
  EXPECT_DOUBLE_EQ(only_action<UndoLowCut>("step = 'undo-low-cut'\nfrequency = '0.3 Hz'").frequency,
                   0.3);
  const auto low_pass = only_action<LowPass>("step = 'low-pass'\ncutoff = '100 kHz'\norder = 3");
  EXPECT_DOUBLE_EQ(low_pass.cutoff, 1e5);
  EXPECT_EQ(low_pass.order, 3);
  const auto hum = only_action<RemoveHum>("step = 'hum'\nharmonics = 7");
  EXPECT_DOUBLE_EQ(*hum.frequency, 50.0);  // the mains of [environment]
  EXPECT_EQ(hum.harmonics, 7);
  EXPECT_DOUBLE_EQ(only_action<RepairDropouts>("step = 'dropouts'").longest, 300e-6);
  const auto to = only_action<AlignTo>("step = 'align'\nto = 'velocity'\nrange = '20 us'");
  EXPECT_EQ(to.reference, "velocity");
  EXPECT_DOUBLE_EQ(to.range, 20e-6);
  EXPECT_DOUBLE_EQ(only_action<Resample>("step = 'resample'\nrate = '1 MHz'").rate, 1e6);
  const auto integral =
      only_action<Integrate>("step = 'integrate'\nname = 'impulse'\nzero_at = '1 ms'");
  EXPECT_EQ(integral.name, "impulse");
  EXPECT_DOUBLE_EQ(*integral.zero_at, 1e-3);
  EXPECT_EQ(only_action<Differentiate>("step = 'differentiate'\nname = 'a'").name, "a");
}

TEST(RigFile, HumIsOfTheMainsUnlessStated) {
  std::string text =
      paper_rig + std::string("\n[[conditioning]]\nchannel = 'force'\nstep = 'hum'\n");
  const RigFile american =
      parse_rig_file(text, "rig.toml", {{"environment.mains_frequency", "60 Hz"}});
  EXPECT_DOUBLE_EQ(*std::get<datasets::RemoveHum>(american.conditioning.at(0).action).frequency,
                   60.0);
  const RigFile stated = parse_rig_file(text + "frequency = '16.7 Hz'\n", "rig.toml");
  EXPECT_DOUBLE_EQ(*std::get<datasets::RemoveHum>(stated.conditioning.at(0).action).frequency,
                   16.7);
}

TEST(RigFile, AConditioningStepThatMakesNoSenseIsRefused) {
  const auto refused = [](const std::string& lines) {
    const std::string message =
        message_of(paper_rig + ("\n[[conditioning]]\nchannel = \"force\"\n" + lines));
    return message.substr(message.find(": ") + 2);
  };
  EXPECT_EQ(refused("step = 'low-pas'\ncutoff = '1 Hz'"),
            "conditioning.1.step: expected one of baseline, "
            "drift, decay, undo-low-cut, low-pass, hum, dropouts, align, resample, integrate, "
            "differentiate, found \"low-pas\"");
  EXPECT_EQ(refused("step = 'low-pass'"),
            "conditioning.1.cutoff: is missing; add cutoff = \"100 kHz\"");
  EXPECT_EQ(refused("step = 'low-pass'\ncutoff = '-1 Hz'"),
            "conditioning.1.cutoff: must be greater than zero");
  EXPECT_EQ(refused("step = 'low-pass'\ncutoff = '1 Hz'\norder = 9"),
            "conditioning.1.order: must be 1 to 8, found 9");
  EXPECT_EQ(refused("step = 'drift'\nquiet = { from = '1 ms', to = '0 s' }"),
            "conditioning.1.quiet.to: must be later than from");
  EXPECT_EQ(refused("step = 'drift'\nquiet = [{ from = '0 s', to = '1 s' }, { from = '2 s', to = "
                    "'3 s' }]"),
            "conditioning.1.quiet: names 2 stretches; this step takes one");
  EXPECT_EQ(refused("step = 'drift'\ncutoff = '1 Hz'"),
            "conditioning.1.cutoff: there is no such key here; known are channel, quiet, step");
  EXPECT_EQ(refused(""), "conditioning.1.step: is missing; add step = \"low-pass\"");
}

}  // namespace
}  // namespace impactrig::tests
