// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/fit_search.hpp"

#include <algorithm>
#include <cmath>

#include "fitting/fit_end.hpp"

namespace impactrig::fitting {
namespace {

// The first pass looks no further than this many contact durations: what follows the first
// separation depends so strongly on the parameters that a fit from afar would run into a false
// minimum.
constexpr double first_window = 1.2;
// What may follow before the whole window is looked at, where that alone does not fit.
constexpr double growing_windows[] = {1.2, 1.7, 2.5, 4.0, 8.0};
// A first pass that ends with more than this reduced chi-square is started again from other places.
constexpr double poor_fit = 4.0;

}  // namespace

/// Searches from the present values within a window; returns the reduced chi-square reached.
double FitSearch::pass(const Search& how, double contacts) {
  problem_.choose_samples(contacts, how.rough, how.one_by_one);
  if (problem_.out_of_time()) {
    last_.converged = false;
    return whole;
  }
  last_ = problem_.search(how);
  iterations_ += last_.iterations;
  const double free = static_cast<double>(problem_.unknowns().size());
  return 2.0 * last_.cost / std::max(1.0, static_cast<double>(problem_.data_size()) - free);
}

/// Cauchy and Tukey take a peak that is far off for outliers: they search from near only.
void FitSearch::run() {
  problem_.set_loss(loss_from_afar(loss_));
  search_first_window();
  const std::vector<double> tried = problem_.values();
  double reached = pass(last_search, whole);
  if (reached > misfit) reached = try_again(reached, [&] { return search_finely(tried); });
  // where not even the first contact fits, looking on from contact to contact mends nothing
  if (reached > misfit && first_reached_ <= poor_fit)
    try_again(reached, [&] { return grow_window(); });
  if (problem_.loss() == loss_) return;
  problem_.set_loss(loss_);
  pass(last_search, whole);
}

/// By rough predictions; from other places too where that ends badly.
void FitSearch::search_first_window() {
  const double reached = pass(first_search, first_window);
  const bool several_starts = std::ranges::any_of(problem_.variables(), [](const Variable& v) {
    return v.name == "contact.restitution" || v.name == "contact.stiffness_factor";
  });
  if (reached > poor_fit && several_starts) search_from_elsewhere(reached);
}

/// Rough predictions may have led astray, a sensor's resonance most easily: with fine ones from the
/// start again, and from where rough searches ended best where they ended at several places.
double FitSearch::search_finely(const std::vector<double>& tried) {
  Search fine = first_search;
  fine.rough = false;
  problem_.set_initial_values();
  first_reached_ = pass(fine, first_window);
  if (several_ends_)
    first_reached_ = try_again(first_reached_, [&] {
      problem_.set_values(tried);
      return pass(fine, first_window);
    });
  return same_place(problem_.values(), tried) ? whole : pass(last_search, whole);
}

/// A false minimum may be the end of another way from the start: keeps what fits better.
template <typename Attempt>
double FitSearch::try_again(double reduced, const Attempt& attempt) {
  const std::vector<double> best = problem_.values();
  const SearchEnd end = last_;
  const double reached = attempt();
  if (reached < reduced) return reached;
  problem_.set_values(best);
  problem_.choose_samples(whole, false);
  last_ = end;
  return reduced;
}

/// Tries other restitutions and stiffnesses, and sensors other than stated where that is asked for,
/// and keeps the best end; two starts, far apart, where these lead to the same place.
void FitSearch::search_from_elsewhere(double reduced) {
  struct Start {
    double restitution, stiffness, sensor;
  };

  constexpr Start starts[] = {
      {0.25, 0.4, 0.8}, {0.8, 2.5, 1.25}, {0.25, 2.5, 1.25}, {0.8, 0.4, 0.8}};
  std::vector<double> best = problem_.values();
  int tried = 0;
  for (const auto& [restitution, stiffness, sensor] : starts) {
    if (reduced <= misfit || (tried++ == 2 && !several_ends_)) break;
    problem_.set_initial_values();
    std::vector<double> start = problem_.values();
    for (std::size_t i = 0; i < start.size(); ++i) {
      const Variable& v = problem_.variables()[i];
      if (v.name == "contact.restitution") start[i] = restitution;
      if (v.name == "contact.stiffness_factor") start[i] = stiffness * v.initial;
      if (v.chain) start[i] = sensor * v.initial;
    }
    problem_.set_values(start);
    const double reached = pass(first_search, first_window);
    several_ends_ = several_ends_ || !same_place(problem_.values(), best);
    if (reached >= reduced) continue;
    reduced = reached;
    best = problem_.values();
  }
  problem_.set_values(best);
}

/// Of the impact's own parameters and the sensors'.
bool FitSearch::same_place(const std::vector<double>& a, const std::vector<double>& b) const {
  constexpr double near = 0.02;
  for (const std::size_t i : problem_.unknowns()) {
    const Variable& v = problem_.variables()[i];
    if (!v.physics && !v.chain) continue;
    if (std::abs(a[i] - b[i]) > near * std::max(std::abs(a[i]), std::abs(b[i]))) return false;
  }
  return true;
}

/// The whole window at once may lead into a false minimum, where the model meets the stop a second
/// time too early or too late. Looks on from contact to contact.
double FitSearch::grow_window() {
  problem_.set_initial_values();
  for (const double contacts : growing_windows) pass(first_search, contacts);
  return pass(last_search, whole);
}

}  // namespace impactrig::fitting
