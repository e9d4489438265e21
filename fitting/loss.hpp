// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string_view>

namespace impactrig::fitting {

/// What a residual r in units of its noise costs: ρ(r), half of which is minimised. With a the
/// tuning constant of 95 % efficiency under normal noise:
///
///   squares  r²
///   huber    r² up to a, then 2 a |r| − a²;                      a = 1.345
///   cauchy   a² ln(1 + (r/a)²);                                  a = 2.385
///   tukey    a²/3 (1 − (1 − (r/a)²)³) up to a, then a²/3;        a = 4.685
///
/// The last two have more than one minimum. Source: [HollandWelsch1977].
enum class Loss { squares, huber, cauchy, tukey };

/// The loss to search with from afar: where one of several minima could be met, huber, which has
/// one.
Loss loss_from_afar(Loss loss);

std::string_view name(Loss loss);
Loss loss_named(std::string_view name);  ///< throws std::invalid_argument and lists the known ones
std::span<const std::string_view> loss_names();

/// ρ and its first two derivatives by r, halved: cost ρ/2, influence ψ = ρ'/2, slope ψ' = ρ''/2.
struct LossValue {
  double cost = 0.0;
  double influence = 0.0;
  double slope = 0.0;
};

LossValue evaluate(Loss loss, double residual);

/// A residual whose half square is the loss of r, for a solver of least squares, and its derivative
/// by r: R = sign(r) √ρ.
struct LossResidual {
  double value = 0.0;
  double slope = 1.0;
};

LossResidual loss_residual(Loss loss, double residual);

}  // namespace impactrig::fitting
