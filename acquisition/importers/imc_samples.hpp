// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/importers/imc_fields.hpp"
#include "acquisition/importers/mapped_file.hpp"
#include "acquisition/importers/stored_numbers.hpp"

namespace impactrig::acquisition {

constexpr int imc_digital_words = 11;
constexpr int imc_six_bytes = 13;

using ImcRuns = std::vector<NumberRun>;

/// Of digital words integers of 16 bits; none for what are no such numbers.
std::optional<NumberKind> imc_kind(const ImcComponent& one);

/// Where the numbers of components lie in an imc file.
class ImcSamples {
 public:
  /// All must live as long; `warnings` takes a sentence each.
  ImcSamples(const MappedFile& file, const ImcContents& contents,
             std::vector<std::string>& warnings)
      : file_(file),
        contents_(contents),
        warnings_(warnings) {}

  /// How many numbers the keys announce.
  std::uint64_t announced_in(const ImcComponent& one, const ImcBuffer& buffer,
                             std::uint64_t width) const;

  /// Buffers that follow each other without a new event. One that says so and yet begins elsewhere,
  /// in time or x, stays alone.
  std::vector<std::vector<ImcBuffer>> joined_buffers(const ImcComponent& one,
                                                     std::uint64_t width) const;

  /// Where the numbers of buffers lie. Empty when their samples are not in the file.
  ImcRuns runs_of(const ImcComponent& one, const std::vector<ImcBuffer>& buffers, NumberKind kind,
                  const std::string& name);

  /// The numbers of `runs` from one on, at most so many.
  StoredNumbers numbers_in(const ImcRuns& runs, NumberKind kind, std::uint64_t first = 0,
                           std::uint64_t count = ~std::uint64_t{0}) const;

  /// All numbers of a component, as the file means them.
  std::vector<double> values_of(const ImcComponent& one);

 private:
  /// The filled bytes of a buffer. A program that did not come to close its file may have left them
  /// at 0.
  std::uint64_t filled_of(const ImcBuffer& buffer) const;
  ImcRuns runs_of(const ImcComponent& one, const ImcBuffer& buffer, NumberKind kind,
                  std::uint64_t width, std::uint64_t within, const std::string& name);

  const MappedFile& file_;
  const ImcContents& contents_;
  std::vector<std::string>& warnings_;
};

}  // namespace impactrig::acquisition
