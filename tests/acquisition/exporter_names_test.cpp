// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "acquisition/exporter.hpp"
#include "tests/acquisition/exported.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Record;
using testing::ElementsAre;
using testing::IsEmpty;
using tests::example;
using tests::export_warnings;
using tests::OutputPath;
using tests::round_trip;

using Names = std::vector<std::string>;

/// Channels of these names; the first one's samples count, the others' fall.
Record named(const Names& names, const std::string& unit = "N", bool with_clock = true) {
  Record record;
  for (const std::string& name : names) {
    datasets::Channel channel;
    channel.name = name;
    channel.unit = unit;
    channel.quantity = datasets::quantity_of_unit(unit);
    if (with_clock) channel.clock = {-1e-3, 1e-6, {}};
    std::vector<double> samples(20);
    for (std::size_t i = 0; i < samples.size(); ++i)
      samples[i] = static_cast<double>(i) * (record.channels.empty() ? 1.0 : -0.5);
    channel.raw = std::move(samples);
    record.channels.push_back(std::move(channel));
  }
  return record;
}

Names names_of(const Record& record) {
  Names names;
  for (const datasets::Channel& channel : record.channels) names.push_back(channel.name);
  return names;
}

std::vector<Names> plain_names() {
  return {{"Kraft \xC3\xA4 \xC2\xB5 \xF0\x9F\x94\xA8", "none"},
          {"F [V]", "F (V)"},
          {"F / V", "a;b"},
          {"# a", "100 %"},
          {"time", "t"},
          {"it's", "'"},
          {"a,b", "nan"},
          {"same", "same"},
          {"Same", "same"},
          {"force_N", "column 1"},
          {std::string(80, 'x'), "end"}};
}

std::vector<Names> hard_names() {
  return {{"NONE", "other"},
          {" force", "force "},
          {"  ", "other"},
          {"", ""},
          {"two\nlines", "two\rlines"},
          {"tab\tstop", "other"},
          {"say \"hit\"", "other"},
          {"1", "2"},
          {"-1", "    -1"},
          {"other", "Time B"},
          {"index", "\xEF\xBB\xBFx"},
          {"Signal:", "X_Value"},
          {std::string(81, 'x'), std::string(5000, 'y')}};
}

class ExportedNames : public testing::TestWithParam<const char*> {};

TEST_P(ExportedNames, StayWhateverTheFormat) {
  for (const Names& names : plain_names()) {
    const Record record = named(names);
    EXPECT_EQ(names_of(round_trip(record, GetParam())), names);
    EXPECT_THAT(export_warnings(record, GetParam()), IsEmpty()) << names.front();
  }
}

TEST_P(ExportedNames, AreKeptOrToldOf) {
  for (const Names& names : hard_names()) {
    for (const Record& record : {named(names), named(names, "s"), named(names, "N", false)}) {
      SCOPED_TRACE(testing::PrintToString(names).substr(0, 60) + record.channels[0].unit);
      try {
        if (!export_warnings(record, GetParam()).empty()) continue;
      } catch (const datasets::FileError&) {
        continue;
      }
      EXPECT_EQ(names_of(round_trip(record, GetParam())), names);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, ExportedNames,
                         testing::Values(".uff", ".unv", ".csv", ".h5", ".mat"));

TEST(ExportedNames, StayInHdf5AndMatWithLineBreaksAndTabs) {
  for (const char* ending : {".h5", ".mat"})
    for (const Names& names : hard_names()) {
      const Record record = named(names);
      EXPECT_EQ(names_of(round_trip(record, ending)), names) << ending;
      EXPECT_THAT(export_warnings(record, ending), IsEmpty());
    }
}

TEST(ExportedNames, ThatAFormatCannotHoldAreListed) {
  EXPECT_THAT(export_warnings(named({"NONE", "f", " a", "", "    -1"}), ".unv"),
              ElementsAre("the file does not give back every name as it is: 'NONE' as 'force', ' "
                          "a' as 'a', '' as 'force' and 1 more; a .h5 file keeps everything"));
  EXPECT_THAT(export_warnings(named({"f"}, " N"), ".uff"),
              ElementsAre("the file does not give back every unit as it is: ' N' as 'N'; a .h5 "
                          "file keeps everything"));
}

// A name that the dataset would have taken for its end.
TEST(ExportedNames, AreNoDelimiterOfAUniversalFile) {
  const OutputPath path(".unv");
  export_recording(named({"    -1"}), path);
  const std::string bytes = tests::bytes_of(path);
  EXPECT_EQ(bytes.substr(0, 20), "    -1\n    58\n-1\nNON");
}

// The head says which column is the time: what looks like times or counts samples is a channel.
TEST(ExportedNames, OfTimesAndCountersInATableAreKept) {
  for (const bool with_clock : {false, true})
    for (const char* unit : {"s", "N", ""})
      for (const Names& names : {Names{"Time B", "f"}, Names{"n", "f"}, Names{"f", "time"}}) {
        const Record record = named(names, unit, with_clock);
        EXPECT_EQ(names_of(round_trip(record, ".csv")), names) << unit << with_clock;
        EXPECT_THAT(export_warnings(record, ".csv"), IsEmpty());
      }
}

TEST(Export, OfNoChannelsIsRefusedWhereTheFileWouldBeEmpty) {
  for (const char* ending : {".uff", ".unv", ".csv"})
    EXPECT_EQ(tests::export_error(Record{}, ending), "OUT: the recording has no channels to write");
}

}  // namespace
}  // namespace impactrig::acquisition
