#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "test/integration/network_support.hpp"

// Runs in a network without a multicast route. If open_transport() blocks, the test fails by its
// time limit.

namespace vantage {
namespace {

TEST(MulticastWithoutRoute, FailsToOpenAndStatesTheRemedy) {
  try {
    bus::open_transport(test::kUrl);
    FAIL() << "opened";
  } catch (const StartupError& e) {
    EXPECT_NE(std::string(e.what()).find("ip route add 224.0.0.0/4"), std::string::npos)
        << e.what();
  }
}

struct Waiting {
  std::vector<std::string> reports;
  std::unique_ptr<bus::Transport> transport = bus::open_waiting_transport(
      test::kUrl, [this](const std::string& words) { reports.push_back(words); });
  int received = 0;

  Waiting() {
    transport->subscribe("A", [this](std::string_view, const bus::Payload&) { ++received; });
  }
  /// True if the transport receives its own message within 100 tries.
  bool receives_own_message() {
    const int before = received;
    for (int i = 0; i < 100 && received == before; ++i) {
      transport->publish("A", test::random_bytes(10, 1));
      transport->handle(std::chrono::milliseconds(20));
    }
    return received > before;
  }
  /// True if the newest report contains `words` within 100 tries.
  bool reports_at_last(const std::string& words) {
    for (int i = 0; i < 100 && reports.back().find(words) == std::string::npos; ++i) {
      transport->handle(std::chrono::milliseconds(20));
    }
    return reports.back().find(words) != std::string::npos;
  }
};

void ip(const std::string& words) { ASSERT_EQ(std::system(("ip " + words).c_str()), 0) << words; }

TEST(MulticastWithoutRoute, JoinsWheneverTheRouteAppears) {
  Waiting waiting;
  EXPECT_FALSE(waiting.receives_own_message());
  ASSERT_EQ(waiting.reports.size(), 1U) << "once, however often it tries";
  EXPECT_NE(waiting.reports[0].find("cannot join"), std::string::npos) << waiting.reports[0];
  EXPECT_EQ(waiting.transport->stats().network_losses, 1);
  for (int loss = 1; loss <= 2; ++loss) {
    ip("route add 224.0.0.0/4 dev lo");
    EXPECT_TRUE(waiting.receives_own_message());
    EXPECT_TRUE(waiting.reports_at_last("the network is back")) << waiting.reports.back();
    ip("route del 224.0.0.0/4 dev lo");
    EXPECT_FALSE(waiting.receives_own_message());
    EXPECT_TRUE(waiting.reports_at_last("cannot send")) << waiting.reports.back();
    EXPECT_EQ(waiting.transport->stats().network_losses, loss + 1);
  }
  // A network card is removed and replaced by one with the same name, which has no multicast
  // membership.
  ip("link add card type veth peer name other_end");
  for (int card = 0; card < 2; ++card) {
    ip("addr add 10.9.9.9/24 dev card");
    ip("link set card up multicast on");
    ip("route add 224.0.0.0/4 dev card");
    EXPECT_TRUE(waiting.receives_own_message()) << card;
    ip("link del card");
    EXPECT_FALSE(waiting.receives_own_message());
    ip("link add card type veth peer name other_end");
  }
  ip("link del card");
}

TEST(MulticastWithoutRoute, RefusesAMalformedUrl) {
  for (const char* const url : {"udpm://239.255.76.67:0", "udpm://10.0.0.1:7667",
                                "udpm://239.255.76.67:7667?tll=1", "udmp://239.255.76.67:7667"}) {
    EXPECT_THROW(bus::open_waiting_transport(url, [](const std::string&) {}), StartupError) << url;
  }
}

}  // namespace
}  // namespace vantage
