// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <random>

#include "acquisition/importer.hpp"
#include "datasets/input_error.hpp"
#include "tests/acquisition/bytes.hpp"
#include "tests/acquisition/tdm_shot.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

namespace fs = std::filesystem;

using datasets::Record;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;
using tests::imported_shot;
using tests::shot_error;
using tests::tdm_header;
using tests::TdmChannel;

const std::string samples = tests::bytes_of_numbers(std::vector<double>{7, 8, 9});

TdmChannel clocked() {
  TdmChannel channel;
  channel.attributes = "<double_attribute name=\"wf_increment\">1</double_attribute>";
  return channel;
}

TEST(TdmErrors, WhatIsCutOffIsToldOf) {
  const Record record = imported_shot(tdm_header({{"G", {clocked()}}}), samples.substr(0, 20));
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(7, 8));
  EXPECT_THAT(record.warnings, ElementsAre("'F': the file ends after 2 of 3 samples"));
  TdmChannel beyond = clocked();
  beyond.block = R"(byteOffset="1000" length="3" valueType="eFloat64Usi")";
  EXPECT_EQ(imported_shot(tdm_header({{"G", {beyond}}}), samples).channels.at(0).size(), 0U);
  for (const char* const type : {"eTimeUsi", "eFloat64Usi"}) {
    beyond.block = fmt::format(R"(byteOffset="1000" length="3" valueType="{}")", type);
    beyond.says = "<datatype>DT_DATE</datatype>";
    EXPECT_EQ(imported_shot(tdm_header({{"G", {beyond}}}), samples).channels.at(0).size(), 0U);
  }
  const std::string header = tdm_header({{"G", {clocked()}}});
  EXPECT_THAT(shot_error(header.substr(0, header.size() / 2), samples),
              StartsWith("FILE: the description is no whole XML document (is it cut off?): "));
  const std::string packed = tests::packed_tdm(header);
  EXPECT_THAT(shot_error(packed.substr(0, packed.size() - 30), samples),
              StartsWith("FILE: the ZIP archive cannot be read: "));
}

// The last part of a url counts, and only a file beside the description is read.
TEST(TdmErrors, SamplesAreNeverSoughtInAnotherFolder) {
  const fs::path folder = fs::path(testing::TempDir()) / "impactrig_tdm_folder";
  fs::remove_all(folder);
  fs::create_directories(folder / "inner");
  const auto write = [](const fs::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
  };
  write(folder / "outside.tdx", samples);
  const fs::path description = folder / "inner" / "shot.tdm";
  const auto error = [&](const std::string& url) {
    write(description, tdm_header({{"G", {clocked()}, "", url}}));
    try {
      import_recording(description.string(), {});
    } catch (const datasets::InputError& problem) {
      return std::string(problem.what());
    }
    return std::string();
  };
  for (const std::string& url :
       {std::string("../outside.tdx"), (folder / "outside.tdx").string(), std::string(".."),
        std::string("..%2Foutside.tdx"), std::string("..\\outside.tdx"), std::string()})
    EXPECT_THAT(error(url), HasSubstr(fmt::format(
                                "the samples are in '{}', which is not beside this description: "
                                "copy both files into one folder",
                                url)));
  write(folder / "inner" / "a b.tdx", samples);
  EXPECT_EQ(error("C:\\data\\a b.tdx"), "");
  EXPECT_EQ(error("file:///data/a%20b.tdx"), "");
  fs::remove(folder / "inner" / "a b.tdx");
  write(folder / "inner" / "shot.tdx", samples);  // both were renamed
  write(description, tdm_header({{"G", {clocked()}, "", "old.tdx"}}));
  const Record record = import_recording(description.string(), {});
  EXPECT_THAT(record.channels.at(0).values(), ElementsAre(7, 8, 9));
  EXPECT_THAT(record.warnings,
              ElementsAre("the description names its samples 'old.tdx', which is not beside it: "
                          "read is 'shot.tdx', which has its own name"));
  EXPECT_THAT(files_of_recording(description.string()), SizeIs(2));
  fs::remove_all(folder);
}

TEST(TdmErrors, WhatIsNotReadIsNamed) {
  const auto left_out = [](TdmChannel channel) {
    channel.name = "x";
    const Record record = imported_shot(tdm_header({{"G", {clocked(), channel}}}), samples);
    EXPECT_THAT(record.channels, SizeIs(1));
    EXPECT_THAT(record.warnings, SizeIs(1));
    return record.warnings.empty() ? "" : record.warnings.front();
  };
  TdmChannel channel;
  channel.block = R"(byteOffset="0" length="3" valueType="eStringUsi")";
  EXPECT_EQ(left_out(channel), "'x' holds 3 texts: it is left out");
  channel.block = R"(byteOffset="0" length="3" valueType="eComplexUsi")";
  EXPECT_EQ(left_out(channel),
            "'x' is left out: its numbers are of the type 'eComplexUsi', which is not known");
  for (const char* const block :
       {R"(byteOffset="-1" length="3" valueType="eInt16Usi")",
        R"(byteOffset="0" length="3" blockSize="1" valueType="eInt16Usi")",
        R"(byteOffset="0" length="99999999999999999999" valueType="eInt16Usi")"}) {
    channel.block = block;
    EXPECT_EQ(left_out(channel),
              "'x' is left out: the description does not say where its numbers are");
  }
  channel.block = "";
  EXPECT_EQ(left_out(channel), "'x' is left out: it refers to no numbers");
  channel.values = "<f>1</f>";
  EXPECT_EQ(left_out(channel),
            "'x' is left out: its numbers stand in the description, not in a file of samples");
  channel.representation = "implicit_saw";
  EXPECT_EQ(left_out(channel),
            "'x' is left out: its numbers are a 'implicit_saw', which is not read");
  channel.representation = "implicit_linear";
  EXPECT_EQ(left_out(channel), "'x' is left out: it states no course of its numbers");
}

// A course takes no memory and no byte of the file, but time: it is as long as samples are.
TEST(TdmErrors, ACourseIsNoLongerThanSamplesAre) {
  TdmChannel course{"Time", "s", "", "implicit_linear", "0 1"};
  course.rows = 2000000000;
  const Record record = imported_shot(tdm_header({{"G", {course, clocked()}}}), samples);
  EXPECT_THAT(record.channels, SizeIs(1));
  EXPECT_THAT(
      record.warnings,
      ElementsAre("'Time' is left out: it is a course of 2000000000 numbers, and no channel "
                  "of the file has more than 3 samples"));
}

TEST(TdmErrors, RefusesWhatIsNoDescription) {
  std::string nowhere = tdm_header({{"G", {TdmChannel{"x", "s", "", "implicit_linear", "0 1"}}}});
  const std::size_t file = nowhere.find("<file");
  nowhere.erase(file, nowhere.find("</file>") + 7 - file);
  EXPECT_EQ(shot_error(nowhere, samples), "FILE: the description names no file of samples");
  EXPECT_EQ(shot_error("<?xml version=\"1.0\"?><other><!--<usi:tdm--></other>", samples),
            "FILE: expected the element 'usi:tdm', found 'other'");
  EXPECT_EQ(shot_error("<?xml version=\"1.0\"?><usi:tdm></usi:tdm>", samples),
            "FILE: the description has no element 'usi:data', which lists the channels");
  EXPECT_EQ(tests::import_error(tests::zip_archive({{"header.xml", "text", true}}), {}, ".tdm"),
            "FILE: the description is no whole XML document (is it cut off?): No document element "
            "found at byte 4");
}

/// What reading takes at most, to see that nothing grows with what is announced.
double seconds_of(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

TEST(TdmErrors, BombsDoNotGoOff) {
  const std::string header = tdm_header({{"G", {clocked()}}});
  // entities of a document type are not replaced
  std::string entities = "<!DOCTYPE lolz [<!ENTITY a \"aaaaaaaaaa\">";
  for (char c = 'b'; c < 'z'; ++c) {
    entities += fmt::format("<!ENTITY {} \"", c);
    for (int i = 0; i < 10; ++i) entities += fmt::format("&{};", static_cast<char>(c - 1));
    entities += "\">";
  }
  std::string bomb = header;
  bomb.insert(bomb.find("<usi:tdm"), entities + "]>");
  bomb.replace(bomb.find("Shot 7"), 6, "&y;");
  EXPECT_LT(seconds_of([&] { EXPECT_EQ(imported_shot(bomb, samples).title, "&y;"); }), 5);
  // elements in elements
  std::string deep = header;
  std::string open, close;
  for (int i = 0; i < 300000; ++i) {
    open += "<a>";
    close += "</a>";
  }
  deep.insert(deep.find("<channelgroups>"), open + close);
  EXPECT_LT(seconds_of([&] { imported_shot(deep, samples); }), 5);
  // a channel that is listed again and again
  std::string listed = header;
  std::string again;
  for (int i = 0; i < 100000; ++i) again += " id(\"ch0_0\")";
  listed.insert(listed.find(" id(\"ch0_0\")") == std::string::npos
                    ? listed.find("id(\"ch0_0\")", listed.find("<channels>"))
                    : listed.find(" id(\"ch0_0\")"),
                again.substr(1) + " ");
  EXPECT_LT(seconds_of([&] { EXPECT_THAT(imported_shot(listed, samples).channels, SizeIs(1)); }),
            5);
  // elements beyond any need, and a packed description that is larger unpacked
  std::string many = header;
  std::string elements;
  for (int i = 0; i < 2100000; ++i) elements += "<a/>";
  many.insert(many.find("<channelgroups>"), elements);
  EXPECT_EQ(shot_error(many, samples),
            "FILE: the description has more elements than 10000 channels need");
  EXPECT_EQ(tests::import_error(tests::packed_tdm(header + std::string(std::size_t{40} << 20, ' ')),
                                {}, ".tdm"),
            "FILE: the description is larger than 32 MB, more than 10000 channels need");
}

TEST(TdmErrors, TextBecomesUtf8) {
  TdmChannel channel = clocked();
  channel.name = "a\xFF&#0;b";
  channel.unit = "\xC2\xB5m";
  channel.says = "<description>&#181;, \xE4 &#xD800;</description>";
  const Record record = imported_shot(tdm_header({{"G", {channel}}}), samples);
  EXPECT_EQ(record.channels.at(0).unit, "\xC2\xB5m");
  EXPECT_THAT(record.channels[0].name, StartsWith("a\xC3\xBF"));
  EXPECT_THAT(record.channels[0].attributes.at("description"), HasSubstr("\xC3\xA4"));
}

// The file of samples stays whole: what the description says of it may be anything.
TEST(TdmErrors, DamagedDescriptionsAreReadOrRefused) {
  const std::vector<std::string> seeds = tests::tdm_seeds();
  int read = 0;
  for (unsigned seed = 0; seed < 600; ++seed) {
    std::mt19937 random(seed);
    std::string damaged = seeds[seed % seeds.size()];
    if (seed % 4 == 0) damaged.resize(random() % damaged.size());
    for (unsigned k = 0; k < seed % 6 && !damaged.empty(); ++k) {
      char& byte = damaged[random() % damaged.size()];
      byte = byte >= '0' && byte <= '9' ? static_cast<char>('0' + random() % 10)
                                        : static_cast<char>(random());
    }
    SCOPED_TRACE(fmt::format("seed {}", seed));
    const tests::WrittenFile beside(std::string(400, '\x41'), ".tdx");
    const tests::WrittenFile file(damaged, ".tdm");
    ImportOptions options;
    options.format = "tdm";
    options.require_clock = false;
    try {
      for (const datasets::Channel& channel : import_recording(file.path(), options).channels)
        ASSERT_LE(channel.size(), 400U);
      ++read;
    } catch (const datasets::InputError& error) {
      ASSERT_THAT(error.what(), HasSubstr(": "));
    }
  }
  EXPECT_GT(read, 60);  // a seventh of them has no damage but in texts
}

}  // namespace
}  // namespace impactrig::acquisition
