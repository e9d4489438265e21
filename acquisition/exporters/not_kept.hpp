// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/exporters/outgoing.hpp"
#include "acquisition/recording_reader.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// Samples that are marked as not valid and are finite: others are marked again by whoever reads
/// them.
struct MarkedSamples {
  std::uint64_t count = 0;
  std::vector<SampleRange> runs;  ///< the first of them
  bool more = false;              ///< there are more runs
};

/// `most` runs of them are kept.
MarkedSamples marked_samples(const OutgoingChannel& channel, std::size_t most);

/// "17-21 40": the first and last sample of each run, from 0.
std::string listed(const std::vector<SampleRange>& runs, std::string_view separator);

/// Tells that calibrations and delays have no place in `format` ("a CSV file"), where there are
/// some.
/// And of filters that channels have been through, which a fit would have to know of.
void tell_of_filters(const datasets::Record& record, std::string_view format,
                     std::vector<std::string>& warnings);

void tell_of_calibrations(const datasets::Record& record, std::string_view format,
                          std::vector<std::string>& warnings);

/// The same of a channel's marks.
void tell_of_marks(const OutgoingChannel& channel, std::string_view format,
                   std::vector<std::string>& warnings);

}  // namespace impactrig::acquisition
