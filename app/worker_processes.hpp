// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace impactrig::app {

/// How a piece of work ended: an exit code and, unless that is `done`, a sentence.
struct WorkEnd {
  int code = 0;
  std::string sentence;
};

/// Runs work(item) for every item from 0, each in a process of its own and `jobs` at a time, and
/// calls ended(item, end) here as each ends: what a recording does to its process (a crash, no
/// memory) does not reach the others, and libraries without threads are safe. Call it while this
/// process has no other threads.
///
/// SIGINT or SIGTERM ends the processes at once; those that were cut short are told to cut(item).
/// Returns that signal, else 0. Throws std::runtime_error when no process can be started.
int run_in_processes(std::size_t items, std::size_t jobs,
                     const std::function<WorkEnd(std::size_t)>& work,
                     const std::function<void(std::size_t, const WorkEnd&)>& ended,
                     const std::function<void(std::size_t)>& cut);

}  // namespace impactrig::app
