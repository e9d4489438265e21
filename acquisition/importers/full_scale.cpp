// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/full_scale.hpp"

#include <fmt/format.h>

#include <utility>

namespace impactrig::acquisition {

namespace {

constexpr std::string_view no_units = " holds no physical units: samples are parts of full scale";

}  // namespace

bool tells_of_full_scale(std::string_view warning) {
  return warning.find(no_units) != warning.npos;
}

void add_full_scale_channels(RecordingHead& head, std::string_view of, std::size_t channels,
                             std::uint64_t samples, double interval, double scale) {
  for (std::size_t c = 0; c < channels; ++c) {
    datasets::Channel channel;
    channel.name = fmt::format("ch{}", c + 1);
    channel.unit = "FS (full scale = 1.0)";
    channel.quantity = datasets::Quantity::unknown;
    channel.scale = scale;
    channel.clock.interval = interval;
    head.record.channels.push_back(std::move(channel));
    head.samples.push_back(samples);
  }
  if (channels == 0)
    head.record.warnings.emplace_back("the file has no channels");
  else
    head.record.warnings.push_back(fmt::format(
        "{}{}; a map says what full scale is (import --map, full_scale = \"10 V\")", of, no_units));
}

}  // namespace impactrig::acquisition
