// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fitting/fit_options.hpp"
#include "fitting/rig_file.hpp"
#include "fitting/variables.hpp"

namespace impactrig::fitting {

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
