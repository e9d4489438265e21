// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/hdf5_handle.hpp"

namespace impactrig::datasets {

/// A group or data set and its path within the file, for messages.
struct Node {
  Hdf5Handle handle;
  std::string path;

  hid_t id() const { return handle.id(); }
};

/// Reads the objects of one file. Nothing the file declares is believed: every size is held against
/// the file's own before memory is taken for it, and every type and shape is checked. Whatever is
/// wrong is an InputError that names the object.
class Hdf5Reader {
 public:
  Hdf5Reader(std::string file, std::uint64_t bytes);  ///< bytes: size of the file

  [[noreturn]] void refuse(std::string_view problem) const;
  [[noreturn]] void damaged(std::string_view path, std::string_view problem) const;

  bool has(const Node& parent, const std::string& name) const;
  Node group(const Node& parent, const std::string& name) const;
  Node data(const Node& parent, const std::string& name) const;
  std::vector<std::string> names(const Node& group) const;  ///< of all in it, alphabetical

  /// An attribute; none where it is missing or no text of fixed length, as all of ours are.
  std::optional<std::string> text(const Node& owner, const char* name) const;

  template <typename Number>
  Number number(const Node& owner, const char* name) const;  ///< an attribute

  std::string scalar_text(const Node& parent, const char* name) const;  ///< a data set

  template <typename Number>
  Number scalar(const Node& parent, const char* name) const;  ///< a data set

  template <typename Number>
  std::vector<Number> numbers(const Node& data) const;

  /// Some that follow each other, into a vector that may be used again.
  template <typename Number>
  void numbers(const Node& data, std::uint64_t first, std::size_t count,
               std::vector<Number>& to) const;

  /// How many numbers a list has, once they are known to be in this file.
  std::size_t length(const Node& data) const;

  std::vector<std::string> optional_texts(const Node& parent, const char* name) const;
  std::map<std::string, std::string> optional_pairs(const Node& parent, const char* name) const;

 private:
  Node child(const Node& parent, const std::string& name, H5I_type_t kind,
             std::string_view kind_name) const;
  Hdf5Handle open_attribute(const Node& owner, const char* name) const;

  /// How many elements a data set of that rank has (0: a scalar, 1: a list, 2: a table of two
  /// columns), once they are known to be in this file.
  std::size_t count(const Node& data, int rank) const;

  void read_number(const Node& owner, const char* name, hid_t memory_type, void* to) const;
  void read_numbers(const Node& data, hid_t memory_type, void* to) const;
  void read_numbers(const Node& data, hid_t memory_type, std::uint64_t first, std::size_t count,
                    void* to) const;
  std::vector<std::string> text_data(const Node& data, int rank) const;  ///< row by row

  std::string file_;
  std::uint64_t bytes_;
};

template <typename Number>
Number Hdf5Reader::number(const Node& owner, const char* name) const {
  Number value{};
  read_number(owner, name, hdf5_memory_type(value), &value);
  return value;
}

template <typename Number>
Number Hdf5Reader::scalar(const Node& parent, const char* name) const {
  const Node node = data(parent, name);
  Number value{};
  if (count(node, 0) == 1) read_numbers(node, hdf5_memory_type(value), &value);
  return value;
}

template <typename Number>
std::vector<Number> Hdf5Reader::numbers(const Node& data) const {
  std::vector<Number> values(count(data, 1));
  read_numbers(data, hdf5_memory_type(Number{}), values.data());
  return values;
}

template <typename Number>
void Hdf5Reader::numbers(const Node& data, std::uint64_t first, std::size_t count,
                         std::vector<Number>& to) const {
  to.resize(count);
  if (count > 0) read_numbers(data, hdf5_memory_type(Number{}), first, count, to.data());
}

}  // namespace impactrig::datasets
