// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "acquisition/conditioning/background.hpp"
#include "acquisition/conditioning/bounce.hpp"
#include "acquisition/conditioning/condition.hpp"
#include "acquisition/conditioning/trace.hpp"

namespace impactrig::acquisition {

/// A first contact as the trigger channel shows it. Indices count samples and have fractions.
struct Contact {
  double onset = 0.0;          ///< first touch [samples]
  double end = 0.0;            ///< [samples]
  std::size_t peak_index = 0;  ///< the extreme sample; of a velocity: the middle of the change
  double peak = 0.0;           ///< see find_impacts [SI]
  double width = 0.0;          ///< [samples]
  double impulse = 0.0;        ///< [SI samples]
  double baseline = 0.0;       ///< at first touch [SI]; of a velocity: its value there
  bool begins_inside = false;  ///< the record starts after first touch
  bool ends_inside = false;    ///< the record ends before the contact does
  int further_hits = 0;        ///< contacts after it within post_trigger
  double last_end = 0.0;       ///< of the last of these, else `end` [samples]; of a motion 0
  std::optional<Bounce> bounce = {};  ///< of a displacement
};

/// Whether a contact has too few samples to tell its shape.
inline bool undersampled(const Contact& contact) {
  return contact.end - contact.onset < 20.0;
}

/// A signal that goes from a baseline to a peak and back: force, acceleration.
std::vector<Contact> find_pulses(const Trace& trace, const DetectionOptions& options);

/// A signal that goes from one course to another: velocity.
std::vector<Contact> find_jumps(const Trace& trace, const DetectionOptions& options);

/// A signal that turns at a stop: displacement.
std::vector<Contact> find_bounces(const Trace& trace, const DetectionOptions& options);

/// The samples before `onset` that say what the signal does undisturbed: at least as many as
/// pre_trigger and 200, a guard of 5 % and 3 samples left out before touch, none before `floor`.
/// None when fewer than 8 are there.
struct QuietSpan {
  std::size_t begin, end;
};

std::optional<QuietSpan> quiet_before(const Trace& trace, double onset, std::size_t floor,
                                      const DetectionOptions& options);

}  // namespace impactrig::acquisition
