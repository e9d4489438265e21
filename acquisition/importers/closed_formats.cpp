// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "acquisition/importers/formats.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/importers/text_file.hpp"

namespace impactrig::acquisition {

namespace {

/// The first bytes of a format we know by sight only.
struct Signature {
  std::size_t offset;  ///< of `bytes`
  std::string_view bytes;
  std::string_view what;
  std::string_view way_out;
  std::string_view also = {};       ///< what the first bytes hold anywhere
  std::string_view container = {};  ///< of files of several programs, which their endings tell
};

constexpr std::string_view from_the_oscilloscope =
    "save the waveform as CSV on the oscilloscope, with its times";

constexpr std::string_view from_the_table = "save the table as CSV, MATLAB (.mat) or HDF5";
constexpr std::string_view from_netcdf = "save it as NetCDF 4, which is HDF5 (nccopy -k netCDF-4)";
constexpr std::string_view as_wave = "save it as WAVE (.wav), which keeps the samples";
constexpr std::string_view from_sigrok =
    "save the analog channels as a sigrok session (.sr) or as CSV";

constexpr auto signatures = std::to_array<Signature>({
    {0,
     std::string_view("\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1", 8),
     "an OLE2 compound file, as Polytec's .svd, .pvd and .set are",
     "no open reader exists: export it from PSV or VibSoft as universal file (UFF) or ASCII",
     {},
     "an OLE2 compound file"},
    {0, "TDSh", "the index of an NI TDMS file (.tdms_index)",
     "state the .tdms file beside it, which holds the samples"},
    {0, "MDF     ", "an ASAM MDF measurement file before version 4",
     "save it as MDF 4 with the program that wrote it"},
    {0, "UnFinMF ", "an unfinished ASAM MDF measurement file before version 4",
     "save it as MDF 4 with the program that wrote it"},
    {0,
     std::string_view("PK\x03\x04", 4),
     "a ZIP archive (a workbook, for example)",
     "save the table in it as CSV",
     {},
     "a ZIP archive"},
    {0, "\x80\x03", "an object of Python (pickle)", from_the_table},
    {0, "\x80\x04\x95", "an object of Python (pickle)", from_the_table},
    {0, "\x80\x05\x95", "an object of Python (pickle)", from_the_table},
    {0, "{", "a JSON document", from_the_table, "\":"},
    {0, "[{", "a JSON document", from_the_table, "\":"},
    {0, "PAR1\x15", "an Apache Parquet table", from_the_table},
    {0, std::string_view("ARROW1\0", 7), "an Apache Arrow table (Feather)", from_the_table},
    {0, "SQLite format 3", "an SQLite database", from_the_table},
    {0, "CDF\x01", "a NetCDF file of the classic format", from_netcdf},
    {0, "CDF\x02", "a NetCDF file of the classic format", from_netcdf},
    {0, "CDF\x05", "a NetCDF file of the classic format", from_netcdf},
    {0, "\x1F\x8B", "a gzip-compressed file", "unpack it first"},
    {0, "BZh", "a bzip2-compressed file", "unpack it first", "1AY&SY"},
    {0,
     std::string_view("\xFD"
                      "7zXZ\0",
                      6),
     "an xz-compressed file", "unpack it first"},
    {0, "\x28\xB5\x2F\xFD", "a Zstandard-compressed file", "unpack it first"},
    {0, "7z\xBC\xAF\x27\x1C", "a 7z archive", "unpack it first"},
    {0, "Rar!\x1A\x07", "a RAR archive", "unpack it first"},
    {0, "\x89PNG", "a picture (PNG)", "a recording is expected"},
    {0, "\xFF\xD8\xFF", "a picture (JPEG)", "a recording is expected"},
    {0, "$date", "a value change dump (.vcd) of logic levels", from_sigrok, "$enddefinitions"},
    {0, "$version", "a value change dump (.vcd) of logic levels", from_sigrok, "$enddefinitions"},
    {0, "$timescale", "a value change dump (.vcd) of logic levels", from_sigrok, "$enddefinitions"},
    {0, "Name", "a text export of TwinCAT Scope, with times in ms beside each group of channels",
     "export it as TDMS", "Starttime of export"},
    {0, "version https://git-lfs.github.com/", "what Git LFS keeps in place of a file",
     "get the file itself with git lfs pull"},
    {0, "%PDF", "a PDF document", "a recording is expected"},
    {0, "DIAEXTENDED",
     "the header of a DIAdem data set (.dat), whose samples are in binary files beside it",
     "save it as TDMS with DIAdem"},
    {0, "Data format edition number",
     "the description of a test in ISO 13499 (.mme), whose samples are in the folder Channel "
     "beside "
     "it",
     "state the files of its channels (.001, .002, ...)"},
    {0, "Octave-1-", "Octave's own binary format", "save it with -v7 in Octave"},
    {0, "\x1A\x45\xDF\xA3", "a recording of an enDAQ or Mide logger (.ide)",
     "export it as CSV or MATLAB (.mat) with enDAQ Lab", "mide"},
    {0, "fLaC", "a FLAC sound file", as_wave, std::string_view("\0\0\x22", 3)},
    {0, std::string_view(".snd\0\0\0", 7), "a Sun sound file (.au)", as_wave},
    {0, std::string_view("caff\0\1", 6), "an Apple Core Audio file (.caf)", as_wave},
    {0, std::string_view("OggS\0\2", 6), "an Ogg sound file", as_wave},
    {0, "\x0E\x03\x13\x01", "an HDF4 file", "convert it to HDF5 (h4toh5)"},
    {0, "FORMAT", "an MTS RPC III time history (.rsp, .rpc, .drv)",
     "export it as MATLAB (.mat) or text with the RPC software", "NUM_HEADER_BLOCKS"},
    {0, "Format,", "a GW Instek waveform (.lsf), whose samples are binary", from_the_oscilloscope,
     ";Memory Length,"},  // its CSV has a line a key
    {0, "DATASET ",
     "the header of a DADiSP or TEAC data set, whose samples are in the .dat beside it",
     "export it as text or MATLAB (.mat) with the program that wrote it", "STORAGE_MODE"},
    {0, "<SALEAE>", "a binary export of Saleae Logic", "export the analog channels as CSV"},
    {0, std::string_view("ABF2\0", 5), "an Axon binary file (.abf)", "save it as text (.atf)"},
    {0, "<!DOCTYPE html", "a web page", "save the table in it as CSV"},
    {0, "<html", "a web page", "save the table in it as CSV"},
    {0, "SPBXDS", "the memory of an OWON oscilloscope (.bin)", from_the_oscilloscope},
    {0, "FORMDS16", "a KayPENTAX CSL recording (.nsp)", "save it as WAVE (.wav) with CSL"},
    {0, "<?xml",
     "the description of a Rohde & Schwarz waveform (.bin), whose samples are in the .Wfm.bin "
     "beside it",
     from_the_oscilloscope, "eRS_"},
});

/// Formats of which only the ending is known.
struct Ending {
  std::string_view ending;  ///< lower case
  std::string_view what;
  std::string_view way_out;
  bool described = false;  ///< by a file beside it, which is read
};

constexpr std::string_view from_polytec =
    "export it from PSV or VibSoft as universal file (UFF) or ASCII";
constexpr std::string_view from_testlab =
    "export it as universal file (UFF) or MATLAB (.mat) with Testlab";
constexpr std::string_view from_its_program =
    "export it as universal file (UFF), MAT or CSV with the program that wrote it";

/// Longer endings first.
constexpr auto endings = std::to_array<Ending>({
    {".wfm.bin", "a Rohde & Schwarz oscilloscope", from_the_oscilloscope},
    {".svd", "Polytec PSV", from_polytec},
    {".pvd", "Polytec VibSoft", from_polytec},
    {".dxd", "Dewesoft", from_its_program},
    {".dxz", "Dewesoft", from_its_program},
    {".d7d", "Dewesoft", from_its_program},
    {".d7z", "Dewesoft", from_its_program},
    {".sie", "HBM SoMat", from_its_program},
    {".spd", "a measuring program", from_its_program},
    {".rdm", "a measuring program", from_its_program},
    {".lms", "Simcenter Testlab", from_testlab},
    {".ldsf", "Simcenter Testlab", from_testlab},
    {".tdf", "Simcenter Testlab", from_testlab},
    {".orx", "OROS NVGate", from_its_program},
    {".oxf", "OROS NVGate", from_its_program},
    {".oros", "OROS NVGate", from_its_program},
    {".pak", "Müller-BBM PAK", from_its_program},
    {".pls", "Brüel & Kjær PULSE", from_its_program},
    {".dwd", "Kistler DynoWare", "export it as text with DynoWare"},
    {".blk", "a measuring program", from_its_program},
    {".wdq", "DATAQ WinDaq", "save it as CSV with WinDaq"},
    {".wdh", "DATAQ WinDaq", "save it as CSV with WinDaq"},
    {".adicht", "ADInstruments LabChart", "export it as MATLAB (.mat) or text with LabChart"},
    {".gbd", "a Graphtec logger", "save it as CSV with the logger or its software"},
    {".lwf", "a Hantek oscilloscope", from_the_oscilloscope},
    {".ibw", "Igor Pro", "save it as HDF5 or as delimited text with Igor Pro"},
    {".pxp", "Igor Pro", "save its waves as HDF5 or as delimited text with Igor Pro"},
    {".ddf", "DASYLab", "save it as ASCII with DASYLab"},
    {".dac", "nCode", "export it as CSV or MATLAB (.mat) with nCode"},
    {".pnrf", "HBM Perception", "export it as MATLAB (.mat), UFF or ASCII with Perception"},
    {".nrf", "HBM Perception", "export it as MATLAB (.mat), UFF or ASCII with Perception"},
    {".wft", "a Nicolet oscilloscope", from_the_oscilloscope},
    {".smr", "CED Spike2", "export it as MATLAB (.mat) or text with Spike2"},
    {".smrx", "CED Spike2", "export it as MATLAB (.mat) or text with Spike2"},
    {".edf", "a medical recorder", "convert it to CSV, MATLAB (.mat) or HDF5"},
    {".bdf", "a medical recorder", "convert it to CSV, MATLAB (.mat) or HDF5"},
    {".sgy", "a seismic recorder (SEG-Y)", "convert it to CSV, MATLAB (.mat) or HDF5"},
    {".segy", "a seismic recorder (SEG-Y)", "convert it to CSV, MATLAB (.mat) or HDF5"},
    {".mseed", "a seismic recorder (miniSEED)", "convert it to CSV, MATLAB (.mat) or HDF5"},
    {".mem", "a Hioki recorder", "save it as CSV with the recorder or its software"},
    {".nsp", "KayPENTAX CSL", "save it as WAVE (.wav) with CSL"},
    {".tst", "HBM catman", "export it from catman as binary (.bin) or ASCII"},
    {".psdata", "PicoScope", "save it as MATLAB (.mat) or CSV with PicoScope"},
    {".wvf", "a Yokogawa oscilloscope", "state the .hdr beside it, which describes the samples",
     true},
    {".wdf", "a Yokogawa oscilloscope", from_the_oscilloscope},
    {".dl850", "a Yokogawa oscilloscope", from_the_oscilloscope},
    {".xls", "a spreadsheet program", "save the table in it as CSV"},
    {".tdx", "NI DIAdem or LabVIEW", "state the .tdm beside it, which describes the samples", true},
});

/// The entry of a file's ending; null where there is none.
const Ending* known_ending(std::string_view file_name) {
  std::string name(file_name);
  for (char& c : name)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  const auto found = std::ranges::find_if(
      endings, [&name](const Ending& one) { return name.ends_with(one.ending); });
  return found == endings.end() ? nullptr : &*found;
}

/// Whether text ends with `letter` in either case behind a count: "4A".
bool counts_of(std::string_view text, char letter) {
  const std::string_view cell = trimmed(text);
  if (cell.size() < 2 || (cell.back() | 0x20) != letter) return false;
  return integer_in(trimmed(cell.substr(0, cell.size() - 1))).has_value();
}

/// The second line of a COMTRADE configuration counts its channels (IEEE C37.111, 5.4):
/// "6,4A,2D".
bool is_comtrade(std::string_view head) {
  const char* at = head.data();
  const char* const end = at + head.size();
  take_line(at, end);
  const std::string_view line = take_line(at, end);
  const std::size_t first = line.find(',');
  if (first == std::string_view::npos) return false;
  const std::size_t second = line.find(',', first + 1);
  if (second == std::string_view::npos) return false;
  return integer_in(trimmed(line.substr(0, first))) &&
         counts_of(line.substr(first + 1, second - first - 1), 'a') &&
         counts_of(line.substr(second + 1), 'd');
}

}  // namespace

std::string closed_ending(std::string_view file_name) {
  const Ending* const found = known_ending(file_name);
  if (found == nullptr) return {};
  return fmt::format(
      "the content is of no known format, and the ending '{}' is that of files of {}, which are "
      "not read{}: {}",
      found->ending, found->what, found->described ? " alone" : "", found->way_out);
}

std::string closed_format(std::string_view file_name, std::string_view head) {
  if (is_comtrade(head))
    return "this is the configuration of a COMTRADE recording (.cfg), whose samples are in the "
           ".dat beside it, which is not read: export it as CSV or MATLAB (.mat) with the program "
           "that wrote it";
  for (const Signature& signature : signatures) {
    if (head.size() < signature.offset) continue;
    if (!head.substr(signature.offset).starts_with(signature.bytes)) continue;
    if (head.find(signature.also) == std::string_view::npos) continue;
    const Ending* const ending = signature.container.empty() ? nullptr : known_ending(file_name);
    if (ending != nullptr)
      return fmt::format("this is {} of {} by its ending '{}', which is not read: {}",
                         signature.container, ending->what, ending->ending, ending->way_out);
    return fmt::format("this is {}, which is not read: {}", signature.what, signature.way_out);
  }
  return {};
}

}  // namespace impactrig::acquisition
