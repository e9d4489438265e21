// SPDX-License-Identifier: BSD-3-Clause
#include "models/beams/bar_modes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "models/lanes/product_lanes.hpp"

namespace impactrig::models {
namespace {

using Values = Eigen::Matrix<double, BarElement::values, 1>;

/// A form of the values of an element's nodes and inside, in its own values.
BarElement::Matrix in_own_values(BarElement::Matrix form, double length) {
  form.col(0) += form.col(2);
  form.col(1) += length * form.col(2) + form.col(3);
  form.row(0) += form.row(2);
  form.row(1) += length * form.row(2) + form.row(3);
  return form;
}

/// Likewise of a load.
Values in_own_values(Values load, double length) {
  load[0] += load[2];
  load[1] += length * load[2] + load[3];
  return load;
}

void append_triangle(const BarElement::Matrix& form, int values, std::vector<double>& to) {
  for (int i = 0; i < values; ++i)
    for (int j = 0; j <= i; ++j) to.push_back(form(i, j));
}

/// What is between two ω² as frequencies of bending waves are: midway in their wave numbers; never
/// zero, as the slowest may be.
double between(double low, double high) {
  if (low <= 0.0) return high > 0.0 && low > -1e-3 * high ? 1e-3 * high : 0.4 * low + 0.6 * high;
  return std::pow(0.5 * (std::pow(low, 0.25) + std::pow(high, 0.25)), 4);
}

}  // namespace

BarModeFinder::BarModeFinder(const LinearBar& bar, bool clamped)
    : hangs_(bar.hangs()),
      negligible_weight_(bar.negligible_weight()) {
  const std::vector<LinearBar::Share> shares = bar.shares();
  bar_.elements = static_cast<int>(shares.size());
  bar_.values = bar.elements().front().shears() ? BarElement::values : 4;
  for (std::size_t e = 0; e < shares.size(); ++e) {
    const BarElement& element = bar.elements()[e];
    // a rigid motion bends nothing, and what moves across has no weight to lift
    BarElement::Matrix elastic = BarElement::Matrix::Zero();
    elastic.bottomRightCorner<5, 5>() = shares[e].stiffness.bottomRightCorner<5, 5>();
    BarElement::Matrix weight = in_own_values(shares[e].gravity, element.length);
    weight.row(0).setZero();
    weight.col(0).setZero();
    length_.push_back(element.length);
    append_triangle(elastic + weight, bar_.values, stiffness_);
    append_triangle(weight, bar_.values, weight_);
    append_triangle(in_own_values(shares[e].mass, element.length), bar_.values, mass_);
    wave_number_.push_back(element.wave_number());
    wave_.push_back((wave_.empty() ? 0.0 : wave_.back()) + element.length * wave_number_.back());
  }
  bar_.length = length_.data();
  bar_.wave = wave_.data();
  bar_.wave_number = wave_number_.data();
  bar_.stiffness = stiffness_.data();
  bar_.mass = mass_.data();
  bar_.spring = bar.spring();
  bar_.clamped = clamped;
  work_.reset(new double[static_cast<std::size_t>(bar_work(bar_))]);
}

BarModeFinder::Form BarModeFinder::form(const std::vector<double>& triangles, int element) const {
  Form form = Form::Zero();
  const double* number = triangles.data() + element * bar_.numbers();
  for (int i = 0; i < bar_.values; ++i)
    for (int j = 0; j <= i; ++j) form(i, j) = form(j, i) = *number++;
  return form;
}

/// Of an element (m, v).
void BarModeFinder::find_values(const Rows& rows, int element, Eigen::MatrixXd& values) const {
  const int each = bar_.values - 2, after = 1 + element * each;
  values.resize(rows.rows(), bar_.values);
  if (element > 0)
    values.leftCols(2) = rows.middleCols(after - each, 2);
  else
    values.leftCols(2) << Eigen::VectorXd::Zero(rows.rows()), rows.col(0);
  values.col(2) =
      rows.col(after) - values.col(0) - length_[static_cast<std::size_t>(element)] * values.col(1);
  values.col(3) = rows.col(after + 1) - values.col(1);
  values.rightCols(each - 2) = rows.middleCols(after + 2, each - 2);
}

void BarModeFinder::count(std::vector<double> at) {
  std::ranges::sort(at);
  at.erase(std::unique(at.begin(), at.end()), at.end());
  std::vector<double> below(at.size());
  count_modes_below({.bar = &bar_,
                     .shifts = static_cast<int>(at.size()),
                     .shift = at.data(),
                     .below = below.data()});
  for (std::size_t i = 0; i < at.size(); ++i)
    fences_.push_back({at[i], static_cast<int>(std::lround(below[i]))});
  std::ranges::sort(fences_, {}, &Fence::at);
}

std::optional<BarModeFinder::Fence> BarModeFinder::fence_below(int mode) const {
  const auto after = std::ranges::upper_bound(fences_, mode, {}, &Fence::below);
  return after == fences_.begin() ? std::nullopt : std::optional(*(after - 1));
}

std::optional<BarModeFinder::Fence> BarModeFinder::fence_above(int mode) const {
  const auto after = std::ranges::upper_bound(fences_, mode, {}, &Fence::below);
  return after == fences_.end() ? std::nullopt : std::optional(*after);
}

/// Where another would help to part a mode from the others; none when it is alone.
std::optional<double> BarModeFinder::next_fence(int mode) const {
  const std::optional<Fence> low = fence_below(mode), high = fence_above(mode);
  if (!low) return -4.0 * std::abs(fences_.front().at);
  if (!high) return 4.0 * std::abs(fences_.back().at);
  if (low->below == mode && high->below == mode + 1) return std::nullopt;
  return between(low->at, high->at);
}

/// By the waves that a bar alike everywhere has between hinge and tip, then by bisection; false
/// where two modes are so close that it would not end.
bool BarModeFinder::fence_off(int known, int modes) {
  constexpr int most_rounds = 120;
  constexpr double closest = 1e-9;
  std::vector<double> guesses;
  for (int k = known; k < modes; ++k)
    guesses.push_back(std::pow((k + 0.75) * std::numbers::pi / wave_.back(), 4));
  if (known == 0) guesses.push_back(-guesses.front());
  count(std::move(guesses));
  for (int round = 0; round < most_rounds; ++round) {
    std::vector<double> next;
    for (int k = known; k < modes; ++k) {
      const std::optional<double> at = next_fence(k);
      if (!at) continue;
      const std::optional<Fence> low = fence_below(k), high = fence_above(k);
      if (low && high && high->at - low->at < closest * std::abs(high->at)) return false;
      next.push_back(*at);
    }
    if (next.empty()) return true;
    count(std::move(next));
  }
  return false;
}

std::optional<BarModes> BarModeFinder::all() {
  std::optional<BarModes> modes = find(most(), 0, nullptr);
  if (modes) find_rotation(*modes);
  return modes;
}

std::optional<BarModes> BarModeFinder::slowest(int count, const std::vector<LinearBar::Row>& points,
                                               const BarModes* fewer) {
  const auto more = static_cast<int>(points.size());
  if (count + more >= most()) return all();
  std::optional<BarModes> modes = find(count, more, fewer);
  if (!modes) return modes;
  if (!points.empty()) stand_in(*modes, points);
  find_rotation(*modes);
  return modes;
}

/// With room for more rows.
std::optional<BarModes> BarModeFinder::find(int modes, int more, const BarModes* fewer) {
  const int known = fewer ? std::min(fewer->own, modes) : 0;
  if (!fence_off(known, modes)) return std::nullopt;
  const int stride = modes + more;
  BarModes found{.squares = Eigen::VectorXd(stride),
                 .rows = Eigen::MatrixXd(stride, size()),
                 .own = modes,
                 .left_out = {},
                 .weight = {},
                 .hinge = {},
                 .rigid = {}};
  if (known > 0) {
    found.squares.head(known) = fewer->squares.head(known);
    found.rows.topRows(known) = fewer->rows.topRows(known);
  }
  const int sought = modes - known;
  std::vector<double> index, above, start, below, converged(static_cast<std::size_t>(sought));
  for (int k = known; k < modes; ++k) {
    index.push_back(k);
    above.push_back(fence_below(k)->at);
    below.push_back(fence_above(k)->at);
    start.push_back(between(above.back(), below.back()));
  }
  find_modes_between({.bar = &bar_,
                      .modes = sought,
                      .index = index.data(),
                      .above = above.data(),
                      .start = start.data(),
                      .below = below.data(),
                      .work = work_.get(),
                      .square = found.squares.data() + known,
                      .converged = converged.data(),
                      .turn = found.rows.data() + known,
                      .shape = found.rows.data() + known + stride,
                      .stride = stride});
  if (std::ranges::count(converged, 0.0) > 0) return std::nullopt;
  if (hangs_) find_weight(found);
  return found;
}

/// In all rows (m, m).
Eigen::MatrixXd BarModeFinder::form_of(const std::vector<double>& triangles,
                                       const Rows& rows) const {
  constexpr int at_once = 16;  // elements: the forces of hundreds of rows stay in the second cache
  const Eigen::Index count = rows.rows(), each = bar_.values;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(count, count), values, forces, across;
  for (int first = 0; first < bar_.elements; first += at_once) {
    const int elements = std::min(at_once, bar_.elements - first);
    forces.resize(count, elements * each);
    across.resize(elements * each, count);
    for (int k = 0; k < elements; ++k) {
      find_values(rows, first + k, values);
      forces.middleCols(k * each, each) =
          values.lazyProduct(form(triangles, first + k).topLeftCorner(each, each));
      across.middleRows(k * each, each) = values.transpose();
    }
    add_product(forces, across, sum);
  }
  return sum;
}

/// How many of the modes up to the last whose ω² the weight changes by more than what is
/// negligible.
int BarModeFinder::moved_by_weight(const Rows& rows,
                                   const Eigen::Ref<const Eigen::VectorXd>& squares) const {
  Eigen::ArrayXd own = Eigen::ArrayXd::Zero(rows.rows());
  Eigen::MatrixXd values;
  for (int e = 0; e < bar_.elements; ++e) {
    find_values(rows, e, values);
    const Form pull = form(weight_, e);
    for (int i = 1; i < bar_.values; ++i) {  // none moves across
      own += pull(i, i) * values.col(i).array().square();
      for (int j = 1; j < i; ++j)
        own += 2.0 * pull(i, j) * values.col(i).array() * values.col(j).array();
    }
  }
  auto moved = static_cast<int>(rows.rows());
  while (moved > 0 && std::abs(own[moved - 1]) < negligible_weight_ * squares[moved - 1]) --moved;
  return moved;
}

/// The faster a mode, the less it is moved: where none of many in a row is, none is beyond.
void BarModeFinder::find_weight(BarModes& modes) const {
  constexpr int many = 32;
  int held = 0;
  for (int first = 0; first < modes.own; first += many) {
    const int count = std::min(many, modes.own - first);
    const int moved =
        moved_by_weight(modes.rows.middleRows(first, count), modes.squares.segment(first, count));
    if (moved == 0) break;
    held = first + moved;
  }
  modes.weight = form_of(weight_, modes.rows.topRows(held));
}

/// Inertia of motions, in the same rows: of each element in its own values, of which the part that
/// e meets is that of its right end, and the rest the left one's.
Eigen::MatrixXd BarModeFinder::inertia_of(const Rows& rows) const {
  const int each = bar_.values - 2;
  Eigen::MatrixXd inertia = Eigen::MatrixXd::Zero(rows.rows(), size()), values, own;
  for (int e = 0; e < bar_.elements; ++e) {
    const double length = length_[static_cast<std::size_t>(e)];
    find_values(rows, e, values);
    own = values.lazyProduct(form(mass_, e).topLeftCorner(bar_.values, bar_.values));
    const int after = 1 + e * each;
    if (e > 0) inertia.col(after - each) += own.col(0) - own.col(2);
    inertia.col(e > 0 ? after - each + 1 : 0) += own.col(1) - length * own.col(2) - own.col(3);
    inertia.middleCols(after, each) += own.rightCols(each);
  }
  return inertia;
}

void BarModeFinder::find_rotation(BarModes& modes) const {
  const int each = bar_.values - 2;
  Eigen::RowVectorXd rigid = Eigen::RowVectorXd::Zero(size());
  rigid[0] = -1.0;
  double x = 0.0;
  for (int e = 0; e < bar_.elements; ++e) {
    x += length_[static_cast<std::size_t>(e)];
    rigid.segment<2>(1 + e * each) << -x, -1.0;
  }
  modes.hinge = -modes.rows.col(0);
  modes.rigid.noalias() = modes.rows * inertia_of(rigid).transpose();
}

/// (K + G − σ M)⁻¹ of loads in the elements' own values, one a row.
Eigen::MatrixXd BarModeFinder::give_way(const Eigen::MatrixXd& loads, double shift) {
  const auto count = static_cast<int>(loads.rows());
  Eigen::MatrixXd rows(count, size());
  find_motion_under({.bar = &bar_,
                     .loads = count,
                     .shift = shift,
                     .load = loads.data(),
                     .work = work_.get(),
                     .turn = rows.data(),
                     .motion = rows.data() + count,
                     .stride = count});
  return rows;
}

/// The loads without what moves the modes bend the bar by what the modes leave out; by a shift as
/// far below zero as the slowest bending mode is above, so that a bar that turns freely or would
/// fall over gives way too. That errs by the ratio of the slowest and the first left out, squared.
void BarModeFinder::stand_in(BarModes& modes, const std::vector<LinearBar::Row>& points) {
  constexpr double same = 1e-8, faster = 2.0;
  const auto count = static_cast<Eigen::Index>(points.size());
  const double shift = -modes.squares.head(std::min(2, modes.own)).cwiseAbs().sum();
  const auto own_rows = modes.rows.topRows(modes.own);
  Eigen::MatrixXd loads = Eigen::MatrixXd::Zero(count, bar_.elements * bar_.values);
  Eigen::MatrixXd shares(count, modes.own), values;
  for (Eigen::Index i = 0; i < count; ++i) {
    const LinearBar::Row& point = points[static_cast<std::size_t>(i)];
    const double length = length_[static_cast<std::size_t>(point.element)];
    const Eigen::VectorXd load = in_own_values(point.values, length).head(bar_.values);
    loads.block(i, point.element * bar_.values, 1, bar_.values) = load.transpose();
    find_values(own_rows, point.element, values);
    shares.row(i) = (values * load).transpose();
  }
  const Eigen::MatrixXd in_modes = shares * own_rows;
  for (int e = 0; e < bar_.elements; ++e) {
    find_values(in_modes, e, values);
    loads.middleCols(e * bar_.values, bar_.values) -=
        values.lazyProduct(form(mass_, e).topLeftCorner(bar_.values, bar_.values));
  }
  Eigen::MatrixXd left = give_way(loads, shift);
  const Eigen::MatrixXd rounding = inertia_of(left) * own_rows.transpose();
  left.noalias() -= rounding * own_rows;

  const Eigen::MatrixXd mass = form_of(mass_, left);
  const Eigen::VectorXd scale =
      (mass.diagonal().array() > 0.0).select(mass.diagonal().array().rsqrt(), 0.0).matrix();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> apart(scale.asDiagonal() * mass *
                                                             scale.asDiagonal());
  const Eigen::Index kept = (apart.eigenvalues().array() > same).count();
  const Eigen::MatrixXd turn =
      scale.asDiagonal() * apart.eigenvectors().rightCols(kept) *
      apart.eigenvalues().tail(kept).cwiseSqrt().cwiseInverse().asDiagonal();
  const Eigen::MatrixXd stiffness =
      form_of(stiffness_, left) + bar_.spring * left.col(0) * left.col(0).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> stiff(turn.transpose() * stiffness * turn);
  const double fastest = faster * faster * modes.squares[modes.own - 1];
  const Eigen::VectorXd slowed = (fastest / stiff.eigenvalues().array()).min(1.0).sqrt();
  modes.squares.conservativeResize(modes.own + kept);
  modes.squares.tail(kept) = stiff.eigenvalues().cwiseMin(fastest);
  modes.left_out = stiff.eigenvalues();
  if (kept < count) modes.rows.conservativeResize(modes.own + kept, Eigen::NoChange);
  modes.rows.bottomRows(kept) =
      slowed.asDiagonal() * (turn * stiff.eigenvectors()).transpose() * left;
}

}  // namespace impactrig::models
