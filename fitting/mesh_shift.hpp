// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "fitting/fit_end.hpp"
#include "fitting/fit_problem.hpp"

namespace impactrig::fitting {

/// What a mesh twice as fine would add to the unknowns and to the first recording's restitutions:
/// mesh_shift and mesh_change of the end, to first order, as far as the residuals have room for the
/// rest of its change: a mesh whose later contacts would come at other times is not as wrong as
/// that where the data follow it. Compared in small motion where the rig has that: what
/// large rotation adds is the same on both. Where that fails, a warning says so.
void estimate_mesh_shift(FitProblem& problem, FitEnd& end, std::vector<std::string>& warnings);

/// What part of the residuals' square a mesh twice as fine would change that no unknown follows, to
/// first order; 0 where that cannot be told.
double part_left_by_mesh(FitProblem& problem, const FitEnd& end);

}  // namespace impactrig::fitting
