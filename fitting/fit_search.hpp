// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <vector>

#include "fitting/fit_problem.hpp"

namespace impactrig::fitting {

/// The way of a fit from its start to the end: by rough predictions of the first contact first,
/// then over the whole window; from other places, or from contact to contact, where that ends
/// badly.
class FitSearch {
 public:
  /// The problem must live as long.
  FitSearch(FitProblem& problem, Loss loss) : problem_(problem), loss_(loss) {}

  void run();

  /// Once more from the present values, over the whole window.
  void finish() { pass(last_search, whole); }

  /// Where the search ended that the present values are from.
  const SearchEnd& end() const { return last_; }

  int iterations() const { return iterations_; }  ///< of all searches

 private:
  static constexpr double whole = std::numeric_limits<double>::infinity();

  double pass(const Search& how, double contacts);
  void search_first_window();
  void search_from_elsewhere(double reduced);
  double search_finely(const std::vector<double>& tried);
  double grow_window();
  bool same_place(const std::vector<double>& a, const std::vector<double>& b) const;
  template <typename Attempt>
  double try_again(double reduced, const Attempt& attempt);

  FitProblem& problem_;
  Loss loss_;
  SearchEnd last_;
  int iterations_ = 0;
  bool several_ends_ = false;     // of searches in the first window from different starts
  double first_reached_ = whole;  // there, by predictions that are not rough
};

}  // namespace impactrig::fitting
