// SPDX-License-Identifier: BSD-3-Clause
#include "models/lane_runs.hpp"

#include <algorithm>
#include <exception>
#include <variant>

namespace impactrig::models {
namespace {

/// A vector, or a matrix by columns.
void write(LaneRow* rows, int lane, const auto& values) {
  for (Eigen::Index i = 0; i < values.size(); ++i) rows[i].at[lane] = values.data()[i];
}

void read(const LaneRow* rows, int lane, auto& values) {
  for (Eigen::Index i = 0; i < values.size(); ++i) values.data()[i] = rows[i].at[lane];
}

/// False for laws that solve_steps() does not know.
bool write_law(const ContactForce& contact, StepLanes& rows, int lane) {
  if (contact.form() != DampingForm::proportional || contact.may_pull()) return false;
  if (const auto* line = std::get_if<LogarithmicContact<>>(&contact.law())) {
    rows.compliance.at[lane] = line->compliance;
    rows.limit_force.at[lane] = line->limit_force;
    return true;
  }
  const auto* power = std::get_if<PowerContact<>>(&contact.law());
  if (!power || power->power != 1.0) return false;
  rows.compliance.at[lane] = 0.0;
  rows.spring.at[lane] = power->factor;
  return true;
}

}  // namespace

template <typename Action>
void LaneRuns::guarded(int number, const Action& action) {
  Lane& lane = lanes_[static_cast<std::size_t>(number)];
  try {
    action(lane);
  } catch (...) {
    queue_.failed(*lane.job);
    drop(lane, number);
  }
}

void LaneRuns::drop(Lane& lane, int number) {
  lane = {};
  rows().pressed.at[number] = rows().slack.at[number] = 0.0;
}

void LaneRuns::begin(Lane& lane, int number) {
  SmallMotionRun& run = *lane.job->run;
  run.run().begin();
  lane.known_law = run.faces_single_rigid_stop() && !run.bar().modes().damped() &&
                   write_law(run.run().contact(), rows(), number);
  rows().tolerance.at[number] = run.run().newton_tolerance();
}

void LaneRuns::fill(int number) {
  Lane& lane = lanes_[static_cast<std::size_t>(number)];
  while (!lane.job) {
    lane.job = queue_.next();
    if (!lane.job) return;
    const SmallMotionRun& run = *lane.job->run;
    if (!block_) block_.emplace(run.rule());
    guarded(number, [&](Lane& taken) { begin(taken, number); });
  }
}

void LaneRuns::propose(Lane& lane, int number) {
  CollocationRun& run = lane.job->run->run();
  const ModalMotion& motion = lane.job->run->motion();
  run.propose();
  if (!lane.known_law) return;
  if (lane.written != &motion.modal_step()) {
    lane.written = &motion.modal_step();
    const BarMotion::Response& response = motion.response(0, 0);
    write(rows().displacement_of_force, number, response.displacement_of_force);
    write(rows().velocity_of_force, number, response.velocity_of_force);
  }
  motion.coast(0, displacement_, velocity_);
  write(rows().displacement, number, displacement_);
  write(rows().velocity, number, velocity_);
  write(rows().force, number, run.proposed().force);
  const ContactForce::Phase phase = run.contact().phase();
  rows().pressed.at[number] = phase == ContactForce::Phase::pressed ? 1.0 : 0.0;
  rows().slack.at[number] = phase == ContactForce::Phase::slack ? 1.0 : 0.0;
  rows().mu.at[number] = run.contact().strength();
}

void LaneRuns::read_solution(Lane& lane, int number) {
  const auto evaluations = static_cast<long>(rows().iterations.at[number]) * rows().nodes;
  StopStep& solution = lane.job->run->run().solution(evaluations);
  for (const auto& [from, to] : {std::pair{rows().force, &solution.force},
                                 {rows().displacement, &solution.displacement},
                                 {rows().velocity, &solution.velocity},
                                 {rows().dissipation, &solution.dissipation},
                                 {rows().force_series, &solution.force_series},
                                 {rows().displacement_series, &solution.displacement_series},
                                 {rows().dissipation_series, &solution.dissipation_series},
                                 {rows().to_depth, &solution.to_depth},
                                 {rows().to_rate, &solution.to_rate}}) {
    to->resize(rows().nodes);
    read(from, number, *to);
  }
  ModalMotion& motion = lane.job->run->motion();
  motion.finish({&solution, 1});
  solution.at_end = motion.struck_at_end(0);
}

void LaneRuns::judge(Lane& lane, int number) {
  CollocationRun& run = lane.job->run->run();
  if (lane.known_law && rows().solved.at[number] != 0.0) {
    read_solution(lane, number);
    run.judge(true);
  } else {
    run.judge(run.solve());
  }
  if (!run.done()) return;
  queue_.finished(*lane.job);
  drop(lane, number);
}

void LaneRuns::work() {
  while (true) {
    bool busy = false;
    for (int number = 0; number < lane_count; ++number) {
      fill(number);
      if (!lanes_[static_cast<std::size_t>(number)].job) continue;
      busy = true;
      guarded(number, [&](Lane& lane) { propose(lane, number); });
    }
    if (!busy) return;
    solve_steps(rows());
    for (int number = 0; number < lane_count; ++number)
      if (lanes_[static_cast<std::size_t>(number)].job)
        guarded(number, [&](Lane& lane) { judge(lane, number); });
  }
}

}  // namespace impactrig::models
