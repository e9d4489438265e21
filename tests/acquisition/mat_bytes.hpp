// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace impactrig::acquisition::tests {

/// Parts of a MAT-file of version 5, in one byte order.
struct MatBytes {
  bool big_endian = false;

  template <typename Number>
  std::string number(Number value) const {
    std::string bytes(sizeof(Number), '\0');
    std::memcpy(bytes.data(), &value, sizeof(Number));
    if (big_endian != (std::endian::native == std::endian::big)) std::ranges::reverse(bytes);
    return bytes;
  }

  template <typename Number>
  std::string numbers(const std::vector<Number>& values) const {
    std::string bytes;
    for (const Number value : values) bytes += number(value);
    return bytes;
  }

  std::string header() const {
    std::string text = "MATLAB 5.0 MAT-file, written by a test";
    text.resize(116, ' ');
    return text + std::string(8, '\0') + number<std::uint16_t>(0x0100) + (big_endian ? "MI" : "IM");
  }

  /// A data element: type, size, data and padding.
  std::string element(std::uint32_t type, const std::string& data) const {
    std::string bytes = number(type) + number(static_cast<std::uint32_t>(data.size())) + data;
    bytes.resize((bytes.size() + 7) / 8 * 8, '\0');
    return bytes;
  }

  /// An element of up to 4 bytes within its tag.
  std::string small(std::uint32_t type, const std::string& data) const {
    std::string bytes = number(static_cast<std::uint32_t>(data.size() << 16 | type)) + data;
    bytes.resize(8, '\0');
    return bytes;
  }

  std::string head(std::uint32_t class_and_flags, const std::vector<std::int32_t>& shape,
                   const std::string& name) const {
    return element(6, number(class_and_flags) + number<std::uint32_t>(0)) +
           element(5, numbers(shape)) +
           (name.size() <= 4 && !name.empty() ? small(1, name) : element(1, name));
  }

  /// An array: head() and the elements of its class.
  std::string matrix(const std::string& content) const { return element(14, content); }

  std::string doubles(const std::string& name, const std::vector<double>& values,
                      std::int32_t columns = 1) const {
    const auto rows = static_cast<std::int32_t>(values.size()) / columns;
    return matrix(head(6, {rows, columns}, name) + element(9, numbers(values)));
  }

  std::string text(const std::string& name, const std::string& value) const {
    std::vector<std::uint16_t> letters(value.begin(), value.end());
    return matrix(head(4, {1, static_cast<std::int32_t>(value.size())}, name) +
                  element(4, numbers(letters)));
  }

  std::string structure(const std::string& name, const std::vector<std::string>& fields,
                        const std::string& matrices, std::int32_t count = 1) const {
    std::string names;
    for (std::string field : fields) {
      field.resize(32, '\0');
      names += field;
    }
    return matrix(head(2, {1, count}, name) + small(5, number<std::int32_t>(32)) +
                  element(1, names) + matrices);
  }

  /// An object of one of MATLAB's newer classes: names, and what its data are found by.
  std::string object(const std::string& name, const std::string& type) const {
    return matrix(element(6, number<std::uint32_t>(17) + number<std::uint32_t>(0)) +
                  element(1, name) + small(1, "MCOS") + element(1, type) +
                  matrix(head(13, {6, 1}, "") +
                         element(6, numbers<std::uint32_t>({3707764736, 2, 1, 1, 1, 1}))));
  }

  std::string compressed(const std::string& bytes) const {
    uLongf size = compressBound(bytes.size());
    std::string packed(size, '\0');
    compress(reinterpret_cast<Bytef*>(packed.data()), &size,
             reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    packed.resize(size);
    return number<std::uint32_t>(15) + number(static_cast<std::uint32_t>(size)) + packed;
  }

  /// Version 4: one array. kind: 10 x precision + 0 full, 1 text, 2 sparse.
  std::string matrix_4(std::int32_t kind, std::int32_t rows, std::int32_t columns,
                       const std::string& name, const std::string& data,
                       std::int32_t imaginary = 0) const {
    return number<std::int32_t>(kind + (big_endian ? 1000 : 0)) + number(rows) + number(columns) +
           number(imaginary) + number(static_cast<std::int32_t>(name.size()) + 1) + name + '\0' +
           data;
  }
};

inline std::vector<std::string> mat_seeds() {
  std::vector<std::string> seeds;
  for (const bool big : {false, true}) {
    const MatBytes b{big};
    const std::string fields =
        b.doubles("", {1, 2}) +
        b.matrix(b.head(0x0806, {1, 2}, "") + b.element(9, b.numbers<double>({1, 2})) +
                 b.element(3, b.numbers<std::int16_t>({3, 4}))) +
        b.text("", "N");
    const std::string arrays =
        b.doubles("time", {0, 0.5, 1}) + b.doubles("force", {1, 2, 3}) + b.doubles("Fs", {2}) +
        b.matrix(b.head(0x0206, {2, 2}, "small") + b.small(2, std::string("\1\0\1\1", 4))) +
        b.structure("run", {"a", "b", "unit"}, fields) +
        b.matrix(b.head(1, {1, 1}, "cell") + b.doubles("", {5})) + b.object("when", "datetime");
    seeds.push_back(b.header() + arrays);
    seeds.push_back(b.header() + b.compressed(b.doubles("t", {0, 1, 3})) +
                    b.compressed(b.doubles("force", {1, 2, 3})) + b.text("note", "hit"));
    seeds.push_back(b.header() + b.doubles("time_ms", {0, 1, 3}) + b.doubles("t", {0, 1, 2}) +
                    b.doubles("force [N]", {1, 2, 3}) + b.doubles("dt [us]", {2}));
    seeds.push_back(b.header() +
                    b.compressed(b.structure("run", {"a", "b", "unit"}, fields + fields, 2)));
    seeds.push_back(
        b.header() +
        b.structure("S", {"x_values", "y_values"},
                    b.structure("", {"start_value", "increment", "quantity"},
                                b.doubles("", {1}) + b.doubles("", {0.5}) +
                                    b.structure("", {"label"}, b.text("", "s"))) +
                        b.structure("", {"values"}, b.doubles("", {1, 2}))) +
        b.structure("File_Header", {"SampleFrequency"}, b.text("", "2048,0")) +
        b.structure("Channel_1_Header", {"SignalName", "Unit"}, b.text("", "F") + b.text("", "N")) +
        b.doubles("Channel_1_Data", {1, 2, 3}));
    seeds.push_back(
        b.header() +
        b.structure("recording", {"format", "title", "attributes"},
                    b.text("", "impactrig-recording") + b.text("", "shot") +
                        b.structure("", {"name", "value"},
                                    b.text("", "a") + b.text("", "b") + b.text("", "c"), 2)) +
        b.structure("F", {"name", "unit", "start", "interval", "time", "value", "invalid", "delay"},
                    b.text("", "F") + b.text("", "N") + b.doubles("", {1}) + b.doubles("", {2}) +
                        b.doubles("", {1, 3, 4}) + b.doubles("", {5, 6, 7}) +
                        b.matrix(b.head(0x0209, {3, 1}, "") + b.small(2, {0, 1, 0})) +
                        b.structure("", {"value"}, b.doubles("", {1}))));
    seeds.push_back(b.matrix_4(0, 3, 1, "t", b.numbers<double>({0, 1, 2})) +
                    b.matrix_4(30, 3, 1, "force", b.numbers<std::int16_t>({1, 2, 3})) +
                    b.matrix_4(51, 1, 2, "unit", "Nm") +
                    b.matrix_4(10, 1, 2, "z", b.numbers<float>({1, 2, 3, 4}), 1));
  }
  return seeds;
}

}  // namespace impactrig::acquisition::tests
