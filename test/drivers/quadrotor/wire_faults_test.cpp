#include <cctype>

#include <gtest/gtest.h>

#include "test/drivers/quadrotor/wire_bench.hpp"
#include "test/drivers/quadrotor/wire_fault_report.hpp"
#include "test/drivers/safety/expect_outcome.hpp"
#include "test/drivers/safety/fault_report.hpp"

namespace vantage::test {
namespace {

using models::AutopilotDialect;

class WireFaults : public testing::TestWithParam<std::tuple<AutopilotDialect, std::size_t>> {};

TEST_P(WireFaults, CauseTheExpectedReactionInTime) {
  const auto [dialect, index] = GetParam();
  const Fault& fault = wire_faults(dialect)[index];
  const FaultRun run = fly_wire_fault(fault, dialect, 2);  // the results page uses seed 1
  const Outcome& outcome = run.outcomes.front();
  SCOPED_TRACE(std::string(fault.name) + ", reasons: " + list(outcome.reasons));
  expect_outcome(fault, outcome);
  EXPECT_TRUE(run.violations.empty()) << list(run.violations);
  EXPECT_GT(run.closest_m, 1.0);
}

std::string case_name(const testing::TestParamInfo<WireFaults::ParamType>& param) {
  const auto [dialect, index] = param.param;
  const Fault& fault = wire_faults(dialect)[index];
  std::string out = dialect == AutopilotDialect::kPx4 ? "Px4" : "Ardupilot";
  out += "_N" + std::to_string(fault.number) + "_";
  for (const char c : std::string(fault.name)) {
    out += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  }
  return out;
}

INSTANTIATE_TEST_SUITE_P(
    EachFault, WireFaults,
    testing::Combine(testing::Values(AutopilotDialect::kPx4, AutopilotDialect::kArdupilot),
                     testing::Range(std::size_t{0}, wire_faults(AutopilotDialect::kPx4).size())),
    case_name);

TEST(WireBench, FliesThreeVehiclesAlongTheirLanes) {
  for (const auto dialect : {AutopilotDialect::kPx4, AutopilotDialect::kArdupilot}) {
    WireBench bench(1, dialect);
    bench.fly_up(kBeginS);
    bench.run(10.0);
    for (const Vehicle& vehicle : bench.vehicles()) {
      EXPECT_EQ(vehicle.out.state, models::FlightState::kFollow) << vehicle.name;
      EXPECT_EQ(list(bench.reasons_of(vehicle.name)), "") << vehicle.name;
      EXPECT_GT(vehicle.position_m.z(), 0.8);
    }
    EXPECT_TRUE(bench.violations().empty());
  }
}

}  // namespace
}  // namespace vantage::test
