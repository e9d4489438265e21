// SPDX-License-Identifier: BSD-3-Clause
#include "models/implicit/ancf_chain.hpp"

#include "models/integration/gauss.hpp"

namespace impactrig::models {
namespace {

/// Coordinate of one direction of an AncfBeam, or -1 for the hinge's position.
int beam_dof(int node, int part) {
  return node == 0 ? part - 1 : 2 * node - 1 + part;
}

}  // namespace

AncfChain::AncfChain(const AncfBeam& beam)
    : elements_(beam.elements()),
      hinge_(beam.hinge()),
      damping_(beam.damping()),
      mass_(elements_.size() + 1),
      inertia_(Eigen::ArrayXd::Zero(4 * static_cast<int>(elements_.size() + 1))),
      weight_force_(inertia_) {
  const GaussRule& rule = gauss_legendre(5);
  for (std::size_t g = 0; g < 5; ++g) {
    const double xi = rule.points[g];
    const double s = xi * xi;
    gauss_[g] = {.chord = 6.0 * (xi - s),
                 .first = 1.0 - 4.0 * xi + 3.0 * s,
                 .second = 3.0 * s - 2.0 * xi,
                 .bend_chord = 6.0 - 12.0 * xi,
                 .bend_first = 6.0 * xi - 4.0,
                 .bend_second = 6.0 * xi - 2.0,
                 .weight = rule.weights[g]};
  }
  const auto entry = [&](int node_r, int part_r, int node_c, int part_c) {
    const int row = beam_dof(node_r, part_r);
    const int column = beam_dof(node_c, part_c);
    return row < 0 || column < 0 ? 0.0 : beam.mass().at(row, column);
  };
  for (int i = 0; i < nodes(); ++i) {
    const auto node = static_cast<std::size_t>(i);
    for (int direction = 0; direction < 4; direction += 2)
      for (int r = 0; r < 2; ++r) {
        for (int c = 0; c < 2; ++c) {
          mass_.diagonal[node](direction + r, direction + c) = entry(i, r, i, c);
          if (i + 1 < nodes())
            mass_.next[node](direction + r, direction + c) = entry(i, r, i + 1, c);
        }
        inertia_[4 * i + direction + r] = entry(i, r, i, r);
      }
  }
  from_beam(beam.weight_force(), weight_force_);
  // what is held has a mass of its own and no force, so that it stays
  mass_.diagonal[0](0, 0) = mass_.diagonal[0](2, 2) = 1.0;
  for (const BarElement& element : elements_)
    element_numbers_.push_back({.over_length = 1.0 / element.length,
                                .stretching = element.axial_stiffness * element.length,
                                .bending = element.bending_stiffness / element.length});
  for (int i = 0; i < nodes(); ++i) {
    const auto node = static_cast<std::size_t>(i);
    AncfNode& numbers = node_numbers_.emplace_back();
    for (int d = 0; d < 2; ++d)
      for (int r = 0; r < 2; ++r)
        for (int c = 0; c < 2; ++c) {
          numbers.own[d][r][c] = mass_.diagonal[node](2 * d + r, 2 * d + c);
          if (i + 1 < nodes()) numbers.next[d][r][c] = mass_.next[node](2 * d + r, 2 * d + c);
        }
    for (int c = 0; c < 4; ++c) numbers.weight[c] = weight_force_[4 * i + c];
  }
  for (std::size_t g = 0; g < 5; ++g)
    gauss_numbers_[g] = {gauss_[g].chord, gauss_[g].first, gauss_[g].second, gauss_[g].weight};
}

BeamEnergy AncfChain::energy(const Eigen::ArrayXd& q, const Eigen::ArrayXd& v) const {
  BeamEnergy energy;
  energy.gravitational = -(weight_force_ * q).sum();
  if (hinge_.spring > 0.0) {
    const double angle = hinge_angle<double>(q[1], q[3]).angle;
    energy.spring = 0.5 * hinge_.spring * angle * angle;
  }
  for (int i = 0; i < nodes(); ++i) {
    const Eigen::Matrix4d& own = mass_.diagonal[static_cast<std::size_t>(i)];
    const Eigen::Vector4d rate = v.segment<4>(4 * i).matrix();
    energy.kinetic += 0.5 * rate.dot(own * rate);
    if (i + 1 < nodes()) {
      const Eigen::Vector4d next = v.segment<4>(4 * i + 4).matrix();
      energy.kinetic += rate.dot(mass_.next[static_cast<std::size_t>(i)] * next);
    }
  }
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const auto p = q.segment<8>(4 * static_cast<Eigen::Index>(e));
    const double l = elements_[e].length;
    const double chord_x = (p[4] - p[0]) / l, chord_u = (p[6] - p[2]) / l;
    const auto bending = [](double first, double second) {
      return first * first + first * second + second * second;
    };
    energy.elastic +=
        2.0 * elements_[e].bending_stiffness / l *
        (bending(p[1] - chord_x, p[5] - chord_x) + bending(p[3] - chord_u, p[7] - chord_u));
    for (const GaussPoint& g : gauss_) {
      const double slope_x = g.chord * chord_x + g.first * p[1] + g.second * p[5];
      const double slope_u = g.chord * chord_u + g.first * p[3] + g.second * p[7];
      const double strain = 0.5 * (slope_x * slope_x + slope_u * slope_u) - slope_u;
      energy.elastic += 0.5 * elements_[e].axial_stiffness * l * g.weight * strain * strain;
    }
  }
  return energy;
}

void AncfChain::stiffness(const Eigen::ArrayXd& q, ChainMatrix& k) const {
  k.set_zero();
  using Matrix8 = Eigen::Matrix<double, 8, 8>;
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const Eigen::Matrix<double, 8, 1> p = q.segment<8>(4 * static_cast<Eigen::Index>(e)).matrix();
    const double l = elements_[e].length;
    const double bending = elements_[e].bending_stiffness / (l * l * l);
    Eigen::Matrix4d own;
    own << 12.0, 6.0 * l, -12.0, 6.0 * l,             //
        6.0 * l, 4.0 * l * l, -6.0 * l, 2.0 * l * l,  //
        -12.0, -6.0 * l, 12.0, -6.0 * l,              //
        6.0 * l, 2.0 * l * l, -6.0 * l, 4.0 * l * l;
    Eigen::Matrix4d xx = bending * own, uu = xx, xu = Eigen::Matrix4d::Zero();
    for (const GaussPoint& g : gauss_) {
      const Eigen::Vector4d s(-g.chord / l, g.first, g.chord / l, g.second);
      const double slope_x = s[0] * p[0] + s[1] * p[1] + s[2] * p[4] + s[3] * p[5];
      const double slope_u = s[0] * p[2] + s[1] * p[3] + s[2] * p[6] + s[3] * p[7];
      const double strain = 0.5 * (slope_x * slope_x + slope_u * slope_u) - slope_u;
      const Eigen::Matrix4d product =
          (elements_[e].axial_stiffness * l * g.weight) * s * s.transpose();
      xx += (slope_x * slope_x + strain) * product;
      xu += slope_x * (slope_u - 1.0) * product;
      uu += ((slope_u - 1.0) * (slope_u - 1.0) + strain) * product;
    }
    Matrix8 whole;  // ordered as the chain
    constexpr std::array<int, 4> x = {0, 1, 4, 5}, u = {2, 3, 6, 7};
    for (int r = 0; r < 4; ++r)
      for (int c = 0; c < 4; ++c) {
        const auto row = static_cast<std::size_t>(r);
        const auto column = static_cast<std::size_t>(c);
        whole(x[row], x[column]) = xx(r, c);
        whole(u[row], u[column]) = uu(r, c);
        whole(x[row], u[column]) = xu(r, c);
        whole(u[column], x[row]) = xu(r, c);
      }
    k.diagonal[e] += whole.topLeftCorner<4, 4>();
    k.diagonal[e + 1] += whole.bottomRightCorner<4, 4>();
    k.next[e] = whole.topRightCorner<4, 4>();
  }
  for (const int held : {0, 2}) {
    k.diagonal[0].row(held).setZero();
    k.diagonal[0].col(held).setZero();
    k.next[0].row(held).setZero();
  }
}

Eigen::Matrix4d AncfChain::hinge_block(const Eigen::ArrayXd& q, double coefficient) const {
  const auto hinge = hinge_angle<double>(q[1], q[3]);
  const Eigen::Vector4d by(0.0, hinge.by_across, 0.0, hinge.by_along);
  return coefficient * by * by.transpose();
}

std::array<ChainShare, 4> AncfChain::shares_of(const AncfBeam::Row& row) {
  std::array<ChainShare, 4> shares;
  for (int i = 0; i < 4; ++i)
    shares[static_cast<std::size_t>(i)] = {stride * (static_cast<int>(row.element) + i / 2) + i % 2,
                                           row.shape[i]};
  return shares;
}

void AncfChain::to_beam(const Eigen::ArrayXd& chain, Eigen::VectorXd& beam) const {
  const int dofs = 2 * nodes() - 1;
  beam.resize(2 * dofs);
  for (int i = 0; i < nodes(); ++i)
    for (int part = 0; part < 2; ++part) {
      const int dof = beam_dof(i, part);
      if (dof < 0) continue;
      beam[dof] = chain[4 * i + part];
      beam[dofs + dof] = chain[4 * i + 2 + part];
    }
}

void AncfChain::from_beam(const Eigen::VectorXd& beam, Eigen::ArrayXd& chain) const {
  const int dofs = 2 * nodes() - 1;
  chain.setZero(coordinates());
  for (int i = 0; i < nodes(); ++i)
    for (int part = 0; part < 2; ++part) {
      const int dof = beam_dof(i, part);
      if (dof < 0) continue;
      chain[4 * i + part] = beam[dof];
      chain[4 * i + 2 + part] = beam[dofs + dof];
    }
}

}  // namespace impactrig::models
