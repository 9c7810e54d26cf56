#include <gtest/gtest.h>

#include "test/drivers/safety/expect_outcome.hpp"
#include "test/drivers/safety/fault_report.hpp"

namespace vantage::test {
namespace {

using models::FlightState;

std::string case_name(const std::string& name) {
  std::string out;
  bool upper = true;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      out += upper ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
      upper = false;
    } else {
      upper = true;
    }
  }
  return out;
}

class FaultTable : public testing::TestWithParam<std::size_t> {};

// Tests single faults: each stage is reached within its time limit, with the reason and final state
// of the table and without a violation.
TEST_P(FaultTable, EachFaultCausesTheExpectedReactionInTime) {
  const Fault& fault = fault_catalogue()[GetParam()];
  const Fault* const one[] = {&fault};
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const FaultRun run = fly_with(one, seed);
    const Outcome& outcome = run.outcomes.front();
    SCOPED_TRACE(std::string(fault.name) + ", seed " + std::to_string(seed) +
                 ", reasons: " + list(outcome.reasons));
    expect_outcome(fault, outcome);
    EXPECT_TRUE(run.violations.empty()) << list(run.violations);
    EXPECT_TRUE(run.path_violations.empty()) << list(run.path_violations);
    if (fault.stages.empty() && fault.end == FlightState::kFollow && !fault.trusts_plans) {
      EXPECT_GT(run.closest_m, 1.0);
    }
  }
}

std::string name_of_case(const testing::TestParamInfo<std::size_t>& param) {
  const Fault& fault = fault_catalogue()[param.param];
  return std::string("N") + std::to_string(fault.number) + case_name(fault.name);
}

INSTANTIATE_TEST_SUITE_P(EachFault, FaultTable,
                         testing::Range(std::size_t{0}, fault_catalogue().size()), name_of_case);

}  // namespace
}  // namespace vantage::test
