// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/tdms_changes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "acquisition/importers/tdms_clock.hpp"

namespace impactrig::acquisition {

namespace {

constexpr std::size_t most_sentences = 50;
constexpr std::size_t most_told_of_a_channel = 3;
constexpr std::uint64_t most_copied = 1000000;  // properties, of all parts

constexpr std::string_view start_time = "wf_start_time";
constexpr std::string_view start_offset = "wf_start_offset";

bool is_of_scales(std::string_view name) {
  return name.starts_with("NI_Scal") || name == "NI_Number_Of_Scales";
}

bool is_start(std::string_view name) {
  return name == start_time || name == start_offset;
}

bool is_of_clock(std::string_view name) {
  return is_start(name) || name == "wf_increment";
}

/// Whether samples mean something else by this property.
bool matters(std::string_view name) {
  constexpr std::array<std::string_view, 4> others = {"unit_string", "wf_increment",
                                                      "wf_xunit_string", "wf_xname"};
  return is_of_scales(name) || is_start(name) || std::ranges::find(others, name) != others.end();
}

/// Intervals that were computed anew differ in their last digits.
bool same(std::string_view name, const TdmsProperty& a, const TdmsProperty& b) {
  if (a == b) return true;
  const auto x = number_of(a), y = number_of(b);
  if (!x || !y) return false;
  const double tolerance = name == "wf_increment" ? 1e-12 * std::abs(*y) : 0.0;
  return std::abs(*x - *y) <= tolerance || (std::isnan(*x) && std::isnan(*y));
}

/// Whether the property stands there and says nothing.
bool says_nothing(std::string_view name, const TdmsProperty& value) {
  if (name == "wf_increment") return !(std::abs(number_of(value).value_or(0.0)) > 0.0);
  return !is_of_scales(name) && name != start_offset && text_of(value).empty();
}

std::string quoted(const TdmsProperty& value) {
  const std::string text = text_of(value);
  return std::holds_alternative<std::string>(value) || text.empty() ? "'" + text + "'" : text;
}

}  // namespace

bool TdmsChanges::set(std::size_t which, const std::string& name, TdmsProperty value) {
  TdmsObject& object = objects_[which];
  TdmsProperties& properties = object.properties;
  const auto known = properties.find(name);
  if (known == properties.end()) {
    properties.emplace(name, std::move(value));
    note(which, name, std::nullopt);
    return true;
  }
  if (same(name, known->second, value)) return false;
  const auto carried_on = object.carried_on.find(name);
  if (carried_on != object.carried_on.end() && same(name, carried_on->second, value)) return false;
  note(which, name, std::exchange(known->second, std::move(value)));
  return false;
}

void TdmsChanges::note(std::size_t which, const std::string& name,
                       std::optional<TdmsProperty> old) {
  TdmsObject& object = objects_[which];
  if (object.depth < 2) {
    if (any_data_ && old && is_of_scales(name)) object.scales_change = true;
    return;
  }
  if (object.samples() == 0 || !matters(name)) return;
  if (!old && name == start_offset) old = 0.0;    // what it is where nothing states it
  pending_[which].emplace(name, std::move(old));  // the oldest stays: it holds for the samples
}

void TdmsChanges::before_data(std::uint64_t at) {
  any_data_ = true;
  steps_ += pending_.size();
  if (steps_ > 10000000 + 64 * std::uint64_t{file_.bytes().size()})
    fail_in_tdms(file_, at,
                 "properties change in so many segments that reading them would not end");
  for (auto next = pending_.begin(); next != pending_.end();) {
    const TdmsObject& object = objects_[next->first];
    const bool comes = object.listed && object.has_data && object.index && object.index->count > 0;
    if (comes) settle(next->first, next->second, at);
    next = comes ? pending_.erase(next) : std::next(next);
  }
}

void TdmsChanges::forget() {
  for (const auto& [which, before] : pending_)
    for (const Change& change : changes(objects_[which], before))
      if (change.old) put_back(objects_[which], change);
  pending_.clear();
}

std::vector<TdmsChanges::Change> TdmsChanges::changes(const TdmsObject& object,
                                                      const Before& before) {
  std::vector<Change> list;
  for (const auto& [name, old] : before) {
    const TdmsProperty& now = object.properties.at(name);
    const bool was_nothing = !old || says_nothing(name, *old);
    if (old && same(name, *old, now)) continue;
    if (was_nothing && says_nothing(name, now)) continue;
    // a start that is no longer stated is the one before
    if (name == start_time && says_nothing(name, now)) continue;
    list.push_back({name, was_nothing ? std::nullopt : old});
  }
  return list;
}

void TdmsChanges::settle(std::size_t which, const Before& before, std::uint64_t at) {
  TdmsObject& object = objects_[which];
  std::vector<Change> all = changes(object, before);
  const auto stated_late = std::stable_partition(
      all.begin(), all.end(), [](const Change& change) { return change.old.has_value(); });
  const std::vector<Change> late(stated_late, all.end());
  all.erase(stated_late, all.end());
  if (!late.empty())
    tell(object,
         fmt::format("segment {} is the first with data that states {}, after {} samples: it "
                     "is taken to hold for all",
                     segment_, text(object, late), object.samples()));
  if (joins_) join(which, all);
  const std::optional<double> gap = settle_start(object, all);
  if (all.empty()) return;
  may_join_ = may_join_ || std::ranges::all_of(
                               all, [](const Change& change) { return is_of_clock(change.name); });
  cut(object, all, gap, at);
}

void TdmsChanges::join(std::size_t which, std::vector<Change>& changes) {
  TdmsObject& object = objects_[which];
  const auto of_clock = [](const Change& change) { return is_of_clock(change.name); };
  if (std::ranges::none_of(changes, of_clock)) return;
  ++joined_[which];
  for (const Change& change : changes) {
    if (!of_clock(change)) continue;
    object.carried_on.insert_or_assign(change.name, object.properties.at(change.name));
    put_back(object, change);
  }
  std::erase_if(changes, of_clock);
}

std::optional<double> TdmsChanges::settle_start(TdmsObject& object, std::vector<Change>& changes) {
  TdmsProperties before;  // of the clock alone: there may be thousands of segments
  for (const char* const name :
       {"wf_start_time", "wf_start_offset", "wf_increment", "wf_xunit_string", "wf_xname"})
    if (const auto found = object.properties.find(name); found != object.properties.end())
      before.insert(*found);
  const TdmsProperties now = before;
  std::vector<Change> starts;
  for (const Change& change : changes) {
    before.insert_or_assign(change.name, *change.old);
    if (is_start(change.name)) starts.push_back(change);
  }
  if (starts.empty()) return std::nullopt;
  const double step = tdms_step(before);
  const std::uint64_t samples = object.samples();
  const auto first = tdms_start(before), next = tdms_start(now);
  double gap = tdms_start_offset(now) - tdms_start_offset(before) - object.after -
               step * static_cast<double>(samples);
  if (first && next) gap += seconds_between(*first, *next);
  const bool readable = starts.back().name != start_time || (first && next);
  if (step == 0.0 || !readable)
    tell(object, fmt::format("segment {} changes {}, after {} samples, from which no times follow: "
                             "the first is kept",
                             segment_, text(object, starts), samples));
  else if (std::abs(gap) > 0.5 * std::abs(step))
    return gap;
  for (const Change& change : starts) {
    object.carried_on.insert_or_assign(change.name, object.properties.at(change.name));
    put_back(object, change);
  }
  std::erase_if(changes, [](const Change& change) { return is_start(change.name); });
  return std::nullopt;
}

void TdmsChanges::cut(TdmsObject& object, const std::vector<Change>& changes,
                      std::optional<double> gap, std::uint64_t at) {
  copied_ += object.properties.size() + 10;  // a part takes memory of its own
  if (copied_ > most_copied)
    fail_in_tdms(file_, at,
                 fmt::format("the properties of {} and others change in so many segments that "
                             "their parts are too many to be channels of their own",
                             object.path));
  std::string apart;
  if (gap)
    apart = fmt::format(", with {} of {:.6g}{}", *gap > 0.0 ? "a gap" : "an overlap",
                        std::abs(*gap), seconds_of_abscissa(object.properties) ? " s" : "");
  if (object.earlier.size() < most_told_of_a_channel)
    tell(object, fmt::format("segment {0} changes {1}, after {2} samples{3}: those that follow are "
                             "'... (segment {0})'",
                             segment_, text(object, changes), object.samples(), apart));
  TdmsPart part = static_cast<TdmsPart&&>(object);
  object.properties = part.properties;
  object.sources.clear();
  object.type = nullptr;
  object.texts = 0;
  object.carried_on.clear();
  object.segment = segment_;
  for (const Change& change : changes) part.properties.insert_or_assign(change.name, *change.old);
  object.after =
      gap ? 0.0 : part.after + tdms_step(part.properties) * static_cast<double>(part.samples());
  object.earlier.push_back(std::move(part));
}

void TdmsChanges::put_back(TdmsObject& object, const Change& change) {
  object.properties.insert_or_assign(change.name, *change.old);
}

std::string TdmsChanges::text(const TdmsObject& object, const std::vector<Change>& changes) {
  constexpr std::size_t most = 3;
  std::string list;
  for (std::size_t i = 0; i < std::min(most, changes.size()); ++i) {
    const Change& change = changes[i];
    if (i > 0) list += ", ";
    list += change.name;
    if (change.old) list += " from " + quoted(*change.old);
    list += (change.old ? " to " : " ") + quoted(object.properties.at(change.name));
  }
  if (changes.size() > most) list += fmt::format(" and {} more", changes.size() - most);
  return list;
}

/// Channels of which the same is to be told share a sentence.
void TdmsChanges::tell(const TdmsObject& object, const std::string& sentence) {
  constexpr std::size_t most_names = 200;  // [bytes]
  const auto known = told_.find(sentence);
  if (known == told_.end() && sentences_.size() == most_sentences) {
    ++untold_;
    return;
  }
  std::string& names = told_[sentence];
  if (known == told_.end()) sentences_.push_back(sentence);
  if (names.size() < most_names)
    names += fmt::format("{}'{}'", names.empty() ? "" : ", ", object.name);
  else if (!names.ends_with("..."))
    names += ", ...";
}

std::vector<std::string> TdmsChanges::warnings() {
  for (const auto& [which, before] : pending_) {
    TdmsObject& object = objects_[which];
    std::vector<Change> all = changes(object, before);
    std::erase_if(all, [](const Change& change) { return !change.old; });  // stated late, for all
    settle_start(object, all);
    if (!all.empty())
      tell(object, fmt::format("{} changed after its last sample: the last statement holds for all",
                               text(object, all)));
  }
  pending_.clear();
  for (const TdmsObject& object : objects_)
    if (object.earlier.size() > most_told_of_a_channel)
      tell(object, fmt::format("{} later segments change properties too, each begins a channel "
                               "'... (segment n)'",
                               object.earlier.size() - most_told_of_a_channel));
  for (const auto& [which, segments] : joined_)
    tell(objects_[which],
         fmt::format("the starts or intervals of {} later {} are passed over, since --sample-rate "
                     "joins segments end to end",
                     segments, segments == 1 ? "segment" : "segments"));
  std::vector<std::string> list;
  for (const std::string& sentence : sentences_)
    list.push_back(fmt::format("{}: {}", told_.at(sentence), sentence));
  if (untold_ > 0)
    list.push_back(fmt::format("{} more changes of properties between segments", untold_));
  if (may_join_)
    list.emplace_back(
        "segments that differ in start or interval alone are joined end to end by --sample-rate");
  return list;
}

}  // namespace impactrig::acquisition
