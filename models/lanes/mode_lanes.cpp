// SPDX-License-Identifier: BSD-3-Clause
#include "models/lanes/advance_modes.hpp"

#include "models/lanes/processor.hpp"
#include "models/lanes/step_modes.hpp"

namespace impactrig::models {

void advance_modes(ModesUnderForce& modes) {
  switch (processor()) {
    case Processor::avx512:
      return advance_modes_avx512(modes);
    case Processor::avx2:
      return advance_modes_avx2(modes);
    case Processor::any:
      return ModeAdvance<2>(modes).advance();
  }
}

void step_modes(const ModesOverStep& modes) {
  switch (processor()) {
    case Processor::avx512:
      return step_modes_avx512(modes);
    case Processor::avx2:
      return step_modes_avx2(modes);
    case Processor::any:
      return ModeStep<2>(modes).respond();
  }
}

}  // namespace impactrig::models
