// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "datasets/quicklook.hpp"
#include "datasets/record.hpp"

namespace impactrig::datasets {

// Parts of our HDF5 file (docs/formats.md) that are the same whether its samples are written at
// once or as they come. All throw WriteFailure.

/// Names of [a-z][a-z0-9_]*, one a channel, as close to the channels' own as that allows.
std::vector<std::string> group_names(std::span<const std::string> channels);

void add_file_head(hid_t file);

/// Title, start, provenance, warnings and attributes.
void describe_record(hid_t entry, const Record& record);

void describe_channel(hid_t group, std::size_t index, const Channel& channel);
void describe_samples(hid_t samples, const Channel& channel);
void describe_times(hid_t times);
void describe_imaginary(hid_t imaginary, const Channel& channel);
void describe_valid(hid_t valid);

/// Calibration and delay; nothing where the channel has neither.
void add_calibration(hid_t parent, const std::string& name, const Channel& channel);

/// What a viewer plots of one channel.
void add_quicklook(hid_t parent, const std::string& name, const std::string& title,
                   std::uint64_t samples, const Quicklook& look);

/// A channel in `quicklook`.
struct ShownChannel {
  std::string group;
  Quantity quantity = Quantity::unknown;
  std::uint64_t samples = 0;
};

/// Tells viewers what to open with: the first force, else the first channel with samples.
void show_first(hid_t entry, hid_t quicklook, std::span<const ShownChannel> channels);

}  // namespace impactrig::datasets
