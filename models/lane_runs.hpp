// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>

#include "models/lanes/step_block.hpp"
#include "models/modal/small_motion_run.hpp"
#include "models/solved_to_size.hpp"

namespace impactrig::models {

/// Where LaneRuns gets its runs from, and what it tells of them.
class LaneQueue {
 public:
  /// What a contact is solved to its size with, and the solution before.
  struct Again {
    Solver solver;
    Solved first;
  };

  struct Job {
    std::size_t member = 0;
    std::unique_ptr<SmallMotionRun> run = {};  ///< not begun; all of as many nodes
    std::shared_ptr<const Again> again = {};   ///< of one that is solved again
  };

  virtual ~LaneQueue() = default;

  virtual std::optional<Job> next() = 0;

  /// The run is done; to be concluded.
  virtual void finished(const Job& job) = 0;

  /// Called in a catch: the run, or its conclusion, threw.
  virtual void failed(const Job& job) = 0;
};

/// Runs of small motion, several at a time: each goes from event to event by itself, in steps of
/// its own, that are solved together with those of the others.
class LaneRuns {
 public:
  explicit LaneRuns(LaneQueue& queue) : queue_(queue) {}

  /// Until the queue is empty and every run done.
  void work();

 private:
  struct Lane {
    std::optional<LaneQueue::Job> job;
    const ModalStep* written = nullptr;  // into the lane
    bool known_law = false;              // by solve_steps()
  };

  void fill(int number);
  void begin(Lane& lane, int number);
  void propose(Lane& lane, int number);
  void judge(Lane& lane, int number);
  void drop(Lane& lane, int number);
  void read_solution(Lane& lane, int number);

  /// Does something with a lane's run; the run is dropped when that throws.
  template <typename Action>
  void guarded(int number, const Action& action);

  StepLanes& rows() { return block_->lanes(); }

  LaneQueue& queue_;
  std::optional<StepBlock> block_;
  NodeVector displacement_, velocity_;  // of a struck point at the nodes
  std::array<Lane, lane_count> lanes_;
};

}  // namespace impactrig::models
