// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/hdf5_lzf.hpp"

#include <hdf5.h>

#include <algorithm>
#include <cstddef>
#include <span>

namespace impactrig::acquisition {
namespace {

constexpr H5Z_filter_t lzf_filter = 32000;
// Three bytes stand for 264 at most, and no larger pieces are read [bytes].
constexpr std::size_t most_expansion = 88, largest_piece = std::size_t{128} << 20;

/// Unpacks all of it, or tells 0: damaged, or more than there is room for. A control byte below 32
/// is followed by as many bytes and one to be copied; of others three bits are the length less 2 of
/// what is repeated, a further byte of it where they are all set, and five and the next byte how
/// far back that begins, less 1.
std::size_t unpack(std::span<const unsigned char> in, std::span<unsigned char> out) {
  std::size_t at = 0, to = 0;
  while (at < in.size()) {
    const std::size_t control = in[at++];
    if (control < 32) {
      const std::size_t count = control + 1;
      if (count > in.size() - at || count > out.size() - to) return 0;
      std::copy_n(in.begin() + static_cast<std::ptrdiff_t>(at), count,
                  out.begin() + static_cast<std::ptrdiff_t>(to));
      at += count;
      to += count;
      continue;
    }
    std::size_t length = control >> 5;
    if (length == 7) {
      if (at == in.size()) return 0;
      length += in[at++];
    }
    if (at == in.size()) return 0;
    const std::size_t back = ((control & 31) << 8) + in[at++] + 1;
    length += 2;
    if (back > to || length > out.size() - to) return 0;
    for (std::size_t i = 0; i < length; ++i, ++to) out[to] = out[to - back];  // may overlap
  }
  return to;
}

/// As H5Z_func_t has it: 0 where it fails.
std::size_t filter(unsigned flags, std::size_t count, const unsigned values[], std::size_t bytes,
                   std::size_t* room, void** buffer) {
  if ((flags & H5Z_FLAG_REVERSE) == 0) return 0;  // files are read, not written
  std::size_t size = std::min(bytes * most_expansion, largest_piece);
  if (count > 2 && values[2] > 0) size = std::min<std::size_t>(size, values[2]);
  void* const unpacked = H5allocate_memory(size, false);
  if (unpacked == nullptr) return 0;
  const std::size_t used = unpack({static_cast<const unsigned char*>(*buffer), bytes},
                                  {static_cast<unsigned char*>(unpacked), size});
  if (used == 0) {
    H5free_memory(unpacked);
    return 0;
  }
  H5free_memory(*buffer);
  *buffer = unpacked;
  *room = size;
  return used;
}

}  // namespace

void register_lzf() {
  const H5Z_class2_t lzf{.version = H5Z_CLASS_T_VERS,
                         .id = lzf_filter,
                         .encoder_present = 0,
                         .decoder_present = 1,
                         .name = "lzf",
                         .can_apply = nullptr,
                         .set_local = nullptr,
                         .filter = filter};
  H5Zregister(&lzf);
}

}  // namespace impactrig::acquisition
