#include <gtest/gtest.h>

#include "trial/recipe.hpp"

namespace vantage::trial {
namespace {

// Logs identify their runs by these numbers, so the numbers must not change. They were computed
// with Python integers from the published constants of FNV-1a and SplitMix64.
TEST(DeterministicRunId, EqualsPrecomputedValues) {
  EXPECT_EQ(deterministic_run_id(1, "PLANNER_Q1"), 8938889392048076765);
  EXPECT_EQ(deterministic_run_id(0, ""), 4656582077437394441);
  EXPECT_EQ(deterministic_run_id(0xFFFF'FFFF'FFFF'FFFF, "SIM"), 1020457809645835924);
  EXPECT_EQ(deterministic_run_id(0x0102'0304'0506'0708, "ESTIMATOR_Q12"), 6490672327190489853);
}

}  // namespace
}  // namespace vantage::trial
