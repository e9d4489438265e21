// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "acquisition/conditioning/condition.hpp"
#include "acquisition/conditioning/contact_search.hpp"
#include "acquisition/conditioning/samples.hpp"
#include "acquisition/conditioning/trace.hpp"

namespace impactrig::acquisition {

/// A pulse of some samples that may be an electric spike.
struct Spike {
  IndexRange range;
  /// How many times as long a contact of the same record has to last for it to be one: ten for one
  /// to three samples and for up to 16 that begin and end at once, as no contact ends; twenty for
  /// up to 64 of any shape between rests as long.
  double times = 0.0;

  double least_contact() const { return times * static_cast<double>(range.size()); }  // [samples]
};

/// The first that was taken for one of the contacts.
std::optional<Spike> spike_among(const Trace& trace, const std::vector<Contact>& contacts);

/// The first behind a contact, within what belongs to it, that is short against it, and higher than
/// noise or a digitiser's steps `quantum` make it: 12 standard deviations, nine steps.
std::optional<Spike> spike_after(const Trace& trace, double quantum,
                                 const std::vector<Contact>& contacts,
                                 const DetectionOptions& options);

}  // namespace impactrig::acquisition
