// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/fit_search.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "fitting/all_cores.hpp"
#include "fitting/fit_end.hpp"
#include "fitting/motion_choice.hpp"
#include "fitting/touch_scan.hpp"

namespace impactrig::fitting {
namespace {

// The first pass looks no further than this many contact durations: what follows the first
// separation depends so strongly on the parameters that a fit from afar would run into a false
// minimum.
constexpr double first_window = 1.2;
// Where that ends badly it begins with this part of the contact.
constexpr double first_part = 0.15;
// By how much the window grows from look to look where the whole of it at once does not fit, until
// it is whole: eight contacts may follow each other within thirty times the first one's duration.
constexpr double growth = 1.5;
constexpr Search fine_search = [] {
  Search search = first_search;
  search.rough = false;
  return search;
}();
// A first pass that ends with more than this reduced chi-square is started again from other places.
constexpr double poor_fit = 4.0;

}  // namespace

struct FitSearch::Start {
  double restitution;
  double stiffness, sensor;  // of where the search begins
};

const FitSearch::Start FitSearch::other_starts[4] = {
    {0.25, 0.4, 0.8}, {0.8, 2.5, 1.25}, {0.25, 2.5, 1.25}, {0.8, 0.4, 0.8}};

/// Searches from the present values within a window; returns the reduced chi-square reached.
double FitSearch::pass(const Search& how, double contacts) {
  problem_.choose_samples(contacts, how.rough, how.one_by_one);
  if (problem_.out_of_time()) {
    last_.converged = false;
    return whole;
  }
  last_ = problem_.search(how);
  iterations_ += last_.iterations;
  return reduced(last_);
}

double FitSearch::degrees_of_freedom() const {
  const double free = static_cast<double>(problem_.unknowns().size());
  return std::max(1.0, static_cast<double>(problem_.data_size()) - free);
}

/// Chi-square by degree of freedom.
double FitSearch::reduced(const SearchEnd& end) const {
  return 2.0 * end.cost / degrees_of_freedom();
}

/// Cauchy and Tukey take a peak that is far off for outliers: they search from near only.
void FitSearch::run() {
  problem_.set_loss(loss_from_afar(loss_));
  if (search_first_window() > misfit && may_end_early_ && !is_of_displacement_alone()) {
    const std::vector<double> tried = problem_.values();
    search_first_window_finely(tried);
    if (first_reached_ > misfit && end_before_second_contact()) return;
    problem_.set_values(tried);
  }
  search_whole_window();
  look_beside_touch();
  if (problem_.loss() == loss_) return;
  problem_.set_loss(loss_);
  pass(last_search, whole);
}

void FitSearch::search_near() {
  if (pass(last_search, whole) <= misfit) look_beside_touch();
}

void FitSearch::finish() {
  // a step that changes the cost by less moves no parameter further than is harmless; the full
  // equations' accuracy may hide smaller changes
  Search search = last_search;
  search.tolerance =
      std::max(search.tolerance, harmless_shift * harmless_shift / degrees_of_freedom());
  const double reached = pass(search, whole);
  if (!(reached > misfit) || !may_end_early_ || early_end_) return;
  const std::vector<double> found = problem_.values();
  const SearchEnd end = last_;
  search_first_window_finely(found);
  problem_.set_values(found);
  last_ = end;
  leave_later_contacts_out(reached);
}

void FitSearch::search_whole_window() {
  const std::vector<double> tried = problem_.values();
  double reached = pass(last_search, whole);
  if (is_of_displacement_alone())
    reached = try_again(reached, [&] { return search_from_everywhere(); });
  if (reached > misfit) reached = try_again(reached, [&] { return search_finely(tried); });
  // where not even the first contact fits, looking on from contact to contact mends nothing
  if (reached > misfit && first_reached_ <= poor_fit)
    reached = try_again(reached, [&] { return grow_window(); });
  if (reached > misfit && may_end_early_) leave_later_contacts_out(reached);
}

/// By rough predictions; from other places too where that ends badly. Returns the reduced
/// chi-square.
double FitSearch::search_first_window() {
  double reached = pass(first_search, first_window);
  if (reached > poor_fit && leaves_touch_open(problem_))
    reached = try_again(reached, [&] { return search_with_touch_scanned(); });
  if (reached > poor_fit) reached = try_again(reached, [&] { return grow_first_window(); });
  return reached > poor_fit && several_starts() ? search_from_elsewhere(reached) : reached;
}

double FitSearch::search_with_touch_scanned() {
  try {
    iterations_ += scan_touch(problem_);
    return pass(first_search, first_window);
  } catch (const std::runtime_error&) {
    return whole;  // what cannot be predicted there fits no better
  }
}

/// A force that rises and falls several times before the first separation has false minima where
/// the model does so too early or too late: looks on from its beginning.
double FitSearch::grow_first_window() {
  problem_.set_initial_values();
  for (double contacts = first_part; contacts < first_window; contacts *= growth)
    pass(first_search, contacts);
  return pass(first_search, first_window);
}

/// Rough predictions may have led astray, a sensor's resonance most easily: with fine ones from the
/// start again, and from where rough searches ended best where that is another place and they ended
/// at several, or this one misfits.
void FitSearch::search_first_window_finely(const std::vector<double>& tried) {
  problem_.set_initial_values();
  first_reached_ = pass(fine_search, first_window);
  const bool elsewhere = first_reached_ > misfit && !same_place(problem_.values(), tried);
  if (several_ends_ || elsewhere)
    first_reached_ = try_again(first_reached_, [&] {
      problem_.set_values(tried);
      return pass(fine_search, first_window);
    });
  first_end_ = problem_.values();
}

double FitSearch::search_finely(const std::vector<double>& tried) {
  if (first_end_.empty()) search_first_window_finely(tried);
  problem_.set_values(first_end_);
  return same_place(first_end_, tried) ? whole : pass(last_search, whole);
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
double FitSearch::search_from_elsewhere(double reduced) {
  std::vector<double> best = problem_.values();
  int tried = 0;
  for (const Start& start : other_starts) {
    if (reduced <= misfit || (tried++ == 2 && !several_ends_)) break;
    problem_.set_values(start_of(start));
    const double reached = pass(first_search, first_window);
    several_ends_ = several_ends_ || !same_place(problem_.values(), best);
    if (reached >= reduced) continue;
    reduced = reached;
    best = problem_.values();
  }
  problem_.set_values(best);
  return reduced;
}

std::vector<double> FitSearch::start_of(const Start& elsewhere) {
  problem_.set_initial_values();
  std::vector<double> start = problem_.values();
  for (std::size_t i = 0; i < start.size(); ++i) {
    const Variable& v = problem_.variables()[i];
    if (v.name == "contact.restitution") start[i] = elsewhere.restitution;
    if (v.name == "contact.stiffness_factor") start[i] = elsewhere.stiffness * v.initial;
    if (v.chain) start[i] = elsewhere.sensor * v.initial;
  }
  return start;
}

/// A displacement alone shows the contact by what the bar does later, which has many minima, and
/// noise may hide by how much a false one misfits: looks over the whole window from many places.
double FitSearch::search_from_everywhere() {
  constexpr double restitutions[] = {0.1, 0.3, 0.5, 0.7, 0.9}, stiffnesses[] = {0.7, 1.0, 1.4};
  constexpr Search search = {.tolerance = 1e-4};

  struct Way {
    std::vector<double> values;
    SearchEnd end = {};
    long simulations = 0;
  };

  std::vector<Way> ways;
  for (const double restitution : restitutions)
    for (const double stiffness : stiffnesses)
      ways.push_back({start_of({restitution, stiffness, 1.0})});
  problem_.choose_samples(whole, false);
  run_on_all_cores(ways.size(), [&](std::size_t i, std::size_t) {
    FitProblem problem = problem_.copy();
    problem.set_values(ways[i].values);
    ways[i].end = problem.search(search);
    ways[i].values = problem.values();
    ways[i].simulations = problem.simulations();
  });
  for (const Way& way : ways) {
    iterations_ += way.end.iterations;
    problem_.add_simulations(way.simulations);
  }
  problem_.set_values(
      std::ranges::min_element(ways, {}, [](const Way& way) { return way.end.cost; })->values);
  return pass(last_search, whole);
}

/// Neither force nor velocity is fitted, and restitution or stiffness are free; by equations that
/// are fast enough to search with from many places.
bool FitSearch::is_of_displacement_alone() const {
  const bool alone = std::ranges::all_of(problem_.shots(), [](const Shot& shot) {
    return std::ranges::all_of(shot.channels, [](const FittedChannel& channel) {
      return channel.signal->quantity == datasets::Quantity::displacement;
    });
  });
  return alone && several_starts() && problem_.motion() == models::Motion::small;
}

bool FitSearch::several_starts() const {
  return std::ranges::any_of(problem_.variables(), [](const Variable& v) {
    return v.name == "contact.restitution" || v.name == "contact.stiffness_factor";
  });
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

/// At first touch, in what is predicted of it.
bool FitSearch::force_jumps(const Shot& shot) const {
  if (!shot.impact->force) return false;
  const Shown shown = shot.model->predict(shot.cost->rig(), shot.model->chains());
  return shown.force && !shown.force->jumps.empty() &&
         std::abs(shown.force->jumps.front().time) < shown.force->interval;
}

/// Searches from a touch that is later by so much [s], which is held until all else has followed
/// it; whether that fits better. Where the model fits as it is, only if the search would end lower
/// were all linear: what a touch so near changes is.
bool FitSearch::moves_touch(std::size_t touch, double by) {
  // of chi-square, where it is what noise leaves: two minima that differ by less are one, or as
  // likely as each other
  constexpr double notable = 0.1;
  const double reached = reduced(last_);
  const double clearly = 1.0 - notable / degrees_of_freedom();
  const double clear = clearly * reached;
  const double found = try_again(clear, [&] {
    const Variable& v = problem_.variables()[touch];
    std::vector<double> values = problem_.values();
    values[touch] += by;
    if (values[touch] < v.lower || values[touch] > v.upper) return whole;
    problem_.set_values(values);
    try {
      if (reached <= misfit && problem_.linear_end() > clearly * last_.cost) return whole;
      iterations_ += problem_.search(last_search, {touch}).iterations;
      return pass(last_search, whole);
    } catch (const std::runtime_error&) {
      return whole;  // what cannot be predicted there fits no better
    }
  });
  return found < clear;
}

/// From touch back to a little before the last sample of the force until then, and on to a little
/// behind the next [s].
std::array<double, 2> FitSearch::to_neighbours(std::size_t touch) const {
  constexpr double little = 0.1;  // of their interval
  const int recording = std::max(0, problem_.variables()[touch].recording);
  const Shot& shot = problem_.shots()[static_cast<std::size_t>(recording)];
  const datasets::ImpactSignal& force = *shot.impact->force;
  double time = problem_.value(touch);
  for (const std::size_t i : shot.numbers) {
    const Variable& v = problem_.variables()[i];
    if (v.role == Variable::Role::delay && v.quantity == datasets::Quantity::force)
      time += v.value - v.initial;
  }
  const bool filtered = !force.filters.empty();
  const double interval = filtered ? force.filters.front().interval : force.interval;
  const double place = (time - (filtered ? force.recorded.begin : force.start)) / interval;
  return {(std::floor(place) - little - place) * interval,
          (std::ceil(place) + little - place) * interval};
}

/// A force that jumps at touch tells it by which samples lie behind it, one after the other: there
/// is a minimum for each place of touch between samples, at times one to either side of a sample,
/// and one for each period of a sensor that rings. Looks beside the one found, as long as that fits
/// better.
void FitSearch::look_beside_touch() {
  constexpr int most_steps = 8;
  for (const std::size_t touch : problem_.unknowns()) {
    const Variable& v = problem_.variables()[touch];
    if (v.role != Variable::Role::touch ||
        !force_jumps(problem_.shots()[static_cast<std::size_t>(std::max(0, v.recording))]))
      continue;
    const auto& sensor = problem_.rig().force;
    if (reduced(last_) > misfit && sensor && sensor->resonance)
      for (const double turn : {1.0, -1.0})
        for (int k = 0; k < most_steps; ++k)
          if (!moves_touch(touch, turn / sensor->resonance->frequency)) break;
    for (const std::size_t side : {0, 1})
      for (int k = 0; k < most_steps; ++k)
        if (!moves_touch(touch, to_neighbours(touch)[side])) break;
  }
}

/// The whole window at once may lead into a false minimum, where the model meets the stop a second
/// time too early or too late. Looks on from contact to contact, by predictions that are not rough:
/// of a fourth contact these may show another course.
double FitSearch::grow_window() {
  problem_.set_initial_values();
  double most = 0.0;  // contact durations in the whole window
  for (const Shot& shot : problem_.shots()) most = std::max(most, shot.window / shot.contact);
  for (double contacts = first_window; contacts < most; contacts *= growth)
    if (pass(fine_search, contacts) > poor_fit) return whole;
  return pass(last_search, whole);
}

/// What follows the first contact depends on all before it, each contact magnifying what the model
/// and its mesh lack; where it cannot be fitted, what it adds is wrong.
void FitSearch::leave_later_contacts_out(double reached) {
  std::vector<double> windows;
  for (const Shot& shot : problem_.shots()) windows.push_back(shot.window);
  try_again(reached, [&] {
    if (end_before_second_contact() && early_end_->early < reached) {
      early_end_->whole = reached;
      return early_end_->early;
    }
    early_end_.reset();
    for (std::size_t i = 0; i < windows.size(); ++i) problem_.shots()[i].window = windows[i];
    return whole;
  });
}

/// From where the first contact fits best; false where there is no other in the window.
bool FitSearch::end_before_second_contact() {
  problem_.set_values(first_end_);
  const double window = time_of_second_contact();
  double longest = 0.0;
  for (const Shot& shot : problem_.shots()) longest = std::max(longest, shot.window);
  if (!(window < longest)) return false;
  for (Shot& shot : problem_.shots()) shot.window = std::min(shot.window, window);
  early_end_ = {.window = window, .whole = {}, .early = pass(last_search, whole)};
  return true;
}

/// A little before the first that there is in any shot, at the present values; infinite where there
/// is none.
double FitSearch::time_of_second_contact() {
  constexpr double little = 0.1;  // of the flight
  problem_.choose_samples(whole, false);
  double time = whole;
  for (const Shot& shot : problem_.shots()) {
    const auto episodes = shot.model->simulate(shot.cost->rig(), 0.0).episodes;
    if (episodes.size() < 2) continue;
    const double flight = episodes[1].start - episodes[0].end;
    // what is predicted goes on a little beyond the window, if possible not into the contact
    const double before = std::clamp(margin_of(shot), little * flight, 0.5 * flight);
    // a model that is off may be free where the bar was still seen to press
    time = std::min(time, std::max(episodes[1].start - before, shot.contact));
  }
  return time;
}

}  // namespace impactrig::fitting
