// SPDX-License-Identifier: BSD-3-Clause
//
// MAT-files as programs write them, after their manuals.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "acquisition/importer.hpp"
#include "tests/acquisition/mat_byte_order.hpp"
#include "tests/acquisition/mat_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using testing::ElementsAre;
using tests::imported;
using tests::Mat;
using tests::MatBytes;

/// A Simcenter Testlab export: an axis as start and increment, in the unit of its label.
std::string testlab(const MatBytes& b, const std::string& label) {
  const std::string axis =
      b.structure("", {"start_value", "increment", "number_of_values", "quantity"},
                  b.doubles("", {-0.5}) + b.doubles("", {0.25}) + b.doubles("", {3}) +
                      b.structure("", {"label"}, b.text("", label)));
  const std::string values =
      b.structure("", {"values", "quantity"},
                  b.doubles("", {1, 2, 3}) + b.structure("", {"label"}, b.text("", "g")));
  return b.header() + b.structure("Signal_0", {"x_values", "y_values"}, axis + values);
}

TEST_P(Mat, AnAxisOfTestlabIsTheClock) {
  const auto named = [](const datasets::Record& record) {
    return *std::ranges::find(record.channels, "Signal_0.y_values.values",
                              &datasets::Channel::name);
  };
  const auto channel = named(imported(testlab(b, "s")));
  EXPECT_EQ(channel.clock.start, -0.5);
  EXPECT_EQ(channel.clock.interval, 0.25);
  EXPECT_EQ(channel.unit, "") << "values may be in SI or in the unit of the label";
  const auto spectrum = named(imported(testlab(b, "Hz")));
  EXPECT_EQ(spectrum.clock.interval, 0.0);
  EXPECT_EQ(spectrum.attributes.at("domain"), "frequency");
  EXPECT_EQ(spectrum.attributes.at("abscissa increment"), "0.25");
}

TEST_P(Mat, AHeaderOfPulseIsThatOfItsChannels) {
  const auto file = [this](const std::string& rate) {
    return b.header() +
           b.structure("File_Header", {"NumberOfChannels", "SampleFrequency"},
                       b.text("", "1") + b.text("", rate)) +
           b.structure("Channel_1_Header", {"SignalName", "Unit"},
                       b.text("", "Hammer") + b.text("", "N")) +
           b.doubles("Channel_1_Data", {1, 2, 3});
  };
  for (const char* rate : {"2048", "2048,0", "2048 2048"}) {
    const auto record = imported(file(rate));
    ASSERT_EQ(record.channels.size(), 1U);
    EXPECT_EQ(record.channels[0].name, "Hammer");
    EXPECT_EQ(record.channels[0].unit, "N");
    EXPECT_EQ(record.channels[0].quantity, datasets::Quantity::force);
    EXPECT_EQ(record.channels[0].clock.interval, 1.0 / 2048.0) << rate;
    EXPECT_EQ(record.channels[0].attributes.at("array"), "Channel_1_Data");
  }
  EXPECT_EQ(imported(file("2048 4096")).channels.at(0).clock.interval, 0.0);
}

// catman's export: a channel of times before those of its rate.
TEST_P(Mat, AHeaderSaysThatAChannelIsTheTime) {
  const auto channel = [this](int number, const std::string& name, const std::string& unit,
                              const std::string& rate, const std::vector<double>& values) {
    const std::string stem = "Channel_" + std::to_string(number);
    return b.structure(stem + "_Header", {"SignalName", "Unit", "SampleFrequency"},
                       b.text("", name) + b.text("", unit) + b.text("", rate)) +
           b.doubles(stem + "_Data", values);
  };
  const auto record = imported(
      b.header() + b.structure("File_Header", {"SampleFrequency"}, b.text("", "4")) +
      channel(1, "Time  1", "s", "4", {-0.5, -0.25, 0}) + channel(2, "Force", "N", "4", {1, 2, 3}) +
      channel(3, "Time  2", "ms", "2", {-500, 0}) + channel(4, "Acc", "g", "2", {4, 5}) +
      channel(5, "Strain", "um/m", "8", {1, 2, 3, 4}));
  const auto& force = *record.find("Force");
  EXPECT_EQ(force.clock.start, -0.5);
  EXPECT_EQ(force.clock.interval, 0.25);
  EXPECT_EQ(force.unit, "N");
  EXPECT_EQ(record.find("Acc")->clock.start, -0.5);
  EXPECT_EQ(record.find("Acc")->clock.interval, 0.5);
  EXPECT_EQ(record.find("Strain")->clock.interval, 0.125) << "of its own header";
  EXPECT_THAT(record.warnings, ElementsAre());
}

// [Keysight, Infiniium programmer's guide: MATLAB (.mat) File Format Specifications]
TEST_P(Mat, AnAxisOfInfiniiumMayBeOfFrequency) {
  const auto waveform = [this](const std::string& name, double step, const std::string& x,
                               const std::string& y) {
    return b.structure(name, {"XInc", "XOrg", "XUnits", "YUnits", "Data"},
                       b.doubles("", {step}) + b.doubles("", {-2.0}) + b.text("", x) +
                           b.text("", y) + b.doubles("", {1, 2, 3}));
  };
  const auto record = imported(b.header() + waveform("Channel_1", 0.5, "Second", "Volt") +
                               waveform("Function_1", 2500.0, "Hertz", "V"));
  const auto& channel = *record.find("Channel_1.Data");
  EXPECT_EQ(channel.clock.start, -2.0);
  EXPECT_EQ(channel.clock.interval, 0.5);
  EXPECT_EQ(channel.unit, "Volt");
  const auto& spectrum = *record.find("Function_1.Data");
  EXPECT_EQ(spectrum.clock.interval, 0.0);
  EXPECT_EQ(spectrum.attributes.at("domain"), "frequency");
  EXPECT_EQ(spectrum.attributes.at("abscissa increment"), "2500");
  EXPECT_THAT(record.warnings, ElementsAre());
}

// A capture: X, and what was recorded over it as Y.
TEST_P(Mat, ACaptureOfControlDeskHasItsTimesInX) {
  const std::string y =
      b.structure("", {"Name", "Unit", "Data"},
                  b.text("", "Model Root/Force") + b.text("", "N") + b.doubles("", {1, 2, 3}));
  const std::string x =
      b.structure("", {"Unit", "Data"}, b.text("", "ms") + b.doubles("", {-4, -3, -2}));
  const auto record = imported(b.header() + b.structure("rec1", {"X", "Y"}, x + y));
  const auto& force = *record.find("Model Root/Force");
  EXPECT_EQ(force.clock.start, -4e-3);
  EXPECT_EQ(force.clock.interval, 1e-3);
  EXPECT_EQ(force.unit, "N");
  EXPECT_THAT(record.warnings, ElementsAre());
}

// [BIOPAC, AcqKnowledge guide: isi, isi_units]
TEST_P(Mat, AnIntervalOfAcqKnowledgeHasItsUnitBeside) {
  const std::string samples = b.doubles("data", {1, 2, 3}) + b.doubles("isi", {0.5});
  EXPECT_EQ(imported(b.header() + samples + b.text("isi_units", "ms")).find("data")->clock.interval,
            0.5e-3);
  EXPECT_EQ(imported(b.header() + samples).find("data")->clock.interval, 0.0)
      << "elsewhere the interval of stimuli";
}

}  // namespace
}  // namespace impactrig::acquisition
