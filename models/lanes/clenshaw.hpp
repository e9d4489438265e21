// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace impactrig::models {
namespace {

/// Of Clenshaw's recurrence for Legendre polynomials, b_p = c_p + forward_p t b_{p+1} −
/// back_p b_{p+2}: by (p + 1) P_{p+1} = (2p + 1) t P_p − p P_{p-1}.
struct ClenshawFactors {
  static constexpr int most = 16;

  double forward[most] = {}, back[most] = {};

  constexpr ClenshawFactors() {
    for (int p = 0; p < most; ++p) {
      forward[p] = (2.0 * p + 1.0) / (p + 1.0);
      back[p] = (p + 1.0) / (p + 2.0);
    }
  }
};

constexpr ClenshawFactors clenshaw;

}  // namespace
}  // namespace impactrig::models
