// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/hdf5_sender.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "acquisition/importers/hdf5_lzf.hpp"
#include "acquisition/importers/text_file.hpp"
#include "datasets/hdf5_handle.hpp"

namespace impactrig::acquisition {

using datasets::Hdf5Handle;

namespace {

constexpr int deepest = 16;                  ///< groups in groups
constexpr std::size_t most_objects = 10000;  ///< groups and data sets that are looked at
constexpr unsigned most_attributes = 200;    ///< of one object
constexpr std::size_t longest_text = 2000;   ///< of an attribute [bytes]
constexpr std::size_t longest_path = 1000;   ///< [bytes]
constexpr std::uint64_t largest_chunk = std::uint64_t{128} << 20;  ///< [bytes]
constexpr std::uint64_t largest_expansion = 1100;                  ///< deflate: 1032

struct OpenFile {
  Hdf5Handle access{H5Pcreate(H5P_FILE_ACCESS), H5Pclose};
  Hdf5Handle file{H5I_INVALID_HID, H5Fclose};

  explicit OpenFile(const std::string& path) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    H5PLset_loading_state(0);  // no filter of a file loads a library
    register_lzf();
    H5Pset_fclose_degree(access.id(), H5F_CLOSE_STRONG);
    file = Hdf5Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose);
  }
};

std::string fixed_text(std::string_view cell) {
  cell = cell.substr(0, cell.find('\0'));
  while (cell.ends_with(' ')) cell.remove_suffix(1);
  return to_utf8(cell.substr(0, longest_text));
}

/// Texts of an attribute or of a data set, which `read` reads with a type into memory.
template <typename Read>
std::optional<std::vector<std::string>> texts_of(hid_t type, std::size_t count, const Read& read) {
  std::vector<std::string> texts;
  if (H5Tis_variable_str(type) > 0) {
    const Hdf5Handle memory(H5Tcopy(type), H5Tclose);
    std::vector<char*> lines(count, nullptr);
    if (read(memory.id(), static_cast<void*>(lines.data())) < 0) return std::nullopt;
    for (char* const line : lines) {
      texts.push_back(line == nullptr ? std::string() : fixed_text(line));
      H5free_memory(line);
    }
    return texts;
  }
  const std::size_t width = H5Tget_size(type);
  if (width == 0 || width > 65536) return std::nullopt;
  std::vector<char> cells(width * count);
  if (read(type, static_cast<void*>(cells.data())) < 0) return std::nullopt;
  for (std::size_t i = 0; i < count; ++i)
    texts.push_back(fixed_text({cells.data() + i * width, width}));
  return texts;
}

/// Texts of an attribute; false when they cannot be read.
bool take_text(hid_t attribute, hid_t type, std::size_t count, const std::string& key,
               Hdf5Attributes& found) {
  auto texts = texts_of(
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

Hdf5Attributes attributes_of(hid_t object) {
  Hdf5Attributes found;
  const int count = H5Aget_num_attrs(object);
  for (unsigned i = 0; i < std::min(static_cast<unsigned>(std::max(count, 0)), most_attributes);
       ++i) {
    const Hdf5Handle attribute(
        H5Aopen_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_INC, i, H5P_DEFAULT, H5P_DEFAULT),
        H5Aclose);
    if (!attribute.valid()) continue;
    std::array<char, 256> name{};
    if (H5Aget_name(attribute.id(), name.size(), name.data()) <= 0) continue;
    const Hdf5Handle type(H5Aget_type(attribute.id()), H5Tclose);
    const Hdf5Handle space(H5Aget_space(attribute.id()), H5Sclose);
    const hssize_t values = H5Sget_simple_extent_npoints(space.id());
    const H5T_class_t kind = H5Tget_class(type.id());
    const std::string key = to_utf8(name.data());
    const auto size = static_cast<std::size_t>(std::max(values, hssize_t{0}));
    const bool is_number = kind == H5T_INTEGER || kind == H5T_FLOAT;
    bool taken = size > 0 && size <= hdf5_longest_list;
    if (taken && kind == H5T_STRING)
      taken = take_text(attribute.id(), type.id(), size, key, found);
    else
      taken = taken && is_number && take_numbers(attribute.id(), size, key, found);
    if (!taken) found.others.push_back(key);
  }
  return found;
}

/// What stands for an object in lists of references; 0 where it has none.
std::uint64_t reference_to(hid_t object) {
  hobj_ref_t reference = 0;
  return H5Rcreate(&reference, object, ".", H5R_OBJECT, H5I_INVALID_HID) < 0 ? 0 : reference;
}

/// The references to the scales of each dimension; empty where there is no such list, or a damaged
/// one. They are compared with those of the data sets that are met, and never followed: a damaged
/// one leads nowhere.
std::vector<std::vector<std::uint64_t>> scales_of(hid_t data, std::size_t rank) {
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

/// The type of ours that holds all numbers of a type, but for floating point wider than double
/// precision; none where HDF5 knows no numbers. The values of an enumeration are its integers: h5py
/// writes true and false so.
std::optional<ArrayNumbers> numbers_of(hid_t type) {
  const H5T_class_t kind = H5Tget_class(type);
  if (kind == H5T_ENUM) {
    const Hdf5Handle integers(H5Tget_super(type), H5Tclose);
    return numbers_of(integers.id());
  }
  if (kind == H5T_INTEGER) {
    const std::size_t bits = H5Tget_precision(type) + (H5Tget_sign(type) == H5T_SGN_NONE ? 1 : 0);
    return bits <= 16 ? ArrayNumbers::i16 : bits <= 32 ? ArrayNumbers::i32 : ArrayNumbers::f64;
  }
  if (kind != H5T_FLOAT) return std::nullopt;
  std::size_t sign = 0, exponent_at = 0, exponent = 0, mantissa_at = 0, mantissa = 0;
  if (H5Tget_fields(type, &sign, &exponent_at, &exponent, &mantissa_at, &mantissa) < 0)
    return std::nullopt;
  return exponent <= 8 && mantissa <= 23 ? ArrayNumbers::f32 : ArrayNumbers::f64;
}

bool is_wide(hid_t type) {
  return H5Tget_class(type) == H5T_INTEGER && H5Tget_precision(type) > 53;
}

hid_t memory_type(ArrayNumbers numbers) {
  switch (numbers) {
    case ArrayNumbers::i16:
      return H5T_NATIVE_INT16;
    case ArrayNumbers::i32:
      return H5T_NATIVE_INT32;
    case ArrayNumbers::f32:
      return H5T_NATIVE_FLOAT;
    default:
      return H5T_NATIVE_DOUBLE;
  }
}

std::size_t width_of(ArrayNumbers numbers) {
  return numbers == ArrayNumbers::i16 ? 2 : numbers == ArrayNumbers::f64 ? 8 : 4;
}

/// Why a data set's bytes cannot be what it declares, or are not read; "" when they can.
std::string storage_problem(hid_t data, const std::vector<std::uint64_t>& shape,
                            std::uint64_t element, std::uint64_t file_bytes) {
  const Hdf5Handle creation(H5Dget_create_plist(data), H5Pclose);
  const H5D_layout_t layout = H5Pget_layout(creation.id());
  if (H5Pget_external_count(creation.id()) != 0 ||
      (layout != H5D_CONTIGUOUS && layout != H5D_CHUNKED && layout != H5D_COMPACT))
    return "kept in another file";
  const int filters = H5Pget_nfilters(creation.id());
  for (int i = 0; i < filters; ++i) {
    unsigned flags = 0;
    std::size_t values = 0;
    unsigned config = 0;
    const H5Z_filter_t filter = H5Pget_filter2(creation.id(), static_cast<unsigned>(i), &flags,
                                               &values, nullptr, 0, nullptr, &config);
    if (H5Zfilter_avail(filter) <= 0)
      return fmt::format(
          "packed by filter {}; HDF5's own and lzf are read: h5repack -f GZIP=1 rewrites it",
          filter);
  }
  const std::uint64_t stored = H5Dget_storage_size(data);
  long double declared = static_cast<long double>(element);
  for (const std::uint64_t side : shape) declared *= static_cast<long double>(side);
  const auto most = static_cast<long double>(std::min(stored, file_bytes) *
                                             (layout == H5D_CHUNKED ? largest_expansion : 1));
  if (stored > file_bytes || declared > most)
    return fmt::format("it declares {:.0f} bytes and holds {}", static_cast<double>(declared),
                       stored);
  if (layout != H5D_CHUNKED) return {};
  std::array<hsize_t, H5S_MAX_RANK> chunk{};
  const int rank = H5Pget_chunk(creation.id(), static_cast<int>(chunk.size()), chunk.data());
  if (rank != static_cast<int>(shape.size())) return "damaged: its pieces have another shape";
  long double bytes = static_cast<long double>(element);
  for (int i = 0; i < rank; ++i)
    bytes *= static_cast<long double>(chunk[static_cast<std::size_t>(i)]);
  if (bytes > static_cast<long double>(largest_chunk))
    return fmt::format("in pieces of {:.0f} MB, at most {} are read",
                       static_cast<double>(bytes) / 1048576.0, largest_chunk >> 20);
  return {};
}

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

  void put(const Hdf5Attributes& attributes) {
    out_.number(attributes.texts.size());
    for (const auto& [key, text] : attributes.texts) {
      out_.text(key);
      out_.text(text);
    }
    out_.number(attributes.lists.size());
    for (const auto& [key, texts] : attributes.lists) {
      out_.text(key);
      out_.number(texts.size());
      for (const std::string& text : texts) out_.text(text);
    }
    out_.number(attributes.numbers.size());
    for (const auto& [key, value] : attributes.numbers) {
      out_.text(key);
      out_.real(value);
    }
    out_.number(attributes.number_lists.size());
    for (const auto& [key, values] : attributes.number_lists) {
      out_.text(key);
      out_.number(values.size());
      for (const double value : values) out_.real(value);
    }
    out_.number(attributes.others.size());
    for (const std::string& key : attributes.others) out_.text(key);
  }

  void group(hid_t id, const std::string& path, int depth) {
    const Hdf5Attributes attributes = attributes_of(id);
    out_.text("group");
    out_.text(path);
    out_.number(reference_to(id));
    put(attributes);
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

  struct Link {
    std::string name;
    H5L_type_t kind;
  };

  static herr_t take_link(hid_t, const char* name, const H5L_info_t* info, void* to) {
    auto& links = *static_cast<std::vector<Link>*>(to);
    links.push_back({name, info->type});
    return links.size() > most_objects ? 1 : 0;
  }

  /// As the file has it; "" where it cannot be read.
  static std::string link_target(hid_t group, const std::string& name) {
    H5L_info_t info{};
    if (H5Lget_info(group, name.c_str(), &info, H5P_DEFAULT) < 0 || info.u.val_size > longest_path)
      return {};
    std::string target(info.u.val_size, '\0');
    if (H5Lget_val(group, name.c_str(), target.data(), target.size(), H5P_DEFAULT) < 0) return {};
    return target.substr(0, target.find('\0'));
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
    if (depth >= deepest) return skip(path, "nested too deeply");
    group(node.id(), path, depth + 1);
  }

  void data(hid_t id, const std::string& path) {
    const Hdf5Handle type(H5Dget_type(id), H5Tclose);
    const Hdf5Handle space(H5Dget_space(id), H5Sclose);
    const H5S_class_t extent = H5Sget_simple_extent_type(space.id());
    if (extent == H5S_NULL) return skip(path, "empty");
    const int rank = H5Sget_simple_extent_ndims(space.id());
    if (rank < 0 || rank > H5S_MAX_RANK) return skip(path, "damaged");
    std::array<hsize_t, H5S_MAX_RANK> sides{};
    H5Sget_simple_extent_dims(space.id(), sides.data(), nullptr);
    Hdf5Array array;
    array.path = path;
    array.shape.assign(sides.begin(), sides.begin() + rank);
    const H5T_class_t kind = H5Tget_class(type.id());
    const bool records = kind == H5T_COMPOUND && !is_complex(type.id());
    const auto numbers = kind == H5T_COMPOUND ? ArrayNumbers::f64 : numbers_of(type.id());
    const bool one = H5Sget_simple_extent_npoints(space.id()) == 1;
    const bool references = kind == H5T_REFERENCE && H5Tequal(type.id(), H5T_STD_REF_OBJ) > 0;
    if (!numbers && !references && !(kind == H5T_STRING && one)) return skip(path, kind_name(kind));
    array.complex = kind == H5T_COMPOUND && !records;
    array.wide = is_wide(type.id());
    if (numbers) array.numbers = *numbers;
    if (std::ranges::find(array.shape, std::uint64_t{0}) != array.shape.end())
      return skip(path, "empty");
    const std::string problem = storage_problem(id, array.shape, H5Tget_size(type.id()), bytes_);
    if (!problem.empty()) return skip(path, problem);
    if (kind == H5T_STRING) return text(id, type.id(), path);
    if (references) return put_references(id, space.id(), path);
    if (is_listed(id, array)) return;
    array.attributes = attributes_of(id);
    array.reference = reference_to(id);
    array.scales = scales_of(id, array.shape.size());
    const auto matlab = array.attributes.texts.find("MATLAB_class");
    if (matlab != array.attributes.texts.end() && matlab->second == "char")
      array.text = letters(id, array.shape);
    if (records)
      fields(type.id(), array);
    else
      put(array);
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

  void put(const Hdf5Array& array) {
    out_.text("array");
    out_.text(array.path);
    out_.number(array.field_path.size());
    for (const std::string& name : array.field_path) out_.text(name);
    out_.number(array.field_index);
    out_.number(array.fields);
    out_.number(array.shape.size());
    for (const std::uint64_t side : array.shape) out_.number(side);
    out_.number(static_cast<std::uint64_t>(array.numbers));
    out_.number(array.wide ? 1 : 0);
    out_.number(array.complex ? 1 : 0);
    out_.text(array.text);
    out_.number(array.reference);
    out_.number(array.scales.size());
    for (const std::vector<std::uint64_t>& scales : array.scales) {
      out_.number(scales.size());
      for (const std::uint64_t reference : scales) out_.number(reference);
    }
    put(array.attributes);
  }

  /// The numbers among the fields of records.
  void fields(hid_t type, Hdf5Array& array) {
    array.fields = static_cast<std::uint64_t>(std::max(H5Tget_nmembers(type), 0));
    if (count_fields(type, 0) > hdf5_longest_list)
      return skip(array.path,
                  fmt::format("records of over {} fields, or too deep ones", hdf5_longest_list));
    for (unsigned i = 0; i < array.fields; ++i) {
      array.field_index = i;
      field(type, i, array);
    }
  }

  /// Of records and of those within them; more than hdf5_longest_list where they are too deep.
  static std::size_t count_fields(hid_t type, int depth) {
    const int members = H5Tget_nmembers(type);
    std::size_t count = static_cast<std::size_t>(std::max(members, 0));
    if (depth > deepest) return hdf5_longest_list + 1;
    for (unsigned i = 0; i < static_cast<unsigned>(std::max(members, 0)); ++i) {
      if (count > hdf5_longest_list) break;
      const Hdf5Handle member(H5Tget_member_type(type, i), H5Tclose);
      if (H5Tget_class(member.id()) == H5T_COMPOUND) count += count_fields(member.id(), depth + 1);
    }
    return count;
  }

  /// One of them, or those of the records that it is.
  void field(hid_t type, unsigned index, Hdf5Array& array) {
    char* const name = H5Tget_member_name(type, index);
    if (name == nullptr) return skip(array.path, "damaged");
    array.field_path.emplace_back(name);
    H5free_memory(name);
    const Hdf5Handle member(H5Tget_member_type(type, index), H5Tclose);
    const auto numbers = numbers_of(member.id());
    const std::string full = array.path + "." + array.field();
    if (full.size() > longest_path) {
      skip(full.substr(0, 100), "a path of over 1000 bytes");
    } else if (H5Tget_class(member.id()) == H5T_COMPOUND) {
      for (unsigned i = 0; i < static_cast<unsigned>(H5Tget_nmembers(member.id())); ++i)
        field(member.id(), i, array);
    } else if (!numbers) {
      skip(full, kind_name(H5Tget_class(member.id())));
    } else {
      array.numbers = *numbers;
      array.wide = is_wide(member.id());
      put(array);
    }
    array.field_path.pop_back();
  }

  void text(hid_t id, hid_t type, const std::string& path) {
    const auto texts = texts_of(type, 1, [id](hid_t memory, void* to) {
      return H5Dread(id, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, to);
    });
    if (!texts) return skip(path, "text");
    out_.text("text");
    out_.text(path);
    out_.text(texts->front());
  }

  /// MATLAB keeps the fields of several structures so, and cell arrays.
  void put_references(hid_t id, hid_t space, const std::string& path) {
    const hssize_t count = H5Sget_simple_extent_npoints(space);
    if (count < 0 || static_cast<std::uint64_t>(count) > hdf5_most_references)
      return skip(path, fmt::format("more than {} references", hdf5_most_references));
    std::vector<hobj_ref_t> references(static_cast<std::size_t>(count));
    if (H5Dread(id, H5T_STD_REF_OBJ, H5S_ALL, H5S_ALL, H5P_DEFAULT, references.data()) < 0)
      return skip(path, "damaged");
    const Hdf5Attributes attributes = attributes_of(id);
    const auto matlab = attributes.texts.find("MATLAB_class");
    out_.text("references");
    out_.text(path);
    out_.text(matlab == attributes.texts.end() ? std::string() : matlab->second);
    out_.number(reference_to(id));
    out_.number(references.size());
    for (const hobj_ref_t reference : references) out_.number(reference);
  }

  /// MATLAB, h5py and others write a complex number as a pair.
  static bool is_complex(hid_t type) {
    if (H5Tget_nmembers(type) != 2) return false;
    constexpr std::array<std::array<std::string_view, 2>, 2> names = {
        {{"real", "imag"}, {"r", "i"}}};
    for (const auto& pair : names) {
      bool matches = true;
      for (unsigned i = 0; i < 2; ++i) {
        char* const name = H5Tget_member_name(type, i);
        const Hdf5Handle member(H5Tget_member_type(type, i), H5Tclose);
        matches = matches && name != nullptr && name == pair[i] && numbers_of(member.id());
        H5free_memory(name);
      }
      if (matches) return true;
    }
    return false;
  }

  /// Text that MATLAB keeps as numbers, one line of it.
  static std::string letters(hid_t id, const std::vector<std::uint64_t>& shape) {
    std::uint64_t count = 1;
    for (const std::uint64_t side : shape)
      count = std::min<std::uint64_t>(count * std::min<std::uint64_t>(side, 10000), 10000);
    if (count > longest_text) return {};
    std::vector<std::uint16_t> codes(count);
    if (H5Dread(id, H5T_NATIVE_UINT16, H5S_ALL, H5S_ALL, H5P_DEFAULT, codes.data()) < 0) return {};
    std::string utf16 = "\xFF\xFE";
    for (const std::uint16_t code : codes) {
      utf16 += static_cast<char>(code & 0xFF);
      utf16 += static_cast<char>(code >> 8);
    }
    return to_utf8(utf16_to_utf8(utf16));
  }

  static std::string_view kind_name(H5T_class_t kind) {
    switch (kind) {
      case H5T_STRING:
        return "text";
      case H5T_ARRAY:
        return "a list";
      case H5T_REFERENCE:
        return "references";
      case H5T_VLEN:
        return "lists of different length";
      default:
        return "of no standard type of numbers";
    }
  }

  OpenFile open_;
  std::uint64_t bytes_;
  const PipeWriter& out_;
  std::size_t objects_ = 0;
  std::size_t skipped_ = 0;
  std::set<haddr_t> seen_;
  std::map<haddr_t, std::string> data_sets_;  ///< paths, of those that are listed
};

/// One slice on its way out.
class SliceReader {
 public:
  SliceReader(hid_t file, const Hdf5Slice& slice) : slice_(&slice) {
    const Hdf5Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
    H5Pset_chunk_cache(access.id(), 12421, std::size_t{32} << 20, 1.0);
    data_ = Hdf5Handle(H5Dopen2(file, slice.array->path.c_str(), access.id()), H5Dclose);
    if (slice.times != nullptr)
      times_ = Hdf5Handle(H5Dopen2(file, slice.times->array->path.c_str(), access.id()), H5Dclose);
    at_ = slice.first;
    left_ = slice.count;
  }

  bool done() const { return left_ == 0; }

  /// False when HDF5 cannot read it.
  bool send(std::size_t index, const PipeWriter& out) {
    const std::uint64_t count = std::min<std::uint64_t>(hdf5_block_size, left_);
    const Hdf5Array& array = *slice_->array;
    bytes_.resize(count * width_of(array.numbers));
    std::vector<double> imaginary;
    if (array.complex) {
      imaginary.resize(count);
      if (!read(data_.id(), *slice_, part_of_complex(0).id(), count, bytes_.data()) ||
          !read(data_.id(), *slice_, part_of_complex(1).id(), count, imaginary.data()))
        return false;
    } else if (!read_numbers(data_.id(), *slice_, memory_type(array.numbers), count,
                             bytes_.data())) {
      return false;
    }
    std::vector<double> times;
    if (slice_->times != nullptr) {
      times.resize(count);
      if (!read_numbers(times_.id(), *slice_->times, H5T_NATIVE_DOUBLE, count, times.data()))
        return false;
    }
    out.number(index);
    out.number(count);
    out.bytes(bytes_.data(), bytes_.size());
    if (slice_->array->complex) out.bytes(imaginary.data(), count * sizeof(double));
    if (slice_->times != nullptr) out.bytes(times.data(), count * sizeof(double));
    at_ += count;
    left_ -= count;
    return true;
  }

 private:
  /// Records with one of the file's fields, by the names that lead to it.
  static Hdf5Handle field_type(const std::vector<std::string>& names, hid_t number) {
    Hdf5Handle type(H5Tcopy(number), H5Tclose);
    for (std::size_t i = names.size(); i-- > 0;) {
      Hdf5Handle around(H5Tcreate(H5T_COMPOUND, H5Tget_size(number)), H5Tclose);
      H5Tinsert(around.id(), names[i].c_str(), 0, type.id());
      type = std::move(around);
    }
    return type;
  }

  /// The real part of a complex number is its first field.
  Hdf5Handle part_of_complex(unsigned part) const {
    const Hdf5Handle type(H5Dget_type(data_.id()), H5Tclose);
    char* const name = H5Tget_member_name(type.id(), part);
    const std::string field = name == nullptr ? "" : name;
    H5free_memory(name);
    return field_type({field}, H5T_NATIVE_DOUBLE);
  }

  /// Reads numbers, which are what the slice asks for: as they are, or less the first of all.
  bool read_numbers(hid_t data, const Hdf5Slice& slice, hid_t number, std::uint64_t count,
                    void* to) {
    if (!slice.from_first) return read_as(data, slice, number, count, to);
    if (!first_) {
      std::int64_t first = 0;
      const std::uint64_t at = std::exchange(at_, 0);
      const bool there = read_as(data, slice, H5T_NATIVE_INT64, 1, &first);
      at_ = at;
      if (!there) return false;
      first_ = first;
    }
    std::vector<std::int64_t> integers(count);
    if (!read_as(data, slice, H5T_NATIVE_INT64, count, integers.data())) return false;
    std::ranges::transform(integers, static_cast<double*>(to), [this](std::int64_t integer) {
      // modulo 2^64, for the difference of integers of any sign
      return static_cast<double>(static_cast<std::int64_t>(static_cast<std::uint64_t>(integer) -
                                                           static_cast<std::uint64_t>(*first_)));
    });
    return true;
  }

  /// Reads numbers of a data set or of a field.
  bool read_as(hid_t data, const Hdf5Slice& slice, hid_t number, std::uint64_t count,
               void* to) const {
    if (slice.array->field_path.empty()) return read(data, slice, number, count, to);
    return read(data, slice, field_type(slice.array->field_path, number).id(), count, to);
  }

  bool read(hid_t data, const Hdf5Slice& slice, hid_t type, std::uint64_t count, void* to) const {
    const Hdf5Handle space(H5Dget_space(data), H5Sclose);
    const auto& shape = slice.array->shape;
    if (H5Sget_simple_extent_ndims(space.id()) != static_cast<int>(shape.size())) return false;
    const hsize_t size = count;
    const Hdf5Handle memory(H5Screate_simple(1, &size, nullptr), H5Sclose);
    if (shape.empty()) return H5Dread(data, type, memory.id(), H5S_ALL, H5P_DEFAULT, to) >= 0;
    if (slice.whole && shape.size() > 1)
      return read_whole(data, space.id(), shape, type, count, to);
    const std::size_t along = shape.size() == 1 ? 0 : slice.along;
    const std::vector<std::uint64_t> places = places_of(slice);
    std::vector<hsize_t> start(places.begin(), places.end());
    std::vector<hsize_t> block(shape.size(), 1);
    start[along] = at_;
    block[along] = count;
    if (H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start.data(), nullptr, block.data(),
                            nullptr) < 0)
      return false;
    return H5Dread(data, type, memory.id(), space.id(), H5P_DEFAULT, to) >= 0;
  }

  /// Numbers in the file's order from a data set of several dimensions: rows of the fastest
  /// dimension, one after another.
  bool read_whole(hid_t data, hid_t space, const std::vector<std::uint64_t>& shape, hid_t type,
                  std::uint64_t count, void* to) const {
    const std::size_t rank = shape.size();
    const std::size_t width = H5Tget_size(type);
    auto* out = static_cast<char*>(to);
    std::uint64_t at = at_;
    while (count > 0) {
      std::vector<hsize_t> start(rank);
      std::uint64_t rest = at;
      for (std::size_t d = rank; d-- > 0;) {
        start[d] = rest % shape[d];
        rest /= shape[d];
      }
      std::vector<hsize_t> block(rank, 1);
      block[rank - 1] = std::min<std::uint64_t>(count, shape[rank - 1] - start[rank - 1]);
      // whole rows together, where nothing is cut off
      if (start[rank - 1] == 0 && block[rank - 1] == shape[rank - 1])
        block[rank - 2] =
            std::min<std::uint64_t>(count / shape[rank - 1], shape[rank - 2] - start[rank - 2]);
      const hsize_t size = block[rank - 1] * block[rank - 2];
      const Hdf5Handle memory(H5Screate_simple(1, &size, nullptr), H5Sclose);
      if (H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, block.data(), nullptr) <
              0 ||
          H5Dread(data, type, memory.id(), space, H5P_DEFAULT, out) < 0)
        return false;
      out += size * width;
      at += size;
      count -= size;
    }
    return true;
  }

  const Hdf5Slice* slice_;
  Hdf5Handle data_{H5I_INVALID_HID, H5Dclose};
  Hdf5Handle times_{H5I_INVALID_HID, H5Dclose};
  std::uint64_t at_ = 0;
  std::uint64_t left_ = 0;
  std::optional<std::int64_t> first_;  ///< of the integers that are handed over less their first
  std::vector<char> bytes_;
};

}  // namespace

void send_hdf5_listing(const std::string& path, std::uint64_t bytes, const PipeWriter& out) {
  Walk(path, bytes, out).run();
}

void send_hdf5_slices(const std::string& path, const std::vector<Hdf5Slice>& slices,
                      const PipeWriter& out) {
  const OpenFile open(path);
  std::vector<SliceReader> readers;
  for (const Hdf5Slice& slice : slices) readers.emplace_back(open.file.id(), slice);
  // all channels in step: those of one table find its pieces unpacked
  for (bool more = open.file.valid(); more;) {
    more = false;
    for (std::size_t i = 0; i < readers.size(); ++i) {
      if (readers[i].done()) continue;
      if (!readers[i].send(i, out)) {
        out.number(hdf5_end_of_blocks);
        out.number(i);
        return;
      }
      more = more || !readers[i].done();
    }
  }
  out.number(hdf5_end_of_blocks);
  out.number(hdf5_end_of_blocks);
}

}  // namespace impactrig::acquisition
