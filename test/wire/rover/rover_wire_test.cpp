#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/rover/link.hpp"
#include "sim/rover/rover_emulator.hpp"
#include "wire/rover/packet.hpp"

namespace vantage::wire::rover {
namespace {

// The example of docs/reference/rover-protocol.md. Another program computed its checksums.
constexpr std::array<std::uint8_t, kCommandBytes> kWorkedCommand = {
    0x56, 0x52, 0x01, 0x01, 0x07, 0x00, 0x00, 0x00, 0x04, 0x03, 0x02, 0x01, 0x05, 0x00,
    0x00, 0x00, 0x00, 0x40, 0x1e, 0x18, 0x24, 0x0a, 0x06, 0x00, 0x00, 0x00, 0x00, 0x3f,
    0x00, 0x00, 0x80, 0xbe, 0x01, 0x00, 0x00, 0x00, 0x45, 0x4d, 0xcc, 0xf6};
constexpr std::array<std::uint8_t, kTelemetryBytes> kWorkedTelemetry = {
    0x56, 0x52, 0x01, 0x02, 0x07, 0x00, 0x00, 0x00, 0xfe, 0xca, 0x00, 0x00, 0x09, 0x00,
    0x00, 0x00, 0x04, 0x03, 0x02, 0x01, 0x05, 0x00, 0x00, 0x00, 0x00, 0x40, 0x1e, 0x18,
    0x24, 0x0a, 0x06, 0x00, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x80, 0xbe, 0x00, 0x00,
    0x40, 0x3f, 0x01, 0x00, 0x00, 0x00, 0x03, 0x00, 0x00, 0x00, 0x56, 0x22, 0x21, 0xfd};

Command worked_command() { return {7, 0x01020304, 5, 1'700'000'000'000'000, 0.5F, -0.25F, kDrive}; }
Telemetry worked_telemetry() {
  return {7, 0xCAFE, 9, 0x01020304, 5, 1'700'000'000'000'000, 0.5F, -0.25F, 0.75F, kDriving, 3};
}

TEST(RoverWire, UsesTheEthernetChecksum) {
  const std::array<std::uint8_t, 9> digits = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  EXPECT_EQ(crc32(digits), 0xCBF43926U);
  EXPECT_EQ(crc32({}), 0U);
}

TEST(RoverWire, MatchesTheReferenceBytes) {
  EXPECT_EQ(encode(worked_command()), kWorkedCommand);
  EXPECT_EQ(encode(worked_telemetry()), kWorkedTelemetry);
  Command command;
  ASSERT_EQ(decode(kWorkedCommand, command), Verdict::kAccepted);
  EXPECT_EQ(command, worked_command());
  Telemetry telemetry;
  ASSERT_EQ(decode(kWorkedTelemetry, telemetry), Verdict::kAccepted);
  EXPECT_EQ(telemetry, worked_telemetry());
}

TEST(RoverWire, RoundTripsAnyContent) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<float> number(-100.0F, 100.0F);
  std::uniform_real_distribution<float> share(0.0F, 1.0F);
  const auto u32 = [&random] { return static_cast<std::uint32_t>(random()); };
  for (int i = 0; i < 10'000; ++i) {
    const Command sent_command{
        u32(),          std::max(1U, u32()), u32(), std::bit_cast<std::int64_t>(random()),
        number(random), number(random),      u32()};
    Command command;
    ASSERT_EQ(decode(encode(sent_command), command), Verdict::kAccepted);
    ASSERT_EQ(command, sent_command);
    const Telemetry sent_telemetry{
        u32(),          u32(),          u32(),
        u32(),          u32(),          std::bit_cast<std::int64_t>(random()),
        number(random), number(random), share(random),
        u32(),          u32()};
    Telemetry telemetry;
    ASSERT_EQ(decode(encode(sent_telemetry), telemetry), Verdict::kAccepted);
    ASSERT_EQ(telemetry, sent_telemetry);
  }
}

TEST(RoverWire, ReportsTheFirstFault) {
  Command out;
  const auto with = [](std::size_t at, std::uint8_t value) {
    auto bytes = kWorkedCommand;
    bytes[at] = value;
    return bytes;
  };
  const std::span<const std::uint8_t> whole(kWorkedCommand);
  EXPECT_EQ(decode({}, out), Verdict::kForeign);
  EXPECT_EQ(decode(whole.first(3), out), Verdict::kForeign);
  EXPECT_EQ(decode(with(0, 'W'), out), Verdict::kForeign);
  EXPECT_EQ(decode(with(2, 2), out), Verdict::kVersion);
  EXPECT_EQ(decode(kWorkedTelemetry, out), Verdict::kKind);
  EXPECT_EQ(decode(whole.first(kCommandBytes - 1), out), Verdict::kLength);
  std::vector<std::uint8_t> longer(whole.begin(), whole.end());
  longer.push_back(0);
  EXPECT_EQ(decode(longer, out), Verdict::kLength);
  EXPECT_EQ(decode(with(kCommandBytes - 1, 0), out), Verdict::kChecksum);
  EXPECT_EQ(out, Command{});

  Command endless = worked_command();
  endless.speed_mps = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(decode(encode(endless), out), Verdict::kValue);
  endless = worked_command();
  endless.session = 0;
  EXPECT_EQ(decode(encode(endless), out), Verdict::kValue);
  Telemetry full = worked_telemetry();
  full.battery_share = 1.01F;
  Telemetry decoded;
  EXPECT_EQ(decode(encode(full), decoded), Verdict::kValue);
}

TEST(RoverWire, RefusesInvalidNumbers) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Command received;
  Telemetry decoded;
  EXPECT_EQ(decode(kWorkedCommand, decoded), Verdict::kKind) << "telemetry instead of a command";
  for (const float bad : {kNan, kInfinity, -kInfinity}) {
    Command command = worked_command();
    command.speed_mps = bad;
    EXPECT_EQ(decode(encode(command), received), Verdict::kValue) << bad;
    command = worked_command();
    command.yaw_rate_radps = bad;
    EXPECT_EQ(decode(encode(command), received), Verdict::kValue) << bad;
    Telemetry telemetry = worked_telemetry();
    telemetry.speed_mps = bad;
    EXPECT_EQ(decode(encode(telemetry), decoded), Verdict::kValue) << bad;
    telemetry = worked_telemetry();
    telemetry.yaw_rate_radps = bad;
    EXPECT_EQ(decode(encode(telemetry), decoded), Verdict::kValue) << bad;
    telemetry = worked_telemetry();
    telemetry.battery_share = bad;
    EXPECT_EQ(decode(encode(telemetry), decoded), Verdict::kValue) << bad;
  }
  EXPECT_EQ(received, Command{}) << "changed only if accepted";
  EXPECT_EQ(decoded, Telemetry{});
  for (const float share : {-0.001F, 0.0F, 0.5F, 1.0F, 1.001F}) {
    Telemetry telemetry = worked_telemetry();
    telemetry.battery_share = share;
    telemetry.session = 0;  // 0: no driver is in control
    EXPECT_EQ(decode(encode(telemetry), decoded),
              share < 0.0F || share > 1.0F ? Verdict::kValue : Verdict::kAccepted)
        << share;
  }
}

// A round trip through this codec alone would not detect wrong values.
TEST(RoverWire, HasTheDocumentedFlagsAndTimes) {
  EXPECT_EQ(kDrive, 1U);
  EXPECT_EQ(kEmergencyStop, 2U);
  EXPECT_EQ(kReleaseStop, 4U);
  EXPECT_EQ(kDriving, 1U);
  EXPECT_EQ(kStopLatched, 2U);
  EXPECT_EQ(kWatchdogOut, 4U);
  EXPECT_EQ(kMotorFailed, 8U);
  EXPECT_EQ(kWatchdogS, 0.2);
  EXPECT_EQ(1.0 / kTelemetryPeriodS, 20.0);
}

TEST(RoverWire, NamesEachVerdict) {
  const std::array<const char*, kVerdicts> names{"accepted", "foreign",  "version", "kind",
                                                 "length",   "checksum", "value"};
  for (std::size_t i = 0; i < kVerdicts; ++i) {
    EXPECT_STREQ(name_of(static_cast<Verdict>(i)), names.at(i));
  }
}

TEST(RoverWire, DetectsEveryFlippedBit) {
  for (std::size_t bit = 0; bit < 8 * kTelemetryBytes; ++bit) {
    auto bytes = kWorkedTelemetry;
    bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ (1U << (bit % 8)));
    Telemetry out;
    EXPECT_NE(decode(bytes, out), Verdict::kAccepted) << "bit " << bit;
  }
}

TEST(RoverWire, SequencesWrap) {
  EXPECT_TRUE(is_after(1, 0));
  EXPECT_FALSE(is_after(0, 0));
  EXPECT_FALSE(is_after(0, 1));
  EXPECT_TRUE(is_after(0, 0xFFFFFFFF));
  EXPECT_TRUE(is_after(5, 0xFFFFFFF0));
  EXPECT_TRUE(is_after(0x7FFFFFFF, 0)) << "by less than half of the range";
  EXPECT_FALSE(is_after(0x80000001, 0));
}

/// Generates random bytes. Half of them begin like a valid datagram, and some of those are valid
/// datagrams with changed bytes.
class Noise {
 public:
  std::span<const std::uint8_t> next() {
    const std::uint64_t kind = random_() % 4;
    std::size_t bytes = random_() % bytes_.size();
    for (std::size_t i = 0; i < bytes; ++i) {
      bytes_[i] = static_cast<std::uint8_t>(random_());
    }
    if (kind == 0) {
      const bool is_command = random_() % 2 == 0;
      bytes = is_command ? kCommandBytes : kTelemetryBytes;
      is_command ? static_cast<void>(std::ranges::copy(kWorkedCommand, bytes_.begin()))
                 : static_cast<void>(std::ranges::copy(kWorkedTelemetry, bytes_.begin()));
      bytes_[random_() % bytes] = static_cast<std::uint8_t>(random_());
      bytes -= random_() % 8 == 0 ? 1U : 0U;
    } else if (kind == 1) {
      const std::array<std::uint8_t, 4> header = {'V', 'R', 1,
                                                  static_cast<std::uint8_t>(1 + random_() % 2)};
      std::ranges::copy(header, bytes_.begin());
    }
    return std::span(bytes_).first(bytes);
  }

 private:
  std::mt19937_64 random_{20'260'101};
  std::array<std::uint8_t, 96> bytes_{};
};

TEST(RoverWire, CountsEachRandomDatagramOnce) {
  Noise noise;
  std::array<std::int64_t, kVerdicts> counts{};
  for (int i = 0; i < 1'000'000; ++i) {
    const auto datagram = noise.next();
    Command command;
    const Verdict verdict = decode(datagram, command);
    ++counts[static_cast<std::size_t>(verdict)];
    if (verdict == Verdict::kAccepted) {
      // Accepted only if each changed byte was replaced by its own value.
      ASSERT_EQ(encode(command), kWorkedCommand);
    }
    Telemetry telemetry;
    if (decode(datagram, telemetry) == Verdict::kAccepted) {
      ASSERT_EQ(encode(telemetry), kWorkedTelemetry);
    }
  }
  for (const Verdict each : {Verdict::kAccepted, Verdict::kForeign, Verdict::kVersion,
                             Verdict::kKind, Verdict::kLength, Verdict::kChecksum}) {
    EXPECT_GT(counts[static_cast<std::size_t>(each)], 0) << name_of(each);
  }
}

TEST(RoverLink, CountsRefusedDatagrams) {
  constexpr Time kNow = from_utime(1'700'000'000'000'000);
  drivers::RoverLink link(7, 0x01020304);
  for (int i = 0; i < 5; ++i) {
    (void)link.command({}, 0, kNow);
  }
  EXPECT_TRUE(link.receive(kWorkedTelemetry, kNow));
  EXPECT_EQ(link.taken_command_age_s(kNow + Duration{30'000}), 0.03);
  EXPECT_FALSE(link.receive(kWorkedTelemetry, kNow)) << "repeated message";
  Telemetry other = worked_telemetry();
  other.robot = 8;
  EXPECT_FALSE(link.receive(encode(other), kNow));
  other = worked_telemetry();
  other.boot = 1;
  other.sequence = 0;
  EXPECT_TRUE(link.receive(encode(other), kNow)) << "a restarted rover";
  Noise noise;
  for (int i = 0; i < 100'000; ++i) {
    (void)link.receive(noise.next(), kNow);
  }
  std::vector<models::NamedCount> counts;
  link.count(counts);
  const auto count_of = [&counts](const std::string& name) {
    const auto found = std::ranges::find(counts, name, &models::NamedCount::name);
    return found == counts.end() ? -1 : found->count;
  };
  EXPECT_EQ(count_of("rover.misaddressed"), 1);
  EXPECT_GE(count_of("rover.late"), 1);
  EXPECT_GT(count_of("rover.foreign"), 0);
  EXPECT_GT(count_of("rover.version"), 0);
  EXPECT_GT(count_of("rover.kind"), 0);
  EXPECT_GT(count_of("rover.length"), 0);
  EXPECT_GT(count_of("rover.checksum"), 0);
}

TEST(RoverLink, IgnoresCommandsOfAnotherDriver) {
  constexpr Time kNow = from_utime(1'700'000'000'000'000);
  drivers::RoverLink link(7, 0x99);
  EXPECT_TRUE(link.is_ours());
  EXPECT_TRUE(link.receive(kWorkedTelemetry, kNow));
  EXPECT_FALSE(link.is_ours());
  EXPECT_EQ(link.taken_command_age_s(kNow), std::numeric_limits<double>::infinity());
}

/// A rover that receives the commands of one driver.
class RoverRules : public ::testing::Test {
 protected:
  void receive_command(Command command) {
    command.time_us = to_utime(now);
    rover.receive(encode(command), now);
  }
  void run(double seconds) {
    const Time end = now + from_seconds(seconds);
    for (; now < end; now += Duration{5'000}) {
      rover.advance_to(now);
    }
  }
  Command drive(std::uint32_t sequence) const { return {1, 11, sequence, 0, 0.5F, 0.0F, kDrive}; }

  Time now = from_utime(1'700'000'000'000'000);
  sim::RoverEmulator rover{{}, now};
};

TEST_F(RoverRules, WatchdogStopsTheRover) {
  for (std::uint32_t i = 1; i <= 50; ++i) {
    receive_command(drive(i));
    run(0.02);
  }
  EXPECT_NEAR(rover.state().speed_mps, 0.5, 1e-9);
  run(kWatchdogS - 0.03);
  EXPECT_NEAR(rover.state().speed_mps, 0.5, 1e-9) << "not before the delay";
  run(0.03 + 0.02 + 0.5 / 2.0);
  EXPECT_EQ(rover.state().speed_mps, 0.0);
}

TEST_F(RoverRules, RefusesOldAndForeignCommands) {
  receive_command(drive(5));
  receive_command(drive(5));
  receive_command(drive(4));
  Command other = drive(100);
  other.session = 12;
  receive_command(other);
  other.robot = 2;
  receive_command(other);
  EXPECT_EQ(rover.refused(), 4);
  run(kWatchdogS + 0.02);
  other.robot = 1;
  receive_command(other);
  EXPECT_EQ(rover.refused(), 4) << "after the first driver's silence, another driver may send";
}

TEST_F(RoverRules, AcceptsEmergencyStopFromAnySenderAndReleaseFromItsDriver) {
  receive_command(drive(5));
  Command stop = drive(1);
  stop.session = 12;
  stop.flags = kEmergencyStop;
  receive_command(stop);
  EXPECT_TRUE(rover.is_stopped());
  receive_command(drive(6));
  run(0.1);
  EXPECT_EQ(rover.state().speed_mps, 0.0);
  stop.sequence = 2;
  stop.flags = kReleaseStop;
  receive_command(stop);
  EXPECT_TRUE(rover.is_stopped());
  Command release = drive(7);
  release.flags = kReleaseStop | kDrive;
  receive_command(release);
  EXPECT_TRUE(rover.is_stopped()) << "not while driving is requested";
  release.sequence = 8;
  release.flags = kReleaseStop;
  receive_command(release);
  EXPECT_FALSE(rover.is_stopped());
}

}  // namespace
}  // namespace vantage::wire::rover
