// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "fitting/fit_options.hpp"
#include "fitting/toml_reader.hpp"

namespace impactrig::fitting {

/// The table [fit] of a rig file: what is fitted, with a table for every parameter of which more is
/// stated, [fit.contact.restitution] and so on. Throws datasets::InputError.
FitOptions read_fit(TableReader& table);

/// Chooses the channels of a fit by their names: force, velocity, displacement. Throws
/// std::invalid_argument on another one.
void choose_channels(const std::vector<std::string>& names, FitOptions& options);

/// One value for all recordings, or each its own. Throws std::invalid_argument on a name of one
/// recording's.
void choose_shared(const std::string& name, bool shared, FitOptions& options);

/// One line each of the command line; these throw std::invalid_argument with a sentence.
void read_prior(std::string_view text, FitOptions& options);   ///< "beam.density=2766(5) kg/m^3"
void read_bounds(std::string_view text, FitOptions& options);  ///< "contact.restitution=0.3:0.9"
/// "contact.modulus=beam.youngs_modulus", "contact.modulus=0.9*beam.youngs_modulus".
void read_tie(std::string_view text, FitOptions& options);

}  // namespace impactrig::fitting
