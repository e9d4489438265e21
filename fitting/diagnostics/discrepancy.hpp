// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "fitting/diagnostics/channel_diagnostics.hpp"
#include "fitting/diagnostics/noise_colour.hpp"

namespace impactrig::fitting {

/// Samples of measured − model after touch, the first one interval after it.
struct DiscrepancyTask {
  std::span<const double> residual;  ///< [unit] (n); missing ones are not numbers
  double interval = 0.0;             ///< [s]
  double contact = 0.0;              ///< duration of the first contact [s]
  double level = 0.05;               ///< chance of seeing something in pure noise
};

/// What the model leaves out, as a smooth function δ of time: y = η(θ̂) + δ(t) + ε, where the
/// parameters stay as fitted, so that δ and θ are not confounded, but δ holds only what they could
/// not take up.
///
/// δ is a Gaussian process that is zero until first touch, of Matérn's covariance with ν = 5/2,
///
///   k(s) = a² (1 + λ s + λ² s² / 3) e^{−λ s},   λ = √5 / l,
///
/// twice differentiable and, unlike the squared exponential, a Markov process of three states: the
/// likelihood costs O(n). What drives it may be weaker, by 0.03 in a², once the contact has ended.
/// ε is the autoregressive noise seen before touch, its size free. a / σ, l and which of the two by
/// marginal likelihood on a grid, l from 4 samples to the duration of the contact.
/// At most 20 000 samples are looked at.
///
/// Significance: Λ = 2 ln(L / L₀) times ν₀ / (ν₀ + K), ν₀ = n₀ / (2 τ₀) independent samples before
/// touch that tell the noise's spectral density, K = n Δt / l such in δ; half a chi-squared of one
/// degree of freedom, since a >= 0, times the number of other choices tried: an upper bound.
///
/// Sources: [KennedyOHagan2001]; [BrynjarsdottirOHagan2014] on what δ can and cannot tell;
/// [HartikainenSarkka2010] for the states, [DurbinKoopman2012], section 4.4, for the smoother.
Discrepancy discrepancy(const DiscrepancyTask& task, const NoiseColour& noise);

}  // namespace impactrig::fitting
