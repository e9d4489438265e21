// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/input_error.hpp"

#include <fmt/format.h>

#include <utility>

namespace impactrig::datasets {

namespace {

/// "place: problem", or the one of the two that is there.
std::string place_and_problem(std::string_view place, std::string_view problem) {
  return place.empty() ? std::string(problem) : fmt::format("{}: {}", place, problem);
}

}  // namespace

std::string SourcePosition::text() const {
  std::string result = file;
  if (line > 0) result += fmt::format("{}{}", file.empty() ? "line " : ":", line);
  if (line > 0 && column > 0) result += fmt::format(":{}", column);
  if (!byte) return result;
  return result.empty() ? fmt::format("byte {}", *byte)
                        : fmt::format("{} (byte {})", result, *byte);
}

InputError::InputError(SourcePosition where, std::string_view problem)
    : std::runtime_error(place_and_problem(where.text(), problem)),
      where_(std::move(where)),
      problem_(problem) {}

FileError::FileError(std::string_view file, std::string_view problem)
    : std::runtime_error(place_and_problem(file, problem)) {}

}  // namespace impactrig::datasets
