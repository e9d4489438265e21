// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/mdf4_conversion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "acquisition/importers/byte_cursor.hpp"
#include "acquisition/importers/formula.hpp"

namespace impactrig::acquisition {

namespace {

constexpr std::string_view gives_texts = "its conversion gives texts";

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
      conversion.problem = std::string(gives_texts);
      return;
    default:
      conversion.problem = fmt::format("its conversion is of the type {}", type);
  }
}

double value_of(const MdfConversion& conversion, double x) {
  if (!conversion.function) return conversion.scale * x + conversion.offset;
  conversion.function(std::span(&x, 1));
  return x;
}

/// A table that gives texts for some numbers, and for the others what further conversions give: a
/// text is no number.
class TextOrScale {
 public:
  static constexpr std::size_t text = ~std::size_t{0};

  /// Numbers from `low` to `high`, of floating-point ones without `high` where it is above `low`.
  struct Case {
    double low;
    double high;
    std::size_t conversion;
  };

  TextOrScale(std::vector<Case> cases, std::size_t otherwise, bool floating,
              std::vector<MdfConversion> conversions)
      : cases_(std::move(cases)),
        otherwise_(otherwise),
        floating_(floating),
        conversions_(std::move(conversions)) {}

  double operator()(double x) const {
    const auto holds = [&](const Case& one) {
      return x == one.low || (x > one.low && (floating_ ? x < one.high : x <= one.high));
    };
    const auto found = std::ranges::find_if(cases_, holds);
    const std::size_t which = found == cases_.end() ? otherwise_ : found->conversion;
    return which == text ? std::nan("") : value_of(conversions_[which], x);
  }

 private:
  std::vector<Case> cases_;
  std::size_t otherwise_;
  bool floating_;
  std::vector<MdfConversion> conversions_;
};

/// A conversion (CC) with its numbers; that of a table of texts (7, 8) is not made yet.
struct Parsed {
  MdfBlock block;
  std::uint8_t type = 0;
  std::vector<double> values{};
  MdfConversion conversion{};
};

Parsed parsed_conversion(MdfBlocks& blocks, std::uint64_t at, bool floating) {
  constexpr std::uint64_t most_links = 5 + 65535;
  Parsed parsed{.block = blocks.block_at(at, "a conversion", most_links)};
  const MdfBlock& block = parsed.block;
  MdfConversion& conversion = parsed.conversion;
  if (block.id != "CC")
    blocks.fail(at, fmt::format("expected a conversion (CC), found a block {}", block.id));
  conversion.unit = blocks.text_at(block.link(1));
  ByteCursor in(blocks.file(), false, block.data);
  const auto type = parsed.type = in.read<std::uint8_t>("a conversion");
  in.skip(5);
  const auto count = in.read<std::uint16_t>("a conversion");
  in.skip(16);
  std::vector<double>& values = parsed.values;
  for (std::uint16_t i = 0; i < count; ++i) values.push_back(in.read<double>("a conversion"));
  const std::string formula = type == 3 ? blocks.text_at(block.link(4)) : std::string();
  set_conversion(type, values, formula, floating, blocks, at, conversion);
  if (!std::isfinite(conversion.scale) || !std::isfinite(conversion.offset)) {
    conversion.scale = 1.0;
    conversion.offset = 0.0;
    conversion.problem = "its conversion is not finite";
  }
  return parsed;
}

/// Takes the conversions that a table of texts refers to (text/scale, types 7 and 8), where there
/// are any that give numbers.
void set_text_or_scale(MdfBlocks& blocks, const Parsed& table, bool floating,
                       MdfConversion& conversion) {
  constexpr std::size_t most_conversions = 16;
  const std::size_t keys_a_case = table.type == 8 ? 2 : 1;
  const std::vector<double>& keys = table.values;
  std::vector<MdfConversion> conversions;
  bool too_many = false;
  const auto refers_to = [&](std::size_t reference) {
    const std::uint64_t at = table.block.link(4 + reference);
    if (at == 0 || blocks.block_at(at, "a text or a conversion", 0).id != "CC")
      return TextOrScale::text;
    too_many = conversions.size() == most_conversions;
    if (too_many) return TextOrScale::text;
    conversions.push_back(parsed_conversion(blocks, at, floating).conversion);
    return conversions.size() - 1;
  };
  std::vector<TextOrScale::Case> cases;
  for (std::size_t i = 0; (i + 1) * keys_a_case <= keys.size() && !too_many; ++i)
    cases.push_back({keys[i * keys_a_case], keys[(i + 1) * keys_a_case - 1], refers_to(i)});
  const std::size_t otherwise = refers_to(cases.size());
  const auto has_problem = [](const MdfConversion& one) { return !one.problem.empty(); };
  if (too_many || conversions.empty() || std::ranges::any_of(conversions, has_problem)) return;
  if (conversion.unit.empty()) conversion.unit = conversions.back().unit;
  conversion.problem.clear();
  conversion.function =
      [f = std::make_shared<const TextOrScale>(std::move(cases), otherwise, floating,
                                               std::move(conversions))](std::span<double> x) {
        for (double& v : x) v = (*f)(v);
      };
}

}  // namespace

MdfConversion read_mdf_conversion(MdfBlocks& blocks, std::uint64_t at, bool floating) {
  Parsed parsed = parsed_conversion(blocks, at, floating);
  MdfConversion conversion = std::move(parsed.conversion);
  if (parsed.type == 7 || parsed.type == 8) set_text_or_scale(blocks, parsed, floating, conversion);
  return conversion;
}

}  // namespace impactrig::acquisition
