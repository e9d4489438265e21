// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace impactrig::fitting {

/// Residuals of one phase of the impact against the noise before touch.
struct PhaseLevel {
  std::string phase;     ///< before touch, compression, restitution, free vibration, later contacts
  long samples = 0;      ///< fitted there
  double rms = 0.0;      ///< of the residuals [unit of the channel]
  double ratio = 0.0;    ///< rms over noise [-]
  double p_value = 1.0;  ///< of so much from noise alone
  /// Part of the samples that holds nine tenths of the residuals' energy [-]: 0.45 of normal noise,
  /// 0.60 of a vibration, little of spikes and dropouts.
  double concentration = 0.0;
};

/// How alike neighbouring residuals are after touch, once whitened by the colour seen before it.
struct Whiteness {
  double lag1 = 0.0;                    ///< autocorrelation at one sample [-]
  double p_value = 1.0;                 ///< against the autocorrelation before touch
  double band = 0.0;                    ///< 95 % of chance lies within ± this [-]
  std::vector<double> autocorrelation;  ///< at lags 1, 2, … (n_lags)
  std::vector<double> before;           ///< the same before touch (n_lags)
};

/// Distribution of the whitened residuals after touch.
struct Normality {
  double statistic = 0.0;        ///< Anderson and Darling's A², mean and variance estimated
  double p_value = 1.0;          ///< of that from a normal distribution
  double skewness = 0.0;         ///< [-]
  double excess_kurtosis = 0.0;  ///< [-], 0 for a normal distribution
  std::string words;  ///< "normal", "heavy-tailed", "light-tailed", "skewed upwards", …
  std::vector<double> quantiles;  ///< at probabilities (i + ½) / n, in standard deviations (n)
};

/// Longest stretch of whitened residuals after touch that share a sign.
struct SignRun {
  long samples = 0;
  double from = 0.0, to = 0.0;  ///< after first touch [s]
  double p_value = 1.0;         ///< of one so long among fair coins
};

/// Something simple that residuals may look like.
struct Structure {
  std::string kind;              ///< delay, gain, offset, drift, vibration
  double amount = 0.0;           ///< how much of it [unit]; a delay > 0: measured later than model
  double std_error = 0.0;        ///< [unit]
  std::string unit;              ///< s, 1, the channel's, the channel's per second
  double share = 0.0;            ///< of the energy of the residuals after touch [-]
  double p_value = 1.0;          ///< of so much from noise alone
  double frequency = 0.0;        ///< of a vibration [Hz]
  double model_amplitude = 0.0;  ///< of the model at that frequency [unit]
};

/// What the model leaves out as a smooth function of time, zero before touch, estimated after the
/// fit: fitting/diagnostics/discrepancy.hpp.
struct Discrepancy {
  bool significant = false;
  double p_value = 1.0;
  double length = 0.0;         ///< correlation length of the function [s]
  double rms = 0.0;            ///< over the fitted samples after touch [unit of the channel]
  double largest = 0.0;        ///< its value where it is largest in size [unit of the channel]
  double largest_error = 0.0;  ///< standard deviation there
  double largest_time = 0.0;   ///< after first touch [s]
  std::vector<double> time;    ///< [s] (n); empty where nothing is significant
  std::vector<double> mean;    ///< (n)
  std::vector<double> error;   ///< standard deviation, 95 % lie within 1.96 of it (n)
};

/// Where a channel's residuals (measured − model) are not what its noise before touch leads to
/// expect.
struct ChannelDiagnostics {
  bool judged = false;   ///< false: too little was seen before touch; only `sentence` counts
  bool sound = true;     ///< no test beyond `level`
  double level = 0.05;   ///< chance of calling a right model unsound, over all tests here
  double p_value = 1.0;  ///< smallest of those tests, times their number
  double noise = 0.0;    ///< standard deviation before touch, trend removed [unit]
  double noise_correlation = 1.0;  ///< its integrated autocorrelation time [samples]
  long noise_samples = 0;
  bool coarse = false;  ///< the digitiser's step hides the noise: only levels were tested
  std::vector<PhaseLevel> phases;
  Whiteness whiteness;
  Normality normality;
  SignRun run;
  std::vector<Structure> structures;
  Discrepancy discrepancy;
  std::string sentence;  ///< where, what it looks like, what to do next
};

}  // namespace impactrig::fitting
