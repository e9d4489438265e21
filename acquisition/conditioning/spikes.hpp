// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "acquisition/conditioning/contact_search.hpp"
#include "acquisition/conditioning/samples.hpp"
#include "acquisition/conditioning/trace.hpp"

namespace impactrig::acquisition {

/// A pulse of some samples that is an electric spike where a contact of the same record lasts many
/// times as long.
struct Spike {
  IndexRange range;
  /// How many times as long: ten for one to three samples and for up to 16 that begin and end at
  /// once, as no contact ends; twenty for up to 64 of any shape between rests as long.
  double times = 0.0;
  double height = 0.0;  ///< [SI], > 0

  /// Whether one of these contacts, which it is no part of, lasts so long and is not far lower.
  bool is_short_beside(const std::vector<Contact>& contacts) const;
};

/// Those that were taken for contacts.
std::vector<Spike> spikes_among(const Trace& trace, const std::vector<Contact>& contacts);

/// Those behind a contact, within what belongs to it, that are short beside it: at least 5 % of its
/// peak, and higher than noise or a digitiser's steps `quantum` make them (12 standard deviations,
/// nine steps).
std::vector<Spike> spikes_after(const Trace& trace, double quantum,
                                const std::vector<Contact>& contacts,
                                const DetectionOptions& options);

/// A spike and those behind it that are as short, within what would belong to a contact there.
std::vector<Spike> spikes_like(const Spike& spike, const Trace& trace, double quantum,
                               const DetectionOptions& options);

}  // namespace impactrig::acquisition
