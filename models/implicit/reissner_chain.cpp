// SPDX-License-Identifier: BSD-3-Clause
#include "models/implicit/reissner_chain.hpp"

namespace impactrig::models {

ReissnerChain::ReissnerChain(const ReissnerBeam& beam)
    : elements_(beam.elements()),
      hinge_(beam.hinge()),
      damping_(beam.damping()),
      masses_(beam.masses()),
      inertia_(Eigen::ArrayXd::Zero(coordinates())),
      weight_force_(inertia_) {
  for (const int place : {Element::x0, Element::u0}) {
    masses_[0].row(place).setZero();
    masses_[0].col(place).setZero();
  }
  for (int e = 0; e < elements(); ++e)
    inertia_.segment<Element::values>(stride * e) +=
        masses_[static_cast<std::size_t>(e)].diagonal().array();
  from_beam(beam.weight_force(), weight_force_);
  // what is held has a mass of its own and no force, so that it stays
  for (const int place : {Element::x0, Element::u0}) masses_[0](place, place) = 1.0;
}

BeamEnergy ReissnerChain::energy(const Eigen::ArrayXd& q, const Eigen::ArrayXd& v) const {
  BeamEnergy energy;
  energy.gravitational = -(weight_force_ * q).sum();
  energy.spring = 0.5 * hinge_.spring * q[Element::turn0] * q[Element::turn0];
  for (int e = 0; e < elements(); ++e) {
    const auto number = static_cast<std::size_t>(e);
    const Element::Vector rates = v.segment<Element::values>(stride * e).matrix();
    energy.kinetic += 0.5 * rates.dot(masses_[number] * rates);
    Element::Values<double> p;
    Element::Vector::Map(p.data()) = q.segment<Element::values>(stride * e).matrix();
    energy.elastic += elements_[number].elastic_energy(p);
  }
  return energy;
}

void ReissnerChain::renew(const Eigen::ArrayXd& q, Tangent& tangent) const {
  for (int e = 0; e < elements(); ++e) {
    const auto number = static_cast<std::size_t>(e);
    Element::Values<double> p;
    Element::Vector::Map(p.data()) = q.segment<Element::values>(stride * e).matrix();
    tangent[number] = elements_[number].stiffness(p);
  }
  for (const int place : {Element::x0, Element::u0}) {
    tangent[0].row(place).setZero();
    tangent[0].col(place).setZero();
  }
}

std::array<ChainShare, 4> ReissnerChain::shares_of(const ReissnerBeam::Row& row) {
  std::array<ChainShare, 4> shares;
  std::size_t i = 0;
  for (const int place : {Element::x0, Element::xa, Element::xc, Element::x1})
    shares[i++] = {stride * static_cast<int>(row.element) + place, row.shape[place]};
  return shares;
}

void ReissnerChain::to_beam(const Eigen::ArrayXd& chain, Eigen::VectorXd& beam) const {
  beam = chain.tail(coordinates() - ReissnerBeam::held).matrix();
}

void ReissnerChain::from_beam(const Eigen::VectorXd& beam, Eigen::ArrayXd& chain) const {
  chain.setZero(coordinates());
  chain.tail(beam.size()) = beam.array();
}

}  // namespace impactrig::models
