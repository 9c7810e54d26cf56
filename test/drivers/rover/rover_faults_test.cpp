// Tests faults of a rover that follows a plan at 0.5 m/s, in virtual time: time until the rover
// stops, its state, and the end of the fault. The expected times are those of docs/guide/rovers.md.

#include <algorithm>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "test/drivers/rover/rover_bench.hpp"
#include "wire/rover/packet.hpp"

namespace vantage::drivers {
namespace {

using models::FlightState;
using models::OperatorAction;
using test::RoverBench;

// s; time from the driver's decision to stationary wheels: one tick, the delay of the rover, two
// ramps from 0.5 m/s at 2 m/s² (of the driver and of the wheels), and two bench steps.
constexpr double kBrakeS = 0.02 + 0.03 + 0.25 + 0.05 + 0.01;
constexpr double kWatchdogS = wire::rover::kWatchdogS;

struct Fault {
  const char* name;
  std::function<void(RoverBench&)> begin;
  double seen_after_s;  ///< s; maximum time from the start of the fault until the driver detects it
  FlightState end;
  const char* reason;
};

void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.name; }

const Fault kFaults[] = {
    {"MocapStops", [](RoverBench& b) { b.mocap_on = false; }, 0.11, FlightState::kHold,
     "pose stale"},
    {"MocapJumps",
     [](RoverBench& b) {
       b.shown_pose = lift({3.5, 7.0, 0.0}, RoverBench::kMarkersM);
     },
     0.12, FlightState::kHold, "pose implausible"},
    {"OperatorFallsSilent", [](RoverBench& b) { b.operator_on = false; }, 1.0, FlightState::kHold,
     "operator quiet"},
    {"OperatorStopsIt", [](RoverBench& b) { (void)b.command(OperatorAction::kEmergencyStop); },
     0.02, FlightState::kKilled, "emergency stop"},
    {"OperatorHoldsIt", [](RoverBench& b) { (void)b.command(OperatorAction::kHold); }, 0.02,
     FlightState::kHold, "operator"},
    {"SomebodyPressesItsButton", [](RoverBench& b) { b.rover.press_stop(); }, 0.0,
     FlightState::kKilled, "emergency stop"},
    {"MotorFails", [](RoverBench& b) { b.rover.fail_motor(); }, 0.0, FlightState::kKilled, "motor"},
    {"CommandsAreLost", [](RoverBench& b) { b.commands_on = false; }, kWatchdogS,
     FlightState::kHold, "commands not accepted"},
    {"TelemetryIsLost", [](RoverBench& b) { b.telemetry_on = false; }, 0.5 + 0.05,
     FlightState::kHold, "rover silent"},
    {"AnotherMapIsFlown", [](RoverBench& b) { b.driver.on_map(false); }, 0.02, FlightState::kHold,
     "map differs"},
    {"ABodyStandsInItsWay",
     [](RoverBench& b) { b.target_m = b.place_m() + Eigen::Vector2d(0.0, 0.8); }, 0.6,
     FlightState::kHold, "separation"},
    {"BatteryRunsOut", [](RoverBench& b) { b.rover.set_battery(0.1); }, 3.0 + 0.1,
     FlightState::kHold, "battery critical"},
};

class RoverFault : public ::testing::TestWithParam<Fault> {};

TEST_P(RoverFault, StopsTheRoverWithinTheDocumentedTime) {
  const Fault& fault = GetParam();
  RoverBench bench;
  ASSERT_TRUE(bench.make_ready());
  ASSERT_EQ(bench.plan(RoverBench::straight(0.5, 9.0)), PlanVerdict::kAccepted);
  bench.run(2.0);
  ASSERT_EQ(bench.driver.state(), FlightState::kFollow);
  ASSERT_GT(bench.rover.state().speed_mps, 0.45);
  fault.begin(bench);
  const Time begin = bench.now;
  ASSERT_TRUE(bench.run_until([&] { return bench.is_stationary(); }, 6.0));
  const double took_s = to_seconds(bench.now - begin);
  EXPECT_LE(took_s, fault.seen_after_s + kBrakeS);
  RecordProperty("took_ms", static_cast<int>(1000.0 * took_s));

  bench.run(0.6);
  EXPECT_EQ(bench.driver.state(), fault.end);
  EXPECT_TRUE(bench.has_reason(fault.reason)) << fault.reason;
  const Eigen::Vector2d stood_m = bench.place_m();
  bench.run(1.0);
  EXPECT_EQ(bench.place_m(), stood_m) << "the rover remains stationary";
  if (bench.target_m) {
    EXPECT_GT((stood_m - *bench.target_m).norm(), 2.0 * bench.scenario.robots[0].limits.radius_m);
  }
}

INSTANTIATE_TEST_SUITE_P(All, RoverFault, ::testing::ValuesIn(kFaults),
                         [](const auto& each) { return std::string(each.param.name); });

/// Row of localizer.safety: reaction of a rover without motion capture, by the 1σ of its pose
/// estimate.
struct EstimateFault {
  const char* name;
  bool may_drive;
  double sigma_m;
  FlightState during;
  const char* reason;      ///< empty: none
  FlightState afterwards;  ///< state 2 s after motion capture sees the rover again
};

const EstimateFault kEstimateFaults[] = {
    {"DrivesByACertainEstimate", true, 0.05, FlightState::kFollow, "", FlightState::kFollow},
    {"HoldsWithAnUncertainEstimate", true, 0.2, FlightState::kHold, "pose uncertain",
     FlightState::kFollow},
    {"StopsWithAVeryUncertainEstimate", true, 0.5, FlightState::kHold, "pose very uncertain",
     FlightState::kHold},
    {"RefusesAnyEstimateByDefault", false, 0.05, FlightState::kHold, "pose lost",
     FlightState::kHold},
};

class RoverWithoutMocap : public ::testing::TestWithParam<EstimateFault> {};

TEST_P(RoverWithoutMocap, ReactsAccordingToTheUncertaintyOfItsPose) {
  const EstimateFault& fault = GetParam();
  RoverBench bench(RoverBench::estimate_limits(fault.may_drive));
  ASSERT_TRUE(bench.make_ready());
  ASSERT_EQ(bench.plan(RoverBench::straight(0.5, 9.0)), PlanVerdict::kAccepted);
  bench.run(1.0);
  ASSERT_EQ(bench.driver.state(), FlightState::kFollow);
  bench.pose_sigma_m = fault.sigma_m;
  bench.run(1.0);
  EXPECT_EQ(bench.driver.state(), fault.during);
  if (*fault.reason != '\0') {
    EXPECT_TRUE(bench.is_stationary());
    EXPECT_TRUE(bench.has_reason(fault.reason));
  }
  bench.pose_sigma_m = 0.0;
  bench.run(1.0);
  // A rover in HOLD needs a new plan that begins at its position.
  static_cast<void>(bench.plan(RoverBench::straight(0.5, 3.0)));
  bench.run(1.0);
  EXPECT_EQ(bench.driver.state(), fault.afterwards);
}

INSTANTIATE_TEST_SUITE_P(All, RoverWithoutMocap, ::testing::ValuesIn(kEstimateFaults),
                         [](const auto& each) { return std::string(each.param.name); });

// The required distance from the fence at y = 8 m grows by 3σ of the pose, so the rover stops
// before the end of its plan.
TEST(RoverMargins, GrowWithTheUncertaintyOfThePose) {
  double stood_y_m[2];
  for (int i = 0; i < 2; ++i) {
    RoverBench bench(RoverBench::estimate_limits());
    bench.pose_sigma_m = 0.1 * i;
    ASSERT_TRUE(bench.make_ready());
    ASSERT_EQ(bench.plan(RoverBench::straight(0.5, 13.2)), PlanVerdict::kAccepted);
    bench.run(16.0);
    stood_y_m[i] = bench.place_m().y();
  }
  EXPECT_NEAR(stood_y_m[0], 1.0 + 0.5 * 13.2 + 0.0625, 0.06);
  EXPECT_LT(stood_y_m[1], 8.0 - 0.2 - 0.3);  // fence minus radius minus 3σ
}

/// A rover that follows a plan.
class RoverUnderWay : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(bench.make_ready());
    ASSERT_EQ(bench.plan(RoverBench::straight(0.5, 9.0)), PlanVerdict::kAccepted);
    bench.run(2.0);
    ASSERT_EQ(bench.driver.state(), FlightState::kFollow);
  }
  RoverBench bench;
};

TEST_F(RoverUnderWay, StopsWhenItsDriverEnds) {
  bench.driver_on = false;
  const Time begin = bench.now;
  ASSERT_TRUE(bench.run_until([&] { return bench.is_stationary(); }, 2.0));
  EXPECT_LE(to_seconds(bench.now - begin), kWatchdogS + 0.25 + 0.02);
}

TEST_F(RoverUnderWay, StopsAtTheEndOfTheLastPlan) {
  ASSERT_TRUE(bench.run_until([&] { return bench.is_stationary(); }, 10.0));
  bench.run(3.0);
  EXPECT_TRUE(bench.is_stationary());
  EXPECT_NEAR(bench.place_m().y(), 1.0 + 0.5 * 9.0 + 0.0625, 0.06);
  EXPECT_EQ(bench.driver.state(), FlightState::kHold);
  EXPECT_TRUE(bench.has_reason("no plan"));
}

TEST_F(RoverUnderWay, KeepsAnEmergencyStopUntilRearmed) {
  (void)bench.command(OperatorAction::kEmergencyStop);
  bench.run(1.0);
  EXPECT_TRUE(bench.rover.is_stopped());
  EXPECT_EQ(bench.command(OperatorAction::kFollow), CommandVerdict::kRefused);
  EXPECT_NE(bench.plan(RoverBench::straight(0.5, 1.0)), PlanVerdict::kAccepted);
  bench.run(1.0);
  EXPECT_EQ(bench.driver.state(), FlightState::kKilled);
  (void)bench.command(OperatorAction::kArm);
  bench.run(0.5);
  EXPECT_FALSE(bench.rover.is_stopped());
  EXPECT_EQ(bench.driver.state(), FlightState::kIdle);
  bench.run(0.5);
  ASSERT_EQ(bench.command(OperatorAction::kArm), CommandVerdict::kObeyed);
  bench.run(0.1);
  (void)bench.command(OperatorAction::kFollow);
  bench.run(0.1);
  ASSERT_EQ(bench.plan(RoverBench::straight(0.5, 1.0)), PlanVerdict::kAccepted);
  bench.run(1.0);
  EXPECT_EQ(bench.driver.state(), FlightState::kFollow);
}

TEST_F(RoverUnderWay, KeepsAStopPressedAtTheRover) {
  bench.rover.press_stop();
  bench.run(20.0);
  EXPECT_TRUE(bench.rover.is_stopped());
  EXPECT_EQ(bench.driver.state(), FlightState::kKilled);
}

TEST_F(RoverUnderWay, ContinuesWithANewPlanWhenMocapReturns) {
  bench.mocap_on = false;
  bench.run(0.3);
  bench.mocap_on = true;
  bench.run(0.3);
  EXPECT_EQ(bench.plan(RoverBench::straight(0.5, 2.0)), PlanVerdict::kNotFollowing) << "too early";
  bench.run(0.5);
  ASSERT_EQ(bench.plan(RoverBench::straight(0.5, 2.0)), PlanVerdict::kAccepted);
  bench.run(1.0);
  EXPECT_EQ(bench.driver.state(), FlightState::kFollow);
}

TEST_F(RoverUnderWay, WaitsForFollowAfterOperatorSilence) {
  bench.operator_on = false;
  bench.run(2.0);
  bench.operator_on = true;
  bench.run(2.0);
  EXPECT_NE(bench.plan(RoverBench::straight(0.5, 1.0)), PlanVerdict::kAccepted);
  EXPECT_EQ(bench.driver.state(), FlightState::kHold);
  (void)bench.command(OperatorAction::kFollow);
  bench.run(0.1);
  EXPECT_EQ(bench.plan(RoverBench::straight(0.5, 1.0)), PlanVerdict::kAccepted);
}

// The steering jams in a curve that would end before the wall; the rover must not cross the fence.
TEST(RoverFence, IsNotCrossedWhenSteeringJams) {
  scenario::Scenario scenario = RoverBench::scenario_for();
  scenario.world.bounds = {{0.0, 0.0}, {4.0, 3.0}};
  RoverBench bench(scenario);
  ASSERT_TRUE(bench.make_ready());
  const std::vector<models::PlanSegment> turn = {
      {{0.5, 0.0}, 2.0, 0.0}, {{0.5, -1.0}, 1.5, 0.0}, {{0.5, 0.0}, 0.25, 2.0}};
  ASSERT_EQ(bench.plan(turn), PlanVerdict::kAccepted);
  bench.change = [](const RoverMessage& sent) {
    wire::rover::Command command;
    if (wire::rover::decode(sent, command) != wire::rover::Verdict::kAccepted) {
      return sent;
    }
    command.yaw_rate_radps = 0.0F;
    return wire::rover::encode(command);
  };
  bench.run(6.0);
  EXPECT_TRUE(bench.is_stationary());
  EXPECT_GT(bench.place_m().y(), 1.8) << "the rover has moved";
  EXPECT_LT(bench.place_m().y(), 3.0 - scenario.robots[0].limits.radius_m);
}

TEST(RoverFence, ForbidsArmingOutside) {
  RoverBench bench;
  bench.rover.push_to({0.1, 1.0, kPi / 2});
  bench.run(1.0);
  EXPECT_TRUE(bench.has_reason("fence"));
  EXPECT_EQ(bench.command(OperatorAction::kArm), CommandVerdict::kRefused);
}

TEST(RoverDrivers, SecondDriverReportsThatTheRoverObeysAnother) {
  RoverBench bench;
  bench.run(1.0);
  RoverDriver second(bench.scenario, "R1", limits_for(bench.scenario, "R1"), 42);
  wire::rover::Telemetry of_first;
  of_first.robot = 7;
  of_first.session = 41;
  second.receive(wire::rover::encode(of_first), bench.now);
  (void)second.tick(bench.now);
  const auto reasons = second.status(bench.now).reasons;
  EXPECT_NE(std::find(reasons.begin(), reasons.end(), "rover disobeys"), reasons.end());
}

}  // namespace
}  // namespace vantage::drivers
