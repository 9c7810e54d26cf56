#include "bus/transport/lcm_transport.hpp"

#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/check.hpp"

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

TEST(LcmTransport, BringsAHandlersExceptionOutAndStaysUsable) {
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

TEST(LcmTransport, TakesChannelNamesLiterallyOrNotAtAll) {
  const auto transport = open_transport("memq://");
  const auto ignore = [](auto, auto) {};
  EXPECT_NO_THROW(transport->subscribe("HEALTH_ESTIMATOR_Q1", ignore));
  EXPECT_NO_THROW(transport->subscribe("*", ignore));
  for (const char* name : {"", "A.B", "A|B", "A+", "(A", "A*B", "A\\d", "A$"}) {
    EXPECT_THROW(transport->subscribe(name, ignore), UsageError) << name;
  }
}

TEST(LcmTransport, RefusesToHandleInsideAHandler) {
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
  Bytes heard;
  reader->subscribe("X",
                    [&](auto, std::span<const std::uint8_t> bytes) { heard.push_back(bytes[0]); });
  int status = 0;
  for (int i = 0; i < 1'000 && status != kSourceEnded; ++i) {
    status = reader->handle(std::chrono::milliseconds(100));
  }
  std::filesystem::remove(path);
  EXPECT_EQ(status, kSourceEnded);
  EXPECT_EQ(heard, (Bytes{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
}

}  // namespace
}  // namespace vantage::bus
