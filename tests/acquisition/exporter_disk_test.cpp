// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "acquisition/exporter.hpp"
#include "acquisition/recording_spool.hpp"
#include "datasets/input_error.hpp"
#include "tests/acquisition/exported.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Channel;
using datasets::Record;
using tests::example;
using tests::expect_same_samples;
using tests::OutputPath;

/// Every kind of samples, with and without marks, stated times and imaginary parts.
Record of_every_kind(std::size_t n) {
  Record record = example(n);
  const auto add = [&record](const std::string& name, auto samples) -> Channel& {
    Channel channel;
    channel.name = name;
    channel.unit = "V";
    channel.clock = {0.5, 1e-5, {}};
    channel.raw = std::move(samples);
    record.channels.push_back(std::move(channel));
    return record.channels.back();
  };
  std::vector<float> singles(n);
  std::vector<std::int16_t> shorts(n);
  std::vector<std::int32_t> integers(n);
  std::vector<double> times(n);
  std::vector<std::uint8_t> valid(n, 1);
  for (std::size_t i = 0; i < n; ++i) {
    singles[i] = static_cast<float>(std::sin(0.01 * static_cast<double>(i)));
    shorts[i] = static_cast<std::int16_t>(i * 7919);
    integers[i] = static_cast<std::int32_t>(i) * 10007;
    times[i] = 1e-5 * static_cast<double>(i * i);
    valid[i] = i % 9000 == 8191 || i % 9000 == 8192 ? 0 : 1;
  }
  add("single", singles).valid = valid;
  Channel& scaled = add("short", shorts);
  scaled.scale = 0.125;
  scaled.offset = -1.0;
  scaled.calibration = {2.0, 0.1, "V", "N", "certificate"};
  add("integer", integers).clock = {0.0, 1.0, times};
  Channel& complex = add("complex", times);
  complex.imaginary = times;
  complex.attributes["domain"] = "frequency";
  return record;
}

/// Hands samples over in blocks of uneven lengths, channels by turns.
SpooledRecording spooled(const Record& record) {
  RecordingSpool spool("OUT", record.channels.size());
  bool more = true;
  for (std::size_t first = 0, step = 1; more; first += step, step = step * 2 % 5000 + 1) {
    more = false;
    for (std::size_t c = 0; c < record.channels.size(); ++c) {
      const Channel& channel = record.channels[c];
      if (first >= channel.size()) continue;
      more = true;
      const std::size_t count = std::min(step, channel.size() - first);
      SampleBlock block;
      std::visit([&](const auto& raw) { block.raw = std::span(raw).subspan(first, count); },
                 channel.raw);
      if (channel.complex()) block.imaginary = std::span(channel.imaginary).subspan(first, count);
      // marks may begin where the first of them is
      if (!channel.valid.empty() && first + count > 8191)
        block.valid = std::span(channel.valid).subspan(first, count);
      spool.take(c, block);
      if (!channel.clock.uniform())
        spool.take_times(c, std::span(channel.clock.times).subspan(first, count));
    }
  }
  return spool.finish();
}

TEST(Export, FromTheDiskIsTheSameAsFromMemory) {
  for (const std::size_t n : {1U, 8192U, 30000U}) {
    for (const std::string ending : {".uff", ".unv", ".mat", ".csv", ".h5"}) {
      SCOPED_TRACE(ending + fmt::format(" {}", n));
      Record record = of_every_kind(n);
      if (ending == ".unv") record.channels.erase(record.channels.begin() + 4);
      if (ending == ".csv") {
        record.channels.erase(record.channels.begin() + 4, record.channels.end());
        for (Channel& channel : record.channels) channel.clock = {0.5, 1e-5, {}};
      }
      Record head = record;
      for (Channel& channel : head.channels) {
        channel.raw = std::vector<double>{};
        channel.imaginary.clear();
        channel.valid.clear();
        channel.clock.times.clear();
      }
      const OutputPath memory("_memory" + ending);
      const OutputPath disk("_disk" + ending);
      const std::vector<std::string> warnings = export_recording(record, memory);
      EXPECT_EQ(export_recording(head, spooled(record), disk), warnings);
      if (ending != ".h5") {
        EXPECT_TRUE(tests::bytes_of(memory) == tests::bytes_of(disk));
        continue;
      }
      const Record found = import_recording(disk);
      ASSERT_EQ(found.channels.size(), record.channels.size());
      for (std::size_t c = 0; c < found.channels.size(); ++c) {
        EXPECT_EQ(found.channels[c].raw.index(), record.channels[c].raw.index());
        expect_same_samples(found.channels[c], record.channels[c]);
        EXPECT_EQ(found.channels[c].clock.times, record.channels[c].clock.times);
        for (std::size_t i = 0; i < n; ++i)
          ASSERT_EQ(found.channels[c].is_valid(i), record.channels[c].is_valid(i)) << i;
      }
    }
  }
}

TEST(CsvExport, OfStatedTimesIsTheSameFromTheDisk) {
  Record record = example(20000);
  for (std::size_t i = 0; i < 20000; ++i)
    record.channels[0].clock.times.push_back(1e-6 * static_cast<double>(i * i));
  record.channels[1].clock.times = record.channels[0].clock.times;
  const OutputPath memory("_memory.csv");
  const OutputPath disk("_disk.csv");
  export_recording(record, memory);
  export_recording(record, spooled(record), disk);
  EXPECT_TRUE(tests::bytes_of(memory) == tests::bytes_of(disk));
  record.channels[1].clock.times[19999] += 1.0;
  EXPECT_THROW(export_recording(record, spooled(record), disk), datasets::FileError);
}

}  // namespace
}  // namespace impactrig::acquisition
