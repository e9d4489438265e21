// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// What a file says of when each of its channels was started, while their times count from a start
/// of their own.
class StartTimes {
 public:
  /// ISO 8601, or as the file says; "": it does not.
  void add(const std::string& start);

  /// Warns in the record where they are more than two seconds apart: channels that were written one
  /// after the other may tell the times of that.
  void tell(datasets::Record& record) const;

 private:
  std::string first_, other_;
};

}  // namespace impactrig::acquisition
