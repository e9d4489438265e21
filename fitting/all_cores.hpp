// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>

namespace impactrig::fitting {

/// How many workers run_on_all_cores() takes for so many items.
std::size_t workers_for(std::size_t items);

/// Calls work(item, worker) once for every item from 0, from as many threads as there are cores;
/// one worker's calls follow each other. Rethrows the first item's exception after all have ended.
void run_on_all_cores(std::size_t items,
                      const std::function<void(std::size_t item, std::size_t worker)>& work);

}  // namespace impactrig::fitting
