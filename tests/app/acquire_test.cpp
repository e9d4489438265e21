// SPDX-License-Identifier: BSD-3-Clause
//
// What `acquire` says where a simulation ends before the recording.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/app/command_line.hpp"

namespace {

using impactrig::tests::Outcome;
using impactrig::tests::rig;
using testing::AllOf;
using testing::HasSubstr;

class Acquire : public impactrig::tests::CommandLine {};

TEST_F(Acquire, SaysWhyASimulationEndedBeforeTheRecording) {
  const Outcome turned = run("acquire --source synthetic --rig " + rig + " -o " + path("shot.h5") +
                             " --duration 0.9 --set environment.gravity='\"2000 m/s^2\"'"
                             " --set environment.gravity_direction='\"180 deg\"'");
  EXPECT_EQ(turned.code, 3);
  EXPECT_THAT(turned.err, AllOf(HasSubstr("shen2007.toml: the simulation ended 0.1236 s after"),
                                HasSubstr("turned half round"), HasSubstr("shorter --duration")));
  EXPECT_FALSE(std::filesystem::exists(path("shot.h5")));
}

}  // namespace
