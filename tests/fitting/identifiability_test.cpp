// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/identifiability.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "fitting/fit.hpp"
#include "tests/fitting/synthetic_shot.hpp"

namespace impactrig::fitting {
namespace {

Fit fit_with(const std::vector<std::string>& free) {
  const RigFile rig = parse_rig_file(tests::paper_rig, "rig.toml",
                                     {{"solver.model", "hybrid"},
                                      {"solver.basis", "pinned-free"},
                                      {"solver.modes", "4"},
                                      {"solver.duration", "1.5 ms"}});
  FitOptions options;
  options.free = free;
  options.for_report = false;
  return fit({tests::synthetic_shot(rig, {.duration = 1.6e-3, .seed = 3})}, rig, options);
}

double error_of(const Fit& fit, const std::string& name) {
  for (const Parameter& p : fit.parameters)
    if (p.name == name) return p.std_error / p.value;
  return std::nan("");
}

// Of a single parameter the combination is that parameter, and its error that of the covariance.
TEST(Identifiability, OfOneParameterIsItsStandardError) {
  const Fit fit = fit_with({"contact.stiffness_factor"});
  ASSERT_EQ(fit.identifiability.combinations.size(), 1U);
  const Combination& only = fit.identifiability.combinations.front();
  ASSERT_EQ(only.exponents.size(), 1U);
  EXPECT_DOUBLE_EQ(only.exponents.front().second, 1.0);
  EXPECT_NEAR(only.relative_error / error_of(fit, "contact.stiffness_factor"), 1.0, 1e-6);
  // stiffness at a force is, by F = factor f(δ), a function of factor alone
  EXPECT_TRUE(fit.identifiability.remedy.empty());
}

// The squares of the errors along the combinations are the eigenvalues of the covariance of the
// logarithms: their sum is its trace.
TEST(Identifiability, ErrorsAddUpToTheTraceOfTheCovariance) {
  const Fit fit = fit_with({"contact.restitution", "contact.stiffness_factor", "start.velocity"});
  double sum = 0.0, trace = 0.0;
  for (const Combination& c : fit.identifiability.combinations)
    sum += c.relative_error * c.relative_error;
  for (const char* name : {"contact.restitution", "contact.stiffness_factor", "start.velocity"})
    trace += std::pow(error_of(fit, name), 2);
  EXPECT_NEAR(sum / trace, 1.0, 1e-6);
  EXPECT_TRUE(fit.identifiability.remedy.empty());
}

// Length of the contact line and radius of the groove of a logarithmic law: the stiffness at the
// peak is known much better than either, and the remedy names both.
TEST(Identifiability, NamesLengthAndRadiusAndWhatIsKnownOfThem) {
  const Fit fit = fit_with(
      {"contact.restitution", "contact.length", "contact.counterface.radius", "start.velocity"});
  const Identifiability& found = fit.identifiability;
  std::map<std::string, double> worst(found.combinations.front().exponents.begin(),
                                      found.combinations.front().exponents.end());
  EXPECT_TRUE(worst.contains("contact.length") || worst.contains("contact.counterface.radius"));
  EXPECT_GT(error_of(fit, "contact.length"), 5.0 * found.contact.relative_error);
  EXPECT_GT(found.contact.stiffness, 0.0);
  EXPECT_LT(found.contact.relative_error, 0.05);
}

// With the modulus of the bar's patch as well, one direction is lost in rounding: the remedy says
// so and offers three ways out.
TEST(Identifiability, OffersARemedyWhereACombinationIsLost) {
  const Fit fit =
      fit_with({"contact.stiffness_factor", "contact.length", "contact.modulus", "start.velocity"});
  EXPECT_THAT(fit.identifiability.remedy, testing::HasSubstr("contact.length"));
  EXPECT_THAT(fit.identifiability.remedy, testing::HasSubstr("--fix"));
  EXPECT_THAT(fit.identifiability.remedy, testing::HasSubstr("--prior"));
  EXPECT_THAT(fit.identifiability.remedy, testing::HasSubstr("its stiffness at the peak"));
  EXPECT_LT(fit.identifiability.contact.relative_error, 0.05);
}

}  // namespace
}  // namespace impactrig::fitting
