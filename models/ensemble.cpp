// SPDX-License-Identifier: BSD-3-Clause
#include "models/ensemble.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <unordered_map>

#include "models/lane_runs.hpp"
#include "models/modal/bar_family.hpp"
#include "models/stop/sensor_peak.hpp"

namespace impactrig::models {
namespace {

/// The bars of an ensemble, each made once and kept while members need it. For concurrent use.
class EnsembleBars {
 public:
  EnsembleBars(std::span<const Rig> rigs, const Solver& solver) : rigs_(rigs), solver_(solver) {
    std::unordered_map<BarKey, std::shared_ptr<Shared>, BarKey::Hash> known;
    for (const Rig& rig : rigs) {
      std::shared_ptr<Shared>& shared = known[BarKey::of(rig, solver)];
      if (!shared) shared = std::make_shared<Shared>();
      ++shared->members;
      of_member_.push_back(shared);
    }
  }

  /// To be called once a member at most.
  std::shared_ptr<const ModalBar> bar(std::size_t member) {
    Shared& shared = *of_member_[member];
    const std::lock_guard lock(shared.mutex);
    if (!shared.bar) shared.bar = make(rigs_[member]);
    return --shared.members == 0 ? std::move(shared.bar) : shared.bar;
  }

 private:
  struct Shared {
    std::mutex mutex;
    std::shared_ptr<const ModalBar> bar;
    std::size_t members = 0;  // that have not asked for it
  };

  std::shared_ptr<const ModalBar> make(const Rig& rig) {
    const std::optional<Rig> representative = BarFamily::representative(rig);
    if (!representative) return make_modal_bar(rig, solver_);
    return family(*representative)->bar(rig);
  }

  std::shared_ptr<const BarFamily> family(const Rig& representative) {
    const std::lock_guard lock(mutex_);
    std::shared_ptr<const BarFamily>& family = families_[BarKey::of(representative, solver_)];
    if (!family) family = std::make_shared<const BarFamily>(representative, solver_);
    return family;
  }

  std::span<const Rig> rigs_;
  const Solver& solver_;
  std::vector<std::shared_ptr<Shared>> of_member_;
  std::mutex mutex_;  // of the families
  std::unordered_map<BarKey, std::shared_ptr<const BarFamily>, BarKey::Hash> families_;
};

class Ensemble {
 public:
  Ensemble(std::span<const Rig> rigs, const Solver& solver, const SimulationOptions& options)
      : rigs_(rigs),
        solver_(solver),
        options_(options),
        bars_(rigs, solver),
        members_(rigs.size()) {
    options_.bars = nullptr;
  }

  std::vector<EnsembleMember> run(std::size_t threads);

 private:
  class Worker;

  std::span<const Rig> rigs_;
  const Solver& solver_;
  SimulationOptions options_;
  EnsembleBars bars_;
  std::atomic<std::size_t> next_ = 0;
  std::vector<EnsembleMember> members_;
};

/// What one thread does: takes members until there are no more.
class Ensemble::Worker : public LaneQueue {
 public:
  explicit Worker(Ensemble& ensemble) : ensemble_(ensemble) {}

  void work() { LaneRuns(*this).work(); }

  std::optional<Job> next() override {
    while (true) {
      if (!again_.empty()) {
        Job job = std::move(again_.back());
        again_.pop_back();
        return job;
      }
      const std::size_t member = ensemble_.next_++;
      if (member >= ensemble_.rigs_.size()) return std::nullopt;
      Job job{.member = member};
      try {
        job.run = small_motion(member);
        if (job.run) return job;
        solve_alone(member, ensemble_.options_.motion);
      } catch (...) {
        failed(job);
      }
    }
  }

  void finished(const Job& job) override {
    Solved solved{.result = {}, .smallness = job.run->run().smallness()};
    solved.result = job.run->conclude_untold();
    if (job.again) {
      const Solved& first = job.again->first;
      take(job.member, solved_to_size(first.result, std::move(solved), first.smallness,
                                      ensemble_.solver_.accuracy));
    } else if (solved.smallness < 1.0) {
      solve_again(job, std::move(solved));
    } else {
      take(job.member, std::move(solved.result));
    }
  }

  void failed(const Job& job) override {
    try {
      throw;
    } catch (const std::runtime_error& error) {
      if (job.again) {
        take(job.member, not_solved_to_size(job.again->first));
        return;
      }
      // what is wrong with the scene the full equations tell
      if (job.run && !asked())
        solve_alone(job.member, Motion::full);
      else
        member(job.member).failure = error.what();
    } catch (const std::exception& error) {
      member(job.member).failure = error.what();
    }
  }

 private:
  const Rig& rig(std::size_t number) const { return ensemble_.rigs_[number]; }

  EnsembleMember& member(std::size_t number) { return ensemble_.members_[number]; }

  bool asked() const { return ensemble_.options_.motion == Motion::small; }

  /// None where small motion may not be tried, or has no contact.
  std::unique_ptr<SmallMotionRun> small_motion(std::size_t number) {
    const Solver& solver = ensemble_.solver_;
    validate(rig(number), solver);
    if (!allows_small_motion(rig(number), ensemble_.options_)) return nullptr;
    if (!rig(number).has_stop()) return nullptr;
    if (!small_motion_refusal(rig(number), solver).empty()) return nullptr;
    return std::make_unique<SmallMotionRun>(rig(number), solver, ensemble_.options_,
                                            ensemble_.bars_.bar(number));
  }

  /// The member's answer, where small motion is accurate enough.
  void take(std::size_t number, Simulation result) {
    result.solver = ensemble_.solver_;
    if (!asked() && !(result.neglected <= ensemble_.solver_.accuracy)) {
      solve_alone(number, Motion::full);
      return;
    }
    if (ensemble_.options_.judge_small_motion) confirm_sensor(number, result);
    tell_swing(rig(number), ensemble_.options_, result);
    give(number, std::move(result));
  }

  void give(std::size_t number, Simulation result) {
    result.skipped.clear();
    member(number).simulation = std::move(result);
  }

  /// As simulate() does.
  void confirm_sensor(std::size_t number, Simulation& result) {
    const Solver& solver = ensemble_.solver_;
    confirm_sensor_peak(
        solver, ensemble_.options_, solver.time_limit,
        [&](const Solver& used, const SimulationOptions& asked) {
          SimulationOptions unconfirmed = asked;
          unconfirmed.judge_small_motion = false;
          return simulate(rig(number), used, unconfirmed);
        },
        result);
  }

  /// As simulate() solves a small contact again; in a lane, where the lanes' steps have its nodes.
  void solve_again(const Job& job, Solved first) {
    Solver finer = solver_to_size(ensemble_.solver_, first.smallness);
    if (nodes_of(finer) != nodes_of(ensemble_.solver_)) {
      solve_alone(job.member, ensemble_.options_.motion);
      return;
    }
    Job again{.member = job.member,
              .again = std::make_shared<const Again>(Again{std::move(finer), std::move(first)})};
    again.run = std::make_unique<SmallMotionRun>(rig(job.member), again.again->solver,
                                                 ensemble_.options_, job.run->shared_bar());
    again_.push_back(std::move(again));
  }

  void solve_alone(std::size_t number, Motion motion) {
    SimulationOptions options = ensemble_.options_;
    options.motion = motion;
    try {
      give(number, simulate(rig(number), ensemble_.solver_, options));
    } catch (const std::exception& error) {
      member(number).failure = error.what();
    }
  }

  Ensemble& ensemble_;
  std::vector<Job> again_;
};

std::vector<EnsembleMember> Ensemble::run(std::size_t threads) {
  std::vector<std::exception_ptr> errors(threads);
  const auto work = [&](std::size_t thread) {
    try {
      Worker(*this).work();
    } catch (...) {
      errors[thread] = std::current_exception();
    }
  };
  std::vector<std::jthread> others;
  for (std::size_t k = 1; k < threads; ++k) others.emplace_back(work, k);
  work(0);
  others.clear();
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
  return std::move(members_);
}

}  // namespace

std::vector<EnsembleMember> simulate_ensemble(std::span<const Rig> rigs, const Solver& solver,
                                              const EnsembleOptions& options) {
  if (options.threads < 0)
    throw std::invalid_argument("simulate_ensemble: the number of threads is negative");
  const std::size_t cores = options.threads > 0 ? static_cast<std::size_t>(options.threads)
                                                : std::max(1U, std::thread::hardware_concurrency());
  const std::size_t groups = (rigs.size() + lane_count - 1) / lane_count;
  return Ensemble(rigs, solver, options.simulation).run(std::clamp<std::size_t>(groups, 1, cores));
}

}  // namespace impactrig::models
