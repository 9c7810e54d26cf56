// Tests that each row of the quadrotor's condition table can be triggered by external inputs:
// MAVLink bytes, mocap frames, plans, commands, and the state of the process.

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/safety/conditions.hpp"
#include "test/drivers/quadrotor/reason_bench.hpp"
#include "wire/mavlink/constants.hpp"

namespace vantage::drivers {
namespace {

namespace mavlink = wire::mavlink;
using models::AutopilotDialect;
using models::OperatorAction;
using test::FlightBench;
using test::kFreeAxis;
using test::ReasonBench;

struct Row {
  const char* name;
  std::function<void(ReasonBench&)> reach;
};

/// Returns a function that triggers a condition: the function hovers, calls `begin`, then runs for
/// `seconds`.
std::function<void(ReasonBench&)> hovering(double seconds,
                                           const std::function<void(ReasonBench&)>& begin) {
  return [seconds, begin](ReasonBench& up) {
    up.hover();
    begin(up);
    up.run(seconds);
  };
}

// Returns one entry for each row of the table, in the table's order.
std::vector<Row> rows() {
  namespace id = mavlink;
  return {
      {"emergency stop",
       hovering(0.1, [](ReasonBench& up) { up.command(OperatorAction::kEmergencyStop); })},
      {"tilt", hovering(1.0, [](ReasonBench& up) { up.report_attitude(1.4, 0.0, 0.0); })},
      {"fence far", hovering(3.0, [](ReasonBench& up) { up.set_velocity(-1.5, kFreeAxis, 0.0); })},
      {"pose lost low", hovering(3.0,
                                 [](ReasonBench& up) {
                                   up.set_velocity(-1.5, kFreeAxis, 0.0);
                                   up.run_until([&] { return up.place_m().x() < -0.3; }, 5.0);
                                   up.has_mocap = false;
                                 })},
      {"body does not lift",
       [](ReasonBench& up) {
         up.arm();
         up.stay_down();
         up.command(OperatorAction::kTakeOff);
         up.run(9.0);
       }},
      {"another body lifts",
       [](ReasonBench& up) {
         up.add_robots();
         double height_m = FlightBench::kFloorM;
         up.show_other([&] { return height_m; });
         up.arm();
         up.stay_down();
         up.command(OperatorAction::kTakeOff);
         up.run(1.0);
         for (int i = 0; i < 200; ++i) {
           height_m += 0.001;
           up.run(0.01);
         }
         up.alter_frame = nullptr;
       }},
      {"lift off course",
       [](ReasonBench& up) {
         up.begin_take_off();
         up.run_until([&] { return up.height_m() > 0.12; }, 10.0);
         up.set_velocity(0.6, kFreeAxis, kFreeAxis);
         up.run(2.0);
       }},
      {"lift disagrees",
       [](ReasonBench& up) {
         up.begin_take_off();
         up.run_until([&] { return up.height_m() > 0.12; }, 10.0);
         up.report_attitude(0.0, 0.0, 2.0);
         up.run(1.0);
       }},
      {"uncommanded rise",
       [](ReasonBench& up) {
         up.arm();
         up.set_velocity(kFreeAxis, kFreeAxis, 0.3);
         up.run(0.5);
       }},
      {"pose lost", hovering(1.0, [](ReasonBench& up) { up.has_mocap = false; })},
      {"fence",
       [](ReasonBench& up) {
         up.hover();
         up.set_velocity(-1.0, kFreeAxis, 0.0);
         up.run_until([&] { return up.place_m().x() < -0.3; }, 5.0);
       }},
      {"separation breach", hovering(0.5,
                                     [](ReasonBench& up) {
                                       up.walker_m = up.vehicle.world_from_body().translation_m +
                                                     Eigen::Vector3d(0.4, 0.0, 0.0);
                                     })},
      {"tracking lost",
       hovering(1.5, [](ReasonBench& up) { up.set_velocity(kFreeAxis, 3.0, 0.0); })},
      {"lift unproven",
       [](ReasonBench& up) {
         up.begin_take_off();
         up.run_until([&] { return up.height_m() > 0.12; }, 10.0);
         const Eigen::Vector2d at_m = up.place_m();
         up.each_step = [&up, at_m](Time) {
           const Eigen::Vector2d off_m = at_m - up.place_m();
           const Eigen::Vector3d mps = up.vehicle.velocity_world_mps();
           up.vehicle.controller().airframe().push(
               {5.0 * off_m.x() - mps.x(), -(5.0 * off_m.y() - mps.y()), 0.0});
         };
         up.run(15.0);
       }},
      {"battery empty", hovering(3.0, [](ReasonBench& up) { up.charge(0.03); })},
      {"battery critical", hovering(6.0, [](ReasonBench& up) { up.charge(0.1); })},
      {"battery silent", hovering(12.0, [](ReasonBench& up) { up.drop_batteries(); })},
      {"battery stuck", hovering(62.0,
                                 [](ReasonBench& up) {
                                   up.drop_batteries();
                                   up.each_step = [&up](Time) {
                                     mavlink::BatteryStatus out;
                                     out.battery_remaining = 85;
                                     up.deliver(out);
                                   };
                                 })},
      {"flight time",
       [](ReasonBench& up) {
         SafetyLimits limits = limits_for(up.scenario, "Q1");
         limits.flight_max_s = 5.0;
         up.driver = std::make_unique<QuadrotorDriver>(up.scenario, "Q1", limits);
         up.begin_take_off();
         up.run(15.0);
       }},
      {"motor", hovering(0.3,
                         [](ReasonBench& up) {
                           if (up.is_px4()) {
                             mavlink::SysStatus out;
                             out.onboard_control_sensors_present = mavlink::kSensorMotorOutputs;
                             out.onboard_control_sensors_enabled = mavlink::kSensorMotorOutputs;
                             out.battery_remaining = 80;
                             up.deliver(out);
                           } else {
                             mavlink::Statustext out;
                             out.severity = 0;
                             constexpr std::string_view kText = "Potential Thrust Loss (3)";
                             std::copy(kText.begin(), kText.end(), out.text.begin());
                             up.deliver(out);
                           }
                         })},
      {"autopilot lost", hovering(4.0, [](ReasonBench& up) { up.driver_receives_nothing = true; })},
      {"estimate lost", hovering(1.0, [](ReasonBench& up) { up.report_motion(1.2, 0.0); })},
      {"estimator failed",
       hovering(
           4.0,
           [](ReasonBench& up) {
             up.drop_messages({id::EstimatorStatus::kMessage.id, id::EkfStatusReport::kMessage.id});
           })},
      {"pose foreign", hovering(3.0, [](ReasonBench& up) { up.report_motion(0.0, 1.0); })},
      {"hover unsteady",
       hovering(4.0, [](ReasonBench& up) { up.set_velocity(kFreeAxis, 0.3, 0.0); })},
      {"does not sink", hovering(6.0,
                                 [](ReasonBench& up) {
                                   up.alter_frame = [k = 0](models::MocapFrame& frame) mutable {
                                     frame.bodies.front().world_from_body.translation_m.z() =
                                         1.0 + 1e-4 * (++k % 7);
                                   };
                                   up.command(OperatorAction::kLand);
                                 })},
      {"operator lost", hovering(4.0, [](ReasonBench& up) { up.has_operator = false; })},
      {"short of processor",
       hovering(4.0, [](ReasonBench& up) { up.driver->on_processor_wait(0.4); })},
      {"ending", hovering(0.2, [](ReasonBench& up) { up.driver->end(false); })},
      {"pose stale", hovering(0.3, [](ReasonBench& up) { up.has_mocap = false; })},
      {"pose late", hovering(3.0,
                             [](ReasonBench& up) {
                               up.has_mocap = false;  // instead, frames arrive 0.2 s late
                               up.alter_frame = [&up](models::MocapFrame frame) {
                                 frame.arrival = frame.stamp.time;
                                 frame.stamp.time -= std::chrono::milliseconds(200);
                                 up.driver->on_mocap(frame, up.now);
                               };
                             })},
      {"pose implausible", hovering(0.3,
                                    [](ReasonBench& up) {
                                      up.alter_frame = [](models::MocapFrame& frame) {
                                        frame.bodies.front().world_from_body.translation_m.x() +=
                                            1.0;
                                      };
                                    })},
      {"fence ahead",
       hovering(2.5, [](ReasonBench& up) { up.set_velocity(-1.0, kFreeAxis, 0.0); })},
      {"obstacle ahead",
       [](ReasonBench& up) {
         up.scenario.world.obstacles = {{{{0.2, 1.0}, {0.6, 3.0}}, 3.0}};
         up.restart_driver();
         up.hover();
         up.set_velocity(-1.0, kFreeAxis, 0.0);
         up.run(2.0);
       }},
      {"separation", hovering(0.5,
                              [](ReasonBench& up) {
                                up.walker_m = up.vehicle.world_from_body().translation_m +
                                              Eigen::Vector3d(0.53, 0.0, 0.0);
                              })},
      {"tracking", hovering(1.5, [](ReasonBench& up) { up.set_velocity(kFreeAxis, 1.2, 0.0); })},
      {"too fast", hovering(1.0, [](ReasonBench& up) { up.set_velocity(kFreeAxis, 1.8, 0.0); })},
      {"found flying", hovering(3.0, [](ReasonBench& up) { up.restart_driver(); })},
      {"no plan", hovering(0.5, [](ReasonBench& up) { up.command(OperatorAction::kFollow); })},
      {"planner late",
       [](ReasonBench& up) {
         up.hover();
         up.command(OperatorAction::kFollow);
         for (int i = 0; i < 4; ++i) {
           models::RobotPlan late = up.plan_on(0.3, 2.0);
           late.late = true;
           up.driver->on_plan(late, up.now);
           up.run(0.2);
         }
       }},
      {"map differs", hovering(0.1, [](ReasonBench& up) { up.driver->on_map(false); })},
      {"autopilot quiet",
       hovering(2.7, [](ReasonBench& up) { up.driver_receives_nothing = true; })},
      {"telemetry stale",
       hovering(1.6, [](ReasonBench& up) { up.driver_receives_nothing = true; })},
      {"estimate off", hovering(1.0, [](ReasonBench& up) { up.report_motion(0.5, 0.0); })},
      {"velocity disagrees", hovering(3.0, [](ReasonBench& up) { up.report_motion(0.0, 0.5); })},
      {"estimator doubtful",
       hovering(
           3.0,
           [](ReasonBench& up) {
             up.drop_messages({id::EstimatorStatus::kMessage.id, id::EkfStatusReport::kMessage.id});
           })},
      {"autopilot disobeys", hovering(2.5,
                                      [](ReasonBench& up) {
                                        up.vehicle.controller().set_mode(
                                            up.is_px4() ? 3U << 16U : 5U, up.now);
                                      })},
      {"operator quiet", hovering(2.0, [](ReasonBench& up) { up.has_operator = false; })},
      {"driver stalled",
       hovering(0.1, [](ReasonBench& up) { up.now += std::chrono::milliseconds(300); })},
      {"waits for processor",
       hovering(0.2, [](ReasonBench& up) { up.driver->on_processor_wait(0.4); })},
      {"pose aging", hovering(0.09, [](ReasonBench& up) { up.has_mocap = false; })},
      {"pose unsettled", [](ReasonBench& up) { up.run(0.3); }},
      {"body tilted",
       [](ReasonBench& up) {
         up.alter_frame = [](models::MocapFrame& frame) {
           frame.bodies.front().world_from_body.rotation =
               frame.bodies.front().world_from_body.rotation *
               Quaternion(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX()));
         };
         up.stay_on_ground();
       }},
      {"not at its start",
       [](ReasonBench& up) {
         up.scenario.robots[0].start.y_m += 1.0;
         up.restart_driver();
         up.stay_on_ground();
       }},
      {"attitude disagrees",
       [](ReasonBench& up) {
         up.report_attitude(0.3, 0.0, 0.0);
         up.stay_on_ground();
       }},
      {"yaw disagrees",
       [](ReasonBench& up) {
         up.report_attitude(0.0, 0.5, 0.0);
         up.stay_on_ground();
       }},
      {"another vehicle is lifting",
       [](ReasonBench& up) {
         up.add_robots();
         up.show_other([] { return FlightBench::kFloorM; });
         up.arm();
         models::OperatorCommand other = up.order(OperatorAction::kTakeOff);
         other.robot = "Q2";
         up.driver->on_command(other, up.now);
         models::OperatorCommand own = up.order(OperatorAction::kTakeOff);
         own.robot = "Q1";
         up.driver->on_command(own, up.now);
         up.run(1.0);
       }},
      {"body nearby",
       [](ReasonBench& up) {
         up.arm();
         up.walker_m = up.vehicle.world_from_body().translation_m + Eigen::Vector3d(0.6, 0.0, 0.0);
         up.run(0.2);
         up.command(OperatorAction::kTakeOff);
         up.run(0.5);
       }},
      {"planner silent",
       hovering(4.0, [](ReasonBench& up) { up.driver->on_plan(up.plan_on(0.3, 2.0), up.now); })},
      {"two planners", hovering(0.1,
                                [](ReasonBench& up) {
                                  up.driver->on_plan(up.plan_on(0.3, 2.0), up.now);
                                  models::RobotPlan other = up.plan_on(0.3, 2.0);
                                  other.stamp.run_id += 1;
                                  up.driver->on_plan(other, up.now);
                                })},
      {"another version",
       hovering(0.1, [](ReasonBench& up) { up.driver->on_other_version(up.now); })},
      {"plans refused",
       hovering(0.1, [](ReasonBench& up) { up.driver->on_plan(up.plan_on(9.0, 2.0), up.now); })},
      {"battery low", hovering(3.0, [](ReasonBench& up) { up.charge(0.2); })},
      {"battery for take-off",
       [](ReasonBench& up) {
         up.charge(0.2);
         up.stay_on_ground();
       }},
      {"host busy", hovering(0.2, [](ReasonBench& up) { up.driver->on_processor_wait(0.2); })},
  };
}

class ConditionReach : public ::testing::TestWithParam<AutopilotDialect> {};
INSTANTIATE_TEST_SUITE_P(Dialects, ConditionReach,
                         ::testing::Values(AutopilotDialect::kPx4, AutopilotDialect::kArdupilot),
                         [](const auto& chosen) { return std::string(name_of(chosen.param)); });

TEST_P(ConditionReach, ExternalInputsTriggerEveryRowOfTheTable) {
  const std::vector<Row> table = rows();
  for (const Condition& row : conditions()) {
    SCOPED_TRACE(row.name);
    const auto found = std::find_if(table.begin(), table.end(), [&](const Row& each) {
      return std::string_view(each.name) == row.name;
    });
    ASSERT_NE(found, table.end()) << "no test input triggers this row";
    ReasonBench up(GetParam());
    found->reach(up);
    EXPECT_TRUE(up.reasons_seen.contains(row.name)) << "now: " << up.reasons();
  }
}

}  // namespace
}  // namespace vantage::drivers
