// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fitting/metrics/history_pair.hpp"

namespace impactrig::fitting {

/// Theil's inequality U = √Σ(c − m)² / (√Σm² + √Σc²) [-], in [0, 1]: 0 equal, 1 where c is a
/// negative multiple of m or one of the two is zero. NaN where both are zero. Source: [Theil1961].
double theil_u(const HistoryPair& pair);

/// Whang's inequality Σ|c − m| / (Σ|c| + Σ|m|) [-], in [0, 1]. NaN where both are zero.
/// Source: [WhangEtAl1994].
double whang(const HistoryPair& pair);

/// Zilliacus' index Σ|c − m| / Σ|m| [-], ≥ 0. NaN where m is zero. Source: [WhangEtAl1994].
double zilliacus(const HistoryPair& pair);

/// The same with squares, the RSS factor √(Σ(c − m)² / Σm²) [-], ≥ 0; equals the RMSE divided by
/// the RMS of m. NaN where m is zero. Source: [WhangEtAl1994].
double rss_factor(const HistoryPair& pair);

/// Weighted integrated factor [-], in [0, 1]:
///
///   √( Σ max(m², c²) (1 − max(0, m c) / max(m², c²))² / Σ max(m², c²) )
///
/// Samples where both are zero are skipped. It counts relative errors, those of large samples most;
/// where the signs differ a sample counts in full. NaN where both are zero throughout.
/// Source: [TwiskRitmeijer2007].
double weighted_integrated_factor(const HistoryPair& pair);

}  // namespace impactrig::fitting
