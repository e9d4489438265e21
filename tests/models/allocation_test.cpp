// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "models/modal/bar_cache.hpp"
#include "tests/models/scenes.hpp"

namespace {

long allocations = 0;

}  // namespace

// The linker hands every call of malloc in the project's own objects to these (--wrap).
extern "C" {
void* __real_malloc(std::size_t size);

void* __wrap_malloc(std::size_t size) {
  ++allocations;
  return __real_malloc(size);
}
}

void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = __real_malloc(size)) return memory;
  throw std::bad_alloc();
}

void operator delete(void* memory) noexcept {
  std::free(memory);
}

void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace impactrig::tests {
namespace {

using namespace models;

Rig damped_paper_rig() {
  Rig rig = paper_rig();
  rig.gravity = 9.81;
  rig.contact.damping = "lankarani-nikravesh";
  rig.contact.restitution = 0.5;
  return rig;
}

struct Counted {
  long allocations, steps;
};

Counted count(const Rig& rig, Solver solver, double duration, const SimulationOptions& options) {
  solver.duration = duration;
  const long before = allocations;
  const Simulation run = simulate(rig, solver, options);
  EXPECT_FALSE(run.episodes.empty());
  return {allocations - before, run.cost.steps};
}

/// Runs that differ in their number of steps alone: the second stretch is free flight or contact
/// like the first.
void expect_no_allocation_in_steps(const Rig& rig, const Solver& solver,
                                   const SimulationOptions& options) {
  count(rig, solver, 3e-3, options);  // fills what is kept between runs
  const Counted shorter = count(rig, solver, 1.5e-3, options);
  const Counted longer = count(rig, solver, 3e-3, options);
  EXPECT_GT(longer.steps, shorter.steps + 5);
  EXPECT_EQ(longer.allocations, shorter.allocations);
}

TEST(TimeLoop, CountsAllocationsAtAll) {
  const Counted run = count(damped_paper_rig(), ancf(7, 1, 1e-3, 0.0), 1e-3, {});
  EXPECT_GT(run.allocations, 20);  // by Eigen and by the containers of the set-up
}

TEST(TimeLoop, OfAncfAllocatesNothing) {
  SimulationOptions exact;
  exact.exact = true;
  for (const double accuracy : {1e-3, 1e-6})
    expect_no_allocation_in_steps(damped_paper_rig(), ancf(7, 1, accuracy, 0.0), exact);
}

TEST(TimeLoop, OfABarThatShearsAllocatesNothing) {
  Rig rig = damped_paper_rig();
  rig.beam.theory = BeamTheory::timoshenko;
  rig.beam.shear_coefficient = 0.886;
  SimulationOptions exact;
  exact.exact = true;
  for (const double accuracy : {1e-3, 1e-6}) {
    expect_no_allocation_in_steps(rig, ancf(7, 1, accuracy, 0.0), exact);
    rig.beam.damping = {.mass = 1.0, .stiffness = 1e-8};
    rig.hinge = {.spring = 100.0, .viscous = 0.1};
  }
}

TEST(TimeLoop, OfDampedAncfAllocatesNothing) {
  Rig rig = damped_paper_rig();
  rig.beam.damping = {.mass = 1.0, .stiffness = 1e-8};
  rig.hinge = {.spring = 100.0, .viscous = 0.1};
  SimulationOptions exact;
  exact.exact = true;
  expect_no_allocation_in_steps(rig, ancf(7, 1, 1e-4, 0.0), exact);
}

TEST(TimeLoop, OfHybridAllocatesNothing) {
  SimulationOptions exact;
  exact.exact = true;
  for (const double accuracy : {1e-3, 1e-6})
    expect_no_allocation_in_steps(damped_paper_rig(), hybrid(Basis::pinned_free, 5, accuracy, 0.0),
                                  exact);
}

TEST(TimeLoop, OfAHingeWithFrictionAllocatesNothing) {
  Rig rig = damped_paper_rig();
  rig.hinge.friction = 2.0;
  SimulationOptions exact;
  exact.exact = true;
  expect_no_allocation_in_steps(rig, ancf(7, 1, 1e-4, 0.0), exact);
  expect_no_allocation_in_steps(rig, hybrid(Basis::pinned_free, 5, 1e-4, 0.0), exact);
}

TEST(TimeLoop, OfSmallMotionAllocatesNothing) {
  BarCache cache;
  SimulationOptions options;
  options.bars = &cache;
  options.motion = Motion::small;
  Rig rig = damped_paper_rig();
  const Solver solver = ancf(14, 2, 1e-4, 0.0);
  count(rig, solver, 3e-3, options);
  EXPECT_EQ(count(rig, solver, 3e-3, options).allocations,  // a flight that is watched for longer
            count(rig, solver, 1.5e-3, options).allocations);
  options.kept = {Simplification::flight_at_once};
  expect_no_allocation_in_steps(rig, solver, options);
  rig.beam.damping = {.mass = 1.0, .stiffness = 1e-8};
  rig.hinge = {.spring = 100.0, .viscous = 0.1};
  expect_no_allocation_in_steps(rig, ancf(14, 2, 1e-4, 0.0), options);
}

/// Swings, and a bar that is turned, with and without derivatives.
TEST(TimeLoop, OfABarWithoutAStopAllocatesNothing) {
  Rig swinging = paper_rig();
  swinging.contact.law = "none";
  swinging.contact.position = swinging.beam.length;
  swinging.gravity = 9.81;
  swinging.beam.youngs_modulus = 2e9;
  Rig turned = swinging;
  swinging.start = {.velocity = 0.0, .release_angle = 0.8};
  turned.start = {};
  turned.hinge.rotation = HingeRotation{.rate = 3.0, .time = 0.1};
  Rig shearing = turned;
  shearing.beam.theory = BeamTheory::timoshenko;
  shearing.beam.shear_coefficient = 0.9;
  const auto run = [](const Rig& rig, Solver solver, double duration,
                      const SimulationOptions& options) {
    solver.duration = duration;
    const long before = allocations;
    const Simulation result = simulate(rig, solver, options);
    EXPECT_EQ(result.sensitivities.size(), options.sensitivities.size());
    return Counted{allocations - before, result.cost.steps};
  };
  SimulationOptions plain, followed;
  plain.exact = followed.exact = true;
  followed.sensitivities = {[](Rig& r) -> double& { return r.gravity; },
                            [](Rig& r) -> double& { return r.beam.density; }};
  for (const Rig& rig : {swinging, turned, shearing})
    for (const Solver& solver : {ancf(4, 0, 1e-6, 0.0), hybrid(Basis::cantilever, 3, 1e-6, 0.0)})
      for (const SimulationOptions& options : {plain, followed}) {
        run(rig, solver, 0.2, options);
        const Counted shorter = run(rig, solver, 0.05, options);
        const Counted longer = run(rig, solver, 0.2, options);
        EXPECT_GT(longer.steps, shorter.steps + 5);
        EXPECT_EQ(longer.allocations, shorter.allocations) << name(solver.model);
      }
}

/// Two stops that press at a time for as long as the bar is held between them.
Rig held_rig() {
  Rig rig = damped_paper_rig();
  rig.further_stops = {{.contact = rig.contact, .side = StopSide::near, .gap = 0.0},
                       {.contact = rig.contact, .side = StopSide::far, .gap = 2e-6}};
  rig.further_stops[0].contact.position = 0.4;
  rig.further_stops[1].contact.position = 0.2;
  return rig;
}

TEST(TimeLoop, OfSeveralStopsAllocatesNothingButEpisodes) {
  BarCache cache;
  SimulationOptions small, exact;
  small.bars = &cache;
  small.motion = Motion::small;
  exact.exact = true;
  for (const auto& [solver, options] : {std::pair{ancf(14, 2, 1e-4, 0.0), small},
                                        {ancf(7, 1, 1e-4, 0.0), exact},
                                        {hybrid(Basis::pinned_free, 5, 1e-9, 0.0), exact}}) {
    const Rig rig = held_rig();
    count(rig, solver, 3e-4, options);
    Solver shorter = solver, longer = solver;
    shorter.duration = 4e-5;
    longer.duration = 9e-5;
    const Simulation a = simulate(rig, shorter, options), b = simulate(rig, longer, options);
    ASSERT_EQ(a.episodes.size(), b.episodes.size());
    const Counted few = count(rig, solver, 4e-5, options);
    const Counted many = count(rig, solver, 9e-5, options);
    EXPECT_GT(many.steps, few.steps + 3);
    EXPECT_EQ(many.allocations, few.allocations);
  }
}

}  // namespace
}  // namespace impactrig::tests
