// SPDX-License-Identifier: BSD-3-Clause
// fuzz_seeds FORMAT DIR: writes the files that fuzzing of a format starts from.
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "tests/acquisition/hdf5_bytes.hpp"
#include "tests/acquisition/lvm_bytes.hpp"
#include "tests/acquisition/mat_bytes.hpp"
#include "tests/acquisition/sigrok_bytes.hpp"
#include "tests/acquisition/text_bytes.hpp"
#include "tests/acquisition/wav_bytes.hpp"

namespace {

using namespace impactrig::acquisition::tests;

struct Seeds {
  std::string_view format;
  std::vector<std::string> (*make)();
};

/// A format's seeds are made by the builders its tests use.
constexpr std::array<Seeds, 9> table = {{
    {"csv", csv_seeds},                //
    {"hdf5", hdf5_seeds},              //
    {"lvm", lvm_seeds},                //
    {"mat", mat_seeds},                //
    {"polytec-ascii", polytec_seeds},  //
    {"sigrok", sigrok_seeds},          //
    {"wav", wav_seeds},                //
    {"uff58", uff58_seeds},            //
    {"uff58b", uff58b_seeds},          //
}};

}  // namespace

int main(int count, char** arguments) {
  if (count != 3) {
    std::fprintf(stderr, "usage: fuzz_seeds FORMAT DIR\n");
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
