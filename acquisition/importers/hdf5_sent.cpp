// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/hdf5_sent.hpp"

#include <string>
#include <vector>

namespace impactrig::acquisition {

void send_hdf5_attributes(const Hdf5Attributes& attributes, const PipeWriter& out) {
  out.number(attributes.texts.size());
  for (const auto& [key, text] : attributes.texts) {
    out.text(key);
    out.text(text);
  }
  out.number(attributes.lists.size());
  for (const auto& [key, texts] : attributes.lists) {
    out.text(key);
    out.number(texts.size());
    for (const std::string& text : texts) out.text(text);
  }
  out.number(attributes.numbers.size());
  for (const auto& [key, value] : attributes.numbers) {
    out.text(key);
    out.real(value);
  }
  out.number(attributes.number_lists.size());
  for (const auto& [key, values] : attributes.number_lists) {
    out.text(key);
    out.number(values.size());
    for (const double value : values) out.real(value);
  }
  out.number(attributes.others.size());
  for (const std::string& key : attributes.others) out.text(key);
}

void send_hdf5_array(const Hdf5Array& array, const PipeWriter& out) {
  out.text("array");
  out.text(array.path);
  out.number(array.field_path.size());
  for (const std::string& name : array.field_path) out.text(name);
  out.number(array.field_index);
  out.number(array.fields);
  out.number(array.element);
  out.number(array.elements);
  out.number(array.shape.size());
  for (const std::uint64_t side : array.shape) out.number(side);
  out.number(static_cast<std::uint64_t>(array.numbers));
  out.number(array.wide ? 1 : 0);
  out.number(array.bits ? 1 : 0);
  out.number(array.complex ? 1 : 0);
  out.text(array.text);
  out.number(array.reference);
  out.number(array.scales.size());
  for (const std::vector<std::uint64_t>& scales : array.scales) {
    out.number(scales.size());
    for (const std::uint64_t reference : scales) out.number(reference);
  }
  send_hdf5_attributes(array.attributes, out);
}

}  // namespace impactrig::acquisition
