// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "datasets/record.hpp"

/// The formats that exporters.cpp lists: each an Exporter's `write`.
namespace impactrig::acquisition {

std::vector<std::string> write_uff58b(const datasets::Record& record, const std::string& path);
std::vector<std::string> write_uff58(const datasets::Record& record, const std::string& path);
std::vector<std::string> write_mat(const datasets::Record& record, const std::string& path);
std::vector<std::string> write_csv(const datasets::Record& record, const std::string& path);

}  // namespace impactrig::acquisition
