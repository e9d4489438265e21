// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/hdf5_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "datasets/input_error.hpp"
#include "datasets/store_layout.hpp"

namespace impactrig::datasets {

namespace {

/// Whether it is text that lies where it belongs, not in a heap whose damage HDF5 does not notice.
bool is_fixed_text(hid_t type) {
  return H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0;
}

/// The text of one cell without its padding.
std::string cell_text(std::string_view cell, hid_t type) {
  cell = cell.substr(0, cell.find('\0'));
  const bool blank_padded = H5Tget_strpad(type) == H5T_STR_SPACEPAD;
  while (blank_padded && cell.ends_with(' ')) cell.remove_suffix(1);
  return layout::with_nul_restored(cell);
}

// Of a member of a group [bytes].
constexpr std::size_t longest_name = 255;

bool is_number(hid_t type) {
  const H5T_class_t kind = H5Tget_class(type);
  return kind == H5T_INTEGER || kind == H5T_FLOAT;
}

}  // namespace

Hdf5Reader::Hdf5Reader(std::string file, std::uint64_t bytes)
    : file_(std::move(file)),
      bytes_(bytes) {}

void Hdf5Reader::refuse(std::string_view problem) const {
  throw InputError({file_, 0, 0, {}}, problem);
}

void Hdf5Reader::damaged(std::string_view path, std::string_view problem) const {
  refuse(fmt::format("is damaged: {} {}", path, problem));
}

bool Hdf5Reader::has(const Node& parent, const std::string& name) const {
  return H5Lexists(parent.id(), name.c_str(), H5P_DEFAULT) > 0;
}

Node Hdf5Reader::group(const Node& parent, const std::string& name) const {
  return child(parent, name, H5I_GROUP, "group");
}

Node Hdf5Reader::data(const Node& parent, const std::string& name) const {
  return child(parent, name, H5I_DATASET, "data set");
}

std::vector<std::string> Hdf5Reader::names(const Node& group) const {
  // all at once: by its number each would be looked for in the whole list
  std::vector<std::string> result;
  hsize_t at = 0;
  const auto take = [](hid_t, const char* name, const H5L_info_t*, void* names) -> herr_t {
    const std::string_view text(name);
    if (text.empty() || text.size() > longest_name) return -1;
    static_cast<std::vector<std::string>*>(names)->emplace_back(text);
    return 0;
  };
  if (H5Literate(group.id(), H5_INDEX_NAME, H5_ITER_INC, &at, take, &result) < 0)
    damaged(group.path, "cannot be listed");
  return result;
}

std::optional<std::string> Hdf5Reader::text(const Node& owner, const char* name) const {
  const Hdf5Handle attribute(H5Aopen(owner.id(), name, H5P_DEFAULT), H5Aclose);
  if (!attribute.valid()) return std::nullopt;
  const Hdf5Handle type(H5Aget_type(attribute.id()), H5Tclose);
  const Hdf5Handle space(H5Aget_space(attribute.id()), H5Sclose);
  if (!is_fixed_text(type.id()) || H5Tget_size(type.id()) > bytes_ ||
      H5Sget_simple_extent_npoints(space.id()) != 1)
    return std::nullopt;
  std::vector<char> cell(H5Tget_size(type.id()));
  if (H5Aread(attribute.id(), type.id(), cell.data()) < 0) return std::nullopt;
  return cell_text({cell.data(), cell.size()}, type.id());
}

std::string Hdf5Reader::scalar_text(const Node& parent, const char* name) const {
  return text_data(data(parent, name), 0).front();
}

std::vector<std::string> Hdf5Reader::optional_texts(const Node& parent, const char* name) const {
  if (!has(parent, name)) return {};
  return text_data(data(parent, name), 1);
}

std::map<std::string, std::string> Hdf5Reader::optional_pairs(const Node& parent,
                                                              const char* name) const {
  std::map<std::string, std::string> result;
  if (!has(parent, name)) return result;
  const std::vector<std::string> cells = text_data(data(parent, name), 2);
  for (std::size_t i = 0; i + 1 < cells.size(); i += 2) result.emplace(cells[i], cells[i + 1]);
  return result;
}

Node Hdf5Reader::child(const Node& parent, const std::string& name, H5I_type_t kind,
                       std::string_view kind_name) const {
  const std::string path =
      parent.path == "/" ? "/" + name : fmt::format("{}/{}", parent.path, name);
  if (!has(parent, name.c_str())) damaged(path, "is missing");
  // a link may lead out of the file
  H5L_info_t link{};
  if (H5Lget_info(parent.id(), name.c_str(), &link, H5P_DEFAULT) < 0 || link.type != H5L_TYPE_HARD)
    damaged(path, "is a link");
  Node node{Hdf5Handle(H5Oopen(parent.id(), name.c_str(), H5P_DEFAULT), H5Oclose), path};
  if (!node.handle.valid()) damaged(path, "cannot be opened");
  if (H5Iget_type(node.id()) != kind) damaged(path, fmt::format("is not a {}", kind_name));
  return node;
}

Hdf5Handle Hdf5Reader::open_attribute(const Node& owner, const char* name) const {
  Hdf5Handle attribute(H5Aopen(owner.id(), name, H5P_DEFAULT), H5Aclose);
  if (!attribute.valid()) damaged(fmt::format("{}@{}", owner.path, name), "is missing");
  return attribute;
}

std::size_t Hdf5Reader::length(const Node& data) const {
  const std::size_t numbers = count(data, 1);
  const Hdf5Handle type(H5Dget_type(data.id()), H5Tclose);
  if (!is_number(type.id())) damaged(data.path, "is not made of numbers");
  return numbers;
}

std::size_t Hdf5Reader::count(const Node& node, int rank) const {
  const Hdf5Handle space(H5Dget_space(node.id()), H5Sclose);
  std::array<hsize_t, 2> shape{1, 1};
  if (H5Sget_simple_extent_ndims(space.id()) != rank ||
      H5Sget_simple_extent_dims(space.id(), shape.data(), nullptr) != rank ||
      (rank == 2 && shape[1] != 2))
    damaged(node.path, "has another shape than it must have");
  const Hdf5Handle creation(H5Dget_create_plist(node.id()), H5Pclose);
  const H5D_layout_t storage_layout = H5Pget_layout(creation.id());
  if (H5Pget_external_count(creation.id()) != 0 ||
      (storage_layout != H5D_CONTIGUOUS && storage_layout != H5D_CHUNKED &&
       storage_layout != H5D_COMPACT))
    damaged(node.path, "is kept in another file");

  const Hdf5Handle type(H5Dget_type(node.id()), H5Tclose);
  const std::uint64_t element = H5Tget_size(type.id());
  const std::uint64_t stored = H5Dget_storage_size(node.id());
  const std::uint64_t expansion =
      storage_layout == H5D_CHUNKED ? layout::largest_expansion : std::uint64_t{1};
  std::array<hsize_t, 2> chunk{1, 1};
  if (storage_layout == H5D_CHUNKED && H5Pget_chunk(creation.id(), 2, chunk.data()) != rank)
    damaged(node.path, "has another shape than it must have");
  const std::uint64_t most = std::min(stored, bytes_) * expansion;
  const std::uint64_t rows = std::max<std::uint64_t>(shape[0], chunk[0]);
  const std::uint64_t columns = std::max<std::uint64_t>(shape[1], chunk[1]);
  if (shape[0] > 0 && (stored > bytes_ || element == 0 || rows > most / element / columns))
    damaged(node.path, fmt::format("declares {} values and holds {} bytes", shape[0], stored));
  return static_cast<std::size_t>(shape[0] * shape[1]);
}

void Hdf5Reader::read_number(const Node& owner, const char* name, hid_t memory_type,
                             void* to) const {
  const Hdf5Handle attribute = open_attribute(owner, name);
  const Hdf5Handle type(H5Aget_type(attribute.id()), H5Tclose);
  const Hdf5Handle space(H5Aget_space(attribute.id()), H5Sclose);
  if (!is_number(type.id()) || H5Sget_simple_extent_npoints(space.id()) != 1 ||
      H5Aread(attribute.id(), memory_type, to) < 0)
    damaged(fmt::format("{}@{}", owner.path, name), "is not one number");
}

void Hdf5Reader::read_numbers(const Node& data, hid_t memory_type, void* to) const {
  const Hdf5Handle type(H5Dget_type(data.id()), H5Tclose);
  if (!is_number(type.id())) damaged(data.path, "is not made of numbers");
  if (H5Dread(data.id(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, to) < 0)
    damaged(data.path, "cannot be read");
}

void Hdf5Reader::read_numbers(const Node& data, hid_t memory_type, std::uint64_t first,
                              std::size_t count, void* to) const {
  const Hdf5Handle type(H5Dget_type(data.id()), H5Tclose);
  if (!is_number(type.id())) damaged(data.path, "is not made of numbers");
  const hsize_t start = first;
  const hsize_t size = count;
  const Hdf5Handle memory(H5Screate_simple(1, &size, nullptr), H5Sclose);
  const Hdf5Handle space(H5Dget_space(data.id()), H5Sclose);
  if (H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, &start, nullptr, &size, nullptr) < 0 ||
      H5Dread(data.id(), memory_type, memory.id(), space.id(), H5P_DEFAULT, to) < 0)
    damaged(data.path, "cannot be read");
}

std::vector<std::string> Hdf5Reader::text_data(const Node& data, int rank) const {
  const std::size_t n = count(data, rank);
  const Hdf5Handle type(H5Dget_type(data.id()), H5Tclose);
  if (!is_fixed_text(type.id())) damaged(data.path, "is not text of a fixed length");
  if (n > layout::largest_expansion * bytes_ / sizeof(std::string))
    damaged(data.path, fmt::format("declares {} texts in a file of {} bytes", n, bytes_));
  const std::size_t width = std::max<std::size_t>(H5Tget_size(type.id()), 1);
  const std::size_t columns = rank == 2 ? 2 : 1;
  const std::size_t rows = n / columns;
  const std::size_t piece = std::max<std::size_t>(layout::text_piece / (width * columns), 1);
  const Hdf5Handle space(H5Dget_space(data.id()), H5Sclose);
  std::vector<std::string> result;
  for (std::size_t row = 0; row < rows; row += piece) {
    const std::array<hsize_t, 2> start{row, 0};
    const std::array<hsize_t, 2> block{std::min(piece, rows - row), columns};
    const Hdf5Handle memory(
        rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(rank, block.data(), nullptr),
        H5Sclose);
    if (rank > 0)
      H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start.data(), nullptr, block.data(), nullptr);
    std::vector<char> cells(block[0] * columns * width);
    if (H5Dread(data.id(), type.id(), memory.id(), space.id(), H5P_DEFAULT, cells.data()) < 0)
      damaged(data.path, "cannot be read");
    for (std::size_t at = 0; at < cells.size(); at += width)
      result.push_back(cell_text({cells.data() + at, width}, type.id()));
  }
  return result;
}

}  // namespace impactrig::datasets
