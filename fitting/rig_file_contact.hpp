// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "fitting/toml_reader.hpp"
#include "models/rig.hpp"

namespace impactrig::fitting {

/// Reads the table [contact], or one of [[contacts]], of a bar that is known already. `radii`: of
/// the surface in each segment of the bar, of a uniform one its only; 0 where it is not round [m].
void read_contact(TableReader& table, const models::Beam& beam, const std::vector<double>& radii,
                  models::Contact& contact);

struct FurtherStops {
  std::vector<models::FurtherStop> stops;
  std::vector<std::string> inherited;  ///< numbers as [contact] has them: "contacts.1.restitution"
};

/// [[contacts]]: what a table leaves open is as [contact] states it.
FurtherStops read_further_stops(TableReader& root, const models::Beam& beam,
                                const std::vector<double>& radii);

}  // namespace impactrig::fitting
