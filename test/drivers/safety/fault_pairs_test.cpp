#include <algorithm>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "test/drivers/safety/fault_catalogue.hpp"

namespace vantage::test {
namespace {

constexpr double kRoundS = 1.0;      // from plan to plan on the bench
constexpr double kFloorS = 10.0;     // limit of a stage that waits for the floor
constexpr std::size_t kOneIn = 4;    // pairs flown by default
constexpr std::size_t kSample = 11;  // which of them; a seed

constexpr const char* kSaysFollow = "first station lost, a second beats on";

// Two faults by name, in either order, and why something is not asked of them.
struct Exception {
  const char* one;
  const char* other;
  const char* why;
};

// Nothing is asked, for no vehicle can survive both.
constexpr Exception kNoneSurvives[] = {
    {"driven at the fence", "driven through the fence",
     "the pushes follow one another: 0.75 s at 1.3 m/s and more, and 0.65 m to the fence"},
    {"driven through the fence", "attitude beyond 60°", "motors off, it goes on as it was pushed"},
};

// No collision and no breach of the fence, as always; but the reaction of each alone is not asked.
constexpr Exception kOneHidesTheOther[] = {
    {"only bad plans from then on", "stopped leader wakes up",
     "the second planner's plans are good"},
    {"every plan after its deadline", "stopped leader wakes up",
     "the second planner's plans are in time"},
    {"operator station lost", "second station beats beside the first",
     "the second station takes charge"},
    {"operator station lost", kSaysFollow, "the second station takes charge"},
    {"operator silent for 2 s", "second station beats beside the first",
     "the second station takes charge and says follow"},
    {"latency 5 to 155 ms", "mocap clock drifts by 1 %",
     "a clock that gains 1 % hides a tenth of a second of latency within ten seconds"},
    {"planner that keeps flying at a teammate", "gust", "blown aside, they meet later"},
    {"driven through the fence", "jitter of 50 ms",
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

// All pairs when asked for, else one in kOneIn, and always those in which two vehicles are meant
// to meet.
bool is_flown(std::size_t i, std::size_t j) {
  const auto& all = fault_catalogue();
  return std::getenv("VANTAGE_ALL_FAULT_PAIRS") != nullptr ||
         (7 * i + 13 * j + kSample) % kOneIn == 0 || all[i].trusts_plans || all[j].trusts_plans;
}

void expect_as_alone(const Fault& fault, const Outcome& outcome, const Fault& other) {
  if (fault.needs_quiet && !other.stages.empty()) {
    return;
  }
  // Who lands before the motors would have been stopped near the floor has landed.
  const bool ends_at_floor = !fault.stages.empty() && fault.stages.back().within_s >= kFloorS;
  // A hold that the operator may end is ended by one who says follow.
  const bool goes_on =
      std::string(other.name) == kSaysFollow && fault.end == models::FlightState::kHold;
  const int needed = goes_on ? 0 : std::min(severity_of(fault.end), ends_at_floor ? 2 : 3);
  EXPECT_GE(severity_of(outcome.end), needed)
      << fault.name << " ends in " << name_of(outcome.end) << " with " << other.name;
  // What one plan was to do, the next one does when the other fault takes the first away.
  const double later_s = fault.strikes_by_plans && other.strikes_by_plans ? kRoundS : 0.0;
  for (std::size_t s = 0; s < fault.stages.size() - (ends_at_floor ? 1 : 0); ++s) {
    EXPECT_GE(outcome.stage_s[s], 0.0) << fault.name << " never reaches "
                                       << name_of(fault.stages[s].state) << " with " << other.name;
    EXPECT_LE(outcome.stage_s[s], fault.stages[s].within_s + other.delays_s + later_s + 1e-9)
        << fault.name << " is late with " << other.name;
  }
}

bool is_of_cameras(const Fault& fault) { return fault.number <= 12; }

// Why what a fault alone makes a vehicle count need not be counted beside the other; nullptr: it
// must. The catalogue is in the order of numbers, so the first of two is of the cameras if one is.
const char* hides_count(const Fault& fault, const Fault& other, bool is_first) {
  if (!is_first && is_of_cameras(fault)) {
    return "the first of two faults of the cameras may leave no frame, or no pose, to be wrong";
  }
  if (fault.strikes_by_plans && other.strikes_by_plans) {
    return "one plan is spoilt once";
  }
  if (fault.strikes_by_plans && !other.stages.empty()) {
    return "a plan for a vehicle that does not follow is refused for that";
  }
  return nullptr;
}

// What is counted alone is counted beside the other.
void expect_counted(const Fault& fault, const Outcome& outcome, const Fault& other, bool is_first) {
  const bool is_known_by_count = fault.counter != nullptr && fault.reason == nullptr;
  if (is_known_by_count && hides_count(fault, other, is_first) == nullptr) {
    EXPECT_TRUE(outcome.reacted) << fault.name << " is not counted as " << fault.counter << " with "
                                 << other.name;
  }
}

// The first of two begins in the very world in which it is flown alone. So each state comes as soon
// as it did there, whatever the table allows: a tick of telemetry, one of ours, one for rounding,
// and what the other delays. Not asked: what waits for the floor, and what strikes by where the
// vehicle is or by plans once the other may have changed them; those are held to the table.
void expect_as_soon(const Fault& fault, const Outcome& alone, const Outcome& outcome,
                    const Fault& other) {
  constexpr double kTicksS = 0.03;
  for (std::size_t s = 0; s < fault.stages.size(); ++s) {
    const bool is_before_other = alone.stage_s[s] + fault.begins_s < kStaggerS;
    const bool is_by_the_clock = !fault.needs_quiet && !fault.strikes_by_plans;
    const bool waits_for_floor = fault.stages[s].within_s >= kFloorS;
    if (!waits_for_floor && (is_before_other || is_by_the_clock)) {
      EXPECT_LE(outcome.stage_s[s], alone.stage_s[s] + kTicksS + other.delays_s)
          << fault.name << " comes later to " << name_of(fault.stages[s].state) << " with "
          << other.name;
    }
  }
}

// Lanes are 1.3 m apart, and no fault brings two vehicles much nearer but those of who trusts plans
// (who are kept from touching, which is asked of each pair): so no two do.
void expect_as_far_apart(const Fault& a, const FaultRun& alone, const Fault& b,
                         const FaultRun& run) {
  constexpr double kLanesKeptM = 1.0;  // FaultTable asks it of each fault that is flown through
  constexpr double kSlackM = 0.1;
  if (!a.trusts_plans && !b.trusts_plans) {
    EXPECT_GE(run.closest_m, std::min(alone.closest_m, kLanesKeptM) - kSlackM)
        << a.name << " + " << b.name;
  }
}

class FaultPairs : public testing::TestWithParam<std::size_t> {};

// Every fault together with every one after it on the list, begun a quarter of a second later:
// nobody collides or leaves the fence, each reaction is as quick as alone, and each fault ends at
// least as severely as alone. And on the way there nothing is asked that cannot be flown, no state
// is taken back, nobody comes nearer to another, and nothing that is counted alone goes uncounted.
TEST_P(FaultPairs, AreNoWorseThanTheWorse) {
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
    for (const std::string& misstep : run.missteps) {
      ADD_FAILURE() << all[i].name << " + " << all[j].name << ": " << misstep;
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

// An exception for faults that are not there, or without a reason, excuses nobody knows what.
TEST(FaultPairExceptions, NameFaultsThatExistAndSayWhy) {
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
