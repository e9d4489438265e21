// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/impact.hpp"

#include <algorithm>
#include <array>

namespace impactrig::datasets {

namespace {

struct FlagText {
  ImpactFlag flag;
  std::string_view name;
  std::string_view sentence;
};

constexpr std::array<FlagText, 6> flag_texts{{
    {ImpactFlag::clipped, "clipped",
     "The signal reaches the end of its range or has flat tops, so peak and impulse are too small; "
     "record again with a larger range, or fit without the clipped samples."},
    {ImpactFlag::double_hit, "double-hit",
     "There is a second contact within the window; end the window before it, or compare with a "
     "simulation that runs through both contacts."},
    {ImpactFlag::no_hit, "no-hit",
     "Nothing rises above the noise; check the trigger channel, its unit and its polarity."},
    {ImpactFlag::too_short, "too-short",
     "The record begins after the contact does, or ends before it; lengthen the pre-trigger or the "
     "record, and do not use impulse and restitution of this impact."},
    {ImpactFlag::dropout, "dropout",
     "Some samples within the window are invalid and are left out; check the vibrometer's focus "
     "and reflective tape, or the recorder's overruns."},
    {ImpactFlag::undersampled, "undersampled",
     "The contact has fewer than 20 samples, so its peak and duration are uncertain; record at a "
     "higher sample rate."},
}};

const FlagText& text_of(ImpactFlag flag) {
  return *std::ranges::find(flag_texts, flag, &FlagText::flag);
}

}  // namespace

std::string_view name(ImpactFlag flag) {
  return text_of(flag).name;
}

std::string_view sentence(ImpactFlag flag) {
  return text_of(flag).sentence;
}

bool Impact::has(ImpactFlag flag) const {
  return std::ranges::find(flags, flag) != flags.end();
}

}  // namespace impactrig::datasets
