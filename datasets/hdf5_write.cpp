// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/hdf5_write.hpp"

#include <algorithm>
#include <array>

namespace impactrig::datasets {

namespace {

herr_t note_first(unsigned, const H5E_error2_t* error, void* reason) {
  if (error->desc != nullptr) *static_cast<std::string*>(reason) = error->desc;
  return 1;  // no further
}

[[noreturn]] void fail() {
  std::string said;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, note_first, &said);
  throw WriteFailure{"HDF5 could not lay it out in memory: " + said};
}

/// At most so many bytes, without the half of a UTF-8 character.
std::string_view cut(std::string_view text, std::size_t most) {
  if (text.size() <= most) return text;
  while (most > 0 && (static_cast<unsigned char>(text[most]) & 0xc0) == 0x80) --most;
  return text.substr(0, most);
}

/// Texts side by side, each filled up with NUL.
std::vector<char> cells_of(std::span<const std::string> texts, std::size_t width) {
  std::vector<char> cells(texts.size() * width, '\0');
  for (std::size_t i = 0; i < texts.size(); ++i)
    std::ranges::copy(texts[i], cells.begin() + static_cast<std::ptrdiff_t>(i * width));
  return cells;
}

void add_text_attribute(hid_t owner, const char* name, std::string_view text, hid_t space) {
  const std::string escaped = layout::with_nul_escaped(cut(text, layout::longest_attribute));
  const Hdf5Handle type = hdf5_text_type(escaped.size());
  add_attribute(owner, name, type.id(), space, type.id(), escaped.c_str());
}

}  // namespace

Hdf5Handle made(hid_t id, Hdf5Handle::Close closer) {
  if (id < 0) fail();
  return {id, closer};
}

void check(herr_t status) {
  if (status < 0) fail();
}

void add_attribute(hid_t owner, const char* name, hid_t type, hid_t space, hid_t memory_type,
                   const void* value) {
  const Hdf5Handle attribute =
      made(H5Acreate2(owner, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  check(H5Awrite(attribute.id(), memory_type, value));
}

Hdf5Handle scalar_space() {
  return made(H5Screate(H5S_SCALAR), H5Sclose);
}

void add_text(hid_t owner, const char* name, std::string_view text) {
  add_text_attribute(owner, name, text, scalar_space().id());
}

void add_text_list(hid_t owner, const char* name, std::string_view text) {
  const hsize_t one = 1;
  add_text_attribute(owner, name, text, made(H5Screate_simple(1, &one, nullptr), H5Sclose).id());
}

Hdf5Handle add_group(hid_t parent, const std::string& name, std::string_view nexus_class) {
  const Hdf5Handle properties = made(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  check(H5Pset_link_creation_order(properties.id(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED));
  Hdf5Handle group =
      made(H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, properties.id(), H5P_DEFAULT), H5Gclose);
  add_text(group.id(), "NX_class", nexus_class);
  return group;
}

void add_text_data(hid_t parent, const char* name, std::span<const std::string> texts,
                   hsize_t columns) {
  if (texts.empty()) return;
  std::vector<std::string> escaped;
  std::size_t width = 1;
  for (const std::string& text : texts) {
    escaped.push_back(layout::with_nul_escaped(text));
    width = std::max(width, escaped.back().size());
  }
  // One long text makes every cell wide, so that rows are compressed and written in pieces.
  const std::array<hsize_t, 2> shape{texts.size() / columns, columns};
  const hsize_t piece = std::clamp<hsize_t>(layout::text_piece / (width * columns), 1, shape[0]);
  const int rank = columns == 1 ? 1 : 2;
  const Hdf5Handle properties = made(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const std::array<hsize_t, 2> chunk{piece, columns};
  check(H5Pset_chunk(properties.id(), rank, chunk.data()));
  check(H5Pset_deflate(properties.id(), 1));
  check(H5Pset_fletcher32(properties.id()));
  const Hdf5Handle type = hdf5_text_type(width);
  const Hdf5Handle space = made(H5Screate_simple(rank, shape.data(), nullptr), H5Sclose);
  const Hdf5Handle data = made(
      H5Dcreate2(parent, name, type.id(), space.id(), H5P_DEFAULT, properties.id(), H5P_DEFAULT),
      H5Dclose);
  for (hsize_t row = 0; row < shape[0]; row += piece) {
    const std::array<hsize_t, 2> start{row, 0};
    const std::array<hsize_t, 2> block{std::min(piece, shape[0] - row), columns};
    const Hdf5Handle memory = made(H5Screate_simple(rank, block.data(), nullptr), H5Sclose);
    check(H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start.data(), nullptr, block.data(),
                              nullptr));
    const std::vector<char> cells =
        cells_of(std::span(escaped).subspan(row * columns, block[0] * columns), width);
    check(H5Dwrite(data.id(), type.id(), memory.id(), space.id(), H5P_DEFAULT, cells.data()));
  }
}

void add_pairs(hid_t parent, const char* name, const std::map<std::string, std::string>& pairs) {
  std::vector<std::string> cells;
  for (const auto& [key, value] : pairs) {
    cells.push_back(key);
    cells.push_back(value);
  }
  add_text_data(parent, name, cells, 2);
}

void add_scalar_text(hid_t parent, const char* name, std::string_view text) {
  const std::string escaped = layout::with_nul_escaped(text);
  const Hdf5Handle type = hdf5_text_type(escaped.size());
  const Hdf5Handle data = made(H5Dcreate2(parent, name, type.id(), scalar_space().id(), H5P_DEFAULT,
                                          H5P_DEFAULT, H5P_DEFAULT),
                               H5Dclose);
  check(H5Dwrite(data.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, escaped.c_str()));
}

void attach_time(hid_t group, const Hdf5Handle& time, std::span<const Hdf5Handle> data) {
  const auto fixed_text = [&](const char* name, const char* text, std::size_t size) {
    const Hdf5Handle type = made(H5Tcopy(H5T_C_S1), H5Tclose);
    check(H5Tset_size(type.id(), size));
    add_attribute(time.id(), name, type.id(), scalar_space().id(), type.id(), text);
  };
  fixed_text("CLASS", "DIMENSION_SCALE", sizeof "DIMENSION_SCALE");
  fixed_text("NAME", "time", sizeof "time");

  struct Use {
    hobj_ref_t data;
    int dimension;
  };

  std::vector<Use> uses;
  hobj_ref_t time_reference{};
  check(H5Rcreate(&time_reference, group, "time", H5R_OBJECT, -1));
  const hsize_t one = 1;
  const Hdf5Handle one_space = made(H5Screate_simple(1, &one, nullptr), H5Sclose);
  const Hdf5Handle list_type = made(H5Tvlen_create(H5T_STD_REF_OBJ), H5Tclose);
  for (const Hdf5Handle& set : data) {
    const hvl_t list{1, &time_reference};
    add_attribute(set.id(), "DIMENSION_LIST", list_type.id(), one_space.id(), list_type.id(),
                  &list);
    uses.push_back({{}, 0});
    check(H5Rcreate(&uses.back().data, set.id(), ".", H5R_OBJECT, -1));
  }
  const Hdf5Handle use_type = made(H5Tcreate(H5T_COMPOUND, sizeof(Use)), H5Tclose);
  check(H5Tinsert(use_type.id(), "dataset", HOFFSET(Use, data), H5T_STD_REF_OBJ));
  check(H5Tinsert(use_type.id(), "dimension", HOFFSET(Use, dimension), H5T_NATIVE_INT));
  const hsize_t count = uses.size();
  const Hdf5Handle space = made(H5Screate_simple(1, &count, nullptr), H5Sclose);
  add_attribute(time.id(), "REFERENCE_LIST", use_type.id(), space.id(), use_type.id(), uses.data());
}

}  // namespace impactrig::datasets
