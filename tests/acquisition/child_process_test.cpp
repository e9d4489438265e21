// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <functional>

#include "acquisition/importers/child_process.hpp"

namespace impactrig::acquisition {
namespace {

TEST(ChildProcess, TellsHowTheChildEnded) {
  const auto ending = [](const std::function<void(const PipeWriter&)>& work) {
    ChildProcess child(work, 1);
    std::uint64_t number = 0;
    EXPECT_TRUE(child.number(number));
    EXPECT_EQ(number, 7U);
    EXPECT_FALSE(child.number(number));
    return child.wait();
  };
  EXPECT_EQ(ending([](const PipeWriter& out) { out.number(7); }), "");
  EXPECT_EQ(ending([](const PipeWriter& out) {
              out.number(7);
              std::abort();
            }),
            "it was ended by signal 6");
  EXPECT_EQ(ending([](const PipeWriter& out) {
              out.number(7);
              throw 1;
            }),
            "it failed with code 3");
  EXPECT_EQ(ending([](const PipeWriter& out) {
              out.number(7);
              for (;;) static_cast<void>(getpid());
            }),
            "it took too long");
}

}  // namespace
}  // namespace impactrig::acquisition
