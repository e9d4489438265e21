// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/record_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <limits>
#include <random>

#include "datasets/input_error.hpp"
#include "datasets/quicklook_builder.hpp"
#include "datasets/store.hpp"

namespace impactrig::datasets {
namespace {

namespace fs = std::filesystem;

/// A path of the running test's own, without a file before and after.
class Path {
 public:
  Path()
      : path_(testing::TempDir() + "impactrig_writer_" + std::to_string(getpid()) + "_" +
              testing::UnitTest::GetInstance()->current_test_info()->name() + ".h5") {
    clear();
  }

  ~Path() { clear(); }

  Path(const Path&) = delete;
  Path& operator=(const Path&) = delete;

  const std::string& text() const { return path_; }

 private:
  void clear() const {
    fs::remove(path_);
    fs::remove(path_ + ".part");
  }

  std::string path_;
};

/// Channels of every type, longer than a piece of the file, with marks, times and imaginary parts.
Record recording(std::size_t n) {
  Record record;
  record.title = "swing 7";
  record.started = "2026-01-02T03:04:05";
  record.warnings = {"a warning"};
  record.attributes = {{"operator", "N. N."}};
  record.provenance.source_file = "shot.tdms";
  record.provenance.sha256 = std::string(64, 'a');
  record.channels.resize(4);
  std::vector<double> force(n);
  std::vector<float> velocity(n);
  std::vector<std::int16_t> counts(n);
  std::vector<std::int32_t> encoder(n);
  for (std::size_t i = 0; i < n; ++i) {
    force[i] = std::sin(0.001 * static_cast<double>(i));
    velocity[i] = static_cast<float>(i) * 0.5F;
    counts[i] = static_cast<std::int16_t>(i % 1000);
    encoder[i] = -static_cast<std::int32_t>(i);
  }
  record.channels[0].raw = force;
  record.channels[1].raw = velocity;
  record.channels[2].raw = counts;
  record.channels[3].raw = encoder;
  for (std::size_t c = 0; c < 4; ++c) {
    Channel& channel = record.channels[c];
    channel.name = "channel " + std::to_string(c);
    channel.unit = c == 0 ? "kN" : "V";
    channel.quantity = c == 0 ? Quantity::force : Quantity::voltage;
    channel.clock = {0.25, 1e-6, {}};
    channel.scale = c == 2 ? 1e-3 : 1.0;
    channel.offset = c == 2 ? -0.5 : 0.0;
    channel.attributes = {{"gain", "10"}};
  }
  record.channels[0].valid.assign(n, 1);
  record.channels[0].valid[n / 2] = 0;
  for (std::size_t i = 0; i < n; ++i) {
    record.channels[1].clock.times.push_back(1e-6 * static_cast<double>(i * i));
    record.channels[3].imaginary.push_back(static_cast<double>(i));
  }
  record.channels[0].calibration = Calibration{4e-3, 1e-5, "V", "N", "certificate"};
  record.channels[0].delay = Delay{2e-6, 1e-7, false};
  return record;
}

template <typename T>
std::span<const T> part(const std::vector<T>& all, std::size_t first, std::size_t count) {
  return all.empty() ? std::span<const T>{} : std::span<const T>(all).subspan(first, count);
}

/// Hands a recording over in blocks of changing length.
void append(const Record& record, RecordWriter& writer) {
  std::mt19937 random(1);
  for (std::size_t c = 0; c < record.channels.size(); ++c) {
    const Channel& channel = record.channels[c];
    for (std::size_t first = 0; first < channel.size();) {
      const std::size_t count =
          std::min<std::size_t>(channel.size() - first, 1 + random() % 100000);
      RawSpan raw;
      std::visit([&](const auto& all) { raw = part(all, first, count); }, channel.raw);
      // a block without marks is sound
      auto valid = part(channel.valid, first, count);
      if (std::ranges::count(valid, 0) == 0) valid = {};
      writer.append(c, raw, part(channel.imaginary, first, count), valid);
      writer.append_times(c, part(channel.clock.times, first, count));
      first += count;
    }
  }
}

/// The channels without samples.
Record head_of(const Record& record) {
  Record head = record;
  for (Channel& channel : head.channels) {
    channel.raw = {};
    channel.valid.clear();
    channel.imaginary.clear();
    channel.clock.times.clear();
  }
  return head;
}

TEST(RecordWriter, WritesWhatTheStoreReads) {
  for (const std::size_t n : {1U, 65536U, 200001U}) {
    const Path path;
    const Record record = recording(n);
    RecordWriter writer(path.text(), {"channel 0", "channel 1", "channel 2", "channel 3"});
    append(record, writer);
    EXPECT_FALSE(fs::exists(path.text()));
    writer.finish(head_of(record));
    EXPECT_FALSE(fs::exists(path.text() + ".part"));
    const Record found = read_record(path.text());
    EXPECT_EQ(found.title, record.title);
    EXPECT_EQ(found.started, record.started);
    EXPECT_EQ(found.warnings, record.warnings);
    EXPECT_EQ(found.attributes, record.attributes);
    EXPECT_EQ(found.provenance.sha256, record.provenance.sha256);
    ASSERT_EQ(found.channels.size(), 4U);
    for (std::size_t c = 0; c < 4; ++c) {
      const Channel& a = found.channels[c];
      const Channel& b = record.channels[c];
      EXPECT_EQ(a.name, b.name);
      EXPECT_EQ(a.quantity, b.quantity);
      EXPECT_EQ(a.unit, b.unit);
      EXPECT_EQ(a.raw, b.raw);
      EXPECT_EQ(a.scale, b.scale);
      EXPECT_EQ(a.offset, b.offset);
      EXPECT_EQ(a.imaginary, b.imaginary);
      EXPECT_EQ(a.valid, b.valid);
      EXPECT_EQ(a.clock.start, b.clock.start);
      EXPECT_EQ(a.clock.interval, b.clock.interval);
      EXPECT_EQ(a.clock.times, b.clock.times);
      EXPECT_EQ(a.attributes, b.attributes);
      EXPECT_EQ(a.calibration.has_value(), b.calibration.has_value());
      EXPECT_EQ(a.delay.has_value(), b.delay.has_value());
    }
  }
}

TEST(RecordWriter, WritesChannelsWithoutSamples) {
  const Path path;
  Record record;
  record.channels.resize(1);
  record.channels[0].name = "empty";
  RecordWriter writer(path.text(), {"empty"});
  writer.finish(record);
  EXPECT_EQ(read_record(path.text()).channels.at(0).size(), 0U);
}

TEST(RecordWriter, LeavesNoFileWhenNotFinished) {
  const Path path;
  {
    RecordWriter writer(path.text(), {"a"});
    const std::vector<double> samples(100000, 1.0);
    writer.append(0, std::span<const double>(samples));
    EXPECT_TRUE(fs::exists(path.text() + ".part"));
  }
  EXPECT_FALSE(fs::exists(path.text() + ".part"));
  EXPECT_FALSE(fs::exists(path.text()));
}

TEST(RecordWriter, TellsWhatTheDiskRefuses) {
  const Path path;
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  for (const rlim_t most : {rlim_t{3'000'000}, rlim_t{1000}}) {
    std::string said;
    try {
      RecordWriter writer(path.text(), {"a"});
      const rlimit small{most, old.rlim_max};
      setrlimit(RLIMIT_FSIZE, &small);
      const std::vector<double> samples(1'000'000, 1.0);
      writer.append(0, std::span<const double>(samples));
      writer.finish(Record{});
    } catch (const FileError& error) {
      said = error.what();
    }
    setrlimit(RLIMIT_FSIZE, &old);
    EXPECT_EQ(said, path.text() + ": cannot be written: File too large");
    EXPECT_FALSE(fs::exists(path.text()));
    EXPECT_FALSE(fs::exists(path.text() + ".part"));
  }
  std::signal(SIGXFSZ, old_handler);
}

TEST(RecordWriter, TellsOfAFolderThatIsNotThere) {
  EXPECT_THROW(
      {
        try {
          RecordWriter("/nowhere/x.h5", {"a"});
        } catch (const FileError& error) {
          EXPECT_STREQ(error.what(), "/nowhere/x.h5: cannot be written: No such file or directory");
          throw;
        }
      },
      FileError);
}

TEST(QuicklookBuilder, KeepsAllSamplesWhileTheyAreFew) {
  QuicklookBuilder look(12);
  const std::vector<double> values = {3.0, 1.0, 2.0, 5.0, 4.0};
  look.add(std::span<const double>(values));
  look.add(std::span<const double>(values));
  const auto points = look.points();
  ASSERT_EQ(points.size(), 10U);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_EQ(points[i].sample, i);
    EXPECT_EQ(points[i].value, values[i % 5]);
  }
}

TEST(QuicklookBuilder, KeepsExtremesHoweverTheSamplesCome) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  std::mt19937 random(2);
  std::vector<double> values(123457);
  for (double& value : values) value = static_cast<double>(random() % 1000);
  values[77] = nan;
  values[5000] = 1e6;
  values[123456] = -1e6;
  QuicklookBuilder at_once(100);
  at_once.add(std::span<const double>(values));
  QuicklookBuilder in_pieces(100);
  for (std::size_t i = 0; i < values.size();) {
    const std::size_t count = std::min<std::size_t>(values.size() - i, 1 + random() % 3000);
    in_pieces.add(std::span<const double>(values).subspan(i, count));
    i += count;
  }
  const auto points = at_once.points();
  EXPECT_LE(points.size(), 100U);
  EXPECT_GE(points.size(), 40U);
  ASSERT_EQ(in_pieces.points().size(), points.size());
  double lowest = 0.0;
  double highest = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(points[i].value, values[points[i].sample]);
    EXPECT_EQ(in_pieces.points()[i].value, points[i].value);
    EXPECT_TRUE(i == 0 || points[i - 1].sample < points[i].sample);
    lowest = std::min(lowest, points[i].value);
    highest = std::max(highest, points[i].value);
  }
  EXPECT_EQ(lowest, -1e6);
  EXPECT_EQ(highest, 1e6);
}

template <typename Number>
void expect_same_points_of_numbers() {
  std::mt19937 random(3);
  std::vector<Number> numbers(54321);
  for (Number& number : numbers)
    number = static_cast<Number>(static_cast<int>(random() % 60001) - 30000);
  numbers[7] = std::numeric_limits<Number>::lowest();
  numbers[54000] = std::numeric_limits<Number>::max();
  const std::vector<double> values(numbers.begin(), numbers.end());
  QuicklookBuilder of_numbers(200);
  of_numbers.add(std::span<const Number>(numbers).first(1001));
  of_numbers.add(std::span<const Number>(numbers).subspan(1001));
  // an independent way: bucket by bucket, with the standard library
  const auto points = of_numbers.points();
  std::uint64_t width = 1;
  while (values.size() > width * 100) width *= 2;
  std::vector<std::pair<std::uint64_t, double>> expected;
  for (std::size_t first = 0; first < values.size(); first += width) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(first);
    const auto end = values.begin() + static_cast<std::ptrdiff_t>(
                                          std::min<std::size_t>(first + width, values.size()));
    auto low = static_cast<std::uint64_t>(std::min_element(begin, end) - values.begin());
    auto high = static_cast<std::uint64_t>(std::max_element(begin, end) - values.begin());
    if (low > high) std::swap(low, high);
    expected.emplace_back(low, values[low]);
    if (low != high) expected.emplace_back(high, values[high]);
  }
  ASSERT_EQ(points.size(), expected.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(points[i].sample, expected[i].first);
    EXPECT_EQ(points[i].value, expected[i].second);
  }
}

TEST(QuicklookBuilder, KeepsExtremesOfEveryTypeOfNumber) {
  expect_same_points_of_numbers<std::int16_t>();
  expect_same_points_of_numbers<std::int32_t>();
  expect_same_points_of_numbers<float>();
  expect_same_points_of_numbers<double>();
}

TEST(QuicklookBuilder, OfSamplesThatAreNoneIsNotANumber) {
  QuicklookBuilder look(4);
  const std::vector<double> none(100, std::numeric_limits<double>::quiet_NaN());
  look.add(std::span<const double>(none));
  for (const auto& point : look.points()) EXPECT_TRUE(std::isnan(point.value));
}

}  // namespace
}  // namespace impactrig::datasets
