#include "wire/mavlink/frame.hpp"

#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "test/wire/mavlink/hex.hpp"
#include "test/wire/mavlink/random_message.hpp"
#include "wire/mavlink/constants.hpp"
#include "wire/mavlink/parser.hpp"

namespace vantage::wire::mavlink {
namespace {

using test::bytes_of_hex;

struct Row {
  const char* name;
  std::uint32_t id;
  int crc_extra;
  int base_bytes;
  int full_bytes;
};

// Checksums and lengths that another program computed from the message definitions; they equal
// those of the generated C headers.
constexpr Row kTable[] = {
    {"HEARTBEAT", 0, 50, 9, 9},
    {"SYS_STATUS", 1, 124, 31, 43},
    {"SYSTEM_TIME", 2, 137, 12, 12},
    {"SET_MODE", 11, 89, 6, 6},
    {"PARAM_REQUEST_READ", 20, 214, 20, 20},
    {"PARAM_VALUE", 22, 220, 25, 25},
    {"PARAM_SET", 23, 168, 23, 23},
    {"ATTITUDE", 30, 39, 28, 28},
    {"ATTITUDE_QUATERNION", 31, 246, 32, 48},
    {"LOCAL_POSITION_NED", 32, 185, 28, 28},
    {"SET_GPS_GLOBAL_ORIGIN", 48, 41, 13, 21},
    {"GPS_GLOBAL_ORIGIN", 49, 39, 12, 20},
    {"MANUAL_CONTROL", 69, 243, 11, 30},
    {"COMMAND_INT", 75, 158, 35, 35},
    {"COMMAND_LONG", 76, 152, 33, 33},
    {"COMMAND_ACK", 77, 143, 3, 10},
    {"SET_ATTITUDE_TARGET", 82, 49, 39, 51},
    {"SET_POSITION_TARGET_LOCAL_NED", 84, 143, 53, 53},
    {"POSITION_TARGET_LOCAL_NED", 85, 140, 51, 51},
    {"HIL_ACTUATOR_CONTROLS", 93, 47, 81, 81},
    {"VISION_POSITION_ESTIMATE", 102, 158, 32, 117},
    {"VISION_SPEED_ESTIMATE", 103, 208, 20, 57},
    {"VICON_POSITION_ESTIMATE", 104, 56, 32, 116},
    {"HIL_SENSOR", 107, 108, 64, 65},
    {"TIMESYNC", 111, 34, 16, 18},
    {"DISTANCE_SENSOR", 132, 85, 14, 39},
    {"ATT_POS_MOCAP", 138, 109, 36, 120},
    {"BATTERY_STATUS", 147, 154, 36, 54},
    {"AUTOPILOT_VERSION", 148, 178, 60, 78},
    {"EKF_STATUS_REPORT", 193, 71, 22, 26},
    {"ESTIMATOR_STATUS", 230, 163, 42, 42},
    {"GPS_INPUT", 232, 151, 63, 65},
    {"HOME_POSITION", 242, 104, 52, 60},
    {"MESSAGE_INTERVAL", 244, 95, 6, 6},
    {"EXTENDED_SYS_STATE", 245, 130, 2, 2},
    {"STATUSTEXT", 253, 83, 51, 54},
    {"ODOMETRY", 331, 91, 230, 233},
};

TEST(MessageDescriptions, HaveTheChecksumsAndLengthsOfTheDefinitions) {
  for (const Row& row : kTable) {
    const MessageInfo* const info = find_message(row.id);
    ASSERT_NE(info, nullptr) << row.name;
    EXPECT_EQ(info->name, row.name);
    EXPECT_EQ(int{info->crc_extra}, row.crc_extra) << row.name;
    EXPECT_EQ(int{info->base_bytes}, row.base_bytes) << row.name;
    EXPECT_EQ(int{info->full_bytes}, row.full_bytes) << row.name;
  }
  EXPECT_EQ(std::size(kTable), std::tuple_size_v<AllMessages>);
  EXPECT_EQ(find_message(99'999), nullptr);
}

TEST(MessageDescriptions, AreInWireOrder) {
  test::for_each_message([]<class Message>() {
    std::size_t last = 8;
    const Message message;
    Message::Fields::for_each(message, [&](std::string_view name, const auto& field) {
      using Shape = FieldShape<std::remove_cvref_t<decltype(field)>>;
      EXPECT_LE(sizeof(typename Shape::Element), last) << Message::kMessage.name << "." << name;
      last = sizeof(typename Shape::Element);
    });
  });
}

template <class Message>
std::string hex_of(const Message& message, const Origin& origin) {
  std::vector<std::uint8_t> bytes;
  append_bytes(pack(message, origin), bytes);
  return test::hex_of_bytes(bytes);
}

TEST(Pack, WritesTheReferenceHeartbeat) {
  Heartbeat heartbeat;
  heartbeat.type = 18;
  heartbeat.autopilot = 8;
  heartbeat.system_status = 4;
  heartbeat.mavlink_version = 3;
  EXPECT_EQ(hex_of(heartbeat, {255, 191, 0}), "fd09000000ffbf000000000000001208000403cb64");
}

TEST(Pack, WritesTheReferencePositionTarget) {
  SetPositionTargetLocalNed target;
  target.time_boot_ms = 123456;
  target.x = 1.5F;
  target.y = -2.25F;
  target.z = -1.0F;
  target.yaw = 0.5F;
  target.type_mask = 3576;
  target.coordinate_frame = 1;
  target.target_system = 1;
  target.target_component = 1;
  EXPECT_EQ(
      hex_of(target, {255, 190, 7}),
      "fd35000007ffbe54000040e201000000c03f000010c0000080bf000000000000000000000000000000000000"
      "0000000000000000003f00000000f80d01010146a3");
}

CommandLong command(std::uint16_t number, float param1, float param2) {
  CommandLong out;
  out.command = number;
  out.param1 = param1;
  out.param2 = param2;
  out.target_system = 1;
  out.target_component = 1;
  return out;
}

TEST(Pack, WritesTheReferenceCommands) {
  EXPECT_EQ(
      hex_of(command(400, 1.0F, 0.0F), {255, 191, 1}),
      "fd20000001ffbf4c00000000803f000000000000000000000000000000000000000000000000900101012fbe");
  EXPECT_EQ(
      hex_of(command(176, 1.0F, 6.0F), {255, 191, 2}),
      "fd20000002ffbf4c00000000803f0000c0400000000000000000000000000000000000000000b0000101d98f");
  EXPECT_EQ(
      hex_of(command(21, 0.0F, 0.0F), {255, 191, 8}),
      "fd20000008ffbf4c000000000000000000000000000000000000000000000000000000000000150001013e5b");
}

TEST(Pack, WritesTheReferenceTimesync) {
  Timesync request;
  request.ts1 = 123'456'789;
  request.target_system = 1;
  request.target_component = 1;
  EXPECT_EQ(hex_of(request, {255, 191, 3}),
            "fd12000003ffbf6f0000000000000000000015cd5b070000000001018063");
}

TEST(Pack, WritesExternalPosesAndTrimsZeros) {
  VisionPositionEstimate vision;
  vision.usec = 1'000'000;
  vision.x = 1.0F;
  vision.y = 2.0F;
  vision.z = -0.5F;
  vision.yaw = 1.5F;
  vision.covariance[0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(
      hex_of(vision, {255, 197, 4}),
      "fd24000004ffc566000040420f00000000000000803f00000040000000bf00000000000000000000c03f0000"
      "c07f8be0");
  AttPosMocap mocap;
  mocap.time_usec = 1'000'000;
  mocap.q[0] = 1.0F;
  mocap.x = 1.0F;
  mocap.y = 2.0F;
  mocap.z = -0.5F;
  EXPECT_EQ(
      hex_of(mocap, {255, 197, 6}),
      "fd24000006ffc58a000040420f00000000000000803f0000000000000000000000000000803f000000400000"
      "00bfb560");
}

TEST(Pack, KeepsOneByteOfAMessageOfZeros) {
  EXPECT_EQ(pack(MessageInterval{}, {1, 1, 0}).payload_size, 1);
}

// Compares the numbers with common.xml and minimal.xml. A round trip between our own encoder and
// decoder would not detect a wrong number.
TEST(Vocabulary, HasTheNumbersOfTheMavlinkDefinitions) {
  EXPECT_EQ(command::kLand, 21);
  EXPECT_EQ(command::kTakeOff, 22);
  EXPECT_EQ(command::kSetMode, 176);
  EXPECT_EQ(command::kArmDisarm, 400);
  EXPECT_EQ(command::kSetMessageInterval, 511);
  EXPECT_EQ(kForceDisarm, 21196.0F);
  EXPECT_EQ(result::kAccepted, 0);
  EXPECT_EQ(result::kInProgress, 5);
  EXPECT_EQ(type::kGroundStation, 6);
  EXPECT_EQ(type::kOnboardController, 18);
  EXPECT_EQ(autopilot::kArdupilot, 3);
  EXPECT_EQ(autopilot::kNone, 8);
  EXPECT_EQ(autopilot::kPx4, 12);
  EXPECT_EQ(kComponentAutopilot, 1);
  EXPECT_EQ(kComponentOnboardComputer, 191);
  EXPECT_EQ(kArmedFlag, 1 << 7);
  EXPECT_EQ(kStateActive, 4);
  EXPECT_EQ(kEstimatorVision, 2);
  EXPECT_EQ(landed::kUnknown, 0);
  EXPECT_EQ(landed::kOnGround, 1);
  EXPECT_EQ(frame::kLocalNed, 1);
  EXPECT_EQ(frame::kBodyNed, 8);
  EXPECT_EQ(frame::kBodyFrd, 12);
  EXPECT_EQ(frame::kLocalFrd, 20);
}

// Bits 0 to 11 of a target's type_mask mean: position, velocity, acceleration, force, yaw, yaw
// rate.
TEST(Vocabulary, HasTheIgnoreBitsOfTheMavlinkDefinitions) {
  EXPECT_EQ(mask::kIgnorePosition, 0b111);
  EXPECT_EQ(mask::kIgnoreVelocity, 0b111 << 3);
  EXPECT_EQ(mask::kIgnoreAcceleration, 0b111 << 6);
  EXPECT_EQ(mask::kIsForce, 1 << 9);
  EXPECT_EQ(mask::kIgnoreYaw, 1 << 10);
  EXPECT_EQ(mask::kIgnoreYawRate, 1 << 11);
  EXPECT_EQ(mask::kNothingIgnored, 0);
  EXPECT_EQ(mask::kPositionAndYaw, 0b1001'1111'1000);
  EXPECT_EQ(mask::kVelocityAndYawRate, 0b0101'1100'0111);
  EXPECT_EQ(estimator::kAttitude, 1 << 0);
  EXPECT_EQ(estimator::kHorizontalVelocity, 1 << 1);
  EXPECT_EQ(estimator::kVerticalVelocity, 1 << 2);
  EXPECT_EQ(estimator::kRelativePosition, 1 << 3);
  EXPECT_EQ(estimator::kAbsolutePosition, 1 << 4);
  EXPECT_EQ(estimator::kHeight, 1 << 5);
  EXPECT_EQ(estimator::kConstantPosition, 1 << 7);
  EXPECT_EQ(estimator::kUninitialised, 1 << 10);
}

TEST(HeartbeatOf, DescribesAGroundStation) {
  const Heartbeat heartbeat = heartbeat_of(type::kOnboardController);
  EXPECT_EQ(heartbeat.type, 18);
  EXPECT_EQ(heartbeat.autopilot, 8);
  EXPECT_EQ(heartbeat.system_status, 4);
  EXPECT_EQ(heartbeat.mavlink_version, 3) << "version of the dialect";
  EXPECT_EQ(heartbeat.base_mode, 0);
  EXPECT_EQ(heartbeat.custom_mode, 0U);
}

TEST(Unpack, InvertsPackForAnyContent) {
  std::mt19937_64 rng(1);
  test::for_each_message([&rng]<class Message>() {
    for (int i = 0; i < 500; ++i) {
      const Message sent = test::random_message<Message>(rng);
      const Frame frame = pack(sent, {3, 4, static_cast<std::uint8_t>(i)});
      const std::optional<Message> back = unpack<Message>(frame);
      ASSERT_TRUE(back.has_value());
      // Equal values have equal bytes, including NaN.
      const Frame again = pack(*back, frame.origin);
      ASSERT_EQ(again.payload, frame.payload) << Message::kMessage.name;
      ASSERT_EQ(again.crc, frame.crc);
    }
  });
}

TEST(Unpack, RefusesAnotherMessage) {
  EXPECT_FALSE(unpack<Attitude>(pack(Heartbeat{}, {1, 1, 0})).has_value());
}

TEST(Unpack, IgnoresUnknownTrailingFields) {
  Frame frame = pack(ExtendedSysState{1, 2}, {1, 1, 0});
  frame.payload[2] = 77;
  frame.payload_size = 3;
  frame.crc = crc_of(frame);
  const auto state = unpack<ExtendedSysState>(frame);
  ASSERT_TRUE(state.has_value());
  EXPECT_EQ(state->landed_state, 2);
}

// Bytes after the version 1 fields are not read as extensions.
TEST(Unpack, IgnoresExtensionsInVersionOne) {
  CommandAck ack;
  ack.command = 400;
  ack.result = 2;
  ack.progress = 77;
  ack.result_param2 = -5;
  ack.target_system = 3;
  ack.target_component = 4;
  Frame frame = pack(ack, {1, 1, 0});
  frame.is_v1 = true;
  frame.crc = crc_of(frame);
  const auto read = unpack<CommandAck>(frame);
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->command, 400);
  EXPECT_EQ(read->result, 2);
  EXPECT_EQ(read->progress, 0);
  EXPECT_EQ(read->result_param2, 0);
  EXPECT_EQ(read->target_system, 0);
  EXPECT_EQ(read->target_component, 0);
  frame.is_v1 = false;
  EXPECT_EQ(unpack<CommandAck>(frame)->progress, 77);
}

}  // namespace
}  // namespace vantage::wire::mavlink
