// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <string>

#include "acquisition/importer.hpp"
#include "acquisition/importers/formats.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Quantity;
using datasets::Record;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::import_error;
using tests::imported;
using tests::names_and_units;

const std::string polytec_head =
    "Source File Name:\tScan\r\nPoint Index:\t3\r\nComponent:\tRoot\r\n";

TEST(PolytecAscii, TakesItsQuantityFromTheUnitOrTheSignal) {
  const Record record =
      imported(polytec_head +
               "Signal:\tTime - Vib Velocity - Samples\r\n\r\nTime\tTime Signal\r\n"
               "[ s ]\t[ mm/s ]\r\n0\t1.5\r\n0.5\t2.5\r\n1\t3.5\r\n");
  EXPECT_EQ(record.provenance.importer, "polytec-ascii");
  EXPECT_THAT(names_and_units(record), ElementsAre("Time Signal [mm/s]"));
  EXPECT_EQ(record.channels[0].quantity, Quantity::velocity);
  EXPECT_EQ(record.channels[0].clock.interval, 0.5);
  EXPECT_EQ(record.channels[0].attributes.at("signal"), "Vib Velocity");
  EXPECT_EQ(record.channels[0].attributes.at("display"), "Samples");
  EXPECT_EQ(record.attributes.at("Point Index"), "3");
  EXPECT_EQ(record.title, "Vib Velocity");
  EXPECT_THAT(record.warnings, IsEmpty());
  const Record odd = imported(
      "Signal:\tTime - Vib Velocity - Samples\nTime\tTime Signal\n[ s ]\t[ gizmo ]\n0\t1\n1\t2\n");
  EXPECT_EQ(odd.channels[0].quantity, Quantity::velocity);
}

TEST(PolytecAscii, MayHaveTabsAtTheEndsOfItsLines) {
  const Record record = imported(
      "Signal:\tTime - Vib Velocity - Samples\t\nTime\tVelocity\t\r\n[ ms ]\t[ mm/s ]\t\r\n"
      "0\t1.5\t\r\n0.5\t2.5\t\r\n1\t3.5\t\r\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Velocity [mm/s]"));
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1.5, 2.5, 3.5));
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 0.5e-3);
  EXPECT_THAT(record.warnings, IsEmpty());
}

TEST(PolytecAscii, MayHaveSeveralColumnsAndDecimalCommas) {
  const Record record = imported(
      "Signal:\tTime - Vib 3D Velocity - Samples\n\nTime\tX\tY\tZ\n[ ms ]\t[ m/s ]\t[ m/s ]\t[ m/s "
      "]\n"
      "0\t1,5\t2\t3\n0,5\t2,5\t3\t4\n1\t3,5\t4\t\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("X [m/s]", "Y [m/s]", "Z [m/s]"));
  EXPECT_DOUBLE_EQ(record.channels[0].clock.interval, 0.5e-3);
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1.5, 2.5, 3.5));
  EXPECT_THAT(record.channels[2].valid, ElementsAre(1, 1, 0));
  EXPECT_THAT(record.warnings,
              ElementsAre(HasSubstr("'Z': 1 of 3 values is missing, the first at ")));
}

TEST(PolytecAscii, ALastNumberThatMayBeCutIsTold) {
  const std::string text = polytec_head +
                           "Signal:\tTime - Vib Velocity - Samples\r\n\r\nTime\tTime Signal\r\n"
                           "[ s ]\t[ m/s ]\r\n0\t1.250\r\n1\t2.125\r\n2\t3.500\r\n";
  const auto told = testing::MatchesRegex(
      "the file ends without a line end, and its last number '4.5' has fewer digits than those "
      "above it, or no mark behind it as they have: it may be cut off, and the row at .* is left "
      "out");
  EXPECT_EQ(imported(text + "3\t4.5").channels.at(0).size(), 3U);
  EXPECT_THAT(imported(text + "3\t4.5").warnings, ElementsAre(told));
  EXPECT_THAT(imported(text + "3\t4.534").warnings, IsEmpty());
  const tests::WrittenFile file(text + "3\t4.5");
  EXPECT_THAT(open_polytec_ascii_by_blocks(file.path(), {})->head().record.warnings,
              ElementsAre(told));
}

TEST(PolytecAscii, OfASpectrumHasNoClock) {
  const Record record = imported(
      "Signal:\tFFT - Vib Velocity - Real & Imag.\n\nFrequency\tReal\tImaginary\n"
      "[ Hz ]\t[ m/s ]\t[ m/s ]\n10\t1\t2\n12.5\t2\t3\n15\t3\t4\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Real [m/s]", "Imaginary [m/s]"));
  EXPECT_EQ(record.channels[0].clock.interval, 0.0);
  EXPECT_EQ(record.channels[0].attributes.at("domain"), "frequency");
  EXPECT_EQ(record.channels[0].attributes.at("abscissa first"), "10");
  EXPECT_EQ(record.channels[0].attributes.at("abscissa increment"), "2.5");
  EXPECT_THAT(record.warnings,
              ElementsAre("this is no time record: 'Vib Velocity' over Frequency [Hz]"));
}

TEST(PolytecAscii, WithUnevenFrequenciesBringsThemAsAChannel) {
  const Record record = imported(
      "Signal:\tOctave - Vib Velocity - Magnitude\nFrequency\tMagnitude\n[ Hz ]\t[ m/s "
      "]\n1\t1\n2\t2\n4\t3\n8\t4\n");
  EXPECT_THAT(names_and_units(record), ElementsAre("Frequency [Hz]", "Magnitude [m/s]"));
  EXPECT_THAT(record.channels[0].values(), ElementsAre(1.0, 2.0, 4.0, 8.0));
}

TEST(PolytecAscii, WithoutItsUnitLineIsAnError) {
  EXPECT_EQ(import_error(polytec_head +
                         "Signal:\tTime - Vib Velocity - Samples\nTime\tTime Signal\n0\t1\n"),
            "FILE: this is a Polytec text export without its line of units: expected a line such "
            "as '[ s ] [ m/s ]' under the "
            "column names");
}

}  // namespace
}  // namespace impactrig::acquisition
