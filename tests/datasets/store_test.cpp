// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/store.hpp"

#include <gmock/gmock.h>
#include <hdf5.h>
#include <sys/resource.h>
#include <unistd.h>

#include <bit>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <random>
#include <stdexcept>
#include <thread>

#include "datasets/input_error.hpp"
#include "tests/datasets/sample_record.hpp"
#include "tests/datasets/stored_file.hpp"

// HDF5 1.10.8 loses some bytes of its own for every piece of a file whose checksum is wrong.
extern "C" {
const char* __lsan_default_suppressions();
const char* __lsan_default_options();

const char* __lsan_default_suppressions() {
  return "leak:libhdf5";
}

const char* __lsan_default_options() {
  return "print_suppressions=0";
}
}

namespace {

using namespace impactrig::datasets;
using tests::bytes_of;
using tests::record_of;
using tests::sample_record;
using tests::TemporaryFile;
using tests::write_bytes;
using tests::written_and_read;

template <typename Number>
bool same_bits(const std::vector<Number>& a, const std::vector<Number>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Number)) == 0);
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

void expect_same(const Channel& a, const Channel& b) {
  SCOPED_TRACE(a.name);
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.quantity, b.quantity);
  EXPECT_EQ(a.unit, b.unit);
  EXPECT_TRUE(same_bits(a.clock.start, b.clock.start));
  EXPECT_TRUE(same_bits(a.clock.interval, b.clock.interval));
  EXPECT_TRUE(same_bits(a.clock.times, b.clock.times));
  ASSERT_EQ(a.raw.index(), b.raw.index());
  std::visit(
      [&](const auto& samples) {
        EXPECT_TRUE(same_bits(samples, std::get<std::decay_t<decltype(samples)>>(b.raw)));
      },
      a.raw);
  EXPECT_TRUE(same_bits(a.scale, b.scale));
  EXPECT_TRUE(same_bits(a.offset, b.offset));
  EXPECT_TRUE(same_bits(a.imaginary, b.imaginary));
  EXPECT_EQ(a.valid, b.valid);
  ASSERT_EQ(a.calibration.has_value(), b.calibration.has_value());
  if (a.calibration) {
    EXPECT_TRUE(same_bits(a.calibration->sensitivity, b.calibration->sensitivity));
    EXPECT_TRUE(same_bits(a.calibration->uncertainty, b.calibration->uncertainty));
    EXPECT_EQ(a.calibration->recorded_unit, b.calibration->recorded_unit);
    EXPECT_EQ(a.calibration->physical_unit, b.calibration->physical_unit);
    EXPECT_EQ(a.calibration->source, b.calibration->source);
  }
  ASSERT_EQ(a.delay.has_value(), b.delay.has_value());
  if (a.delay) {
    EXPECT_TRUE(same_bits(a.delay->value, b.delay->value));
    EXPECT_TRUE(same_bits(a.delay->uncertainty, b.delay->uncertainty));
    EXPECT_EQ(a.delay->removed, b.delay->removed);
  }
  EXPECT_EQ(a.attributes, b.attributes);
}

void expect_same(const Record& a, const Record& b) {
  EXPECT_EQ(a.title, b.title);
  EXPECT_EQ(a.started, b.started);
  EXPECT_EQ(a.warnings, b.warnings);
  EXPECT_EQ(a.attributes, b.attributes);
  EXPECT_EQ(a.provenance.source_file, b.provenance.source_file);
  EXPECT_EQ(a.provenance.bytes, b.provenance.bytes);
  EXPECT_EQ(a.provenance.sha256, b.provenance.sha256);
  EXPECT_EQ(a.provenance.importer, b.provenance.importer);
  EXPECT_EQ(a.provenance.program, b.provenance.program);
  ASSERT_EQ(a.provenance.edits.size(), b.provenance.edits.size());
  for (std::size_t i = 0; i < a.provenance.edits.size(); ++i) {
    EXPECT_EQ(a.provenance.edits[i].what, b.provenance.edits[i].what);
    EXPECT_EQ(a.provenance.edits[i].channel, b.provenance.edits[i].channel);
    EXPECT_EQ(a.provenance.edits[i].parameters, b.provenance.edits[i].parameters);
  }
  ASSERT_EQ(a.channels.size(), b.channels.size());
  for (std::size_t i = 0; i < a.channels.size(); ++i) expect_same(a.channels[i], b.channels[i]);
}

TEST(Store, KeepsEveryFieldOfARecord) {
  expect_same(sample_record(), written_and_read(sample_record(), "all.h5"));
}

TEST(Store, KeepsAnEmptyRecordAndAnEmptyChannel) {
  expect_same(Record{}, written_and_read(Record{}, "empty.h5"));
  for (const RawSamples& none :
       {RawSamples(std::vector<double>{}), RawSamples(std::vector<float>{}),
        RawSamples(std::vector<std::int16_t>{}), RawSamples(std::vector<std::int32_t>{})})
    expect_same(record_of(none), written_and_read(record_of(none), "none.h5"));
}

TEST(Store, KeepsEveryBitOfEverySampleType) {
  const std::vector<double> doubles{0.0,
                                    -0.0,
                                    5e-324,
                                    -std::numeric_limits<double>::infinity(),
                                    std::bit_cast<double>(0x7ff8dead'beef0001ULL),
                                    std::bit_cast<double>(0xfff0000000000001ULL),
                                    std::numeric_limits<double>::max()};
  const std::vector<float> floats{-0.0F, 1e-45F, std::bit_cast<float>(0x7fc12345U),
                                  std::numeric_limits<float>::max()};
  const std::vector<std::int16_t> shorts{-32768, -1, 0, 1, 32767};
  const std::vector<std::int32_t> longs{std::numeric_limits<std::int32_t>::min(), -1, 0,
                                        std::numeric_limits<std::int32_t>::max()};
  for (const RawSamples& raw :
       {RawSamples(doubles), RawSamples(floats), RawSamples(shorts), RawSamples(longs)})
    expect_same(record_of(raw), written_and_read(record_of(raw), "bits.h5"));

  Record record = record_of(doubles);
  record.channels[0].clock.times = doubles;
  record.channels[0].imaginary = doubles;
  record.channels[0].scale = doubles[4];
  record.channels[0].delay = Delay{doubles[5], -0.0, false};
  expect_same(record, written_and_read(record, "bits.h5"));
}

TEST(Store, KeepsAMillionSamplesOfNoise) {
  std::mt19937 random(7);
  std::vector<double> noise(1000000);
  std::vector<std::int16_t> counts(1000000);
  for (double& value : noise) value = std::bit_cast<double>(0x3ff0000000000000ULL | random());
  for (auto& value : counts) value = static_cast<std::int16_t>(random());
  Record record = record_of(noise);
  record.channels.push_back(record_of(counts).channels[0]);
  record.channels[1].valid.assign(counts.size(), 1);
  expect_same(record, written_and_read(record, "million.h5"));
}

// A zero takes the least room there is: the check of sizes against the file's must not mind.
TEST(Store, KeepsAMillionZeros) {
  Record record = record_of(std::vector<double>(1000000, 0.0));
  record.channels[0].imaginary.assign(1000000, 0.0);
  record.channels[0].valid.assign(1000000, 0);
  expect_same(record, written_and_read(record, "zeros.h5"));
  for (const std::size_t n : {1023u, 1024u, 65535u, 65536u, 65537u})
    expect_same(record_of(std::vector<std::int32_t>(n, 0)),
                written_and_read(record_of(std::vector<std::int32_t>(n, 0)), "zeros.h5"));
}

TEST(Store, KeepsChannelNamesOfEveryKind) {
  Record record;
  const std::string long_name(5000, 'x');
  for (const std::string& name :
       {std::string("a/b"), std::string("a/b"), std::string("A B"), std::string(""),
        std::string("."), std::string(".."), std::string("力 [N]"), std::string("7"), long_name,
        long_name, std::string("a_b_2"), std::string("nul\0inside", 10), std::string("\xff\xfe")}) {
    Channel channel;
    channel.name = name;
    channel.raw = std::vector<double>{static_cast<double>(record.channels.size())};
    channel.calibration = Calibration{};
    channel.calibration->source = "of channel " + std::to_string(record.channels.size());
    record.channels.push_back(channel);
  }
  expect_same(record, written_and_read(record, "names.h5"));
}

// One long text makes every cell of its table as wide; neither file nor memory may grow with the
// product.
TEST(Store, KeepsLongTexts) {
  Record record = sample_record();
  record.title = std::string(300000, 't');
  record.channels[0].unit = std::string(100000, 'u');
  record.channels[1].name = "\u00e4" + std::string(998, 'n') + "\u00e4\u00e4";
  for (int i = 0; i < 300; ++i) record.attributes[std::to_string(i)] = "";
  record.attributes["certificate"] = std::string(100000, 'c');
  record.warnings.assign(700, "again");
  record.warnings[333] = std::string(70000, 'w');
  record.provenance.edits[0].what = std::string(100000, 'e');
  const TemporaryFile file("texts.h5");
  write_record(record, file.path());
  expect_same(record, read_record(file.path()));
  EXPECT_LT(std::filesystem::file_size(file.path()), 3000000u);
}

TEST(Store, KeepsTheOrderOfManyChannels) {
  Record record;
  for (int i = 0; i < 300; ++i) {
    record.channels.push_back(record_of(std::vector<std::int32_t>{i}).channels[0]);
    record.channels.back().name = std::to_string(299 - i);
  }
  expect_same(record, written_and_read(record, "order.h5"));
}

TEST(Store, CompressesWhatIsSmooth) {
  const TemporaryFile file("ramp.h5");
  Record record = record_of(std::vector<std::int16_t>(200000));
  auto& counts = std::get<std::vector<std::int16_t>>(record.channels[0].raw);
  for (std::size_t i = 0; i < counts.size(); ++i) counts[i] = static_cast<std::int16_t>(i / 8);
  write_record(record, file.path());
  EXPECT_LT(std::filesystem::file_size(file.path()), 2 * counts.size() / 3);
}

TEST(Store, ReplacesAFileOnlyByACompleteOne) {
  const TemporaryFile file("replaced.h5");
  write_record(record_of(std::vector<double>{1.0}), file.path());
  const std::string before = bytes_of(file.path());
  Record wrong = record_of(std::vector<double>{1.0});
  wrong.channels[0].valid = {1, 1};
  EXPECT_THROW(write_record(wrong, file.path()), std::invalid_argument);
  EXPECT_EQ(bytes_of(file.path()), before);
  write_record(sample_record(), file.path());
  expect_same(sample_record(), read_record(file.path()));
}

TEST(Store, CanBeUsedByManyThreadsAtOnce) {
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([t] {
      for (int i = 0; i < 5; ++i)
        EXPECT_EQ(written_and_read(sample_record(), "thread" + std::to_string(t)).title,
                  sample_record().title);
    });
  for (std::thread& thread : threads) thread.join();
}

TEST(Store, PrintsNothingOfItsOwn) {
  const TemporaryFile file("silent.h5");
  testing::internal::CaptureStderr();
  write_bytes(file.path(), "\x89HDF\r\n\x1a\n" + std::string(100, 'x'));
  EXPECT_THROW(read_record(file.path()), InputError);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");

  H5E_auto2_t print = nullptr;
  void* data = nullptr;
  H5Eget_auto2(H5E_DEFAULT, &print, &data);
  EXPECT_NE(print, nullptr) << "the caller's own error printing must be as it was";
}

/// Ends the process after reading a file whose root does not match its checksum.
[[noreturn]] void read_a_damaged_root(const std::string& path) {
  write_record(sample_record(), path);
  std::string bytes = bytes_of(path);
  bytes[60] = static_cast<char>(~bytes[60]);
  write_bytes(path, bytes);
  try {
    read_record(path);
  } catch (const InputError& error) {
    std::fprintf(stderr, "<%s>", error.problem().c_str());
  }
  std::exit(7);
}

TEST(StoreDeathTest, SaysNothingAtTheEndOfTheProgram) {
  testing::GTEST_FLAG(death_test_style) = "threadsafe";
  const TemporaryFile file("end.h5");
  EXPECT_EXIT(read_a_damaged_root(file.path()), testing::ExitedWithCode(7),
              "^<is damaged: / cannot be opened>$");
}

TEST(LooksLikeHdf5, KnowsTheSignature) {
  EXPECT_TRUE(looks_like_hdf5("\x89HDF\r\n\x1a\nmore"));
  EXPECT_TRUE(looks_like_hdf5("\x89HDF\r\n\x1a\n"));
  EXPECT_FALSE(looks_like_hdf5("\x89HDF\r\n\x1a"));
  EXPECT_FALSE(looks_like_hdf5("\x89HDF\n\x1a\n\n"));
  EXPECT_FALSE(looks_like_hdf5(""));
}

}  // namespace
