// SPDX-License-Identifier: BSD-3-Clause
// MATLAB's files of version 7.3, which are HDF5.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "acquisition/importer.hpp"
#include "tests/acquisition/hdf5_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using tests::Hdf5File;
using tests::imported;

TEST(ForeignHdf5, MatlabFilesAreNamedAsMatlabDoes) {
  const Hdf5File file(512);
  file.group("/run");
  std::vector<double> matrix(303);
  std::iota(matrix.begin(), matrix.end(), 0.0);
  // MATLAB's 101 x 3: HDF5's shape is the other way round
  file.data<double>("/run/m", {3, 101}, matrix, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
  file.data<double>("/small", {2, 3}, {1, 2, 3, 4, 5, 6}, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
  file.data<double>("/run/Fs", {1, 1}, {50}, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
  file.data<std::uint16_t>("/note", {3, 1}, {'h', 'i', 't'}, H5T_NATIVE_UINT16, H5T_STD_U16LE);
  file.text("/note", "MATLAB_class", "char");
  file.group("/#refs#");
  file.doubles("/#refs#/a", {1, 2});
  const auto record = imported(tests::mat73_bytes(file), {}, ".mat");
  EXPECT_EQ(record.provenance.importer, "mat");
  ASSERT_EQ(record.channels.size(), 5U);
  EXPECT_EQ(record.channels[0].name, "run.Fs");
  EXPECT_EQ(record.channels[2].name, "run.m:2");
  EXPECT_EQ(record.channels[2].value(0), 101.0);
  EXPECT_EQ(record.channels[2].clock.interval, 0.02);
  EXPECT_EQ(record.channels[2].attributes.at("size"), "101 x 3");
  EXPECT_EQ(record.channels[4].name, "small");
  EXPECT_THAT(record.channels[4].values(), ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_EQ(record.attributes.at("note"), "hit");
}

// shots x channels x samples
/// A Simcenter Testlab export: an axis as start and increment, in the unit of its label.
std::string testlab(const std::vector<std::uint16_t>& label) {
  const Hdf5File file(512);
  for (const char* const group :
       {"/Signal_0", "/Signal_0/x_values", "/Signal_0/x_values/quantity", "/Signal_0/y_values"})
    file.structure(group);
  const std::string axis = "/Signal_0/x_values/";
  file.matlab(axis + "start_value", {-0.5});
  file.matlab(axis + "increment", {0.25});
  file.data<std::uint16_t>(axis + "quantity/label", {label.size(), 1}, label, H5T_NATIVE_UINT16,
                           H5T_STD_U16LE);
  file.text(axis + "quantity/label", "MATLAB_class", "char");
  file.matlab("/Signal_0/y_values/values", {1, 2, 3});
  return tests::mat73_bytes(file);
}

TEST(ForeignHdf5, AnAxisOfTestlabInMatFilesOfVersion73IsTheClock) {
  const auto named = [](const datasets::Record& record) {
    return *std::ranges::find(record.channels, "Signal_0.y_values.values",
                              &datasets::Channel::name);
  };
  const auto channel = named(imported(testlab({'s'}), {}, ".mat"));
  EXPECT_EQ(channel.clock.start, -0.5);
  EXPECT_EQ(channel.clock.interval, 0.25);
  EXPECT_EQ(channel.unit, "") << "values may be in SI or in the unit of the label";
  const auto spectrum = named(imported(testlab({'H', 'z'}), {}, ".mat"));
  EXPECT_EQ(spectrum.clock.interval, 0.0);
  EXPECT_EQ(spectrum.attributes.at("domain"), "frequency");
  EXPECT_EQ(spectrum.attributes.at("abscissa increment"), "0.25");
}

// Of objects MATLAB keeps six integers here, of sparse matrices rows and columns.
TEST(ForeignHdf5, WhatIsNoArrayOfMatlabsIsNoChannel) {
  const Hdf5File file(512);
  file.doubles("/force", {1, 2, 3});
  file.text("/force", "MATLAB_class", "double");
  file.data<std::uint32_t>("/label", {1, 6}, {3707764736, 2, 1, 1, 1, 1}, H5T_NATIVE_UINT32,
                           H5T_STD_U32LE);
  file.text("/label", "MATLAB_class", "string");
  file.group("/loads");
  file.text("/loads", "MATLAB_class", "double");
  file.number("/loads", "MATLAB_sparse", 4);
  for (const char* const path : {"/loads/data", "/loads/ir", "/loads/jc"}) file.doubles(path, {1});
  file.group("/run");
  file.text("/run", "MATLAB_class", "struct");
  file.group("/run/f");
  file.text("/run/f", "MATLAB_class", "function_handle");
  file.doubles("/run/f/workspace", {1, 2});
  const auto record = imported(tests::mat73_bytes(file), {}, ".mat");
  ASSERT_EQ(record.channels.size(), 1U);
  EXPECT_EQ(record.channels[0].name, "force");
  EXPECT_EQ(record.warnings[0],
            "not read: 'label' (an object of class string), 'loads' (a sparse matrix), 'run.f' (a "
            "function handle)");
}

TEST(ForeignHdf5, FieldsOfSeveralStructuresOfMatlabAreChannels) {
  const auto record = imported(tests::mat73_structures(), {}, ".mat");
  std::vector<std::string> names;
  for (const datasets::Channel& channel : record.channels) names.push_back(channel.name);
  EXPECT_THAT(names, testing::UnorderedElementsAre("run(1).force", "run(2).force", "run(1).t",
                                                   "run(2).t", "run(1).set.gain", "run(2).set.gain",
                                                   "run(1).set.deep.x", "run(2).set.deep.x"));
  EXPECT_THAT(record.find("run(1).force")->values(), ElementsAre(1, 2, 3));
  EXPECT_THAT(record.find("run(2).force")->values(), ElementsAre(4, 5, 6));
  EXPECT_THAT(record.find("run(2).set.deep.x")->values(), ElementsAre(8, 9, 10));
  // each structure has its own time
  EXPECT_EQ(record.find("run(1).force")->clock.interval, 0.5);
  EXPECT_EQ(record.find("run(2).force")->clock.interval, 0.25);
  for (const std::string& warning : record.warnings)
    EXPECT_EQ(warning.find("not read"), std::string::npos) << warning;
}

/// A line of letters, or several one below the other, in MATLAB's order.
void letters(const Hdf5File& file, const std::string& path, const std::vector<std::string>& lines) {
  std::vector<std::uint16_t> codes;
  for (std::size_t i = 0; i < lines.front().size(); ++i)
    for (const std::string& line : lines)
      codes.push_back(static_cast<std::uint16_t>(static_cast<unsigned char>(line[i])));
  file.data<std::uint16_t>(path, {lines.front().size(), lines.size()}, codes, H5T_NATIVE_UINT16,
                           H5T_STD_U16LE);
  file.text(path, "MATLAB_class", "char");
}

// A matrix of letters, a cell array, and the text of a structure: as of the versions before.
TEST(ForeignHdf5, TextsOfMatlabNameColumnsAndTheirUnits) {
  const Hdf5File file(512);
  std::vector<double> matrix(202);
  std::iota(matrix.begin(), matrix.end(), 0.0);
  file.group("/#refs#");
  letters(file, "/#refs#/a", {"kN"});
  letters(file, "/#refs#/b", {"mm/s"});
  for (const char* const structure : {"/lines", "/cells", "/run"}) file.structure(structure);
  for (const char* const path : {"/lines/data", "/cells/data"}) {
    file.data<double>(path, {2, 101}, matrix, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
    file.text(path, "MATLAB_class", "double");
  }
  letters(file, "/lines/labels", {"force", "speed"});
  file.references("/cells/units", {2, 1}, {"/#refs#/a", "/#refs#/b"});
  file.text("/cells/units", "MATLAB_class", "cell");
  file.matlab("/run/force", std::vector<double>(101, 1.0));
  letters(file, "/run/unit", {"kN"});
  const auto record = imported(tests::mat73_bytes(file), {}, ".mat");
  std::vector<std::string> seen;
  for (const datasets::Channel& channel : record.channels)
    seen.push_back(channel.name + " [" + channel.unit + "]");
  EXPECT_THAT(seen, testing::UnorderedElementsAre("lines.data.force []", "lines.data.speed []",
                                                  "cells.data:1 [kN]", "cells.data:2 [mm/s]",
                                                  "run.force [kN]"));
}

// References are compared with what is there, not followed.
TEST(ForeignHdf5, FieldsOfMatlabThatAreNoNumbersAreTold) {
  const Hdf5File file(512);
  file.group("/#refs#");
  file.matlab("/#refs#/a", {1, 2, 3});
  file.references("/#refs#/b", {1, 1}, {"/#refs#/a"});
  file.text("/#refs#/b", "MATLAB_class", "cell");
  file.structure("/#refs#/c");
  file.references("/#refs#/c/again", {2, 1}, {"/#refs#/c", "/#refs#/a"});
  file.structure("/run");
  file.references("/run/x", {4, 1}, {"/#refs#/a", "", "/#refs#/b", "/#refs#/a"});
  file.references("/run/z", {1, 1}, {"/#refs#/a"});
  file.text("/run/z", "MATLAB_class", "function_handle");
  file.references("/run/y", {1, 1}, {"/#refs#/c"});
  file.references("/cells", {1, 1}, {"/#refs#/a"});
  file.text("/cells", "MATLAB_class", "cell");
  const auto record = imported(tests::mat73_bytes(file), {}, ".mat");
  EXPECT_THAT(record.find("run(1).x")->values(), ElementsAre(1, 2, 3));
  EXPECT_THAT(record.find("run(4).x")->values(), ElementsAre(1, 2, 3));
  EXPECT_THAT(record.find("run(1).y(2).again")->values(), ElementsAre(1, 2, 3));
  std::string told;
  for (const std::string& warning : record.warnings)
    if (warning.starts_with("not read")) told = warning;
  EXPECT_THAT(told, testing::HasSubstr("'run(2).x' (a reference that leads nowhere)"));
  EXPECT_THAT(told, testing::HasSubstr("'run.z' (references)"));
  EXPECT_THAT(record.find("run(3).x{1}")->values(), ElementsAre(1, 2, 3));
  EXPECT_THAT(record.find("cells{1}")->values(), ElementsAre(1, 2, 3));
  EXPECT_THAT(told, testing::HasSubstr("(nested too deeply)"));
}

TEST(ForeignHdf5, FieldsOfMatlabThatAreTooManyAreTold) {
  const Hdf5File file(512);
  file.group("/#refs#");
  file.matlab("/#refs#/a", {1, 2, 3});
  file.structure("/run");
  const std::vector<std::string> names(6000, "/#refs#/a");
  file.references("/run/x", {6000, 1}, names);
  file.references("/run/y", {6000, 1}, names);
  const auto record = imported(tests::mat73_bytes(file), {}, ".mat");
  EXPECT_EQ(record.channels.size(), 10000U);
  bool told = false;
  for (const std::string& warning : record.warnings)
    told = told || warning == "not read: more than 10000 fields of structures";
  EXPECT_TRUE(told);
}

}  // namespace
}  // namespace impactrig::acquisition
