// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/uff58_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "acquisition/importers/number.hpp"
#include "acquisition/importers/uff58_layout.hpp"
#include "acquisition/importers/uff58_text.hpp"

namespace impactrig::acquisition {

using datasets::InputError;

namespace {

/// Where the closing -1 stands when the data end at `at`: directly, or after a line end. Null when
/// it is not there.
const char* closing_line(const char* at, const char* end) {
  const char* p = at;
  if (p != end && *p == '\r') ++p;
  if (p != end && *p == '\n') ++p;
  const char* next = p;
  const std::string_view line = take_line(next, end);
  return is_uff_delimiter(line.substr(0, 80)) ? p : nullptr;
}

/// The first place at or after `at` that closes a dataset; `end` when there is none.
const char* find_closing_line(const char* at, const char* end) {
  constexpr std::string_view sign = "    -1";
  const std::string_view text(at, static_cast<std::size_t>(end - at));
  for (std::size_t found = text.find(sign); found != std::string_view::npos;
       found = text.find(sign, found + 1)) {
    const char* next = at + found;
    const char* const start = next;
    if (is_uff_delimiter(take_line(next, end).substr(0, 80))) return start;
  }
  return end;
}

/// The block's length [bytes] by the -1 that follows it, directly or where the next one is.
std::uint64_t length_to_closing(const TextFile& file, const std::array<std::uint64_t, 3>& lengths,
                                Uff58Extent& extent) {
  const std::string_view bytes = file.bytes();
  const char* const end = bytes.data() + bytes.size();
  const auto available = static_cast<std::uint64_t>(end - extent.start);
  std::uint64_t length = 0;
  for (const std::uint64_t candidate : lengths) {
    if (candidate > available || extent.closing != nullptr) continue;
    extent.closing = closing_line(extent.start + candidate, end);
    length = candidate;
  }
  if (extent.closing != nullptr) return length;
  extent.closing = find_closing_line(extent.start, end);
  length = static_cast<std::uint64_t>(extent.closing - extent.start);
  if (extent.closing != end) return length;
  extent.warnings.emplace_back("the file ends without the closing -1: it may have been cut off");
  return std::min(length, std::max(lengths[2], lengths[0]));
}

void warn_of_bytes(const Uff58Form& form, std::uint64_t length, Uff58Extent& extent) {
  if (form.announced_bytes != 0 && form.announced_bytes != length)
    extent.warnings.push_back(
        fmt::format("the identifier line announces {} bytes of data, {} are there",
                    form.announced_bytes, length));
  if (!form.complex() && uff58_looks_reversed(extent, form.little_endian))
    extent.warnings.push_back(fmt::format(
        "the identifier line says that bytes are {}-endian, and the values are numbers of "
        "a measurement only the other way round: correct the byte order in columns 8 to "
        "13 of that line",
        form.little_endian ? "little" : "big"));
}

/// The block is as long as its points are, or as announced: the length that a -1 follows is it.
/// Otherwise it goes on to the next -1.
Uff58Extent find_binary(const TextFile& file, const char* start, const Uff58Form& form) {
  const std::string_view bytes = file.bytes();
  const auto available = static_cast<std::uint64_t>(bytes.data() + bytes.size() - start);
  Uff58Extent extent;
  extent.start = start;
  Uff58PointLayout layout = uff58_point_layout(form, false);
  const Uff58PointLayout wide = uff58_point_layout(form, true);
  // more points than bytes can be no true count; the products below must not overflow
  const std::uint64_t points = std::min(form.points, available + 1);
  const std::array<std::uint64_t, 3> lengths = {points * layout.size(), points * wide.size(),
                                                form.announced_bytes};
  const std::uint64_t length = length_to_closing(file, lengths, extent);
  // of data that are cut off the announced length tells
  const bool announced_wide =
      form.announced_bytes / wide.size() == form.points && form.announced_bytes % wide.size() == 0;
  if ((length == lengths[1] || announced_wide) && length != lengths[0])
    layout = wide;
  else if (length == form.announced_bytes && length != lengths[0] && form.points <= available)
    layout = settle_uff58_layout(file, start, form, length, layout, extent.warnings);
  extent.abscissa_bytes = static_cast<std::uint32_t>(layout.abscissa);
  extent.number_bytes = static_cast<std::uint32_t>(layout.number);
  extent.points = length / layout.size();
  warn_of_bytes(form, length, extent);
  if (extent.points == 0 && form.points > 0)
    throw InputError(file.byte_position(start),
                     fmt::format("{} points are announced and no data are there", form.points));
  return extent;
}

/// Reads a text's numbers through and counts its points; fills in the rest of `extent`.
std::uint64_t count_points(const TextFile& file, const Uff58Form& form, bool lines_count,
                           Uff58Extent& extent) {
  Uff58Text text(file, extent.start, form, lines_count);
  const std::uint64_t points = text.count();
  extent.closing = text.at();
  extent.warnings = text.warnings();
  return points;
}

}  // namespace

bool is_uff_delimiter(std::string_view line) {
  if (line.size() < 2 || line.size() > 200) return false;
  const std::string_view text = trimmed(line);
  return text == "-1" && text.data() - line.data() == 4;
}

Uff58Extent find_uff58_data(const TextFile& file, const char* start, const Uff58Form& form,
                            bool lines_count, bool trusting) {
  Uff58Extent extent;
  if (form.binary) {
    extent = find_binary(file, start, form);
  } else {
    const std::string_view bytes = file.bytes();
    extent.start = start;
    if (trusting)
      extent.closing = uff58_closing_line_by_count(start, bytes.data() + bytes.size(), form);
    extent.counted = extent.closing == nullptr;
    extent.points = form.points;
    if (extent.counted) extent.points = count_points(file, form, lines_count, extent);
  }
  if (extent.points != form.points)
    extent.warnings.push_back(
        fmt::format("the header announces {} points, {} are there: these are read", form.points,
                    extent.points));
  return extent;
}

}  // namespace impactrig::acquisition
