#include "drivers/quadrotor/command_sender.hpp"

#include <gtest/gtest.h>

namespace vantage::drivers {
namespace {

constexpr Time kNow = from_utime(1'700'000'000'000'000);
constexpr Duration kSecond = std::chrono::seconds(1);

wire::mavlink::CommandLong arm(float on) {
  wire::mavlink::CommandLong out;
  out.command = 400;
  out.param1 = on;
  return out;
}

wire::mavlink::CommandAck ack(std::uint8_t result) {
  wire::mavlink::CommandAck out;
  out.command = 400;
  out.result = result;
  return out;
}

TEST(CommandSender, RepeatsWithIncreasingConfirmationThenGivesUp) {
  CommandSender sender;
  sender.send_command(arm(1), kNow, kSecond);
  std::vector<int> confirmations;
  for (int i = 0; i < 50; ++i) {
    for (const auto& command : sender.due(kNow + i * Duration{100'000})) {
      confirmations.push_back(command.confirmation);
    }
  }
  EXPECT_EQ(confirmations, (std::vector{0, 1, 2, 3}));
  EXPECT_EQ(sender.unanswered(), 1);
  ASSERT_TRUE(sender.outcome(400).has_value());
  EXPECT_FALSE(sender.outcome(400)->result.has_value());
}

TEST(CommandSender, RepeatsOnlyAfterThePause) {
  CommandSender sender;
  sender.send_command(arm(1), kNow, 2 * kSecond);
  EXPECT_EQ(sender.due(kNow).size(), 1U);
  sender.acknowledge(ack(4), kNow);
  EXPECT_EQ(sender.outcome(400)->result, 4);
  sender.send_command(arm(1), kNow + kSecond, 2 * kSecond);
  EXPECT_TRUE(sender.due(kNow + kSecond).empty());
  sender.send_command(arm(1), kNow + 2 * kSecond, 2 * kSecond);
  EXPECT_EQ(sender.due(kNow + 2 * kSecond).size(), 1U);
}

TEST(CommandSender, ReplacesACommandByItsOpposite) {
  CommandSender sender;
  sender.send_command(arm(1), kNow, kSecond);
  EXPECT_EQ(sender.due(kNow).size(), 1U);
  sender.send_command(arm(0), kNow, kSecond);
  const auto due = sender.due(kNow);
  ASSERT_EQ(due.size(), 1U);
  EXPECT_EQ(due[0].param1, 0.0F);
}

TEST(CommandSender, WaitsLongerForACommandInProgress) {
  CommandSender sender;
  sender.send_command(arm(1), kNow, kSecond);
  EXPECT_EQ(sender.due(kNow).size(), 1U);
  sender.acknowledge(ack(5), kNow + Duration{100'000});
  EXPECT_TRUE(sender.due(kNow + 2 * kSecond).empty());
  EXPECT_TRUE(sender.is_under_way(400));
  EXPECT_EQ(sender.due(kNow + 4 * kSecond).size(), 1U);
}

TEST(CommandSender, RepeatsAPeriodicCommandAfterAFailure) {
  CommandSender sender;
  int sent = 0;
  for (int i = 0; i < 100; ++i) {
    const Time now = kNow + i * Duration{20'000};
    sender.send_command_periodically(arm(0), now, Duration{100'000});
    sent += static_cast<int>(sender.due(now).size());
    sender.acknowledge(ack(4), now);
  }
  EXPECT_EQ(sent, 20);
}

TEST(CommandSender, IgnoresUnexpectedReplies) {
  CommandSender sender;
  sender.acknowledge(ack(0), kNow);
  EXPECT_FALSE(sender.outcome(400).has_value());
}

}  // namespace
}  // namespace vantage::drivers
