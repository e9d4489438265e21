// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "acquisition/exporters/outgoing.hpp"

/// The formats that exporters.cpp lists: each an Exporter's `write`.
namespace impactrig::acquisition {

std::vector<std::string> write_uff58b(const OutgoingRecording& recording, const std::string& path);
std::vector<std::string> write_uff58(const OutgoingRecording& recording, const std::string& path);
std::vector<std::string> write_mat(const OutgoingRecording& recording, const std::string& path);
std::vector<std::string> write_csv(const OutgoingRecording& recording, const std::string& path);

}  // namespace impactrig::acquisition
