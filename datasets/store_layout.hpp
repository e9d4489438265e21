// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace impactrig::datasets::layout {

// What writer and reader of our HDF5 file must agree on; the whole layout is in docs/formats.md.

constexpr std::string_view format = "impactrig-recording";
constexpr std::string_view format_version = "1.0";
constexpr int format_major = 1;  ///< a reader takes every minor version of it

constexpr std::size_t chunk = 65536;            ///< samples of a compressed piece
constexpr std::size_t smallest_chunked = 1024;  ///< shorter data sets are stored plain
constexpr std::size_t text_piece = 65536;  ///< bytes of text that are compressed and moved at once
constexpr std::size_t longest_attribute =
    1000;  ///< bytes; HDF5 allows 64 kB. Longer text is cut, so attributes
           ///< only repeat what a data set holds
constexpr std::size_t quicklook_points = 20000;

/// The best deflate can do is 1032:1, so no sound data set is larger than this times its file.
constexpr std::size_t largest_expansion = 1100;

/// A NUL ends an HDF5 text, so it is written as the two bytes C0 80, which no UTF-8 text
/// holds.
std::string with_nul_escaped(std::string_view text);
std::string with_nul_restored(std::string_view text);

/// Where an HDF5 file ends by its superblock of version 0, 2 or 3 with offsets of 8 bytes; 0 where
/// its first 48 bytes do not say. HDF5 file format specification 3.0, section II.A.
std::uint64_t declared_end(std::string_view head);

}  // namespace impactrig::datasets::layout
