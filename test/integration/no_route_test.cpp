#include <gtest/gtest.h>

#include "core/check.hpp"
#include "test/integration/network_support.hpp"

// Run in a network without a multicast route. Should opening wait, the test's time limit ends it.

namespace vantage {
namespace {

TEST(WithoutARoute, OpeningFailsAndSaysWhatToDo) {
  try {
    bus::open_transport(test::kUrl);
    FAIL() << "opened";
  } catch (const StartupError& e) {
    EXPECT_NE(std::string(e.what()).find("ip route add 224.0.0.0/4"), std::string::npos)
        << e.what();
  }
}

}  // namespace
}  // namespace vantage
