// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "acquisition/importers/formats.hpp"

namespace impactrig::acquisition {

namespace {

/// The first bytes of a format we know by sight only.
struct Signature {
  std::size_t offset;  ///< of `bytes`
  std::string_view bytes;
  std::string_view what;
  std::string_view way_out;
};

constexpr std::string_view as_csv = "export it as CSV with the program that wrote it";

constexpr std::array<Signature, 19> signatures = {{
    {0, std::string_view("\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1", 8),
     "an OLE2 compound file, as Polytec's .svd, .pvd and .set are",
     "no open reader exists: export it from PSV or VibSoft as universal file (UFF) or ASCII"},
    {0, "TDSm", "an NI TDMS file", as_csv},
    {0, "MDF     ", "an ASAM MDF measurement file", as_csv},
    {0, "UnFinMF ", "an unfinished ASAM MDF measurement file", as_csv},
    {0, "WAVEDESC", "a LeCroy waveform (.trc)", "save it as CSV on the oscilloscope"},
    {11, "WAVEDESC", "a LeCroy waveform (.trc)", "save it as CSV on the oscilloscope"},
    {2, ":WFM#", "a Tektronix waveform (.wfm)", "save it as CSV on the oscilloscope"},
    {0, ":WFMP", "a Tektronix waveform (.isf)", "save it as CSV on the oscilloscope"},
    {0, "AG10", "a Keysight waveform (.bin)", "save it as CSV on the oscilloscope"},
    {0, "AG01", "an Agilent waveform (.bin)", "save it as CSV on the oscilloscope"},
    {0, "RG01", "a Rigol waveform (.bin)", "save it as CSV on the oscilloscope"},
    {0, "RG03", "a Rigol waveform (.bin)", "save it as CSV on the oscilloscope"},
    {0, std::string_view("\xA5\xA5\x00\x00", 4), "a Rigol waveform (.wfm)",
     "save it as CSV on the oscilloscope"},
    {0, "\x01\xFF\xFF\xFF", "a Rigol waveform (.wfm)", "save it as CSV on the oscilloscope"},
    {0, "\x94\x13", "an HBM catman recording (.bin)", as_csv},
    {0, "|CF,", "an imc FAMOS raw file", as_csv},
    {0, std::string_view("PK\x03\x04", 4), "a ZIP archive (a workbook, for example)",
     "save the table in it as CSV"},
    {0, "\x1F\x8B", "a gzip-compressed file", "unpack it first"},
    {0, "%PDF", "a PDF document", "a recording is expected"},
}};

}  // namespace

std::string closed_format(std::string_view head) {
  for (const Signature& signature : signatures) {
    if (head.size() < signature.offset) continue;
    if (!head.substr(signature.offset).starts_with(signature.bytes)) continue;
    return fmt::format("this is {}, which is not read: {}", signature.what, signature.way_out);
  }
  return {};
}

}  // namespace impactrig::acquisition
