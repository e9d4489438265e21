// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "acquisition/importer.hpp"
#include "tests/acquisition/aiff_bytes.hpp"
#include "tests/acquisition/sndfile_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using testing::ElementsAre;
using tests::AiffFile;
using tests::import_error;
using tests::imported;

const std::string calibrate =
    "an AIFF file holds no physical units: samples are parts of full scale; a map says what full "
    "scale is (import --map, full_scale = \"10 V\")";

// Steps of an eighth, which every coding holds.
TEST(Aiff, IsReadAsLibsndfileWritesIt) {
  std::vector<double> samples;
  for (int i = 0; i < 3 * 50000; ++i) samples.push_back((i % 13 - 6) / 8.0);
  for (const int coding : std::vector<int>{SF_FORMAT_PCM_S8, SF_FORMAT_PCM_U8, SF_FORMAT_PCM_16,
                                           SF_FORMAT_PCM_24, SF_FORMAT_PCM_32, SF_FORMAT_FLOAT,
                                           SF_FORMAT_DOUBLE, SF_FORMAT_PCM_16 | SF_ENDIAN_LITTLE}) {
    SCOPED_TRACE(coding);
    const std::string bytes = tests::sound_file(SF_FORMAT_AIFF | coding, 3, 51200, samples);
    const auto record = imported(bytes);
    EXPECT_EQ(record.provenance.importer, "aiff");
    EXPECT_EQ(record.title, "run 7");
    EXPECT_THAT(record.warnings, ElementsAre(calibrate));
    ASSERT_EQ(record.channels.size(), 3U);
    EXPECT_EQ(record.channels[2].name, "ch3");
    EXPECT_EQ(record.channels[2].unit, "FS (full scale = 1.0)");
    EXPECT_EQ(record.channels[2].clock.interval, 1.0 / 51200);
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < 50000; ++i)
        ASSERT_EQ(record.channels[c].value(i), samples[3 * i + c]) << c << ", " << i;
    ImportOptions options;
    options.channels = {"ch2"};
    options.from = 40000 / 51200.0;
    const auto part = imported(bytes, options);
    ASSERT_EQ(part.channels.size(), 1U);
    ASSERT_EQ(part.channels[0].size(), 10000U);
    EXPECT_EQ(part.channels[0].clock.start, 40000 / 51200.0);
    EXPECT_EQ(part.channels[0].value(9999), samples[3 * 49999 + 1]);
  }
}

TEST(Aiff, SamplesMayBeginBehindAnOffset) {
  AiffFile aiff;
  aiff.bits = 12;  // at the upper end of two bytes
  aiff.frames = 3;
  aiff.offset = 5;
  aiff.rate = 44100.5;
  aiff.data = std::string("\x40\0\x80\0\0\x10", 6);
  const auto record = imported(aiff.bytes());
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(0.5, -1, 1.0 / 2048));
  EXPECT_EQ(record.channels[0].clock.interval, 1.0 / 44100.5);
  EXPECT_EQ(record.attributes.at("coding"), "PCM, 12 bits");
}

TEST(Aiff, CutAndStoppedFilesGiveWhatIsThere) {
  AiffFile aiff;
  aiff.frames = 4;
  aiff.data = std::string("\x40\0\x80\0\0\0\x20\0", 8);
  const std::string whole = aiff.bytes();
  const auto cut = imported(whole.substr(0, whole.size() - 3));
  EXPECT_THAT(cut.channels.at(0).values(), ElementsAre(0.5, -1));
  EXPECT_THAT(cut.warnings,
              ElementsAre("the file is cut: its header declares 4 samples a channel, 2 are there",
                          calibrate));
  aiff.frames = 2;
  EXPECT_THAT(imported(aiff.bytes()).warnings,
              ElementsAre("the file contradicts itself: its header declares 2 samples a channel, "
                          "4 are there",
                          calibrate));
  aiff.frames = 0;
  aiff.data.clear();
  const auto stopped = imported(aiff.bytes() + std::string("\x40\0\x80\0\0", 5));
  EXPECT_THAT(stopped.channels.at(0).values(), ElementsAre(0.5, -1));
  EXPECT_THAT(stopped.warnings,
              ElementsAre("the header says that there are no samples, as of a recorder that was "
                          "stopped: the 5 bytes behind it are read as samples",
                          calibrate));
  EXPECT_EQ(imported(aiff.bytes()).channels.at(0).size(), 0U);
}

TEST(Aiff, WhatIsNotReadIsSaid) {
  AiffFile aiff;
  aiff.coding = "ima4";
  EXPECT_EQ(import_error(aiff.bytes()),
            "FILE (byte 12): the samples are coded as 'ima4', which is not read: save it as PCM or "
            "floating point");
  aiff.coding.clear();
  aiff.bits = 33;
  EXPECT_EQ(import_error(aiff.bytes()),
            "FILE (byte 0): the header states 33 bits a sample; integers of up to 32 bits are "
            "read");
  aiff.channels = 1025;
  EXPECT_EQ(import_error(aiff.bytes()),
            "FILE (byte 12): the header states 1025 channels, up to 1024 are read");
  aiff.channels = 1;
  aiff.rate = 0;
  EXPECT_EQ(import_error(aiff.bytes()),
            "FILE (byte 12): the header states a sample rate of 0 Hz: its writer has to state it");
  EXPECT_EQ(import_error("FORM" + std::string(4, '\0') + "AIFF"),
            "FILE (byte 12): there is no chunk 'COMM', which describes samples");
  EXPECT_EQ(import_error("FORM" + std::string(4, '\0') + "AIFF" + AiffFile::chunk("COMM", "12345")),
            "FILE (byte 12): the chunk 'COMM' has 5 bytes");
  ImportOptions options;
  options.format = "aiff";
  EXPECT_EQ(import_error("FORMxxxxAIFX", options),
            "FILE (byte 0): expected 'FORM', and 'AIFF' or 'AIFC' at byte 8");
  aiff = {};
  aiff.channels = 0;
  EXPECT_THAT(imported(aiff.bytes()).warnings, ElementsAre("the file has no channels"));
}

}  // namespace
}  // namespace impactrig::acquisition
