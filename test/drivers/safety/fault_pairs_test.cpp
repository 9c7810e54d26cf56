#include <algorithm>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "test/drivers/safety/fault_catalogue.hpp"

namespace vantage::test {
namespace {

constexpr double kRoundS = 1.0;      // s; time between two plans on the bench
constexpr double kFloorS = 10.0;     // s; a stage with at least this time limit ends on the floor
constexpr std::size_t kOneIn = 4;    // by default, one in this number of pairs is flown
constexpr std::size_t kSample = 11;  // seed that selects the flown pairs

constexpr const char* kSecondStationFault = "first station lost, a second sends heartbeats";

// Names of two faults, in either order, and the reason why a check is skipped.
struct Exception {
  const char* one;
  const char* other;
  const char* why;
};

// Pairs that no vehicle can survive: nothing is checked.
constexpr Exception kNoneSurvives[] = {
    {"pushed towards the fence", "pushed through the fence",
     "the pushes follow one another: 0.75 s at 1.3 m/s and more, and 0.65 m to the fence"},
    {"pushed through the fence", "attitude beyond 60°", "motors off, it goes on as it was pushed"},
};

// Pairs in which one fault hides the other: violations are checked, but the reaction to each fault
// is not.
constexpr Exception kOneHidesTheOther[] = {
    {"only bad plans from now on", "stopped planner continues",
     "the second planner's plans are good"},
    {"every plan after its deadline", "stopped planner continues",
     "the second planner's plans are in time"},
    {"operator station lost", "second station sends heartbeats too",
     "the second station takes charge"},
    {"operator station lost", kSecondStationFault, "the second station takes charge"},
    {"operator silent for 2 s", "second station sends heartbeats too",
     "the second station takes control and sends follow"},
    {"latency 5 to 155 ms", "mocap clock drifts by 1 %",
     "a clock that gains 1 % hides a tenth of a second of latency within ten seconds"},
    {"planner that repeatedly plans towards a teammate", "gust", "blown aside, they meet later"},
    {"pushed through the fence", "jitter of 50 ms",
     "held for the jitter already, it stops before the fence"},
    {"outage 0.5 s", "own process stops for 0.4 s",
     "most of the outage is over before the process sees anything"},
};

bool is_listed(std::span<const Exception> list, const Fault& a, const Fault& b) {
  return std::any_of(list.begin(), list.end(), [&](const Exception& each) {
    const std::string one = each.one;
    const std::string other = each.other;
    return (a.name == one && b.name == other) || (b.name == one && a.name == other);
  });
}

// Returns true for all pairs if VANTAGE_ALL_FAULT_PAIRS is set. Otherwise returns true for one in
// kOneIn pairs and for all pairs that bring two vehicles together.
bool is_flown(std::size_t i, std::size_t j) {
  const auto& all = fault_catalogue();
  return std::getenv("VANTAGE_ALL_FAULT_PAIRS") != nullptr ||
         (7 * i + 13 * j + kSample) % kOneIn == 0 || all[i].trusts_plans || all[j].trusts_plans;
}

void expect_as_alone(const Fault& fault, const Outcome& outcome, const Fault& other) {
  if (fault.needs_undisturbed_flight && !other.stages.empty()) {
    return;
  }
  // The motors need not be stopped near the floor, because the vehicle may have landed before.
  const bool ends_at_floor = !fault.stages.empty() && fault.stages.back().within_s >= kFloorS;
  // The fault `other` (a second station that sends `follow`) ends a hold that an operator can end.
  const bool is_resumed =
      std::string(other.name) == kSecondStationFault && fault.end == models::FlightState::kHold;
  const int needed = is_resumed ? 0 : std::min(severity_of(fault.end), ends_at_floor ? 2 : 3);
  EXPECT_GE(severity_of(outcome.end), needed)
      << fault.name << " ends in " << name_of(outcome.end) << " with " << other.name;
  // If the other fault removes the plan that this fault corrupts, this fault acts one round later.
  const double later_s = fault.acts_through_plans && other.acts_through_plans ? kRoundS : 0.0;
  for (std::size_t s = 0; s < fault.stages.size() - (ends_at_floor ? 1 : 0); ++s) {
    EXPECT_GE(outcome.stage_s[s], 0.0) << fault.name << " never reaches "
                                       << name_of(fault.stages[s].state) << " with " << other.name;
    EXPECT_LE(outcome.stage_s[s], fault.stages[s].within_s + other.delays_s + later_s + 1e-9)
        << fault.name << " is late with " << other.name;
  }
}

bool is_of_cameras(const Fault& fault) { return fault.number <= 12; }

// Returns the reason why `fault` need not be counted when it occurs together with `other`, or
// nullptr if it must be counted. The catalogue is sorted by number, so a camera fault is second
// only after another camera fault.
const char* hides_count(const Fault& fault, const Fault& other, bool is_first) {
  if (!is_first && is_of_cameras(fault)) {
    return "the first of two faults of the cameras may leave no frame, or no pose, to be wrong";
  }
  if (fault.acts_through_plans && other.acts_through_plans) {
    return "one plan is spoilt once";
  }
  if (fault.acts_through_plans && !other.stages.empty()) {
    return "a plan for a vehicle that does not follow is refused for that";
  }
  return nullptr;
}

// Expects that a fault that is counted when it occurs alone is also counted together with the other
// fault.
void expect_counted(const Fault& fault, const Outcome& outcome, const Fault& other, bool is_first) {
  const bool is_known_by_count = fault.counter != nullptr && fault.reason == nullptr;
  if (is_known_by_count && hides_count(fault, other, is_first) == nullptr) {
    EXPECT_TRUE(outcome.reacted) << fault.name << " is not counted as " << fault.counter << " with "
                                 << other.name;
  }
}

// Expects that each state is reached as early as when the first fault occurs alone. The tolerance
// is one telemetry tick, one guard tick, one tick for rounding and the delay of the other fault.
//
// Skips stages that wait for the floor. Also skips stages that depend on positions or plans if the
// other fault may have changed them; expect_as_alone() checks such stages by the table's limits.
void expect_as_soon(const Fault& fault, const Outcome& alone, const Outcome& outcome,
                    const Fault& other) {
  constexpr double kTicksS = 0.03;
  for (std::size_t s = 0; s < fault.stages.size(); ++s) {
    const bool is_before_other = alone.stage_s[s] + fault.begins_s < kStaggerS;
    const bool is_by_the_clock = !fault.needs_undisturbed_flight && !fault.acts_through_plans;
    const bool waits_for_floor = fault.stages[s].within_s >= kFloorS;
    if (!waits_for_floor && (is_before_other || is_by_the_clock)) {
      EXPECT_LE(outcome.stage_s[s], alone.stage_s[s] + kTicksS + other.delays_s)
          << fault.name << " is later in " << name_of(fault.stages[s].state) << " with "
          << other.name;
    }
  }
}

// Expects that a pair of faults does not bring vehicles closer together than the lanes, which are
// 1.3 m apart. Faults with `trusts_plans` are excluded, because they bring vehicles much closer;
// pairs with such a fault are checked for collisions only.
void expect_as_far_apart(const Fault& a, const FaultRun& alone, const Fault& b,
                         const FaultRun& run) {
  constexpr double kLanesKeptM = 1.0;  // m; checked by FaultTable for faults without a reaction
  constexpr double kSlackM = 0.1;
  if (!a.trusts_plans && !b.trusts_plans) {
    EXPECT_GE(run.closest_m, std::min(alone.closest_m, kLanesKeptM) - kSlackM)
        << a.name << " + " << b.name;
  }
}

class FaultPairs : public testing::TestWithParam<std::size_t> {};

// Flies each fault of the list with each later one, which begins 0.25 s after the first. No vehicle
// collides or leaves the fence. Each reaction is as fast and each final state at least as severe as
// with the fault alone. Set-points are feasible, the state never becomes less severe, separation is
// kept, and counted faults are counted.
TEST_P(FaultPairs, CauseAtLeastTheReactionToEachFaultAlone) {
  const auto& all = fault_catalogue();
  const std::size_t i = GetParam();
  const Fault* const one[] = {&all[i]};
  const FaultRun alone = fly_with(one, 1, 11.0);
  for (std::size_t j = i + 1; j < all.size(); ++j) {
    if (!is_flown(i, j) || is_listed(kNoneSurvives, all[i], all[j])) {
      continue;
    }
    const Fault* const both[] = {&all[i], &all[j]};
    const FaultRun run = fly_with(both, 1, 11.0);
    for (const std::string& violation : run.violations) {
      ADD_FAILURE() << all[i].name << " + " << all[j].name << ": " << violation;
    }
    for (const std::string& violation : run.path_violations) {
      ADD_FAILURE() << all[i].name << " + " << all[j].name << ": " << violation;
    }
    expect_as_far_apart(all[i], alone, all[j], run);
    if (!is_listed(kOneHidesTheOther, all[i], all[j])) {
      expect_as_alone(all[i], run.outcomes[0], all[j]);
      expect_as_alone(all[j], run.outcomes[1], all[i]);
      expect_as_soon(all[i], alone.outcomes[0], run.outcomes[0], all[j]);
      expect_counted(all[i], run.outcomes[0], all[j], true);
      expect_counted(all[j], run.outcomes[1], all[i], false);
    }
  }
}

// An exception must name existing faults and give a reason.
TEST(FaultPairExceptions, NameExistingFaultsAndReasons) {
  const auto exists = [](const std::string& name) {
    const auto& all = fault_catalogue();
    return std::any_of(all.begin(), all.end(),
                       [&](const Fault& each) { return each.name == name; });
  };
  const auto check = [&](std::span<const Exception> list) {
    for (const Exception& each : list) {
      EXPECT_TRUE(exists(each.one)) << each.one;
      EXPECT_TRUE(exists(each.other)) << each.other;
      EXPECT_FALSE(std::string(each.why).empty()) << each.one << " + " << each.other;
    }
  };
  check(kNoneSurvives);
  check(kOneHidesTheOther);
}

std::string name_of_case(const testing::TestParamInfo<std::size_t>& param) {
  return "From" + std::to_string(param.param);
}

INSTANTIATE_TEST_SUITE_P(All, FaultPairs,
                         testing::Range(std::size_t{0}, fault_catalogue().size() - 1),
                         name_of_case);

}  // namespace
}  // namespace vantage::test
