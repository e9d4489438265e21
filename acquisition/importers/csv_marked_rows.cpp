// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/csv_marked_rows.hpp"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <limits>
#include <optional>
#include <string_view>

#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/text_table.hpp"

namespace impactrig::acquisition {

namespace {

/// "17-21 40", in order; none where it is anything else.
std::optional<std::vector<SampleRange>> runs_in(std::string_view text) {
  std::vector<SampleRange> runs;
  for (const std::string_view cell : cells_of(text, ' ')) {
    SampleRange run;
    const char* const end = cell.data() + cell.size();
    auto [at, error] = std::from_chars(cell.data(), end, run.first);
    if (error != std::errc{}) return std::nullopt;
    run.last = run.first;
    if (at != end && *at == '-') {
      const auto second = std::from_chars(at + 1, end, run.last);
      if (second.ec != std::errc{}) return std::nullopt;
      at = second.ptr;
    }
    const std::uint64_t behind = runs.empty() ? 0 : runs.back().last;
    if (at != end || run.first < behind || run.last < run.first ||
        run.last == std::numeric_limits<std::uint64_t>::max())
      return std::nullopt;
    ++run.last;
    runs.push_back(run);
  }
  return runs;
}

}  // namespace

MarkedRows take_marked_rows(TableHead& head) {
  constexpr std::string_view key = "invalid samples of column ";
  MarkedRows marked;
  for (auto entry = head.attributes.lower_bound(std::string(key));
       entry != head.attributes.end() && entry->first.starts_with(key);) {
    const auto column = integer_in(std::string_view(entry->first).substr(key.size()));
    auto runs = runs_in(entry->second);
    if (!column || *column < 0 || !runs) {
      ++entry;
      continue;
    }
    marked[static_cast<std::size_t>(*column)] = std::move(*runs);
    entry = head.attributes.erase(entry);
  }
  return marked;
}

void mark_rows(const MarkedRows& marked, std::size_t column, std::uint64_t first,
               std::size_t samples, std::vector<std::uint8_t>& valid) {
  const auto found = marked.find(column);
  if (found == marked.end()) return;
  const std::uint64_t end = first + samples;
  const auto& runs = found->second;
  auto run = std::ranges::upper_bound(runs, first, {}, &SampleRange::last);
  for (; run != runs.end() && run->first < end; ++run) {
    if (valid.empty()) valid.assign(samples, 1);
    const auto from = static_cast<std::ptrdiff_t>(std::max(run->first, first) - first);
    const auto to = static_cast<std::ptrdiff_t>(std::min(run->last, end) - first);
    std::fill(valid.begin() + from, valid.begin() + to, std::uint8_t{0});
  }
}

}  // namespace impactrig::acquisition
