// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "reports/report_data.hpp"

namespace impactrig::reports {

/// What a fit amounts to, in words (plain text).
///
/// explained: the residual of every channel is at most 1.5 times the noise seen before the trigger;
/// the headline says so where diagnostics find a part of it that is no noise.
/// in_shape: so, but with calibrations that it contradicts; or not so, but every channel's
/// Sprague-Geers comprehensive error is at most 0.1.
/// not_explained: neither. open: the fit did not converge, nothing was compared, or no impact was
/// found. The limits are conventions of this report, not of a standard.
struct Verdict {
  enum class Grade { explained, in_shape, not_explained, open };

  Grade grade = Grade::open;
  std::string headline;  ///< "Explained to within the noise"
  std::string sentence;  ///< the numbers behind it, and reservations
};

Verdict verdict(const fitting::Fit& fit);

}  // namespace impactrig::reports
