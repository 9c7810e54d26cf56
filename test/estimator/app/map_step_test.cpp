#include "estimator/app/map_step.hpp"

#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/transport/transport.hpp"
#include "test/estimator/occupancy/mapping_scenario.hpp"
#include "test/support/sent_ref.hpp"

namespace vantage::estimator {
namespace {

using namespace std::chrono_literals;

constexpr Time kStart = from_utime(1'700'000'000'000'000);

// The map publisher of Q1 on an in-process bus, with a second bus end for Q2.
class MapPublisherTest : public ::testing::Test {
 protected:
  void deliver() {
    while (bus_.handle(0us) + ear_.handle(0us) + replay_bus_.handle(0us) > 0) {
    }
  }

  // Publishes MAP_Q2 with `seen` observations of cell 0, from an estimator with run id `run_id`.
  models::InputRef publish(std::int64_t run_id, int step, std::int16_t seen) {
    models::RobotMap map;
    map.stamp.time = time_of(step);
    map.robot = "Q2";
    map.step = step;
    map.grid = grid_;
    map.own_looks.assign(static_cast<std::size_t>(grid_.size()), 0);
    map.own_looks[0] = seen;
    map.team_looks = map.own_looks;
    bus::Bus& mate = mates_.try_emplace(run_id, *mate_end_, run_id).first->second;
    const models::InputRef ref = vantage::test::sent_ref(mate, bus::map_channel("Q2"), map);
    deliver();
    return ref;
  }

  models::RobotMap step(int step) {
    models::RobotBelief belief;
    belief.stamp.time = time_of(step);
    belief.robot = "Q1";
    belief.step = step;
    belief.viewpoint = {{0.5, 0.25, 0.5}, 1.0};
    publisher_.step(bus_.publish(bus::belief_channel("Q1"), belief));
    deliver();
    return received_.back();
  }

  // Publishes a scan without hits on SCAN_Q1 with the robot name `robot`.
  models::InputRef scan(int step, const std::string& robot = "Q1") {
    models::RangeScan scan;
    scan.stamp.time = time_of(step);
    scan.robot = robot;
    scan.viewpoint = {{2.0, 3.0, 0.5}, 1.0};
    scan.field_of_view_rad = scenario_.mapping.scanner.field_of_view_rad;
    scan.range_max_m = scenario_.mapping.scanner.range_max_m;
    scan.ranges_m.assign(static_cast<std::size_t>(scenario_.mapping.scanner.beams), 1.5);
    const models::InputRef ref = vantage::test::sent_ref(ear_, bus::scan_channel("Q1"), scan);
    deliver();
    return ref;
  }

  [[nodiscard]] std::int16_t own_looks_here() const {
    const int here = grid_.index_of({2.0, 3.0});
    return received_.back().own_looks[static_cast<std::size_t>(here)];
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
  std::unique_ptr<bus::Transport> replay_end_ = hub_.connect();
  bus::Bus bus_{*own_end_, 1};
  bus::Bus ear_{*ear_end_, 2};
  bus::Bus replay_bus_{*replay_end_, 3, "REPLAY_"};
  std::map<std::int64_t, bus::Bus> mates_;  ///< teammates' buses by run id
  MapPublisher publisher_{bus_, scenario_, "Q1"};
  std::vector<models::RobotMap> received_;

  MapPublisherTest() {
    ear_.subscribe<models::RobotMap>(bus::map_channel("Q1"),
                                     [this](const auto& map) { received_.push_back(map); });
  }
};

TEST_F(MapPublisherTest, SumsTheNewestMapOfEachRunOfATeammate) {
  publish(10, 0, -3);
  EXPECT_EQ(step(0).team_looks[0], -3);
  const models::InputRef of_first = publish(10, 1, -4);
  EXPECT_EQ(step(1).team_looks[0], -4);
  const models::InputRef of_second = publish(11, 2, -1);
  const models::RobotMap map = step(2);
  EXPECT_EQ(map.team_looks[0], -5) << "its estimator was restarted";
  for (const models::InputRef& ref : {of_first, of_second}) {
    EXPECT_EQ(std::count(map.inputs.begin(), map.inputs.end(), ref), 1);
  }
}

TEST_F(MapPublisherTest, CountsMapsOfAnotherGrid) {
  grid_.resolution_m *= 2.0;
  publish(10, 0, -3);
  EXPECT_EQ(step(0).team_looks[0], 0);
  EXPECT_EQ(count("map.malformed_maps"), 1);
}

TEST_F(MapPublisherTest, LimitsTheNumberOfRunsOfATeammate) {
  models::RobotMap map;
  std::vector<models::InputRef> published;
  for (int run = 0; run < 40; ++run) {
    published.push_back(publish(100 + run * 7919 % 41, run, -1));
    map = step(run);
  }
  for (std::size_t run = 0; run < published.size(); ++run) {
    EXPECT_EQ(std::count(map.inputs.begin(), map.inputs.end(), published[run]), run < 24 ? 0 : 1);
  }
  EXPECT_EQ(map.team_looks[0], -16);
  EXPECT_EQ(map.inputs.size(), 2 + 16U) << "the belief, the previous own map, and 16 maps";
  EXPECT_EQ(count("map.runs_forgotten"), 24);
}

TEST_F(MapPublisherTest, AssignsEachScanToTheStepOfItsTime) {
  const models::InputRef first = scan(0);
  const models::InputRef second = scan(1);
  const models::InputRef later = scan(2);
  const models::RobotMap map = step(1);
  EXPECT_EQ(map.inputs, (std::vector<models::InputRef>{{"BELIEF_Q1", 1, 0}, first, second}));
  EXPECT_EQ(own_looks_here(), -2);
  EXPECT_EQ(map.step, 1);
  EXPECT_EQ(map.stamp.time, time_of(1));
  EXPECT_EQ(map.viewpoint.world_from_body, (Pose2{0.5, 0.25, 0.5}));
  const models::InputRef theirs = publish(10, 2, -3);
  const models::RobotMap next = step(2);
  EXPECT_EQ(next.inputs,
            (std::vector<models::InputRef>{{"BELIEF_Q1", 1, 1}, {"MAP_Q1", 1, 0}, later, theirs}));
  EXPECT_EQ(own_looks_here(), -3);
  EXPECT_EQ(next.team_looks[0], -3);
  EXPECT_TRUE(publisher_.counters().empty());
}

TEST_F(MapPublisherTest, KeepsTheNewestScans) {
  constexpr std::size_t kRoom = 64;
  std::vector<models::InputRef> scans;
  for (std::size_t i = 0; i < kRoom; ++i) {
    scans.push_back(scan(0));
  }
  EXPECT_EQ(count("map.scans_overflowed"), 0);
  scans.push_back(scan(0));
  scans.push_back(scan(0));
  EXPECT_EQ(count("map.scans_overflowed"), 2);
  const models::RobotMap map = step(0);
  ASSERT_EQ(map.inputs.size(), 1 + kRoom);
  EXPECT_TRUE(std::equal(map.inputs.begin() + 1, map.inputs.end(), scans.begin() + 2));
  EXPECT_EQ(own_looks_here(), -static_cast<int>(kRoom));
}

TEST_F(MapPublisherTest, IgnoresMapsUnderAnotherRobotsName) {
  scan(0, "Q2");
  models::RobotMap map;
  map.stamp.time = time_of(0);
  map.robot = "Q1";
  map.grid = grid_;
  map.own_looks.assign(static_cast<std::size_t>(grid_.size()), 5);
  map.team_looks = map.own_looks;
  ear_.publish(bus::map_channel("Q2"), map);
  ear_.publish(bus::map_channel("Q2"), map);
  deliver();
  EXPECT_EQ(count("map.misaddressed"), 3);
  EXPECT_EQ(step(0).inputs.size(), 1U);
  EXPECT_EQ(received_.back().team_looks[0], 0);
}

// Maps from outside radio range are ignored; maps received earlier are kept.
TEST_F(MapPublisherTest, MergesMapsWithinRadioRange) {
  scenario_.network.communication_range_m = 0.5;
  const auto far_end = hub_.connect();
  bus::Bus far_bus(*far_end, 7);
  MapPublisher far(far_bus, scenario_, "Q1");
  std::vector<models::RobotMap> made;
  ear_.subscribe<models::RobotMap>(bus::map_channel("Q1"),
                                   [&](const auto& map) { made.push_back(map); });
  publish(10, 0, -3);
  far_bus.handle(0us);
  models::RobotBelief belief;
  belief.stamp.time = time_of(0);
  belief.viewpoint = {{0.4, 0.0, 0.0}, 0.0};
  far.step(belief);
  publish(10, 1, -4);
  far_bus.handle(0us);
  belief.stamp.time = time_of(1);
  belief.viewpoint = {{0.6, 0.0, 0.0}, 0.0};
  far.step(belief);
  deliver();
  ASSERT_EQ(made.size(), 2U);
  EXPECT_EQ(made[0].team_looks[0], -3);
  EXPECT_EQ(made[1].team_looks[0], -3);
}

// Repeats the maps of a flight under another prefix, using only the inputs that each map names.
TEST_F(MapPublisherTest, ReproducesMapsFromTheInputsThatTheyName) {
  MapReplayer replayer(replay_bus_, scenario_, "Q1");
  std::vector<models::RobotMap> again;
  ear_.subscribe<models::RobotMap>(bus::Channel<models::RobotMap>{"REPLAY_MAP_Q1"},
                                   [&](const auto& map) { again.push_back(map); });
  for (int k = 0; k < 6; ++k) {
    scan(k);
    if (k % 3 == 0) {
      publish(10, k, static_cast<std::int16_t>(-1 - k));
    }
    if (k == 2) {
      scan(k);  // two scans in one step
    }
    step(k);
  }
  deliver();
  ASSERT_EQ(again.size(), 6U);
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_EQ(again[k].inputs, received_[k].inputs);
    EXPECT_EQ(again[k].own_looks, received_[k].own_looks);
    EXPECT_EQ(again[k].team_looks, received_[k].team_looks);
    EXPECT_EQ(again[k].entropy_nats, received_[k].entropy_nats);
    EXPECT_EQ(again[k].step, received_[k].step);
  }
  EXPECT_TRUE(replayer.counters().empty());
  // A map that names an unknown input, or no belief, is not reproduced. The replay waits two
  // seconds for the unknown input; later maps do not prolong this wait.
  models::RobotMap strange = received_.back();
  strange.inputs.push_back({"SCAN_Q1", 77, 0});
  bus_.publish(bus::map_channel("Q1"), strange);
  strange.inputs = {received_.back().inputs[1]};
  bus_.publish(bus::map_channel("Q1"), strange);
  deliver();
  for (int tick = 0; tick < 60; ++tick) {
    EXPECT_EQ(replayer.counters().empty(), tick < 20) << tick;
    replayer.tick();
  }
  deliver();
  EXPECT_EQ(again.size(), 6U);
  ASSERT_EQ(replayer.counters().size(), 1U);
  EXPECT_EQ(replayer.counters()[0].name, "map.replay_inputs_missing");
  EXPECT_EQ(replayer.counters()[0].count, 2);
}

}  // namespace
}  // namespace vantage::estimator
