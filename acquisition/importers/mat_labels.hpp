// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "acquisition/importers/mat_contents.hpp"

namespace impactrig::acquisition {

/// A matrix longer than this holds samples one way and channels the other.
constexpr std::uint64_t longest_small_matrix = 100;

/// Whether a matrix that is not taken apart may hold channels, which is told then.
bool is_told_of_small(std::uint64_t rows, std::uint64_t columns);
std::string told_of_small(std::string_view name, std::uint64_t rows, std::uint64_t columns);

/// What texts of a MAT-file say of the array beside which they stand, in the same structure or at
/// the top.
class MatLabels {
 public:
  explicit MatLabels(const MatContents& contents);

  /// "N" of `force_unit` or `ForceUnit` for `force`, and of `run.unit` for `run.data`, the only
  /// array of its structure that holds several numbers but its times; "" where no text says so, or
  /// it is a unit of time or of nothing that is known.
  std::string unit_of(std::string_view array) const;

  /// The names of a matrix' channels, by a cell array or lines of as many texts: `colheaders`, as
  /// importdata() has it, `names`, `labels`, ... Empty where there is none, or two are the same.
  std::vector<std::string> channels_of(std::string_view array, std::uint64_t channels) const;

  /// Their units likewise, by `units`, ...; empty where there are none, or not as many.
  std::vector<std::string> units_of(std::string_view array, std::uint64_t channels) const;

  /// Whether few rows of a matrix, or columns, are samples all the same: as many times stand
  /// beside, or, where they are many more than the channels, an interval or a rate, or the channels
  /// are `named`.
  bool rows_are_samples(std::uint64_t rows, std::uint64_t columns, bool named) const;

 private:
  std::vector<std::string> texts_of(const std::string& cells, std::uint64_t count) const;

  /// Of a text of that name, capitals and underscores aside where `any_case`; "" where it is no
  /// unit that is known.
  std::string stated_unit(const std::string& name, bool any_case) const;

  const MatContents& contents_;
  std::unordered_map<std::string, std::string_view> texts_;  ///< without capitals, underscores
  std::unordered_map<std::string, int> arrays_;              ///< how many have such a name
  std::set<std::uint64_t> lengths_of_times_;                 ///< of vectors
  bool tells_rate_ = false;                                  ///< a number is one, or an interval
  std::unordered_map<std::string_view, std::string_view> only_;  ///< by structure; "": several
};

}  // namespace impactrig::acquisition
