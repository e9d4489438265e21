// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace impactrig::fitting {

/// One quantity as one shot has it.
struct ShotValue {
  double value = 0.0;
  double std_error = 0.0;  ///< > 0
};

/// How far one shot is from the others, judged by them alone.
struct ShotDeviation {
  double residual = 0.0;  ///< in standard deviations, of the shot and of the others' mean together
  double p_value = 1.0;   ///< two-sided, of Student's t with shots − 2 degrees of freedom
  bool outlier = false;   ///< p below 0.05 / shots: one false alarm in 20 campaigns
};

/// One quantity over repeated shots: y = µ + u + ε with u ~ N(0, τ²) from shot to shot and
/// ε ~ N(0, s²) as each shot's own standard error says.
struct BetweenShots {
  std::size_t shots = 0;
  double mean = 0.0;                    ///< µ, weighted by 1 / (s² + τ²)
  double std_error = 0.0;               ///< of µ
  std::array<double, 2> ci95 = {};      ///< of µ
  double tau = 0.0;                     ///< standard deviation between shots
  std::array<double, 2> tau_ci95 = {};  ///< both 0 where Q is below all χ² of the interval
  double q = 0.0;        ///< Cochran's: Σ ((y − ȳ) / s)², ȳ weighted by 1 / s²
  long dof = 0;          ///< shots − 1
  double p_value = 1.0;  ///< of a Q at least as large, were τ 0
  double i2 = 0.0;  ///< I² = max(0, 1 − dof / Q): share of the scatter that s does not explain
  double scatter = 0.0;  ///< √(Q / dof): how many times the stated errors the shots scatter
  std::vector<ShotDeviation> deviations;  ///< one a shot; empty for fewer than three
};

/// Random-effects estimate of a quantity from repeated shots: τ² by Paule and Mandel, interval of
/// the mean by Hartung and Knapp (random_effects.hpp). The interval of τ is where Q(τ²) lies
/// between the 2.5 % and 97.5 % points of χ² with shots − 1 degrees of freedom (Q-profile), exact
/// where s is known. A shot's deviation leaves it out: (y − µ₋) / √(s² + τ₋² + u²(µ₋)).
///
/// Valid for errors that differ from shot to shot. What all shots share (a calibration, a dimension
/// of the rig) is in s but does not scatter: `scatter` is below 1 then, and the shared part is to
/// be added to the mean's uncertainty undivided. Throws std::invalid_argument for fewer than two
/// shots or a standard error that is not positive.
///
/// Source: [PauleMandel1982], [HartungKnapp2001], [Viechtbauer2007], [ViechtbauerCheung2010],
/// [HigginsThompson2002].
BetweenShots between_shots(std::span<const ShotValue> shots);

/// Whether the shots differ as their intervals say.
enum class ShotAgreement {
  scatter,  ///< more than the intervals say: p of Q below 0.05
  agree,    ///< as the intervals say
  too_well  ///< less than the intervals say: 1 − p below 0.05
};

ShotAgreement agreement(const BetweenShots& found);

/// The approach speed of one shot.
struct ShotSpeed {
  double speed = 0.0;        ///< [m/s]
  double std_error = 0.0;    ///< [m/s]; 0: taken for exact
  double correlation = 0.0;  ///< of its error with that of the shot's value
};

/// How a quantity goes with the approach speed: y = a + b (x − x̄) + u + ε, as in BetweenShots,
/// where x too is known to an error only.
struct SpeedTrend {
  double slope = 0.0;  ///< b [unit of y by m/s]
  double std_error = 0.0;
  std::array<double, 2> ci95 = {};  ///< Student's t with shots − 2 degrees of freedom
  double p_value = 1.0;             ///< two-sided, of b = 0
  double mean_speed = 0.0;          ///< x̄ [m/s]
  double at_mean_speed = 0.0;       ///< a
  double tau = 0.0;                 ///< between shots, besides the trend
  double q = 0.0;                   ///< Cochran's, about the line
  long dof = 0;
};

/// None where speeds (n) say nothing of it: fewer than four shots, or speeds that spread less than
/// three times their median standard error, where the line's own error (line_fit.hpp), of first
/// order in that ratio, is no longer good. τ² as in between_shots, from the scatter about the line;
/// where that is below its expectation the slope's error is not made smaller. Valid as
/// between_shots, and for errors of the speeds that differ from shot to shot: one that all share, a
/// calibration, scales the slope. Source: [YorkEtAl2004], and those of between_shots.
std::optional<SpeedTrend> speed_trend(std::span<const ShotValue> shots,
                                      std::span<const ShotSpeed> speeds);

}  // namespace impactrig::fitting
