// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "datasets/record.hpp"

/// The formats that exporters.cpp lists: each an Exporter's `write`.
namespace impactrig::acquisition {

void write_uff58b(const datasets::Record& record, const std::string& path);
void write_uff58(const datasets::Record& record, const std::string& path);
void write_mat(const datasets::Record& record, const std::string& path);
void write_csv(const datasets::Record& record, const std::string& path);

}  // namespace impactrig::acquisition
