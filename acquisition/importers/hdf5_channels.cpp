// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/hdf5_channels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <utility>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/date_time.hpp"
#include "acquisition/importers/mat73_structures.hpp"
#include "acquisition/importers/mat_contents.hpp"
#include "acquisition/importers/mat_labels.hpp"
#include "acquisition/importers/start_times.hpp"
#include "acquisition/importers/stated_units.hpp"
#include "acquisition/importers/text_file.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::Record;

namespace {

constexpr std::uint64_t most_columns = 1000;

/// Copies what it is handed of one channel as doubles.
class Doubles final : public SampleSink {
 public:
  void take(std::size_t, const SampleBlock& block) override {
    std::visit(
        [this](auto samples) {
          for (const auto sample : samples) values.push_back(static_cast<double>(sample));
        },
        block.raw);
  }

  void take_times(std::size_t, std::span<const double>) override {}

  std::vector<double> values;
};

/// Hands numbers on as they come.
class EachBlock final : public SampleSink {
 public:
  using Use = std::function<void(std::span<const double>)>;

  explicit EachBlock(const Use& use) : use_(use) {}

  void take(std::size_t, const SampleBlock& block) override {
    std::visit(
        [this](auto samples) {
          numbers_.assign(samples.begin(), samples.end());
          use_(numbers_);
        },
        block.raw);
  }

  void take_times(std::size_t, std::span<const double>) override {}

 private:
  const Use& use_;
  std::vector<double> numbers_;
};

/// Letters of the plane that MATLAB's text has, of UTF-8.
std::u16string utf16_of(std::string_view text) {
  std::u16string letters;
  for (std::size_t i = 0; i < text.size();) {
    const auto first = static_cast<unsigned char>(text[i]);
    const std::size_t length = first < 0x80 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
    unsigned letter = length == 1 ? first : first & (0xFFU >> (length + 1));
    for (std::size_t k = 1; k < length && i + k < text.size(); ++k)
      letter = letter << 6 | (static_cast<unsigned char>(text[i + k]) & 0x3FU);
    letters += static_cast<char16_t>(letter < 0x10000 ? letter : 0xFFFD);
    i += length;
  }
  return letters;
}

/// "/run/force", and of MATLAB's "run.force".
std::string shown(std::string path, bool matlab) {
  return matlab ? mat73_name(std::move(path)) : to_utf8(path);
}

/// References of programs other than MATLAB are told.
Hdf5Listing without_references(Hdf5Listing listing) {
  for (const Hdf5References& references : listing.references)
    listing.skipped.push_back(fmt::format("'{}' (references)", to_utf8(references.path)));
  return listing;
}

/// True for what a list of the names of columns is called.
bool is_names_key(std::string_view key) {
  constexpr std::array<std::string_view, 13> keys = {
      "columns",      "column_names", "columnnames", "channels", "channel_names",
      "channelnames", "names",        "labels",      "fields",   "channel",
      "sensor",       "sensors",      "signals"};
  return std::ranges::find(keys, lowered(key)) != keys.end();
}

/// The names that an attribute gives the columns; null where none does, or two are the same.
const std::vector<std::string>* column_names(const Hdf5Array& array, std::uint64_t columns) {
  for (const auto& [key, list] : array.attributes.lists) {
    if (list.size() != columns || !is_names_key(key)) continue;
    const std::set<std::string> different(list.begin(), list.end());
    if (different.size() == list.size() && !different.contains("")) return &list;
  }
  return nullptr;
}

bool states_unit(const Hdf5Attributes& attributes) {
  const auto is_unit = [](const auto& entry) { return is_unit_key(entry.first); };
  return std::ranges::any_of(attributes.texts, is_unit) ||
         std::ranges::any_of(attributes.lists, is_unit);
}

/// Lists of names and of units that stand beside data sets of as many columns become attributes of
/// these, where these have none of the kind; what nothing takes stays.
void take_lists_beside(Hdf5Listing& listing) {
  std::erase_if(listing.text_lists, [&listing](const auto& entry) {
    const auto& [path, list] = entry;
    const std::size_t end = path.rfind('/') + 1;
    const std::string key = path.substr(end);
    const bool names = is_names_key(key);
    if (!names && !is_unit_key(key)) return false;
    const std::set<std::string> different(list.begin(), list.end());
    if (names && (different.size() < list.size() || different.contains(""))) return false;
    bool used = false;
    for (Hdf5Array& array : listing.arrays) {
      const auto& shape = array.shape;
      const bool beside = !array.is_field() && array.path.rfind('/') + 1 == end &&
                          array.path.starts_with(path.substr(0, end));
      if (!beside || shape.size() != 2 || shape[0] == shape[1] ||
          std::ranges::min(shape) != list.size())
        continue;
      const bool stated =
          names ? column_names(array, list.size()) != nullptr : states_unit(array.attributes);
      if (stated) continue;
      array.attributes.lists.emplace(names ? "columns" : "units", list);
      used = true;
    }
    return used;
  });
}

/// What a variable of MATLAB is that is no array of numbers; "" where it is one, or a structure.
std::string kept_otherwise(const Hdf5Attributes& attributes) {
  constexpr std::array<std::string_view, 13> plain = {
      "double", "single", "logical", "int8",   "uint8", "int16", "uint16",
      "int32",  "uint32", "int64",   "uint64", "char",  "struct"};
  if (attributes.numbers.contains("MATLAB_sparse")) return "a sparse matrix";
  const auto found = attributes.texts.find("MATLAB_class");
  if (found == attributes.texts.end() || std::ranges::find(plain, found->second) != plain.end())
    return {};
  if (found->second == "function_handle") return "a function handle";
  return matlab_object(found->second);
}

/// Which column of a data set, or field of its records, and of how many.
struct Column {
  std::uint64_t which = 0;
  std::uint64_t columns = 1;
};

/// How many columns a data set of several dimensions has along one of them; some number above
/// `most_columns` where there are more.
std::uint64_t columns_beside(const Hdf5Array& array, std::size_t along) {
  std::uint64_t columns = 1;
  for (std::size_t d = 0; d < array.shape.size(); ++d)
    if (d != along && columns <= most_columns)
      columns *= std::min(array.shape[d], most_columns + 1);
  return columns;
}

Column column_of(const Hdf5Slice& slice) {
  const Hdf5Array& array = *slice.array;
  if (array.is_field()) return {array.field_index, array.fields};
  if (slice.whole) return {slice.other, 1};
  return {slice.other, columns_beside(array, slice.along)};
}

bool is_matlab_text(const Hdf5Array& array) {
  const auto kept_as = array.attributes.texts.find("MATLAB_class");
  return kept_as != array.attributes.texts.end() && kept_as->second == "char";
}

/// The names and texts of a MAT-file of version 7.3, as the versions before have them.
MatContents texts_of_matlab(const Hdf5Channels& made) {
  MatContents contents;
  if (!made.matlab) return contents;
  for (const Hdf5Array& array : made.listing.arrays) {
    const std::string name = made.name_of_set(array);
    if (!is_matlab_text(array)) {
      MatArray& numbers = contents.arrays.emplace_back();
      numbers.name = name;
      constexpr std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
      numbers.count = 1;
      for (const std::uint64_t side : array.shape)
        numbers.count = side > 0 && numbers.count > most / side ? most : numbers.count * side;
      if (array.shape.size() != 2) continue;
      numbers.rows = array.shape[1];
      numbers.columns = array.shape[0];
      continue;
    }
    if (array.text.empty()) continue;  // too long to be names
    // MATLAB's dimensions stand in the other order: the last counts the lines
    const std::uint64_t lines = array.shape.size() == 2 ? array.shape[1] : 1;
    if (lines == 1)
      contents.texts.emplace(name, array.text);
    else
      contents.add_lines(name, lines, utf16_of(array.text));
  }
  return contents;
}

/// Makes the channels of a listing.
class ChannelMaker {
 public:
  explicit ChannelMaker(Hdf5Channels& made)
      : made_(made),
        matlab_(texts_of_matlab(made)),
        labels_(matlab_) {
    take_lists_beside(made.listing);
  }

  void make(const std::vector<std::string>& units) {
    take_facts();
    for (const Hdf5Array& array : made_.listing.arrays) add(array);
    tell_links();
    for (const auto& [path, list] : made_.listing.text_lists)
      skip(fmt::format("'{}' (text)", shown(path, made_.matlab)));
    take_units(units);
    for (std::size_t i = 0; i < made_.slices.size(); ++i) tell_as_stored(i);
  }

 private:
  /// Attributes of the root, and texts beside the data; NeXus has the title and start so.
  void take_facts() {
    Record& record = made_.record;
    if (made_.matlab) record.attributes["MAT-file version"] = "7.3";
    const auto root = made_.listing.groups.find("/");
    if (root != made_.listing.groups.end()) {
      for (const auto& [key, text] : root->second.texts) record.attributes.emplace(key, text);
      for (const auto& [key, value] : root->second.numbers)
        record.attributes.emplace(key, fmt::format("{}", value));
    }
    for (const auto& [path, text] : made_.listing.texts) {
      if (text.empty() || (made_.matlab && path.starts_with("/#"))) continue;
      record.attributes.emplace(path, text);
      if (path.ends_with("/title") && record.title.empty()) record.title = text;
      if (path.ends_with("/start_time") && record.started.empty()) record.started = text;
    }
    find_start();
  }

  /// When the recording began, where it does not say so as NeXus does: by attributes of the root
  /// [ACDD: time_coverage_start], of groups or data sets, or times that count from a date [CF 4.4],
  /// but one before 1971, which begins a scale. Where they differ the first one found, and told.
  void find_start() {
    StartTimes starts;
    std::string first;
    const auto add = [&](std::string_view text) {
      constexpr std::int32_t begin_of_1971 = 365;  // days
      const auto start = date_time_in(text);
      if (!start || !start->has_date || start->days[0].value_or(begin_of_1971) < begin_of_1971)
        return;
      if (first.empty()) first = start->iso();
      starts.add(start->iso());
    };
    const auto add_attributes = [&](const Hdf5Attributes& attributes) {
      for (const char* key : {"start_time", "time_coverage_start", "wf_start_time", "start"})
        if (const auto text = attributes.texts.find(key); text != attributes.texts.end())
          add(text->second);
    };
    for (const auto& [path, group] : made_.listing.groups) add_attributes(group);
    constexpr std::string_view mark = " since ";
    for (const Hdf5Array& array : made_.listing.arrays) {
      add_attributes(array.attributes);
      const auto units = array.attributes.texts.find("units");
      const std::size_t since =
          units == array.attributes.texts.end() ? std::string::npos : units->second.find(mark);
      if (since != std::string::npos)
        add(std::string_view(units->second).substr(since + mark.size()));
    }
    if (made_.record.started.empty()) made_.record.started = first;
    starts.tell(made_.record);
  }

  /// Of a field of records: "/run/table.force".
  std::string name_of(const Hdf5Array& array) const {
    return !array.is_field() || !array.shown_as.empty()
               ? made_.name_of_set(array)
               : shown(array.path + "." + array.field(), made_.matlab);
  }

  void skip(std::string what) { made_.listing.skipped.push_back(std::move(what)); }

  void add(const Hdf5Array& array) {
    const std::string name = name_of(array);
    const auto& shape = array.shape;
    const bool matlab = made_.matlab;
    if (matlab && is_matlab_text(array)) {
      if (array.text.empty()) return skip(fmt::format("'{}' (text)", name));
      made_.record.attributes.emplace(name, array.text);
      return;
    }
    if (array.attributes.numbers.contains("MATLAB_empty"))
      return skip(fmt::format("'{}' (empty)", name));
    if (matlab && is_of_no_numbers(array)) return;
    if (shape.size() > 2 && !matlab) return add_of_many_dimensions(array, name);
    Hdf5Slice slice;
    slice.array = &array;
    slice.whole = true;
    if (shape.size() != 2) return add_channel(name, slice);
    const std::size_t along = made_.scales.time_dimension(array);
    const std::uint64_t columns = shape[1 - along];
    if (columns > most_columns && !matlab)
      return skip(
          fmt::format("'{}' ({} columns, at most {} are read)", name, columns, most_columns));
    std::vector<std::string> names, units;
    if (const auto* const listed = column_names(array, columns)) names = *listed;
    if (matlab && names.empty()) names = labels_.channels_of(name, columns);
    const bool small = matlab && shape[along] <= longest_small_matrix &&
                       !labels_.rows_are_samples(shape[0], shape[1], !names.empty());
    if (columns == 1 || columns > most_columns || small) {
      if (small && is_told_of_small(shape[0], shape[1]))
        made_.warn(told_of_small(name, shape[1], shape[0]));
      return add_channel(name, slice);
    }
    slice.whole = false;
    slice.along = along;
    if (matlab) units = labels_.units_of(name, columns);
    for (slice.other = 0; slice.other < columns; ++slice.other)
      add_channel(names.empty() ? fmt::format("{}:{}", name, slice.other + 1)
                                : name + "." + names[slice.other],
                  slice, units.empty() ? std::string() : units[slice.other]);
  }

  /// A channel for each place in the dimensions beside the time: "/cube:2,3".
  void add_of_many_dimensions(const Hdf5Array& array, const std::string& name) {
    Hdf5Slice slice;
    slice.array = &array;
    slice.along = made_.scales.time_dimension(array);
    const std::uint64_t columns = columns_beside(array, slice.along);
    const std::string size = size_of(array);
    if (columns > most_columns)
      return skip(
          fmt::format("'{}' ({} numbers: more than {} columns; write those you need as data "
                      "sets of two dimensions)",
                      name, size, most_columns));
    if (!made_.scales.time_dimension_is_sure(array))
      return skip(
          fmt::format("'{}' ({} numbers, of which no scale of a dimension says which one is "
                      "the time; write it as data sets of two dimensions)",
                      name, size));
    for (slice.other = 0; slice.other < columns; ++slice.other) {
      std::string places;
      const std::vector<std::uint64_t> at = places_of(slice);
      for (std::size_t d = 0; d < at.size(); ++d)
        if (d != slice.along) places += fmt::format("{}{}", places.empty() ? "" : ",", at[d] + 1);
      add_channel(fmt::format("{}:{}", name, places), slice);
    }
    made_.warn(
        fmt::format("'{}': of its {} numbers dimension {} is taken for the time; the places "
                    "in the others name the channels",
                    name, size, slice.along + 1));
  }

  /// True where a MATLAB variable that is no array of numbers keeps something as numbers: an object
  /// what its data are found by, a sparse matrix its rows and columns. Each is told of once.
  bool is_of_no_numbers(const Hdf5Array& array) {
    std::string path = array.path;
    std::string why = kept_otherwise(array.attributes);
    for (std::size_t end = path.rfind('/'); why.empty() && end > 0; end = path.rfind('/')) {
      path.resize(end);
      const auto group = made_.listing.groups.find(path);
      if (group != made_.listing.groups.end()) why = kept_otherwise(group->second);
    }
    if (why.empty()) return false;
    if (told_.insert(path).second) skip(fmt::format("'{}' ({})", shown(path, true), why));
    return true;
  }

  /// Links that lead to no data set that is read.
  void tell_links() {
    std::set<std::string> lead_to;
    for (const Hdf5Slice& slice : made_.slices) {
      const std::string& path = slice.array->path;
      for (std::size_t end = path.size(); end != std::string::npos && end > 0;
           end = path.rfind('/', end - 1))
        lead_to.insert(path.substr(0, end));
    }
    for (const auto& [target, from] : made_.listing.links)
      if (!lead_to.contains(target))
        skip(fmt::format("'{}' (a link to '{}')", to_utf8(from), to_utf8(target)));
  }

  /// `slice`: its count and what stands for none are not known yet. `unit`: where the data set's
  /// attributes state none.
  void add_channel(const std::string& name, Hdf5Slice slice, const std::string& unit = "") {
    const Hdf5Array& array = *slice.array;
    Channel channel;
    channel.name = name;
    std::string linked;
    if (slice.whole && !array.is_field())
      for (const std::string& link : links_to(made_.listing, array.path))
        if (linked.size() < 1000)
          linked += (linked.empty() ? "" : " | ") + made_.name_of_path(link);
    if (!linked.empty()) channel.attributes[std::string(datasets::other_names)] = linked;
    for (const auto& [key, text] : array.attributes.texts) channel.attributes.emplace(key, text);
    for (const auto& [key, value] : array.attributes.numbers)
      channel.attributes.emplace(key, fmt::format("{}", value));
    channel.attributes.emplace("size", size_of(array));
    slice.count = slice.whole ? 1 : array.shape[slice.along];
    if (slice.whole)
      for (const std::uint64_t side : array.shape) slice.count *= side;
    const Column column = column_of(slice);
    channel.unit = unit_of(array, name, column.which, column.columns);
    if (channel.unit.empty()) channel.unit = unit;
    if (channel.unit.empty()) channel.unit = unit_of_group(array.path);
    if (channel.unit.empty() && made_.matlab) channel.unit = labels_.unit_of(name);
    take_packing(channel, slice);
    channel.quantity = datasets::quantity_of_unit(channel.unit);
    made_.record.channels.push_back(std::move(channel));
    made_.slices.push_back(slice);
  }

  /// Of a group that has a unit, and no other data set that it could be of.
  std::string unit_of_group(std::string_view path) {
    const auto parent_of = [](std::string_view within) {
      return within.substr(0, std::max<std::size_t>(within.rfind('/'), 1));
    };
    const std::string_view parent = parent_of(path);
    const auto group = made_.listing.groups.find(std::string(parent));
    if (group == made_.listing.groups.end()) return {};
    const auto& texts = group->second.texts;
    const auto stated =
        std::ranges::find_if(texts, [](const auto& text) { return is_unit_key(text.first); });
    if (stated == texts.end() ||
        datasets::quantity_of_unit(stated->second) == datasets::Quantity::unknown)
      return {};
    if (sets_.empty())
      for (const Hdf5Array& array : made_.listing.arrays)
        ++sets_[std::string(parent_of(array.path))];
    return sets_[std::string(parent)] == 1 ? stated->second : std::string();
  }

  /// "1024 x 2", as the program has it that wrote it.
  std::string size_of(const Hdf5Array& array) const {
    std::string size;
    for (std::size_t d = 0; d < array.shape.size(); ++d) {
      const std::size_t which = made_.matlab ? array.shape.size() - 1 - d : d;
      size += fmt::format("{}{}", d == 0 ? "" : " x ", array.shape[which]);
    }
    return size.empty() ? "1" : size;
  }

  /// Undoes what the NetCDF conventions pack. What cannot be undone is not in its unit.
  void take_packing(Channel& channel, Hdf5Slice& slice) {
    const Column column = column_of(slice);
    const Hdf5Packing packing = packing_of(*slice.array, column.which, column.columns);
    channel.scale = packing.scale;
    channel.offset = packing.offset;
    if (!packing.problem.empty()) {
      channel.unit.clear();
      made_.still_packed.insert(made_.slices.size());
    }
    if (!slice.array->complex) slice.none = no_value_of(*slice.array, column.which, column.columns);
  }

  /// The user sees no single numbers among the channels, except MATLAB's.
  void take_units(const std::vector<std::string>& units) {
    if (units.empty()) return;
    Record& record = made_.record;
    const auto is_channel = [this](const Hdf5Slice& slice) {
      return made_.matlab || !slice.array->shape.empty();
    };
    const auto count = std::ranges::count_if(made_.slices, is_channel);
    check_stated_units(units, static_cast<std::size_t>(count), "channels", made_.path);
    std::vector<std::string> of_all;
    std::size_t next = 0;
    for (const Hdf5Slice& slice : made_.slices)
      of_all.push_back(is_channel(slice) ? units[next++] : "");
    take_stated_units(of_all, made_.path, record);
    for (std::size_t i = 0; i < of_all.size(); ++i)
      if (!of_all[i].empty()) made_.scales.state_unit(*made_.slices[i].array, of_all[i]);
  }

  /// Of numbers that are as they are stored, where a unit would make them look like a measurement.
  void tell_as_stored(std::size_t index) {
    const Hdf5Array& array = *made_.slices[index].array;
    const std::string name = made_.name_of_set(array);
    const std::string& unit = made_.record.channels[index].unit;
    const Column column = column_of(made_.slices[index]);
    if (made_.still_packed.contains(index))
      made_.warn(fmt::format("'{}': {}: its numbers are {}", name,
                             packing_of(array, column.which, column.columns).problem,
                             unit.empty() ? "as they are stored, without a unit"
                                          : fmt::format("taken in {} as they are stored", unit)));
    for (const auto& [key, list] : array.attributes.lists)
      if (is_unit_key(key) && list.size() != column.columns)
        made_.warn(fmt::format("'{}': its attribute '{}' lists {} units, not {}: none is used",
                               name, key, list.size(), column.columns));
    const std::string names = unapplied_scales(array);
    if (names.empty()) return;
    const bool several = names.find("', '") != std::string::npos;
    made_.warn(fmt::format(
        "'{}': its attribute{} {} {} not applied: its numbers are taken{} as they are stored", name,
        several ? "s" : "", names, several ? "are" : "is",
        unit.empty() ? std::string() : fmt::format(" in {}", unit)));
  }

  Hdf5Channels& made_;
  const MatContents matlab_;
  const MatLabels labels_;
  std::set<std::string> told_;       // variables that are no numbers
  std::map<std::string, int> sets_;  // data sets of each group, once one asks
};

/// "not read: " and what, as far as it is no longer than a reader likes.
std::string told_skipped(const std::vector<std::string>& skipped) {
  std::string list;
  std::size_t more = 0;
  for (const std::string& text : skipped) {
    if (list.size() > 500)
      ++more;
    else
      list += (list.empty() ? "" : ", ") + text;
  }
  if (more > 0) list += fmt::format(" and {} more", more);
  return list.empty() ? list : "not read: " + list;
}

}  // namespace

Hdf5Channels::Hdf5Channels(const std::string& file, Hdf5Listing listed, bool of_matlab,
                           const std::vector<std::string>& units)
    : path(file),
      matlab(of_matlab),
      listing(matlab ? with_mat73_structures(std::move(listed))
                     : without_references(std::move(listed))),
      scales(listing.arrays) {
  record.provenance.importer = matlab ? "mat" : "hdf5";
  ChannelMaker(*this).make(units);
}

void Hdf5Channels::settle_the_rest() {
  std::vector<Hdf5Slice> single;
  std::vector<std::string> names;
  std::vector<Channel> kept;
  std::vector<Hdf5Slice> kept_slices;
  for (std::size_t i = 0; i < slices.size(); ++i) {
    Channel& channel = record.channels[i];
    if (!matlab && slices[i].array->shape.empty()) {
      single.push_back(slices[i]);
      names.push_back(channel.name);
    } else {
      kept.push_back(std::move(channel));
      kept_slices.push_back(slices[i]);
    }
  }
  record.channels = std::move(kept);
  slices = std::move(kept_slices);
  still_packed.clear();
  if (!single.empty()) {
    Doubles sink;  // one sample each, in their order
    read_hdf5_slices(path, single, sink);
    for (std::size_t i = 0; i < names.size() && i < sink.values.size(); ++i)
      record.attributes.emplace(names[i], fmt::format("{}", sink.values[i]));
  }
  if (std::string skipped = told_skipped(listing.skipped); !skipped.empty())
    record.warnings.push_back(std::move(skipped));
  if (record.channels.empty())
    record.warnings.emplace_back("there are no data sets of numbers: there are no channels");
}

std::string Hdf5Channels::name_of_path(const std::string& path_within) const {
  return shown(path_within, matlab);
}

void Hdf5Channels::warn(std::string sentence) {
  auto& warnings = record.warnings;
  if (std::ranges::find(warnings, sentence) == warnings.end())
    warnings.push_back(std::move(sentence));
}

void each_number_of(const std::string& path, const Hdf5Slice& slice, const EachBlock::Use& use) {
  EachBlock sink(use);
  read_hdf5_slices(path, {slice}, sink);
}

}  // namespace impactrig::acquisition
