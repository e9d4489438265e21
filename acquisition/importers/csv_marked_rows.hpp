// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/recording_reader.hpp"

namespace impactrig::acquisition {

/// Samples that a head marks as not valid, by column: runs in order that do not touch.
using MarkedRows = std::map<std::size_t, std::vector<SampleRange>>;

/// Takes "invalid samples of column 2: 17-21 40", as our own export writes it, out of the head.
/// Rows count from 0. What is no such list stays.
MarkedRows take_marked_rows(TableHead& head);

/// Marks samples as not valid; the first of `valid`, which is empty or one a sample, is sample
/// `first`.
void mark_rows(const MarkedRows& marked, std::size_t column, std::uint64_t first,
               std::size_t samples, std::vector<std::uint8_t>& valid);

}  // namespace impactrig::acquisition
