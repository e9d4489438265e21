// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace impactrig::reports {

using Json = nlohmann::ordered_json;

/// A value inside a JSON document that knows where it stands, so that every complaint names the
/// place: "fit.json: /parameters/2/value: expected a number, found a string".
/// All members throw datasets::InputError; the document must outlive it.
class JsonReader {
 public:
  JsonReader(const Json& value, const std::string& file, std::string path = "")
      : value_(value),
        file_(file),
        path_(std::move(path)) {}

  JsonReader operator[](const std::string& key) const;  ///< member that must be there
  bool has(const std::string& key) const;               ///< there, and not null
  bool states(const std::string& key) const;            ///< there, null or not
  std::size_t size() const;                             ///< of an array
  JsonReader element(std::size_t index) const;          ///< of an array

  double number() const;                  ///< null: not a number
  double number_or(double absent) const;  ///< null: `absent`
  long integer() const;
  std::uint64_t count() const;
  bool boolean() const;
  std::string text() const;
  std::vector<double> numbers() const;
  std::vector<std::string> texts() const;
  std::array<double, 2> pair() const;
  std::map<std::string, std::string> text_map() const;
  std::map<std::string, double> number_map() const;
  std::vector<std::string> keys() const;  ///< of an object

  [[noreturn]] void fail(const std::string& problem) const;

 private:
  [[noreturn]] void expected(const char* what) const;

  const Json& value_;
  const std::string& file_;
  std::string path_;  // JSON pointer, "" for the document
};

}  // namespace impactrig::reports
