// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/law_numbers.hpp"

/// What `impactrig laws` prints, for readers and for machines.
namespace impactrig::app {

using Json = nlohmann::ordered_json;

std::string list_text();
Json list_json();

std::string elastic_text(const LawScene& scene, const LawContact& choice,
                         const ElasticFigures& figures);
Json elastic_json(const LawScene& scene, const LawContact& choice, const ElasticFigures& figures);

std::string damping_text(const LawScene& scene, std::string_view law,
                         const DampingFigures& figures);
Json damping_json(const LawScene& scene, std::string_view law, const DampingFigures& figures);

std::string table_text(const LawScene& scene, const std::vector<ReboundRow>& rows);
Json table_json(const LawScene& scene, const std::vector<ReboundRow>& rows);

std::string comparison_text(const LawScene& scene, const LawComparison& comparison);
Json comparison_json(const LawScene& scene, const LawComparison& comparison);

}  // namespace impactrig::app
