// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include "tests/acquisition/mat_bytes.hpp"

namespace impactrig::acquisition::tests {

/// MAT-files of each byte order, big-endian where the parameter is true. importer_mat_test.cpp says
/// for all tests which are run.
class Mat : public testing::TestWithParam<bool> {
 protected:
  MatBytes b{GetParam()};
};

}  // namespace impactrig::acquisition::tests
