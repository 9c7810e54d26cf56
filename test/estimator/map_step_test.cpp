#include "estimator/app/map_step.hpp"

#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/transport/transport.hpp"
#include "test/estimator/mapping_scenario.hpp"

namespace vantage::estimator {
namespace {

using namespace std::chrono_literals;

constexpr Time kStart = from_utime(1'700'000'000'000'000);

// The map's part of the estimator of Q1, and Q2 at the other end of a bus in one process.
class MapPublisherTest : public ::testing::Test {
 protected:
  void deliver() {
    while (bus_.handle(0us) + ear_.handle(0us) > 0) {
    }
  }

  // MAP_Q2 of `seen` looks at cell 0, from an estimator whose run is `run_id`.
  models::InputRef say(std::int64_t run_id, int step, std::int16_t seen) {
    models::RobotMap map;
    map.stamp.time = time_of(step);
    map.robot = "Q2";
    map.step = step;
    map.grid = grid_;
    map.own_looks.assign(static_cast<std::size_t>(grid_.size()), 0);
    map.own_looks[0] = seen;
    map.team_looks = map.own_looks;
    bus::Bus& mate = mates_.try_emplace(run_id, *mate_end_, run_id).first->second;
    const models::InputRef ref = mate.publish(bus::map_channel("Q2"), map);
    deliver();
    return ref;
  }

  models::RobotMap step(int step) {
    models::RobotBelief belief;
    belief.stamp.time = time_of(step);
    belief.step = step;
    publisher_.step(belief, {"BELIEF_Q1", 1, step});
    deliver();
    return heard_.back();
  }

  [[nodiscard]] static Time time_of(int step) { return kStart + step * 500ms; }

  [[nodiscard]] std::int64_t count(const std::string& name) const {
    for (const models::NamedCount& counter : publisher_.counters()) {
      if (counter.name == name) {
        return counter.count;
      }
    }
    return 0;
  }

  scenario::Scenario scenario_ = test::mapping_scenario({"Q1", "Q2"});
  models::GridGeometry grid_ = models::map_geometry(scenario_.world, scenario_.mapping);
  bus::InProcessHub hub_;
  std::unique_ptr<bus::Transport> own_end_ = hub_.connect();
  std::unique_ptr<bus::Transport> mate_end_ = hub_.connect();
  std::unique_ptr<bus::Transport> ear_end_ = hub_.connect();
  bus::Bus bus_{*own_end_, 1};
  bus::Bus ear_{*ear_end_, 2};
  std::map<std::int64_t, bus::Bus> mates_;  ///< by run
  MapPublisher publisher_{bus_, scenario_, "Q1"};
  std::vector<models::RobotMap> heard_;

  MapPublisherTest() {
    ear_.subscribe<models::RobotMap>(bus::map_channel("Q1"),
                                     [this](const auto& map) { heard_.push_back(map); });
  }
};

TEST_F(MapPublisherTest, AddsUpTheNewestOfEachRunOfATeammate) {
  say(10, 0, -3);
  EXPECT_EQ(step(0).team_looks[0], -3);
  const models::InputRef of_first = say(10, 1, -4);
  EXPECT_EQ(step(1).team_looks[0], -4);
  const models::InputRef of_second = say(11, 2, -1);
  const models::RobotMap map = step(2);
  EXPECT_EQ(map.team_looks[0], -5) << "its estimator has started again";
  for (const models::InputRef& ref : {of_first, of_second}) {
    EXPECT_EQ(std::count(map.inputs.begin(), map.inputs.end(), ref), 1);
  }
}

TEST_F(MapPublisherTest, CountsMapsOfAnotherGrid) {
  grid_.resolution_m *= 2.0;
  say(10, 0, -3);
  EXPECT_EQ(step(0).team_looks[0], 0);
  EXPECT_EQ(count("map.malformed_maps"), 1);
}

TEST_F(MapPublisherTest, KeepsSoManyRunsOfATeammateWhoseEstimatorStartsOverAndOver) {
  models::RobotMap map;
  std::vector<models::InputRef> said;
  for (int run = 0; run < 40; ++run) {
    said.push_back(say(100 + run * 7919 % 41, run, -1));
    map = step(run);
  }
  for (std::size_t run = 0; run < said.size(); ++run) {
    EXPECT_EQ(std::count(map.inputs.begin(), map.inputs.end(), said[run]), run < 24 ? 0 : 1);
  }
  EXPECT_EQ(map.team_looks[0], -16);
  EXPECT_EQ(map.inputs.size(), 2 + 16U) << "the belief, the own map before, its maps";
  EXPECT_EQ(count("map.runs_forgotten"), 24);
}

}  // namespace
}  // namespace vantage::estimator
