// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <hdf5.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace impactrig::acquisition::tests {

/// Writes an HDF5 file in memory, with the library, as other programs do.
class Hdf5File {
 public:
  explicit Hdf5File(hsize_t user_block = 0) {
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_fapl_core(access, 65536, false);
    const hid_t creation = H5Pcreate(H5P_FILE_CREATE);
    if (user_block > 0) H5Pset_userblock(creation, user_block);
    file_ = H5Fcreate("in memory", H5F_ACC_TRUNC, creation, access);
    H5Pclose(access);
    H5Pclose(creation);
  }

  ~Hdf5File() { H5Fclose(file_); }

  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;

  hid_t id() const { return file_; }

  void group(const std::string& path) const {
    H5Gclose(H5Gcreate2(file_, path.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  }

  /// `stored`: type in the file; `chunk`: empty for a plain data set, else compressed pieces.
  template <typename Number>
  void data(const std::string& path, const std::vector<hsize_t>& shape,
            const std::vector<Number>& values, hid_t memory, hid_t stored,
            const std::vector<hsize_t>& chunk = {}) const {
    const hid_t space =
        shape.empty() ? H5Screate(H5S_SCALAR)
                      : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
    const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
    if (!chunk.empty()) {
      H5Pset_chunk(creation, static_cast<int>(chunk.size()), chunk.data());
      H5Pset_shuffle(creation);
      H5Pset_deflate(creation, 6);
    }
    const hid_t set =
        H5Dcreate2(file_, path.c_str(), stored, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    H5Dwrite(set, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Dclose(set);
    H5Pclose(creation);
    H5Sclose(space);
  }

  void doubles(const std::string& path, const std::vector<double>& values) const {
    data<double>(path, {values.size()}, values, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
  }

  void text(const std::string& path, const std::string& name, const std::string& value,
            bool variable = false) const {
    const hid_t object = H5Oopen(file_, path.c_str(), H5P_DEFAULT);
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, variable ? H5T_VARIABLE : value.size());
    const hid_t space = H5Screate(H5S_SCALAR);
    const hid_t attribute = H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT);
    const char* const letters = value.c_str();
    H5Awrite(attribute, type, variable ? static_cast<const void*>(&letters) : letters);
    H5Aclose(attribute);
    H5Sclose(space);
    H5Tclose(type);
    H5Oclose(object);
  }

  void texts(const std::string& path, const std::string& name,
             const std::vector<const char*>& values) const {
    const hid_t object = H5Oopen(file_, path.c_str(), H5P_DEFAULT);
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, H5T_VARIABLE);
    const hsize_t size = values.size();
    const hid_t space = H5Screate_simple(1, &size, nullptr);
    const hid_t attribute = H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, type, values.data());
    H5Aclose(attribute);
    H5Sclose(space);
    H5Tclose(type);
    H5Oclose(object);
  }

  /// A data set that is one text.
  void text_data(const std::string& path, const std::string& value) const {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, value.size());
    data<char>(path, {}, {value.begin(), value.end()}, type, type);
    H5Tclose(type);
  }

  /// A data set of several texts, each of the same number of bytes.
  void text_list(const std::string& path, const std::vector<std::string>& values) const {
    std::size_t width = 1;
    for (const std::string& value : values) width = std::max(width, value.size());
    std::vector<char> letters;
    for (std::string value : values) {
      value.resize(width);
      letters.insert(letters.end(), value.begin(), value.end());
    }
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, width);
    data<char>(path, {values.size()}, letters, type, type);
    H5Tclose(type);
  }

  /// Records of an index and lists of two numbers and of one, as pandas' tables are.
  void records_of_lists(const std::string& path, std::size_t count) const {
    struct Row {
      double index;
      double block_0[2];
      float block_1[1];
    };

    const hsize_t two = 2, one = 1;
    const hid_t pair = H5Tarray_create2(H5T_NATIVE_DOUBLE, 1, &two);
    const hid_t single = H5Tarray_create2(H5T_NATIVE_FLOAT, 1, &one);
    const hid_t type = H5Tcreate(H5T_COMPOUND, sizeof(Row));
    H5Tinsert(type, "index", HOFFSET(Row, index), H5T_NATIVE_DOUBLE);
    H5Tinsert(type, "values_block_0", HOFFSET(Row, block_0), pair);
    H5Tinsert(type, "values_block_1", HOFFSET(Row, block_1), single);
    std::vector<Row> rows;
    for (std::size_t i = 0; i < count; ++i) {
      const auto k = static_cast<double>(i);
      rows.push_back({0.25 * k, {k * k, -k}, {static_cast<float>(i) + 0.5F}});
    }
    data<Row>(path, {count}, rows, type, type, {std::min<hsize_t>(count, 16)});
    H5Tclose(type);
    H5Tclose(single);
    H5Tclose(pair);
  }

  /// Records of a time in single precision, a force and a name.
  void records(const std::string& path, std::size_t count, hsize_t chunk) const {
    struct Row {
      float time;
      double force;
      std::int64_t ticks;
      char name[4];
    };

    const hid_t name = H5Tcopy(H5T_C_S1);
    H5Tset_size(name, sizeof(Row::name));
    const hid_t type = H5Tcreate(H5T_COMPOUND, sizeof(Row));
    H5Tinsert(type, "name", HOFFSET(Row, name), name);
    H5Tinsert(type, "time", HOFFSET(Row, time), H5T_NATIVE_FLOAT);
    H5Tinsert(type, "force", HOFFSET(Row, force), H5T_NATIVE_DOUBLE);
    H5Tinsert(type, "ticks", HOFFSET(Row, ticks), H5T_NATIVE_INT64);
    std::vector<Row> rows;
    for (std::size_t i = 0; i < count; ++i)
      rows.push_back({0.25F * static_cast<float>(i), static_cast<double>(i * i),
                      (std::int64_t{1} << 60) + static_cast<std::int64_t>(i), "ab"});
    data<Row>(path, {count}, rows, type, type, {chunk});
    H5Tclose(type);
    H5Tclose(name);
  }

  void number(const std::string& path, const std::string& name, double value) const {
    const hid_t object = H5Oopen(file_, path.c_str(), H5P_DEFAULT);
    const hid_t space = H5Screate(H5S_SCALAR);
    const hid_t attribute =
        H5Acreate2(object, name.c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value);
    H5Aclose(attribute);
    H5Sclose(space);
    H5Oclose(object);
  }

  /// One number a column.
  void numbers(const std::string& path, const std::string& name,
               const std::vector<double>& values) const {
    const hid_t object = H5Oopen(file_, path.c_str(), H5P_DEFAULT);
    const hsize_t size = values.size();
    const hid_t space = H5Screate_simple(1, &size, nullptr);
    const hid_t attribute =
        H5Acreate2(object, name.c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, H5T_NATIVE_DOUBLE, values.data());
    H5Aclose(attribute);
    H5Sclose(space);
    H5Oclose(object);
  }

  /// A data set of references to objects; a name that is not there gives one that leads nowhere.
  void references(const std::string& path, const std::vector<hsize_t>& shape,
                  const std::vector<std::string>& names) const {
    std::vector<hobj_ref_t> references(names.size());
    for (std::size_t i = 0; i < names.size(); ++i)
      if (!names[i].empty())
        H5Rcreate(&references[i], file_, names[i].c_str(), H5R_OBJECT, H5I_INVALID_HID);
    data<hobj_ref_t>(path, shape, references, H5T_STD_REF_OBJ, H5T_STD_REF_OBJ);
  }

  /// A data set that is to be the scale of a dimension.
  void scale(const std::string& path) const { text(path, "CLASS", "DIMENSION_SCALE"); }

  /// The scales of each dimension, as the library's "dimension scales" keep them; "" = none.
  void scales(const std::string& path, const std::vector<std::string>& names) const {
    std::vector<hobj_ref_t> references(names.size());
    std::vector<hvl_t> lists(names.size());
    for (std::size_t d = 0; d < names.size(); ++d) {
      if (!names[d].empty())
        H5Rcreate(&references[d], file_, names[d].c_str(), H5R_OBJECT, H5I_INVALID_HID);
      lists[d] = {names[d].empty() ? 0U : 1U, &references[d]};
    }
    const hid_t object = H5Oopen(file_, path.c_str(), H5P_DEFAULT);
    const hid_t type = H5Tvlen_create(H5T_STD_REF_OBJ);
    const hsize_t size = names.size();
    const hid_t space = H5Screate_simple(1, &size, nullptr);
    const hid_t attribute =
        H5Acreate2(object, "DIMENSION_LIST", type, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, type, lists.data());
    H5Aclose(attribute);
    H5Sclose(space);
    H5Tclose(type);
    H5Oclose(object);
  }

  /// A structure of MATLAB, or what its fields refer to.
  void structure(const std::string& path) const {
    group(path);
    text(path, "MATLAB_class", "struct");
  }

  /// Numbers as MATLAB keeps them.
  void matlab(const std::string& path, const std::vector<double>& values) const {
    data<double>(path, {1, values.size()}, values, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
    text(path, "MATLAB_class", "double");
  }

  std::string bytes() const {
    H5Fflush(file_, H5F_SCOPE_LOCAL);
    const ssize_t size = H5Fget_file_image(file_, nullptr, 0);
    std::string image(static_cast<std::size_t>(size), '\0');
    H5Fget_file_image(file_, image.data(), image.size());
    return image;
  }

 private:
  hid_t file_;
};

/// MATLAB's own block before the HDF5 file.
inline std::string mat73_bytes(const Hdf5File& file) {
  std::string bytes = file.bytes();
  if (bytes.starts_with("\x89HDF")) bytes.insert(0, 512, '\0');  // HDF5 leaves the block away
  std::string text = "MATLAB 7.3 MAT-file, written by a test";
  text.resize(116, ' ');
  text += std::string(8, '\0') + std::string("\x00\x02IM", 4);
  return bytes.replace(0, text.size(), text);
}

/// Two structures `run` of a force, a time and a structure, as MATLAB saves them.
inline std::string mat73_structures() {
  const Hdf5File file(512);
  file.group("/#refs#");
  file.matlab("/#refs#/a", {1, 2, 3});
  file.matlab("/#refs#/b", {4, 5, 6});
  file.matlab("/#refs#/c", {0, 0.5, 1});
  file.matlab("/#refs#/d", {0, 0.25, 0.5});
  for (const char* const inner : {"/#refs#/e", "/#refs#/f"}) {
    file.structure(inner);
    file.matlab(std::string(inner) + "/gain", {7});
    file.structure(std::string(inner) + "/deep");
    file.matlab(std::string(inner) + "/deep/x", {8, 9, 10});
  }
  file.structure("/run");
  file.references("/run/force", {2, 1}, {"/#refs#/a", "/#refs#/b"});
  file.references("/run/t", {2, 1}, {"/#refs#/c", "/#refs#/d"});
  file.references("/run/set", {2, 1}, {"/#refs#/e", "/#refs#/f"});
  return mat73_bytes(file);
}

inline std::vector<std::string> hdf5_seeds() {
  std::vector<std::string> seeds;
  {
    const Hdf5File file;
    file.group("/shot");
    file.text("/shot", "pandas_type", "frame_table");
    file.records_of_lists("/shot/table", 3);
    file.text("/shot/table", "values_block_0_kind", "(lp0\nVa\np1\naVb\np2\na.");
    seeds.push_back(file.bytes());
  }
  {
    const Hdf5File file;
    file.group("/run");
    file.text("/run", "pandas_type", "frame");
    file.text_list("/run/block0_items", {"a", "b"});
    file.data<double>("/run/block0_values", {3, 2}, {1, 2, 3, 4, 5, 6}, H5T_NATIVE_DOUBLE,
                      H5T_IEEE_F64LE);
    file.doubles("/run/axis1", {0.0, 0.5, 1.0});
    file.text("/run/axis1", "kind", "float");
    seeds.push_back(file.bytes());
  }
  {
    const Hdf5File file;
    file.group("/entry");
    file.data<float>("/entry/force", {3}, {1, 2, 3}, H5T_NATIVE_FLOAT, H5T_IEEE_F32BE);
    file.text("/entry/force", "units", "N");
    file.number("/entry/force", "dt", 0.001);
    file.data<std::int16_t>("/table", {8, 2},
                            {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16},
                            H5T_NATIVE_INT16, H5T_STD_I16LE, {4, 2});
    seeds.push_back(file.bytes());
  }
  {
    const Hdf5File file;
    file.group("/entry");
    file.text("/entry", "axes", "clock", true);
    file.doubles("/entry/clock", {0, 1, 3});
    file.text("/entry/clock", "units", "ms", true);
    file.doubles("/entry/force", {1, 2, 3});
    seeds.push_back(file.bytes());
  }
  {
    const Hdf5File file;
    file.records("/rows", 8, 4);
    file.texts("/rows", "units", {"", "s", "N", ""});
    file.doubles("/force", {1, 2, 3});
    file.number("/force", "scale_factor", 0.5);
    file.number("/force", "_FillValue", 2.0);
    file.text("/force", "fs", "1 kHz");
    file.text_data("/title", "a shot");
    seeds.push_back(file.bytes());
  }
  {
    const Hdf5File file(512);
    file.group("/run");
    file.doubles("/run/time", {0, 1, 2});
    file.text("/run/time", "MATLAB_class", "double");
    seeds.push_back(mat73_bytes(file));
  }
  {
    const Hdf5File file;
    file.doubles("/ticks", {0, 1, 2});
    file.text("/ticks", "units", "ms");
    file.scale("/ticks");
    file.data<double>("/rows", {3, 2}, {1, 2, 3, 4, 5, 6}, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
    file.numbers("/rows", "scale_factor", {0.5, 2.0});
    file.scales("/rows", {"/ticks", ""});
    file.data<std::int64_t>(
        "/time", {3},
        {std::int64_t{1} << 60, (std::int64_t{1} << 60) + 1, (std::int64_t{1} << 60) + 3},
        H5T_NATIVE_INT64, H5T_STD_I64LE);
    file.doubles("/velocity", {1, 2, 3});
    seeds.push_back(file.bytes());
  }
  return seeds;
}

}  // namespace impactrig::acquisition::tests
