// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/hdf5_attributes.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "acquisition/importers/hdf5_sender.hpp"
#include "acquisition/importers/text_file.hpp"
#include "datasets/hdf5_handle.hpp"

namespace impactrig::acquisition {

using datasets::Hdf5Handle;

namespace {

constexpr unsigned most_attributes = 200;  ///< of one object

std::string fixed_text(std::string_view cell) {
  cell = cell.substr(0, cell.find('\0'));
  while (cell.ends_with(' ')) cell.remove_suffix(1);
  return to_utf8(cell.substr(0, hdf5_longest_text));
}

/// Texts of an attribute; false when they cannot be read.
bool take_text(hid_t attribute, hid_t type, std::size_t count, const std::string& key,
               Hdf5Attributes& found) {
  auto texts = hdf5_texts_of(
      type, count, [attribute](hid_t memory, void* to) { return H5Aread(attribute, memory, to); });
  if (!texts) return false;
  if (count == 1)
    found.texts.emplace(key, std::move(texts->front()));
  else
    found.lists.emplace(key, std::move(*texts));
  return true;
}

/// Numbers of an attribute; false when they cannot be read.
bool take_numbers(hid_t attribute, std::size_t count, const std::string& key,
                  Hdf5Attributes& found) {
  std::vector<double> values(count);
  if (H5Aread(attribute, H5T_NATIVE_DOUBLE, values.data()) < 0) return false;
  if (count == 1)
    found.numbers.emplace(key, values.front());
  else
    found.number_lists.emplace(key, std::move(values));
  return true;
}

/// One attribute, as text or number; of another kind, or with too many values, its name.
void take_attribute(hid_t attribute, Hdf5Attributes& found) {
  std::array<char, 256> name{};
  if (H5Aget_name(attribute, name.size(), name.data()) <= 0) return;
  const Hdf5Handle type(H5Aget_type(attribute), H5Tclose);
  const Hdf5Handle space(H5Aget_space(attribute), H5Sclose);
  const hssize_t values = H5Sget_simple_extent_npoints(space.id());
  const H5T_class_t kind = H5Tget_class(type.id());
  const std::string key = to_utf8(name.data());
  const auto size = static_cast<std::size_t>(std::max(values, hssize_t{0}));
  const bool is_number = kind == H5T_INTEGER || kind == H5T_FLOAT;
  bool taken = size > 0 && size <= hdf5_longest_list;
  if (taken && kind == H5T_STRING)
    taken = take_text(attribute, type.id(), size, key, found);
  else
    taken = taken && is_number && take_numbers(attribute, size, key, found);
  if (!taken) found.others.push_back(key);
}

}  // namespace

std::optional<std::vector<std::string>> hdf5_texts_of(
    hid_t type, std::size_t count, const std::function<herr_t(hid_t, void*)>& read) {
  std::vector<std::string> texts;
  if (H5Tis_variable_str(type) > 0) {
    const Hdf5Handle memory(H5Tcopy(type), H5Tclose);
    std::vector<char*> lines(count, nullptr);
    if (read(memory.id(), lines.data()) < 0) return std::nullopt;
    for (char* const line : lines) {
      texts.push_back(line == nullptr ? std::string() : fixed_text(line));
      H5free_memory(line);
    }
    return texts;
  }
  const std::size_t width = H5Tget_size(type);
  if (width == 0 || width > 65536) return std::nullopt;
  std::vector<char> cells(width * count);
  if (read(type, cells.data()) < 0) return std::nullopt;
  for (std::size_t i = 0; i < count; ++i)
    texts.push_back(fixed_text({cells.data() + i * width, width}));
  return texts;
}

Hdf5Attributes hdf5_attributes_of(hid_t object) {
  Hdf5Attributes found;
  const int count = H5Aget_num_attrs(object);
  for (unsigned i = 0; i < std::min(static_cast<unsigned>(std::max(count, 0)), most_attributes);
       ++i) {
    const Hdf5Handle attribute(
        H5Aopen_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_INC, i, H5P_DEFAULT, H5P_DEFAULT),
        H5Aclose);
    if (attribute.valid()) take_attribute(attribute.id(), found);
  }
  return found;
}

std::uint64_t hdf5_reference_to(hid_t object) {
  hobj_ref_t reference = 0;
  return H5Rcreate(&reference, object, ".", H5R_OBJECT, H5I_INVALID_HID) < 0 ? 0 : reference;
}

std::vector<std::vector<std::uint64_t>> hdf5_scales_of(hid_t data, std::size_t rank) {
  constexpr const char* name = "DIMENSION_LIST";
  if (rank == 0 || H5Aexists(data, name) <= 0) return {};
  const Hdf5Handle attribute(H5Aopen(data, name, H5P_DEFAULT), H5Aclose);
  const Hdf5Handle type(H5Aget_type(attribute.id()), H5Tclose);
  const Hdf5Handle space(H5Aget_space(attribute.id()), H5Sclose);
  if (H5Tget_class(type.id()) != H5T_VLEN) return {};
  const Hdf5Handle element(H5Tget_super(type.id()), H5Tclose);
  if (H5Tequal(element.id(), H5T_STD_REF_OBJ) <= 0 ||
      H5Sget_simple_extent_npoints(space.id()) != static_cast<hssize_t>(rank))
    return {};
  const Hdf5Handle memory(H5Tvlen_create(H5T_STD_REF_OBJ), H5Tclose);
  std::vector<hvl_t> lists(rank, hvl_t{0, nullptr});
  if (H5Aread(attribute.id(), memory.id(), lists.data()) < 0) return {};
  std::vector<std::vector<std::uint64_t>> scales(rank);
  for (std::size_t d = 0; d < rank; ++d) {
    const auto* const first = static_cast<const hobj_ref_t*>(lists[d].p);
    const std::size_t count = first == nullptr ? 0 : std::min(lists[d].len, hdf5_most_scales);
    scales[d].assign(first, first + count);
  }
  H5Dvlen_reclaim(memory.id(), space.id(), H5P_DEFAULT, lists.data());
  return scales;
}

}  // namespace impactrig::acquisition
