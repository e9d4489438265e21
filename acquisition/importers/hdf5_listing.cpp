// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/hdf5_sender.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string_view>

#include "acquisition/importers/hdf5_attributes.hpp"
#include "acquisition/importers/hdf5_open_file.hpp"
#include "acquisition/importers/hdf5_sent.hpp"
#include "acquisition/importers/hdf5_storage.hpp"
#include "acquisition/importers/hdf5_types.hpp"
#include "acquisition/importers/text_file.hpp"

namespace impactrig::acquisition {

using datasets::Hdf5Handle;

namespace {

constexpr std::size_t most_objects = 10000;     ///< groups and data sets that are looked at
constexpr std::size_t longest_path = 1000;      ///< [bytes]
constexpr std::uint64_t most_elements = 10000;  ///< of lists in records

struct Link {
  std::string name;
  H5L_type_t kind;
};

herr_t take_link(hid_t, const char* name, const H5L_info_t* info, void* to) {
  auto& links = *static_cast<std::vector<Link>*>(to);
  links.push_back({name, info->type});
  return links.size() > most_objects ? 1 : 0;
}

/// As the file has it; "" where it cannot be read.
std::string link_target(hid_t group, const std::string& name) {
  H5L_info_t info{};
  if (H5Lget_info(group, name.c_str(), &info, H5P_DEFAULT) < 0 || info.u.val_size > longest_path)
    return {};
  std::string target(info.u.val_size, '\0');
  if (H5Lget_val(group, name.c_str(), target.data(), target.size(), H5P_DEFAULT) < 0) return {};
  return target.substr(0, target.find('\0'));
}

/// False where the file tells none.
bool take_shape(hid_t space, Hdf5Array& array) {
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 0 || rank > H5S_MAX_RANK) return false;
  std::array<hsize_t, H5S_MAX_RANK> sides{};
  H5Sget_simple_extent_dims(space, sides.data(), nullptr);
  array.shape.assign(sides.begin(), sides.begin() + rank);
  return true;
}

/// Text that MATLAB keeps as numbers, one line of it.
std::string letters(hid_t id, const std::vector<std::uint64_t>& shape) {
  std::uint64_t count = 1;
  for (const std::uint64_t side : shape)
    count = std::min<std::uint64_t>(count * std::min<std::uint64_t>(side, 10000), 10000);
  constexpr std::uint64_t most_letters = 2000;
  if (count > most_letters) return {};
  std::vector<std::uint16_t> codes(count);
  if (H5Dread(id, H5T_NATIVE_UINT16, H5S_ALL, H5S_ALL, H5P_DEFAULT, codes.data()) < 0) return {};
  std::string utf16 = "\xFF\xFE";
  for (const std::uint16_t code : codes) {
    utf16 += static_cast<char>(code & 0xFF);
    utf16 += static_cast<char>(code >> 8);
  }
  return to_utf8(utf16_to_utf8(utf16));
}

/// Goes through the groups of a file, each once.
class Walk {
 public:
  Walk(const std::string& path, std::uint64_t bytes, const PipeWriter& out)
      : open_(path),
        bytes_(bytes),
        out_(out) {}

  void run() {
    if (!open_.file.valid()) return out_.text("HDF5 cannot open it: it is damaged or cut");
    out_.text("");
    const Hdf5Handle root(H5Gopen2(open_.file.id(), "/", H5P_DEFAULT), H5Gclose);
    H5O_info_t info{};
    if (root.valid() && H5Oget_info(root.id(), &info) >= 0) {
      seen_.insert(info.addr);
      group(root.id(), "/", 0);
    }
    out_.text("end");
  }

 private:
  void skip(const std::string& path, std::string_view why) {
    if (++skipped_ > 50) return;
    out_.text("skipped");
    out_.text(fmt::format("'{}' ({})", to_utf8(path), why));
  }

  void group(hid_t id, const std::string& path, int depth) {
    const Hdf5Attributes attributes = hdf5_attributes_of(id);
    out_.text("group");
    out_.text(path);
    out_.number(hdf5_reference_to(id));
    send_hdf5_attributes(attributes, out_);
    std::vector<Link> links;
    hsize_t at = 0;
    H5Literate(id, H5_INDEX_NAME, H5_ITER_INC, &at, take_link, &links);
    for (const auto& [name, kind] : links) {
      if (++objects_ > most_objects) {
        if (objects_ == most_objects + 1) skip(path, "more than 10000 objects");
        return;
      }
      const std::string full = path == "/" ? "/" + name : path + "/" + name;
      if (full.size() > longest_path) {
        skip(full.substr(0, 100), "a path of over 1000 bytes");
      } else if (kind == H5L_TYPE_SOFT) {
        link(full, path, link_target(id, name));
      } else if (kind != H5L_TYPE_HARD) {
        skip(full, "a link into another file");
      } else {
        object(id, name, full, depth);
      }
    }
  }

  /// A soft link is never followed: what it leads to is listed where it is. A path without a '/' in
  /// front begins in the link's group.
  void link(const std::string& from, const std::string& group, std::string target) {
    if (target.empty()) return skip(from, "a link");
    if (target.front() != '/') target.insert(0, group == "/" ? group : group + "/");
    out_.text("link");
    out_.text(from);
    out_.text(target);
  }

  void object(hid_t parent, const std::string& name, const std::string& path, int depth) {
    const Hdf5Handle node(H5Oopen(parent, name.c_str(), H5P_DEFAULT), H5Oclose);
    if (!node.valid()) return skip(path, "damaged");
    const H5I_type_t kind = H5Iget_type(node.id());
    if (kind == H5I_DATASET) return data(node.id(), path);
    if (kind != H5I_GROUP) return;
    H5O_info_t info{};
    if (H5Oget_info(node.id(), &info) < 0) return skip(path, "damaged");
    // a group may be linked from several places, also from within itself
    if (!seen_.insert(info.addr).second) return skip(path, "a group that is listed already");
    if (depth >= hdf5_deepest) return skip(path, "nested too deeply");
    group(node.id(), path, depth + 1);
  }

  void data(hid_t id, const std::string& path) {
    const Hdf5Handle type(H5Dget_type(id), H5Tclose);
    const Hdf5Handle space(H5Dget_space(id), H5Sclose);
    if (H5Sget_simple_extent_type(space.id()) == H5S_NULL) return skip(path, "empty");
    Hdf5Array array;
    array.path = path;
    if (!take_shape(space.id(), array)) return skip(path, "damaged");
    const H5T_class_t kind = H5Tget_class(type.id());
    const auto numbers = kind == H5T_COMPOUND ? ArrayNumbers::f64 : hdf5_numbers_of(type.id());
    const hssize_t points = H5Sget_simple_extent_npoints(space.id());
    const bool few = points > 0 && points <= static_cast<hssize_t>(hdf5_longest_list);
    const bool references = kind == H5T_REFERENCE && H5Tequal(type.id(), H5T_STD_REF_OBJ) > 0;
    if (!numbers && !references && !(kind == H5T_STRING && few))
      return skip(path, hdf5_kind_name(kind));
    if (numbers) array.numbers = *numbers;
    if (std::ranges::find(array.shape, std::uint64_t{0}) != array.shape.end())
      return skip(path, "empty");
    const std::string problem =
        hdf5_storage_problem(id, array.shape, H5Tget_size(type.id()), bytes_);
    if (!problem.empty()) return skip(path, problem);
    if (kind == H5T_STRING) return text(id, type.id(), static_cast<std::size_t>(points), path);
    if (references) return put_references(id, space.id(), path);
    if (!is_listed(id, array)) put_numbers(id, type.id(), array);
  }

  /// A data set of numbers, or those among the fields of its records.
  void put_numbers(hid_t id, hid_t type, Hdf5Array& array) {
    const bool compound = H5Tget_class(type) == H5T_COMPOUND;
    array.complex = compound && hdf5_is_complex(type);
    array.wide = hdf5_is_wide(type);
    array.bits = H5Tget_class(type) == H5T_BITFIELD;
    array.attributes = hdf5_attributes_of(id);
    array.reference = hdf5_reference_to(id);
    array.scales = hdf5_scales_of(id, array.shape.size());
    const auto matlab = array.attributes.texts.find("MATLAB_class");
    if (matlab != array.attributes.texts.end() && matlab->second == "char")
      array.text = letters(id, array.shape);
    if (compound && !array.complex)
      fields(type, array);
    else
      send_hdf5_array(array, out_);
  }

  /// A data set that several hard links lead to is listed by the first; the others are told as soft
  /// ones are. A single number (an interval, a rate) counts in each of its groups, and what MATLAB
  /// keeps for itself gives no variable its name.
  bool is_listed(hid_t id, const Hdf5Array& array) {
    H5O_info_t info{};
    if (array.shape.empty() || array.path.starts_with("/#") || H5Oget_info(id, &info) < 0)
      return false;
    const auto [first, is_new] = data_sets_.emplace(info.addr, array.path);
    if (!is_new) link(array.path, "/", first->second);
    return !is_new;
  }

  /// The numbers among the fields of records.
  void fields(hid_t type, Hdf5Array& array) {
    array.fields = static_cast<std::uint64_t>(std::max(H5Tget_nmembers(type), 0));
    if (hdf5_count_fields(type) > hdf5_longest_list)
      return skip(array.path,
                  fmt::format("records of over {} fields, or too deep ones", hdf5_longest_list));
    for (unsigned i = 0; i < array.fields; ++i) {
      array.field_index = i;
      field(type, i, array);
    }
  }

  /// One of them, or those of the records that it is.
  void field(hid_t type, unsigned index, Hdf5Array& array) {
    char* const name = H5Tget_member_name(type, index);
    if (name == nullptr) return skip(array.path, "damaged");
    array.field_path.emplace_back(name);
    H5free_memory(name);
    const Hdf5Handle member(H5Tget_member_type(type, index), H5Tclose);
    const std::uint64_t elements = hdf5_list_length(member.id());
    const Hdf5Handle of_list(elements > 0 ? H5Tget_super(member.id()) : H5Tcopy(member.id()),
                             H5Tclose);
    const auto numbers = hdf5_numbers_of(of_list.id());
    const std::string full = array.path + "." + array.field();
    if (full.size() > longest_path) {
      skip(full.substr(0, 100), "a path of over 1000 bytes");
    } else if (H5Tget_class(member.id()) == H5T_COMPOUND) {
      for (unsigned i = 0; i < static_cast<unsigned>(H5Tget_nmembers(member.id())); ++i)
        field(member.id(), i, array);
    } else if (!numbers) {
      skip(full, hdf5_kind_name(H5Tget_class(member.id())));
    } else {
      array.numbers = *numbers;
      array.wide = hdf5_is_wide(of_list.id());
      array.bits = H5Tget_class(of_list.id()) == H5T_BITFIELD;
      if (elements > 0 && (elements_ += elements) > most_elements) {
        skip(full, fmt::format("a list: more than {} numbers in lists", most_elements));
        array.field_path.pop_back();
        return;
      }
      array.elements = elements;
      for (array.element = 0; array.element < std::max<std::uint64_t>(elements, 1); ++array.element)
        send_hdf5_array(array, out_);
      array.element = array.elements = 0;
    }
    array.field_path.pop_back();
  }

  void text(hid_t id, hid_t type, std::size_t count, const std::string& path) {
    const auto texts = hdf5_texts_of(type, count, [id](hid_t memory, void* to) {
      return H5Dread(id, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, to);
    });
    if (!texts) return skip(path, "text");
    out_.text(count == 1 ? "text" : "texts");
    out_.text(path);
    if (count > 1) out_.number(count);
    for (const std::string& one : *texts) out_.text(one);
  }

  /// MATLAB keeps the fields of several structures so, and cell arrays.
  void put_references(hid_t id, hid_t space, const std::string& path) {
    const hssize_t count = H5Sget_simple_extent_npoints(space);
    if (count < 0 || static_cast<std::uint64_t>(count) > hdf5_most_references)
      return skip(path, fmt::format("more than {} references", hdf5_most_references));
    std::vector<hobj_ref_t> references(static_cast<std::size_t>(count));
    if (H5Dread(id, H5T_STD_REF_OBJ, H5S_ALL, H5S_ALL, H5P_DEFAULT, references.data()) < 0)
      return skip(path, "damaged");
    const Hdf5Attributes attributes = hdf5_attributes_of(id);
    const auto matlab = attributes.texts.find("MATLAB_class");
    out_.text("references");
    out_.text(path);
    out_.text(matlab == attributes.texts.end() ? std::string() : matlab->second);
    out_.number(hdf5_reference_to(id));
    out_.number(references.size());
    for (const hobj_ref_t reference : references) out_.number(reference);
  }

  Hdf5OpenFile open_;
  std::uint64_t bytes_;
  const PipeWriter& out_;
  std::size_t objects_ = 0;
  std::uint64_t elements_ = 0;  ///< of lists in records, all of a file
  std::size_t skipped_ = 0;
  std::set<haddr_t> seen_;
  std::map<haddr_t, std::string> data_sets_;  ///< paths, of those that are listed
};

}  // namespace

void send_hdf5_listing(const std::string& path, std::uint64_t bytes, const PipeWriter& out) {
  Walk(path, bytes, out).run();
}

}  // namespace impactrig::acquisition
