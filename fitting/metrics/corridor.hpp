// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fitting/metrics/history_pair.hpp"

namespace impactrig::fitting {

/// Share of the samples within a corridor round m [-], in [0, 1], as ISO/TS 18571 and CORA count
/// it: with δ_i = 0.05 max|m| and δ_o = 0.5 max|m| a sample scores 1 where |c − m| < δ_i, 0 where
/// |c − m| > δ_o and ((δ_o − |c − m|) / (δ_o − δ_i))² between. Where m is zero throughout a sample
/// scores 1 where c is zero too. A quiet tail raises it: state the window with it.
/// Source: [ISO18571].
double corridor_score(const HistoryPair& pair);

}  // namespace impactrig::fitting
