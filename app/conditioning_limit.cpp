// SPDX-License-Identifier: BSD-3-Clause
#include "app/conditioning_limit.hpp"

#include <fmt/format.h>

#include "datasets/input_error.hpp"

namespace impactrig::app {

std::uint64_t samples_of(const acquisition::RecordingHead& head,
                         const acquisition::Selection& wanted) {
  std::uint64_t samples = 0;
  for (const std::size_t index : acquisition::selected_channels(head, wanted)) {
    const auto range =
        acquisition::samples_within(head.record.channels[index].clock, head.samples[index], wanted);
    samples += range.last - range.first;
  }
  return samples;
}

void refuse_too_many_to_condition(const std::string& path, std::uint64_t samples,
                                  std::string_view remedy) {
  constexpr std::uint64_t most = 64'000'000;
  if (samples <= most) return;
  throw datasets::InputError(
      {.file = path}, fmt::format("{} million samples are too many to be conditioned or averaged, "
                                  "which takes them into memory; {} million are the most: {}",
                                  samples / 1'000'000, most / 1'000'000, remedy));
}

}  // namespace impactrig::app
