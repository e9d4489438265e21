// SPDX-License-Identifier: BSD-3-Clause
#include "reports/json_reader.hpp"

#include <limits>

#include <fmt/format.h>

#include "datasets/input_error.hpp"

namespace impactrig::reports {

namespace {

std::string article(const Json& value) {
  if (value.is_null()) return "null";
  if (value.is_object()) return "an object";
  if (value.is_array()) return "an array";
  if (value.is_string()) return "a string";
  if (value.is_boolean()) return "true or false";
  return fmt::format("the number {}", value.dump());
}

}  // namespace

void JsonReader::fail(const std::string& problem) const {
  throw datasets::InputError({file_, 0, 0, {}},
                             path_.empty() ? problem : fmt::format("{}: {}", path_, problem));
}

void JsonReader::expected(const char* what) const {
  fail(fmt::format("expected {}, found {}", what, article(value_)));
}

JsonReader JsonReader::operator[](const std::string& key) const {
  if (!value_.is_object()) expected("an object");
  const auto member = value_.find(key);
  if (member == value_.end())
    fail(fmt::format("the member \"{}\" is missing; write the file again with impactrig fit --json",
                     key));
  return {*member, file_, path_ + "/" + key};
}

bool JsonReader::has(const std::string& key) const {
  if (!value_.is_object()) expected("an object");
  const auto member = value_.find(key);
  return member != value_.end() && !member->is_null();
}

bool JsonReader::states(const std::string& key) const {
  return value_.contains(key);
}

std::size_t JsonReader::size() const {
  if (!value_.is_array()) expected("an array");
  return value_.size();
}

JsonReader JsonReader::element(std::size_t index) const {
  if (!value_.is_array()) expected("an array");
  return {value_[index], file_, fmt::format("{}/{}", path_, index)};
}

double JsonReader::number() const {
  return number_or(std::numeric_limits<double>::quiet_NaN());
}

double JsonReader::number_or(double absent) const {
  if (value_.is_null()) return absent;
  if (!value_.is_number()) expected("a number");
  return value_.get<double>();
}

long JsonReader::integer() const {
  if (!value_.is_number_integer()) expected("an integer");
  return value_.get<long>();
}

std::uint64_t JsonReader::count() const {
  if (!value_.is_number_integer() || (!value_.is_number_unsigned() && value_.get<long>() < 0))
    expected("a count");
  return value_.get<std::uint64_t>();
}

bool JsonReader::boolean() const {
  if (!value_.is_boolean()) expected("true or false");
  return value_.get<bool>();
}

std::string JsonReader::text() const {
  if (!value_.is_string()) expected("a string");
  return value_.get<std::string>();
}

std::vector<double> JsonReader::numbers() const {
  std::vector<double> out(size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    // The place is only spelt out for a culprit: curves have 1e5 samples.
    if (!value_[i].is_number() && !value_[i].is_null()) element(i).expected("a number");
    out[i] =
        value_[i].is_null() ? std::numeric_limits<double>::quiet_NaN() : value_[i].get<double>();
  }
  return out;
}

std::vector<std::string> JsonReader::texts() const {
  std::vector<std::string> out(size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = element(i).text();
  return out;
}

std::array<double, 2> JsonReader::pair() const {
  if (!value_.is_array() || value_.size() != 2) expected("an array of two numbers");
  return {element(0).number(), element(1).number()};
}

std::map<std::string, std::string> JsonReader::text_map() const {
  std::map<std::string, std::string> out;
  for (const std::string& key : keys()) out[key] = (*this)[key].text();
  return out;
}

std::map<std::string, double> JsonReader::number_map() const {
  std::map<std::string, double> out;
  for (const std::string& key : keys()) out[key] = (*this)[key].number();
  return out;
}

std::vector<std::string> JsonReader::keys() const {
  if (!value_.is_object()) expected("an object");
  std::vector<std::string> out;
  for (const auto& [key, unused] : value_.items()) out.push_back(key);
  return out;
}

}  // namespace impactrig::reports
