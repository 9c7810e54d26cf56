#include "wire/sitl/json_physics.hpp"

#include <cstdio>
#include <vector>

#include <gtest/gtest.h>

namespace vantage::wire::sitl {
namespace {

// A packet sent by ArduCopter 4.6.2: frame 3, with 1500 µs on the first output and 1000 µs on the
// others.
const std::vector<std::uint8_t> kRecorded = [] {
  std::vector<std::uint8_t> out{0x1A, 0x48, 0xB0, 0x04, 3, 0, 0, 0, 0xDC, 0x05};
  while (out.size() < 40) {
    out.insert(out.end(), {0xE8, 0x03});
  }
  return out;
}();

TEST(JsonPhysics, ReadsTheFirmwaresOutputs) {
  const auto outputs = wire::sitl::parse_servo_outputs(kRecorded);
  ASSERT_TRUE(outputs);
  EXPECT_EQ(outputs->frame_rate_hz, 1200);
  EXPECT_EQ(outputs->frame_count, 3U);
  EXPECT_EQ(outputs->pulse_us[0], 1500);
  EXPECT_EQ(outputs->pulse_us[15], 1000);
  const auto bytes = wire::sitl::format_servo_outputs(*outputs);
  EXPECT_EQ(std::vector<std::uint8_t>(bytes.begin(), bytes.end()), kRecorded);
}

TEST(JsonPhysics, AcceptsThirtyTwoOutputs) {
  std::vector<std::uint8_t> wide = kRecorded;
  wide[0] = 0x81;
  wide[1] = 0x73;
  wide.resize(72, 0);
  const auto outputs = wire::sitl::parse_servo_outputs(wide);
  ASSERT_TRUE(outputs);
  EXPECT_EQ(outputs->pulse_us[0], 1500);
}

TEST(JsonPhysics, KeepsTheOrderOfOutputs) {
  wire::sitl::ServoOutputs sent;
  sent.frame_rate_hz = 0x0102;
  sent.frame_count = 0x03040506;
  for (std::size_t i = 0; i < sent.pulse_us.size(); ++i) {
    sent.pulse_us[i] = static_cast<std::uint16_t>(1000 + 37 * i);
  }
  const auto bytes = wire::sitl::format_servo_outputs(sent);
  const auto read = wire::sitl::parse_servo_outputs(bytes);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->frame_rate_hz, sent.frame_rate_hz);
  EXPECT_EQ(read->frame_count, sent.frame_count);
  EXPECT_EQ(read->pulse_us, sent.pulse_us);
  std::vector<std::uint8_t> wide(bytes.begin(), bytes.end());
  wide.resize(72, 0xFF);
  EXPECT_FALSE(wire::sitl::parse_servo_outputs(wide)) << "the magic of the short one";
  wide[0] = 0x81;
  wide[1] = 0x73;
  ASSERT_TRUE(wire::sitl::parse_servo_outputs(wide));
  EXPECT_EQ(wire::sitl::parse_servo_outputs(wide)->pulse_us, sent.pulse_us);
  wide.resize(40);
  EXPECT_FALSE(wire::sitl::parse_servo_outputs(wide)) << "the magic of the long one";
}

TEST(JsonPhysics, RefusesAnyWrongLengthOrMagicNumber) {
  for (std::size_t length = 0; length < 80; ++length) {
    std::vector<std::uint8_t> bytes = kRecorded;
    bytes.resize(length, 0);
    EXPECT_EQ(wire::sitl::parse_servo_outputs(bytes).has_value(), length == 40) << length;
  }
  for (std::size_t i = 0; i < 2; ++i) {
    std::vector<std::uint8_t> bytes = kRecorded;
    bytes[i] ^= 1U;
    EXPECT_FALSE(wire::sitl::parse_servo_outputs(bytes));
  }
}

// The firmware's parser searches for a key, skips the quote and the colon, and reads with "[%f, %f,
// %f]". It does not accept a blank before the bracket.
TEST(JsonPhysics, IsReadableByTheFirmwaresParser) {
  wire::sitl::JsonSensors sensors;
  sensors.time_s = 12.5;
  sensors.gyro_body_radps = {0.1, -0.2, 1e-9};
  sensors.specific_force_body_mps2 = {0.5, 0.0, -9.81};
  sensors.position_local_m = {-3.0, 0.25, -1.5};
  sensors.velocity_local_mps = {0.75, -0.5, 0.125};
  sensors.local_from_body = Eigen::Quaterniond(0.1, -0.3, 0.5, -0.8);
  const std::string text = wire::sitl::format_json_sensors(sensors);
  ASSERT_EQ(text.front(), '\n');
  ASSERT_EQ(text.back(), '\n');
  const auto read3 = [&text](const char* key) {
    Eigen::Vector3d v;
    const std::size_t at = text.find(key);
    EXPECT_NE(at, std::string::npos) << key;
    const char* value = text.c_str() + at + std::string(key).size() + 2;
    EXPECT_EQ(std::sscanf(value, "[%lf, %lf, %lf]", &v.x(), &v.y(), &v.z()), 3) << key;
    return v;
  };
  EXPECT_EQ(read3("gyro"), sensors.gyro_body_radps);
  EXPECT_EQ(read3("accel_body"), sensors.specific_force_body_mps2);
  EXPECT_EQ(read3("position"), sensors.position_local_m);
  EXPECT_EQ(read3("velocity"), sensors.velocity_local_mps);
  EXPECT_NE(text.find("\"timestamp\":12.500000"), std::string::npos);
  EXPECT_EQ(wire::sitl::kJsonPort, 9002);
  EXPECT_NE(text.find("\"quaternion\":[0.1,-0.3,0.5,-0.8]"), std::string::npos);
  EXPECT_NE(text.find("\"no_time_sync\":1"), std::string::npos);
}

}  // namespace
}  // namespace vantage::wire::sitl
