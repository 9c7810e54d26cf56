#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "wire/crtp/flight.hpp"
#include "wire/crtp/packet.hpp"
#include "wire/crtp/system.hpp"

namespace vantage::wire::crtp {
namespace {

using ByteList = std::vector<std::uint8_t>;

const Quaternion kTurned = Quaternion(0.9, 0.1, -0.2, 0.3).normalized();

/// Packet, and its bytes from another implementation: cflib's layouts, packed with Python's struct.
struct Row {
  const char* name;
  std::optional<Packet> packet;
  ByteList bytes;
};

std::vector<Row> rows() {
  FullStateSetpoint full;
  full.position_world_m = {1.0, -2.0, 1.5};
  full.velocity_world_mps = {0.1, -0.2, 0.3};
  full.acceleration_world_mps2 = {0.01, 0.02, -0.03};
  full.world_from_body = kTurned;
  full.rate_body_radps = {0.1, -0.2, 0.3};
  const ExternalPose pose{{1.0, -2.0, 0.5}, Quaternion::Identity()};
  const std::vector<PackedPose> packed{{1, pose}, {2, {{-0.001, 0.0, 0.001}, kTurned}}};
  return {
      {"full state", encode(full), {0x7c, 0x06, 0xe8, 0x03, 0x30, 0xf8, 0xdc, 0x05, 0x64, 0x00,
                                    0x38, 0xff, 0x2c, 0x01, 0x0a, 0x00, 0x14, 0x00, 0xe2, 0xff,
                                    0xde, 0x50, 0xaa, 0xc4, 0x64, 0x00, 0x38, 0xff, 0x2c, 0x01}},
      {"position",
       encode(PositionSetpoint{{1.0, -2.0, 0.5}, std::acos(0.0)}),
       {0x7c, 0x07, 0x00, 0x00, 0x80, 0x3f, 0x00, 0x00, 0x00, 0xc0, 0x00, 0x00, 0x00, 0x3f, 0x00,
        0x00, 0xb4, 0x42}},
      {"stop", encode(StopSetpoint{}), {0x7c, 0x00}},
      {"set-points end", encode(SetpointsEnd{}), {0x7d, 0x00, 0x00, 0x00, 0x00, 0x00}},
      {"external position",
       encode(ExternalPosition{{1.0, -2.0, 0.5}}),
       {0x6c, 0x00, 0x00, 0x80, 0x3f, 0x00, 0x00, 0x00, 0xc0, 0x00, 0x00, 0x00, 0x3f}},
      {"external pose", encode(pose), {0x6d, 0x08, 0x00, 0x00, 0x80, 0x3f, 0x00, 0x00, 0x00, 0xc0,
                                       0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
                                       0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x80, 0x3f}},
      {"packed poses",
       encode(std::span<const PackedPose>(packed)),
       {0x6d, 0x09, 0x01, 0xe8, 0x03, 0x30, 0xf8, 0xf4, 0x01, 0x00, 0x00, 0x00,
        0xc0, 0x02, 0xff, 0xff, 0x00, 0x00, 0x01, 0x00, 0xde, 0x50, 0xaa, 0xc4}},
      {"land",
       encode(HighLevelHeight{true, 0.05, std::nullopt, 2.0}),
       {0x8c, 0x08, 0x00, 0xcd, 0xcc, 0x4c, 0x3d, 0x00, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00,
        0x40}},
      {"take-off",
       encode(HighLevelHeight{false, 1.0, 0.5, 2.0}),
       {0x8c, 0x07, 0x00, 0x00, 0x00, 0x80, 0x3f, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x00, 0x00,
        0x40}},
      {"go to",
       encode(HighLevelGoTo{false, true, {1.0, 2.0, 3.0}, 0.5, 4.0}),
       {0x8c, 0x0c, 0x00, 0x00, 0x01, 0x00, 0x00, 0x80, 0x3f, 0x00, 0x00, 0x00, 0x40,
        0x00, 0x00, 0x40, 0x40, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x80, 0x40}},
      {"high-level stop", encode(HighLevelStop{}), {0x8c, 0x03, 0x00}},
      {"arm", arm_request(true), {0x9d, 0x01, 0x01}},
      {"disarm", arm_request(false), {0x9d, 0x01, 0x00}},
      {"recover", supervisor_request(SupervisorCommand::kRecover), {0x9d, 0x02}},
      {"emergency stop", supervisor_request(SupervisorCommand::kEmergencyStop), {0x9d, 0x03}},
      {"stop watchdog", supervisor_request(SupervisorCommand::kStopWatchdog), {0x9d, 0x04}},
      {"info", info_request(), {0x9c, 0x0c}},
      {"old emergency stop", legacy_emergency_stop(), {0x6d, 0x03}},
      {"protocol", platform_request(PlatformRequest::kProtocol), {0xdd, 0x00}},
      {"firmware", platform_request(PlatformRequest::kFirmware), {0xdd, 0x01}},
      {"device", platform_request(PlatformRequest::kDevice), {0xdd, 0x02}},
      {"source", source_request(), {0xfd, 0x00}},
  };
}

TEST(CrtpPacket, MatchesTheBytesOfAnotherClient) {
  for (const Row& row : rows()) {
    ASSERT_TRUE(row.packet) << row.name;
    const Encoded encoded = encode(*row.packet);
    EXPECT_EQ(ByteList(encoded.bytes().begin(), encoded.bytes().end()), row.bytes) << row.name;
    const auto back = decode(row.bytes);
    ASSERT_TRUE(back) << row.name;
    EXPECT_EQ(*back, *row.packet) << row.name;
  }
}

TEST(CrtpPacket, RefusesAnEmptyOrOverlongPacket) {
  EXPECT_FALSE(decode({}));
  EXPECT_FALSE(decode(ByteList(kPacketMax + 1, 0)));
  EXPECT_TRUE(decode(ByteList(kPacketMax, 0)));
  const auto null = decode(ByteList{kNullHeader});
  ASSERT_TRUE(null);
  EXPECT_TRUE(is_null(*null));
}

TEST(CrtpPacket, IgnoresTheLinkBits) {
  const Packet info = info_request();
  const Encoded from_vehicle = encode(info, 0);
  EXPECT_EQ(from_vehicle.data[0], 0x90);
  EXPECT_EQ(decode(from_vehicle.bytes()), info);
}

// A number that is not finite stops the firmware, so no encoder may write one.
TEST(CrtpPacket, EncodersRefuseImpossibleNumbers) {
  using Encoder = std::function<std::optional<Packet>(double)>;
  const std::vector<std::pair<const char*, Encoder>> encoders = {
      {"external position",
       [](double x) {
         return encode(ExternalPosition{{0.0, x, 0.0}});
       }},
      {"external pose",
       [](double x) {
         return encode(ExternalPose{{x, 0.0, 0.0}, kTurned});
       }},
      {"rotation",
       [](double x) {
         return encode(ExternalPose{Eigen::Vector3d::Zero(), Quaternion(x, 0.0, 0.0, 0.0)});
       }},
      {"packed pose",
       [](double x) {
         const std::vector<PackedPose> one{{1, {{0.0, 0.0, x}, kTurned}}};
         return encode(std::span<const PackedPose>(one));
       }},
      {"full state position",
       [](double x) {
         FullStateSetpoint out;
         out.position_world_m.x() = x;
         return encode(out);
       }},
      {"full state rotation",
       [](double x) {
         FullStateSetpoint out;
         out.world_from_body = Quaternion(0.0, 0.0, x, 0.0);
         return encode(out);
       }},
      {"full state rate",
       [](double x) {
         FullStateSetpoint out;
         out.rate_body_radps.z() = x;
         return encode(out);
       }},
      {"position set-point",
       [](double x) {
         return encode(PositionSetpoint{Eigen::Vector3d::Zero(), x});
       }},
      {"landing",
       [](double x) {
         return encode(HighLevelHeight{true, x, std::nullopt, 1.0});
       }},
      {"duration",
       [](double x) {
         return encode(HighLevelHeight{true, 0.0, std::nullopt, x});
       }},
      {"go to", [](double x) {
         return encode(HighLevelGoTo{false, false, {x, 0.0, 0.0}, 0.0, 1.0});
       }}};
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const auto& [name, encoder] : encoders) {
    EXPECT_TRUE(encoder(1.0)) << name;
    for (const double bad : {std::nan(""), kInfinity, -kInfinity, 1e39}) {
      EXPECT_FALSE(encoder(bad)) << name << " " << bad;
    }
  }
}

TEST(CrtpPacket, FullStateCoversAtMost32Metres) {
  FullStateSetpoint out;
  out.position_world_m.x() = 32.767;
  EXPECT_TRUE(encode(out));
  out.position_world_m.x() = 32.768;
  EXPECT_FALSE(encode(out));
  out.position_world_m.x() = -32.768;
  EXPECT_FALSE(encode(out));
}

TEST(CrtpPacket, PackedPosesContainOneOrTwoPoses) {
  const std::vector<PackedPose> poses(3);
  const std::span<const PackedPose> all(poses);
  EXPECT_FALSE(encode(all.first(0)));
  EXPECT_TRUE(encode(all.first(1)));
  EXPECT_TRUE(encode(all.first(2)));
  EXPECT_FALSE(encode(all));
}

TEST(CrtpPacket, VehicleReadsWhatTheClientWrites) {
  FullStateSetpoint full;
  full.position_world_m = {1.234, -2.5, 0.75};
  full.rate_body_radps = {0.001, 0.0, -1.5};
  full.world_from_body = kTurned;
  const auto read = decode_flight(*encode(full));
  ASSERT_TRUE(read && std::holds_alternative<FullStateSetpoint>(*read));
  const auto& back = std::get<FullStateSetpoint>(*read);
  EXPECT_NEAR((back.position_world_m - full.position_world_m).norm(), 0.0, 1e-9);
  EXPECT_NEAR((back.rate_body_radps - full.rate_body_radps).norm(), 0.0, 1e-9);
  EXPECT_LT(back.world_from_body.angularDistance(kTurned), 0.005);

  const auto land = decode_flight(*encode(HighLevelHeight{true, 0.25, std::nullopt, 1.5}));
  ASSERT_TRUE(land && std::holds_alternative<HighLevelHeight>(*land));
  EXPECT_TRUE(std::get<HighLevelHeight>(*land).is_landing);
  EXPECT_FALSE(std::get<HighLevelHeight>(*land).yaw_rad);
  EXPECT_EQ(std::get<HighLevelHeight>(*land).duration_s, 1.5);
}

// The firmware stops on set-points of a wrong length, so the emulated vehicle must detect them.
TEST(CrtpPacket, RefusesEveryOtherPayloadLength) {
  for (const Row& row : rows()) {
    const Packet whole = *row.packet;
    const bool is_flight = whole.port == Port::kLocalisation || whole.port == Port::kSetpoint ||
                           whole.port == Port::kHighLevel;
    if (!is_flight || !decode_flight(whole)) {
      continue;
    }
    for (std::uint8_t size = 0; size <= kPayloadMax; ++size) {
      Packet other = whole;
      other.size = size;
      const bool is_one_packed_pose = std::string(row.name) == "packed poses" && size == 12;
      EXPECT_EQ(decode_flight(other).has_value(), size == whole.size || is_one_packed_pose)
          << row.name << " " << int{size};
    }
  }
}

TEST(CrtpPacket, RepliesRoundTrip) {
  const Packet land = *encode(HighLevelHeight{true, 0.25, std::nullopt, 1.5});
  const auto reply = decode_high_level_reply(*encode_reply(land, kHighLevelBusy));
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->command, 8);
  EXPECT_EQ(reply->error, 16);
  EXPECT_EQ(decode_info_reply(info_reply(0x20E)), 0x20E);
  EXPECT_FALSE(decode_info_reply(info_request()));
  EXPECT_EQ(decode_protocol_reply(protocol_reply(12)), 12U);
  EXPECT_EQ(decode_platform_text(platform_text_reply(PlatformRequest::kFirmware, "2026.08"),
                                 PlatformRequest::kFirmware),
            "2026.08");
  EXPECT_EQ(source_reply().size, kPayloadMax);
}

TEST(CrtpPacket, VehicleReadsSupervisorRequests) {
  const auto arm = decode_supervisor_request(arm_request(true));
  ASSERT_TRUE(arm);
  EXPECT_TRUE(arm->is_to_arm);
  EXPECT_FALSE(decode_supervisor_request(arm_request(false))->is_to_arm);
  EXPECT_TRUE(decode_supervisor_request(info_request())->is_info);
  EXPECT_EQ(decode_supervisor_request(legacy_emergency_stop())->command,
            SupervisorCommand::kEmergencyStop);
  Packet shorter = arm_request(true);
  shorter.size = 1;
  EXPECT_FALSE(decode_supervisor_request(shorter));
  Packet unknown = arm_request(true);
  unknown.data[0] = 5;
  EXPECT_FALSE(decode_supervisor_request(unknown));
}

}  // namespace
}  // namespace vantage::wire::crtp
