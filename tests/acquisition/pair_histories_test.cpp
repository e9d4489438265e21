// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/pair_histories.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "datasets/input_error.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Channel;
using datasets::Quantity;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Channel force(std::vector<double> values, double start = 0.0, double interval = 1.0,
              const std::string& unit = "N") {
  Channel channel;
  channel.name = "Force";
  channel.unit = unit;
  channel.quantity = datasets::quantity_of_unit(unit);
  channel.clock = {.start = start, .interval = interval, .times = {}};
  channel.raw = std::move(values);
  return channel;
}

Channel at_times(std::vector<double> values, std::vector<double> times) {
  Channel channel = force(std::move(values));
  channel.clock.start = times.front();
  channel.clock.interval = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  channel.clock.times = std::move(times);
  return channel;
}

PairedHistories paired(const Channel& measured, const Channel& predicted,
                       const PairingOptions& options = {}) {
  return pair_histories({measured, "m.h5"}, {predicted, "p.h5"}, options);
}

std::string complaint(const Channel& measured, const Channel& predicted,
                      const PairingOptions& options = {}) {
  try {
    paired(measured, predicted, options);
  } catch (const datasets::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(PairHistories, LeavesOneClockAlone) {
  const PairedHistories pair = paired(force({1, 2, 3}, 5.0), force({4, 5, 6}, 5.0));
  EXPECT_EQ(pair.unit, "N");
  EXPECT_EQ(pair.start, 5.0);
  EXPECT_EQ(pair.end(), 7.0);
  EXPECT_THAT(pair.measured, ElementsAre(1, 2, 3));
  EXPECT_THAT(pair.predicted, ElementsAre(4, 5, 6));
  EXPECT_FALSE(pair.measured_resampled || pair.predicted_resampled);
  EXPECT_THAT(pair.notes, IsEmpty());
}

// 0.1 + 0.2 is not 0.3: clocks that differ by rounding show the same instants, and values stay.
TEST(PairHistories, DoesNotResampleForRounding) {
  const Channel shifted = force({0, 10, 20, 30, 40}, -0.1, 0.1 * (1.0 + 1e-13));
  const PairedHistories pair = paired(force({1, 2, 3}, 0.1 + 0.2 - 0.3, 0.1), shifted);
  EXPECT_FALSE(pair.predicted_resampled);
  EXPECT_THAT(pair.predicted, ElementsAre(10, 20, 30));
}

TEST(PairHistories, ComparesWhereBothAreAndSaysSo) {
  const PairedHistories pair =
      paired(force({0, 1, 2, 3, 4, 5}), force({10, 20, 30}, 2.0), {.to = 3.0});
  EXPECT_EQ(pair.start, 2.0);
  EXPECT_THAT(pair.measured, ElementsAre(2, 3));
  EXPECT_THAT(pair.predicted, ElementsAre(10, 20));
  EXPECT_THAT(pair.notes, ElementsAre("m.h5: 'Force' is compared from 2 s to 3 s only, where p.h5 "
                                      "has sound samples (2 s to 4 s)"));
}

TEST(PairHistories, MovesThePrediction) {
  const PairedHistories pair = paired(force({0, 1, 2, 3}), force({7, 8, 9}), {.shift = 1.0});
  EXPECT_EQ(pair.start, 1.0);
  EXPECT_THAT(pair.measured, ElementsAre(1, 2, 3));
  EXPECT_THAT(pair.predicted, ElementsAre(7, 8, 9));
  EXPECT_FALSE(pair.predicted_resampled);
}

TEST(PairHistories, ResamplesByStraightLinesAndSaysSo) {
  const PairedHistories between = paired(force({0, 0, 0}), force({10, 20, 30, 50}, -0.25));
  EXPECT_THAT(between.predicted, ElementsAre(12.5, 22.5, 35));
  EXPECT_TRUE(between.predicted_resampled);
  EXPECT_FALSE(between.measured_resampled);
  EXPECT_THAT(between.notes,
              ElementsAre("p.h5: 'Force' was resampled by straight lines to 3 instants 1 s apart; "
                          "its own lie -0.25 s beside them"));
  const PairedHistories coarse = paired(force({0, 0, 0, 0, 0}), force({0, 4, 0}, 0.0, 2.0));
  EXPECT_THAT(coarse.predicted, ElementsAre(0, 2, 4, 2, 0));
  EXPECT_THAT(coarse.notes[0], HasSubstr("its own step is 2 s"));
  const PairedHistories fine = paired(force({0, 0}), force({0, 9, 4}, 0.0, 0.5));
  EXPECT_THAT(fine.predicted, ElementsAre(0, 4));
  EXPECT_THAT(fine.notes[0], HasSubstr("folded back unless it was filtered"));
}

TEST(PairHistories, GivesUnevenTimesAUniformRun) {
  const Channel measured = at_times({0, 1, 4, 6}, {0, 0.5, 2, 3});
  const PairedHistories pair = paired(measured, force({0, 20, 40, 60, 80}));
  EXPECT_TRUE(pair.measured_resampled);
  EXPECT_FALSE(pair.predicted_resampled);  // the mean step is 1
  EXPECT_THAT(pair.measured, ElementsAre(0, 2, 4, 6));
  EXPECT_THAT(pair.predicted, ElementsAre(0, 20, 40, 60));
  EXPECT_THAT(pair.notes,
              ElementsAre("m.h5: 'Force' was resampled by straight lines to 4 instants 1 s apart; "
                          "its own steps are uneven, 1 s on average"));
}

TEST(PairHistories, BridgesWhatIsNotSoundWithinAndCutsItAtTheEnds) {
  std::vector<double> values(24);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(i);
  const Channel measured = force(values);
  values[0] = values[23] = nan;
  values[10] = 1e9;
  Channel predicted = force(values);
  predicted.valid.assign(values.size(), 1);
  predicted.valid[10] = 0;
  const PairedHistories pair = paired(measured, predicted);
  EXPECT_EQ(pair.start, 1.0);
  EXPECT_EQ(pair.predicted, pair.measured);
  EXPECT_EQ(pair.predicted.size(), 22U);
  EXPECT_EQ(pair.predicted_bridged, 1U);
  EXPECT_EQ(pair.measured_bridged, 0U);
  EXPECT_THAT(pair.notes, ElementsAre("p.h5: 1 of the samples of 'Force' is not sound (missing, "
                                      "clipped or not finite) and was bridged by straight lines"));
  EXPECT_EQ(
      complaint(measured, force({0, nan, 2, 3, 4})),
      "p.h5: channel 'Force' is not sound at 1 of the 5 samples compared, too many to bridge; "
      "choose a window without them (--from, --to)");
}

TEST(PairHistories, ConvertsUnits) {
  PairedHistories pair = paired(force({1, 2}, 0, 1, "kN"), force({1000, 3000}));
  EXPECT_EQ(pair.unit, "N");
  EXPECT_THAT(pair.measured, ElementsAre(1000, 2000));
  EXPECT_THAT(pair.predicted, ElementsAre(1000, 3000));
  pair = paired(force({1, 2}, 0, 1, ""), force({1, 3}, 0, 1, ""));
  EXPECT_EQ(pair.unit, "");
  pair = paired(force({1, 2}, 0, 1, "N m"), force({1000, 3000}, 0, 1, "N mm"));
  EXPECT_EQ(pair.unit, "N m");
  EXPECT_THAT(pair.predicted, ElementsAre(1, 3));
  pair = paired(force({20, 21}, 0, 1, "degC"), force({293.15, 294.15}, 0, 1, "K"));
  EXPECT_EQ(pair.unit, "degC");  // 273 K on both sides would make any prediction look good
  EXPECT_NEAR(pair.predicted[1], 21.0, 1e-12);
}

TEST(PairHistories, RefusesWhatCannotBePaired) {
  const Channel two = force({1, 2});
  EXPECT_EQ(complaint(two, force({1, 2}, 0, 1, "V")),
            "p.h5: channel 'Force' is in 'V', the measured 'Force' in 'N', and one cannot be "
            "converted into the other; state the sensors' sensitivities (--rig), compare other "
            "channels (--channel, --predicted-channel), or state the units of a text (--units, "
            "--predicted-units)");
  EXPECT_THAT(complaint(two, force({1, 2}, 0, 1, "")), HasSubstr("is without a unit"));
  EXPECT_EQ(
      complaint(two, force({1, 2}, 7.0)),
      "p.h5: 'Force' from 7 s to 8 s and the measured 'Force' of m.h5 from 0 s to 1 s have no "
      "instants in common; if they count their times from different events, --shift moves "
      "the predicted history");
  EXPECT_THAT(complaint(two, force({1, 2}, 1.0)), HasSubstr("have too few instants in common;"));
  EXPECT_THAT(complaint(two, two, {.from = 0.5}),
              HasSubstr("have too few instants in common within the window;"));
  EXPECT_EQ(complaint(two, force({1, 2}, 0.0, 0.0)),
            "p.h5: channel 'Force' has no times; state the sample rate (--sample-rate, "
            "--predicted-sample-rate)");
  EXPECT_EQ(complaint(force({}), two),
            "m.h5: channel 'Force' has no samples; choose another channel");
  EXPECT_EQ(complaint(force({nan, nan}), two),
            "m.h5: channel 'Force' has no sound sample; choose another channel");
  EXPECT_EQ(complaint(two, at_times({1, 2, 3}, {0, 2, 1})),
            "p.h5: channel 'Force' has times that do not increase: 1 s after 2 s at sample 2");
  Channel complex = two;
  complex.imaginary = {0, 0};
  EXPECT_EQ(complaint(two, complex),
            "p.h5: channel 'Force' holds complex numbers, so it is a spectrum; choose a channel "
            "that is a time history");
  Channel spectrum = two;
  spectrum.attributes["domain"] = "frequency";
  EXPECT_EQ(complaint(spectrum, two),
            "m.h5: channel 'Force' is over frequency, not over time; choose a channel that is a "
            "time history");
}

}  // namespace
}  // namespace impactrig::acquisition
