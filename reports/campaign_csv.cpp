// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/campaign.hpp"

namespace impactrig::reports {
namespace {

/// RFC 4180: quoted where it must be.
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

/// Shortest digits that give the same double back; nothing where there is no number.
std::string cell(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "";
}

struct Column {
  std::string name, unit;
};

/// Of all shots, in the order they come.
std::vector<Column> columns_of(const Campaign& campaign) {
  std::vector<Column> columns;
  for (const CampaignShot& shot : campaign.shots)
    for (const ShotNumber& number : shot.numbers)
      if (std::none_of(columns.begin(), columns.end(),
                       [&](const Column& column) { return column.name == number.name; }))
        columns.push_back({number.name, number.unit});
  return columns;
}

std::string numbers_of(const CampaignShot& shot, const std::vector<Column>& columns) {
  std::string out;
  for (const Column& column : columns) {
    const ShotNumber* number = shot.number(column.name);
    const bool known =
        number != nullptr && std::isfinite(number->std_error) && number->std_error > 0.0;
    out += "," + (number == nullptr ? "" : cell(number->value));
    out += known ? fmt::format(",{},{},{}", cell(number->std_error), cell(number->ci95[0]),
                               cell(number->ci95[1]))
                 : ",,,";
  }
  return out;
}

}  // namespace

std::string to_csv(const Campaign& campaign) {
  const std::vector<Column> columns = columns_of(campaign);
  std::string out = "file,word,verdict";
  for (const Column& column : columns)
    for (const char* what : {"", " std_error", " ci95 low", " ci95 high"})
      out += "," + cell(fmt::format("{}{} [{}]", column.name, what, column.unit));
  out += ",reduced chi2 [1],peak force [N],approach speed [m/s],flags,result,failure\r\n";
  for (const CampaignShot& shot : campaign.shots)
    out += fmt::format("{},{},{}{},{},{},{},{},{},\r\n", cell(shot.file), word(shot),
                       cell(shot.verdict.headline), numbers_of(shot, columns),
                       cell(shot.reduced_chi2), cell(shot.peak_force), cell(shot.approach_speed),
                       fmt::join(shot.flags, " "), cell("fits/" + shot.name + ".json"));
  for (const CampaignFailure& failure : campaign.failed)
    out += fmt::format("{},failed,{},,,,,,{}\r\n", cell(failure.file),
                       std::string(4 * columns.size(), ','), cell(failure.sentence));
  return out;
}

}  // namespace impactrig::reports
