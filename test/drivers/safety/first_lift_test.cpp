// Tests that flight safety verifies, on the ground or within the first 0.3 m of the lift, that the
// commanded vehicle is the body that mocap shows.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/angle.hpp"
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
  const char* addressee;  ///< vehicles that must not fly
  bool flies;             ///< true if the set-up is correct
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
TEST_P(FirstLift, StaysBelowTheTestHeightIfTheSetupIsWrong) {
  const WorldSetup setup = setups()[GetParam()];
  // A single vehicle takes off, or all take off simultaneously.
  for (const char* addressee : {"", "Q1", "Q2"}) {
    SCOPED_TRACE(std::string("commanded: ") + (*addressee == '\0' ? "all" : addressee));
    FlightBench bench(7);
    bench.wiring() = setup.wiring;
    bench.run(1.0);
    bench.send_command(OperatorAction::kArm);
    bench.run(0.5);
    bench.send_command(OperatorAction::kTakeOff, addressee);
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
      const bool is_concerned =
          std::string(setup.addressee).find(vehicle.name) != std::string::npos;
      if (setup.flies || !is_concerned) {
        continue;
      }
      EXPECT_LT(highest_m[i], kProofM);
      EXPECT_LT(farthest_m[i], 0.5);
      EXPECT_NEAR(vehicle.position_m.z(), 0.0, 1e-9);
      if (setup.wiring.swaps_names || setup.wiring.swaps_addresses) {
        EXPECT_FALSE(vehicle.is_armed) << "a wrong set-up is detected";
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

// Q3 receives a take-off order, and shortly afterwards Q1.
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

}  // namespace
}  // namespace vantage::test
