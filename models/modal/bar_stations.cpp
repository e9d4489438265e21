// SPDX-License-Identifier: BSD-3-Clause
#include "models/modal/bar_stations.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

#include "models/lanes/station_lanes.hpp"

namespace impactrig::models {
namespace {

/// Of a bending wave of a given frequency, how many are in the piece; only ratios matter.
double waves(const BarElement& piece) {
  return piece.length * piece.wave_number();
}

/// The bar's pieces, those alike taken together, cut at the struck point.
std::vector<BarElement> unlike_spans(const Rig& rig) {
  std::vector<BarElement> spans;
  for (const BarElement& piece : bar_pieces(rig.beam)) {
    const bool like = !spans.empty() && spans.back().line_density == piece.line_density &&
                      spans.back().bending_stiffness == piece.bending_stiffness;
    if (like)
      spans.back().length = piece.x + piece.length - spans.back().x;
    else
      spans.push_back(piece);
  }
  const double struck = rig.contact.position;
  const std::size_t cut = element_at(spans, struck);
  const double before = struck - spans[cut].x, beyond = spans[cut].length - before;
  const double shortest = 1e-9 * rig.beam.length;
  if (before <= shortest || beyond <= shortest) return spans;
  BarElement second = spans[cut];
  spans[cut].length = before;
  second.x = struck;
  second.length = beyond;
  spans.insert(spans.begin() + static_cast<std::ptrdiff_t>(cut) + 1, second);
  return spans;
}

/// Two a half wave of the fastest mode, or of the slow ones that move most of a mesh with many.
std::vector<BarElement> station_spans(const Rig& rig, int modes) {
  constexpr std::size_t fewest_of_span = 2;
  const auto usual = static_cast<std::size_t>(std::clamp(2 * modes, 24, 48));
  const std::vector<BarElement> spans = unlike_spans(rig);
  std::vector<std::size_t> shares(spans.size(), fewest_of_span);
  for (std::size_t all = fewest_of_span * spans.size(); all < usual; ++all) {
    std::size_t coarsest = 0;
    for (std::size_t i = 1; i < spans.size(); ++i)
      if (waves(spans[i]) * static_cast<double>(shares[coarsest]) >
          waves(spans[coarsest]) * static_cast<double>(shares[i]))
        coarsest = i;
    ++shares[coarsest];
  }
  std::vector<BarElement> stations;
  for (std::size_t i = 0; i < spans.size(); ++i)
    for (std::size_t k = 0; k < shares[i]; ++k) {
      BarElement station = spans[i];
      station.length /= static_cast<double>(shares[i]);
      station.x += static_cast<double>(k) * station.length;
      stations.push_back(station);
    }
  return stations;
}

}  // namespace

BarStations::BarStations(const Rig& rig, int modes, const PointOf& point, int axial_modes) {
  const std::vector<BarElement> spans = station_spans(rig, modes);
  const auto count = static_cast<Eigen::Index>(spans.size());
  for (Eigen::VectorXd* values : {&x, &length, &mass}) values->resize(count);
  Eigen::MatrixXd of_modes(modes, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const BarElement& span = spans[static_cast<std::size_t>(i)];
    x[i] = span.x;
    length[i] = span.length;
    mass[i] = span.line_density * span.length;
    of_modes.col(i) = (point(span.x + span.length) - point(span.x)) / span.length;
  }
  slopes = of_modes.transpose();
  for (const LumpedMass& lump : rig.beam.masses) {
    const auto station = static_cast<Eigen::Index>(element_at(spans, lump.position));
    const double part = (lump.position - x[station]) / length[station];
    lumps.push_back({station, std::min(part, 1.0), lump.mass});
  }
  weight = mass;
  for (const Lump& lump : lumps) weight[lump.station] += lump.mass;
  add_up_from_tip(weight);
  weight *= rig.gravity_along();
  bending.resize(count - 1);
  for (Eigen::Index i = 0; i + 1 < count; ++i) {
    const BarElement& here = spans[static_cast<std::size_t>(i)];
    const BarElement& next = spans[static_cast<std::size_t>(i) + 1];
    bending[i] =
        2.0 / (here.length / here.bending_stiffness + next.length / next.bending_stiffness);
  }
  find_axial_modes(spans, std::min(axial_modes, most_axial_modes));
}

void BarStations::add_up_from_tip(Eigen::VectorXd& values) {
  double beyond = 0.0;
  for (Eigen::Index i = values.size() - 1; i >= 0; --i) {
    const double own = values[i];
    values[i] = beyond + 0.5 * own;
    beyond += own;
  }
}

/// Ritz' of those of a uniform bar, sin((k - ½) π x / L).
void BarStations::find_axial_modes(const std::vector<BarElement>& spans, int modes) {
  const Eigen::Index count = x.size();
  const double whole = spans.back().x + spans.back().length;
  stretch = Eigen::VectorXd::Zero(count);
  axial.resize(count + static_cast<Eigen::Index>(lumps.size()), modes);
  axial_squares.resize(modes);
  if (modes == 0) return;
  const auto at = [&](double place) {
    Eigen::VectorXd shapes(modes);
    for (int k = 0; k < modes; ++k)
      shapes[k] = std::sin((k + 0.5) * std::numbers::pi * place / whole);
    return shapes;
  };
  Eigen::MatrixXd inertia = Eigen::MatrixXd::Zero(modes, modes), stiffness = inertia;
  const auto add = [&](Eigen::Index row, double place, double share) {
    const Eigen::VectorXd shapes = at(place);
    axial.row(row) = shapes;
    inertia.selfadjointView<Eigen::Lower>().rankUpdate(shapes, share);
  };
  for (Eigen::Index i = 0; i < count; ++i) {
    const double axial_stiffness = spans[static_cast<std::size_t>(i)].axial_stiffness;
    stretch[i] = length[i] / axial_stiffness;
    add(i, middle(i), mass[i]);
    stiffness.selfadjointView<Eigen::Lower>().rankUpdate(at(x[i] + length[i]) - at(x[i]),
                                                         axial_stiffness / length[i]);
  }
  for (std::size_t l = 0; l < lumps.size(); ++l)
    add(count + static_cast<Eigen::Index>(l), place(lumps[l]), lumps[l].mass);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(stiffness, inertia);
  axial_squares = solver.eigenvalues();
  axial *= solver.eigenvectors();
}

void BarStations::scale(double of_stiffness, double of_mass) {
  const double root = std::sqrt(of_mass);
  slopes /= root;
  mass *= of_mass;
  for (Lump& lump : lumps) lump.mass *= of_mass;
  bending *= of_stiffness;
  weight *= of_stiffness;
  stretch /= of_stiffness;
  axial /= root;
  axial_squares *= of_stiffness / of_mass;
}

void BarStations::find_slopes(const Eigen::VectorXd& a, const Eigen::VectorXd& rate,
                              Slopes& to) const {
  to.slope.resize(slopes.rows());
  to.rate.resize(slopes.rows());
  models::find_slopes({.stations = static_cast<int>(slopes.rows()),
                       .modes = static_cast<int>(slopes.cols()),
                       .slopes = slopes.data(),
                       .a = a.data(),
                       .rate = rate.data(),
                       .slope = to.slope.data(),
                       .slope_rate = to.rate.data()});
}

double BarStations::shorten(const Slopes& of, Eigen::VectorXd& momentum) const {
  const auto count = static_cast<std::size_t>(of.slope.size());
  momentum.resize(of.slope.size());
  const std::span slope(of.slope.data(), count), rate(of.rate.data(), count);
  const std::span lengths(length.data(), count), masses(mass.data(), count);
  const std::span momenta(momentum.data(), count);
  double drawn = 0.0, energy = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double step = slope[i] * rate[i] * lengths[i];
    const double middle = drawn + 0.5 * step;
    momenta[i] = masses[i] * middle;
    energy += 0.5 * momenta[i] * middle;
    drawn += step;
  }
  for (const Lump& lump : lumps) {
    const auto station = static_cast<std::size_t>(lump.station);
    double speed = lump.part * slope[station] * rate[station] * lengths[station];
    for (std::size_t i = 0; i < station; ++i) speed += slope[i] * rate[i] * lengths[i];
    momenta[station] += lump.mass * speed;
    energy += 0.5 * lump.mass * speed * speed;
  }
  return energy;
}

}  // namespace impactrig::models
