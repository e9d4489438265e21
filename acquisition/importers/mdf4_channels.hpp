// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/importers/mdf4_blocks.hpp"
#include "acquisition/importers/mdf4_conversion.hpp"
#include "acquisition/importers/mdf4_records.hpp"

namespace impactrig::acquisition {

/// A channel (CN) as its block describes it.
struct MdfDescribed {
  std::uint64_t at = 0;
  std::string name;
  std::string unit;
  std::uint8_t type = 0;  ///< 0 values, 2 master, 3 virtual master, ...
  std::uint8_t sync = 0;  ///< of a master: 1 time, 2 angle, 3 distance, 4 index
  MdfField field;
  MdfConversion conversion;
  std::optional<std::uint64_t> invalid_bit;
  bool never_valid = false;
  std::string comment;
  bool usable = true;
};

/// Describes the channels of an MDF 4 file's groups, those that structures and arrays are made of
/// one by one. All of it throws datasets::InputError for blocks that are none, or that place a
/// channel outside of its records.
class MdfChannels {
 public:
  using Warn = std::function<void(std::string)>;

  /// Both are to outlive it.
  MdfChannels(MdfBlocks& blocks, Warn warn) : blocks_(blocks), warn_(std::move(warn)) {}

  /// Of the records that channels lie in [bytes].
  struct Records {
    std::uint64_t id = 0;  ///< before the values
    std::uint64_t values = 0;
    std::uint64_t all = 0;  ///< with those of invalidation behind the values
  };

  /// The channels of the chain that begins at a place.
  std::vector<MdfDescribed> chain(std::uint64_t first, const Records& records) {
    return chain_of_channels(first, {records, 0});
  }

  /// Warns of the channels of texts and byte arrays, which are left out.
  void tell_left_out() const;

 private:
  /// Where in a file a chain of channels stands.
  struct Around {
    Records records;
    int depth = 0;  ///< structures around it
  };

  [[noreturn]] void fail(std::uint64_t at, std::string_view problem) const {
    blocks_.fail(at, problem);
  }

  void count_channels(std::uint64_t at, std::uint64_t more);
  std::vector<MdfDescribed> chain_of_channels(std::uint64_t next, const Around& around);
  std::vector<MdfDescribed> parts_of(const MdfBlock& block, const Around& around);
  std::vector<MdfDescribed> elements_of(const MdfBlock& block, const std::string& name,
                                        const Around& within);
  bool has_numbers(const MdfBlock& block) const;
  void place(MdfDescribed& channel, std::int64_t bytes, std::int64_t bits,
             const Records& records) const;
  std::string name_of(const MdfBlock& block);
  void leave_out(const std::string& name);
  MdfDescribed described(const MdfBlock& block, const Records& records);
  static std::optional<MdfField> field_of(std::uint8_t data_type, std::uint32_t bit_offset,
                                          std::uint32_t bit_count);
  const MdfConversion& conversion_at(std::uint64_t at, bool floating = false);

  MdfBlocks& blocks_;
  Warn warn_;
  std::size_t channel_blocks_ = 0;
  std::map<std::pair<std::uint64_t, bool>, MdfConversion> conversions_;  // and whether of floats
  std::vector<std::string> left_out_;
  std::size_t left_out_count_ = 0;
};

}  // namespace impactrig::acquisition
