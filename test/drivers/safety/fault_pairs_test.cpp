#include <algorithm>

#include <gtest/gtest.h>

#include "test/drivers/safety/fault_catalogue.hpp"

namespace vantage::test {
namespace {

constexpr double kFloorS = 10.0;  // limit of a stage that waits for the floor

constexpr const char* kSaysFollow = "first station lost, a second beats on";

class FaultPairs : public testing::TestWithParam<std::size_t> {};

// Every fault together with every one after it on the list, begun a quarter of a second later:
// nobody collides or leaves the fence, each reaction is as quick as alone, and each fault ends at
// least as severely as alone.
TEST_P(FaultPairs, AreNoWorseThanTheWorse) {
  const auto& all = fault_catalogue();
  const std::size_t i = GetParam();
  for (std::size_t j = i + 1; j < all.size(); ++j) {
    const Fault* const both[] = {&all[i], &all[j]};
    const FaultRun run = fly_with(both, 1, 11.0);
    for (const std::string& violation : run.violations) {
      ADD_FAILURE() << all[i].name << " + " << all[j].name << ": " << violation;
    }
    for (std::size_t k = 0; k < 2; ++k) {
      const Outcome& outcome = run.outcomes[k];
      const Fault& fault = *both[k];
      const Fault& other = *both[1 - k];
      if (fault.needs_quiet && !other.stages.empty()) {
        continue;
      }
      // While a process stands still a short fault may come and go unseen.
      if (std::string(fault.name) == "outage 0.5 s" && other.delays_s > 0.1) {
        continue;
      }
      // Who lands before the motors would have been stopped near the floor has landed.
      const bool ends_at_floor = !fault.stages.empty() && fault.stages.back().within_s >= kFloorS;
      // A hold that the operator may end is ended by one who says follow.
      const bool goes_on =
          std::string(other.name) == kSaysFollow && fault.end == models::FlightState::kHold;
      const int needed = goes_on ? 0 : std::min(severity_of(fault.end), ends_at_floor ? 2 : 3);
      EXPECT_GE(severity_of(outcome.end), needed)
          << fault.name << " ends in " << models::name_of(outcome.end) << " with " << other.name;
      for (std::size_t s = 0; s < fault.stages.size() - (ends_at_floor ? 1 : 0); ++s) {
        EXPECT_GE(outcome.stage_s[s], 0.0)
            << fault.name << " never reaches " << models::name_of(fault.stages[s].state) << " with "
            << other.name;
        EXPECT_LE(outcome.stage_s[s], fault.stages[s].within_s + other.delays_s + 1e-9)
            << fault.name << " is late with " << other.name;
      }
    }
  }
}

std::string name_of_case(const testing::TestParamInfo<std::size_t>& param) {
  return "From" + std::to_string(param.param);
}

INSTANTIATE_TEST_SUITE_P(All, FaultPairs,
                         testing::Range(std::size_t{0}, fault_catalogue().size() - 1),
                         name_of_case);

}  // namespace
}  // namespace vantage::test
