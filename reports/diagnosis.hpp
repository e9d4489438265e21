// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "reports/report_data.hpp"

namespace impactrig::reports {

/// "The model leaves out of the force up to 12 ± 1 N, 80 µs after touch, …": what a smooth function
/// of time besides the noise amounts to; says so where there is none. "" where none was looked for.
std::string discrepancy_sentence(const fitting::ChannelFit& channel);

/// The diagnosis of the channel whose residuals are furthest from noise; that all are noise, where
/// all are; "" where no channel was judged.
std::string diagnosis_summary(const fitting::Fit& fit);

/// Whether some channel was judged unsound.
bool any_unsound(const fitting::Fit& fit);

/// Table of each channel and phase, what residuals look like, and pictures, as escaped markup; ""
/// where there are no diagnostics.
std::string html_diagnostics(const fitting::Fit& fit);

}  // namespace impactrig::reports
