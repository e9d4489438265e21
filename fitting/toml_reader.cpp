// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/toml_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>

namespace impactrig::fitting {
namespace {

/// Levenshtein distance, for "did you mean".
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0U : 1U)});
      diagonal = above;
    }
  }
  return row[b.size()];
}

}  // namespace

std::string_view nearest_name(std::string_view name, const std::vector<std::string_view>& known) {
  std::string_view nearest;
  std::size_t distance = 4;
  for (const std::string_view other : known)
    if (const std::size_t d = edit_distance(name, other); d < distance) {
      distance = d;
      nearest = other;
    }
  return nearest;
}

std::optional<std::string> overriding_key(std::string name,
                                          const std::set<std::string>& overridden) {
  while (!name.empty()) {
    if (overridden.contains(name)) return name;
    const std::size_t end = name.rfind('.');
    name.resize(end == std::string::npos ? 0 : end);
  }
  return std::nullopt;
}

TableReader::TableReader(const toml::table& table, std::string file, std::string path,
                         const std::set<std::string>& overridden)
    : table_(table),
      file_(std::move(file)),
      path_(std::move(path)),
      overridden_(overridden) {}

std::string TableReader::full_name(std::string_view key) const {
  return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

/// Of a key's value, or of the --set it came from.
datasets::SourcePosition TableReader::position_of(std::string_view key) const {
  datasets::SourcePosition where{.file = file_};
  if (const auto override = overriding_key(full_name(key), overridden_)) {
    where.file = "--set " + *override;
  } else if (const toml::node* node = table_.get(key)) {
    where.line = node->source().begin.line;
    where.column = node->source().begin.column;
    // a table that only --set made, for a key in it
    const auto within = std::ranges::find_if(overridden_, [&](const std::string& overridden) {
      return overridden.starts_with(full_name(key) + ".");
    });
    if (where.line == 0 && within != overridden_.end()) where = {.file = "--set " + *within};
  } else {
    where.line = table_.source().begin.line;
  }
  return where;
}

void TableReader::refuse(std::string_view key, std::string_view problem) const {
  throw datasets::InputError(position_of(key), fmt::format("{}: {}", full_name(key), problem));
}

void TableReader::refuse_name(std::string_view key, std::string_view problem) const {
  throw UnknownName(position_of(key), fmt::format("{}: {}", full_name(key), problem));
}

const toml::node* TableReader::find(std::string_view key) {
  known_.emplace(key);
  const toml::node* own = table_.get(key);
  return own || !other_ ? own : other_->get(key);
}

std::optional<datasets::UncertainValue> TableReader::quantity(std::string_view key,
                                                              std::string_view unit) {
  const toml::node* node = find(key);
  if (!node) return std::nullopt;
  if (const auto text = node->value_exact<std::string>()) {
    try {
      return datasets::parse_quantity(*text, unit);
    } catch (const std::invalid_argument& error) {
      refuse(key, error.what());
    }
  }
  if (const auto bare = node->value<double>(); bare && node->is_number())
    refuse(key, fmt::format("the bare number {:g} has no unit; write it in quotes with its unit, "
                            "for example \"{:g} {}\"",
                            *bare, *bare, unit));
  refuse(key, fmt::format("expected a quantity in quotes, for example \"1 {}\"", unit));
}

double TableReader::required_quantity(std::string_view key, std::string_view unit,
                                      std::string_view example) {
  const auto value = quantity(key, unit);
  if (!value) refuse_missing(key, example);
  return value->value;
}

/// Names a key that may have been meant.
void TableReader::refuse_missing(std::string_view key, std::string_view example) const {
  for (const auto& [other, node] : table_)
    if (!known_.contains(other.str()) && edit_distance(other.str(), key) < 4)
      refuse(other.str(), fmt::format("there is no such key here; did you mean {}?", key));
  refuse(key, fmt::format("is missing; add {} = \"{}\"", key, example));
}

std::optional<double> TableReader::number(std::string_view key) {
  const toml::node* node = find(key);
  if (!node) return std::nullopt;
  if (node->is_number()) return node->value<double>();
  refuse(key, "expected a plain number");
}

std::optional<int> TableReader::integer(std::string_view key) {
  const toml::node* node = find(key);
  if (!node) return std::nullopt;
  if (const auto value = node->value_exact<std::int64_t>();
      value && std::abs(*value) < 1'000'000'000)
    return static_cast<int>(*value);
  refuse(key, "expected a whole number");
}

std::optional<std::string> TableReader::text(std::string_view key) {
  const toml::node* node = find(key);
  if (!node) return std::nullopt;
  if (auto value = node->value_exact<std::string>()) return value;
  refuse(key, "expected a text in quotes");
}

std::string TableReader::required_text(std::string_view key, std::string_view example) {
  auto value = text(key);
  if (!value) refuse_missing(key, example);
  return *std::move(value);
}

std::optional<std::string> TableReader::name_or_index(std::string_view key) {
  const toml::node* node = find(key);
  if (!node) return std::nullopt;
  if (const auto index = node->value_exact<std::int64_t>()) return std::to_string(*index);
  if (auto value = node->value_exact<std::string>()) return value;
  refuse(key, "expected a channel's name in quotes, or its index from 0");
}

std::optional<std::vector<int>> TableReader::integers(std::string_view key) {
  const toml::node* node = find(key);
  if (!node) return std::nullopt;
  const toml::array* array = node->as_array();
  if (!array) return std::vector<int>{*integer(key)};
  std::vector<int> values;
  for (const toml::node& element : *array) {
    const auto value = element.value_exact<std::int64_t>();
    if (!value || std::abs(*value) > 1'000'000) refuse(key, "expected whole numbers");
    values.push_back(static_cast<int>(*value));
  }
  return values;
}

std::optional<std::vector<std::string>> TableReader::texts(std::string_view key) {
  const toml::node* node = find(key);
  if (!node) return std::nullopt;
  const toml::array* array = node->as_array();
  if (!array) return std::vector<std::string>{*text(key)};
  std::vector<std::string> values;
  for (const toml::node& element : *array) {
    auto value = element.value_exact<std::string>();
    if (!value) refuse(key, "expected texts in quotes");
    values.push_back(*std::move(value));
  }
  return values;
}

std::optional<bool> TableReader::flag(std::string_view key) {
  const toml::node* node = find(key);
  if (!node) return std::nullopt;
  if (const auto value = node->value_exact<bool>()) return value;
  refuse(key, "expected true or false");
}

std::optional<TableReader> TableReader::table(std::string_view key) {
  const toml::node* node = find(key);
  if (!node) return std::nullopt;
  const toml::table* inner = node->as_table();
  if (!inner) refuse(key, fmt::format("expected a table, for example [{}]", full_name(key)));
  return TableReader(*inner, file_, full_name(key), overridden_);
}

std::vector<TableReader> TableReader::tables(std::string_view key) {
  std::vector<TableReader> found;
  const toml::node* node = find(key);
  if (!node) return found;
  const toml::array* array = node->as_array();
  for (std::size_t i = 0; array && i < array->size(); ++i)
    if (const toml::table* inner = array->get(i)->as_table())
      found.emplace_back(*inner, file_, fmt::format("{}.{}", full_name(key), i + 1), overridden_);
  if (!array || found.size() != array->size())
    refuse(key, fmt::format("expected tables, for example [[{}]]", full_name(key)));
  return found;
}

std::optional<std::size_t> TableReader::choice(std::string_view key,
                                               const std::vector<std::string_view>& choices) {
  const auto value = text(key);
  if (!value) return std::nullopt;
  const auto found = std::ranges::find(choices, *value);
  if (found == choices.end())
    refuse_name(key,
                fmt::format("expected one of {}, found \"{}\"", fmt::join(choices, ", "), *value));
  return static_cast<std::size_t>(found - choices.begin());
}

void TableReader::finish() const {
  std::set<std::string, std::less<>> names = known_;
  names.insert(asked_.begin(), asked_.end());
  for (const auto& [key, node] : table_) {
    if (known_.contains(key.str())) continue;
    const std::string_view nearest = nearest_name(key.str(), {names.begin(), names.end()});
    std::string problem = "there is no such key here";
    if (!nearest.empty())
      problem += fmt::format("; did you mean {}?", nearest);
    else
      problem += fmt::format("; known are {}", fmt::join(names, ", "));
    refuse_name(key.str(), problem);
  }
}

}  // namespace impactrig::fitting
