// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "fitting/fit_problem.hpp"

namespace impactrig::fitting {

/// The way of a fit from its start to the end: by rough predictions of the first contact first,
/// then over the whole window; from other places, or from contact to contact, where that ends
/// badly; without later contacts where these do not fit at all.
class FitSearch {
 public:
  /// `window_stated`: it is fitted to its end, whatever that gives. The problem must live as long.
  FitSearch(FitProblem& problem, Loss loss, bool window_stated)
      : problem_(problem),
        loss_(loss),
        may_end_early_(!window_stated && loss == Loss::squares) {}

  void run();

  /// From the present values over the whole window; where that fits, beside its touch, but no other
  /// way.
  void search_near();

  /// Once more from the present values, over the whole window, by other predictions than before.
  void finish();

  /// Where the search ended that the present values are from.
  const SearchEnd& end() const { return last_; }

  int iterations() const { return iterations_; }  ///< of all searches

  /// A window that ends before the second contact.
  struct EarlyEnd {
    double window;                ///< after first touch [s]
    std::optional<double> whole;  ///< reduced chi-square with what follows, where that was tried
    double early;                 ///< without
  };

  /// Where that was chosen.
  const std::optional<EarlyEnd>& early_end() const { return early_end_; }

 private:
  static constexpr double whole = std::numeric_limits<double>::infinity();

  struct Start;
  static const Start other_starts[4];

  double pass(const Search& how, double contacts);
  void search_whole_window();
  double search_first_window();
  double search_with_touch_scanned();
  double grow_first_window();
  void search_first_window_finely(const std::vector<double>& tried);
  double search_from_elsewhere(double reduced);
  double search_from_everywhere();
  bool is_of_displacement_alone() const;
  std::vector<double> start_of(const Start& elsewhere);
  bool several_starts() const;
  double search_finely(const std::vector<double>& tried);
  double grow_window();
  void leave_later_contacts_out(double reached);
  double degrees_of_freedom() const;
  double reduced(const SearchEnd& end) const;
  bool force_jumps(const Shot& shot) const;
  bool moves_touch(std::size_t touch, double by);
  std::array<double, 2> to_neighbours(std::size_t touch) const;
  void look_beside_touch();
  bool end_before_second_contact();
  double time_of_second_contact();
  bool same_place(const std::vector<double>& a, const std::vector<double>& b) const;
  template <typename Attempt>
  double try_again(double reduced, const Attempt& attempt);

  FitProblem& problem_;
  Loss loss_;
  bool may_end_early_;
  SearchEnd last_;
  int iterations_ = 0;
  bool several_ends_ = false;      // of searches in the first window from different starts
  double first_reached_ = whole;   // there, by predictions that are not rough
  std::vector<double> first_end_;  // likewise, where
  std::optional<EarlyEnd> early_end_;
};

}  // namespace impactrig::fitting
