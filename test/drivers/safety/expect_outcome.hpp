#pragma once

#include <cstddef>

#include <gtest/gtest.h>

#include "test/drivers/safety/fault_catalogue.hpp"

namespace vantage::test {

/// Expects that each stage of `fault` was reached within its time limit, and its final state.
inline void expect_outcome(const Fault& fault, const Outcome& outcome) {
  EXPECT_TRUE(outcome.reacted);
  for (std::size_t i = 0; i < fault.stages.size(); ++i) {
    EXPECT_GE(outcome.stage_s[i], 0.0) << "never " << name_of(fault.stages[i].state);
    EXPECT_LE(outcome.stage_s[i], fault.stages[i].within_s + 1e-9)
        << name_of(fault.stages[i].state);
  }
  EXPECT_STREQ(name_of(outcome.end), name_of(fault.end));
}

}  // namespace vantage::test
