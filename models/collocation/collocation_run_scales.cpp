// SPDX-License-Identifier: BSD-3-Clause
//
// What the errors of a CollocationRun are compared with.
#include "models/collocation/collocation_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "models/beams/bar_element.hpp"
#include "models/beams/bending_modes.hpp"

namespace impactrig::models {
namespace {

// A first contact smaller than this part of its scales is to be solved again.
constexpr double smallest_part = 0.01;
// As slowest_part where the steps resolve all of the bar's vibration: their ends then err so little
// that this is below the accuracy anyway, but for what a law does that changes with the rate's
// sign, which nodes may miss. By this rule 194 contacts of hybrid bars that ended at 0.01 to 0.1 of
// their approach erred by 0.022 of the accuracy at most.
constexpr double slowest_resolved = 0.01;
// The energy of the first contact, as a multiple of what the bar first has to be stopped of.
constexpr double most_of_local = 30.0;
// Of the speed that the scales are made from.
constexpr double much_faster = 2.0;

/// What of the bar the contact first has to stop: in how long a time, and with which energy. A
/// short bar as a whole; of a long one, what moves with the struck point in that time. A point
/// force meets an infinite beam's impedance 2 √2 m' (EI / m')^¼ √ω [Cremer2005, 5.2].
struct Loading {
  double time;    ///< [s]
  double energy;  ///< [J]
};

Loading loading(const Rig& rig, const Solver& solver, const ContactPoint& point, double approach,
                double kinetic) {
  const ContactForce& contact = point.contact();
  const double depth = point.depth();
  const double whole = depth / approach;
  double time = whole;
  if (solver.model != BeamModel::rigid) {
    const std::vector<BarElement> pieces = bar_pieces(rig.beam);
    const BarElement& piece = pieces[element_at(pieces, point.position())];
    const double line_mass = piece.line_density;
    const double wave = std::pow(piece.bending_stiffness / line_mass, 0.25);
    const double stiffness = contact.elastic(depth) / depth;
    const double mass = 2.0 * std::numbers::sqrt2 * line_mass * wave;  // times √time
    time = std::min(time, std::pow(mass / stiffness, 2.0 / 3.0));
  }
  // strong damping presses with full force earlier
  return {time / (1.0 + contact.damping_share(approach, depth)),
          kinetic * std::pow(time / whole, 2)};
}

/// How far the bar can go beyond a stop with an energy [J]. It turns about its hinge no further
/// than the point is far from it, or bends; spring and weight may hold it before the contact does.
double farthest(const Rig& rig, const Solver& solver, const ContactPoint& point, double energy) {
  const double x = point.position();
  const double hold =
      rig.hinge.spring + std::max(rig.gravity_along(), 0.0) * rig.beam.first_moment();
  const double bends = solver.model == BeamModel::rigid ? 0.0 : clamped_compliance(rig.beam, x);
  return std::min(x, std::sqrt(2.0 * energy * (x * x / hold + bends)));
}

}  // namespace

/// How fast the straight bar's point before a stop moves when the struck point closes at approach_.
double CollocationRun::speed_before(const ContactPoint& point) const {
  return point.number() == 0 ? approach_ : approach_ * point.position() / rig_.contact.position;
}

void CollocationRun::set_scales() {
  constexpr double endless = std::numeric_limits<double>::infinity();
  BarMotion::Scales scales{.energy = endless, .contact_time = endless};
  held_ = false;
  for (ContactPoint& point : points_) {
    const double speed = speed_before(point);
    point.set_scales(energy_scale_, speed, farthest(rig_, solver_, point, energy_scale_),
                     solver_.accuracy);
    held_ = held_ || point.takes_little(energy_scale_);
    const Loading load = loading(rig_, solver_, point, speed, energy_scale_);
    point.set_local_energy(load.energy);
    scales.contact_time = std::min(scales.contact_time, load.time);
    scales.energy = std::min(scales.energy, load.energy);
    scales.damping =
        std::max(scales.damping, point.contact().damping_share(speed, point.depth()) / speed);
  }
  if (!std::isfinite(energy_scale_ + points_.front().force_scale()) || energy_scale_ <= 0.0 ||
      !(points_.front().depth() > 0.0))
    throw std::runtime_error(fmt::format(
        "an impact at {:g} m/s has an energy of {:g} J and would press with {:g} N: numbers out of "
        "all range; look at start, beam and contact",
        approach_, energy_scale_, points_.front().force_scale()));
  contact_time_ = scales.contact_time;
  // a bar that turns past its stop, or of which hardly more than the struck point is stopped
  const ContactPoint& first = points_.front();
  impulse_scale_ =
      2.0 / approach_ *
      std::min({energy_scale_, most_of_local * scales.energy, first.force_scale() * first.depth()});
  scales.force = first.force_scale();
  scales.impulse = impulse_scale_;
  bar_.set_scales(scales);
  // of a force that rises from none
  impulse_scale_ *= std::pow(share_of_contact(), 2);
}

/// Of the time of the first contact, what a run sees that is cut before.
double CollocationRun::share_of_contact() const {
  return std::min(1.0, solver_.duration.value_or(contact_time_) / contact_time_);
}

/// A bar that moves so much faster than at first touch, as after a long swing, that errors count by
/// what it does now: by the first contact's scales they would be made small without end. One that
/// is slower keeps the scales that are.
void CollocationRun::grow_scales() {
  if (result_.episodes.empty() || result_.episodes.front().open) return;
  const double kinetic = bar_.energy().kinetic;
  if (!(kinetic > much_faster * much_faster * energy_scale_)) return;
  smallness_ = smallness();
  approach_ *= std::sqrt(kinetic / energy_scale_);
  energy_scale_ = kinetic;
  set_scales();
  limit_steps();
}

void CollocationRun::limit_steps() {
  longest_ = std::min(100.0 * points_.front().depth() / approach_, bar_.ladder().longest);
}

double CollocationRun::smallness() const {
  if (smallness_) return *smallness_;
  if (result_.episodes.empty() || result_.episodes.front().open) return 1.0;
  const Episode& first = result_.episodes.front();
  double part = std::min(std::abs(first.impulse) / impulse_scale_,
                         first.peak_force / points_.front().force_scale());
  // of what pulling takes back, pushing may leave next to nothing
  const double pulled = -log_.lowest_force() * (first.end - first.start);
  if (pulled > 0.0) part = std::min(part, std::abs(first.impulse) / pulled);
  const double slow = std::abs(first.separation_velocity) / first.approach_velocity;
  const bool smooth = std::ranges::none_of(points_, [](const ContactPoint& point) {
    return point.contact().form() == DampingForm::closing;
  });
  // where it is smaller than what errors are compared with, its end errs by so much more
  const double end = slow * std::min(1.0, std::abs(first.impulse) / impulse_scale_);
  const double of_end = resolved_ && smooth && slow >= slowest_resolved ? 1.0 : end / slowest_part;
  return std::min({1.0, part / smallest_part, of_end});
}

}  // namespace impactrig::models
