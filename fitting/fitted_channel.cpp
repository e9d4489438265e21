// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/fitted_channel.hpp"

namespace impactrig::fitting {

void whiten(const FittedChannel& channel, std::span<double> of_used) {
  const NoiseModel noise = channel.one_by_one ? channel.noise.as_if_white() : channel.noise;
  std::size_t begin = 0;
  for (std::size_t i = 1; i <= channel.used.size(); ++i)
    if (i == channel.used.size() || channel.used[i] != channel.used[i - 1] + channel.every) {
      noise.whiten(of_used.subspan(begin, i - begin));
      begin = i;
    }
}

}  // namespace impactrig::fitting
