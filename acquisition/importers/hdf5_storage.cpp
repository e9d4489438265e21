// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/hdf5_storage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "datasets/hdf5_handle.hpp"

namespace impactrig::acquisition {

using datasets::Hdf5Handle;

namespace {

constexpr std::uint64_t largest_chunk = std::uint64_t{128} << 20;  ///< [bytes]
constexpr std::uint64_t largest_expansion = 1100;                  ///< deflate: 1032

/// Of a filter that is not there; "" when all are.
std::string filter_problem(hid_t creation) {
  const int filters = H5Pget_nfilters(creation);
  for (int i = 0; i < filters; ++i) {
    unsigned flags = 0;
    std::size_t values = 0;
    unsigned config = 0;
    const H5Z_filter_t filter = H5Pget_filter2(creation, static_cast<unsigned>(i), &flags, &values,
                                               nullptr, 0, nullptr, &config);
    if (H5Zfilter_avail(filter) <= 0)
      return fmt::format(
          "packed by filter {}; HDF5's own and lzf are read: h5repack -f GZIP=1 rewrites it",
          filter);
  }
  return {};
}

/// Of the pieces of a data set; "" when they are read.
std::string chunk_problem(hid_t creation, const std::vector<std::uint64_t>& shape,
                          std::uint64_t element) {
  std::array<hsize_t, H5S_MAX_RANK> chunk{};
  const int rank = H5Pget_chunk(creation, static_cast<int>(chunk.size()), chunk.data());
  if (rank != static_cast<int>(shape.size())) return "damaged: its pieces have another shape";
  long double bytes = static_cast<long double>(element);
  for (int i = 0; i < rank; ++i)
    bytes *= static_cast<long double>(chunk[static_cast<std::size_t>(i)]);
  if (bytes > static_cast<long double>(largest_chunk))
    return fmt::format("in pieces of {:.0f} MB, at most {} are read",
                       static_cast<double>(bytes) / 1048576.0, largest_chunk >> 20);
  return {};
}

}  // namespace

std::string hdf5_storage_problem(hid_t data, const std::vector<std::uint64_t>& shape,
                                 std::uint64_t element, std::uint64_t file_bytes) {
  const Hdf5Handle creation(H5Dget_create_plist(data), H5Pclose);
  const H5D_layout_t layout = H5Pget_layout(creation.id());
  if (layout == H5D_VIRTUAL)
    return "virtual: a view of other data sets, which are read where they are";
  if (H5Pget_external_count(creation.id()) != 0 ||
      (layout != H5D_CONTIGUOUS && layout != H5D_CHUNKED && layout != H5D_COMPACT))
    return "kept in another file";
  std::string filtered = filter_problem(creation.id());
  if (!filtered.empty()) return filtered;
  const std::uint64_t stored = H5Dget_storage_size(data);
  long double declared = static_cast<long double>(element);
  for (const std::uint64_t side : shape) declared *= static_cast<long double>(side);
  const auto most = static_cast<long double>(std::min(stored, file_bytes) *
                                             (layout == H5D_CHUNKED ? largest_expansion : 1));
  if (stored > file_bytes || declared > most)
    return fmt::format("it declares {:.0f} bytes and holds {}", static_cast<double>(declared),
                       stored);
  return layout == H5D_CHUNKED ? chunk_problem(creation.id(), shape, element) : std::string();
}

}  // namespace impactrig::acquisition
