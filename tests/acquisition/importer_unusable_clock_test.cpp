// SPDX-License-Identifier: BSD-3-Clause
// Files that state a sample interval or a rate that can be none.
#include <gmock/gmock.h>

#include <limits>
#include <string>
#include <vector>

#include "acquisition/importer.hpp"
#include "tests/acquisition/hdf5_bytes.hpp"
#include "tests/acquisition/lvm_bytes.hpp"
#include "tests/acquisition/mat_bytes.hpp"
#include "tests/acquisition/sigrok_bytes.hpp"
#include "tests/acquisition/tdms_bytes.hpp"
#include "tests/acquisition/tek_isf_bytes.hpp"
#include "tests/acquisition/tek_wfm_bytes.hpp"
#include "tests/acquisition/uff58_function.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using tests::import_error;
using tests::imported;

const std::string way_out = ": state it with --sample-rate, or the column with --time-column";

/// The error, whose channels are those of the file.
std::string why(const std::string& channels, const std::string& stated) {
  return "FILE: " + channels + " no sample rate, since the file states " + stated + way_out;
}

TEST(UnusableClock, OfOscilloscopesIsTold) {
  tests::TekWfm wfm;
  wfm.interval = 0.0;
  EXPECT_EQ(import_error(wfm.bytes()), why("'waveform' has", "a sample interval of 0 s"));
  wfm.interval = -1e-6;
  wfm.x_unit = "us";
  EXPECT_EQ(import_error(wfm.bytes()), why("'waveform' has", "a sample interval of -1e-06 us"));
  wfm.interval = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(import_error(wfm.bytes()), why("'waveform' has", "a sample interval of nan us"));
  ImportOptions options;
  options.sample_rate = 1e6;
  EXPECT_EQ(imported(wfm.bytes(), options).channels.at(0).clock.interval, 1e-6);
}

TEST(UnusableClock, OfTextsIsTold) {
  tests::uff58::Function function;
  function.increment = "  0.00000E+00";
  EXPECT_EQ(import_error(function.text()), why("'Hammer' has", "a sample interval of 0 s"));
  const tests::LvmFile lvm{'\t', "Tab", ".", "No", "Yes", ""};
  EXPECT_EQ(import_error(lvm.header() + lvm.segment(tests::lvm_two_channels("2", "0", "-0.5"),
                                                    "X_Value|a|b|Comment", "|1|2\n|3|4\n")),
            why("'a', 'b' have", "'Delta_X' as '-0.5'"));
  EXPECT_EQ(import_error("Sample rate,0 Hz\nF [N],v [m/s]\n1,5\n2,3\n"),
            why("'F', 'v' have", "'Sample rate' as '0 Hz'"));
  EXPECT_EQ(import_error("dt = -1e-5\nF [N],v [m/s]\n1,5\n2,3\n"),
            why("'F', 'v' have", "'dt' as '-1e-5'"));
  EXPECT_THAT(imported("Sample rate,0\nt [s],F [N]\n0,1\n1,5\n2,3\n").warnings,
              Not(Contains(HasSubstr("Sample rate"))));
}

TEST(UnusableClock, OfTdmsAndSigrokIsTold) {
  const tests::TdmsParts t;
  EXPECT_EQ(
      import_error(t.segment({t.channel("F", t.index(10, 2), {t.property("wf_increment", 0.0)})},
                             t.numbers(std::vector<double>{1, 2}))),
      why("'F' has", "a sample interval of 0 s"));
  EXPECT_EQ(import_error(tests::zip_archive({{"version", "2"},
                                             {"metadata", "[device 1]\nsamplerate=0 Hz\n"},
                                             {"analog-1-1-1", std::string(8, '\0')}})),
            why("'analog 1' has", "a sample rate of '0 Hz'"));
}

TEST(UnusableClock, OfNamedArraysIsTold) {
  const auto with = [](const std::string& path, const std::string& key, double value) {
    const tests::Hdf5File file;
    file.doubles("/force", {1, 5, 2});
    file.number(path, key, value);
    return file.bytes();
  };
  EXPECT_EQ(import_error(with("/force", "dt", -1.0)),
            why("'/force' has", "a sample interval of -1 s"));
  EXPECT_EQ(import_error(with("/", "fs", 0.0)), why("'/force' has", "a sample rate of 0 Hz"));
  const tests::Hdf5File short_times;
  short_times.doubles("/force", {1, 5, 2});
  short_times.doubles("/time", {0, 1});
  EXPECT_EQ(import_error(short_times.bytes()),
            why("'/force' has", "'/time' with 2 numbers for 3 samples"));
  const tests::MatBytes mat{};
  EXPECT_EQ(import_error(mat.header() + mat.doubles("force", {1, 5, 2}) + mat.doubles("Fs", {0})),
            why("'force' has", "'Fs' as 0"));
}

// An oscilloscope's text that states none has said nothing.
TEST(UnusableClock, IsOnlyWhatIsStated) {
  const std::string key = "XINCR 1.0E-6;";
  std::string isf = tests::Isf{}.bytes();
  isf.erase(isf.find(key), key.size());
  EXPECT_THAT(import_error(isf), HasSubstr("has neither times nor a sample rate"));
}

TEST(UnusableClock, OfTimesThatGoBackIsTold) {
  EXPECT_EQ(import_error("t [s],F [N]\n3,1\n2,5\n1,3\n"),
            "FILE: 'F' has no sample rate, since its times do not increase" + way_out);
}

TEST(UnusableClock, IsToldForEachReason) {
  const tests::Hdf5File file;
  file.doubles("/a", {1, 5, 2});
  file.doubles("/b", {1, 5, 2});
  file.number("/b", "fs", 0.0);
  EXPECT_EQ(import_error(file.bytes()),
            "FILE: '/a' has neither times nor a sample rate; '/b' has no sample rate, since the "
            "file states a sample rate of 0 Hz" +
                way_out);
}

}  // namespace
}  // namespace impactrig::acquisition
