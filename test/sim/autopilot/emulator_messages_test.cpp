// Tests each message that an emulated autopilot sends or accepts.

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "core/axes.hpp"
#include "sim/autopilot/autopilot_emulator.hpp"
#include "test/sim/autopilot/emulator_bench.hpp"
#include "wire/mavlink/constants.hpp"
#include "wire/mavlink/messages.hpp"
#include "wire/mavlink/parameter.hpp"
#include "wire/mavlink/parser.hpp"
#include "wire/mavlink/single.hpp"

namespace vantage::sim {
namespace {

namespace mavlink = wire::mavlink;
using models::AutopilotDialect;
using test::EmulatorBench;
using test::flying;
using test::spec_of;
using test::target_of;

constexpr Time kBoot = test::kBenchBoot;

TEST(EmulatorMessages, StartsWithItsWorldPosition) {
  const EmulatorBench bench(AutopilotDialect::kPx4);
  EXPECT_LT(
      (bench.emulator.world_from_body().translation_m - Eigen::Vector3d(1.0, 2.0, 0.25)).norm(),
      1e-12);
  EXPECT_NEAR(flatten(bench.emulator.world_from_body()).yaw_rad, 0.5, 1e-12);
  EXPECT_EQ(bench.emulator.velocity_world_mps(), Eigen::Vector3d::Zero());
}

TEST(EmulatorMessages, SendsHeartbeatEachSecond) {
  struct Row {
    AutopilotDialect dialect;
    int id;
    std::uint32_t mode;
    int timesyncs;  ///< number of TIMESYNC messages in ten seconds and one step
  };
  for (const Row& row : {Row{AutopilotDialect::kPx4, 12, 0x03040000U, 101},
                         Row{AutopilotDialect::kArdupilot, 3, 0U, 2}}) {
    EmulatorBench bench(row.dialect);
    bench.run(10.005);
    const auto heartbeats = bench.all<mavlink::Heartbeat>();
    EXPECT_EQ(heartbeats.size(), 11u);
    EXPECT_EQ(bench.all<mavlink::Timesync>().size(), static_cast<std::size_t>(row.timesyncs));
    EXPECT_EQ(bench.all<mavlink::Timesync>().front().tc1, 0);
    EXPECT_EQ(bench.all<mavlink::Timesync>().front().ts1, 5'000'000) << "its clock, in ns";
    const mavlink::Heartbeat& heartbeat = heartbeats.back();
    EXPECT_EQ(heartbeat.autopilot, row.id);
    EXPECT_EQ(heartbeat.type, 2) << "a quadrotor";
    EXPECT_EQ(heartbeat.custom_mode, row.mode);
    EXPECT_EQ(heartbeat.base_mode, 1);
    EXPECT_EQ(heartbeat.system_status, 3) << "standby";
    EXPECT_EQ(heartbeat.mavlink_version, 3);
    std::uint8_t sequence = 0;
    for (const mavlink::Frame& frame : bench.frames) {
      EXPECT_EQ(frame.origin.system_id, 9);
      EXPECT_EQ(frame.origin.component_id, 1);
      EXPECT_EQ(frame.origin.sequence, sequence++);
    }
  }
}

TEST(EmulatorMessages, SendsOwnMessagesAtRequestedRate) {
  EmulatorBench bench(AutopilotDialect::kPx4);
  const std::uint16_t kInterval = mavlink::command::kSetMessageInterval;
  EXPECT_EQ(bench.command(kInterval, 30.0F, 20'000.0F), 0);
  bench.frames.clear();
  bench.run(1.0);
  EXPECT_EQ(bench.all<mavlink::Attitude>().size(), 50u);
  EXPECT_EQ(bench.command(kInterval, 30.0F, 5'000.0F), 0);
  EXPECT_EQ(bench.command(kInterval, 30.0F, 4'999.0F), 4);
  EXPECT_EQ(bench.command(kInterval, 30.0F, -1.0F), 4);
  EXPECT_EQ(bench.command(kInterval, 30.0F, std::numeric_limits<float>::quiet_NaN()), 4);
  EXPECT_EQ(bench.command(kInterval, 9'999.0F, 20'000.0F), 4) << "unknown message";
  EXPECT_EQ(bench.command(kInterval, 193.0F, 20'000.0F), 4);
  EXPECT_EQ(bench.command(kInterval, 230.0F, 20'000.0F), 0);
  EXPECT_EQ(bench.command(kInterval, 242.0F, 20'000.0F), 0)
      << "accepted, although it has no source";
  bench.frames.clear();
  bench.run(1.0);
  EXPECT_EQ(bench.all<mavlink::Attitude>().size(), 200u);
  EXPECT_EQ(bench.all<mavlink::EstimatorStatus>().size(), 50u);
  EXPECT_EQ(bench.all<mavlink::HomePosition>().size(), 0u);
  EmulatorBench other(AutopilotDialect::kArdupilot);
  EXPECT_EQ(other.command(kInterval, 193.0F, 20'000.0F), 0);
  EXPECT_EQ(other.command(kInterval, 230.0F, 20'000.0F), 4);
}

TEST(EmulatorMessages, AcceptsOwnAddressAndBroadcastOnly) {
  EmulatorBench bench(AutopilotDialect::kPx4);
  EXPECT_EQ(bench.command(mavlink::command::kSetMode, 1.0F, 4.0F, 6.0F, 0.0F, 8), -1);
  EXPECT_EQ(bench.command(mavlink::command::kSetMode, 1.0F, 4.0F, 6.0F, 0.0F, 0), 0);
  EXPECT_EQ(bench.emulator.controller().mode(), 0x06040000U);
  EXPECT_EQ(bench.command(mavlink::command::kSetMode, 1.0F, 6.0F), 0);
  EXPECT_EQ(bench.emulator.controller().mode(), 0x00060000U);
  EXPECT_EQ(bench.command(mavlink::command::kLand), 0);
  EXPECT_EQ(bench.emulator.controller().mode(), 0x06040000U);
  EXPECT_EQ(bench.command(12'345), 3) << "unsupported";
  EXPECT_EQ(bench.command(mavlink::command::kTakeOff, 0.0F, 0.0F, 0.0F, 1.0F), 1);
  EXPECT_EQ(bench.command(mavlink::command::kArmDisarm, 0.0F), 0)
      << "disarming a disarmed vehicle is accepted";
  EmulatorBench other(AutopilotDialect::kArdupilot);
  EXPECT_EQ(other.command(mavlink::command::kSetMode, 1.0F, 9.0F, 3.0F), 0);
  EXPECT_EQ(other.emulator.controller().mode(), 9U) << "ArduPilot has no sub-modes";
}

TEST(EmulatorMessages, ReportsPoseInAutopilotAxes) {
  EmulatorBench bench = flying();
  auto target = target_of(mavlink::mask::kVelocityAndYawRate);
  target.vx = 1.0F;
  target.vy = -1.4F;
  target.vz = -0.3F;
  target.yaw_rate = 0.4F;
  bench.command(mavlink::command::kSetMessageInterval, 32.0F, 5000.0F);
  bench.command(mavlink::command::kSetMessageInterval, 30.0F, 5000.0F);
  bench.send_poses(0.4, &target);
  const mavlink::LocalPositionNed motion = bench.all<mavlink::LocalPositionNed>().back();
  EXPECT_EQ(motion.time_boot_ms, static_cast<std::uint32_t>((bench.now - kBoot).count() / 1000));
  const Eigen::Vector3d place_m = bench.place_m();
  EXPECT_NEAR(motion.x, place_m.x(), 0.02);
  EXPECT_NEAR(motion.y, place_m.y(), 0.02);
  EXPECT_NEAR(motion.z, place_m.z(), 0.02);
  const Eigen::Vector3d velocity_mps = convert_axes(bench.emulator.velocity_world_mps());
  EXPECT_NEAR(motion.vx, velocity_mps.x(), 1e-5);
  EXPECT_NEAR(motion.vy, velocity_mps.y(), 1e-5);
  EXPECT_NEAR(motion.vz, velocity_mps.z(), 1e-5);
  EXPECT_GT(velocity_mps.x(), 0.2);
  EXPECT_LT(velocity_mps.y(), -0.2);
  const mavlink::Attitude attitude = bench.all<mavlink::Attitude>().back();
  const Eigen::Matrix3d reported = (Eigen::AngleAxisd(attitude.yaw, Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(attitude.pitch, Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(attitude.roll, Eigen::Vector3d::UnitX()))
                                       .toRotationMatrix();
  const Quaternion truth = convert_axes(bench.emulator.world_from_body().rotation);
  EXPECT_LT((reported - truth.toRotationMatrix()).norm(), 1e-5);
  EXPECT_GT(std::abs(attitude.roll), 0.02);
  EXPECT_LT(attitude.pitch, -0.02) << "nose down in forward flight";
  EXPECT_NEAR(attitude.yawspeed, bench.emulator.controller().airframe().yaw_rate_radps(), 1e-6);
  EXPECT_GT(attitude.yawspeed, 0.1);
  EXPECT_EQ(attitude.time_boot_ms, motion.time_boot_ms);
  const auto status = bench.request<mavlink::EstimatorStatus>();
  EXPECT_EQ(status.time_usec, static_cast<std::uint64_t>((bench.now - kBoot).count()));
  EXPECT_EQ(status.flags, 0x12F);
  EXPECT_EQ(bench.request<mavlink::ExtendedSysState>().landed_state, 2);
  const auto heartbeat = bench.request<mavlink::Heartbeat>();
  EXPECT_EQ(heartbeat.base_mode, 129);
  EXPECT_EQ(heartbeat.system_status, 4) << "active";
}

// Without poses PX4 reports its power-up position as the origin; ArduPilot sends no position.
TEST(EmulatorMessages, Px4ReportsZeroAndArdupilotNothingWithoutPoses) {
  EmulatorBench bench(AutopilotDialect::kPx4);
  const auto motion = bench.request<mavlink::LocalPositionNed>();
  EXPECT_EQ(motion.x, 0.0F);
  EXPECT_EQ(motion.y, 0.0F);
  EXPECT_EQ(motion.z, 0.0F);
  EmulatorBench other(AutopilotDialect::kArdupilot);
  EXPECT_EQ(other.command(mavlink::command::kSetMessageInterval, 32.0F, 5000.0F), 0);
  other.run(1.0);
  EXPECT_TRUE(other.all<mavlink::LocalPositionNed>().empty());
}

TEST(EmulatorMessages, ReportsBatteryPerDialect) {
  struct Row {
    BatteryReport report;
    int remaining;
  };
  for (const Row& row : {Row{BatteryReport::kShare, 46}, Row{BatteryReport::kVoltageOnly, -1},
                         Row{BatteryReport::kFromFull, 100}}) {
    AutopilotEmulatorSpec spec = spec_of(AutopilotDialect::kPx4);
    spec.battery = row.report;
    spec.airframe.battery_start_share = 0.456;
    EmulatorBench bench(spec);
    const auto battery = bench.request<mavlink::BatteryStatus>();
    EXPECT_EQ(battery.battery_remaining, row.remaining);
    EXPECT_EQ(battery.voltages[0], std::lround(1000.0 * (10.5 + 0.456 * 2.1)));
    EXPECT_EQ(battery.charge_state, 1);
    const auto status = bench.request<mavlink::SysStatus>();
    EXPECT_EQ(status.battery_remaining, row.remaining);
    EXPECT_EQ(status.voltage_battery, battery.voltages[0]);
    for (const auto& [share, state] :
         {std::pair{0.151, 1}, std::pair{0.149, 2}, std::pair{0.051, 2}, std::pair{0.049, 4}}) {
      bench.emulator.controller().airframe().set_battery_share(share);
      EXPECT_EQ(bench.request<mavlink::BatteryStatus>().charge_state, state) << share;
    }
  }
  EmulatorBench bench = flying();
  // The current is 25 A at the maximum thrust acceleration, 20 m/s². In hover, thrust acceleration
  // and current are lower by the ratio g / (20 m/s²).
  EXPECT_NEAR(bench.request<mavlink::BatteryStatus>().current_battery, 2500.0 * 9.81 / 20.0, 60.0);
}

TEST(EmulatorMessages, ReadsWritesAndResetsParameters) {
  EmulatorBench bench(AutopilotDialect::kPx4);
  const auto ask = [&](const std::string& name, std::uint8_t to = 9) {
    mavlink::ParamRequestRead out;
    out.param_id = mavlink::parameter_id(name);
    out.target_system = to;
    bench.frames.clear();
    bench.send(out);
    return bench.all<mavlink::ParamValue>();
  };
  const auto set = [&](const std::string& name, float value, std::uint8_t to = 9) {
    mavlink::ParamSet out;
    out.param_id = mavlink::parameter_id(name);
    out.param_value = value;
    out.param_type = mavlink::parameter_type::kFloat;
    out.target_system = to;
    bench.frames.clear();
    bench.send(out);
    return bench.all<mavlink::ParamValue>();
  };
  ASSERT_EQ(ask("COM_OF_LOSS_T").size(), 1u);
  EXPECT_EQ(mavlink::parameter_name(ask("COM_OF_LOSS_T")[0].param_id), "COM_OF_LOSS_T");
  EXPECT_EQ(ask("COM_OF_LOSS_T")[0].param_index, 0xFFFF);
  const std::uint16_t count = ask("COM_OF_LOSS_T")[0].param_count;
  EXPECT_TRUE(ask("COM_OF_LOSS_T", 8).empty());
  EXPECT_EQ(bench.emulator.ignored(), 0);
  EXPECT_TRUE(ask("NO_SUCH_NAME").empty());
  EXPECT_EQ(bench.emulator.ignored(), 1);
  ASSERT_EQ(set("COM_OF_LOSS_T", 0.75F).size(), 1u);
  EXPECT_EQ(bench.emulator.parameter("COM_OF_LOSS_T"), 0.75);
  EXPECT_TRUE(set("COM_OF_LOSS_T", 0.5F, 8).empty());
  EXPECT_EQ(bench.emulator.parameter("COM_OF_LOSS_T"), 0.75);
  EXPECT_TRUE(set("NO_SUCH_NAME", 0.5F).empty());
  EXPECT_EQ(bench.emulator.parameter("NO_SUCH_NAME"), std::nullopt);
  // A new parameter with an integral value becomes an integer, otherwise a float.
  bench.emulator.set_parameter("WHOLE", 7.0);
  bench.emulator.set_parameter("PART", 7.5);
  ASSERT_EQ(ask("WHOLE").size(), 1u);
  EXPECT_EQ(ask("WHOLE")[0].param_type, mavlink::parameter_type::kInt32);
  EXPECT_EQ(ask("PART")[0].param_type, mavlink::parameter_type::kFloat);
  EXPECT_EQ(ask("PART")[0].param_value, 7.5F);
  EXPECT_EQ(ask("PART")[0].param_count, count + 2);
  bench.emulator.set_parameter("PART", 8.0);
  EXPECT_EQ(ask("PART")[0].param_type, mavlink::parameter_type::kFloat)
      << "keeps the type with which it was created";
  bench.emulator.forget_parameter("PART");
  EXPECT_TRUE(ask("PART").empty());
}

// PX4 accepts poses in each coordinate frame that it knows, and counts the others as refused.
TEST(EmulatorMessages, Px4ConvertsPoseFrames) {
  struct Row {
    std::uint8_t frame;
    Eigen::Vector3d said_m;
    bool is_taken;
  };
  const Eigen::Vector3d ned(1.0, -2.0, -0.25);  // m; position relative to the start
  for (const Row& row :
       {Row{mavlink::frame::kLocalNed, ned, true}, Row{mavlink::frame::kLocalFrd, ned, true},
        Row{4, {-2.0, 1.0, 0.25}, true},  // east, north, up
        Row{21, {1.0, 2.0, 0.25}, true},  // forward, left, up
        Row{0, ned, false}, Row{8, ned, false}, Row{12, ned, false}}) {
    EmulatorBench bench(AutopilotDialect::kPx4);
    bench.run(0.1);
    auto pose = bench.pose(row.said_m);
    pose.frame_id = row.frame;
    bench.send(pose);
    EXPECT_EQ(bench.poses(), row.is_taken ? 1 : 0) << int{row.frame};
    EXPECT_EQ(bench.emulator.ignored(), row.is_taken ? 0 : 1);
    if (row.is_taken) {
      EXPECT_LT((bench.emulator.controller().estimator().position_m() - ned).norm(), 1e-6)
          << int{row.frame};
    }
  }
}

TEST(EmulatorMessages, Px4FusesVisionAndReportsOtherSources) {
  for (int type = 0; type <= 8; ++type) {
    EmulatorBench bench(AutopilotDialect::kPx4);
    mavlink::Heartbeat station;
    station.type = mavlink::type::kGroundStation;
    bench.send(station);
    bench.run(0.1);
    auto pose = bench.pose(bench.place_m());
    pose.estimator_type = static_cast<std::uint8_t>(type);
    bench.frames.clear();
    bench.send(pose);
    EXPECT_EQ(bench.poses(), type <= 3 ? 1 : 0) << type;
    EXPECT_EQ(bench.emulator.ignored(), type <= 3 ? 0 : 1) << type;
    const auto texts = bench.all<mavlink::Statustext>();
    ASSERT_EQ(texts.size(), type <= 3 || type == 6 ? 0u : 1u) << type;
    if (!texts.empty()) {
      EXPECT_EQ(std::string(texts[0].text.data()), "ODOMETRY: estimator_type unsupported");
      EXPECT_EQ(texts[0].severity, 2);
    }
  }
}

TEST(EmulatorMessages, ArdupilotAcceptsPosesInOneFrameOnly) {
  const auto taken = [](std::uint8_t frame, std::uint8_t body, double x_m) {
    EmulatorBench bench(AutopilotDialect::kArdupilot);
    bench.run(5.1);
    auto pose = bench.pose({x_m, -2.0, -0.25});
    pose.frame_id = frame;
    pose.child_frame_id = body;
    bench.send(pose);
    EXPECT_EQ(bench.poses() + bench.emulator.ignored(), 1);
    return bench.poses() == 1;
  };
  EXPECT_TRUE(taken(mavlink::frame::kLocalFrd, mavlink::frame::kBodyFrd, 1.0));
  EXPECT_FALSE(taken(mavlink::frame::kLocalNed, mavlink::frame::kBodyFrd, 1.0));
  EXPECT_FALSE(taken(mavlink::frame::kLocalFrd, mavlink::frame::kBodyNed, 1.0));
  EXPECT_FALSE(taken(mavlink::frame::kLocalFrd, mavlink::frame::kBodyFrd,
                     std::numeric_limits<double>::infinity()));
}

TEST(EmulatorMessages, AcceptsFiniteVisionEstimates) {
  EmulatorBench bench(AutopilotDialect::kPx4);
  bench.run(0.1);
  mavlink::VisionPositionEstimate vision;
  vision.x = 1.0F;
  vision.y = -2.5F;
  vision.z = std::numeric_limits<float>::quiet_NaN();
  bench.send(vision);
  EXPECT_EQ(bench.poses(), 0);
  vision.z = -0.5F;
  bench.send(vision);
  EXPECT_EQ(bench.poses(), 1);
  EXPECT_EQ(bench.emulator.controller().estimator().position_m(), Eigen::Vector3d(1.0, -2.5, -0.5));
  // A pose with a new reset counter corrects the complete error, as with odometry.
  vision.x = 9.0F;
  vision.reset_counter = 1;
  bench.send(vision);
  EXPECT_EQ(bench.emulator.controller().estimator().position_m().x(), 9.0);
  auto pose = bench.pose({-9.0, 0.0, 0.0});
  pose.reset_counter = 2;
  bench.send(pose);
  EXPECT_EQ(bench.emulator.controller().estimator().position_m().x(), -9.0);
}

}  // namespace
}  // namespace vantage::sim
