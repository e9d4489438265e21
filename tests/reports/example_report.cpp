// SPDX-License-Identifier: BSD-3-Clause
#include "tests/reports/example_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include <fmt/format.h>

#include "fitting/diagnostics/diagnose.hpp"

namespace impactrig::tests {

namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

/// A bar as three modes that share the struck point; mode 0 is the rigid swing.
struct Motion {
  std::array<double, 3> mass{0.55, 0.45, 0.40};                        // [kg]
  std::array<double, 3> omega{0.0, two_pi * 1000.0, two_pi * 3000.0};  // [rad/s]
  std::array<double, 3> q{}, v{};

  double sum(const std::array<double, 3>& x) const { return x[0] + x[1] + x[2]; }

  double rotation() const { return 0.5 * mass[0] * v[0] * v[0]; }

  double vibration() const {
    double energy = 0.0;
    for (std::size_t i = 1; i < 3; ++i)
      energy += 0.5 * mass[i] * (v[i] * v[i] + omega[i] * omega[i] * q[i] * q[i]);
    return energy;
  }

  /// Semi-implicit Euler under the contact force [N].
  void step(double force, double dt) {
    for (std::size_t i = 0; i < 3; ++i) {
      v[i] -= dt * (force / mass[i] + omega[i] * omega[i] * q[i]);
      q[i] += dt * v[i];
    }
  }
};

/// A run's episodes, built sample by sample.
class EpisodeKeeper {
 public:
  EpisodeKeeper(models::Simulation& run, double dt) : run_(run), dt_(dt) {}

  void add(double t, double depth, double rate, double force, double elastic) {
    if (depth > 0.0 && !touching_) {
      run_.episodes.emplace_back();
      run_.episodes.back().start = t;
      run_.episodes.back().approach_velocity = rate;
    }
    const bool leaves = depth <= 0.0 && touching_;
    touching_ = depth > 0.0;
    if (leaves) {
      run_.episodes.back().end = t;
      run_.episodes.back().separation_velocity = -rate;
    }
    if (!touching_) return;
    models::Episode& episode = run_.episodes.back();
    episode.end = t;
    episode.impulse += force * dt_;
    episode.dissipated += (force - elastic) * rate * dt_;
    episode.max_penetration = std::max(episode.max_penetration, depth);
    if (force > episode.peak_force) {
      episode.peak_force = force;
      episode.peak_time = t;
    }
    if (run_.episodes.size() > 1) return;
    (rate > 0.0 ? closing_ : opening_) += force * dt_;
    (rate > 0.0 ? taken_ : returned_) += std::abs(force * rate) * dt_;
  }

  void finish(double restitution) {
    for (const models::Episode& episode : run_.episodes) {
      run_.impulse += episode.impulse;
      run_.energy.dissipated += episode.dissipated;
      run_.max_penetration = std::max(run_.max_penetration, episode.max_penetration);
      if (episode.peak_force > run_.peak_force) {
        run_.peak_force = episode.peak_force;
        run_.peak_time = episode.peak_time;
      }
    }
    const models::Episode& first = run_.episodes.front();
    run_.restitution = {restitution, first.separation_velocity / first.approach_velocity,
                        opening_ / closing_, std::sqrt(returned_ / taken_)};
  }

 private:
  models::Simulation& run_;
  double dt_;
  bool touching_ = false;
  double closing_ = 0.0, opening_ = 0.0, taken_ = 0.0, returned_ = 0.0;
};

/// K d^1.08 (1 + mu rate), mu = 3 (1 - e^2) / (4 v): compression > 0.
models::Simulation example_run(double velocity, double restitution, double stiffness) {
  models::Simulation run;
  run.solver.model = models::BeamModel::hybrid;
  run.history.start = -500e-6;
  run.history.interval = 1e-6;
  const int substeps = 20;
  const double dt = run.history.interval / substeps;
  const double mu = 0.75 * (1.0 - restitution * restitution) / velocity;
  Motion bar;
  bar.v[0] = velocity;
  EpisodeKeeper keeper(run, dt);
  for (int k = -500; k < 2500; ++k) {
    double force = 0.0, depth = 1e-6 * k * velocity, rate = velocity;
    for (int i = 0; k >= 0 && i < substeps; ++i) {
      depth = bar.sum(bar.q);
      rate = bar.sum(bar.v);
      const double elastic = depth > 0.0 ? stiffness * std::pow(depth, 1.08) : 0.0;
      force = std::max(0.0, elastic * (1.0 + mu * rate));
      keeper.add(1e-6 * k + i * dt, depth, rate, force, elastic);
      bar.step(force, dt);
    }
    run.history.force.push_back(force);
    run.history.penetration.push_back(depth);
    run.history.velocity.push_back(rate);
    run.history.displacement.push_back(depth);
  }
  keeper.finish(restitution);
  run.duration = 2.5e-3;
  run.energy.initial = 0.5 * bar.mass[0] * velocity * velocity;
  run.energy.rigid_rotation = bar.rotation();
  run.energy.vibration = bar.vibration();
  run.energy.kinetic = bar.rotation() + 0.5 * bar.vibration();
  run.energy.elastic = 0.5 * bar.vibration();
  run.energy.imbalance = (run.energy.initial - run.energy.dissipated - run.energy.vibration -
                          run.energy.rigid_rotation) /
                         run.energy.initial;
  run.cost = {1240, 31, 5060, 0.021};
  run.termination = "the bar has left for good, 1.7 ms after its last contact";
  run.skipped = {"the swing before first touch: its end state is given",
                 "axial modes: 0.02 % of the peak force"};
  return run;
}

/// One degree of freedom, unit gain at 0 Hz.
std::vector<double> through_resonance(const std::vector<double>& in, double frequency,
                                      double quality, double interval) {
  const double omega = two_pi * frequency;
  const int substeps = 20;
  const double dt = interval / substeps;
  double x = in.front(), v = 0.0;
  std::vector<double> out;
  for (const double target : in) {
    for (int i = 0; i < substeps; ++i) {
      v += dt * (omega * omega * (target - x) - omega / quality * v);
      x += dt * v;
    }
    out.push_back(x);
  }
  return out;
}

/// A channel: the model's curve, and the "measured" one of slightly other parameters plus noise,
/// rounded to the digitiser's steps.
fitting::ChannelFit example_channel(const std::string& quantity, const std::vector<double>& model,
                                    const std::vector<double>& truth, double noise, double quantum,
                                    unsigned seed) {
  fitting::ChannelFit channel;
  channel.quantity = quantity;
  channel.channel = quantity == "force" ? "CH1 Force 208C04" : "CH2 Vibrometer velocity";
  channel.unit = quantity == "force" ? "N" : "m/s";
  channel.noise = noise;
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal(0.0, noise);
  double squares = 0.0, difference = 0.0, reference = 0.0;
  int used = 0;
  for (std::size_t i = 0; i < model.size(); ++i) {
    const double t = -500e-6 + 1e-6 * static_cast<double>(i);
    const bool fitted = t > -50e-6 && t < 1200e-6;
    const double measured = std::round((truth[i] + normal(generator)) / quantum) * quantum;
    channel.time.push_back(t);
    channel.model.push_back(model[i]);
    channel.measured.push_back(measured);
    channel.used.push_back(fitted ? 1 : 0);
    if (!fitted) continue;
    squares += (measured - model[i]) * (measured - model[i]);
    difference += std::abs(measured - model[i]);
    reference = std::max(reference, std::abs(measured));
    ++used;
  }
  channel.residual_rms = std::sqrt(squares / used);
  channel.metrics = {{"nrmse", channel.residual_rms / reference},
                     {"correlation", 0.99981},
                     {"sprague_geers_magnitude", -0.0042},
                     {"sprague_geers_phase", 0.0061},
                     {"sprague_geers_comprehensive", 0.0074}};
  return channel;
}

std::vector<fitting::Parameter> example_parameters(int recordings) {
  std::vector<fitting::Parameter> out;
  const auto add = [&](const std::string& name, const std::string& unit, double value, double error,
                       double initial) -> fitting::Parameter& {
    fitting::Parameter p;
    p.name = name;
    p.unit = unit;
    p.value = value;
    p.std_error = error;
    p.ci95 = {value - 1.96 * error, value + 1.96 * error};
    p.initial = initial;
    p.lower = value - 10.0 * std::abs(value);
    p.upper = value + 10.0 * std::abs(value);
    return out.emplace_back(p);
  };
  fitting::Parameter& restitution = add("contact.restitution", "1", 0.512, 0.0113, 0.7);
  restitution.lower = 0.0;
  restitution.upper = 1.0;
  add("contact.stiffness_factor", "1", 0.8714, 0.0121, 1.0);
  for (int r = 0; r < recordings; ++r) {
    const std::string suffix = recordings > 1 ? fmt::format("[{}]", r + 1) : "";
    add("start.velocity" + suffix, "m/s", 0.44083 * (1.0 + 0.2 * r), 0.00037, 0.44);
    fitting::Parameter& touch = add("timing.first_touch" + suffix, "s", 1.237e-7, 4.4e-8, 0.0);
    touch.nuisance = true;
    fitting::Parameter& gain = add("sensors.force.gain" + suffix, "1", 1.0062, 0.0084, 1.0);
    gain.prior = {1.0, 0.01};
    gain.nuisance = true;
    fitting::Parameter& offset = add("sensors.force.offset" + suffix, "N", -0.31, 0.22, 0.0);
    offset.nuisance = true;
    fitting::Parameter& delay = add("sensors.velocity.delay" + suffix, "s", 2.2e-6, 0.0, 2e-6);
    delay.prior = {2e-6, 0.1e-6};
    delay.nuisance = true;
    delay.at_bound = true;
    delay.lower = 1.8e-6;
    delay.upper = 2.2e-6;
    delay.ci95 = {std::nan(""), std::nan("")};
    fitting::Parameter& resonance =
        add("sensors.force.resonance.quality" + suffix, "1", 21.4, 0.0, 20.0);
    resonance.identifiable = false;
    resonance.nuisance = true;
    resonance.std_error = resonance.mesh_shift = resonance.mesh_error = std::nan("");
    resonance.ci95 = {std::nan(""), std::nan("")};
  }
  return out;
}

/// exp(-|i - j| / 2) with alternating sign: symmetric, 1 on the diagonal, positive definite.
Eigen::MatrixXd example_correlations(std::size_t parameters) {
  const auto n = static_cast<Eigen::Index>(parameters);
  Eigen::MatrixXd out(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) {
      const double distance = std::abs(static_cast<double>(i - j));
      out(i, j) = ((i - j) % 2 == 0 ? 1.0 : -1.0) * std::exp(-distance / 1.5);
    }
  return out;
}

datasets::Record example_record(const std::string& file) {
  datasets::Record record;
  record.title = "Bar on groove, shot 17";
  record.started = "2024-05-17T14:03:22+02:00";
  for (const bool force : {true, false}) {
    datasets::Channel channel;
    channel.name = force ? "CH1 Force 208C04" : "CH2 Vibrometer velocity";
    channel.quantity = force ? datasets::Quantity::force : datasets::Quantity::velocity;
    channel.unit = force ? "N" : "m/s";
    channel.clock = {0.0, 1e-6, {}};
    channel.raw = std::vector<std::int16_t>(3000, 1);
    channel.scale = force ? 0.25 : 5e-4;
    channel.calibration = datasets::Calibration{force ? 0.004 : 8.0, force ? 4e-5 : 0.0, "V",
                                                force ? "N" : "m/s", "bench.toml"};
    channel.delay = datasets::Delay{force ? 0.0 : 2e-6, force ? 1e-6 : 1e-7, true};
    channel.attributes = {{"range", "10 V"}};
    record.channels.push_back(channel);
  }
  record.provenance = {
      file,
      1537024,
      "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08",
      "uff58b",
      "impactrig 0.1.0",
      {{"apply the sensitivity", "CH1 Force 208C04", {{"sensitivity", "4 mV/N"}}},
       {"remove the baseline", "", {{"force", "0.31 N"}, {"velocity", "0 m/s"}}},
       {"take off the known delay", "CH2 Vibrometer velocity", {{"delay", "2 us"}}}}};
  record.warnings = {"The header states 3001 samples, the file holds 3000; all 3000 were read."};
  record.attributes = {{"operator", "A. Example"}};
  return record;
}

datasets::Impact example_impact(const std::string& file, const models::Simulation& run) {
  datasets::Impact impact;
  impact.recording = file;
  impact.start = 0.0005;
  impact.end = 0.0005 + run.episodes.front().end;
  impact.peak = run.peak_force + 9.0;
  impact.peak_time = 0.0005 + run.peak_time + 1e-6;
  impact.width = 0.52 * run.episodes.front().end;
  impact.impulse = run.episodes.front().impulse * 1.004;
  impact.approach_velocity = run.episodes.front().approach_velocity + 4e-4;
  const auto signal = [&](datasets::Quantity quantity, double noise, double quantum) {
    datasets::ImpactSignal out;
    out.quantity = quantity;
    out.channel =
        quantity == datasets::Quantity::force ? "CH1 Force 208C04" : "CH2 Vibrometer velocity";
    out.interval = 1e-6;
    out.noise = noise;
    out.noise_correlation = 1.3;
    out.quantum = quantum;
    out.baseline = 0.05 * noise;
    out.gain_uncertainty = 0.01;
    out.delay = quantity == datasets::Quantity::force ? 0.0 : 2e-6;
    out.delay_uncertainty = 1e-7;
    return out;
  };
  impact.force = signal(datasets::Quantity::force, 6.0, 0.25);
  impact.velocity = signal(datasets::Quantity::velocity, 1.5e-3, 5e-4);
  impact.flags = {datasets::ImpactFlag::double_hit};
  return impact;
}

const char* const example_rig_text = R"([beam]
length = "0.8 m"
section = { shape = "circle", radius = "15 mm" }
youngs_modulus = "68.952 GPa"
poisson_ratio = 0.3
density = "2766.7 kg/m^3"

[contact]
position = "0.69 m"
counterface = { shape = "groove", radius = "17.5 mm" }
length = "20 mm"
counter_modulus = "68.952 GPa"
counter_poisson_ratio = 0.3
law = "goldsmith"
damping = "lankarani-nikravesh"
restitution = 0.7

[start]
velocity = "0.44 m/s"
)";

reports::ResultProvenance example_provenance() {
  reports::ResultProvenance out;
  out.tool = "impactrig";
  out.version = "0.1.0";
  out.build = "g++ 12.2.0, Release; Eigen 3.4.0, Ceres 2.1.0";
  out.git = "0123abc+";
  out.command = {"impactrig",  "validate", "shot 17.uff", "--rig",
                 "bench.toml", "-o",       "report.html"};
  out.config = example_rig_text;
  out.config_sha256 = "2c26b46b68ffc68ff99b453c1d30413413422d706483bfa0f98a5e886266e7ae";
  out.started = "2024-05-17T16:20:41+02:00";
  out.wall_s = 0.83;
  out.host = "bench-pc";
  out.result_key = "fcde2b2edba56bf408601fb721fe9b5c338d10ee429ea04fae5511b68fbf8fb9";
  return out;
}

/// Of all samples, fitted or not.
fitting::ChannelDiagnostics example_diagnostics(const fitting::ChannelFit& channel,
                                                const models::Simulation& run, double quantum) {
  fitting::ChannelResiduals residuals;
  residuals.quantity = channel.quantity;
  residuals.unit = channel.unit;
  residuals.start = channel.time.front();
  residuals.interval = 1e-6;
  residuals.model = channel.model;
  for (std::size_t i = 0; i < channel.time.size(); ++i)
    residuals.residual.push_back(channel.measured[i] - channel.model[i]);
  residuals.quantum = quantum;
  residuals.phases = {run.episodes.front().peak_time, run.episodes.front().end, {}};
  return fitting::diagnose(residuals, 0.025);
}

fitting::DirectEstimate direct_estimate(double value, double error) {
  fitting::DirectEstimate out;
  out.value = value;
  out.std_error = error;
  out.ci95 = {value - 1.96 * error, value + 1.96 * error};
  out.budget = {{"force noise", 0.3 * error},
                {"motion noise", 0.0},
                {"relative delay", std::sqrt(0.91) * error}};
  return out;
}

/// As the run has it, but for the kinetic restitution, which is off by four standard errors.
fitting::DirectRestitution example_direct(const models::Simulation& run) {
  fitting::DirectRestitution out;
  out.kinematic = direct_estimate(run.restitution.kinematic + 0.002, 0.008);
  out.smoothed.absent = "The record is too short.";
  out.kinetic = direct_estimate(run.restitution.kinetic + 0.08, 0.02);
  out.energetic = direct_estimate(run.restitution.energetic - 0.004, 0.009);
  const models::Episode& first = run.episodes.front();
  out.hysteresis.dissipated = direct_estimate(1.05 * first.dissipated, 0.05 * first.dissipated);
  out.hysteresis.max_penetration =
      direct_estimate(first.max_penetration, 0.02 * first.max_penetration);
  out.touch = 5e-4;
  out.deepest = 6e-4;
  out.separation = 5e-4 + first.end;
  const models::History& history = run.history;
  for (std::size_t k = 0; k < history.force.size(); ++k) {
    const double t = history.start + history.interval * static_cast<double>(k);
    if (t < 0.0 || t > first.end) continue;
    out.hysteresis.time.push_back(t);
    out.hysteresis.penetration.push_back(history.penetration[k]);
    out.hysteresis.force.push_back(1.02 * history.force[k]);
  }
  return out;
}

void add_recording(reports::ReportData& data, int index) {
  const double velocity = 0.44083 * (1.0 + 0.2 * index);
  const std::string file = fmt::format("shot {}.uff", 17 + index);
  const models::Simulation run = example_run(velocity, 0.512, 2.2e8 * 0.8714);
  const models::Simulation truth = example_run(velocity * 1.001, 0.520, 2.2e8 * 0.8714);
  const auto seed = static_cast<unsigned>(17 + 2 * index);
  data.fit.channels.push_back(
      example_channel("force", through_resonance(run.history.force, 45e3, 20.0, 1e-6),
                      through_resonance(truth.history.force, 45e3, 20.0, 1e-6), 6.0, 0.25, seed));
  data.fit.channels.push_back(example_channel("velocity", run.history.velocity,
                                              truth.history.velocity, 1.5e-3, 5e-4, seed + 1));
  for (std::size_t c = data.fit.channels.size() - 2; c < data.fit.channels.size(); ++c) {
    fitting::ChannelFit& channel = data.fit.channels[c];
    channel.recording = index;
    channel.diagnostics =
        example_diagnostics(channel, run, channel.quantity == "force" ? 0.25 : 5e-4);
  }
  data.fit.impacts.push_back(example_impact(file, run));
  data.fit.predictions.push_back(run);
  data.fit.direct.push_back(example_direct(run));
  data.records.push_back(example_record(file));
  data.provenance.inputs.push_back({file, 1537024, data.records.back().provenance.sha256});
}

fitting::RigFile example_rig() {
  fitting::RigFile rig;
  rig.path = "bench.toml";
  rig.text = example_rig_text;
  rig.sha256 = "2c26b46b68ffc68ff99b453c1d30413413422d706483bfa0f98a5e886266e7ae";
  rig.rig.beam = {0.8, 7.0686e-4, 3.9761e-8, 68.952e9, 2766.7};
  rig.rig.contact = {.position = 0.69,
                     .counterface = models::Counterface::groove,
                     .radius = 0.015,
                     .counter_radius = 0.0175,
                     .length = 0.02,
                     .modulus = 68.952e9,
                     .poisson_ratio = 0.3,
                     .counter_modulus = 68.952e9,
                     .counter_poisson_ratio = 0.3,
                     .law = "goldsmith",
                     .exponent = 1,
                     .stiffness_factor = 0.8714,
                     .damping = "lankarani-nikravesh",
                     .restitution = 0.512};
  rig.rig.start.velocity = 0.44083;
  rig.solver.model = models::BeamModel::hybrid;
  rig.force = datasets::Sensor{};
  rig.force->sensitivity = datasets::UncertainValue{0.004, 4e-5};
  rig.force->recorded_unit = "V";
  rig.force->resonance = datasets::Resonance{45e3, 20.0};
  rig.force->high_cut = datasets::BandLimit{100e3, 1};
  rig.velocity = datasets::Sensor{};
  rig.velocity->quantity = datasets::Quantity::velocity;
  rig.velocity->position = 0.69;
  rig.velocity->delay = {2e-6, 1e-7, true};
  return rig;
}

}  // namespace

reports::ReportData example_report(int recordings) {
  reports::ReportData data;
  data.title = "Invented example: bar on groove";
  data.provenance = example_provenance();
  for (int r = 0; r < recordings; ++r) add_recording(data, r);
  data.provenance.inputs.push_back({"bench.toml", 431, data.provenance.config_sha256});
  data.fit.parameters = example_parameters(recordings);
  data.fit.correlations = example_correlations(data.fit.parameters.size());
  data.fit.not_identifiable = {
      "sensors.force.resonance.quality: the recording stops ringing below the noise within one "
      "period, so the data cannot tell it from its initial value."};
  data.fit.goodness = {2811.4, 2494, 2827.6, 2873.9};
  const models::Restitution& found = data.fit.predictions.front().restitution;
  data.fit.restitution = {
      {"law", {0.512, {0.4899, 0.5341}}},
      {"kinematic", {found.kinematic, {found.kinematic - 0.009, found.kinematic + 0.009}}},
      {"kinetic", {found.kinetic, {found.kinetic - 0.015, found.kinetic + 0.015}}},
      {"energetic", {found.energetic, {found.energetic - 0.006, found.energetic + 0.006}}}};
  data.fit.rig = example_rig();
  data.fit.termination = "converged";
  data.fit.iterations = 9;
  data.fit.loss = fitting::Loss::huber;
  data.fit.judging_seconds = 0.075;
  data.fit.simulations = 97;
  data.fit.seconds = 0.71;
  data.fit.warnings = {
      "The residual of the force rings at 45 kHz after the contact: the sensor's resonance is not "
      "where the rig file has it; measure it, or free sensors.force.resonance.frequency."};
  return data;
}

}  // namespace impactrig::tests
