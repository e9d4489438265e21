// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <set>
#include <string>
#include <utility>

#include "acquisition/importer.hpp"
#include "datasets/input_error.hpp"
#include "tests/acquisition/wav_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using tests::import_error;
using tests::imported;
using tests::WrittenFile;
using namespace std::string_view_literals;

TEST(Importers, HaveDistinctNamesAndAGenericOneLast) {
  std::set<std::string_view> ids;
  for (const Importer& importer : importers()) {
    EXPECT_TRUE(ids.insert(importer.id).second) << importer.id;
    EXPECT_FALSE(importer.description.empty());
  }
  EXPECT_EQ(importers().back().id, "csv");
}

TEST(Import, FillsTheProvenance) {
  const std::string text = "time [s],F [N]\n0,1\n1,2\n";
  const WrittenFile file(text, ".csv");
  const datasets::Record record = import_recording(file.path());
  EXPECT_EQ(record.provenance.source_file, file.path());
  EXPECT_EQ(record.provenance.bytes, text.size());
  EXPECT_EQ(record.provenance.sha256, datasets::sha256_of(text));
  EXPECT_EQ(record.provenance.importer, "csv");
  EXPECT_EQ(record.provenance.program, datasets::program_version());
}

TEST(Import, OfAMissingFileOrADirectoryIsAFileError) {
  EXPECT_THROW(import_recording("/no/such/file.csv"), datasets::FileError);
  EXPECT_THROW(import_recording("/"), datasets::FileError);
}

std::string known() {
  std::string list;
  for (const Importer& importer : importers())
    list += (list.empty() ? "" : ", ") + std::string(importer.id);
  return list;
}

TEST(Import, SaysWhereUnitsAreStatedInstead) {
  ImportOptions options;
  options.units = {"V"};
  EXPECT_THAT(import_error(tests::wav_seeds().front(), options, ".wav"),
              testing::HasSubstr("--units is not for the format wav; a map states the units"));
}

TEST(Import, OfUnknownContentNamesTheKnownFormats) {
  EXPECT_EQ(
      import_error("\x01\x02\x00\x00\xFF\x00\x10"sv, {}, ".csv"),
      "FILE: the content is of no known format; known are " + known() + " (--format states one)");
  ImportOptions options;
  options.format = "fortran";
  EXPECT_EQ(import_error("1,2\n", options),
            "FILE: there is no format 'fortran'; known are " + known());
}

TEST(Import, AStatedFormatIsNotSearched) {
  ImportOptions options;
  options.format = "csv";
  options.delimiter = ' ';
  options.skip_lines = 13;
  EXPECT_EQ(imported("Signal:\tTime\nA\tB\n[ s ]\t[ V ]\n0\t1\n1\t2\n", {}).provenance.importer,
            "polytec-ascii");
  options = {};
  options.format = "csv";
  EXPECT_EQ(
      imported("Signal:\tTime\nA\tB\n[ s ]\t[ V ]\n0\t1\n1\t2\n", options).provenance.importer,
      "csv");
}

struct Closed {
  std::string_view head;
  const char* says;
};

class ClosedFormat : public testing::TestWithParam<Closed> {};

TEST_P(ClosedFormat, IsNamedWithAWayOut) {
  EXPECT_EQ(import_error(std::string(GetParam().head) + "\n1,2,3\n4,5,6\n"),
            std::string("FILE: this is ") + GetParam().says);
}

INSTANTIATE_TEST_SUITE_P(
    All, ClosedFormat,
    testing::Values(
        Closed{"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1"sv,
               "an OLE2 compound file, as Polytec's .svd, .pvd and .set are, which is not read: no "
               "open reader exists: export it "
               "from PSV or VibSoft as universal file (UFF) or ASCII"},
        Closed{
            "TDSh\x0E\x00\x00\x00"sv,
            "the index of an NI TDMS file (.tdms_index), which is not read: state the .tdms file "
            "beside it, which holds the samples"},
        Closed{"MDF     3.30"sv,
               "an ASAM MDF measurement file before version 4, which is not read: save it as MDF 4 "
               "with the program that wrote it"},
        Closed{
            "UnFinMF 3.30"sv,
            "an unfinished ASAM MDF measurement file before version 4, which is not read: save it "
            "as MDF 4 with the program that wrote it"},
        Closed{
            "PK\x03\x04"sv,
            "a ZIP archive (a workbook, for example), which is not read: save the table in it as "
            "CSV"},
        Closed{"\x80\x04\x95\xC4\x1F"sv,
               "an object of Python (pickle), which is not read: save the table as CSV, MATLAB "
               "(.mat) or HDF5"},
        Closed{"{\"time\": [0.0, 0.1], \"force\": [1.5, 2.5]}"sv,
               "a JSON document, which is not read: save the table as CSV, MATLAB (.mat) or HDF5"},
        Closed{"[{\"t\": 0.0, \"F\": 1.5},"sv,
               "a JSON document, which is not read: save the table as CSV, MATLAB (.mat) or HDF5"},
        Closed{"PAR1\x15\x04"sv,
               "an Apache Parquet table, which is not read: save the table as CSV, MATLAB (.mat) "
               "or HDF5"},
        Closed{"ARROW1\x00\x00"sv,
               "an Apache Arrow table (Feather), which is not read: save the table as CSV, MATLAB "
               "(.mat) or HDF5"},
        Closed{"SQLite format 3\x00"sv,
               "an SQLite database, which is not read: save the table as CSV, MATLAB (.mat) or "
               "HDF5"},
        Closed{"CDF\x02\x00"sv,
               "a NetCDF file of the classic format, which is not read: save it as NetCDF 4, "
               "which is HDF5 (nccopy -k netCDF-4)"},
        Closed{"Name\tShot\t\nFile\tC:\\x.csv\t\nStarttime of export\t132959733843760000\n"sv,
               "a text export of TwinCAT Scope, with times in ms beside each group of channels, "
               "which is not read: export it as TDMS"},
        Closed{"BZh91AY&SY"sv, "a bzip2-compressed file, which is not read: unpack it first"},
        Closed{"\xFD\x37zXZ\x00"sv, "an xz-compressed file, which is not read: unpack it first"},
        Closed{"\x28\xB5\x2F\xFD\x04"sv,
               "a Zstandard-compressed file, which is not read: unpack it first"},
        Closed{"7z\xBC\xAF\x27\x1C"sv, "a 7z archive, which is not read: unpack it first"},
        Closed{"Rar!\x1A\x07\x01"sv, "a RAR archive, which is not read: unpack it first"},
        Closed{"\x89PNG\r\n"sv, "a picture (PNG), which is not read: a recording is expected"},
        Closed{"\xFF\xD8\xFF\xE0"sv,
               "a picture (JPEG), which is not read: a recording is expected"},
        Closed{"$date today $end\n$timescale 1 us $end\n$enddefinitions $end\n#0 0!"sv,
               "a value change dump (.vcd) of logic levels, which is not read: save the analog "
               "channels as a sigrok session (.sr) or as CSV"},
        Closed{"\x1F\x8B\x08"sv, "a gzip-compressed file, which is not read: unpack it first"},
        Closed{"%PDF-1.7"sv, "a PDF document, which is not read: a recording is expected"},
        Closed{"DIAEXTENDED  {@:ENDLINE}\n#BEGINGLOBALHEADER\n1,WINDOWS 32Bit"sv,
               "the header of a DIAdem data set (.dat), whose samples are in binary files beside "
               "it, which is not read: save it as TDMS with DIAdem"},
        Closed{"Data format edition number :1.6"sv,
               "the description of a test in ISO 13499 (.mme), whose samples are in the folder "
               "Channel beside it, which is not read: state the files of its channels (.001, .002, "
               "...)"},
        Closed{"Octave-1-L\x00"sv,
               "Octave's own binary format, which is not read: save it with -v7 in Octave"},
        Closed{"\x1A\x45\xDF\xA3\x42\x82\x84mide"sv,
               "a recording of an enDAQ or Mide logger (.ide), which is not read: export it as CSV "
               "or MATLAB (.mat) with enDAQ Lab"},
        Closed{"fLaC\x80\x00\x00\x22"sv,
               "a FLAC sound file, which is not read: save it as WAVE (.wav), which keeps the "
               "samples"},
        Closed{"\x0E\x03\x13\x01\x00"sv,
               "an HDF4 file, which is not read: convert it to HDF5 (h4toh5)"},
        Closed{"FORMAT\x00\x00BINARY\x00\x00NUM_HEADER_BLOCKS\x00"sv,
               "an MTS RPC III time history (.rsp, .rpc, .drv), which is not read: export it as "
               "MATLAB (.mat) or text with the RPC software"},
        Closed{"Format,2.0B;Memory Length,4;Source,CH1;\nWaveform Data;\n#48\x01\x02"sv,
               "a GW Instek waveform (.lsf), whose samples are binary, which is not read: save the "
               "waveform as CSV on the oscilloscope, with its times"},
        Closed{"DATASET test\nVERSION 1\nSERIES CH1\nRATE 1000\nSTORAGE_MODE INTERLACED\n"sv,
               "the header of a DADiSP or TEAC data set, whose samples are in the .dat beside it, "
               "which is not read: export it as text or MATLAB (.mat) with the program that wrote "
               "it"},
        Closed{"<SALEAE>\x00\x00"sv,
               "a binary export of Saleae Logic, which is not read: export the analog channels as "
               "CSV"},
        Closed{"SPBXDS\x01"sv,
               "the memory of an OWON oscilloscope (.bin), which is not read: save the waveform as "
               "CSV on the oscilloscope, with its times"},
        Closed{"FORMDS16\x01"sv,
               "a KayPENTAX CSL recording (.nsp), which is not read: save it as WAVE (.wav) with "
               "CSL"},
        Closed{"<?xml version=\"1.0\"?>\n<Prop Value=\"eRS_SIGNAL_FORMAT_FLOAT\"/>"sv,
               "the description of a Rohde & Schwarz waveform (.bin), whose samples are in the "
               ".Wfm.bin beside it, which is not read: save the waveform as CSV on the "
               "oscilloscope, with its times"},
        Closed{"STATION,IED 7,1999\r\n  3, 2A , 1d\r\n1,IA,A,,A,0.1,0,0,-32767,32767,1,1,P\r\n"sv,
               "the configuration of a COMTRADE recording (.cfg), whose samples are in the .dat "
               "beside it, which is not read: export it as CSV or MATLAB (.mat) with the program "
               "that wrote it"}));

TEST(ClosedFormats, AreNoTablesWhoseSecondRowHoldsThreeCells) {
  EXPECT_EQ(imported("t [s],A,D\n0,1,2\n1,2,3\n").channels.size(), 2U);
  EXPECT_EQ(imported("t,4A,2D\ns,A,D\n0,1,2\n1,2,3\n").channels.size(), 2U);
}

TEST(ClosedFormats, AreNotTakenForColumnsThatAreNamedLikeThem) {
  for (const std::string name : {"PAR1", "ARROW1", "BZh", "CDF", "Rar!", "{F}", "[{F}]"}) {
    const datasets::Record record = imported("t [s]," + name + "\n0,1\n1,2\n2,3\n");
    EXPECT_EQ(record.channels.at(0).name, name);
    EXPECT_EQ(imported(name + ",t [s]\n1,0\n2,1\n3,2\n").channels.at(0).name, name);
  }
}

TEST(ClosedFormatByEnding, TellsWhoseAContainerIs) {
  const auto ole = "\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1\x00\x01"sv;
  EXPECT_EQ(
      import_error(ole, {}, ".LMS"),
      "FILE: this is an OLE2 compound file of Simcenter Testlab by its ending '.lms', which is "
      "not read: export it as universal file (UFF) or MATLAB (.mat) with Testlab");
  EXPECT_EQ(
      import_error(ole, {}, ".xls"),
      "FILE: this is an OLE2 compound file of a spreadsheet program by its ending '.xls', which "
      "is not read: save the table in it as CSV");
  EXPECT_EQ(
      import_error("PK\x03\x04\x14\x00\x00"sv, {}, ".dxz"),
      "FILE: this is a ZIP archive of Dewesoft by its ending '.dxz', which is not read: export "
      "it as universal file (UFF), MAT or CSV with the program that wrote it");
}

TEST(ClosedFormatByEnding, IsNamedWhereTheContentIsOfNoKnownFormat) {
  const auto unknown = "\x07\x01\xFE\x00\x02\x90"sv;
  EXPECT_EQ(import_error(unknown, {}, ".pvd"),
            "FILE: the content is of no known format, and the ending '.pvd' is that of files of "
            "Polytec VibSoft, which are not read: export it from PSV or VibSoft as universal file "
            "(UFF) or ASCII");
  EXPECT_EQ(import_error(unknown, {}, ".DXD"),
            "FILE: the content is of no known format, and the ending '.dxd' is that of files of "
            "Dewesoft, which are not read: export it as universal file (UFF), MAT or CSV with the "
            "program that wrote it");
  const auto told = [unknown](const std::string& ending) {
    const std::string text = import_error(unknown, {}, ending);
    return text.substr(text.find("is that of"));
  };
  EXPECT_EQ(told(".Wfm.bin"),
            "is that of files of a Rohde & Schwarz oscilloscope, which are not read: save the "
            "waveform as CSV on the oscilloscope, with its times");
  for (const char* const ending : {".dl850", ".WDF"})
    EXPECT_EQ(told(ending),
              "is that of files of a Yokogawa oscilloscope, which are not read: save the waveform "
              "as CSV on the oscilloscope, with its times");
  EXPECT_EQ(told(".wvf"),
            "is that of files of a Yokogawa oscilloscope, which are not read alone: state the .hdr "
            "beside it, which describes the samples");
  for (const auto& [ending, says] :
       {std::pair{".LDSF",
                  "Simcenter Testlab, which are not read: export it as universal file "
                  "(UFF) or MATLAB (.mat) with Testlab"},
        std::pair{".orx",
                  "OROS NVGate, which are not read: export it as universal file (UFF), MAT "
                  "or CSV with the program that wrote it"},
        std::pair{".mem",
                  "a Hioki recorder, which are not read: save it as CSV with the recorder "
                  "or its software"}})
    EXPECT_EQ(told(ending), std::string("is that of files of ") + says);
  EXPECT_EQ(told(".psdata"),
            "is that of files of PicoScope, which are not read: save it as MATLAB (.mat) or CSV "
            "with PicoScope");
  EXPECT_EQ(told(".TST"),
            "is that of files of HBM catman, which are not read: export it from catman as binary "
            "(.bin) or ASCII");
  EXPECT_EQ(told(".tdx"),
            "is that of files of NI DIAdem or LabVIEW, which are not read alone: state the .tdm "
            "beside it, which describes the samples");
  EXPECT_THAT(import_error(unknown, {}, ".xyz"),
              testing::StartsWith("FILE: the content is of no known format; known are "));
  EXPECT_THAT(import_error("0,1\n1,2\n2,3\n", {}, ".tst"),  // a table, whatever its name
              testing::StartsWith("FILE: 'column 1' has neither times nor a sample rate"));
}

TEST(Uff58Recognition, SeesBinaryFunctionsBehindOtherDatasets) {
  const std::string geometry = "    -1\n    15\n         1         0         0\n    -1\n";
  const auto importer_for = [](std::string_view head) {
    std::string_view best;
    int score = 0;
    for (const Importer& importer : importers())
      if (const int this_score = importer.recognises("x", head); this_score > score) {
        score = this_score;
        best = importer.id;
      }
    return best;
  };
  EXPECT_EQ(importer_for(geometry), "uff58");
  EXPECT_EQ(importer_for(geometry + "    -1\n    58b     1     2\n"), "uff58b");
  EXPECT_EQ(importer_for(geometry + "    -1\n    58\n"), "uff58");
  EXPECT_EQ(importer_for("-1\n5\n"), "csv");  // two numbers
}

}  // namespace
}  // namespace impactrig::acquisition
