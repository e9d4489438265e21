// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/loss.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

namespace impactrig::fitting {
namespace {

constexpr std::array<std::string_view, 4> names = {"squares", "huber", "cauchy", "tukey"};

constexpr double huber_constant = 1.345;
constexpr double cauchy_constant = 2.385;
constexpr double tukey_constant = 4.685;

}  // namespace

Loss loss_from_afar(Loss loss) {
  return loss == Loss::squares ? loss : Loss::huber;
}

std::string_view name(Loss loss) {
  return names[static_cast<std::size_t>(loss)];
}

std::span<const std::string_view> loss_names() {
  return names;
}

Loss loss_named(std::string_view name) {
  std::string known;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] == name) return static_cast<Loss>(i);
    known += fmt::format("{}{}", i == 0 ? "" : ", ", names[i]);
  }
  throw std::invalid_argument(fmt::format("there is no loss '{}'; losses are {}", name, known));
}

LossValue evaluate(Loss loss, double r) {
  switch (loss) {
    case Loss::squares:
      break;
    case Loss::huber: {
      const double a = huber_constant;
      if (std::abs(r) <= a) break;
      return {a * std::abs(r) - 0.5 * a * a, std::copysign(a, r), 0.0};
    }
    case Loss::cauchy: {
      const double a = cauchy_constant;
      const double part = r / a * (r / a);
      const double weight = 1.0 / (1.0 + part);
      return {0.5 * a * a * std::log1p(part), r * weight, (1.0 - part) * weight * weight};
    }
    case Loss::tukey: {
      const double a = tukey_constant;
      const double part = r / a * (r / a);
      if (part >= 1.0) return {a * a / 6.0, 0.0, 0.0};
      const double rest = 1.0 - part;
      // 1 − rest³ without cancellation
      const double saved = part * (3.0 - 3.0 * part + part * part);
      return {a * a / 6.0 * saved, r * rest * rest, rest * (1.0 - 5.0 * part)};
    }
  }
  return {0.5 * r * r, r, 1.0};
}

LossResidual loss_residual(Loss loss, double r) {
  const LossValue at = evaluate(loss, r);
  const double size = std::sqrt(2.0 * at.cost);
  if (loss == Loss::squares || size == 0.0) return {r, 1.0};  // 0 also where r² underflows
  return {std::copysign(size, r), std::abs(at.influence) / size};
}

}  // namespace impactrig::fitting
