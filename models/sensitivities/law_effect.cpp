// SPDX-License-Identifier: BSD-3-Clause
#include "models/sensitivities/law_effect.hpp"

namespace impactrig::models {
namespace {

double gap_of(const Rig& rig, int stop) {
  return stop == 0 ? 0.0 : rig.further_stops[static_cast<std::size_t>(stop - 1)].gap;
}

}  // namespace

LawEffect::LawEffect(const Rig& rig, int stop, const ParameterStencil& by)
    : by_(by),
      gap_(by.slope([&](std::size_t place) { return gap_of(by.rig_at(place), stop); })),
      factor_(rig.contact_of(stop).stiffness_factor) {
  if (!ContactForce(by.rig_beside(), stop).differs(ContactForce(rig, stop))) return;
  for (std::size_t place = 0; place < ParameterStencil::places; ++place)
    contacts_.emplace_back(by.rig_at(place), stop);
  Rig copy = rig;
  const DampingForm form = contacts_.front().form();
  const bool strength_apart =
      form == DampingForm::proportional || form == DampingForm::implicit;  // of the stiffness
  const bool is_factor = &by.number(copy) == &copy.contact_of(stop).stiffness_factor;
  if (contacts_.front().differs_by_strength(contacts_.back()))
    change_ = Change::by_strength;
  else
    change_ = strength_apart && is_factor ? Change::by_factor : Change::otherwise;
}

/// Of what is told of the contact at each place.
template <typename Function>
double LawEffect::slope(const Function& of_contact) const {
  if (change_ == Change::none) return 0.0;
  return by_.slope([&](std::size_t place) { return of_contact(contacts_[place]); });
}

void LawEffect::begin_episode(double law_speed) {
  for (ContactForce& contact : contacts_) contact.begin_episode(law_speed);
  if (change_ == Change::by_strength)
    strength_ = slope([](const ContactForce& contact) { return contact.strength(); });
}

void LawEffect::set_phase(ContactForce::Phase phase) {
  for (ContactForce& contact : contacts_) contact.set_phase(phase);
}

double LawEffect::of_force(double depth, double rate, const ContactForce::Response& law) const {
  if (change_ == Change::by_strength) return law.to_strength * strength_;
  if (change_ == Change::by_factor) return law.force / factor_;
  return slope([&](const ContactForce& contact) { return contact.pressed(depth, rate).force; });
}

double LawEffect::of_switching(double depth, double rate) const {
  return slope([&](const ContactForce& contact) { return contact.switching(depth, rate).value; });
}

double LawEffect::of_dissipation(double depth, double rate) const {
  return slope([&](const ContactForce& contact) { return contact.dissipation(depth, rate); });
}

double LawEffect::of_stored(double depth) const {
  return slope([&](const ContactForce& contact) { return contact.stored(depth); });
}

}  // namespace impactrig::models
