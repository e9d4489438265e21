// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "acquisition/importers/mapped_file.hpp"
#include "acquisition/importers/mdf4_data.hpp"

namespace impactrig::acquisition {

/// Data in which the records of several channel groups stand by turns, each behind the number (id)
/// of its group: an unsorted file.
struct MdfMixed {
  /// The records of one id.
  struct Kind {
    std::uint64_t bytes = 0;  ///< with the id; of texts of variable length: of id and length
    bool variable = false;    ///< texts of a channel elsewhere, each behind its length
    std::size_t place = 0;    ///< in `groups`, where not variable
  };

  std::vector<MdfFragment> fragments{};
  std::uint64_t id_bytes = 1;  ///< 1, 2, 4 or 8
  std::unordered_map<std::uint64_t, Kind> kinds{};
  std::vector<std::size_t> groups{};  ///< of the recording
  std::string name{};                 ///< "group 3", for warnings

  std::uint64_t bytes() const {
    return fragments.empty() ? 0 : fragments.back().begin + fragments.back().length;
  }
};

/// Goes through such data once, from the beginning.
class MdfMixedRecords {
 public:
  /// Both have to live as long.
  MdfMixedRecords(const MappedFile& file, const MdfMixed& mixed)
      : mixed_(&mixed),
        total_(mixed.bytes()),
        bytes_(file, mixed.fragments) {}

  /// A record of a group, with its id; the bytes live until the next call.
  struct Seen {
    std::size_t place = 0;  ///< of the group
    const char* bytes = nullptr;
  };

  /// The next record that begins before `end`; none where there is none. Throws
  /// datasets::InputError for damaged data.
  std::optional<Seen> next(std::uint64_t end = ~std::uint64_t{0});

  std::uint64_t at() const { return at_; }

  bool at_the_end() const { return at_ >= total_; }

  /// Why the data were not gone through to their end; "" where they were.
  const std::string& problem() const { return problem_; }

 private:
  const char* look(std::uint64_t count);
  void pass(std::uint64_t count);
  std::uint64_t number(std::uint64_t from, std::uint64_t count);

  const MdfMixed* mixed_;
  std::uint64_t total_;
  std::uint64_t at_ = 0;
  MdfRecordBytes bytes_;
  std::string_view piece_;    ///< what lies together from `at_` on, as far as it is known
  std::string_view fetched_;  ///< the whole of it
  std::string problem_;
};

}  // namespace impactrig::acquisition
