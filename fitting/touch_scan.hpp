// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fitting/fit_problem.hpp"

namespace impactrig::fitting {

/// Whether first touch of a recording may lie anywhere between samples that are few in a contact.
bool leaves_touch_open(const FitProblem& problem);

/// Sets the values to those of the best of many searches, each with touch held at another place
/// about where it was found, and the sensors at what is stated of them. Of a contact of few samples
/// a touch that is off, a delay and a gain with it, is a false minimum: one for each period of a
/// sensor that rings. The samples and the way of predicting are those chosen. Returns the searches'
/// iterations.
int scan_touch(FitProblem& problem);

}  // namespace impactrig::fitting
