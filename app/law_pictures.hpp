// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "app/law_numbers.hpp"

/// What `impactrig laws` draws, as SVG.
namespace impactrig::app {

/// Force against penetration, the point asked about, and where the law ends if that is near.
std::string elastic_picture(const models::Contact& contact, const ElasticFigures& figures);

/// The rebound of a free rigid impact against the restitution asked for.
std::string damping_picture(std::string_view law, const DampingFigures& figures);

/// Left the elastic laws up to the depth of the rig's impact, right the loops of one free impact by
/// each damping law. Loops that cannot be told apart are one line.
std::string comparison_picture(const LawScene& scene, const LawComparison& comparison);

}  // namespace impactrig::app
