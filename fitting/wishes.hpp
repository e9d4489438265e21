// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fitting/fit_options.hpp"
#include "fitting/rig_file.hpp"
#include "fitting/variables.hpp"

namespace impactrig::fitting {

/// What a damping law of [contact] may be made of: one of these.
inline constexpr std::array<std::string_view, 3> damping_parameters = {
    "contact.restitution", "contact.viscous", "contact.relaxation_time"};

/// The one of these that the force depends on: a coefficient where it is stated, or is to be
/// fitted, else the restitution; empty without damping.
std::string_view damping_parameter(const models::Contact& contact, const FitOptions& options);

/// What options ask for and state, by name: "start.velocity" is of all recordings, or of each its
/// own, "start.velocity[2]" that of recording 2.
class Wishes {
 public:
  static constexpr int all_recordings = -1;

  /// The options must live as long. Throws std::invalid_argument on a name that no parameter has or
  /// that is asked for twice.
  Wishes(const RigFile& rig, const FitOptions& options);

  /// Of what is to be free, in the order asked for, without numbers of recordings.
  const std::vector<std::string>& names() const { return names_; }

  /// Whether a parameter is to be free, in any recording or in this one (from 0).
  bool asks_for(std::string_view name, int recording = all_recordings) const;

  bool fixes(const Variable& v) const;
  bool shares(std::string_view name, bool by_itself) const;

  /// Whether one recording's own of this name is named.
  bool names_one_of(std::string_view name) const;

  /// What is stated of a variable: of its recording's own, and beside that of all.
  std::optional<ParameterSetting> of(const Variable& v) const;

  /// Throws std::invalid_argument on a name with the number of a recording that there is not, or of
  /// what all recordings share.
  void refuse_strangers(const std::vector<Variable>& variables, int recordings) const;

 private:
  std::vector<std::string> numbered_names() const;

  const FitOptions& options_;
  std::vector<std::string> names_;
  std::vector<ParameterKey> asked_;
};

}  // namespace impactrig::fitting
