// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/all_cores.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <limits>
#include <thread>
#include <vector>

namespace impactrig::fitting {

namespace {

std::atomic<std::size_t> most_cores = std::numeric_limits<std::size_t>::max();

}  // namespace

void limit_cores(std::size_t cores) {
  most_cores = std::max<std::size_t>(1, cores);
}

std::size_t workers_for(std::size_t items) {
  return std::min(
      {items, most_cores.load(), std::max<std::size_t>(1, std::thread::hardware_concurrency())});
}

void run_on_all_cores(std::size_t items,
                      const std::function<void(std::size_t, std::size_t)>& work) {
  std::vector<std::exception_ptr> errors(items);
  std::atomic<std::size_t> next = 0;
  const auto run = [&](std::size_t worker) {
    for (std::size_t i = next++; i < items; i = next++) try {
        work(i, worker);
      } catch (...) {
        errors[i] = std::current_exception();
      }
  };
  {
    std::vector<std::jthread> threads;
    for (std::size_t k = 1; k < workers_for(items); ++k) threads.emplace_back(run, k);
    if (items > 0) run(0);
  }
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
}

}  // namespace impactrig::fitting
