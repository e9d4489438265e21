// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/needed_channels.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Sensor;

namespace {

/// A sensor and the channel it names, by its place in the recording.
struct Need {
  Sensor* sensor;
  std::size_t channel;
};

/// Empty when not every sensor names a channel that is there.
std::vector<Need> needs_of(const datasets::Record& record, SensorSet& sensors) {
  std::vector<Need> needs;
  for (auto* const sensor : {&sensors.force, &sensors.velocity, &sensors.displacement}) {
    if (!*sensor) continue;
    const Channel* const channel =
        (*sensor)->channel.empty() ? nullptr : record.find((*sensor)->channel);
    if (channel == nullptr) return {};
    needs.push_back({&**sensor, static_cast<std::size_t>(channel - record.channels.data())});
  }
  return needs;
}

}  // namespace

void narrow_to_sensors(const RecordingHead& head, Selection& wanted, SensorSet& sensors) {
  if (!wanted.channels.empty()) return;
  SensorSet named = sensors;
  const std::vector<Need> needs = needs_of(head.record, named);
  if (needs.empty()) return;
  std::vector<std::size_t> chosen;
  for (const Need& need : needs) chosen.push_back(need.channel);
  std::ranges::sort(chosen);
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());

  datasets::Record alone;
  for (const std::size_t index : chosen) alone.channels.push_back(head.record.channels[index]);
  for (const Need& need : needs) {
    const auto place = std::ranges::find(chosen, need.channel) - chosen.begin();
    need.sensor->channel = std::to_string(place);
    // Where a channel is called "0", the name is heard first.
    if (alone.find(need.sensor->channel) != &alone.channels[static_cast<std::size_t>(place)])
      return;
  }
  sensors = std::move(named);
  wanted.channels = std::move(chosen);
}

}  // namespace impactrig::acquisition
