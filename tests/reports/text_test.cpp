// SPDX-License-Identifier: BSD-3-Clause
#include "reports/text.hpp"

#include <gmock/gmock.h>

#include "tests/reports/example_report.hpp"

namespace {

using namespace impactrig;
using testing::HasSubstr;
using testing::Not;

TEST(FitText, EndsWithWhyItDidNotConverge) {
  reports::ReportData data = tests::example_report();
  EXPECT_THAT(reports::to_text(data), Not(HasSubstr("did not converge")));
  data.fit.termination = "stopped after 61 iterations without converging";
  EXPECT_THAT(
      reports::to_text(data),
      testing::EndsWith("\nwarning: The fit did not converge: stopped after 61 iterations "
                        "without converging. Values and intervals are provisional. Start "
                        "nearer to the answer (--set), or free fewer parameters (--free).\n"));
}

}  // namespace
