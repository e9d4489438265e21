// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>

namespace impactrig::fitting {

/// How many workers run_on_all_cores() takes for so many items.
std::size_t workers_for(std::size_t items);

/// Takes no more than `cores` (>= 1) from here on, in this process, where other processes want the
/// rest. Results do not depend on it.
void limit_cores(std::size_t cores);

/// Calls work(item, worker) once for every item from 0, from as many threads as there are cores
/// (or limit_cores() says);
/// one worker's calls follow each other. Rethrows the first item's exception after all have ended.
void run_on_all_cores(std::size_t items,
                      const std::function<void(std::size_t item, std::size_t worker)>& work);

}  // namespace impactrig::fitting
