// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace impactrig::fitting {

/// Where the data of a bootstrap's draws come from, besides the best fit's prediction.
///
///   parametric  noise of the channel's own model, coloured as it is, times the fit's inflation
///   residual    the fit's own residuals, with signs drawn by blocks of samples that belong
///   together
///               (wild bootstrap): what exceeds the noise stays where it was seen
///
/// In both the calibrations behind the priors are drawn anew. Source: [EfronTibshirani1993],
/// [Shao2010].
enum class BootstrapKind { parametric, residual };

std::string_view name(BootstrapKind kind);
BootstrapKind bootstrap_named(std::string_view name);  ///< throws std::invalid_argument

}  // namespace impactrig::fitting
