// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "acquisition/exporter.hpp"
#include "tests/acquisition/exported.hpp"
#include "tests/acquisition/mat_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Channel;
using datasets::Quantity;
using datasets::Record;
using tests::example;
using tests::expect_same_head;
using tests::expect_same_samples;
using tests::export_error;
using tests::OutputPath;
using tests::round_trip;

/// One channel of what only some formats keep.
Channel particular(const std::string& name) {
  Channel channel;
  channel.name = name;
  channel.quantity = Quantity::force;
  channel.unit = "N";
  channel.clock = {-1.0 / 3.0, 1e-6, {}};
  channel.raw = std::vector<float>{1.5F, -0.0F, 3e38F};
  channel.valid = {1, 0, 1};
  channel.calibration = {4e-12, 1e-14, "C", "N", "certificate \xC2\xB5 17"};
  channel.delay = {2e-6, 1e-7, true};
  channel.attributes = {{"coupling", "AC"}, {"note", "two\nlines \xF0\x9F\x94\xA8"}};
  return channel;
}

TEST(MatExport, KeepsWhateverIsKnown) {
  Record record;
  record.title = "Shot 7, \xC2\xB5s";
  record.started = "2020-04-30T19:12:52";
  record.warnings = {"one sentence.", "and another."};
  record.attributes = {{"operator", "N. N."}};
  record.provenance.source_file = "shot.tdms";
  record.provenance.importer = "tdms";
  record.provenance.edits = {
      {"map channel", "Kraft", {{"map", "m.toml"}, {"name in file", "ch \xC3\xA4"}}},
      {"low-pass, zero phase", "Kraft", {}}};
  record.channels = {particular("Kraft \xC3\xA4/1"),
                     particular("Kraft \xC3\xA4/1"),
                     particular("7 end"),
                     particular("end"),
                     particular("recording"),
                     particular("")};
  record.channels[1].clock = {0.5, 0.25, {0.5, 0.6, 1.0}};
  record.channels[1].valid.clear();
  record.channels[2].raw = std::vector<double>{};
  record.channels[2].valid.clear();
  record.channels[3].raw = std::vector<std::int32_t>{1, 2, 3};
  record.channels[3].scale = 0.1;
  record.channels[3].offset = -7.0;
  record.channels[4].imaginary = {1, 1.0 / 3.0, -0.0};
  record.channels[4].calibration.reset();
  record.channels[5].delay.reset();
  const Record back = round_trip(record, ".mat");
  EXPECT_EQ(back.title, record.title);
  EXPECT_EQ(back.started, record.started);
  std::vector<std::string> warnings = record.warnings;
  warnings.push_back(
      fmt::format("2 channels are called '{}': the name means the first of them, an "
                  "index any other",
                  record.channels[0].name));
  EXPECT_EQ(back.warnings, warnings);
  EXPECT_EQ(back.attributes.at("operator"), "N. N.");
  EXPECT_EQ(back.attributes.at("origin file"), "shot.tdms");
  EXPECT_EQ(back.attributes.at("origin format"), "tdms");
  ASSERT_EQ(back.provenance.edits.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(back.provenance.edits[i].what, record.provenance.edits[i].what);
    EXPECT_EQ(back.provenance.edits[i].channel, record.provenance.edits[i].channel);
    EXPECT_EQ(back.provenance.edits[i].parameters, record.provenance.edits[i].parameters);
  }
  ASSERT_EQ(back.channels.size(), record.channels.size());
  for (std::size_t c = 0; c < back.channels.size(); ++c) {
    SCOPED_TRACE(c);
    const Channel& was = record.channels[c];
    const Channel& is = back.channels[c];
    expect_same_head(was, is);
    expect_same_samples(was, is);
    EXPECT_EQ(is.valid, was.valid);
    EXPECT_EQ(is.attributes, was.attributes);
    ASSERT_EQ(is.calibration.has_value(), was.calibration.has_value());
    if (was.calibration) {
      EXPECT_EQ(is.calibration->sensitivity, was.calibration->sensitivity);
      EXPECT_EQ(is.calibration->uncertainty, was.calibration->uncertainty);
      EXPECT_EQ(is.calibration->recorded_unit, was.calibration->recorded_unit);
      EXPECT_EQ(is.calibration->physical_unit, was.calibration->physical_unit);
      EXPECT_EQ(is.calibration->source, was.calibration->source);
    }
    ASSERT_EQ(is.delay.has_value(), was.delay.has_value());
    if (was.delay) {
      EXPECT_EQ(is.delay->value, was.delay->value);
      EXPECT_EQ(is.delay->uncertainty, was.delay->uncertainty);
      EXPECT_EQ(is.delay->removed, was.delay->removed);
    }
  }
  EXPECT_TRUE(std::holds_alternative<std::vector<float>>(back.channels[0].raw));
}

// The file built from its parts by the tests' own MatBytes.
TEST(MatExport, IsWrittenAsTheStandardSays) {
  Record record;
  record.channels.resize(1);
  Channel& channel = record.channels[0];
  channel.name = "F 1";
  channel.unit = "N";
  channel.quantity = Quantity::force;
  channel.clock = {0.5, 0.25, {}};
  channel.raw = std::vector<double>{1.0, 2.0, 3.0};
  channel.valid = {1, 0, 1};
  const OutputPath path(".mat");
  export_recording(record, path);
  const std::string bytes = tests::bytes_of(path);

  const tests::MatBytes b{std::endian::native == std::endian::big};
  const auto word = [&b](const std::string& letters) {
    const std::vector<std::uint16_t> units(letters.begin(), letters.end());
    const std::string data = b.numbers(units);
    const auto n = static_cast<std::int32_t>(units.size());
    return b.matrix(b.head(4, {n > 0 ? 1 : 0, n}, "") +
                    (n == 1 || n == 2 ? b.small(4, data) : b.element(4, data)));
  };
  const std::string none = b.matrix(b.head(6, {0, 0}, "") + b.element(9, ""));
  const std::string no_pairs = b.structure("", {"name", "value"}, "", 0);
  const std::string marks = b.matrix(b.head(0x0209, {3, 1}, "") + b.small(2, {0, 1, 0}));
  EXPECT_EQ(bytes.substr(0, 19), "MATLAB 5.0 MAT-file");
  EXPECT_EQ(bytes.substr(116, 12), b.header().substr(116));
  EXPECT_EQ(
      bytes.substr(128),
      b.structure(
          "recording",
          {"format", "format_version", "title", "start_time", "source_file", "source_sha256",
           "source_format", "source_program", "edits", "warnings", "attributes"},
          word("impactrig-recording") + word("1.0") + word("") + word("") + word("") + word("") +
              word("") + word("") + b.structure("", {"what", "channel", "parameters"}, "", 0) +
              b.structure("", {"text"}, "", 0) + no_pairs) +
          b.structure("F_1",
                      {"name", "quantity", "unit", "start", "interval", "time", "value", "invalid",
                       "calibration", "delay", "attributes"},
                      word("F 1") + word("force") + word("N") + b.doubles("", {0.5}) +
                          b.doubles("", {0.25}) + none + b.doubles("", {1, 2, 3}) + marks + none +
                          none + no_pairs));
}

TEST(MatExport, NamesWhatItCannotHold) {
  Record record = example(3);
  record.channels[0].raw = std::vector<std::int16_t>(std::size_t{1} << 28);
  EXPECT_EQ(export_error(record, ".mat"),
            "OUT: 'Force' takes 2.1 GB, a variable of a MAT-file of this version at most 2.1 GB: "
            "choose a part with --from and --to, or write a .h5 file, which MATLAB reads with "
            "h5read");
}

TEST(MatExport, WhatIsAddedToItIsNamed) {
  const OutputPath path(".mat");
  export_recording(example(3), path);
  const tests::MatBytes b{std::endian::native == std::endian::big};
  const Record back =
      tests::imported(tests::bytes_of(path) + b.doubles("x", {1}) + b.text("note", "hit") +
                          b.structure("run", {"value"}, b.doubles("", {1})),
                      {}, ".mat");
  EXPECT_EQ(back.channels.size(), 2U);
  EXPECT_THAT(back.warnings,
              testing::ElementsAre("not read, since no channel of the recording is there: 'run', "
                                   "'x', 'note'"));
}

}  // namespace
}  // namespace impactrig::acquisition
