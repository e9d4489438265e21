// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "acquisition/importer.hpp"
#include "acquisition/importers/mapped_file.hpp"
#include "acquisition/importers/wave_chunks.hpp"
#include "tests/acquisition/sndfile_bytes.hpp"
#include "tests/acquisition/wav_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using tests::import_error;
using tests::imported;
using tests::WavFile;

const std::string calibrate =
    "a WAVE file holds no physical units: samples are parts of full scale; a map says what full "
    "scale is (import --map, full_scale = \"10 V\")";

class Wav : public testing::TestWithParam<bool> {
 protected:
  Wav() { wav.big_endian = GetParam(); }

  std::vector<double> values() const { return imported(wav.bytes()).channels.at(0).values(); }

  WavFile wav;
};

INSTANTIATE_TEST_SUITE_P(ByteOrder, Wav, testing::Bool(),
                         [](const auto& instance) { return instance.param ? "Big" : "Little"; });

TEST_P(Wav, EveryTypeOfNumberIsRead) {
  wav.data = wav.numbers<std::int16_t>({16384, -32768, 1});
  EXPECT_THAT(values(), ElementsAre(0.5, -1, 1.0 / 32768));
  EXPECT_TRUE(
      std::holds_alternative<std::vector<std::int16_t>>(imported(wav.bytes()).channels[0].raw));
  wav.bits = 8;
  wav.data = std::string("\x80\xC0\x00\xFF", 4);
  EXPECT_THAT(values(), ElementsAre(0, 0.5, -1, 127.0 / 128));
  wav.bits = 24;
  wav.data = GetParam() ? std::string("\x40\0\0\x80\0\0\0\0\1", 9)
                        : std::string("\0\0\x40\0\0\x80\1\0\0", 9);
  EXPECT_THAT(values(), ElementsAre(0.5, -1, 1.0 / 8388608));
  wav.bits = 32;
  wav.data = wav.numbers<std::int32_t>({1 << 30, -2147483647 - 1, 1});
  EXPECT_THAT(values(), ElementsAre(0.5, -1, 1.0 / 2147483648.0));
  wav.format = 3;
  wav.data = wav.numbers<float>({0.5F, -1.5F});
  EXPECT_THAT(values(), ElementsAre(0.5, -1.5));
  wav.bits = 64;
  wav.data = wav.numbers<double>({0.1, -3e300});
  EXPECT_THAT(values(), ElementsAre(0.1, -3e300));
}

TEST_P(Wav, ExtensibleFormatsNameTheirCodingWithin) {
  wav.format = 0xFFFE;
  wav.data = wav.numbers<std::int16_t>({16384, -32768});
  EXPECT_THAT(values(), ElementsAre(0.5, -1));
}

// Libsndfile reads none of them.
TEST_P(Wav, IntegersOf64BitsAreRead) {
  wav.bits = 64;
  wav.channels = 2;
  const std::int64_t half = std::int64_t{1} << 62;
  wav.data = wav.numbers<std::int64_t>({half, 1, -2 * half, -half});
  for (const std::uint16_t format : {std::uint16_t{1}, std::uint16_t{0xFFFE}}) {
    wav.format = format;
    const auto record = imported(wav.bytes());
    EXPECT_THAT(record.channels.at(0).values(), ElementsAre(0.5, -1));
    EXPECT_THAT(record.channels.at(1).values(), ElementsAre(0x1p-63, -0.5));
    EXPECT_EQ(record.channels[1].clock.interval, 1.0 / 8000);
    EXPECT_EQ(record.attributes.at("coding"), "PCM, 64 bits");
  }
  wav.bits = 48;
  wav.format = 1;
  EXPECT_EQ(import_error(wav.bytes()),
            "FILE (byte 0): the header states 48 bits a sample; integers of up to 32 and of 64 "
            "bits are read: save it as one of these or as floating point");
}

TEST_P(Wav, ChannelsHaveRateUnitAndAWarning) {
  wav.channels = 2;
  wav.rate = 44100;
  wav.data = wav.numbers<std::int16_t>({16384, -16384, 8192, -8192});
  wav.more_chunks = wav.chunk("LIST", "INFO" + wav.chunk("INAM", "run 7"));
  const auto record = imported(wav.bytes());
  ASSERT_EQ(record.channels.size(), 2U);
  EXPECT_EQ(record.channels[1].name, "ch2");
  EXPECT_EQ(record.channels[1].unit, "FS (full scale = 1.0)");
  EXPECT_THAT(record.channels[1].values(), ElementsAre(-0.5, -0.25));
  EXPECT_EQ(record.channels[1].clock.interval, 1.0 / 44100);
  EXPECT_EQ(record.attributes.at("coding"), "PCM, 16 bits");
  EXPECT_EQ(record.title, "run 7");
  EXPECT_THAT(record.warnings, ElementsAre(calibrate));
}

TEST_P(Wav, AWindowOfAChannelIsThatPartOfTheWhole) {
  wav.channels = 3;
  std::vector<std::int32_t> samples;
  for (std::int32_t i = 0; i < 3 * 70000; ++i) samples.push_back(i * 1000);
  wav.bits = 32;
  wav.data = wav.numbers(samples);
  ImportOptions options;
  options.channels = {"ch2"};
  options.from = 60000.0 / 8000.0;
  const auto whole = imported(wav.bytes());
  const auto part = imported(wav.bytes(), options);
  ASSERT_EQ(part.channels.size(), 1U);
  ASSERT_EQ(part.channels[0].size(), 10000U);
  EXPECT_EQ(part.channels[0].clock.start, 7.5);
  for (const std::size_t i : {std::size_t{0}, std::size_t{9999}})
    EXPECT_EQ(part.channels[0].value(i), whole.channels[1].value(60000 + i));
}

// libsndfile 1.2.0 reads such a list for minutes; found by fuzzing.
TEST_P(Wav, DamagedListsAreLeftOut) {
  wav.data = wav.numbers<std::int16_t>({16384, -16384});
  wav.more_chunks = wav.chunk("LIST", std::string(85, '\xFF') + "\x10INFO(NAM\0\0\0\4name");
  const auto record = imported(wav.bytes());
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(0.5, -0.5));
  EXPECT_THAT(record.warnings,
              ElementsAre("the list at byte 36 is damaged, its parts do not fit into it: it is "
                          "left out",
                          calibrate));
}

TEST_P(Wav, CutFilesGiveWhatIsThere) {
  wav.data = wav.numbers<std::int16_t>({16384, -16384, 8192, -8192});
  const std::string bytes = wav.bytes();
  const auto record = imported(bytes.substr(0, bytes.size() - 4));
  EXPECT_THAT(record.channels[0].values(), ElementsAre(0.5, -0.5));
  EXPECT_THAT(
      record.warnings,
      ElementsAre("the file is cut: its header declares 52 bytes, 48 are there", calibrate));
  // a size of the whole that is too small: that of the samples tells
  std::string counted_short = bytes;
  counted_short.replace(4, 4, wav.number<std::uint32_t>(40));
  EXPECT_THAT(
      imported(counted_short.substr(0, bytes.size() - 1)).warnings,
      ElementsAre("the file is cut: its header declares 52 bytes, 51 are there", calibrate));
}

// As recorders leave it that lose their power.
TEST_P(Wav, SamplesThatTheHeaderDoesNotCountAreRead) {
  wav.data = wav.numbers<std::int16_t>({16384, -16384, 0, 8192});
  std::string bytes = wav.bytes();
  const std::size_t size = bytes.find("data") + 4;
  bytes.replace(size, 4, 4, '\0');
  const auto record = imported(bytes);
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(0.5, -0.5, 0.0, 0.25));
  EXPECT_THAT(record.warnings,
              ElementsAre("the header says that there are no samples, as of a recorder that was "
                          "stopped: the 8 bytes behind it are read as samples",
                          calibrate));
  // silence looks like chunks without a name
  wav.data = std::string(64, '\0');
  bytes = wav.bytes();
  bytes.replace(size, 4, 4, '\0');
  EXPECT_EQ(imported(bytes).channels.at(0).size(), 32U);
  // chunks are no samples
  wav.data.clear();
  bytes = wav.bytes() + wav.chunk("LIST", "INFO" + wav.chunk("INAM", "run 7"));
  EXPECT_EQ(imported(bytes).channels.at(0).size(), 0U);
}

/// Bytes of a file whose head states other sizes of the file and of the samples.
std::string with_sizes(const WavFile& wav, std::uint32_t file, std::uint32_t samples) {
  std::string bytes = wav.bytes();
  bytes.replace(4, 4, wav.number(file));
  return bytes.replace(bytes.find("data") + 4, 4, wav.number(samples));
}

// As recorders leave it that update the header now and then and lose their power between.
TEST_P(Wav, SamplesBehindThoseThatTheHeaderCountsAreRead) {
  wav.data = wav.numbers<std::int16_t>({16384, -16384, 0, 8192, 1, -1, 2, -2});
  const std::string stale = with_sizes(wav, 40, 4);
  const auto record = imported(stale);
  EXPECT_EQ(record.channels.at(0).size(), 8U);
  EXPECT_THAT(record.warnings,
              ElementsAre("the header counts 4 bytes of samples and declares a file of 48 bytes, "
                          "but no chunk follows them and the file has 60, as of a recorder that "
                          "lost its power or a file of more than 4 GiB: 16 bytes are read as "
                          "samples",
                          calibrate));
  // a list that ends the file is none of them
  const std::string title = wav.chunk("LIST", "INFO" + wav.chunk("INAM", "run 7"));
  EXPECT_EQ(imported(stale + title).channels.at(0).size(), 8U);
  EXPECT_EQ(imported(stale + title).title, "run 7");
}

TEST_P(Wav, WhatOthersPutBehindTheSamplesIsNotReadAsSamples) {
  wav.data = wav.numbers<std::int16_t>({16384, -16384});
  for (const std::string& behind :
       {std::string(512, '\0'), "TAG" + std::string(125, '\x01'), "ID3" + std::string(20, '\x04'),
        wav.chunk("LIST", "INFO" + wav.chunk("INAM", "run 7")), wav.chunk("abcd", "12345678")})
    EXPECT_THAT(imported(wav.bytes() + behind).channels.at(0).values(), ElementsAre(0.5, -0.5));
  // a header that declares the whole file counts its samples right
  wav.data = wav.numbers<std::int16_t>({16384, -16384, 0, 8192, 1, -1, 2, -2});
  const auto record = imported(with_sizes(wav, 52, 4));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(0.5, -0.5));
  EXPECT_THAT(record.warnings,
              ElementsAre("the 12 bytes behind the 4 bytes of samples are no chunk: they are left "
                          "out",
                          calibrate));
}

TEST_P(Wav, AListBehindSamplesOfUnknownSizeIsNotReadAsSamples) {
  wav.data = wav.numbers<std::int16_t>({16384, -16384, 0, 8192});
  const std::string title = wav.chunk("LIST", "INFO" + wav.chunk("INAM", "run 7"));
  for (const std::uint32_t size : {0U, 0x7FFFFFFFU, 0xFFFFFFFFU}) {
    const auto record = imported(with_sizes(wav, size, size) + title);
    EXPECT_THAT(record.channels.at(0).values(), ElementsAre(0.5, -0.5, 0.0, 0.25)) << size;
    EXPECT_EQ(record.title, "run 7") << size;
  }
}

// Some writers leave out the byte that fills up an odd chunk.
TEST_P(Wav, OddChunksWithoutTheirPadByteArePassedOver) {
  wav.data = wav.numbers<std::int16_t>({16384, -16384, 0, 8192});
  const auto unfilled = [&](const std::string& name, const std::string& content) {
    return name + wav.number(static_cast<std::uint32_t>(content.size())) + content;
  };
  const std::string comment = wav.chunk("LIST", "INFO" + wav.chunk("ICMT", "test data of rig 5"));
  for (const std::string& odd :
       {unfilled("note", "abcde"), unfilled("LIST", "INFO" + unfilled("ISFT", "abcde"))}) {
    wav.more_chunks = odd;
    for (const std::string& behind : {std::string(), comment}) {
      const auto record = imported(wav.bytes() + behind);
      EXPECT_THAT(record.channels.at(0).values(), ElementsAre(0.5, -0.5, 0.0, 0.25));
      EXPECT_THAT(record.warnings, ElementsAre(calibrate));
    }
  }
}

TEST_P(Wav, TextOfACommentIsNotReadAsSamples) {
  wav.data = wav.numbers<std::int16_t>({16384, -16384, 0, 8192});
  wav.more_chunks = std::string(4, '\x01') + std::string(4, '\xFF') + "test data of rig 5, ";
  EXPECT_THAT(imported(wav.bytes()).channels.at(0).values(), ElementsAre(0.5, -0.5, 0.0, 0.25));
}

// The sizes of such a file are those modulo 2^32.
TEST(WavVariants, SamplesBeyond4GiBAreCounted) {
  WavFile wav;
  wav.data = wav.numbers<std::int16_t>({16384, -16384});
  const std::string title = wav.chunk("LIST", "INFO" + wav.chunk("INAM", "run 7"));
  const tests::WrittenFile file(with_sizes(wav, 40, 4), ".wav");
  const std::uint64_t more = std::uint64_t{1} << 32;
  for (const std::string& behind : {std::string(), title}) {
    std::filesystem::resize_file(file.path(), more + 48);  // sparse
    std::ofstream(file.path(), std::ios::binary | std::ios::app) << behind;
    const MappedFile mapped(file.path());
    const WaveChunks chunks = wave_chunks(mapped.bytes());
    EXPECT_EQ(chunks.sample_bytes, more + 4);
    EXPECT_EQ(chunks.texts.size(), behind.empty() ? 0U : 1U);
    EXPECT_THAT(chunks.warnings, ElementsAre(HasSubstr(": 4294967300 bytes are read as samples")));
  }
}

TEST(WavVariants, ExtensibleRf64AndLogarithmicAreRead) {
  WavFile wav;
  wav.data = wav.numbers<std::int16_t>({16384, -32768});
  wav.format = 0xFFFE;
  EXPECT_THAT(imported(wav.bytes()).channels[0].values(), ElementsAre(0.5, -1));
  wav.format = 1;
  wav.rf64 = true;
  EXPECT_THAT(imported(wav.bytes()).channels[0].values(), ElementsAre(0.5, -1));
  wav.rf64 = false;
  wav.format = 7;
  wav.bits = 8;
  wav.data = std::string("\xFF\x80\x00", 3);  // 0, the largest, the smallest of G.711
  EXPECT_THAT(imported(wav.bytes()).channels[0].values(),
              ElementsAre(0, 32124.0 / 32768, -32124.0 / 32768));
}

TEST(WavVariants, WhatIsNotReadSaysSo) {
  WavFile wav;
  wav.format = 2;  // Microsoft ADPCM
  wav.bits = 4;
  wav.data = std::string(256, '\0');
  EXPECT_EQ(
      import_error(wav.bytes()),
      "FILE (byte 0): the samples are coded as Microsoft ADPCM, which loses what a measurement "
      "needs and is not read: save it as PCM or floating point");
  wav.format = 0xFFFE;
  std::string extensible = wav.bytes();
  extensible[extensible.find("fmt ") + 8 + 24] = 0x55;
  EXPECT_THAT(import_error(extensible), HasSubstr("the samples are coded as MPEG layer 3, which"));
  ImportOptions options;
  options.format = "wav";
  EXPECT_EQ(import_error("some text", options),
            "FILE (byte 0): expected 'RIFF', 'RIFX', 'RF64' or 'BW64' and 'WAVE' at byte 8");
  EXPECT_THAT(import_error(std::string("RIFF\4\0\0\0WAVE", 12), options),
              HasSubstr("FILE (byte 0): libsndfile cannot read it: "));
}

// Libsndfile reads them as packed: four samples of three, with other values.
TEST(WavVariants, SamplesOf24BitsInRowsOfFourBytesAreRefused) {
  WavFile wav;
  wav.bits = 24;
  wav.data = wav.numbers<std::int32_t>({0x40000000, -0x40000000, 0x7FFFFF00});
  std::string bytes = wav.bytes();
  bytes[bytes.find("fmt ") + 8 + 12] = 4;
  EXPECT_EQ(import_error(bytes, {}, ".wav"),
            "FILE (byte 0): the header states 24 bits a sample and 1 channel, but rows of 4 bytes: "
            "what fills them is not told; save it as PCM of whole bytes");
  wav.big_endian = true;
  bytes = wav.bytes();
  bytes[bytes.find("fmt ") + 8 + 13] = 4;
  EXPECT_THAT(import_error(bytes, {}, ".wav"), HasSubstr("but rows of 4 bytes"));
}

TEST(WavVariants, WithoutARateOrWithSamplesInTwoChunksAreRefused) {
  for (const bool big_endian : {false, true}) {
    WavFile wav;
    wav.big_endian = big_endian;
    wav.data = wav.numbers<std::int16_t>({1, 2, 3, 4});
    wav.rate = 0;
    EXPECT_EQ(import_error(wav.bytes(), {}, ".wav"),
              "FILE (byte 0): the header states a sample rate of 0 Hz: its writer has to state it");
    wav.rate = 8000;
    EXPECT_EQ(import_error(wav.bytes() + wav.chunk("data", wav.data), {}, ".wav"),
              "FILE (byte 0): the samples are in several chunks 'data', of which a file may have "
              "one: join them");
  }
}

// Found by fuzzing: libsndfile did not come back from this one.
TEST(Wav, AChunkThatIsLongerThanTheFileEndsIt) {
  using namespace std::string_view_literals;
  const std::string bytes =
      std::string(
          "RIFFH\0\0\0WAVEfmt \x10\0\0\0\1\0\2\0\x40\x1f\0\0\x80\xbb\0\0\6\0\x18\0"
          "INFOINA\xd2\4"sv) +
      std::string(35, '\xff') + "\xdf\xff\xff\xff";
  EXPECT_THAT(import_error(bytes, {}, ".wav"),
              testing::StartsWith("FILE (byte 0): libsndfile cannot read it: "));
}

// A chunk "INFO" of its own libsndfile 1.2.0 takes for a list, and reads this one for minutes;
// found by fuzzing. The format is damaged as well.
TEST_P(Wav, AListInAnothersPlaceDoesNotKeepTheReaderBusy) {
  const std::string format = wav.number<std::uint16_t>(1) + wav.number<std::uint16_t>(2) +
                             wav.number<std::uint32_t>(4154) + "LIST" +
                             wav.number<std::uint32_t>(0x5E00);
  const std::string body = "WAVE" + wav.chunk("fmt ", format) + "INFOIN" + std::string(85, '\xFF') +
                           std::string("\0\x08\x04nam", 6) + wav.chunk("data", "\1\2\3\4");
  const std::string bytes =
      (GetParam() ? "RIFX" : "RIFF") + wav.number(static_cast<std::uint32_t>(body.size())) + body;
  EXPECT_THAT(import_error(bytes, {}, ".wav"),
              testing::StartsWith("FILE (byte 0): libsndfile cannot read it: "));
}

TEST_P(Wav, SamplesBehindADamagedChunkAreReadWithAWarning) {
  wav.data = wav.numbers<std::int16_t>({16384, -16384});
  for (const std::string& damaged :
       std::vector<std::string>{"cue " + std::string(9, '\x7F'), "INFOIN" + std::string(11, '\xFF'),
                                std::string(21, '\xFF'), std::string(20, '\0') + "\x01"}) {
    wav.more_chunks = damaged;
    const auto record = imported(wav.bytes());
    EXPECT_THAT(record.channels.at(0).values(), ElementsAre(0.5, -0.5)) << damaged;
    const std::string at = std::to_string(36 + damaged.size());
    EXPECT_THAT(record.warnings, testing::Contains(testing::AllOf(
                                     HasSubstr("is damaged: what follows the next word 'data', at "
                                               "byte " +
                                               at + ", is taken for the samples"))))
        << damaged;
  }
}

TEST_P(Wav, WhatFollowsTheSamplesIsReadAsFarAsItIsSound) {
  wav.data = wav.numbers<std::int16_t>({16384, -16384});
  const std::string title = wav.chunk("LIST", "INFO" + wav.chunk("INAM", "run 7"));
  EXPECT_EQ(imported(wav.bytes() + title).title, "run 7");
  const auto record = imported(wav.bytes() + title.substr(0, title.size() - 3));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(0.5, -0.5));
  EXPECT_THAT(record.warnings,
              ElementsAre("the list at byte 48 is damaged, its parts do not fit into it: it is "
                          "left out",
                          calibrate));
}

// Steps of an eighth, which every coding holds; 8 bits and 24 libsndfile decodes.
TEST(Wave64, IsReadAsLibsndfileWritesIt) {
  std::vector<double> samples;
  for (int i = 0; i < 2 * 50000; ++i) samples.push_back((i % 13 - 6) / 8.0);
  for (const int coding : std::vector<int>{SF_FORMAT_PCM_U8, SF_FORMAT_PCM_16, SF_FORMAT_PCM_24,
                                           SF_FORMAT_PCM_32, SF_FORMAT_FLOAT, SF_FORMAT_DOUBLE}) {
    SCOPED_TRACE(coding);
    const std::string bytes = tests::sound_file(SF_FORMAT_W64 | coding, 2, 51200, samples);
    const auto record = imported(bytes);
    EXPECT_EQ(record.provenance.importer, "wav");
    EXPECT_THAT(record.warnings, ElementsAre(calibrate));
    ASSERT_EQ(record.channels.size(), 2U);
    EXPECT_EQ(record.channels[1].clock.interval, 1.0 / 51200);
    ASSERT_EQ(record.channels[1].size(), 50000U);
    for (std::size_t i = 0; i < 50000; ++i)
      ASSERT_EQ(record.channels[1].value(i), samples[2 * i + 1]) << i;
    ImportOptions options;
    options.channels = {"ch1"};
    options.from = 40000 / 51200.0;
    const auto part = imported(bytes, options);
    ASSERT_EQ(part.channels.at(0).size(), 10000U);
    EXPECT_EQ(part.channels[0].value(9999), samples[2 * 49999]);
  }
}

TEST(Wave64, CutAndStoppedFilesGiveWhatIsThere) {
  const std::string whole =
      tests::sound_file(SF_FORMAT_W64 | SF_FORMAT_PCM_16, 1, 8000, {0.5, -1, 0, 0.25});
  const auto cut = imported(whole.substr(0, whole.size() - 4));
  EXPECT_THAT(cut.channels.at(0).values(), ElementsAre(0.5, -1));
  EXPECT_THAT(cut.warnings,
              ElementsAre(fmt::format("the file is cut: its header declares {} bytes, {} are there",
                                      whole.size(), whole.size() - 4),
                          calibrate));
  const std::string empty = tests::sound_file(SF_FORMAT_W64 | SF_FORMAT_PCM_16, 1, 8000, {});
  EXPECT_EQ(imported(empty).channels.at(0).size(), 0U);
  const auto stopped = imported(empty + whole.substr(whole.size() - 8));
  EXPECT_THAT(stopped.channels.at(0).values(), ElementsAre(0.5, -1, 0, 0.25));
  EXPECT_THAT(stopped.warnings,
              ElementsAre("the header says that there are no samples, as of a recorder that was "
                          "stopped: the 8 bytes behind it are read as samples",
                          calibrate));
}

// Nothing behind their end is looked at.
TEST(WaveChunks, OfWhatIsNoWaveFileThereAreNone) {
  const std::string_view behind("RIFF\x7F\x7F\x7F\x7FWAVEdata\4\0\0\0abcd", 24);
  for (std::size_t size = 0; size < 12; ++size) {
    const WaveChunks chunks = wave_chunks(behind.substr(0, size));
    EXPECT_EQ(chunks.declared_bytes, 0U);
    EXPECT_EQ(chunks.data_chunks, 0);
  }
}

TEST(WavVariants, Bw64IsReadAsRf64) {
  WavFile wav;
  wav.rf64 = true;
  wav.data = wav.numbers<std::int16_t>({16384, -32768});
  const std::string bytes = "BW64" + wav.bytes().substr(4);
  const auto record = imported(bytes);
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(0.5, -1));
  EXPECT_EQ(record.provenance.importer, "wav");
  EXPECT_EQ(record.warnings, imported(wav.bytes()).warnings);
}

TEST(WavVariants, Rf64ThatIsCutIsTold) {
  WavFile wav;
  wav.rf64 = true;
  wav.data = wav.numbers<std::int16_t>({16384, -32768, 0, 8192});
  const std::string whole = wav.bytes(), bytes = whole.substr(0, whole.size() - 4);
  EXPECT_THAT(imported(whole).warnings,
              testing::Not(testing::Contains(HasSubstr("the file is cut"))));
  const auto record = imported(bytes);
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(0.5, -1));
  EXPECT_THAT(record.warnings, testing::Contains(HasSubstr(fmt::format(
                                   "the file is cut: its header declares {} bytes, {} are "
                                   "there",
                                   whole.size(), bytes.size()))));
}

TEST(WavVariants, Rf64WhoseRecorderWasStoppedIsRead) {
  WavFile wav;
  wav.rf64 = true;
  wav.data = wav.numbers<std::int16_t>({16384, -32768, 0, 8192});
  wav.more_chunks = wav.chunk("LIST", "INFO" + wav.chunk("INAM", "run 7"));
  std::string bytes = wav.bytes();
  EXPECT_EQ(imported(bytes).title, "run 7");
  bytes.replace(bytes.find("ds64") + 16, 8, 8, '\0');
  const auto record = imported(bytes);
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(0.5, -1, 0, 0.25));
  EXPECT_THAT(record.warnings.at(0), HasSubstr("the 8 bytes behind it are read as samples"));
}

}  // namespace
}  // namespace impactrig::acquisition
