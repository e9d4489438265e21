// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <toml++/toml.h>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/input_error.hpp"
#include "datasets/units.hpp"

namespace impactrig::fitting {

/// A key that there is not, or a value that is none of those it may be: misspelt, most likely.
class UnknownName : public datasets::InputError {
 public:
  using InputError::InputError;
};

/// The one of `known` that a mistyped name is at most 3 edits from, for "did you mean"; else empty.
std::string_view nearest_name(std::string_view name, const std::vector<std::string_view>& known);

/// The dotted key among `overridden` that a value came from: its own or that of a table it is in;
/// none.
std::optional<std::string> overriding_key(std::string name,
                                          const std::set<std::string>& overridden);

/// Reads one table of a configuration, key by key, and refuses in finish() whatever was not asked
/// for. Every error names the key and its place in the file (or the --set option it came from).
class TableReader {
 public:
  /// `path` is the table's dotted name, "" for the root; `overridden` the dotted keys that --set
  /// supplied.
  TableReader(const toml::table& table, std::string file, std::string path,
              const std::set<std::string>& overridden);

  /// Keys that this table does not state are read from another one, which must live as long.
  void inherit(const toml::table& other) { other_ = &other; }

  bool has(std::string_view key) const {
    asked_.emplace(key);
    return table_.contains(key) || (other_ && other_->contains(key));
  }

  bool is_number(std::string_view key) const {
    const toml::node* const node = table_.get(key) ? table_.get(key)
                                   : other_        ? other_->get(key)
                                                   : nullptr;
    return node != nullptr && node->is_number();
  }

  /// "0.69 m" in `unit`; none when the key is absent.
  std::optional<datasets::UncertainValue> quantity(std::string_view key, std::string_view unit);
  double required_quantity(std::string_view key, std::string_view unit, std::string_view example);
  std::optional<double> number(std::string_view key);  ///< dimensionless, a plain number
  std::optional<int> integer(std::string_view key);
  std::optional<std::string> text(std::string_view key);
  std::string required_text(std::string_view key, std::string_view example);
  std::optional<std::string> name_or_index(std::string_view key);
  std::optional<std::vector<int>> integers(std::string_view key);       ///< an array or one number
  std::optional<std::vector<std::string>> texts(std::string_view key);  ///< an array or one text
  std::optional<bool> flag(std::string_view key);                       ///< true or false
  std::optional<TableReader> table(std::string_view key);
  std::vector<TableReader> tables(std::string_view key);  ///< an array of tables, none when absent

  /// One of `choices`, by position; none when absent.
  std::optional<std::size_t> choice(std::string_view key,
                                    const std::vector<std::string_view>& choices);

  /// Throws when the table holds a key nobody asked for, with the nearest known one.
  void finish() const;

  [[noreturn]] void refuse(std::string_view key, std::string_view problem) const;
  [[noreturn]] void refuse_name(std::string_view key, std::string_view problem) const;
  std::string full_name(std::string_view key) const;

  const toml::table& raw() const { return table_; }

 private:
  const toml::node* find(std::string_view key);
  datasets::SourcePosition position_of(std::string_view key) const;
  [[noreturn]] void refuse_missing(std::string_view key, std::string_view example) const;

  const toml::table& table_;
  const toml::table* other_ = nullptr;
  std::string file_;
  std::string path_;
  const std::set<std::string>& overridden_;
  std::set<std::string, std::less<>> known_;          ///< that were read
  mutable std::set<std::string, std::less<>> asked_;  ///< whether they are there
};

}  // namespace impactrig::fitting
