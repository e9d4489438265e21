// SPDX-License-Identifier: BSD-3-Clause
// NI TDM: a description in XML (.tdm), samples in the .tdx beside it. What groups and channels say
// is what they say in TDMS.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>
#include <vector>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/date_time.hpp"
#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/joined_readers.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/importers/tdm_columns.hpp"
#include "acquisition/importers/tdm_document.hpp"
#include "acquisition/importers/tdms_clock.hpp"
#include "acquisition/importers/tdms_recording.hpp"
#include "datasets/input_error.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::InputError;
using datasets::Record;

namespace {

/// "2022-11-04T14:37:48.565" as LabVIEW's time stamp, of a zone that is not stated; anything else
/// as it stands.
TdmsProperty time_in(const std::string& text) {
  const auto time = date_time_in(text);
  if (!time || !time->has_date || !time->has_time || !time->days[0]) return text;
  constexpr std::int64_t from_1904_to_1970 = 2082844800;
  TdmsTime made;
  made.utc = time->zone.has_value();
  // a zone may have moved the time to the day before
  constexpr std::int64_t second = 1000000000;
  const std::int64_t rest = (time->nanoseconds % second + second) % second;
  made.seconds = std::int64_t{*time->days[0]} * 86400 + (time->nanoseconds - rest) / second +
                 from_1904_to_1970;
  made.fraction = static_cast<std::uint64_t>(std::ldexp(static_cast<double>(rest) * 1e-9, 64));
  return made;
}

/// <string_attribute name="..."><s>...</s>, <double_attribute name="...">1</... and the like.
TdmsProperty property_in(pugi::xml_node attribute) {
  const std::string_view kind = attribute.name();
  const pugi::xml_node text = attribute.child("s");
  std::string says = tdm_text(text ? text : attribute);
  if (kind == "time_attribute") return time_in(says);
  if (kind == "string_attribute") return says;
  const auto number = number_in(says, {'.', false});
  return number ? TdmsProperty(*number) : TdmsProperty(std::move(says));
}

constexpr std::size_t most_properties = 500000;
constexpr std::size_t longest_name = 250;  ///< [bytes]: a group's stands before each of its own

class TdmReader {
 public:
  TdmReader(const std::string& path, const ImportOptions& options)
      : path_(path),
        description_(path),
        document_(description_),
        columns_(document_, path),
        options_(options) {}

  std::unique_ptr<RecordingReader> open() {
    if (columns_.files().empty()) fail("the description names no file of samples");
    for (const std::string& warning : columns_.warnings()) warn(warning);
    for (const pugi::xml_node root : document_.data().children("tdm_root")) take_root(root);
    for (const pugi::xml_node group : document_.data().children("tdm_channelgroup"))
      take_group(group);
    limit_ramps();
    return columns_.files().size() == 1 ? one_file() : several_files();
  }

 private:
  void warn(std::string sentence) { record_.warnings.push_back(std::move(sentence)); }

  /// What an element says of a root, a group or a channel: its children that refer to no others,
  /// and its attributes. Scales are left out: TDM holds what they have made.
  TdmsProperties properties_of(pugi::xml_node element) {
    TdmsProperties properties;
    for (const pugi::xml_node child : element.children()) {
      if (std::string_view(child.name()) == "instance_attributes") {
        for (const pugi::xml_node attribute : child.children()) {
          std::string name = tdm_text(attribute.attribute("name"));
          if (name.starts_with("NI_Scal") || name == "NI_Number_Of_Scales") continue;
          properties[std::move(name)] = property_in(attribute);
        }
      } else if (std::string text = tdm_text(child);
                 !text.empty() && !text.starts_with("#xpointer")) {
        properties[tdm_name(child)] = std::move(text);
      }
    }
    stated_ += properties.size();
    if (stated_ > most_properties)
      fail(fmt::format("there are more than {} properties", most_properties));
    return properties;
  }

  void take_root(pugi::xml_node root) {
    TdmsObject object;
    object.properties = properties_of(root);
    common_.push_back(std::move(object));
    for (const pugi::xml_node group : document_.referred(root.child("channelgroups")))
      take_group(group);
  }

  void take_group(pugi::xml_node group) {
    if (std::string_view(group.name()) != "tdm_channelgroup" || !seen_.insert(group).second) return;
    TdmsObject object;
    object.depth = 1;
    object.group = tdm_text(group.child("name"), longest_name);
    object.properties = properties_of(group);
    object.properties.erase("name");
    const bool first_is_axis = text_of(object.properties, "wf_xcolumns") == "One";
    const std::string name = object.group;
    common_.push_back(std::move(object));
    const std::size_t first = channels_.size();
    for (const pugi::xml_node channel : document_.referred(group.child("channels")))
      take_channel(channel, name);
    if (first_is_axis && first < channels_.size()) take_axis(first);
    place_ramps(first);
  }

  void take_channel(pugi::xml_node channel, const std::string& group) {
    if (std::string_view(channel.name()) != "tdm_channel" || !seen_.insert(channel).second) return;
    if (channels_.size() == most_channels)
      fail(fmt::format("there are more than {} channels", most_channels));
    TdmsObject object;
    object.depth = 2;
    object.group = group;
    object.name = tdm_text(channel.child("name"), longest_name);
    const std::vector<pugi::xml_node> parts = document_.referred(channel.child("local_columns"));
    TdmColumn column = parts.empty() ? TdmColumn{{}, {}, "it refers to no numbers", {}}
                                     : columns_.column(parts.front(), object.name);
    for (std::string& warning : column.warnings) warn(std::move(warning));
    if (!column.problem.empty()) {
      warn(fmt::format("'{}' is left out: {}", object.name, column.problem));
      return;
    }
    if (parts.size() > 1)
      warn(fmt::format("'{}' has {} parts: the first is read", object.name, parts.size()));
    static_cast<TdmsPart&>(object) = std::move(column.part);
    object.properties.merge(properties_of(channel));
    object.properties.erase("name");
    settle_times(object);
    channels_.push_back({std::move(object), column.file});
  }

  /// DIAdem keeps times of day as numbers that it shows as times; a course of numbers in a unit of
  /// time is the abscissa.
  static void settle_times(TdmsObject& object) {
    const bool is_number = object.type->role == TdmsRole::number && object.samples() > 0 &&
                           object.type->kind == NumberKind::f64;
    const std::string shown = lowered(text_of(object.properties, "displaytype"));
    const std::string kind = text_of(object.properties, "datatype");
    if (is_number && (shown == "time" || kind == "DT_DATE")) {
      object.diadem_times = true;
      object.type = tdms_type(0x44);
    } else if (is_number && object.sources.front().numbers.ramp()) {
      const std::string unit = text_of(object.properties, "unit_string");
      object.is_axis = object.is_axis || (!unit.empty() && datasets::conversion(unit, "s"));
    }
  }

  /// LabVIEW's "one X column": the first channel has the times of all, whose increment of 1 means
  /// nothing.
  void take_axis(std::size_t first) {
    TdmsObject& axis = channels_[first].object;
    const std::string unit = text_of(axis.properties, "unit_string");
    if (axis.type->role != TdmsRole::time && !datasets::conversion(unit, "s")) return;
    axis.is_axis = true;
    for (std::size_t i = first; i < channels_.size(); ++i) {
      auto increment = channels_[i].object.properties.extract("wf_increment");
      if (increment.empty()) continue;
      increment.key() = "wf_increment beside the column of times";
      channels_[i].object.properties.insert(std::move(increment));
    }
  }

  /// A course of numbers belongs to the file of its group's samples.
  void place_ramps(std::size_t first) {
    std::optional<std::size_t> file;
    for (std::size_t i = first; i < channels_.size() && !file; ++i) file = channels_[i].file;
    for (std::size_t i = first; i < channels_.size(); ++i)
      if (!channels_[i].file) channels_[i].file = file.value_or(0);
  }

  /// A course of numbers has as many as are announced, but no more than there are samples of any
  /// channel in a file.
  void limit_ramps() {
    std::uint64_t most = 0;
    for (const Placed& channel : channels_)
      if (const StoredNumbers* const numbers = numbers_of(channel); numbers && !numbers->ramp())
        most = std::max(most, numbers->size());
    std::erase_if(channels_, [&](const Placed& channel) {
      const StoredNumbers* const numbers = numbers_of(channel);
      if (numbers == nullptr || !numbers->ramp() || numbers->size() <= most) return false;
      warn(
          fmt::format("'{}' is left out: it is a course of {} numbers, and no channel of the file "
                      "has more than {} samples",
                      channel.object.name, numbers->size(), most));
      return true;
    });
  }

  struct Placed {
    TdmsObject object;
    std::optional<std::size_t> file;
  };

  static const StoredNumbers* numbers_of(const Placed& channel) {
    const std::vector<TdmsSource>& sources = channel.object.sources;
    return sources.empty() ? nullptr : &sources.front().numbers;
  }

  std::unique_ptr<RecordingReader> one_file() {
    std::vector<TdmsObject> objects = std::move(common_);
    for (Placed& channel : channels_) objects.push_back(std::move(channel.object));
    return tdms_recording(std::move(columns_.files().front()), objects, std::move(record_),
                          options_);
  }

  /// Every file is a recording, the first of them with what all have in common; their channels
  /// share the earliest start of all.
  std::unique_ptr<RecordingReader> several_files() {
    share_start();
    std::vector<std::unique_ptr<RecordingReader>> readers;
    for (std::size_t file = 0; file < columns_.files().size(); ++file) {
      if (std::ranges::find(channels_, file, &Placed::file) == channels_.end()) continue;
      std::vector<TdmsObject> objects = std::exchange(common_, {});
      for (Placed& channel : channels_)
        if (channel.file == file) objects.push_back(std::move(channel.object));
      readers.push_back(tdms_recording(std::move(columns_.files()[file]), objects,
                                       std::exchange(record_, {}), options_));
    }
    if (readers.empty()) fail("the description refers to no numbers in its files of samples");
    Record says = readers.front()->head().record;
    if (earliest_) says.started = iso_text(*earliest_);
    return join_readers(std::move(says), std::move(readers));
  }

  void share_start() {
    const auto before = [](const TdmsTime& a, const TdmsTime& b) {
      return a.seconds != b.seconds ? a.seconds < b.seconds : a.fraction < b.fraction;
    };
    std::vector<std::optional<TdmsTime>> of_files(columns_.files().size());
    for (const Placed& channel : channels_) {
      const auto start = tdms_start(channel.object.properties);
      std::optional<TdmsTime>& of_file = of_files[*channel.file];
      if (start && (!of_file || before(*start, *of_file))) of_file = start;
      if (start && (!earliest_ || before(*start, *earliest_))) earliest_ = start;
    }
    for (Placed& channel : channels_)
      if (const auto& start = of_files[*channel.file];
          start && seconds_of_abscissa(channel.object.properties))
        channel.object.after = seconds_between(*earliest_, *start);
  }

  [[noreturn]] void fail(const std::string& problem) const {
    datasets::SourcePosition place;
    place.file = path_;
    throw InputError(place, problem);
  }

  std::string path_;
  MappedFile description_;
  TdmDocument document_;
  TdmColumns columns_;
  const ImportOptions& options_;
  Record record_;
  std::vector<TdmsObject> common_;  // the file and its groups
  std::vector<Placed> channels_;
  std::optional<TdmsTime> earliest_;
  std::size_t stated_ = 0;  // properties

  struct Hash {
    std::size_t operator()(pugi::xml_node node) const { return node.hash_value(); }
  };

  std::unordered_set<pugi::xml_node, Hash> seen_;  // what is listed twice is taken once
};

}  // namespace

int recognises_tdm(std::string_view file_name, std::string_view head) {
  if (head.find("<usi:tdm") != std::string_view::npos &&
      (head.starts_with("<?xml") || head.starts_with("<usi:tdm")))
    return 100;
  // packed: the name of the first entry stands behind its header of 30 bytes
  const bool packed = head.starts_with(std::string_view("PK\x03\x04", 4)) && head.size() > 40 &&
                      head.substr(30, 10) == "header.xml";
  return packed && lowered(file_name).ends_with(".tdm") ? 90 : 0;
}

std::vector<std::string> samples_of_tdm(const std::string& path) try {
  const MappedFile description(path);
  const TdmDocument document(description);
  const std::vector<std::string> urls = urls_of_tdm(document);
  std::vector<std::string> files;
  for (const std::string& url : urls)
    if (TdmSamples beside = samples_beside_tdm(path, url, urls.size() == 1); !beside.path.empty())
      files.push_back(std::move(beside.path));
  return files;

} catch (const InputError&) {
  return {};
}

std::unique_ptr<RecordingReader> open_tdm(const std::string& path, const ImportOptions& options) {
  return TdmReader(path, options).open();
}

}  // namespace impactrig::acquisition
