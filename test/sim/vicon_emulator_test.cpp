#include <string>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "sim/vicon/app/emulator.hpp"

namespace vantage::sim::vicon {
namespace {

/// Runs the program with a missing recording. The program reports it as missing only if the options
/// are accepted.
int run_at(std::string port) {
  std::string words[] = {"vantage-vicon-emulator", "--flight", "/nowhere/flight.csv", "--port",
                         std::move(port)};
  char* argv[5];
  for (int i = 0; i < 5; ++i) {
    argv[i] = words[i].data();
  }
  return run_emulator(5, argv);
}

TEST(RunEmulator, AcceptsEveryValidPort) {
  for (const char* port : {"0", "-1", "65536", "some"}) {
    EXPECT_EQ(run_at(port), 2) << port;
  }
  for (const char* port : {"1", "801", "65535"}) {
    EXPECT_THROW(run_at(port), StartupError) << port;
  }
}

}  // namespace
}  // namespace vantage::sim::vicon
