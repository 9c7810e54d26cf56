#include <algorithm>

#include <gtest/gtest.h>

#include "test/drivers/safety/fault_catalogue.hpp"

namespace vantage::test {
namespace {

constexpr double kFloorS = 10.0;  // limit of a stage that waits for the floor

constexpr const char* kSaysFollow = "first station lost, a second beats on";

// Pairs of which one takes away what the other is seen by; of them only what must never happen is
// asked. Names by their beginnings, in either order.
struct Masks {
  const char* one;
  const char* other;
  const char* why;
};
constexpr Masks kMasks[] = {
    {"latency 5 to 155 ms", "mocap clock", "a clock that is set hides the latency"},
    {"latency 5 to 155 ms", "latency 5 to 35 ms", "one latency at a time"},
    {"every plan after its deadline", "",
     "the late plan is refused or replaced for another reason"},
    {"only bad plans", "stopped leader", "the second planner's plans are good"},
    {"operator station lost", "second station", "the second station takes charge"},
    {"operator station lost", "first station", "the second station takes charge"},
    {"operator silent", "second station", "the second station takes charge and says follow"},
    {"driven", "", "how far it is pushed depends on what the other did to its way"},
    {"planner that keeps flying", "", "it must be let fly to be stopped"},
};

bool begins(const char* name, const char* with) { return std::string(name).rfind(with, 0) == 0; }

bool is_masked(const Fault& a, const Fault& b) {
  return std::any_of(std::begin(kMasks), std::end(kMasks), [&](const Masks& each) {
    return (begins(a.name, each.one) && begins(b.name, each.other)) ||
           (begins(b.name, each.one) && begins(a.name, each.other));
  });
}

class FaultPairs : public testing::TestWithParam<std::size_t> {};

// Every fault together with every one after it on the list, begun a quarter of a second later:
// nobody collides or leaves the fence, each reaction is as quick as alone, and each fault ends at
// least as severely as alone.
TEST_P(FaultPairs, AreNoWorseThanTheWorse) {
  const auto& all = fault_catalogue();
  const std::size_t i = GetParam();
  for (std::size_t j = i + 1; j < all.size(); ++j) {
    if (begins(all[i].name, "driven") && begins(all[j].name, "driven")) {
      continue;  // the two pushes together are longer than any vehicle can withstand
    }
    const Fault* const both[] = {&all[i], &all[j]};
    const FaultRun run = fly_with(both, 1, 11.0);
    for (const std::string& violation : run.violations) {
      ADD_FAILURE() << all[i].name << " + " << all[j].name << ": " << violation;
    }
    for (std::size_t k = 0; k < (is_masked(all[i], all[j]) ? 0U : 2U); ++k) {
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
