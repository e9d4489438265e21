// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "fitting/between_shots.hpp"
#include "reports/report_data.hpp"
#include "reports/verdict.hpp"

namespace impactrig::reports {

/// A number of one shot: a parameter of the physics, a restitution of the fit
/// ("restitution.kinetic") or one read from the record ("direct.kinetic").
struct ShotNumber {
  std::string name;
  std::string label;
  std::string unit;  ///< SI, "1" when dimensionless
  double value = std::numeric_limits<double>::quiet_NaN();
  double std_error = 0.0;  ///< 0 or NaN: could not be estimated
  std::array<double, 2> ci95 = {0, 0};
  double mesh_shift = 0.0;  ///< fitting::Parameter::mesh_shift: of all shots alike, so no scatter
  double mesh_error = 0.0;  ///< likewise
  bool compared = true;     ///< between shots; what follows from parameters only is not
  double with_speed = 0.0;  ///< correlation of its error with that of the fitted approach speed
};

/// One recording of a campaign, fitted by itself: a row of the summary.
struct CampaignShot {
  std::string file;  ///< as it was named
  std::string name;  ///< of its result and report, without ending
  bool has_report = false;
  Verdict verdict;
  bool converged = false;
  std::vector<std::string> flags;  ///< datasets::name(ImpactFlag)
  std::vector<ShotNumber> numbers;
  double reduced_chi2 = std::numeric_limits<double>::quiet_NaN();
  double peak_force = std::numeric_limits<double>::quiet_NaN();  ///< measured [N]
  /// Before touch as the velocity channel shows it, else as fitted [m/s].
  double approach_speed = std::numeric_limits<double>::quiet_NaN();
  /// As fitted, and its standard error; NaN where it was not, or is not known [m/s].
  double fitted_speed = std::numeric_limits<double>::quiet_NaN();
  double speed_error = std::numeric_limits<double>::quiet_NaN();
  std::string input_sha256;
  std::string result_key;

  const ShotNumber* number(const std::string& name) const;  ///< none: nullptr
};

/// "pass": explained and nothing flagged; "warn": explained in shape only, or flagged; "fail".
std::string word(const CampaignShot& shot);

/// A recording without a result.
struct CampaignFailure {
  std::string file;
  std::string sentence;
};

/// One number over the shots.
struct CampaignQuantity {
  std::string name, label, unit;
  std::vector<std::size_t> shots;  ///< indices of those that count
  std::vector<std::size_t> left_out;
  fitting::BetweenShots between;
  double mesh_shift = 0.0;          ///< mean of the shots' [SI]
  double mesh_error = 0.0;          ///< of the mean, with the sign of the shift [SI]
  std::array<double, 2> ci95 = {};  ///< of the mean, widened by the mesh error, which all share
  std::string sentence;             ///< what that amounts to
  std::optional<fitting::SpeedTrend> trend;
  std::string trend_sentence;  ///< "" where the speeds say nothing
};

/// Shots of one rig, each fitted by itself, and what they have in common.
struct Campaign {
  std::string title;
  std::vector<CampaignShot> shots;  ///< in the order of the recordings
  std::vector<CampaignFailure> failed;
  std::vector<CampaignFailure> left_out;     ///< named, but not to be counted
  std::vector<CampaignQuantity> quantities;  ///< of summarise()
  /// Of summarise(): a sentence for every parameter that too few shots tell to be compared.
  std::vector<std::string> not_compared;
  ResultProvenance provenance;
};

/// The row of a fit of one recording.
CampaignShot campaign_shot(const ReportData& data);

/// Fills `quantities` and `not_compared`: random effects and trend of every number that at least
/// two shots have. Impacts that are not whole or not plausible, parameters of fits that did not
/// converge, and values at a bound or without a standard error do not count.
void summarise(Campaign& campaign);

/// One JSON document, schema "impactrig/campaign/1".
std::string to_json(const Campaign& campaign);

/// One row a recording, those that failed too; RFC 4180, heads with units.
std::string to_csv(const Campaign& campaign);

/// The list of what failed, schema "impactrig/failed/1".
std::string failed_json(const Campaign& campaign);

/// One page; its links are relative: reports/NAME.html, fits/NAME.json. No request leaves it.
std::string to_html(const Campaign& campaign);

/// The same for the terminal.
std::string to_text(const Campaign& campaign);

/// "shot 1.uff" -> "shot%201.uff": a path in a link.
std::string url_path(const std::string& name);

}  // namespace impactrig::reports
