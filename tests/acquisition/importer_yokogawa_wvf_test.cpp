// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cstdint>

#include "acquisition/importer.hpp"
#include "tests/acquisition/bytes.hpp"
#include "tests/acquisition/written_file.hpp"
#include "tests/acquisition/yokogawa_bytes.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Record;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::names_and_units;
using tests::yokogawa_head;

std::string words(const std::vector<std::int16_t>& numbers, bool big_endian = false) {
  return tests::bytes_of_numbers(numbers, big_endian);
}

Record imported_with(const std::string& head, const std::string& samples) {
  const tests::WrittenFile beside(samples, ".wvf");
  const tests::WrittenFile file(head, ".hdr");
  return import_recording(file.path(), {});
}

std::string error_with(const std::string& head, const std::string& samples) {
  const tests::WrittenFile beside(samples, ".wvf");
  return tests::import_error(head, {}, ".hdr");
}

TEST(YokogawaWvf, ScalesSamplesAndMarksThoseBeyondTheRange) {
  const Record record = imported_with(yokogawa_head(), words({1, 100, -3, 7, 20}));
  EXPECT_EQ(record.provenance.importer, "yokogawa-wvf");
  EXPECT_THAT(names_and_units(record), ElementsAre("CH 1 [V]", "Hammer [N]"));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(-0.5, 49.0, -2.5));
  EXPECT_THAT(record.channels[0].valid, ElementsAre(1, 0, 1));
  EXPECT_THAT(record.channels[1].values(), ElementsAre(14, 40));
  EXPECT_THAT(record.channels[1].valid, ElementsAre(0, 1));
  EXPECT_DOUBLE_EQ(record.channels[0].clock.start, -2e-4);
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 1e-4);
  EXPECT_DOUBLE_EQ(record.channels[1].clock.interval, 1e-3);
  EXPECT_EQ(record.started, "2016-01-22T16:27:26");
  EXPECT_EQ(record.attributes.at("Model"), "WE7273");
  EXPECT_THAT(
      record.warnings,
      ElementsAre("'CH 1': 1 sample is beyond the input's range or missing; marked as not "
                  "valid",
                  "'Hammer': 1 sample is beyond the input's range or missing; marked as not "
                  "valid"));
}

// two traces of three and two samples, two blocks each
TEST(YokogawaWvf, BlocksFollowEachOtherByTraceOrByBlock) {
  const auto check = [](const Record& record) {
    EXPECT_THAT(names_and_units(record), ElementsAre("CH 1, block 1 [V]", "CH 1, block 2 [V]",
                                                     "Hammer, block 1 [N]", "Hammer, block 2 [N]"));
    EXPECT_THAT(record.channels.at(0).values(), ElementsAre(-0.5, 0, 0.5));
    EXPECT_THAT(record.channels[1].values(), ElementsAre(4, 4.5, 5));
    EXPECT_THAT(record.channels[2].values(), ElementsAre(2, 4));
    EXPECT_THAT(record.channels[3].values(), ElementsAre(6, 8));
    EXPECT_THAT(record.warnings, IsEmpty());
  };
  check(imported_with(yokogawa_head("Block", "Ltl", 2), words({1, 2, 3, 1, 2, 10, 11, 12, 3, 4})));
  check(imported_with(yokogawa_head("TRACE", "Big", 2, "IS2", "2"),
                      words({99, 1, 2, 3, 10, 11, 12, 1, 2, 3, 4}, true)));
}

// Two shots may have the same head: what they were is in the samples.
TEST(YokogawaWvf, TracesOfDifferentStartsAreTold) {
  std::string head = yokogawa_head();
  const std::string times = "16:27:26       16:27:26";
  head.replace(head.find(times), times.size(), "16:27:26       16:29:26");
  EXPECT_THAT(imported_with(head, words({1, 2, 3, 4, 5})).warnings,
              ElementsAre("channels were started at different times (the first at "
                          "2016-01-22T16:27:26, another at 2016-01-22T16:29:26): each counts its "
                          "time from its own start"));
}

TEST(YokogawaWvf, HeadAndSamplesAreBothOfTheProvenance) {
  const std::string head = yokogawa_head();
  const std::string samples = words({1, 2, 3, 4, 5});
  const datasets::Provenance provenance = imported_with(head, samples).provenance;
  EXPECT_EQ(provenance.sha256, datasets::sha256_of(head + samples));
  EXPECT_EQ(provenance.bytes, head.size() + samples.size());
  EXPECT_NE(imported_with(head, words({1, 2, 3, 4, 6})).provenance.sha256, provenance.sha256);
}

TEST(YokogawaWvf, SamplesThatDoNotFitTheHeadAreToldOf) {
  const Record cut = imported_with(yokogawa_head(), words({1, 2, 3, 4}));
  EXPECT_EQ(cut.channels.at(1).size(), 1U);
  EXPECT_THAT(cut.warnings, ElementsAre("'Hammer': the file ends after 1 of 2 samples"));
  EXPECT_THAT(imported_with(yokogawa_head(), words({1, 2, 3, 4, 5, 6})).warnings,
              ElementsAre("the file of samples has 2 bytes more than the head describes: they are "
                          "left out"));
}

TEST(YokogawaWvf, ErrorsNameTheLine) {
  EXPECT_THAT(tests::import_error(yokogawa_head(), {}, ".hdr"),
              HasSubstr(".wvf' beside it, which is not there"));
  EXPECT_EQ(error_with(yokogawa_head("Rows"), ""),
            "FILE:7: DataFormat: expected 'trace' or 'block', found 'Rows'");
  EXPECT_EQ(error_with(yokogawa_head("Block", "Ltl", 1, "B16"), ""),
            "FILE:19: VDataType: samples of the type 'B16' are not read: save the waveform as CSV "
            "on the oscilloscope, with its times");
  EXPECT_EQ(error_with(yokogawa_head("Block", "Ltl", 9000), ""),
            "FILE:12: 2 traces of 9000 blocks are more than 10000 channels");
  std::string head = yokogawa_head();
  EXPECT_EQ(error_with(head.replace(head.find("2.0e+000"), 8, "x       "), ""),
            "FILE:17: VResolution: expected a number, found 'x'");
  head = yokogawa_head();
  EXPECT_EQ(error_with(head.replace(head.find("BlockSize"), 9, "BlockSize -"), ""),
            "FILE:16: BlockSize: expected a whole number, found '-'");
  head = yokogawa_head();
  EXPECT_EQ(error_with(head.replace(head.find("$Group1"), 7, "$Other1"), ""),
            "FILE:3: the head describes no traces");
}

}  // namespace
}  // namespace impactrig::acquisition
