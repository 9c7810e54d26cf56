#include "models/exchange/messages.hpp"

#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace vantage::models {
namespace {

template <class Kind>
void expect_names(const std::vector<Kind>& kinds, const std::vector<std::string>& names) {
  ASSERT_EQ(kinds.size(), names.size());
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    EXPECT_EQ(name_of(kinds[i]), names[i]);
  }
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
}

// Logs, pages and people read them.
TEST(Names, AreAsStated) {
  expect_names<PlanSource>({PlanSource::kSearched, PlanSource::kShifted, PlanSource::kBraking},
                           {"searched", "shifted", "braking"});
  expect_names<FlightState>({FlightState::kIdle, FlightState::kFollow, FlightState::kHold,
                             FlightState::kLand, FlightState::kKilled},
                            {"idle", "follow", "hold", "land", "killed"});
  expect_names<SupervisedPhase>({SupervisedPhase::kRunning, SupervisedPhase::kWaiting,
                                 SupervisedPhase::kGivenUp, SupervisedPhase::kEnded},
                                {"running", "waiting", "given up", "ended"});
}

}  // namespace
}  // namespace vantage::models
