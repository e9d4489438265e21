// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/mdf4_conversion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/importers/byte_cursor.hpp"
#include "acquisition/importers/formula.hpp"

namespace impactrig::acquisition {

namespace {

std::shared_ptr<const std::vector<double>> shared(std::vector<double> numbers) {
  return std::make_shared<const std::vector<double>>(std::move(numbers));
}

/// Triples of lowest key, highest key and value, then the value of all else. Of floating-point keys
/// the highest is no more part of its range.
double value_of_range(const std::vector<double>& p, bool floating, double key) {
  for (std::size_t i = 0; i + 2 < p.size(); i += 3)
    if (key >= p[i] && (floating ? key < p[i + 1] : key <= p[i + 1])) return p[i + 2];
  return p.back();
}

/// Pairs of key and value; between keys a straight line, or the value of the nearest key.
void set_table(std::vector<double> p, bool interpolated, MdfConversion& conversion) {
  std::vector<double> x;
  std::vector<double> y;
  for (std::size_t i = 0; i < p.size(); i += 2) {
    if (!std::isfinite(p[i]) || (!x.empty() && !(p[i] > x.back()))) {
      conversion.problem = "its conversion is a table whose keys do not increase";
      return;
    }
    x.push_back(p[i]);
    y.push_back(p[i + 1]);
  }
  conversion.function = [k = shared(std::move(x)), w = shared(std::move(y)),
                         interpolated](std::span<double> all) {
    const std::vector<double>& keys = *k;
    const std::vector<double>& values = *w;
    for (double& v : all) {
      if (std::isnan(v)) continue;
      const auto above = std::ranges::upper_bound(keys, v);
      const auto i = static_cast<std::size_t>(above - keys.begin());
      if (i == 0)
        v = values.front();
      else if (i == keys.size())
        v = values.back();
      else if (interpolated)
        v = values[i - 1] +
            (values[i] - values[i - 1]) * (v - keys[i - 1]) / (keys[i] - keys[i - 1]);
      else
        v = v - keys[i - 1] > keys[i] - v ? values[i] : values[i - 1];
    }
  };
}

void set_formula(const std::string& text, MdfConversion& conversion) {
  if (text.empty()) {
    conversion.problem = "its conversion is a formula and states none";
    return;
  }
  Formula formula = read_formula(text);
  if (!formula.problem.empty())
    conversion.problem = "its conversion " + formula.problem;
  else
    conversion.function = [f = std::move(formula.function)](std::span<double> x) {
      for (double& v : x) v = f(v);
    };
}

void set_conversion(std::uint8_t type, std::vector<double> p, const std::string& formula,
                    bool floating, const MdfBlocks& blocks, std::uint64_t at,
                    MdfConversion& conversion) {
  const auto needs = [&](bool enough) {
    if (!enough)
      blocks.fail(at, fmt::format("a conversion of type {} states {} parameters", type, p.size()));
  };
  switch (type) {
    case 0:
      return;
    case 1:  // p0 + p1 x
      needs(p.size() >= 2);
      conversion.offset = p[0];
      conversion.scale = p[1];
      return;
    case 2:
      needs(p.size() >= 6);
      if (p[0] == 0.0 && p[3] == 0.0 && p[4] == 0.0) {  // a straight line
        conversion.scale = p[1] / p[5];
        conversion.offset = p[2] / p[5];
        return;
      }
      p.resize(6);
      conversion.function = [p = shared(std::move(p))](std::span<double> x) {
        const double* const c = p->data();
        for (double& v : x) v = ((c[0] * v + c[1]) * v + c[2]) / ((c[3] * v + c[4]) * v + c[5]);
      };
      return;
    case 3:
      return set_formula(formula, conversion);
    case 4:
    case 5:
      needs(p.size() >= 2 && p.size() % 2 == 0);
      return set_table(std::move(p), type == 4, conversion);
    case 6:
      needs(p.size() % 3 == 1);
      conversion.function = [p = shared(std::move(p)), floating](std::span<double> x) {
        for (double& v : x) v = value_of_range(*p, floating, v);
      };
      return;
    case 7:
    case 8:
      conversion.problem = "its conversion gives texts";
      return;
    default:
      conversion.problem = fmt::format("its conversion is of the type {}", type);
  }
}

}  // namespace

MdfConversion read_mdf_conversion(MdfBlocks& blocks, std::uint64_t at, bool floating) {
  MdfConversion conversion;
  const MdfBlock block = blocks.block_at(at, "a conversion", 5);
  if (block.id != "CC")
    blocks.fail(at, fmt::format("expected a conversion (CC), found a block {}", block.id));
  conversion.unit = blocks.text_at(block.link(1));
  ByteCursor in(blocks.file(), false, block.data);
  const auto type = in.read<std::uint8_t>("a conversion");
  in.skip(5);
  const auto count = in.read<std::uint16_t>("a conversion");
  in.skip(16);
  std::vector<double> values;
  for (std::uint16_t i = 0; i < count; ++i) values.push_back(in.read<double>("a conversion"));
  const std::string formula = type == 3 ? blocks.text_at(block.link(4)) : std::string();
  set_conversion(type, std::move(values), formula, floating, blocks, at, conversion);
  if (!std::isfinite(conversion.scale) || !std::isfinite(conversion.offset)) {
    conversion.scale = 1.0;
    conversion.offset = 0.0;
    conversion.problem = "its conversion is not finite";
  }
  return conversion;
}

}  // namespace impactrig::acquisition
