// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/hdf5_pandas.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "acquisition/importers/text_encoding.hpp"

namespace impactrig::acquisition {

namespace {

std::string text_of(const Hdf5Attributes& attributes, const std::string& key) {
  const auto found = attributes.texts.find(key);
  return found == attributes.texts.end() ? std::string() : found->second;
}

/// A text of a pickle: what is not Latin-1, and a backslash, is written as "\u0394".
std::string unescaped(std::string_view text) {
  std::string utf8;
  while (!text.empty()) {
    unsigned code = 0;
    if (text.starts_with("\\u") && text.size() >= 6) {
      const auto [end, error] = std::from_chars(text.data() + 2, text.data() + 6, code, 16);
      if (error == std::errc{} && end == text.data() + 6) {
        utf8 += utf16_to_utf8({std::string("\xFE\xFF") + static_cast<char>(code >> 8U) +
                               static_cast<char>(code & 0xFFU)});
        text.remove_prefix(6);
        continue;
      }
    }
    utf8 += text.front();
    text.remove_prefix(1);
  }
  return utf8;
}

/// The texts of a pickled list, "(lp0 Vforce p1 aVspeed, tip p2 a.", or its whole numbers, "(lp0 I1
/// aI2 a.", whose line ends have become blanks; none where it is something else.
std::vector<std::string> pickled_texts(std::string_view pickle) {
  constexpr std::string_view begin = "(lp0 ";
  if (!pickle.starts_with(begin)) return {};
  pickle.remove_prefix(begin.size());
  std::vector<std::string> texts;
  while (pickle != ".") {
    const bool number = pickle.starts_with('I');
    const std::string end = number ? " a" : fmt::format(" p{} a", texts.size() + 1);
    const std::size_t length = pickle.find(end);
    if (!(number || pickle.starts_with('V')) || length == pickle.npos) return {};
    texts.push_back(unescaped(pickle.substr(1, length - 1)));
    pickle.remove_prefix(length + end.size());
  }
  return texts;
}

/// "us" of "datetime64[us]" and "timedelta64[us]", "ns" without brackets; "" of other kinds.
std::string unit_of_dates(std::string_view kind) {
  if (!kind.starts_with("datetime64") && !kind.starts_with("timedelta64")) return {};
  const std::size_t open = kind.find('[');
  if (open == kind.npos || !kind.ends_with(']')) return "ns";
  const std::string_view unit = kind.substr(open + 1, kind.size() - open - 2);
  return std::string(unit.substr(0, unit.find(',')));  // a zone may follow
}

/// One data frame or series.
class Frame {
 public:
  Frame(Hdf5Listing& listing, const std::string& path, const Hdf5Attributes& group)
      : listing_(listing),
        path_(path),
        group_(group) {}

  void take() {
    const bool table = text_of(group_, "pandas_type").ends_with("_table");
    if (table) leave_out_search_trees();
    for (Hdf5Array& array : listing_.arrays) {
      const std::size_t end = array.path.rfind('/');
      const std::string group = end == 0 ? "/" : array.path.substr(0, end);
      const std::string_view name = std::string_view(array.path).substr(end + 1);
      if (table && group == path_ && name == "table" && array.is_field())
        take_field(array);
      else if (!table && group == path_ && !array.is_field())
        take_data_set(array, std::string(name));
    }
    listing_.text_lists.erase(path_ + "/axis0");
    if (!table) leave_out_levels();
    leave_out_placeholders();
  }

 private:
  void leave_out_search_trees() {
    const std::string trees = path_ + "/_i_table/";
    std::erase_if(listing_.arrays,
                  [&](const Hdf5Array& array) { return array.path.starts_with(trees); });
    std::erase_if(listing_.skipped,
                  [&](const std::string& text) { return text.starts_with("'" + trees); });
  }

  /// Of an index of several levels, whose values and places in them are kept apart.
  void leave_out_levels() {
    const std::string within = path_ == "/" ? path_ : path_ + "/";
    for (const auto& [axis, reason] :
         {std::pair<std::string_view, std::string_view>{
              "axis1", "an index of several levels: reset_index() makes columns of it"},
          {"index", "an index of several levels: reset_index() makes columns of it"},
          {"axis0", "names of several levels: columns are numbered"}}) {
      if (text_of(group_, std::string(axis) + "_variety") != "multi") continue;
      const std::string place = within + std::string(axis) + "_l";
      const auto is_part = [&](const std::string& path) { return path.starts_with(place); };
      std::erase_if(listing_.arrays, [&](const Hdf5Array& array) { return is_part(array.path); });
      std::erase_if(listing_.text_lists, [&](const auto& list) { return is_part(list.first); });
      std::erase_if(listing_.texts, [&](const auto& text) { return is_part(text.first); });
      listing_.skipped.push_back(fmt::format("'{}{}' ({})", to_utf8(within), axis, reason));
    }
    const auto is_level = [&](const auto& text) {
      return text.first.starts_with(within + "block") &&
             text.first.find("_items_level") != std::string::npos;
    };
    std::erase_if(listing_.text_lists, is_level);
    std::erase_if(listing_.texts, is_level);
  }

  /// Numbers that name columns, and what stands for empty data, keeping their shape.
  void leave_out_placeholders() {
    const std::string within = path_ == "/" ? path_ : path_ + "/";
    std::erase_if(listing_.arrays, [&](const Hdf5Array& array) {
      if (!array.path.starts_with(within) || array.is_field()) return false;
      const std::string_view name = std::string_view(array.path).substr(within.size());
      const auto& of = array.attributes;
      const bool empty = of.texts.contains("value_type") &&
                         (of.texts.contains("shape") || of.numbers.contains("shape") ||
                          of.number_lists.contains("shape"));
      if (empty) listing_.skipped.push_back(fmt::format("'{}' (empty)", to_utf8(array.path)));
      return empty || name.starts_with("axis0") ||
             (name.starts_with("block") && name.find("_items") != name.npos);
    });
  }

  void name(Hdf5Array& array, const std::string& column) const {
    array.shown_as = fmt::format("{}.{}", path_, column);
  }

  void take_index(Hdf5Array& array, std::string index, const std::string& kind) const {
    name(array, index.empty() ? "index" : index);
    const std::string unit = unit_of_dates(kind);
    if (!unit.empty()) array.attributes.texts.emplace("units", unit);
    array.is_axis = kind == "float" || !unit.empty();
  }

  /// Of a table: the index, a column of its own, or one of those of a block.
  void take_field(Hdf5Array& array) const {
    auto& texts = array.attributes.texts;
    const std::string field = array.field_path.front();
    const auto names = pickled_texts(text_of(array.attributes, field + "_kind"));
    const std::string index_kind = text_of(array.attributes, "index_kind");
    std::erase_if(texts, [](const auto& text) {
      return std::ranges::any_of(std::array<std::string_view, 3>{"_kind", "_dtype", "_meta"},
                                 [&](std::string_view end) { return text.first.ends_with(end); });
    });
    if (field == "index") return take_index(array, name_of_index(), index_kind);
    if (array.element < names.size()) name(array, names[array.element]);
  }

  /// Within a pickle: "... Vindex_name p8 Vtime_s p9 ...".
  std::string name_of_index() const {
    constexpr std::string_view key = "Vindex_name p";
    const std::string info = text_of(group_, "info");
    std::size_t at = info.find(key);
    if (at == info.npos) return {};
    // "V", the number of the key's memo, and that of the name, which is the next
    unsigned memo = 0;
    const char* const digits = info.data() + at + key.size();
    const auto [behind, error] = std::from_chars(digits, info.data() + info.size(), memo);
    at = static_cast<std::size_t>(behind - info.data());
    if (error != std::errc{} || info.compare(at, 2, " V") != 0) return {};
    const std::size_t end = info.find(fmt::format(" p{} ", memo + 1), at + 2);
    return end == info.npos ? std::string()
                            : unescaped(std::string_view(info).substr(at + 2, end - at - 2));
  }

  void take_data_set(Hdf5Array& array, const std::string& name_within) {
    constexpr std::string_view values = "_values";
    if (name_within == "axis1" || name_within == "index") {
      const std::string index = text_of(array.attributes, "name");
      return take_index(array, index == "N." ? "" : index, text_of(array.attributes, "kind"));
    }
    if (name_within == "values") {
      const std::string series = text_of(group_, "name");
      return name(array, series.empty() || series == "N." ? "values" : series);
    }
    if (!name_within.starts_with("block") || !name_within.ends_with(values)) return;
    array.rows_first = true;
    const std::string unit = unit_of_dates(text_of(array.attributes, "value_type"));
    if (!unit.empty()) array.attributes.texts.emplace("units", unit);
    const std::string items = array.path.substr(0, array.path.size() - values.size()) + "_items";
    if (const auto list = listing_.text_lists.find(items); list != listing_.text_lists.end()) {
      array.attributes.lists.emplace("columns", list->second);
      array.shown_as = path_;
      listing_.text_lists.erase(list);
    } else if (const auto text = listing_.texts.find(items); text != listing_.texts.end()) {
      name(array, text->second);
      listing_.texts.erase(text);
    }
  }

  Hdf5Listing& listing_;
  const std::string& path_;
  const Hdf5Attributes& group_;
};

}  // namespace

void take_pandas(Hdf5Listing& listing) {
  for (const auto& [path, group] : listing.groups)
    if (group.texts.contains("pandas_type")) Frame(listing, path, group).take();
}

}  // namespace impactrig::acquisition
