// Compares the MAVLink messages of the driver with the protocol.

#include "drivers/quadrotor/autopilot_link.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "test/support/near.hpp"
#include "test/support/random.hpp"
#include "wire/mavlink/constants.hpp"

namespace vantage::drivers {
namespace {

using models::AutopilotDialect;

constexpr Time kNow = from_utime(1'700'000'000'123'456);

/// An autopilot link and the messages that it sent, decoded.
struct Bench {
  explicit Bench(AutopilotDialect dialect, const std::optional<wire::mavlink::SigningKey>& key = {},
                 scenario::ParameterPolicy parameters = scenario::ParameterPolicy::kIgnore)
      : link({dialect, "", 1, "", parameters}, key) {}

  std::vector<wire::mavlink::Frame> sent() {
    std::vector<wire::mavlink::Frame> out;
    for (const WireMessage& message : link.take_output()) {
      wire::mavlink::Parser parser;
      parser.feed(message, [&out](const wire::mavlink::Frame& frame) { out.push_back(frame); });
    }
    return out;
  }
  template <class Message>
  std::vector<Message> sent_of() {
    std::vector<Message> out;
    for (const wire::mavlink::Frame& frame : sent()) {
      if (const auto message = wire::mavlink::unpack<Message>(frame)) {
        out.push_back(*message);
      }
    }
    return out;
  }
  template <class Message>
  void receive_message(const Message& message, Time now, std::uint8_t system = 1,
                       std::uint8_t component = 1) {
    std::vector<std::uint8_t> bytes;
    wire::mavlink::append_bytes(wire::mavlink::pack(message, {system, component, sequence++}),
                                bytes);
    link.receive(bytes, true, now);
  }
  void receive_heartbeat(Time now, std::uint8_t autopilot = 12) {
    receive_message(wire::mavlink::Heartbeat{0, 2, autopilot, 0, 3, 3}, now);
  }

  std::string fault(Time now) const { return link.fault(now).value_or("none"); }
  std::string warning() const {
    return link.telemetry().newest_warning(kNow, Duration{0}).value_or("none");
  }

  AutopilotLink link;
  std::uint8_t sequence = 0;
};

TEST(AutopilotLink, SendsHeartbeatsAtFiveHertz) {
  for (const auto dialect : {AutopilotDialect::kPx4, AutopilotDialect::kArdupilot}) {
    Bench bench(dialect);
    for (int i = 0; i < 500; ++i) {
      bench.link.tick(kNow + i * Duration{20'000});
    }
    const std::vector<wire::mavlink::Frame> frames = bench.sent();
    ASSERT_EQ(frames.size(), 50U) << "only heartbeats are sent before the vehicle is received";
    const auto heartbeat = wire::mavlink::unpack<wire::mavlink::Heartbeat>(frames[0]);
    ASSERT_TRUE(heartbeat.has_value());
    const bool is_px4 = dialect == AutopilotDialect::kPx4;
    EXPECT_EQ(heartbeat->type, 6);  // ground station; PX4 reports refusal reasons only to these
    EXPECT_EQ(heartbeat->autopilot, 8);
    EXPECT_EQ(heartbeat->system_status, 4);
    EXPECT_EQ(frames[0].origin.system_id, is_px4 ? 254 : 255);
    EXPECT_EQ(frames[0].origin.component_id, 191);
  }
}

TEST(AutopilotLink, SendsPosesInTheEstimatorsFormat) {
  test::Random random(1);
  for (int i = 0; i < 200; ++i) {
    Bench bench(AutopilotDialect::kPx4);
    BodyState state;
    state.capture = kNow;
    state.world_from_body.translation_m = random.vector<3>(-5.0, 5.0);
    state.world_from_body.rotation =
        Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal())
            .normalized();
    state.velocity_world_mps = random.vector<3>(-2.0, 2.0);
    state.resets = 3;
    bench.link.send_pose(state, kNow + Duration{7'000});
    const auto poses = bench.sent_of<wire::mavlink::Odometry>();
    ASSERT_EQ(poses.size(), 1U);
    const wire::mavlink::Odometry& odometry = poses[0];
    EXPECT_EQ(odometry.frame_id, 20);
    EXPECT_EQ(odometry.child_frame_id, 12);
    EXPECT_EQ(odometry.estimator_type, 2) << "PX4 never uses type 6";
    EXPECT_EQ(odometry.quality, 100);
    EXPECT_EQ(odometry.reset_counter, 3);
    EXPECT_EQ(odometry.time_usec, 1'700'000'000'123'456U) << "time of the capture";
    for (const std::size_t diagonal : {0U, 6U, 11U, 15U, 18U, 20U}) {
      EXPECT_GT(odometry.pose_covariance[diagonal], 0.0F);
      EXPECT_GT(odometry.velocity_covariance[diagonal], 0.0F);
    }
    // The reference uses rotation matrices: half a turn about x transforms both the world and the
    // body frame.
    const Eigen::DiagonalMatrix<double, 3> turn(1.0, -1.0, -1.0);
    const Eigen::Matrix3d world_from_body = state.world_from_body.rotation.toRotationMatrix();
    const Eigen::Matrix3d local_from_body = turn * world_from_body * turn;
    const Eigen::Quaternionf q(odometry.q[0], odometry.q[1], odometry.q[2], odometry.q[3]);
    EXPECT_TRUE(test::is_near(q.toRotationMatrix().cast<double>(), local_from_body, 1e-6));
    const Eigen::Vector3d position_m(odometry.x, odometry.y, odometry.z);
    EXPECT_TRUE(test::is_near(position_m, turn * state.world_from_body.translation_m, 1e-6));
    const Eigen::Vector3d velocity_body_mps(odometry.vx, odometry.vy, odometry.vz);
    EXPECT_TRUE(
        test::is_near(local_from_body * velocity_body_mps, turn * state.velocity_world_mps, 1e-6));
  }
}

TEST(AutopilotLink, SendsPositionVelocityAndAccelerationInEachSetPoint) {
  for (const AutopilotDialect dialect : {AutopilotDialect::kPx4, AutopilotDialect::kArdupilot}) {
    Bench bench(dialect);
    Setpoint moving;
    moving.position_world_m = {1.0, 2.0, 3.0};
    moving.velocity_world_mps = {0.1, 0.2, 0.3};
    moving.acceleration_world_mps2 = {-0.5, 0.25, 0.125};
    moving.yaw_rad = 0.5;
    moving.yaw_rate_radps = -0.4;
    Setpoint standing;
    standing.position_world_m = {1.0, 2.0, 3.0};
    bench.link.send_setpoint(moving, kNow);
    bench.link.send_setpoint(standing, kNow);
    const auto targets = bench.sent_of<wire::mavlink::SetPositionTargetLocalNed>();
    ASSERT_EQ(targets.size(), 2U);
    const wire::mavlink::SetPositionTargetLocalNed& t = targets[0];
    EXPECT_EQ(t.coordinate_frame, 1);
    EXPECT_EQ(t.target_system, 1);
    EXPECT_EQ((std::vector{t.x, t.y, t.z, t.yaw}), (std::vector{1.0F, -2.0F, -3.0F, -0.5F}));
    EXPECT_EQ((std::vector{t.vx, t.vy, t.vz, t.yaw_rate}), (std::vector{0.1F, -0.2F, -0.3F, 0.4F}));
    EXPECT_EQ((std::vector{t.afx, t.afy, t.afz}), (std::vector{-0.5F, -0.25F, -0.125F}));
    // All set-points must be of the same kind, because a change of the kind can disturb an
    // autopilot.
    EXPECT_EQ(targets[0].type_mask, 0);
    EXPECT_EQ(targets[1].type_mask, 0);
  }
}

TEST(AutopilotLink, SynchronisesWithTheVehicleClock) {
  Bench bench(AutopilotDialect::kPx4);
  bench.receive_heartbeat(kNow);
  wire::mavlink::Timesync request;
  request.ts1 = 42;
  bench.receive_message(request, kNow);
  auto sent = bench.sent_of<wire::mavlink::Timesync>();
  ASSERT_EQ(sent.size(), 1U);
  EXPECT_EQ(sent[0].tc1, to_utime(kNow) * 1000);
  EXPECT_EQ(sent[0].ts1, 42);

  bench.link.tick(kNow);
  sent = bench.sent_of<wire::mavlink::Timesync>();
  ASSERT_EQ(sent.size(), 1U);
  EXPECT_EQ(sent[0].tc1, 0);
  // The vehicle's clock started 100 s ago; the latency is 2 ms in each direction.
  wire::mavlink::Timesync reply;
  reply.tc1 = 100'002'000'000;
  reply.ts1 = sent[0].ts1;
  bench.receive_message(reply, kNow + Duration{4'000});
  EXPECT_EQ(bench.link.telemetry().clock_offset_ns(), 100'000'000'000 - to_utime(kNow) * 1000);
  // A reply that matches no request is ignored.
  reply.tc1 = 5;
  reply.ts1 = 1;
  bench.receive_message(reply, kNow + Duration{4'000});
  EXPECT_EQ(bench.link.telemetry().clock_offset_ns(), 100'000'000'000 - to_utime(kNow) * 1000);
}

TEST(AutopilotLink, RequestsStreamsUntilTheyArrive) {
  Bench bench(AutopilotDialect::kPx4);
  std::map<int, int> requested;
  for (int i = 0; i < 400; ++i) {
    const Time now = kNow + i * Duration{20'000};
    bench.receive_heartbeat(now);
    bench.receive_message(wire::mavlink::LocalPositionNed{}, now);
    bench.receive_message(wire::mavlink::EstimatorStatus{}, now);
    bench.link.tick(now);
    for (const auto& command : bench.sent_of<wire::mavlink::CommandLong>()) {
      ASSERT_EQ(command.command, 511);
      EXPECT_GT(command.param2, 0.0F);
      ++requested[static_cast<int>(command.param1)];
      wire::mavlink::CommandAck ack;
      ack.command = 511;
      bench.receive_message(ack, now);
    }
  }
  EXPECT_EQ(requested.count(32) + requested.count(230), 0U)
      << "these messages arrive without a request";
  for (const int id : {30, 245, 147, 1}) {
    EXPECT_GE(requested[id], 2) << id;
    EXPECT_LE(requested[id], 4) << id << ": requested every three seconds at most";
  }
}

TEST(AutopilotLink, SendsArdupilotAnOriginUntilConfirmed) {
  for (const auto dialect : {AutopilotDialect::kPx4, AutopilotDialect::kArdupilot}) {
    Bench bench(dialect);
    const auto origins_in = [&bench](int from_s, int to_s) {
      for (int i = from_s * 10; i < to_s * 10; ++i) {
        bench.receive_heartbeat(kNow + i * Duration{100'000});
        bench.link.tick(kNow + i * Duration{100'000});
      }
      return bench.sent_of<wire::mavlink::SetGpsGlobalOrigin>().size();
    };
    const std::size_t wanted = dialect == AutopilotDialect::kPx4 ? 0U : 5U;
    EXPECT_EQ(origins_in(0, 5), wanted);
    // ArduCopter without an origin reports a position but does not arm.
    bench.receive_message(wire::mavlink::LocalPositionNed{}, kNow + std::chrono::seconds(5));
    EXPECT_EQ(origins_in(5, 10), wanted);
    bench.receive_message(wire::mavlink::GpsGlobalOrigin{}, kNow + std::chrono::seconds(10));
    EXPECT_EQ(origins_in(10, 15), 0U);
  }
}

TEST(AutopilotLink, AcceptsOnlyItsVehicle) {
  Bench bench(AutopilotDialect::kPx4);
  bench.receive_message(wire::mavlink::Heartbeat{0, 2, 12, 128, 4, 3}, kNow, 9);
  EXPECT_FALSE(bench.link.telemetry().heartbeat_time().has_value());
  EXPECT_STREQ(bench.fault(kNow).c_str(),
               "messages received, but none from an autopilot with this system id");
  bench.receive_message(wire::mavlink::Heartbeat{0, 6, 8, 128, 4, 3}, kNow, 1,
                        190);  // 190: component id of a ground station
  EXPECT_FALSE(bench.link.telemetry().heartbeat_time().has_value());
  bench.receive_heartbeat(kNow);
  EXPECT_FALSE(bench.link.fault(kNow).has_value());
  EXPECT_STREQ(bench.fault(kNow + std::chrono::seconds(3)).c_str(),
               "the autopilot's messages have stopped");
}

TEST(AutopilotLink, AcceptsTheFirstAutopilotByDefault) {
  AutopilotLink link({AutopilotDialect::kArdupilot, "", 0, ""}, std::nullopt);
  const auto receive_message = [&link](const wire::mavlink::Heartbeat& heartbeat,
                                       std::uint8_t system, std::uint8_t component) {
    std::vector<std::uint8_t> bytes;
    wire::mavlink::append_bytes(wire::mavlink::pack(heartbeat, {system, component, 0}), bytes);
    link.receive(bytes, true, kNow);
  };
  receive_message({0, 6, 8, 0, 4, 3}, 255, 190);  // not an autopilot
  receive_message({0, 2, 3, 0, 4, 3}, 17, 0);     // a vehicle may start as component 0
  receive_message({0, 2, 3, 128, 4, 3}, 18, 1);
  EXPECT_TRUE(link.telemetry().heartbeat_time().has_value());
  EXPECT_FALSE(link.telemetry().is_armed()) << "the link uses the second component";
}

// Companion computers and ground stations may send as component 0 or 1 with the system id of the
// vehicle; pymavlink does so by default.
TEST(AutopilotLink, IgnoresOtherComponentsOnceTheAutopilotIsKnown) {
  using wire::mavlink::Heartbeat;
  struct Row {
    const char* what;
    Heartbeat heartbeat;
    std::uint8_t component;
  };
  const Row rows[] = {
      {"a companion with pymavlink's defaults", {0, 18, 8, 0, 3, 3}, 0},
      {"a vehicle's type, no autopilot", {0, 2, 8, 0, 3, 3}, 0},
      {"an autopilot's heartbeat of component 0", {0, 2, 12, 0, 3, 3}, 0},
      {"a companion as component 1", {0, 18, 8, 0, 3, 3}, 1},
      {"a station as component 1", {0, 6, 12, 0, 3, 3}, 1},
      {"a gimbal as component 1", {0, 26, 12, 0, 3, 3}, 1},
      {"a camera as component 1", {0, 30, 12, 0, 3, 3}, 1},
      {"no autopilot as component 1", {0, 2, 8, 0, 3, 3}, 1},
  };
  for (const Row& row : rows) {
    SCOPED_TRACE(row.what);
    Bench bench(AutopilotDialect::kPx4);
    bench.receive_message(Heartbeat{6U << 16U, 2, 12, 128, 4, 3}, kNow);
    ASSERT_TRUE(bench.link.telemetry().is_armed());
    bench.receive_message(row.heartbeat, kNow + std::chrono::milliseconds(100), 1, row.component);
    EXPECT_TRUE(bench.link.telemetry().is_armed());
    EXPECT_EQ(bench.link.telemetry().mode(), 6U << 16U);
    EXPECT_EQ(bench.link.telemetry().heartbeat_time(), kNow);
    EXPECT_EQ(bench.fault(kNow), "none");
  }
}

TEST(AutopilotLink, AcceptsComponent0OnlyForHeartbeatsBeforeComponent1) {
  Bench bench(AutopilotDialect::kArdupilot);
  bench.receive_message(wire::mavlink::Heartbeat{4, 2, 3, 0, 4, 3}, kNow, 1, 0);
  EXPECT_TRUE(bench.link.telemetry().heartbeat_time().has_value());
  wire::mavlink::LocalPositionNed position;
  position.x = 5.0F;
  wire::mavlink::Attitude attitude;
  attitude.roll = 1.0F;
  wire::mavlink::BatteryStatus battery;
  battery.battery_remaining = 90;
  bench.receive_message(position, kNow, 1, 0);
  bench.receive_message(attitude, kNow, 1, 0);
  bench.receive_message(battery, kNow, 1, 0);
  EXPECT_FALSE(bench.link.telemetry().position_world_m(kNow).has_value());
  EXPECT_FALSE(bench.link.telemetry().has_attitude(kNow));
  EXPECT_FALSE(bench.link.telemetry().battery_share().has_value());
}

TEST(AutopilotLink, ReportsMavlinkVersionOne) {
  Bench bench(AutopilotDialect::kPx4);
  wire::mavlink::Frame frame =
      wire::mavlink::pack(wire::mavlink::Heartbeat{0, 2, 12, 0, 3, 3}, {1, 1, 0});
  frame.is_v1 = true;
  frame.payload_size = 9;
  frame.crc = wire::mavlink::crc_of(frame);
  std::vector<std::uint8_t> bytes;
  wire::mavlink::append_bytes(frame, bytes);
  bench.link.receive(bytes, true, kNow);
  EXPECT_STREQ(bench.fault(kNow).c_str(), "the autopilot sends MAVLink 1; version 2 is required");
}

TEST(AutopilotLink, SignsMessagesAndRefusesUnsignedOnes) {
  const wire::mavlink::SigningKey key{4, 5, 6};
  Bench bench(AutopilotDialect::kPx4, key);
  bench.receive_heartbeat(kNow);
  EXPECT_FALSE(bench.link.telemetry().heartbeat_time().has_value());
  wire::mavlink::Frame frame =
      wire::mavlink::pack(wire::mavlink::Heartbeat{0, 2, 12, 0, 3, 3}, {1, 1, 9});
  wire::mavlink::Signer vehicle(key, 0);
  vehicle.sign(frame, kNow);
  std::vector<std::uint8_t> bytes;
  wire::mavlink::append_bytes(frame, bytes);
  bench.link.receive(bytes, true, kNow);
  EXPECT_TRUE(bench.link.telemetry().heartbeat_time().has_value());
  bench.link.tick(kNow);
  const std::vector<wire::mavlink::Frame> sent = bench.sent();
  ASSERT_FALSE(sent.empty());
  for (const wire::mavlink::Frame& each : sent) {
    EXPECT_EQ(vehicle.check(each, kNow), wire::mavlink::SignatureVerdict::kGood);
  }
}

TEST(AutopilotLink, JoinsThePartsOfLongTexts) {
  Bench bench(AutopilotDialect::kPx4);
  bench.receive_heartbeat(kNow);
  wire::mavlink::Statustext text;
  text.severity = 3;
  text.id = 5;
  text.text.fill('a');
  std::string whole(51, 'a');
  whole.back() = 'b';
  bench.receive_message(text, kNow);
  text.chunk_seq = 1;
  text.text.fill('\0');
  text.text[0] = 'b';
  bench.receive_message(text, kNow);
  EXPECT_EQ(bench.warning(), whole);
  text = {};
  text.severity = 6;
  text.text[0] = 'i';
  bench.receive_message(text, kNow);
  EXPECT_EQ(bench.warning(), whole) << "informational text is not a warning";
}

TEST(AutopilotLink, SurvivesRandomBytes) {
  std::mt19937_64 rng(7);
  for (const bool is_datagram : {true, false}) {
    Bench bench(AutopilotDialect::kArdupilot);
    std::vector<std::uint8_t> bytes;
    for (int i = 0; i < 50'000; ++i) {
      bytes.clear();
      switch (rng() % 4) {
        case 0:
          wire::mavlink::append_bytes(wire::mavlink::pack(wire::mavlink::Statustext{}, {1, 1, 0}),
                                      bytes);
          break;
        case 1:
          wire::mavlink::append_bytes(wire::mavlink::pack(wire::mavlink::CommandAck{}, {1, 1, 0}),
                                      bytes);
          break;
        default:
          bytes.resize(rng() % 300);
      }
      for (std::uint8_t& byte : bytes) {
        byte = rng() % 8 == 0 || rng() % 2 == 0 ? static_cast<std::uint8_t>(rng()) : byte;
      }
      bench.link.receive(bytes, is_datagram, kNow + i * Duration{1'000});
      bench.link.tick(kNow + i * Duration{1'000});
    }
    EXPECT_LE(bench.link.take_output().size(), 1024U);
    bench.receive_heartbeat(kNow + std::chrono::seconds(60), 3);
    EXPECT_FALSE(bench.link.fault(kNow + std::chrono::seconds(60)).has_value());
  }
}

// According to docs/guide/quadrotors.md, all other modes may run without a pilot, in any sub-mode
// of PX4.
TEST(Dialect, ListsTheModesFlownByHand) {
  const std::set<std::uint32_t> px4{1, 2, 3, 5, 7, 8, 11};
  const std::set<std::uint32_t> ardupilot{0, 1, 2, 5, 11, 13, 16, 22};
  for (std::uint32_t mode = 0; mode < 40; ++mode) {
    for (const std::uint32_t sub : {0U, 1U, 2U, 6U}) {
      EXPECT_EQ(is_flown_by_hand(AutopilotDialect::kPx4, mode << 16U | sub << 24U),
                px4.contains(mode))
          << mode;
    }
    EXPECT_EQ(is_flown_by_hand(AutopilotDialect::kArdupilot, mode), ardupilot.contains(mode))
        << mode;
  }
}

// According to docs/guide/quadrotors.md, set-points lead by the response time of each autopilot.
TEST(DialectTraits, HaveTheDocumentedSetpointLead) {
  const DialectTraits& px4 = traits_of(models::AutopilotDialect::kPx4);
  EXPECT_EQ(px4.lead_s, 0.05);
  EXPECT_EQ(px4.acceleration_lead_s, 0.05);
  const DialectTraits& ardupilot = traits_of(models::AutopilotDialect::kArdupilot);
  EXPECT_EQ(ardupilot.lead_s, 0.07);
  EXPECT_EQ(ardupilot.acceleration_lead_s, 0.16);
}

}  // namespace
}  // namespace vantage::drivers
