// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fitting/fit_problem.hpp"

namespace impactrig::fitting {

/// Whether first touch of a recording may lie anywhere between samples that are few in a contact.
bool leaves_touch_open(const FitProblem& problem);

/// Searches from the initial values, with touch held where about its place that promises most, and
/// the sensors at what is stated of them. Of a contact of few samples a touch that is off, a delay
/// and a gain with it, is a false minimum: one for each period of a sensor that rings. The samples
/// and the way of predicting are those chosen. Returns the iterations. Throws std::runtime_error
/// where it cannot start.
int scan_touch(FitProblem& problem);

}  // namespace impactrig::fitting
