// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/record.hpp"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <set>
#include <span>
#include <string_view>

namespace impactrig::datasets {

namespace {

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

bool equal_without_case(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, [](char x, char y) { return lower(x) == lower(y); });
}

/// scale * raw + offset, and `raw` itself, signed zeros included, where the scale does nothing.
double scaled(double raw, double scale, double offset) {
  return scale == 1.0 && offset == 0.0 ? raw : scale * raw + offset;
}

/// True for "b" in "a | b".
bool is_listed(std::string_view list, std::string_view name) {
  constexpr std::string_view between = " | ";
  for (;;) {
    const std::size_t end = list.find(between);
    if (list.substr(0, end) == name) return true;
    if (end == std::string_view::npos) return false;
    list.remove_prefix(end + between.size());
  }
}

}  // namespace

std::size_t Channel::size() const {
  return std::visit([](const auto& samples) { return samples.size(); }, raw);
}

double Channel::value(std::size_t i) const {
  return std::visit(
      [&](const auto& samples) { return scaled(static_cast<double>(samples[i]), scale, offset); },
      raw);
}

std::vector<double> Channel::values() const {
  std::vector<double> result(size());
  values(0, result);
  return result;
}

void Channel::values(std::size_t first, std::span<double> to) const {
  std::visit(
      [&](const auto& samples) {
        std::ranges::transform(
            std::span(samples).subspan(first, to.size()), to.begin(),
            [&](auto sample) { return scaled(static_cast<double>(sample), scale, offset); });
      },
      raw);
}

const Channel* Record::find(std::string_view name_or_index) const {
  const auto exact = std::ranges::find(channels, name_or_index, &Channel::name);
  if (exact != channels.end()) return &*exact;

  const auto same = [&](const Channel& channel) {
    return equal_without_case(channel.name, name_or_index);
  };
  const auto first = std::ranges::find_if(channels, same);
  if (first != channels.end()) {
    const bool only = std::find_if(first + 1, channels.end(), same) == channels.end();
    return only ? &*first : nullptr;
  }

  const auto in_group = [&](const Channel& channel) {
    const auto group = channel.attributes.find("group");
    return group != channel.attributes.end() &&
           name_or_index.size() == group->second.size() + 1 + channel.name.size() &&
           name_or_index.starts_with(group->second) && name_or_index.ends_with(channel.name) &&
           name_or_index[group->second.size()] == '/';
  };
  const auto grouped = std::ranges::find_if(channels, in_group);
  if (grouped != channels.end()) return &*grouped;

  const auto linked = [&](const Channel& channel) {
    const auto names = channel.attributes.find(std::string(other_names));
    return names != channel.attributes.end() && is_listed(names->second, name_or_index);
  };
  const auto other = std::ranges::find_if(channels, linked);
  if (other != channels.end()) return &*other;

  // "Force" of "/shot/Force", where no other ends so
  const auto ends_so = [&](const Channel& channel) {
    const std::size_t slash = channel.name.rfind('/');
    return slash != std::string::npos &&
           equal_without_case(std::string_view(channel.name).substr(slash + 1), name_or_index);
  };
  const auto leaf = std::ranges::find_if(channels, ends_so);
  if (leaf != channels.end() && std::find_if(leaf + 1, channels.end(), ends_so) == channels.end())
    return &*leaf;

  std::size_t index = 0;
  const char* const last = name_or_index.data() + name_or_index.size();
  const auto [end, error] = std::from_chars(name_or_index.data(), last, index);
  if (error != std::errc{} || end != last || index >= channels.size()) return nullptr;
  return &channels[index];
}

std::string program_version() {
  return "impactrig " IMPACTRIG_VERSION;
}

namespace {

/// Null where the edit has none of that name.
const std::string* parameter(const Edit& edit, const std::string& name) {
  const auto found = edit.parameters.find(name);
  return found == edit.parameters.end() ? nullptr : &found->second;
}

/// How many of the last were made at once: one, and of a map all that it made, each name once.
std::size_t made_at_once(std::span<const Edit> edits) {
  const std::string* const map = parameter(edits.back(), "map");
  if (map == nullptr) return 1;
  std::set<std::string_view> names;
  const auto other = std::find_if(edits.rbegin(), edits.rend(), [&](const Edit& edit) {
    const std::string* const its = parameter(edit, "map");
    return its == nullptr || *its != *map || !names.insert(edit.channel).second;
  });
  return static_cast<std::size_t>(other - edits.rbegin());
}

}  // namespace

bool is_of_file_of(const Edit& edit, const Channel& channel) {
  const std::string key(recorded_in);
  const auto of_edit = edit.parameters.find(key);
  const auto of_channel = channel.attributes.find(key);
  return of_edit == edit.parameters.end() || of_channel == channel.attributes.end() ||
         of_edit->second == of_channel->second;
}

bool was_made_to(const Edit& edit, const Channel& channel) {
  return edit.channel == channel.name && is_of_file_of(edit, channel);
}

std::vector<const Edit*> edits_of(const Record& record, const Channel& channel) {
  std::vector<const Edit*> all;
  std::string name = channel.name;
  const auto take_one_of = [&](std::span<const Edit> edits) {
    for (const Edit& edit : edits) {
      if (!is_of_file_of(edit, channel)) continue;
      const std::string* const made = parameter(edit, "result");
      if (made != nullptr && *made == name) name = edit.channel;
      if (edit.channel != name) continue;
      all.push_back(&edit);
      if (const std::string* const old = parameter(edit, "name in file")) name = *old;
      return;
    }
  };
  for (std::span<const Edit> left = record.provenance.edits; !left.empty();) {
    const std::size_t count = made_at_once(left);
    take_one_of(left.last(count));
    left = left.first(left.size() - count);
  }
  std::ranges::reverse(all);
  return all;
}

bool has_been_inverted(const Record& record, const Channel& channel) {
  return std::ranges::any_of(edits_of(record, channel), [](const Edit* edit) {
    const std::string* const polarity = parameter(*edit, "polarity");
    return edit->what == "map channel" && polarity != nullptr && *polarity == "-1";
  });
}

}  // namespace impactrig::datasets
