// Tests an artificial flight that keeps every invariant, and flights that each break one invariant.

#include "test/support/flight_invariants.hpp"

#include <cmath>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "test/support/made_up_flight.hpp"

namespace vantage::test {
namespace {

using models::FlightState;
using Names = std::vector<std::string>;

TEST(FlightInvariants, HoldForAnUndisturbedFlight) {
  EXPECT_EQ(violations(MadeUpFlight().record()), Names{});
  EXPECT_EQ(violations(FlightRecord()), Names{"nothing flew: no SCENARIO, or no vehicle"});
}

TEST(FlightInvariants, ReportVehicleValueAndLimit) {
  MadeUpFlight flight;
  flight.is = [](double t_s, models::TruthBody& body) {
    if (body.name == "Q2" && std::abs(t_s - 9.0) < 0.1) {
      body.velocity_world_mps.y() = 1.2;
    }
    return true;
  };
  const auto lines = violations(flight.record());
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_TRUE(lines[0].starts_with("Q2 speed: 1.")) << lines[0];
  EXPECT_TRUE(lines[0].ends_with("of its limit (at most 1.15)")) << lines[0];
}

TEST(FlightInvariants, RequireNoFollowShareOfRobotsThatMayHold) {
  MadeUpFlight flight;
  flight.says = [](double t_s, models::VehicleStatus& status) {
    if (t_s > 7.0 && t_s < 9.0) {
      status.state = FlightState::kHold;
    }
    return true;
  };
  FlightBounds bounds;
  EXPECT_EQ(broken(flight.record(), bounds), (Names{"Q1 following", "Q2 following"}));
  bounds.may_hold = {"Q1"};
  EXPECT_EQ(broken(flight.record(), bounds), Names{"Q2 following"});
}

// Breaks each invariant at one moment of the flight, for Q1 alone.
TEST(FlightInvariants, DetectEachViolation) {
  struct Case {
    std::function<bool(double, models::VehicleStatus&)> says;
    std::function<bool(double, models::TruthBody&)> is;
    Names broken;
  };
  const auto during = [](double t_s, double begin_s, double lasts_s) {
    return t_s >= begin_s && t_s < begin_s + lasts_s;
  };
  const auto q1 = [&during](double begin_s, double lasts_s, auto change) {
    return [=](double t_s, auto& message) {
      const std::string* name = nullptr;
      if constexpr (requires { message.robot; }) {
        name = &message.robot;
      } else {
        name = &message.name;
      }
      return *name != "Q1" || !during(t_s, begin_s, lasts_s) || change(message);
    };
  };
  const auto as_it_is = [](double, auto&) { return true; };
  const Case cases[] = {
      {q1(5.0, 2.0,
          [](models::VehicleStatus& changed) {
            changed.state = FlightState::kHold;
            return true;
          }),
       as_it_is,
       {"Q1 following"}},
      {q1(5.0, 12.0,
          [](models::VehicleStatus& changed) {
            changed.setpoint_height_m += 0.2;
            return true;
          }),
       as_it_is,
       {"Q1 set-point error"}},
      {as_it_is,
       q1(5.0, 0.3,
          [](models::TruthBody& body) {
            body.world_from_body = lift({body.world_from_body.translation_m.x(), 0.0, 0.0}, 1.0);
            return true;
          }),
       {"Q1 turn"}},
      {q1(5.0, 0.1,
          [](models::VehicleStatus& changed) {
            changed.setpoint.y_m += 0.3;
            return true;
          }),
       as_it_is,
       {"Q1 continuity"}},
      {q1(17.95, 0.5,
          [](models::VehicleStatus& changed) {
            changed.state = FlightState::kFollow;
            changed.reasons = {"fence"};
            return true;
          }),
       as_it_is,
       {"Q1 fence"}},
      {q1(5.0, 0.6, [](models::VehicleStatus&) { return false; }), as_it_is, {"Q1 ages"}},
      {as_it_is, q1(5.0, 0.6, [](models::TruthBody&) { return false; }), {"Q1 ages"}},
  };
  for (const Case& each : cases) {
    MadeUpFlight flight;
    flight.says = each.says;
    flight.is = each.is;
    EXPECT_EQ(broken(flight.record()), each.broken);
  }
}

TEST(FlightInvariants, ReportNearMissForBothVehicles) {
  MadeUpFlight flight;
  flight.is = [](double t_s, models::TruthBody& body) {
    if (body.name == "Q2" && is_between_words(t_s)) {
      body.world_from_body.translation_m.x() = -3.0 + 0.5 * std::sin(t_s) + 0.45;
    }
    return true;
  };
  EXPECT_EQ(broken(flight.record()), (Names{"Q1 separation", "Q2 separation"}));
}

TEST(FlightInvariants, OutsideMeansBeyondBoundsOrInAnObstacle) {
  for (const Eigen::Vector2d& place_m : {Eigen::Vector2d(-3.0, 2.1), Eigen::Vector2d(-1.5, 0.8)}) {
    MadeUpFlight flight;
    flight.is = [&](double t_s, models::TruthBody& body) {
      if (body.name == "Q1" && is_between_words(t_s)) {
        body.world_from_body.translation_m.head<2>() = place_m;
      }
      return true;
    };
    EXPECT_EQ(broken(flight.record()), Names{"Q1 fence"});
  }
}

// A ground robot's fence, speed and turns are judged on the ground; a flying vehicle's are not
// judged at such a height.
TEST(FlightInvariants, GroundRobotsAreCheckedOnTheGround) {
  const std::string flying = "height_m: 1.0\n";
  const std::string ground =
      "height_m: 0.2\n    rover: {url: \"udpout://127.0.0.1:7700\", number: 4}\n";
  const auto of_q1 = [&](bool is_rover, const std::function<void(models::TruthBody&)>& change) {
    MadeUpFlight flight;
    if (is_rover) {
      flight.yaml.replace(flight.yaml.find(flying), flying.size(), ground);
    }
    flight.says = [](double, models::VehicleStatus& status) {
      status.setpoint_height_m = status.robot == "Q1" ? 0.2 : 1.0;
      return true;
    };
    flight.is = [&](double t_s, models::TruthBody& body) {
      if (body.name == "Q1") {
        body.world_from_body.translation_m.z() = 0.2;
        if (is_between_words(t_s)) {
          change(body);
        }
      }
      return true;
    };
    return broken(flight.record());
  };
  const auto far_off = [](models::TruthBody& body) {
    body.world_from_body.translation_m.y() = 2.1;
  };
  const auto fast = [](models::TruthBody& body) { body.velocity_world_mps.y() = 1.5; };
  const auto near = [](models::TruthBody& body) {
    body.world_from_body.translation_m = {0.5 * std::sin(9.05), 0.3, 1.0};
  };
  const auto turned = [](models::TruthBody& body) {
    body.world_from_body = lift({body.world_from_body.translation_m.x(), 0.0, 0.0}, 0.2);
  };
  EXPECT_EQ(of_q1(true, [](models::TruthBody&) {}), Names{});
  EXPECT_EQ(of_q1(true, far_off), Names{"Q1 fence"});
  EXPECT_EQ(of_q1(true, fast), Names{"Q1 speed"});
  EXPECT_EQ(of_q1(true, turned), Names{"Q1 turn"});
  EXPECT_EQ(of_q1(true, near), (Names{"Q1 separation", "Q2 separation"}));
  EXPECT_EQ(of_q1(false, far_off), Names{});
  EXPECT_EQ(of_q1(false, fast), Names{});
  EXPECT_EQ(of_q1(false, turned), Names{});
}

// Messages of another run are refused while the vehicle's own run is active. After a silence they
// are accepted, and the record reports that the flight had another driver.
TEST(FlightInvariants, CountForeignMessagesAndDriverRestarts) {
  MadeUpFlight beside;
  beside.add_messages = [](double t_s, FlightRecord& record) {
    if (std::abs(t_s - 9.01) < 0.05) {
      models::VehicleStatus status = MadeUpFlight::state_of("Q1", t_s);
      status.stamp.run_id = 66;
      status.state = FlightState::kKilled;
      MadeUpFlight::give(record, "VEHICLE_Q1", MadeUpFlight::at(t_s), status);
      models::TruthFrame truth;
      truth.stamp = {MadeUpFlight::at(t_s), 77, 0};
      MadeUpFlight::give(record, "TRUTH", MadeUpFlight::at(t_s), truth);
    }
  };
  EXPECT_EQ(broken(beside.record()), (Names{"TRUTH believed", "Q1 believed"}));

  MadeUpFlight anew;
  anew.says = [](double t_s, models::VehicleStatus& status) {
    status.stamp.run_id += t_s > 9.0 && status.robot == "Q1" ? 100 : 0;
    return status.robot != "Q1" || t_s < 8.3 || t_s > 9.0;
  };
  EXPECT_EQ(broken(anew.record()), (Names{"Q1 believed", "Q1 ages"}));
  FlightBounds mishap;
  mishap.runs_max = 2;
  mishap.gap_max_s = 1.0;
  EXPECT_EQ(broken(anew.record(), mishap), Names{});
}

TEST(FlightInvariants, ReportAVehicleThatNeverFollowed) {
  MadeUpFlight flight;
  flight.says = [](double, models::VehicleStatus& status) {
    status.state = status.robot == "Q1" ? FlightState::kIdle : status.state;
    return true;
  };
  EXPECT_EQ(violations(flight.record()), Names{"Q1 following: it never followed a plan"});
}

}  // namespace
}  // namespace vantage::test
