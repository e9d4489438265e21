// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string_view>

#include "models/contact/damping/damping_law_entry.hpp"

namespace impactrig::models {

/// A law of the table: how the damping enters the force, and how strong the restitution e asks it
/// to be.
///
/// Where it is in proportion to the elastic force, f = f_0(δ) (1 + d δ̇ / v), a free impact of rigid
/// bodies rebounds with the e_out of d (1 + e_out) = ln((1 + d) / (1 − e_out d)), whatever f_0,
/// mass and speed are [GonthierEtAl2004]; only `exact` gives e_out = e.
struct DampingLaw {
  DampingLawText text;
  double (*factor)(double restitution);  ///< d or ζ, as the form has it [-]
};

/// A new law is one header, one line of this table, one test and one entry in docs/laws.md.
std::span<const DampingLaw> damping_laws();

/// Throws std::invalid_argument on an unknown name (and lists the known ones).
const DampingLaw& damping_law(std::string_view name);

}  // namespace impactrig::models
