// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "acquisition/importer.hpp"
#include "acquisition/source.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// How fast a replay goes.
enum class Pace {
  at_once,   ///< a record whenever it is asked for
  real_time  ///< a record no sooner after the one before than it lasts
};

/// Recordings one after the other, in the order given.
class ReplaySource : public Source {
 public:
  /// Files of any known format, each read when its turn comes.
  explicit ReplaySource(std::vector<std::string> files, ImportOptions options = {},
                        Pace pace = Pace::at_once);
  explicit ReplaySource(std::vector<datasets::Record> records, Pace pace = Pace::at_once);

  /// Throws what import_recording throws; the next call goes on with the next file.
  std::optional<datasets::Record> next() override;

 private:
  std::vector<std::variant<std::string, datasets::Record>> items_;
  ImportOptions options_;
  Pace pace_;
  std::size_t position_ = 0;
  std::optional<std::chrono::steady_clock::time_point> due_;  ///< of the last record
};

}  // namespace impactrig::acquisition
