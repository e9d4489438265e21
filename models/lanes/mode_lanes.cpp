// SPDX-License-Identifier: BSD-3-Clause
#include "models/lanes/advance_modes.hpp"

#include "models/lanes/processor.hpp"
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

}  // namespace impactrig::models
