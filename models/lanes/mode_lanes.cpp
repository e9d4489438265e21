// SPDX-License-Identifier: BSD-3-Clause
#include "models/lanes/advance_modes.hpp"

#include "models/lanes/processor.hpp"
#include "models/lanes/step_maps.hpp"
#include "models/lanes/step_modes.hpp"

namespace impactrig::models {

void advance_modes(ModesUnderForce& modes) {
  on_processor<ModesUnderForce>(
      modes, [](ModesUnderForce& own) { ModeAdvance<2>(own).advance(); }, advance_modes_avx2,
      advance_modes_avx512);
}

void step_modes(const ModesOverStep& modes) {
  on_processor<const ModesOverStep>(
      modes, [](const ModesOverStep& own) { ModeStep<2>(own).respond(); }, step_modes_avx2,
      step_modes_avx512);
}

void find_sum(const WeightedSum& sum) {
  on_processor<const WeightedSum>(sum, find_sum_by<2>, find_sum_avx2, find_sum_avx512);
}

void find_values(const SeriesAtNodes& series) {
  on_processor<const SeriesAtNodes>(series, find_values_by<2>, find_values_avx2,
                                    find_values_avx512);
}

void find_at_nodes(const PointAtNodes& point) {
  on_processor<const PointAtNodes>(point, find_at_nodes_by<2>, find_at_nodes_avx2,
                                   find_at_nodes_avx512);
}

void find_at_end(const ModesAtEnd& modes) {
  on_processor<const ModesAtEnd>(modes, find_at_end_by<2>, find_at_end_avx2, find_at_end_avx512);
}

}  // namespace impactrig::models
