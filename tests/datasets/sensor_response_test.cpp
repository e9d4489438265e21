// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/sensor_response.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "tests/support/places.hpp"

namespace {

using namespace impactrig::datasets;
using std::numbers::pi;

Sensor with_resonance(double frequency, double quality) {
  Sensor sensor;
  sensor.resonance = Resonance{frequency, quality};
  return sensor;
}

Sensor with_low_cut(double frequency, int order) {
  Sensor sensor;
  sensor.low_cut = BandLimit{frequency, order};
  return sensor;
}

Sensor with_high_cut(double frequency, int order) {
  Sensor sensor;
  sensor.high_cut = BandLimit{frequency, order};
  return sensor;
}

std::vector<double> sampled(const std::function<double(double)>& f, std::size_t n,
                            double interval) {
  std::vector<double> values(n);
  for (std::size_t i = 0; i < n; ++i) values[i] = f(interval * static_cast<double>(i));
  return values;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = a.size() == b.size() ? 0.0 : std::nan("");
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

/// Slope of log error over log interval.
double order_of(const std::vector<double>& intervals, const std::vector<double>& errors) {
  double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const double x = std::log(intervals[i]), y = std::log(errors[i]);
    sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  const auto n = static_cast<double>(intervals.size());
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

// A ramp is linear between any two samples, so its response is exact at every interval: only
// rounding is left.

TEST(SensorResponse, OfARampIsExactForAFirstOrderHighCut) {
  for (const double omega_h : {1e-8, 1e-3, 0.3, 1.0, 20.0, 6000.0}) {
    const double interval = 1e-7, tau = interval / omega_h;
    const auto ramp = sampled([](double t) { return t; }, 200, interval);
    const auto exact =
        sampled([&](double t) { return t + tau * std::expm1(-t / tau); }, 200, interval);
    const auto found = sensor_response(with_high_cut(1.0 / (2.0 * pi * tau), 1), ramp, interval);
    // the output is the input plus a deviation, so its rounding is of the input's size
    EXPECT_LT(largest_difference(found, exact), 1e-14 * ramp.back() + 1e-15 * tau) << omega_h;
  }
}

TEST(SensorResponse, OfARampIsExactForAFirstOrderLowCut) {
  for (const double omega_h : {1e-8, 1e-3, 0.3, 1.0, 20.0, 6000.0}) {
    const double interval = 1e-7, tau = interval / omega_h;
    const auto ramp = sampled([](double t) { return t; }, 200, interval);
    const auto exact =
        sampled([&](double t) { return -tau * std::expm1(-t / tau); }, 200, interval);
    const auto found = sensor_response(with_low_cut(1.0 / (2.0 * pi * tau), 1), ramp, interval);
    EXPECT_LT(largest_difference(found, exact), 1e-13 * exact.back()) << omega_h;
  }
}

// y'' + 2ζω y' + ω² y = ω² t from rest: y = t − 2ζ/ω + e^(−ζωt) (2ζ/ω cos ω_d t + (2ζ² − 1)/ω_d sin
// ω_d t)
TEST(SensorResponse, OfARampIsExactForAResonance) {
  for (const double quality : {0.51, 1.0, 20.0, 1e4, std::numeric_limits<double>::infinity()})
    for (const double omega_h : {1e-3, 0.3, 1.0, 20.0, 6000.0}) {
      const double interval = 1e-6, omega = omega_h / interval, zeta = 0.5 / quality;
      const double damped = omega * std::sqrt(1.0 - zeta * zeta);
      const auto ramp = sampled([](double t) { return t; }, 200, interval);
      const auto exact = sampled(
          [&](double t) {
            return t - 2.0 * zeta / omega +
                   std::exp(-zeta * omega * t) *
                       (2.0 * zeta / omega * std::cos(damped * t) +
                        (2.0 * zeta * zeta - 1.0) / damped * std::sin(damped * t));
          },
          200, interval);
      const auto found =
          sensor_response(with_resonance(omega / (2.0 * pi), quality), ramp, interval);
      // an angle of 200 * 6000 rad has no more than 1e-10 in a double
      EXPECT_LT(largest_difference(found, exact), 1e-13 * ramp.back() + 2e-9 / omega)
          << quality << " " << omega_h;
    }
}

// b/(s (s + a) (s + b)) = 1/a [1/s] − b/(a (b − a)) [1/(s + a)] + 1/(b − a) [1/(s + b)]
TEST(SensorResponse, OfARampIsExactForAChain) {
  for (const auto& [low, high] : std::vector<std::pair<double, double>>{
           {0.01, 1e10}, {0.3, 1e5}, {1e3, 1e4}, {3e6, 1e3}, {1e10, 0.01}}) {
    const double interval = 1e-7, a = 2.0 * pi * low, b = 2.0 * pi * high;
    Sensor sensor = with_low_cut(low, 1);
    sensor.high_cut = BandLimit{high, 1};
    const auto ramp = sampled([](double t) { return t; }, 500, interval);
    const auto exact = sampled(
        [&](double t) { return (a * std::expm1(-b * t) - b * std::expm1(-a * t)) / (a * (b - a)); },
        500, interval);
    const auto found = sensor_response(sensor, ramp, interval);
    const double largest = *std::max_element(exact.begin(), exact.end());
    // the output is built from the input, so its rounding is of the input's size
    EXPECT_LT(largest_difference(found, exact), 1e-8 * largest + 1e-15 * ramp.back())
        << low << " " << high;
  }
}

std::complex<double> butterworth(std::complex<double> s, int order) {
  std::complex<double> denominator = 1.0;
  for (int k = 1; k <= order; ++k)
    denominator *= s - std::polar(1.0, pi * (2.0 * k + order - 1.0) / (2.0 * order));
  return 1.0 / denominator;
}

/// Amplitude and phase over the last of many periods, by correlation.
std::complex<double> measured_gain(const Sensor& sensor, double frequency, double settle,
                                   int samples_per_period) {
  const double interval = 1.0 / (frequency * samples_per_period);
  const auto periods = static_cast<std::size_t>(std::ceil(settle * frequency)) + 1;
  const auto per_period = static_cast<std::size_t>(samples_per_period);
  const auto input = sampled([&](double t) { return std::sin(2.0 * pi * frequency * t); },
                             periods * per_period, interval);
  const auto output = sensor_response(sensor, input, interval);
  std::complex<double> sum = 0.0;
  for (std::size_t i = output.size() - per_period; i < output.size(); ++i)
    sum += output[i] *
           std::polar(1.0, -2.0 * pi * static_cast<double>(i % per_period) / samples_per_period);
  return sum * std::complex<double>(0.0, 2.0) / static_cast<double>(samples_per_period);
}

TEST(SensorResponse, HasTheGainAndPhaseOfButterworthsFilters) {
  const double corner = 1e4;
  for (int order = 1; order <= 8; ++order)
    for (const double ratio : {0.5, 1.0, 2.0}) {
      const std::complex<double> s(0.0, ratio);
      const double settle = 8.0 / corner;  // the slowest pole of order 8 has decayed to e^-10
      const auto low = measured_gain(with_high_cut(corner, order), ratio * corner, settle, 4000);
      EXPECT_LT(std::abs(low - butterworth(s, order)), 1e-4) << order << " " << ratio;
      const auto high = measured_gain(with_low_cut(corner, order), ratio * corner, settle, 4000);
      EXPECT_LT(std::abs(high - butterworth(1.0 / s, order)), 1e-4) << order << " " << ratio;
    }
}

TEST(SensorResponse, HasTheGainAndPhaseOfAResonance) {
  for (const double ratio : {0.3, 0.9, 1.0, 1.1, 3.0}) {
    const double quality = 5.0;
    const std::complex<double> exact =
        1.0 / std::complex<double>(1.0 - ratio * ratio, ratio / quality);
    const auto found = measured_gain(with_resonance(45e3, quality), ratio * 45e3, 5e-4, 4000);
    EXPECT_LT(std::abs(found - exact), 1e-4) << ratio;
  }
}

TEST(SensorResponse, IsThreeDecibelsDownAtTheCorner) {
  for (int order = 1; order <= 8; ++order) {
    EXPECT_NEAR(std::norm(measured_gain(with_high_cut(1e5, order), 1e5, 1e-4, 4000)), 0.5, 1e-4);
    EXPECT_NEAR(std::norm(measured_gain(with_low_cut(0.3, order), 0.3, 40.0, 4000)), 0.5, 1e-4);
  }
}

// The whole chain at once: its gain is the product of the sections' gains.
TEST(SensorResponse, OfTheChainIsTheProductOfItsSections) {
  Sensor sensor = with_resonance(3e4, 8.0);
  sensor.low_cut = BandLimit{5e3, 3};
  sensor.high_cut = BandLimit{2e4, 4};
  const double frequency = 1.5e4;
  const std::complex<double> s(0.0, frequency);
  const std::complex<double> ratio = s / 3e4;
  const auto exact =
      1.0 / (1.0 + ratio / 8.0 + ratio * ratio) * butterworth(5e3 / s, 3) * butterworth(s / 2e4, 4);
  EXPECT_LT(std::abs(measured_gain(sensor, frequency, 4e-3, 4000) - exact), 1e-5);
}

// A resonance 20 times above the sampling rate must not be seen, whatever follows it.
TEST(SensorResponse, DoesNotNeedToResolveItsFastestSection) {
  const double interval = 1e-6;
  const auto pulse =
      sampled([](double t) { return t < 2e-4 ? std::pow(std::sin(pi * t / 2e-4), 2) : 0.0; }, 1000,
              interval);
  Sensor sensor = with_high_cut(3e4, 2);
  const auto without = sensor_response(sensor, pulse, interval);
  sensor.resonance = Resonance{2e7, 2.0};
  // its delay 2ζ/ω = 4 ns times the steepest slope, π/(2e-4 s)
  EXPECT_LT(largest_difference(sensor_response(sensor, pulse, interval), without), 7e-5);
}

TEST(SensorResponse, ConvergesWithOrderTwo) {
  Sensor sensor = with_resonance(45e3, 20.0);
  sensor.low_cut = BandLimit{100.0, 2};
  sensor.high_cut = BandLimit{1e5, 3};
  const auto pulse = [](double t) { return t < 2e-4 ? std::pow(std::sin(pi * t / 2e-4), 2) : 0.0; };
  const double finest = 2e-4 / 51200;
  const auto reference = sensor_response(sensor, sampled(pulse, 102401, finest), finest);
  std::vector<double> intervals, errors;
  for (std::size_t stride = 64; stride <= 1024; stride *= 2) {
    const double interval = finest * static_cast<double>(stride);
    const std::size_t n = 102400 / stride + 1;
    const auto coarse = sensor_response(sensor, sampled(pulse, n, interval), interval);
    double error = 0.0;
    for (std::size_t i = 0; i < n; ++i)
      error = std::max(error, std::abs(coarse[i] - reference[i * stride]));
    intervals.push_back(interval);
    errors.push_back(error);
  }
  EXPECT_NEAR(order_of(intervals, errors), 2.0, 0.05);
  EXPECT_LT(errors.front(), 1e-4);
}

TEST(SensorResponse, PassesAConstantExactlyAndALowCutStopsIt) {
  const std::vector<double> constant(1000, 441.7);
  Sensor sensor = with_resonance(11e3, 20.0);
  sensor.high_cut = BandLimit{1e5, 5};
  EXPECT_THAT(sensor_response(sensor, constant, 1e-6), testing::Each(441.7));
  sensor.low_cut = BandLimit{0.3, 1};
  EXPECT_THAT(sensor_response(sensor, constant, 1e-6), testing::Each(0.0));
}

TEST(SensorResponse, IsLinearAndDoesNotMindTheTimeOfDay) {
  Sensor sensor = with_resonance(11e3, 20.0);
  sensor.low_cut = BandLimit{50.0, 2};
  sensor.high_cut = BandLimit{2e4, 3};
  std::vector<double> input(400, 0.0), later(400, 0.0);
  for (std::size_t i = 0; i < 100; ++i) {
    input[50 + i] = std::sin(0.7 * static_cast<double>(i * i));
    later[150 + i] = -3.0 * input[50 + i];
  }
  const auto first = sensor_response(sensor, input, 1e-6);
  const auto second = sensor_response(sensor, later, 1e-6);
  for (std::size_t i = 100; i < 400; ++i) ASSERT_NEAR(second[i], -3.0 * first[i - 100], 1e-13);
}

// A low-pass of unit gain at 0 Hz leaves the impulse alone.
TEST(SensorResponse, KeepsTheImpulseThroughALowPass) {
  const double interval = 1e-6;
  const auto pulse =
      sampled([](double t) { return t < 2e-4 ? std::sin(pi * t / 2e-4) : 0.0; }, 20000, interval);
  Sensor sensor = with_resonance(11e3, 10.0);
  sensor.high_cut = BandLimit{3e3, 4};
  const auto output = sensor_response(sensor, pulse, interval);
  const double impulse = std::accumulate(pulse.begin(), pulse.end(), 0.0);
  EXPECT_NEAR(std::accumulate(output.begin(), output.end(), 0.0), impulse, 1e-10 * impulse);
}

TEST(SensorResponse, StaysBoundedFromOneHundredthHertzToTenGigahertz) {
  const double interval = 1e-7;
  std::vector<double> input(20000);
  for (std::size_t i = 0; i < input.size(); ++i) input[i] = (i / 100) % 2 == 0 ? 1.0 : -1.0;
  const std::vector<double> frequencies{0.01, 1.0, 1e3, 4.9e6, 5e6, 1e8, 1e10};
  for (const double resonance : frequencies)
    for (const double cut : frequencies)
      for (const int order : {1, 2, 7, 8}) {
        Sensor sensor = with_resonance(resonance, 30.0);
        sensor.low_cut = BandLimit{cut, order};
        sensor.high_cut = BandLimit{1e10, order};
        const auto output = sensor_response(sensor, input, interval);
        const auto [lowest, highest] = std::minmax_element(output.begin(), output.end());
        ASSERT_TRUE(std::isfinite(output.back())) << resonance << " " << cut << " " << order;
        // overshoot of a square wave through Q = 30 at resonance stays below 4 Q / π
        ASSERT_GT(*lowest, -80.0) << resonance << " " << cut << " " << order;
        ASSERT_LT(*highest, 80.0) << resonance << " " << cut << " " << order;
      }
}

// A step of one interval, then rest: the low cut decays with its own time constant, however slow.
TEST(SensorResponse, DroopsWithTheTimeConstantOfASlowLowCut) {
  const double interval = 1e-7, tau = 1.0 / (2.0 * pi * 0.01);
  std::vector<double> step(1000000, 1.0);
  step[0] = 0.0;
  Sensor sensor = with_low_cut(0.01, 1);
  sensor.resonance = Resonance{1e10, 0.7};
  sensor.high_cut = BandLimit{1e10, 8};
  const auto output = sensor_response(sensor, step, interval);
  for (const std::size_t i : {1000u, 999999u}) {
    const double droop = -std::expm1(-interval * (static_cast<double>(i) - 0.5) / tau);
    // the 10 GHz filters delay the step by 0.1 ns
    EXPECT_NEAR((1.0 - output[i]) / droop, 1.0,
                1e-9 + 1.1e-10 / (interval * static_cast<double>(i)))
        << i;
  }
}

// A sin² force pulse of 200 us. The figures come from another program, which integrated each filter
// on its own.
TEST(SensorResponse, LowersThePeakAsMuchAsTheMeasuringChainsTableSays) {
  const double interval = 1e-7;
  const auto pulse =
      sampled([](double t) { return t < 2e-4 ? std::pow(std::sin(pi * t / 2e-4), 2) : 0.0; }, 20000,
              interval);
  const auto peak = [&](const Sensor& sensor) {
    const auto output = sensor_response(sensor, pulse, interval);
    return 100.0 * (*std::max_element(output.begin(), output.end()) - 1.0);
  };
  EXPECT_NEAR(peak(with_high_cut(100e3, 2)), 0.0, 0.005);
  EXPECT_NEAR(peak(with_high_cut(30e3, 2)), -0.02, 0.005);
  EXPECT_NEAR(peak(with_high_cut(10e3, 2)), -1.6, 0.05);
  EXPECT_NEAR(peak(with_high_cut(3e3, 2)), -31.0, 0.5);
  EXPECT_NEAR(peak(with_high_cut(1e3, 2)), -72.0, 0.5);
  EXPECT_NEAR(peak(with_low_cut(0.3, 1)), -0.009, 0.0005);
  EXPECT_NEAR(peak(with_low_cut(10.0, 1)), -0.3, 0.05);
  const auto after = sensor_response(with_low_cut(1.0, 1), pulse, interval);
  EXPECT_NEAR(100.0 * after[2000], -0.06, 0.005);
}

TEST(SensorResponse, RingsAsAHalfSineMakesAResonantSensorRing) {
  const std::string path = impactrig::tests::shared_dir + "/reference/checks/sensor_response.json";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no check values in " << path;
  const auto checks = nlohmann::json::parse(std::ifstream(path));
  ASSERT_EQ(checks["cases"].size(), 9u);
  for (const auto& check : checks["cases"]) {
    const double duration = check["T"], frequency = check["f_res"], zeta = check["zeta"];
    const double interval = duration / 20000;
    const auto input =
        sampled([&](double t) { return t < duration ? std::sin(pi * t / duration) : 0.0; }, 60000,
                interval);
    const auto output = sensor_response(with_resonance(frequency, 0.5 / zeta), input, interval);
    const auto peak = std::max_element(output.begin(), output.begin() + 20001);
    double residual = 0.0;
    for (std::size_t i = 20000; i < output.size(); ++i)
      residual = std::max(residual, std::abs(output[i]));
    SCOPED_TRACE(check.dump());
    EXPECT_NEAR(*peak, check["peak_ratio"], 1e-6);
    EXPECT_NEAR(interval * static_cast<double>(peak - output.begin()), check["t_peak"],
                1e-3 * duration);
    EXPECT_NEAR(residual, check["residual_peak"], 1e-6);
  }
}

TEST(SensorResponse, OfNothingIsNothingAndOfNoChainTheInput) {
  EXPECT_TRUE(sensor_response(with_resonance(1e4, 20.0), {}, 1e-6).empty());
  const std::vector<double> input{1.0, -2.0, 3.0};
  EXPECT_EQ(sensor_response(Sensor{}, input, 1e-6), input);
}

std::string refusal(const Sensor& sensor, double interval) {
  try {
    sensor_response(sensor, std::vector<double>{0.0, 1.0}, interval);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(SensorResponse, RefusesWhatIsNoChain) {
  EXPECT_EQ(refusal(Sensor{}, 0.0), "sensor response: the interval must be above 0 s, not 0");
  EXPECT_EQ(refusal(Sensor{}, std::nan("")),
            "sensor response: the interval must be above 0 s, not nan");
  EXPECT_EQ(refusal(with_resonance(-1.0, 20.0), 1e-6),
            "sensor response: the resonance's frequency must be above 0 Hz, not -1");
  EXPECT_EQ(refusal(with_resonance(1e4, 0.5), 1e-6),
            "sensor response: the resonance's quality must be above 0.5, not 0.5");
  EXPECT_EQ(refusal(with_low_cut(0.0, 1), 1e-6),
            "sensor response: the low cut's frequency must be above 0 Hz, not 0");
  EXPECT_EQ(refusal(with_high_cut(1e4, 9), 1e-6),
            "sensor response: the high cut's order must be from 1 to 8, not 9");
  EXPECT_EQ(refusal(with_high_cut(1e4, 0), 1e-6),
            "sensor response: the high cut's order must be from 1 to 8, not 0");
}

}  // namespace
