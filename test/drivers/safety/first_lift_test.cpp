// Flight safety must verify, on the ground or within the first 0.3 m of the lift, that the
// commanded vehicle is the body that mocap shows.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "drivers/safety/lift.hpp"
#include "test/drivers/safety/flight_bench.hpp"

namespace vantage::test {
namespace {

using models::FlightState;
using models::OperatorAction;

constexpr double kProofM = 0.3;

Eigen::Matrix3d turned(double degrees) {
  return Eigen::AngleAxisd(degrees * kPi / 180.0, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}
Eigen::Matrix3d diagonal(double x, double y, double z) {
  return Eigen::Vector3d(x, y, z).asDiagonal();
}
/// Returns the rotation of a y-up world with z sideways: (x, y, z) is shown as (x, z, -y).
Eigen::Matrix3d y_up() {
  Eigen::Matrix3d out;
  out << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  return out;
}

struct WorldSetup {
  const char* name;
  Wiring wiring;
  const char* whom;  ///< vehicles that must not fly
  bool flies;        ///< true if the set-up is correct
};

std::vector<WorldSetup> setups() {
  const auto world = [](const Eigen::Matrix3d& turn, bool mirrors_attitude = true,
                        bool has_compass = false) {
    Wiring out;
    out.mocap_from_world = turn;
    out.mirrors_attitude = mirrors_attitude;
    out.has_compass = has_compass;
    return out;
  };
  Wiring names, addresses;
  names.swaps_names = true;
  addresses.swaps_addresses = true;
  return {
      {"AsItShouldBe", {}, "Q1 Q2 Q3", true},
      {"YUp", world(y_up()), "Q1 Q2 Q3", false},
      {"SwappedNames", names, "Q1 Q2", false},
      {"SwappedAddresses", addresses, "Q1 Q2", false},
      {"MirroredX", world(diagonal(-1, 1, 1)), "Q1 Q2 Q3", false},
      {"MirroredY", world(diagonal(1, -1, 1)), "Q1 Q2 Q3", false},
      {"MirroredXPositionsOnly", world(diagonal(-1, 1, 1), false), "Q1 Q2 Q3", false},
      {"MirroredYPositionsOnly", world(diagonal(1, -1, 1), false), "Q1 Q2 Q3", false},
      {"UpsideDown", world(diagonal(1, 1, -1)), "Q1 Q2 Q3", false},
      // If the autopilot takes its yaw from the mocap poses, it flies correctly in a world that is
      // rotated about the vertical. Only the start positions differ from the scenario.
      {"Turned20", world(turned(20.0)), "Q1 Q2 Q3", false},
      {"Turned90", world(turned(90.0)), "Q1 Q2 Q3", false},
      {"Turned180", world(turned(180.0)), "Q1 Q2 Q3", false},
      {"TurnedBack90", world(turned(-90.0)), "Q1 Q2 Q3", false},
      {"Turned20Compass", world(turned(20.0), true, true), "Q1 Q2 Q3", false},
      {"Turned90Compass", world(turned(90.0), true, true), "Q1 Q2 Q3", false},
      {"Turned180Compass", world(turned(180.0), true, true), "Q1 Q2 Q3", false},
  };
}

class FirstLift : public testing::TestWithParam<std::size_t> {};

// Regression: vehicles flew with y-up mocap, and two with swapped addresses climbed to 12 m.
TEST_P(FirstLift, StaysBelowTheTestHeightInAWrongSetup) {
  const WorldSetup setup = setups()[GetParam()];
  // Take-off of a single vehicle or of all simultaneously.
  for (const char* whom : {"", "Q1", "Q2"}) {
    SCOPED_TRACE(std::string("told: ") + (*whom == '\0' ? "all" : whom));
    FlightBench bench(7);
    bench.wiring() = setup.wiring;
    bench.run(1.0);
    bench.send_command(OperatorAction::kArm);
    bench.run(0.5);
    bench.send_command(OperatorAction::kTakeOff, whom);
    double highest_m[3] = {};
    double farthest_m[3] = {};
    std::vector<Eigen::Vector3d> start_m;
    for (const Vehicle& vehicle : bench.vehicles()) {
      start_m.push_back(vehicle.position_m);
    }
    bench.run(45.0, [&] {
      for (std::size_t i = 0; i < 3; ++i) {
        const Eigen::Vector3d& p_m = bench.vehicles()[i].position_m;
        highest_m[i] = std::max(highest_m[i], p_m.z());
        farthest_m[i] = std::max(farthest_m[i], (p_m - start_m[i]).head<2>().norm());
      }
    });
    for (std::size_t i = 0; i < 3; ++i) {
      const Vehicle& vehicle = bench.vehicles()[i];
      SCOPED_TRACE(vehicle.name);
      const bool is_concerned = std::string(setup.whom).find(vehicle.name) != std::string::npos;
      if (setup.flies || !is_concerned) {
        continue;
      }
      EXPECT_LT(highest_m[i], kProofM);
      EXPECT_LT(farthest_m[i], 0.5);
      EXPECT_NEAR(vehicle.position_m.z(), 0.0, 1e-9);
      if (setup.wiring.swaps_names || setup.wiring.swaps_addresses) {
        EXPECT_FALSE(vehicle.is_armed) << "told or not, it is not what it seems";
      } else {
        EXPECT_FALSE(vehicle.is_armed && vehicle.out.state != FlightState::kIdle);
      }
    }
    if (setup.flies) {
      const auto flies = [&](const std::string& name) {
        return std::abs(bench.vehicle(name).position_m.z() - 1.0) < 0.05;
      };
      EXPECT_TRUE(flies("Q1") || flies("Q2") || flies("Q3"));
    }
  }
}

std::string name_of_setup(const testing::TestParamInfo<std::size_t>& param) {
  return setups()[param.param].name;
}
INSTANTIATE_TEST_SUITE_P(Setups, FirstLift, testing::Range(std::size_t{0}, setups().size()),
                         name_of_setup);

TEST(FirstLiftOfThree, LiftsInTheOrderOfNames) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    FlightBench bench(seed);
    bench.run(1.0);
    bench.send_command(OperatorAction::kArm);
    bench.run(0.3);
    bench.send_command(OperatorAction::kTakeOff);
    bool waited = false;
    bench.run(14.0, [&] {
      int lifting = 0;
      for (const Vehicle& vehicle : bench.vehicles()) {
        lifting += vehicle.position_m.z() > 0.02 && vehicle.position_m.z() < 0.28 ? 1 : 0;
      }
      EXPECT_LE(lifting, 1) << bench.time_s();
      waited = waited || FlightBench::has_reason(bench.vehicle("Q3"), "another vehicle is lifting",
                                                 bench.now());
    });
    EXPECT_TRUE(waited);
    for (const Vehicle& vehicle : bench.vehicles()) {
      EXPECT_NEAR(vehicle.position_m.z(), 1.0, 0.05) << vehicle.name;
      EXPECT_EQ(vehicle.out.state, FlightState::kHold) << vehicle.name;
    }
  }
}

// A vehicle that cannot lift is skipped after a time limit.
TEST(FirstLiftOfThree, SkipsAVehicleThatCannotLift) {
  for (const char* broken : {"Q1", "Q2", "Q3"}) {
    FlightBench bench(4);
    const auto knobs = [&] { bench.vehicle(broken).knobs.cannot_lift = true; };
    bench.run(1.0, knobs);
    knobs();
    bench.send_command(OperatorAction::kArm);
    bench.run(0.3, knobs);
    knobs();
    bench.send_command(OperatorAction::kTakeOff);
    bench.run(30.0, knobs);
    for (const Vehicle& vehicle : bench.vehicles()) {
      if (vehicle.name == broken) {
        EXPECT_EQ(vehicle.out.state, FlightState::kKilled);
        EXPECT_TRUE(FlightBench::has_reason(vehicle, "body does not lift", bench.now()));
        EXPECT_FALSE(vehicle.is_armed);
      } else {
        EXPECT_NEAR(vehicle.position_m.z(), 1.0, 0.05) << vehicle.name << " without " << broken;
      }
    }
  }
}

// Take-off orders for Q3 and, shortly afterwards, for Q1.
TEST(FirstLiftOfThree, LiftsInTheOrderOfCommands) {
  for (const double later_s : {0.02, 0.3, 1.0, 2.0}) {
    FlightBench bench(4);
    bench.run(1.0);
    bench.send_command(OperatorAction::kArm);
    bench.run(0.3);
    bench.send_command(OperatorAction::kTakeOff, "Q3");
    bench.run(later_s);
    bench.send_command(OperatorAction::kTakeOff, "Q1");
    bench.run(10.0);
    for (const char* name : {"Q1", "Q3"}) {
      EXPECT_NEAR(bench.vehicle(name).position_m.z(), 1.0, 0.05) << name << " " << later_s;
    }
    EXPECT_LT(bench.vehicle("Q2").position_m.z(), 0.01);
  }
}

// An armed vehicle without a take-off order rises: a person lifts it, or mocap shows the body of
// another vehicle.
TEST(FirstLiftOfThree, StopsABodyThatRisesWithoutAnOrder) {
  FlightBench bench(4);
  bench.run(1.0);
  bench.send_command(OperatorAction::kArm);
  bench.run(0.5);
  Vehicle& q1 = bench.vehicle("Q1");
  ASSERT_TRUE(q1.is_armed);
  bench.run(0.6, [&] { q1.velocity_mps.z() = 0.5; });
  EXPECT_EQ(q1.out.state, FlightState::kKilled);
  EXPECT_FALSE(q1.is_armed);
  EXPECT_TRUE(FlightBench::has_reason(q1, "uncommanded rise", bench.now()));
}

// Real autopilots take up to 30 s to arm and several seconds to spool up. By then the order of the
// commands is forgotten and mocap does not show a rise yet, so vehicles report their own lift.
TEST(LiftQueue, WaitsForReportedLiftsThenOrdersByName) {
  const scenario::Scenario scenario = FlightBench::scenario();
  const drivers::SafetyLimits limits = drivers::limits_for(scenario, "Q2");
  const Time start = from_utime(1'700'000'000'000'000);
  drivers::LiftQueue second(scenario, "Q2");
  drivers::LiftQueue third(scenario, "Q3");
  const auto look = [&](double at_s) {
    second.update({}, limits, start + from_seconds(at_s));
    third.update({}, limits, start + from_seconds(at_s));
  };
  for (const double begin_s : {0.0, 20.0}) {  // repeated later with the same queues
    look(begin_s);
    EXPECT_FALSE(second.is_blocked());
    for (int i = 0; i <= 40; ++i) {
      second.on_lifting("Q1", start + from_seconds(begin_s + 0.1 * i));
      third.on_lifting("Q1", start + from_seconds(begin_s + 0.1 * i));
      look(begin_s + 0.1 * i);
      EXPECT_TRUE(second.is_blocked());
      EXPECT_TRUE(third.is_blocked());
    }
    double second_s = 0.0;
    double third_s = 0.0;
    for (int i = 0; i <= 100; ++i) {
      const double at_s = begin_s + 4.0 + 0.02 * i;
      look(at_s);
      second_s = second_s > 0.0 || second.is_blocked() ? second_s : at_s;
      third_s = third_s > 0.0 || third.is_blocked() ? third_s : at_s;
    }
    EXPECT_GT(second_s, begin_s + 4.4);
    EXPECT_GT(third_s, second_s + 0.1) << "long enough for the third to hear of the second";
    EXPECT_LT(third_s, begin_s + 5.5);
  }
}

// The motors of two vehicles start at the same instant.
TEST(LiftQueue, StaggersSimultaneousStarts) {
  const scenario::Scenario scenario = FlightBench::scenario();
  const drivers::SafetyLimits limits = drivers::limits_for(scenario, "Q1");
  const Time start = from_utime(1'700'000'000'000'000);
  double begun_s[3] = {};
  const char* const names[] = {"Q1", "Q2", "Q3"};
  for (int i = 0; i < 3; ++i) {
    drivers::LiftQueue queue(scenario, names[i]);
    queue.begin_turn(start);
    for (int k = 1; k < 100 && begun_s[i] == 0.0; ++k) {
      queue.update({}, limits, start + k * Duration{20'000});
      begun_s[i] = queue.is_blocked() ? 0.0 : 0.02 * k;
    }
  }
  EXPECT_GT(begun_s[0], 0.0);
  EXPECT_GT(begun_s[1], begun_s[0] + 0.1);
  EXPECT_GT(begun_s[2], begun_s[1] + 0.1);
}

// The test step and turn of a lift are recognised only in the commanded direction and beyond 0.3 of
// the commanded amount, for any ground position and yaw.
TEST(Lift, IsVerifiedByTheCommandedStepAndTurn) {
  const drivers::SafetyLimits limits = drivers::limits_for(FlightBench::scenario(), "Q1");
  const Time start = from_utime(1'700'000'000'000'000);
  const auto proves = [&](const Pose2& rest, double x_share, double y_share, double turn_share) {
    drivers::Lift own;
    drivers::Course course(0.25);
    own.begin(lift(rest, 0.1), {}, limits, start);
    EXPECT_DOUBLE_EQ(own.rest_m(), 0.1);
    EXPECT_DOUBLE_EQ(own.height_m(), 0.1 + limits.lift_height_m);
    EXPECT_EQ(own.phase(), drivers::Lift::Phase::kRising);
    const Eigen::Vector3d hover_m(rest.x_m, rest.y_m, own.height_m());
    EXPECT_FALSE(own.step(hover_m, rest.yaw_rad, course, limits, start));
    EXPECT_EQ(own.phase(), drivers::Lift::Phase::kProving);
    const drivers::Setpoint asked = course.planned_at(start);
    Eigen::Vector3d gone_m = asked.position_world_m - hover_m;
    EXPECT_NEAR(std::abs(gone_m.x()), limits.lift_step_m, 1e-12);
    EXPECT_NEAR(std::abs(gone_m.y()), limits.lift_step_m, 1e-12);
    EXPECT_NEAR(wrap_to_pi(asked.yaw_rad - rest.yaw_rad), limits.lift_turn_rad, 1e-12);
    gone_m = gone_m.cwiseProduct(Eigen::Vector3d(x_share, y_share, 0.0));
    const double yaw_rad = wrap_to_pi(rest.yaw_rad + turn_share * limits.lift_turn_rad);
    const bool is_proven = own.step(hover_m + gone_m, yaw_rad, course, limits, start);
    EXPECT_EQ(own.is_under_way(), !is_proven);
    const drivers::Setpoint then =
        course.planned_at(start);  // ground position once verified, else the step
    const Eigen::Vector2d back_m =
        is_proven ? rest.position_m() : Eigen::Vector2d(asked.position_world_m.head<2>());
    EXPECT_LT((then.position_world_m.head<2>() - back_m).norm(), 1e-12);
    const double back_rad = is_proven ? rest.yaw_rad : asked.yaw_rad;
    EXPECT_NEAR(wrap_to_pi(then.yaw_rad - back_rad), 0.0, 1e-12);
    return is_proven;
  };
  for (const Pose2& rest : {Pose2{0.0, 0.0, 0.0}, Pose2{-1.0, 0.5, 3.1}, Pose2{1.0, -0.5, -2.0}}) {
    for (const double x_share : {-1.0, -0.31, 0.29, 0.31, 1.0}) {
      for (const double y_share : {-1.0, 0.29, 0.31, 1.0}) {
        for (const double turn_share : {-1.0, 0.29, 0.31, 1.0}) {
          EXPECT_EQ(proves(rest, x_share, y_share, turn_share),
                    std::min({x_share, y_share, turn_share}) > 0.3)
              << x_share << " " << y_share << " " << turn_share;
        }
      }
    }
  }
}

// The first hover must not be higher than the commanded take-off height.
TEST(Lift, StaysBelowTheTakeOffHeight) {
  const drivers::SafetyLimits limits = drivers::limits_for(FlightBench::scenario(), "Q1");
  drivers::Lift own;
  own.begin(lift(Pose2{0.3, -0.2, 0.0}, limits.take_off_height_m - 0.05), {}, limits, Time{});
  EXPECT_DOUBLE_EQ(own.height_m(), limits.take_off_height_m);
}

}  // namespace
}  // namespace vantage::test
