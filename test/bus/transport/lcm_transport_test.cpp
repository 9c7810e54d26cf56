#include "bus/transport/lcm_transport.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/check.hpp"
#include "core/deadline.hpp"

namespace vantage::bus {
namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr std::chrono::microseconds kNow{0};

TEST(LcmTransport, DeliversWithinAProcessInOrder) {
  const auto transport = open_transport("memq://");
  std::vector<std::string> names;
  transport->subscribe("PLAN_*", [&](std::string_view name, auto) { names.emplace_back(name); });
  EXPECT_EQ(transport->handle(kNow), 0);
  transport->publish("PLAN_Q1", Bytes{1});
  transport->publish("BELIEF_Q1", Bytes{1});
  transport->publish("PLAN_Q2", Bytes{1});
  EXPECT_EQ(transport->handle(kNow), 2);
  EXPECT_EQ(names, (std::vector<std::string>{"PLAN_Q1", "PLAN_Q2"}));
}

TEST(LcmTransport, RethrowsAHandlersExceptionAndStaysUsable) {
  const auto transport = open_transport("memq://");
  int calls = 0;
  transport->subscribe("X", [&](auto, auto) {
    if (++calls == 1) {
      throw std::runtime_error("handler");
    }
  });
  transport->publish("X", Bytes{});
  transport->publish("X", Bytes{});
  EXPECT_THROW(transport->handle(kNow), std::runtime_error);
  EXPECT_EQ(transport->handle(kNow), 1);
  EXPECT_EQ(calls, 2);
}

TEST(LcmTransport, TreatsChannelNamesLiterally) {
  const auto transport = open_transport("memq://");
  const auto ignore = [](auto, auto) {};
  EXPECT_NO_THROW(transport->subscribe("HEALTH_ESTIMATOR_Q1", ignore));
  EXPECT_NO_THROW(transport->subscribe("*", ignore));
  for (const char* name : {"", "A.B", "A|B", "A+", "(A", "A*B", "A\\d", "A$"}) {
    EXPECT_THROW(transport->subscribe(name, ignore), UsageError) << name;
  }
}

TEST(LcmTransport, AcceptsAllValidChannelCharacters) {
  const auto transport = open_transport("memq://");
  const std::string allowed = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_:/-";
  const auto ignore = [](auto, auto) {};
  for (int c = 1; c < 256; ++c) {
    const std::string name = std::string("X") + static_cast<char>(c) + "Y";
    if (allowed.find(static_cast<char>(c)) != std::string::npos) {
      EXPECT_NO_THROW(transport->subscribe(name, ignore)) << name;
      EXPECT_NO_THROW(transport->subscribe(name + "*", ignore)) << name;
    } else {
      EXPECT_THROW(transport->subscribe(name, ignore), UsageError) << name;
    }
  }
}

TEST(LcmTransport, DeliversNothingAfterUnsubscribing) {
  const auto transport = open_transport("memq://");
  std::string received;
  const std::vector<std::pair<const char*, char>> handlers{
      {"X", 'a'}, {"Y", 'b'}, {"X", 'c'}, {"X*", 'd'}};
  for (const auto& [name, who] : handlers) {
    transport->subscribe(name, [&received, who = who](auto, auto) { received += who; });
  }
  for (int time = 0; time < 2; ++time) {
    transport->unsubscribe("X");
    transport->publish("X", Bytes{});
    transport->publish("Y", Bytes{});
    EXPECT_EQ(transport->handle(kNow), 2);
    EXPECT_EQ(received, "db");
    received.clear();
  }
  transport->subscribe("X", [&received](auto, auto) { received += 'e'; });
  transport->unsubscribe("X*");
  transport->publish("X", Bytes{});
  transport->handle(kNow);
  EXPECT_EQ(received, "e");
}

TEST(LcmTransport, CountsSentAndReceivedMessages) {
  const auto transport = open_transport("memq://");
  for (const char* const name : {"X", "X*", "Y"}) {
    transport->subscribe(name, [](auto, auto) {});
  }
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(transport->publish("X", Bytes{1}));
  }
  EXPECT_TRUE(transport->publish("Y", Bytes{1}));
  EXPECT_EQ(transport->handle(kNow), 4);
  EXPECT_EQ(transport->stats().messages_sent, 4);
  EXPECT_EQ(transport->stats().messages_received, 7) << "two handlers of X and one other";
  EXPECT_EQ(transport->stats().send_errors, 0);
}

// handle() must return during a flood; the next call handles the remaining messages.
TEST(LcmTransport, HandlesTheRequestedNumberOfMessages) {
  const auto transport = open_transport("memq://");
  int received = 0;
  transport->subscribe("X", [&received](auto, auto) { ++received; });
  for (int i = 0; i < 5'000; ++i) {
    transport->publish("X", Bytes{1});
  }
  EXPECT_EQ(transport->handle(kNow), 4'096);
  EXPECT_EQ(received, 4'096);
  EXPECT_EQ(transport->handle(kNow), 904);
  EXPECT_EQ(transport->handle(kNow), 0);
}

TEST(LcmTransport, WaitsForTheTimeoutWithoutMessages) {
  const auto transport = open_transport("memq://");
  for (const int wait_us : {20'000, 500, 0, -1'000}) {  // parts of a millisecond are rounded up
    const std::int64_t begin_ns = monotonic_ns();
    EXPECT_EQ(transport->handle(std::chrono::microseconds(wait_us)), 0);
    EXPECT_GE(monotonic_ns() - begin_ns, std::int64_t{1'000} * wait_us) << wait_us;
  }
}

TEST(LcmTransport, RefusesHandleInsideAHandler) {
  const auto transport = open_transport("memq://");
  transport->subscribe("X", [&](auto, auto) { transport->handle(kNow); });
  transport->publish("X", Bytes{});
  EXPECT_THROW(transport->handle(kNow), UsageError);
}

TEST(LcmTransport, WritesALogAndReadsItToItsEnd) {
  const std::filesystem::path path = std::filesystem::temp_directory_path() /
                                     ("vantage_bus_test_" + std::to_string(getpid()) + ".lcmlog");
  {
    const auto writer = open_transport("file://" + path.string() + "?mode=w");
    for (std::uint8_t i = 0; i < 10; ++i) {
      EXPECT_TRUE(writer->publish("X", Bytes{i}));
    }
  }
  const auto reader = open_transport("file://" + path.string() + "?mode=r&speed=0");
  Bytes received;
  reader->subscribe(
      "X", [&](auto, std::span<const std::uint8_t> bytes) { received.push_back(bytes[0]); });
  int status = 0;
  int handled = 0;
  for (int i = 0; i < 1'000 && status != kSourceEnded; ++i) {
    status = reader->handle(std::chrono::milliseconds(100));
    handled += std::max(status, 0);
  }
  EXPECT_EQ(handled, 10);
  EXPECT_EQ(reader->handle(kNow), kSourceEnded) << "the end is permanent";
  std::filesystem::remove(path);
  EXPECT_EQ(status, kSourceEnded);
  EXPECT_EQ(received, (Bytes{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
}

}  // namespace
}  // namespace vantage::bus
