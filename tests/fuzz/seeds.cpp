// SPDX-License-Identifier: BSD-3-Clause
// fuzz_seeds FORMAT DIR: writes the files that fuzzing of a format starts from; fuzz_seeds: the
// formats.
#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/store.hpp"
#include "tests/acquisition/aiff_bytes.hpp"
#include "tests/acquisition/catman_bytes.hpp"
#include "tests/acquisition/hdf5_bytes.hpp"
#include "tests/acquisition/imc_raw_bytes.hpp"
#include "tests/acquisition/lecroy_trc_bytes.hpp"
#include "tests/acquisition/lvm_bytes.hpp"
#include "tests/acquisition/mat_bytes.hpp"
#include "tests/acquisition/mdf4_bytes.hpp"
#include "tests/acquisition/numpy_bytes.hpp"
#include "tests/acquisition/rigol_wfm_bytes.hpp"
#include "tests/acquisition/sigrok_bytes.hpp"
#include "tests/acquisition/tdm_bytes.hpp"
#include "tests/acquisition/tdms_bytes.hpp"
#include "tests/acquisition/tek_isf_bytes.hpp"
#include "tests/acquisition/tek_wfm_bytes.hpp"
#include "tests/acquisition/text_bytes.hpp"
#include "tests/acquisition/wav_bytes.hpp"
#include "tests/acquisition/waveform_container_bytes.hpp"
#include "tests/acquisition/yokogawa_bytes.hpp"
#include "tests/datasets/sample_record.hpp"

namespace {

using namespace impactrig::acquisition::tests;

struct Seeds {
  std::string_view format;
  std::vector<std::string> (*make)();
};

std::string own_hdf5(const impactrig::datasets::Record& record) {
  const std::string path = std::filesystem::temp_directory_path() / "impactrig-fuzz-seed.h5";
  impactrig::datasets::write_record(record, path);
  std::ifstream stream(path, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(stream)), {});
  std::filesystem::remove(path);
  return bytes;
}

/// A record with every field, and one that is as small as can be.
std::vector<std::string> own_hdf5_seeds() {
  impactrig::datasets::Record small;
  small.channels.resize(1);
  small.channels[0].name = "F";
  small.channels[0].clock.interval = 1.0;
  small.channels[0].raw = std::vector<std::int16_t>{1, 2, 3};
  return {own_hdf5(::tests::sample_record()), own_hdf5(small)};
}

/// Of all versions; 7.3 is HDF5.
std::vector<std::string> all_mat_seeds() {
  std::vector<std::string> seeds = mat_seeds();
  seeds.push_back(mat73_structures());
  return seeds;
}

/// A format's seeds are made by the builders its tests use.
constexpr auto table = std::to_array<Seeds>({
    {"aiff", aiff_seeds},                  //
    {"catman", catman_seeds},              //
    {"csv", csv_seeds},                    //
    {"hdf5", hdf5_seeds},                  //
    {"impactrig-hdf5", own_hdf5_seeds},    //
    {"imc-raw", imc_raw_seeds},            //
    {"keysight-bin", keysight_bin_seeds},  //
    {"lecroy-trc", lecroy_trc_seeds},      //
    {"lvm", lvm_seeds},                    //
    {"mat", all_mat_seeds},                //
    {"mdf4", mdf4_seeds},                  //
    {"numpy", numpy_seeds},                //
    {"polytec-ascii", polytec_seeds},      //
    {"rigol-bin", rigol_bin_seeds},        //
    {"rigol-wfm", rigol_wfm_seeds},        //
    {"sigrok", sigrok_seeds},              //
    {"tdm", tdm_seeds},                    //
    {"tdms", tdms_seeds},                  //
    {"tek-isf", tek_isf_seeds},            //
    {"tek-wfm", tek_wfm_seeds},            //
    {"uff58", uff58_seeds},                //
    {"uff58b", uff58b_seeds},              //
    {"wav", wav_seeds},                    //
    {"yokogawa-wvf", yokogawa_seeds},      //
});

}  // namespace

int main(int count, char** arguments) {
  if (count == 1) {
    for (const Seeds& seeds : table) std::printf("%s\n", std::string(seeds.format).c_str());
    return 0;
  }
  if (count != 3) {
    std::fprintf(stderr, "usage: fuzz_seeds [FORMAT DIR]: without words, the formats\n");
    return 2;
  }
  const std::string_view format = arguments[1];
  const std::filesystem::path folder = arguments[2];
  for (const Seeds& seeds : table) {
    if (seeds.format != format) continue;
    std::filesystem::create_directories(folder);
    int number = 0;
    for (const std::string& bytes : seeds.make())
      std::ofstream(folder / std::to_string(number++), std::ios::binary) << bytes;
    return 0;
  }
  std::fprintf(stderr, "no seeds of format %s\n", arguments[1]);
  return 2;
}
