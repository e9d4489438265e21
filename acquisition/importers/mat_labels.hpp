// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "acquisition/importers/mat_contents.hpp"

namespace impactrig::acquisition {

/// What texts of a MAT-file say of the array beside which they stand, in the same structure or at
/// the top.
class MatLabels {
 public:
  explicit MatLabels(const MatContents& contents);

  /// "N" of `run.unit` for `run.data`, the only array of its structure that holds several numbers
  /// but its times; "" where no text says so, or it is a unit of time or of nothing that is known.
  std::string unit_of(std::string_view array) const;

  /// The names of a matrix' channels, by a cell array or lines of as many texts: `colheaders`, as
  /// importdata() has it, `names`, `labels`, ... Empty where there is none, or two are the same.
  std::vector<std::string> channels_of(std::string_view array, std::uint64_t channels) const;

  /// Their units likewise, by `units`, ...; empty where there are none, or not as many.
  std::vector<std::string> units_of(std::string_view array, std::uint64_t channels) const;

 private:
  std::vector<std::string> texts_of(const std::string& cells, std::uint64_t count) const;

  const MatContents& contents_;
  std::unordered_map<std::string_view, std::string_view> only_;  ///< by structure; "": several
};

}  // namespace impactrig::acquisition
