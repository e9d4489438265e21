// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/mat73_structures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "acquisition/importers/text_file.hpp"

namespace impactrig::acquisition {

namespace {

constexpr int deepest = 16;                 ///< structures in structures
constexpr std::size_t most_fields = 10000;  ///< that are gone through

bool is_internal(std::string_view path) {
  return path.starts_with("/#") || path.starts_with("'/#");
}

std::string parent_of(const std::string& path) {
  return path.substr(0, std::max<std::size_t>(path.rfind('/'), 1));
}

std::string leaf_of(const std::string& path) {
  return to_utf8(path.substr(path.rfind('/') + 1));
}

/// Follows the references of structure arrays by comparing them with what is listed.
class Structures {
 public:
  explicit Structures(Hdf5Listing listing) : listing_(std::move(listing)) {
    for (const Hdf5Array& array : listing_.arrays) {
      if (!is_internal(array.path)) continue;
      if (array.reference != 0) arrays_.emplace(array.reference, &array);
      inner_arrays_[parent_of(array.path)].push_back(&array);
    }
    for (const auto& [path, attributes] : listing_.groups)
      if (is_internal(path)) inner_groups_[parent_of(path)].push_back(path);
    for (const Hdf5References& references : listing_.references) {
      references_[parent_of(references.path)].push_back(&references);
      if (references.kept_as == "cell" && references.reference != 0)
        cells_.emplace(references.reference, &references);
    }
  }

  Hdf5Listing named() {
    for (const Hdf5References& references : listing_.references)
      if (!is_internal(references.path))
        follow(references, mat73_name(parent_of(references.path)), 0);
    std::erase_if(listing_.arrays, [](const Hdf5Array& array) { return is_internal(array.path); });
    std::erase_if(listing_.skipped, [](const std::string& text) { return is_internal(text); });
    std::ranges::move(found_, std::back_inserter(listing_.arrays));
    std::ranges::move(skipped_, std::back_inserter(listing_.skipped));
    return std::move(listing_);
  }

 private:
  void skip(const std::string& name, std::string_view why) {
    skipped_.push_back(fmt::format("'{}' ({})", name, why));
  }

  bool is_structure(const std::string& group) const {
    const auto known = listing_.groups.find(group);
    if (known == listing_.groups.end()) return false;
    const auto kept_as = known->second.texts.find("MATLAB_class");
    return kept_as != known->second.texts.end() && kept_as->second == "struct";
  }

  /// True while there are not too many; tells where there are.
  bool counts() {
    if (++fields_ == most_fields + 1)
      skipped_.push_back(fmt::format("more than {} fields of structures", most_fields));
    return fields_ <= most_fields;
  }

  /// A field of the structures that `structure` names, or a cell array.
  void follow(const Hdf5References& references, const std::string& structure, int depth) {
    const std::string field = leaf_of(references.path);
    const std::string name = structure.empty() ? field : structure + "." + field;
    if (references.kept_as == "cell") return cells_at(references, name, depth);
    if (!references.kept_as.empty() || !is_structure(parent_of(references.path)))
      return skip(name, "references");
    for (std::size_t i = 0; i < references.to.size() && counts(); ++i)
      field_at(references.to[i], fmt::format("{}({}).{}", structure, i + 1, field), depth);
  }

  void cells_at(const Hdf5References& references, const std::string& name, int depth) {
    if (depth > deepest) return skip(name, "nested too deeply");
    for (std::size_t i = 0; i < references.to.size() && counts(); ++i)
      field_at(references.to[i], fmt::format("{}{{{}}}", name, i + 1), depth + 1);
  }

  void field_at(std::uint64_t reference, const std::string& name, int depth) {
    const auto array = arrays_.find(reference);
    if (array != arrays_.end()) return add(*array->second, name);
    const auto group = listing_.referred_groups.find(reference);
    if (group != listing_.referred_groups.end())
      return structure_at(group->second, name, depth + 1);
    const auto cells = cells_.find(reference);
    if (cells == cells_.end()) return skip(name, "a reference that leads nowhere");
    cells_at(*cells->second, name, depth + 1);
  }

  /// What a structure that is a field holds.
  void structure_at(const std::string& group, const std::string& name, int depth) {
    if (!is_structure(group)) return skip(name, "no structure");
    if (depth > deepest) return skip(name, "nested too deeply");
    for (const Hdf5Array* const array : inner_arrays_[group])
      if (counts()) add(*array, name + "." + leaf_of(array->path));
    for (const std::string& inner : inner_groups_[group])
      if (counts()) structure_at(inner, name + "." + leaf_of(inner), depth + 1);
    for (const Hdf5References* const references : references_[group])
      if (counts()) follow(*references, name, depth + 1);
  }

  void add(const Hdf5Array& array, const std::string& name) {
    found_.push_back(array);
    found_.back().shown_as = name;
    if (named_.insert(&array).second) return;
    Hdf5Attributes& kept = found_.back().attributes;  // not all of them as often as it is named
    std::erase_if(kept.texts, [](const auto& text) { return text.first != "MATLAB_class"; });
    std::erase_if(kept.numbers, [](const auto& number) { return number.first != "MATLAB_empty"; });
    kept.lists.clear();
    kept.number_lists.clear();
    kept.others.clear();
  }

  Hdf5Listing listing_;
  std::map<std::uint64_t, const Hdf5Array*> arrays_;  ///< internal ones, by their reference
  std::map<std::string, std::vector<const Hdf5Array*>> inner_arrays_;     ///< by their group
  std::map<std::string, std::vector<std::string>> inner_groups_;          ///< by the group around
  std::map<std::string, std::vector<const Hdf5References*>> references_;  ///< by their group
  std::map<std::uint64_t, const Hdf5References*> cells_;  ///< arrays of them, by their reference
  std::vector<Hdf5Array> found_;
  std::set<const Hdf5Array*> named_;
  std::vector<std::string> skipped_;
  std::size_t fields_ = 0;
};

}  // namespace

std::string mat73_name(std::string path) {
  path.erase(0, 1);
  std::ranges::replace(path, '/', '.');
  return to_utf8(path);
}

Hdf5Listing with_mat73_structures(Hdf5Listing listing) {
  return Structures(std::move(listing)).named();
}

}  // namespace impactrig::acquisition
