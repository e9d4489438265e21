// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/hdf5_scales.hpp"

#include <algorithm>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/text_file.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

namespace {

/// "t", "time", "time2", "t_us", "zeit".
bool named_like_a_time(std::string_view path) {
  const std::string word = lowered(path.substr(path.find_last_of("./") + 1));
  return word == "t" || word == "tvec" || word.starts_with("t_") || word.starts_with("time") ||
         word.starts_with("zeit");
}

bool is_scale(const Hdf5Attributes& attributes) {
  const auto kind = attributes.texts.find("CLASS");
  return kind != attributes.texts.end() && kind->second == "DIMENSION_SCALE";
}

}  // namespace

DimensionScales::DimensionScales(const std::vector<Hdf5Array>& arrays) {
  for (const Hdf5Array& array : arrays)
    if (array.reference != 0 && !array.is_field()) by_reference_.emplace(array.reference, &array);
}

void DimensionScales::state_unit(const Hdf5Array& scale, const std::string& unit) {
  stated_units_[&scale] = unit;
}

DimensionScale DimensionScales::along(const Hdf5Array& array, std::size_t dimension) const {
  DimensionScale best;
  if (dimension >= array.scales.size()) return best;
  for (const std::uint64_t reference : array.scales[dimension]) {
    const auto found = by_reference_.find(reference);
    if (found == by_reference_.end() || found->second == &array) continue;
    const Hdf5Array& scale = *found->second;
    // what was deleted may have left its place to another
    if (!is_scale(scale.attributes)) continue;
    if (scale.shape.size() != 1 || scale.shape[0] != array.shape[dimension] || scale.complex)
      continue;
    const ScaleKind kind = kind_of(scale);
    if (kind > best.kind) best = {kind, &scale};
  }
  return best;
}

std::size_t DimensionScales::time_dimension(const Hdf5Array& array) const {
  if (array.rows_first) return 0;
  const auto longest = std::ranges::max_element(array.shape);
  const auto found = static_cast<std::size_t>(longest - array.shape.begin());
  if (along(array, found).kind == ScaleKind::time) return found;
  for (std::size_t d = 0; d < array.shape.size(); ++d)
    if (array.shape[d] > 1 && along(array, d).kind == ScaleKind::time) return d;
  return found;
}

bool DimensionScales::time_dimension_is_sure(const Hdf5Array& array) const {
  const std::size_t time = time_dimension(array);
  return along(array, time).kind == ScaleKind::time ||
         std::ranges::count(array.shape, array.shape[time]) == 1;
}

DimensionScale DimensionScales::of_samples(const Hdf5Slice& slice) const {
  const std::size_t rank = slice.array->shape.size();
  if (rank == 0 || (rank > 2 && slice.whole)) return {};
  return along(*slice.array, rank == 1     ? 0
                             : slice.whole ? time_dimension(*slice.array)
                                           : slice.along);
}

ScaleKind DimensionScales::kind_of(const Hdf5Array& scale) const {
  if (!packing_of(scale, 0, 1).problem.empty()) return ScaleKind::unknown;
  const auto stated = stated_units_.find(&scale);
  const std::string unit =
      stated != stated_units_.end() ? stated->second : unit_of(scale, to_utf8(scale.path), 0, 1);
  if (datasets::conversion(unit, "s")) return ScaleKind::time;
  if (unit.empty()) return named_like_a_time(scale.path) ? ScaleKind::time : ScaleKind::unknown;
  const datasets::Quantity quantity = datasets::quantity_of_unit(unit);
  const bool understood =
      quantity != datasets::Quantity::unknown && quantity != datasets::Quantity::other;
  return understood ? ScaleKind::other : ScaleKind::unknown;
}

}  // namespace impactrig::acquisition
