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
using tests::sample_record;

/// A path of this process's own (tests run side by side), gone after the test.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& name)
      : path_(testing::TempDir() + "store_" + std::to_string(getpid()) + "_" + name) {
    remove();
  }

  ~TemporaryFile() { remove(); }

  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  void remove() const {
    std::filesystem::remove_all(path_);
    std::filesystem::remove(path_ + ".part");
  }

  std::string path_;
};

std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_bytes(const std::string& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

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

Record written_and_read(const Record& record, const std::string& name) {
  const TemporaryFile file(name);
  write_record(record, file.path());
  EXPECT_FALSE(std::filesystem::exists(file.path() + ".part"));
  return read_record(file.path());
}

Record record_of(RawSamples raw) {
  Record record;
  record.channels.resize(1);
  record.channels[0].name = "a";
  record.channels[0].raw = std::move(raw);
  return record;
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

// --- What cannot be written ----------------------------------------------------------------------

std::string write_error(const Record& record, const std::string& path) {
  try {
    write_record(record, path);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "written";
}

TEST(StoreWrite, SaysWhyItCannotWrite) {
  const std::string absent = testing::TempDir() + "no_such_folder/shot.h5";
  EXPECT_EQ(write_error({}, absent), absent + ": cannot be written: No such file or directory");

  const TemporaryFile folder("folder");
  std::filesystem::create_directory(folder.path());
  EXPECT_EQ(write_error({}, folder.path()), folder.path() + ": cannot be written: Is a directory");
  EXPECT_FALSE(std::filesystem::exists(folder.path() + ".part"));
}

TEST(StoreWrite, RefusesChannelsOfUnequalLength) {
  Record record = record_of(std::vector<double>{1.0, 2.0});
  record.channels[0].valid = {1};
  EXPECT_EQ(write_error(record, "unused"),
            "write_record: channel 'a' has 1 validity flags for 2 samples");
  record.channels[0].valid.clear();
  record.channels[0].imaginary = {1.0, 2.0, 3.0};
  EXPECT_EQ(write_error(record, "unused"),
            "write_record: channel 'a' has 3 imaginary parts for 2 samples");
  record.channels[0].imaginary.clear();
  record.channels[0].clock.times = {1.0};
  EXPECT_EQ(write_error(record, "unused"), "write_record: channel 'a' has 1 times for 2 samples");
}

/// Ends the process: 7 when the write fails as it should and leaves no file.
[[noreturn]] void write_with_a_limit(rlim_t limit, const std::string& path) {
  std::mt19937 random(1);
  std::vector<std::int32_t> noise(1000000);
  for (auto& value : noise) value = static_cast<std::int32_t>(random());
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limits{limit, limit};
  setrlimit(RLIMIT_FSIZE, &limits);
  const std::string error = write_error(record_of(noise), path);
  const bool said = error == path + ": cannot be written: File too large";
  if (!said) std::fprintf(stderr, "%s\n", error.c_str());
  const bool left = std::filesystem::exists(path) || std::filesystem::exists(path + ".part");
  std::exit(said && !left ? 7 : 8);
}

// A limit on the size of files stands for a full disk: the system refuses the write that passes it.
TEST(StoreWriteDeathTest, LeavesNothingBehindWhenTheDiskIsFull) {
  testing::GTEST_FLAG(death_test_style) = "threadsafe";
  const TemporaryFile file("full.h5");
  for (const rlim_t limit : {100u, 5000u, 100000u, 1000000u})
    EXPECT_EXIT(write_with_a_limit(limit, file.path()), testing::ExitedWithCode(7), "") << limit;
}

// --- What cannot be read -------------------------------------------------------------------------

/// The message without the file's name; every error must name it.
std::string read_error(const std::string& path) {
  try {
    read_record(path);
  } catch (const InputError& error) {
    EXPECT_EQ(error.where().file, path);
    EXPECT_EQ(std::string(error.what()), path + ": " + error.problem());
    return error.problem();
  } catch (const FileError& error) {
    return std::string("FileError: ") + error.what();
  }
  return "read";
}

TEST(StoreRead, SaysWhyAFileCannotBeOpened) {
  const TemporaryFile file("absent.h5");
  EXPECT_EQ(read_error(file.path()),
            "FileError: " + file.path() + ": cannot be opened: No such file or directory");
  std::filesystem::create_directory(file.path());
  EXPECT_EQ(read_error(file.path()),
            "FileError: " + file.path() + ": cannot be read: Is a directory");
}

TEST(StoreRead, RefusesWhatIsNoHdf5File) {
  const TemporaryFile file("foreign");
  write_bytes(file.path(), "");
  EXPECT_EQ(read_error(file.path()), "is empty, not an HDF5 file");
  write_bytes(file.path(), "time;force\n0;1\n");
  EXPECT_EQ(read_error(file.path()),
            "is not an HDF5 file: it does not begin with the HDF5 signature");
  write_bytes(file.path(), "\x89PNG\r\n\x1a\n" + std::string(5000, '\0'));
  EXPECT_EQ(read_error(file.path()),
            "is not an HDF5 file: it does not begin with the HDF5 signature");
  write_bytes(file.path(), "\x89HDF\r\n\x1a\n" + std::string(5000, '\0'));
  EXPECT_EQ(read_error(file.path()), "is damaged: HDF5 cannot open it");
}

TEST(StoreRead, SaysHowMuchIsMissingOfAFileThatWasCutShort) {
  const TemporaryFile file("cut.h5");
  write_record(sample_record(), file.path());
  const std::string whole = bytes_of(file.path());
  const std::string of_all =
      " of " + std::to_string(whole.size()) + " bytes; copy or record it again";
  for (std::size_t size = 1; size < whole.size(); size += size < 100 ? 1 : 997) {
    write_bytes(file.path(), whole.substr(0, size));
    EXPECT_EQ(read_error(file.path()),
              size < 48 ? "is cut short: it ends after " + std::to_string(size) +
                              " bytes, within the HDF5 header"
                        : "is cut short: it has " + std::to_string(size) + of_all);
  }
  write_bytes(file.path(), whole.substr(0, whole.size() - 1));
  EXPECT_EQ(read_error(file.path()),
            "is cut short: it has " + std::to_string(whole.size() - 1) + of_all);
}

// Each byte in turn is turned over. Most lie under a checksum; whatever is read must be a record or
// an error.
TEST(StoreRead, SurvivesAnyWrongByte) {
  const TemporaryFile file("byte.h5");
  Record record = sample_record();
  record.channels[0].raw = std::vector<std::int16_t>(1100, 5);
  record.channels[0].valid.clear();
  write_record(record, file.path());
  const std::string whole = bytes_of(file.path());
  int refused = 0;
  for (std::size_t at = 0; at < whole.size(); at += 61) {
    std::string wrong = whole;
    wrong[at] = static_cast<char>(~wrong[at]);
    write_bytes(file.path(), wrong);
    try {
      read_record(file.path());
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

TEST(StoreRead, FindsAWrongByteAmongItsSamples) {
  const TemporaryFile file("sum.h5");
  std::mt19937 random(3);
  std::vector<std::int32_t> noise(60000);
  for (auto& value : noise) value = static_cast<std::int32_t>(random());
  write_record(record_of(noise), file.path());
  std::string bytes = bytes_of(file.path());
  const auto chunk = static_cast<std::size_t>(bytes.find("\x78\x5e") + 50000);  // zlib's header
  ASSERT_LT(chunk, bytes.size());
  bytes[chunk] = static_cast<char>(bytes[chunk] ^ 1);
  write_bytes(file.path(), bytes);
  EXPECT_EQ(read_error(file.path()), "is damaged: /entry/raw/a/samples cannot be read");
}

/// Changes a written file behind the writer's back and gives the reader's answer.
class Tampered {
 public:
  explicit Tampered(const Record& record = sample_record()) : file_("tampered.h5") {
    write_record(record, file_.path());
    id_ = H5Fopen(file_.path().c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  }

  ~Tampered() {
    if (id_ >= 0) H5Fclose(id_);
  }

  Tampered(const Tampered&) = delete;
  Tampered& operator=(const Tampered&) = delete;

  hid_t id() const { return id_; }

  void remove(const char* path) const { ASSERT_GE(H5Ldelete(id_, path, H5P_DEFAULT), 0); }

  void remove_attribute(const char* object, const char* name) const {
    ASSERT_GE(H5Adelete_by_name(id_, object, name, H5P_DEFAULT), 0);
  }

  void put_text(const char* object, const char* name, const char* text) const {
    if (H5Aexists_by_name(id_, object, name, H5P_DEFAULT) > 0) remove_attribute(object, name);
    const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
    H5Tset_size(type, std::strlen(text) + 1);
    const hid_t attribute =
        H5Acreate_by_name(id_, object, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    ASSERT_GE(H5Awrite(attribute, type, text), 0);
    H5Aclose(attribute), H5Sclose(space), H5Tclose(type);
  }

  /// A data set that holds nothing yet.
  void put_data(const char* path, hid_t type, const std::vector<hsize_t>& shape,
                hid_t properties = H5P_DEFAULT) const {
    if (H5Lexists(id_, path, H5P_DEFAULT) > 0) remove(path);
    const hid_t space =
        shape.empty() ? H5Screate(H5S_SCALAR)
                      : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
    const hid_t data = H5Dcreate2(id_, path, type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    ASSERT_GE(data, 0);
    H5Dclose(data), H5Sclose(space);
  }

  std::string answer() {
    H5Fclose(id_);
    id_ = -1;
    return read_error(file_.path());
  }

 private:
  TemporaryFile file_;
  hid_t id_ = -1;
};

TEST(StoreRead, RefusesHdf5FilesOfOthers) {
  const std::string refusal =
      "is an HDF5 file, but not a recording of impactrig: its root has no attribute 'format' that "
      "says 'impactrig-recording'";
  const TemporaryFile file("others.h5");
  H5Fclose(H5Fcreate(file.path().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
  EXPECT_EQ(read_error(file.path()), refusal);

  Tampered tampered;
  tampered.put_text("/", "format", "impactrig-recordings");
  EXPECT_EQ(tampered.answer(), refusal);

  // with a header of its own before HDF5's, as MATLAB 7.3 writes
  const hid_t creation = H5Pcreate(H5P_FILE_CREATE);
  H5Pset_userblock(creation, 512);
  H5Fclose(H5Fcreate(file.path().c_str(), H5F_ACC_TRUNC, creation, H5P_DEFAULT));
  H5Pclose(creation);
  EXPECT_EQ(read_error(file.path()), refusal);
}

TEST(StoreRead, RefusesALaterFormat) {
  Tampered later;
  later.put_text("/", "format_version", "2.0");
  later.put_text("/", "creator", "impactrig 9.1.0");
  EXPECT_EQ(later.answer(),
            "has format 2.0 of recordings, written by impactrig 9.1.0; this is " +
                program_version() +
                ", which reads format 1.0 and what came before: update it, or write the file again "
                "with the older program");
  for (const char* wrong : {"", "1", "x.1", "-1.0", "99999999999999999999.0"}) {
    Tampered tampered;
    tampered.put_text("/", "format_version", wrong);
    EXPECT_EQ(tampered.answer(),
              "is damaged: /@format_version is '" + std::string(wrong) + "', not a version");
  }
}

TEST(StoreRead, TakesALaterMinorFormatAndWhatItDoesNotKnow) {
  Tampered later;
  later.put_text("/", "format_version", "1.7");
  later.put_data("/entry/novelty", H5T_NATIVE_DOUBLE, {3});
  EXPECT_EQ(later.answer(), "read");
}

TEST(StoreRead, TakesAnUnknownQuantityAndSaysSo) {
  const TemporaryFile file("quantity.h5");
  write_record(record_of(std::vector<double>{1.0}), file.path());
  const hid_t id = H5Fopen(file.path().c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  H5Ldelete(id, "/entry/raw/a/quantity", H5P_DEFAULT);
  const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
  H5Tset_size(type, 8);
  H5Tset_strpad(type, H5T_STR_SPACEPAD);
  const hid_t data =
      H5Dcreate2(id, "/entry/raw/a/quantity", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, "torque  ");
  H5Dclose(data), H5Sclose(space), H5Tclose(type), H5Fclose(id);
  const Record record = read_record(file.path());
  EXPECT_EQ(record.channels[0].quantity, Quantity::other);
  EXPECT_THAT(record.warnings,
              testing::ElementsAre("Channel 'a': this program does not know its quantity 'torque' "
                                   "and takes it as 'other'."));
}

TEST(StoreRead, NamesWhatIsMissing) {
  for (const char* path :
       {"/entry", "/entry/title", "/entry/raw", "/entry/calibration", "/entry/provenance",
        "/entry/provenance/sha256", "/entry/raw/force/name", "/entry/raw/force/samples",
        "/entry/calibration/force/source", "/entry/calibration/force/delay_errors"}) {
    Tampered tampered;
    tampered.remove(path);
    EXPECT_EQ(tampered.answer(), "is damaged: " + std::string(path) + " is missing");
  }
  Tampered tampered;
  tampered.remove_attribute("/entry/raw/force/samples", "scale_factor");
  EXPECT_EQ(tampered.answer(), "is damaged: /entry/raw/force/samples@scale_factor is missing");
}

TEST(StoreRead, NamesWhatIsOfAnotherKind) {
  const auto answer = [](const std::function<void(Tampered&)>& change) {
    Tampered tampered;
    change(tampered);
    return tampered.answer();
  };
  EXPECT_EQ(answer([](auto& file) { file.put_data("/entry/raw", H5T_NATIVE_DOUBLE, {3}); }),
            "is damaged: /entry/raw is not a group");
  EXPECT_EQ(
      answer([](auto& file) {
        file.remove("/entry/title");
        H5Gclose(H5Gcreate2(file.id(), "/entry/title", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
      }),
      "is damaged: /entry/title is not a data set");
  EXPECT_EQ(answer([](auto& file) { file.put_data("/entry/title", H5T_NATIVE_DOUBLE, {}); }),
            "is damaged: /entry/title declares 1 values and holds 0 bytes");
  EXPECT_EQ(answer([](auto& file) { file.put_text("/entry/raw/force/samples", "start", "0 s"); }),
            "is damaged: /entry/raw/force/samples@start is not one number");
  EXPECT_EQ(answer([](auto& file) {
              const hid_t text = H5Tcopy(H5T_C_S1);
              H5Tset_size(text, H5T_VARIABLE);
              file.put_data("/entry/warnings", text, {0});
              H5Tclose(text);
            }),
            "is damaged: /entry/warnings is not text of a fixed length");
  EXPECT_EQ(answer([](auto& file) {
              file.put_data("/entry/raw/h1/samples", H5T_NATIVE_DOUBLE, {2, 2});
            }),
            "is damaged: /entry/raw/h1/samples has another shape than it must have");
  EXPECT_EQ(
      answer([](auto& file) { file.put_data("/entry/raw/h1/samples", H5T_NATIVE_UINT16, {0}); }),
      "is damaged: /entry/raw/h1/samples is of a number type that no recording has");
  EXPECT_EQ(answer([](auto& file) { file.put_data("/entry/raw/h1/samples", H5T_C_S1, {0}); }),
            "is damaged: /entry/raw/h1/samples is of a number type that no recording has");
  EXPECT_EQ(answer([](auto& file) { file.put_data("/entry/raw/h1/imaginary", H5T_C_S1, {0}); }),
            "is damaged: /entry/raw/h1/imaginary is not made of numbers");
  EXPECT_EQ(
      answer([](auto& file) { file.put_data("/entry/raw/h1/imaginary", H5T_NATIVE_DOUBLE, {0}); }),
      "is damaged: /entry/raw/h1/imaginary has 0 values for 3 samples");
  EXPECT_EQ(answer([](auto& file) { file.put_data("/entry/warnings", H5T_NATIVE_DOUBLE, {0}); }),
            "is damaged: /entry/warnings is not text of a fixed length");
}

TEST(StoreRead, DoesNotFollowLinksOutOfTheFile) {
  Tampered link;
  link.remove("/entry/provenance");
  ASSERT_GE(H5Lcreate_external("/absent/other.h5", "/", link.id(), "/entry/provenance", H5P_DEFAULT,
                               H5P_DEFAULT),
            0);
  EXPECT_EQ(link.answer(), "is damaged: /entry/provenance is a link");

  Tampered outside;
  const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_external(properties, "/absent/other.bin", 0, 24);
  outside.put_data("/entry/raw/h1/samples", H5T_NATIVE_DOUBLE, {3}, properties);
  H5Pclose(properties);
  EXPECT_EQ(outside.answer(), "is damaged: /entry/raw/h1/samples is kept in another file");
}

TEST(StoreRead, TakesNoMemoryForWhatAFileOnlyDeclares) {
  const std::string large = std::to_string(hsize_t{1} << 45);
  Tampered contiguous;
  contiguous.put_data("/entry/raw/h1/samples", H5T_NATIVE_DOUBLE, {hsize_t{1} << 45});
  EXPECT_EQ(contiguous.answer(),
            "is damaged: /entry/raw/h1/samples declares " + large + " values and holds 0 bytes");

  Tampered chunked;
  const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
  const hsize_t chunk = hsize_t{1} << 28;
  H5Pset_chunk(properties, 1, &chunk);
  chunked.put_data("/entry/raw/h1/samples", H5T_NATIVE_DOUBLE, {hsize_t{1} << 45}, properties);
  H5Pclose(properties);
  EXPECT_EQ(chunked.answer(),
            "is damaged: /entry/raw/h1/samples declares " + large + " values and holds 0 bytes");

  Tampered texts;
  const hid_t text = H5Tcopy(H5T_C_S1);
  H5Tset_size(text, 80);
  texts.put_data("/entry/warnings", text, {hsize_t{1} << 45});
  H5Tclose(text);
  EXPECT_EQ(texts.answer(),
            "is damaged: /entry/warnings declares " + large + " values and holds 0 bytes");
}

TEST(Store, ClosesAllItOpens) {
  const auto open_now = [] {
    hsize_t sum = 0;
    for (const H5I_type_t type : {H5I_FILE, H5I_GROUP, H5I_DATATYPE, H5I_DATASPACE, H5I_DATASET,
                                  H5I_ATTR, H5I_GENPROP_LST}) {
      hsize_t members = 0;
      H5Inmembers(type, &members);
      sum += members;
    }
    return sum;
  };
  EXPECT_EQ(written_and_read(sample_record(), "ids.h5").channels.size(), 3u);
  const hsize_t before = open_now();
  EXPECT_EQ(written_and_read(sample_record(), "ids.h5").channels.size(), 3u);
  EXPECT_EQ(open_now(), before);
  Tampered tampered;
  tampered.remove("/entry/provenance/sha256");
  EXPECT_EQ(tampered.answer(), "is damaged: /entry/provenance/sha256 is missing");
  EXPECT_EQ(open_now(), before);
}

TEST(LooksLikeHdf5, KnowsTheSignature) {
  EXPECT_TRUE(looks_like_hdf5("\x89HDF\r\n\x1a\nmore"));
  EXPECT_TRUE(looks_like_hdf5("\x89HDF\r\n\x1a\n"));
  EXPECT_FALSE(looks_like_hdf5("\x89HDF\r\n\x1a"));
  EXPECT_FALSE(looks_like_hdf5("\x89HDF\n\x1a\n\n"));
  EXPECT_FALSE(looks_like_hdf5(""));
}

}  // namespace
