// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/importers/mapped_file.hpp"
#include "acquisition/importers/tdms_objects.hpp"

namespace impactrig::acquisition {

/// Properties that change from one segment to another. Where unit, scales or clock of a channel do,
/// what follows becomes a part of its own, so that no sample has the properties of others; a start
/// that is stated anew where the samples so far end is no change. Other properties are those of the
/// last segment.
class TdmsChanges {
 public:
  /// `objects` may grow meanwhile. `joins`: another start or interval begins no part, since the
  /// user states the rate of all.
  TdmsChanges(const MappedFile& file, std::vector<TdmsObject>& objects, bool joins)
      : file_(file),
        objects_(objects),
        joins_(joins) {}

  void next_segment() { ++segment_; }

  /// States a property of an object; true when it is the first of its name.
  bool set(std::size_t which, const std::string& name, TdmsProperty value);

  /// Before the raw data of a segment, which lie at `at`, are placed: those of channels whose
  /// properties have changed begin a part. Throws datasets::InputError when that would not end.
  void before_data(std::uint64_t at);

  /// The file ends before the data to come: what was stated for them is forgotten.
  void forget();

  /// What there is to tell the user once all segments are read, one sentence each.
  std::vector<std::string> warnings();

 private:
  struct Change {
    std::string name;
    std::optional<TdmsProperty> old;  ///< none: it was not stated
  };

  using Before = std::map<std::string, std::optional<TdmsProperty>>;

  void note(std::size_t which, const std::string& name, std::optional<TdmsProperty> old);
  void settle(std::size_t which, const Before& before, std::uint64_t at);
  /// What of `before` differs from what is stated now.
  static std::vector<Change> changes(const TdmsObject& object, const Before& before);
  /// Takes out of `changes` a start that goes on, or without a step means nothing, and puts the
  /// first one back. Returns how much later [s, or as abscissa] another one is than the end of the
  /// samples so far.
  std::optional<double> settle_start(TdmsObject& object, std::vector<Change>& changes);
  /// Takes starts and intervals out of `changes` and puts the first ones back.
  void join(std::size_t which, std::vector<Change>& changes);
  void cut(TdmsObject& object, const std::vector<Change>& changes, std::optional<double> gap,
           std::uint64_t at);
  static void put_back(TdmsObject& object, const Change& change);
  static std::string text(const TdmsObject& object, const std::vector<Change>& changes);
  void tell(const TdmsObject& object, const std::string& sentence);

  const MappedFile& file_;
  std::vector<TdmsObject>& objects_;
  bool joins_;
  std::map<std::size_t, std::uint64_t> joined_;  ///< segments, by object
  bool may_join_ = false;                        ///< where parts differ in start or interval alone
  std::size_t segment_ = 0;                      ///< the one at hand, from 1
  bool any_data_ = false;
  std::map<std::size_t, Before> pending_;  ///< by object: what held for its samples so far
  std::uint64_t steps_ = 0;
  std::uint64_t copied_ = 0;                 ///< properties
  std::vector<std::string> sentences_;       ///< in their order
  std::map<std::string, std::string> told_;  ///< names of channels, by sentence
  std::uint64_t untold_ = 0;                 ///< changes
};

}  // namespace impactrig::acquisition
