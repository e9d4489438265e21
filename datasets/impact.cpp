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

constexpr std::array<FlagText, 16> flag_texts{{
    {ImpactFlag::clipped, "clipped",
     "The signal reaches the end of its range or has flat tops, so peak and impulse are too small; "
     "record again with a larger range. A fit leaves the clipped samples out."},
    {ImpactFlag::double_hit, "double-hit",
     "There is a second contact within the window; end the window before it, or compare with a "
     "simulation that runs through both contacts."},
    {ImpactFlag::multiple_hits, "multiple-hits",
     "There are three or more contacts within the window; check for rattling of the stop or a "
     "loose "
     "sensor, and end the window before the second contact."},
    {ImpactFlag::no_hit, "no-hit",
     "Nothing rises above the noise; check the trigger channel, its unit and its polarity."},
    {ImpactFlag::too_short, "too-short",
     "The record does not hold the whole contact; do not use impulse, duration and restitution of "
     "this impact."},
    {ImpactFlag::missed_start, "missed-start",
     "The record begins after first touch; lengthen the pre-trigger, or trigger at a lower level."},
    {ImpactFlag::truncated_tail, "truncated-tail",
     "The record ends before the contact does; record for longer after the trigger."},
    {ImpactFlag::dropout, "dropout",
     "Some samples within the window are invalid or an electric spike, and are left out, or a "
     "motion stays on one value throughout; check the vibrometer's focus and reflective tape, a "
     "force's cable, or the recorder's overruns."},
    {ImpactFlag::unmarked_dropout, "unmarked-dropout",
     "The laser's signal leaves its course for a moment and comes back, as it does when the light "
     "is lost, and nothing marks these samples; add the conditioning step dropouts, which leaves "
     "them out, and check the vibrometer's focus and reflective tape."},
    {ImpactFlag::undersampled, "undersampled",
     "The contact has fewer than 20 samples, so its peak and duration are uncertain; record at a "
     "higher sample rate."},
    {ImpactFlag::noisy, "noisy",
     "The noise before the trigger is more than 2 % of the signal, and single samples (peak, first "
     "touch) are as uncertain; use a finer range, shield the cable, or low-pass the record."},
    {ImpactFlag::unsteady, "unsteady",
     "The force or acceleration wanders before touch by more than 2 % of its peak (drift, hum, "
     "ringing of the impact before); wait longer before the shot, or take it off with the "
     "conditioning steps drift, decay or hum."},
    {ImpactFlag::baseline_shift, "baseline-shift",
     "The force does not come back to its level before the impact by more than 1 % of its peak: an "
     "amplifier that was overloaded, a lower limit too high for the pulse, a ground loop, or a bar "
     "that goes on pressing; lower the gain or the lower limit, and do not integrate beyond the "
     "contact."},
    {ImpactFlag::inverted, "inverted",
     "The force is negative in the contact, or the bar moves away from the stop before it; state "
     "polarity = -1 for that sensor."},
    {ImpactFlag::swapped, "swapped",
     "The velocity is a pulse between two rests and the force does not come back to its level, as "
     "if the two channels were swapped; state which is which in sensors.force.channel and "
     "sensors.velocity.channel, or by their roles in a map."},
    {ImpactFlag::implausible, "implausible",
     "Impulse and approach speed do not fit the rig by a factor that no restitution explains; "
     "check "
     "units, sensitivities, gains and ranges of both channels."},
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

std::optional<ImpactFlag> flag_named(std::string_view name) {
  const auto* const found = std::ranges::find(flag_texts, name, &FlagText::name);
  return found == flag_texts.end() ? std::nullopt : std::optional(found->flag);
}

bool Impact::has(ImpactFlag flag) const {
  return std::ranges::find(flags, flag) != flags.end();
}

}  // namespace impactrig::datasets
