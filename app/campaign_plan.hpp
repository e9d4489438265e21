// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace impactrig::app {

/// What a campaign would do to one recording.
struct PlannedItem {
  enum class What {
    reuse,      ///< its result is there
    fit,        ///< there is none
    replace,    ///< made anew: what is there is of something else
    refuse,     ///< the same without --force, which stops the campaign
    leave_out,  ///< a copy of another one
    fail        ///< it cannot be read
  };

  std::string file;
  What what = What::fit;
  std::string why;  ///< where its result is or goes, or a sentence
};

/// One line a recording, and how many of each.
std::string plan_text(const std::vector<PlannedItem>& plan);

/// The same, schema "impactrig/campaign-plan/1".
std::string plan_json(const std::vector<PlannedItem>& plan);

}  // namespace impactrig::app
