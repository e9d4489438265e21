// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/clipped_as_recorded.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <optional>
#include <string>

#include "datasets/input_error.hpp"

namespace impactrig::acquisition {

using datasets::Edit;
using datasets::Impact;
using datasets::Record;
using datasets::TimeSpan;

namespace {

constexpr const char* note = "note clipped contacts";

/// The number in "0.0002 s".
std::optional<double> seconds_in(const std::map<std::string, std::string>& parameters,
                                 const std::string& key) {
  const auto found = parameters.find(key);
  if (found == parameters.end()) return std::nullopt;
  const std::string& text = found->second;
  double value = 0.0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || std::string(rest) != " s") return std::nullopt;
  return value;
}

std::vector<Impact> impacts_of(const Record& record, const DetectionOptions& detection) {
  try {
    return find_impacts(record, detection);
  } catch (const datasets::InputError&) {
    return {};  // what needs an impact says so
  }
}

}  // namespace

bool is_among(const std::vector<TimeSpan>& contacts, const Impact& impact) {
  return std::ranges::any_of(contacts, [&](const TimeSpan& contact) {
    return contact.begin < impact.end && contact.end > impact.start;
  });
}

void note_clipped(Record& record, const DetectionOptions& detection) {
  Edit edit{note, "", {}};
  std::size_t contacts = 0;
  const std::vector<TimeSpan> noted = noted_clipped(record);
  for (const Impact& impact : impacts_of(record, detection)) {
    if (!impact.has(datasets::ImpactFlag::clipped) || is_among(noted, impact)) continue;
    edit.channel = impact.trigger;
    ++contacts;
    edit.parameters[fmt::format("begin {}", contacts)] = fmt::format("{:.9g} s", impact.start);
    edit.parameters[fmt::format("end {}", contacts)] = fmt::format("{:.9g} s", impact.end);
  }
  if (contacts > 0) record.provenance.edits.push_back(std::move(edit));
}

std::vector<TimeSpan> noted_clipped(const Record& record) {
  std::vector<TimeSpan> spans;
  for (const Edit& edit : record.provenance.edits) {
    if (edit.what != note) continue;
    for (std::size_t k = 1;; ++k) {
      const auto begin = seconds_in(edit.parameters, fmt::format("begin {}", k));
      const auto end = seconds_in(edit.parameters, fmt::format("end {}", k));
      if (!begin || !end) break;
      spans.push_back({*begin, *end});
    }
  }
  return spans;
}

}  // namespace impactrig::acquisition
