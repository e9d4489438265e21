// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "acquisition/importer.hpp"
#include "acquisition/importers/spool.hpp"
#include "acquisition/importers/stored_numbers.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// A moment, whole seconds apart from the rest so that differences keep their digits.
struct LvmMoment {
  std::int64_t seconds = 0;
  double fraction = 0.0;
};

/// [s]
double operator-(const LvmMoment& a, const LvmMoment& b);

/// Whether X values are X_0 + i Delta_X but for the digits they were printed with.
struct LvmDeltaCheck {
  bool agrees = true;
  std::uint64_t count = 0;
  double first = 0.0;
  double first_place = 0.0;

  void see(double x, double place, double delta) {
    if (count == 0) {
      first = x;
      first_place = place;
    }
    const double line = first + delta * static_cast<double>(count++);
    const double rounding = 0.5 * (place + first_place) + 1e-12 * std::abs(x);
    agrees = agrees && std::abs(x - line) <= 1.02 * rounding;
  }
};

/// One channel of one segment.
struct LvmPart {
  std::string name;
  std::string unit;
  std::string y_dimension;
  std::string x_dimension;
  std::string x_unit;
  std::string delta_text;             ///< of Delta_X, as printed
  std::optional<double> x0;           ///< in x_unit
  std::optional<double> delta;        ///< likewise
  double later = 0.0;                 ///< than its segment's date and time, by its own [s]
  std::optional<std::uint64_t> said;  ///< samples the header declares
  NumberList<double> values;
  NumberList<std::uint8_t> invalid;  ///< 1 where a value is missing; empty: all are there
  NumberList<double> x;              ///< one a value; empty: there is no X column
  LvmDeltaCheck check;
  std::uint64_t missing = 0;
  std::uint64_t counted = 0;    ///< samples, where they are counted only and `values` stays empty
  std::uint64_t counted_x = 0;  ///< X values with them

  std::uint64_t samples() const { return counted > 0 ? counted : values.size(); }

  /// From here on numbers are kept in a spool, which must live as long; null: in memory.
  void keep_in(Spool* spool) {
    values = NumberList<double>(spool);
    invalid = NumberList<std::uint8_t>(spool);
    x = NumberList<double>(spool);
  }

  /// No more values come.
  void settle() {
    values.settle();
    invalid.settle();
    x.settle();
  }
};

/// Channels that were recorded together.
struct LvmSegment {
  std::vector<LvmPart> parts;
  std::optional<LvmMoment> moment;
  double shift = 0.0;    ///< what its times lack to those of the first segment [s]
  int first = 1;         ///< number of this segment in the file
  int joined = 1;        ///< how many segments of the file it consists of
  bool comment = false;  ///< its last column has comments
  bool goes_on = false;  ///< only its first rows were read
};

/// What the segments of a LabVIEW measurement file become: segments that go on where the one before
/// ends are joined to it, the others are channels of their own.
class LvmRecording {
 public:
  /// `options` must live as long.
  LvmRecording(std::string path, const ImportOptions& options)
      : path_(std::move(path)),
        options_(options) {}

  /// From here on values are kept on the disk, not in the record's channels.
  void use_spool() { spool_ = std::make_unique<Spool>(path_); }

  Spool* spool() const { return spool_.get(); }  ///< null: there is none

  datasets::Record& record() { return record_; }

  /// Of the finished recording.
  std::unique_ptr<RecordingReader> reader();

  const std::vector<LvmSegment>& segments() const { return segments_; }

  /// Once each, and a hundred of them.
  void warn(std::string text);

  /// An attribute of the record, the first of its name.
  void say(std::string_view key, std::string_view value);

  /// `one_heading`: packets may follow each other within the segment.
  void add(LvmSegment&& segment, bool one_heading);

  /// Makes channels of the segments, once all are there, or, not `whole`, the first ones; `multi`:
  /// each had an X column. Throws datasets::InputError when the user states more units than there
  /// are channels.
  void finish(bool multi, bool whole = true);

 private:
  void check_counts(const LvmSegment& segment, bool one_heading);
  /// What the times of a segment lack to those of the first.
  double shift_of(const LvmSegment& segment) const;
  void tell_of_later_stamp(const LvmSegment& segment, double shift);
  /// To the segment before, when all channels are the same and go on in time.
  void join(LvmSegment&& segment);
  void tell_times_among(const LvmSegment& segment);
  void deliver(LvmSegment& segment, bool multi);
  void set_clock(LvmPart& part, double shift, bool multi, datasets::Channel& channel,
                 StoredChannel& stored);
  /// By the X column alone: X times `factor` are seconds.
  void take_x_column(LvmPart& part, double factor, double shift, bool multi,
                     datasets::Channel& channel, StoredChannel& stored);
  void tell_rate_meant(const LvmPart& part);

  std::string path_;
  const ImportOptions& options_;
  datasets::Record record_;
  std::unique_ptr<Spool> spool_;
  std::vector<LvmSegment> segments_;
  std::vector<StoredChannel> stored_;  ///< of the channels, where there is a spool
};

}  // namespace impactrig::acquisition
