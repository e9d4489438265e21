// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "acquisition/importers/child_process.hpp"
#include "acquisition/importers/hdf5_arrays.hpp"

namespace impactrig::acquisition {

// What the child process that runs HDF5 does, and writes to its pipe. hdf5_arrays.cpp reads it.

constexpr std::size_t hdf5_block_size = 65536;  ///< samples handed over at once
constexpr std::size_t hdf5_longest_list =
    1000;  ///< texts or numbers of one attribute; fields of records
constexpr std::size_t hdf5_most_scales = 16;           ///< of one dimension
constexpr std::uint64_t hdf5_most_references = 10000;  ///< of one data set
constexpr std::uint64_t hdf5_end_of_blocks = ~std::uint64_t{0};

/// Writes "" or why the file cannot be read, then its groups and data sets of numbers as they come,
/// and "end". `bytes`: size of the file.
void send_hdf5_listing(const std::string& path, std::uint64_t bytes, const PipeWriter& out);

/// Writes blocks of the slices by turns, each with the index of its slice and its number of
/// samples. Behind the last stands hdf5_end_of_blocks, and the index of a slice that cannot be
/// read, or hdf5_end_of_blocks.
void send_hdf5_slices(const std::string& path, const std::vector<Hdf5Slice>& slices,
                      const PipeWriter& out);

}  // namespace impactrig::acquisition
