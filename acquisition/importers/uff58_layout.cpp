// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/uff58_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "acquisition/importers/uff58_bytes.hpp"

namespace impactrig::acquisition {

using datasets::InputError;

namespace {

/// Whether this is no number that was ever measured.
bool is_strange(const char* at, std::size_t bytes, bool little) {
  const double value = bytes == 8 ? read_uff58_number<double>(at, little)
                                  : static_cast<double>(read_uff58_number<float>(at, little));
  const double size = std::abs(value);
  return value != 0.0 && !(size > 1e-30 && size < 1e30);
}

constexpr std::uint64_t points_looked_at = 512;

/// Whether the first values of points of this layout are all numbers that may be measured.
bool looks_measured(const char* start, const Uff58PointLayout& layout, const Uff58Form& form) {
  for (std::uint64_t i = 0; i < std::min(form.points, points_looked_at); ++i)
    for (std::size_t k = 0; k < layout.numbers; ++k)
      if (is_strange(start + i * layout.size() + layout.abscissa + k * layout.number, layout.number,
                     form.little_endian))
        return false;
  return true;
}

/// The layouts of all ordinate types in which the announced points take so many bytes.
std::vector<Uff58PointLayout> layouts_of(const Uff58Form& form, std::uint64_t length) {
  std::vector<Uff58PointLayout> fitting;
  for (const std::size_t number : {4U, 8U})
    for (const std::size_t numbers : {1U, 2U})
      for (const bool wide : {false, true}) {
        if (wide && (form.even || number == 4)) continue;
        const Uff58PointLayout layout{form.even ? 0 : wide ? number : 4, number, numbers};
        if (layout.size() * form.points == length) fitting.push_back(layout);
      }
  return fitting;
}

}  // namespace

Uff58PointLayout uff58_point_layout(const Uff58Form& form, bool wide_abscissa) {
  Uff58PointLayout layout;
  layout.number = form.double_precision() ? 8 : 4;
  layout.numbers = form.complex() ? 2 : 1;
  layout.abscissa = form.even ? 0 : (wide_abscissa ? layout.number : 4);
  return layout;
}

Uff58PointLayout settle_uff58_layout(const TextFile& file, const char* start, const Uff58Form& form,
                                     std::uint64_t length, const Uff58PointLayout& layout,
                                     std::vector<std::string>& warnings) {
  const std::vector<Uff58PointLayout> fitting = layouts_of(form, length);
  if (fitting.empty()) return layout;
  const std::string contradiction = fmt::format(
      "ordinate type {} takes {} bytes a point, and the header's points and bytes give {}",
      form.ordinate_type, layout.size(), fitting.front().size());
  const bool settled = fitting.size() == 1 && fitting.front().numbers == layout.numbers &&
                       looks_measured(start, fitting.front(), form);
  if (!settled)
    throw InputError(file.byte_position(start),
                     contradiction +
                         ": which is wrong cannot be told; correct the ordinate type in columns 1 "
                         "to 10 of record 7 or the number of points behind it");
  warnings.push_back(fmt::format("{}, as many as are there: the numbers are read in {} precision",
                                 contradiction, fitting.front().number == 8 ? "double" : "single"));
  return fitting.front();
}

bool uff58_looks_reversed(const Uff58Extent& extent, bool little_endian) {
  const std::size_t bytes = extent.number_bytes;
  const std::size_t point = extent.abscissa_bytes + bytes;
  std::uint64_t strange = 0, values = 0;
  for (std::uint64_t i = 0; i < std::min(extent.points, points_looked_at); ++i) {
    const char* const at = extent.start + i * point + extent.abscissa_bytes;
    if (is_strange(at, bytes, !little_endian)) return false;
    strange += is_strange(at, bytes, little_endian) ? 1 : 0;
    values += read_uff58_number<std::uint32_t>(at, true) != 0 ||
                      read_uff58_number<std::uint32_t>(at + bytes - 4, true) != 0
                  ? 1
                  : 0;
  }
  return values > 0 && 2 * strange > values;
}

}  // namespace impactrig::acquisition
