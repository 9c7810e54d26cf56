#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/auth/authenticator.hpp"
#include "bus/auth/envelope.hpp"
#include "bus/auth/trailer.hpp"

// Tests the trailer after a payload, the role that signs each channel, and the names of refusals.

namespace vantage::bus::auth {
namespace {

using Message = std::vector<std::uint8_t>;
using scenario::TrialMode;

/// Returns a message composed of the arguments. Its MAC and signature are each filled with one
/// distinct byte.
Message message_of(const Message& payload, const Foot& foot, const std::vector<Echo>& echoes,
                   std::size_t signatures) {
  Message out = payload;
  append_echoes(echoes, out);
  out.insert(out.end(), signatures * kSignatureBytes, 0xAA);
  out.insert(out.end(), kMacBytes, 0xBB);
  const auto foot_at_end = foot_bytes(foot, echoes.size(), signatures);
  out.insert(out.end(), foot_at_end.begin(), foot_at_end.end());
  return out;
}

TEST(Trailer, ParsesToTheWrittenFields) {
  std::mt19937_64 rng(31);
  for (int i = 0; i < 2'000; ++i) {
    const Foot foot{static_cast<std::uint32_t>(rng()), rng(), rng(), kRoles[rng() % kRoles.size()],
                    static_cast<TrialMode>(1 + rng() % 4)};
    std::vector<Echo> echoes(i < 65 ? static_cast<std::size_t>(i) : rng() % 4);
    for (Echo& echo : echoes) {
      echo = {static_cast<std::uint32_t>(rng()), rng()};
    }
    const Message payload(rng() % 50, 0xCC);
    const std::size_t signatures = rng() % 2;
    const Message message = message_of(payload, foot, echoes, signatures);
    const auto parts = split(message);
    ASSERT_TRUE(parts.has_value());
    EXPECT_EQ(parts->foot, foot);
    EXPECT_EQ(Message(parts->payload.begin(), parts->payload.end()), payload);
    EXPECT_EQ(Message(parts->signature.begin(), parts->signature.end()),
              Message(signatures * kSignatureBytes, 0xAA));
    EXPECT_EQ(Message(parts->mac.begin(), parts->mac.end()), Message(kMacBytes, 0xBB));
    EXPECT_EQ(parts->foot_bytes.size(), kFootBytes);
    EXPECT_EQ(payload_of(message).size(), payload.size());
    for (const Echo& echo : echoes) {
      EXPECT_EQ(parts->echo_for(echo.destination), echo.nonce);
    }
    EXPECT_EQ(parts->echo_for(static_cast<std::uint32_t>(rng())), std::nullopt);
    // An empty payload is valid; a trailer that is one byte shorter is not.
    const Bytes trailer = Bytes(message).subspan(payload.size());
    ASSERT_TRUE(split(trailer).has_value());
    EXPECT_TRUE(split(trailer)->payload.empty());
    EXPECT_FALSE(split(trailer.subspan(1)).has_value());
    EXPECT_EQ(payload_of(trailer.subspan(1)).size(), trailer.size() - 1)
        << "without a trailer the payload is the complete message";
  }
}

TEST(Trailer, RefusesUnknownRolesModesAndCounts) {
  const Message good =
      message_of(Message(5'000, 0), {1, 2, 3, Role::kNode, TrialMode::kLive}, {}, 0);
  const auto with = [&good](std::size_t from_end, int value) {
    Message message = good;
    message[message.size() - from_end] = static_cast<std::uint8_t>(value);
    return split(message).has_value();
  };
  for (int value = 0; value < 256; ++value) {
    EXPECT_EQ(with(12, value), value >= 1 && value <= 5) << "role " << value;
    EXPECT_EQ(with(11, value), value >= 1 && value <= 4) << "mode " << value;
    EXPECT_EQ(with(10, value), value <= 64) << "echoes " << value;
    EXPECT_EQ(with(9, value), value <= 1) << "signatures " << value;
    EXPECT_EQ(with(8, value), value == 1) << "version " << value;
  }
  for (std::size_t from_end = 1; from_end <= 8; ++from_end) {
    EXPECT_FALSE(with(from_end, 'X'));
  }
}

TEST(Trailer, ReturnsTheFirstEchoOfADuplicateVehicle) {
  const Message message = message_of({}, {1, 2, 3, Role::kOperator, TrialMode::kLive},
                                     {{0x01020304, 5}, {0x01020305, 6}, {0x01020304, 7}}, 1);
  const SignedParts parts = split(message).value();
  EXPECT_EQ(parts.echo_for(0x01020304), 5U);
  EXPECT_EQ(parts.echo_for(0x01020305), 6U);
  EXPECT_EQ(parts.echo_for(0x04030201), std::nullopt);
}

TEST(Policy, GivesEachChannelItsRole) {
  const std::vector<std::pair<Role, std::vector<const char*>>> rows{
      {Role::kMocap, {"VICON"}},
      {Role::kOperator, {"COMMAND"}},
      {Role::kPlanner,
       {"PLAN_Q1", "PROPOSAL_Q1", "TEAM_PROPOSAL_Q1", "EXTERNAL_PLAN_Q1", "EXTERNAL_REQUEST_Q1"}},
      {Role::kVehicle, {"VEHICLE_Q1"}},
      {Role::kNode,
       {"MEASUREMENT_Q1", "SCAN_Q1", "BELIEF_Q1", "MIXTURE_Q1", "MAP_Q1", "ATTACK", "HEALTH_X",
        "SCENARIO", "TRUTH", "HOST_A", "COLLISION", "anything", "", "VICON_", "COMMANDS", "PLAN"}}};
  for (const auto& [role, channels] : rows) {
    for (const char* const channel : channels) {
      EXPECT_EQ(role_of(channel), role) << channel;
    }
  }
  for (const char* const other :
       {"PLAN", "PLANS_Q1", "COMMANDS", "COMMAND_", "XPLAN_Q1", "TRUTHS"}) {
    EXPECT_FALSE(must_be_signed(other)) << other;
  }
}

TEST(Roles, HaveTheNamesOfTheirKeys) {
  const std::vector<std::string> names{"mocap", "planner", "vehicle", "operator", "node"};
  for (std::size_t i = 0; i < kRoles.size(); ++i) {
    EXPECT_EQ(name_of(kRoles[i]), names[i]);
    EXPECT_EQ(static_cast<std::size_t>(kRoles[i]), i + 1) << "value in the message";
  }
}

TEST(RefusalCounts, CoverEveryReason) {
  for (std::size_t i = 0; i < kRefusals; ++i) {
    const std::string reason = name_of(static_cast<Refusal>(i));
    EXPECT_NE(reason, "unknown") << i;
    const auto count = parse_refusal("A.B." + reason);
    EXPECT_EQ(count.has_value(), i > 0) << reason;
    if (count) {
      EXPECT_EQ(count->channel, "A.B");
      EXPECT_EQ(count->reason, reason);
    }
  }
  EXPECT_STREQ(name_of(static_cast<Refusal>(kRefusals)), "unknown")
      << "all refusals have been named";
  EXPECT_TRUE(parse_refusal("VICON.no_key").has_value());
  EXPECT_FALSE(parse_refusal("no_key").has_value());
  EXPECT_FALSE(parse_refusal("VICON.unsigned.").has_value());
}

}  // namespace
}  // namespace vantage::bus::auth
