// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/needed_channels.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/acquisition/scene.hpp"

namespace impactrig::acquisition {

namespace {

using datasets::Quantity;
using testing::ElementsAre;
using testing::IsEmpty;

RecordingHead head_of(const std::vector<std::string>& names) {
  RecordingHead head;
  for (const std::string& name : names) {
    head.record.channels.push_back(tests::channel_of(name, Quantity::voltage, {}, {}));
    head.samples.push_back(10);
  }
  return head;
}

SensorSet sensors_on(const std::string& force, const std::string& velocity) {
  SensorSet sensors;
  sensors.force.emplace().channel = force;
  sensors.velocity.emplace().channel = velocity;
  return sensors;
}

TEST(NarrowToSensors, ReadsOnlyWhatSensorsName) {
  const RecordingHead head = head_of({"Time", "Vib", "Acc", "Force"});
  for (const auto& [force, velocity] : {std::pair{"Force", "Vib"}, std::pair{"force", "1"}}) {
    Selection wanted;
    SensorSet sensors = sensors_on(force, velocity);
    narrow_to_sensors(head, wanted, sensors);
    EXPECT_THAT(wanted.channels, ElementsAre(1, 3));
    EXPECT_EQ(sensors.force->channel, "1");
    EXPECT_EQ(sensors.velocity->channel, "0");
  }
}

TEST(NarrowToSensors, ReadsAllWhereAChoiceOrAComplaintIsDue) {
  const RecordingHead head = head_of({"Vib", "Acc", "Force"});
  for (const auto& [force, velocity] : {std::pair{"Force", ""}, std::pair{"Forze", "Vib"}}) {
    Selection wanted;
    SensorSet sensors = sensors_on(force, velocity);
    narrow_to_sensors(head, wanted, sensors);
    EXPECT_THAT(wanted.channels, IsEmpty());
    EXPECT_EQ(sensors.force->channel, force);
    EXPECT_EQ(sensors.velocity->channel, velocity);
  }
  Selection wanted;
  SensorSet none;
  narrow_to_sensors(head, wanted, none);
  EXPECT_THAT(wanted.channels, IsEmpty());
  // What the user chose is left alone.
  wanted.channels = {2};
  SensorSet sensors = sensors_on("Force", "Vib");
  narrow_to_sensors(head, wanted, sensors);
  EXPECT_THAT(wanted.channels, ElementsAre(2));
}

TEST(NarrowToSensors, IsNotMisledByChannelsThatAreNumbers) {
  const RecordingHead head = head_of({"2", "0", "1"});
  Selection wanted;
  SensorSet sensors = sensors_on("0", "1");
  narrow_to_sensors(head, wanted, sensors);
  datasets::Record left;
  if (wanted.channels.empty()) left = head.record;
  for (const std::size_t index : wanted.channels)
    left.channels.push_back(head.record.channels[index]);
  EXPECT_EQ(left.find(sensors.force->channel)->name, "0");
  EXPECT_EQ(left.find(sensors.velocity->channel)->name, "1");
}

}  // namespace

}  // namespace impactrig::acquisition
