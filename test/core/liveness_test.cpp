#include "core/liveness.hpp"

#include <cstdlib>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

namespace vantage {
namespace {

using std::chrono::milliseconds;

constexpr Time kStart = from_utime(1'000'000'000);

struct Pipe {
  LivenessReceiver receiver;
  LivenessSender sender{child_end_of(receiver)};

  /// Returns the receiver's only descriptor for the child process.
  static int child_end_of(LivenessReceiver& receiver) {
    EXPECT_TRUE(receiver.open());
    const int descriptor = ::dup(receiver.child_end());
    receiver.close_child_end();
    return descriptor;
  }
};

TEST(LivenessSender, WritesAtMostTenTimesPerSecond) {
  Pipe pipe;
  int arrived = 0;
  for (int ms = 0; ms < 1'000; ms += 5) {
    pipe.sender.on_loop(kStart + milliseconds(ms), InFlight::kUnknown);
    arrived += pipe.receiver.take().any ? 1 : 0;
  }
  EXPECT_EQ(arrived, 10);
}

TEST(LivenessSender, WritesAtOnceWhenTheVehicleTakesOff) {
  Pipe pipe;
  pipe.sender.on_loop(kStart, InFlight::kNo);
  EXPECT_EQ(pipe.receiver.take().in_flight, InFlight::kNo);
  pipe.sender.on_loop(kStart + milliseconds(5), InFlight::kYes);
  EXPECT_EQ(pipe.receiver.take().in_flight, InFlight::kYes);
  pipe.sender.on_loop(kStart + milliseconds(10), InFlight::kYes);
  EXPECT_FALSE(pipe.receiver.take().any);
}

TEST(LivenessReceiver, KeepsTheNewestKnownStateOfTheVehicle) {
  Pipe pipe;
  pipe.sender.on_loop(kStart, InFlight::kYes);
  pipe.sender.on_loop(kStart + milliseconds(200), InFlight::kUnknown);
  const LivenessReceiver::Report signs = pipe.receiver.take();
  EXPECT_TRUE(signs.any);
  EXPECT_EQ(signs.in_flight, InFlight::kYes);
}

// A supervisor that hangs must not block a driver.
TEST(LivenessSender, NeverBlocksOnAStalledSupervisor) {
  Pipe pipe;
  for (int i = 0; i < 200'000; ++i) {  // more messages than fit into a pipe
    pipe.sender.on_loop(kStart + i * milliseconds(100), InFlight::kNo);
  }
  EXPECT_TRUE(pipe.receiver.take().any);
}

TEST(LivenessSender, AcceptsOnlyAPipeFromTheEnvironment) {
  LivenessReceiver receiver;
  ASSERT_TRUE(receiver.open());
  const std::string pipe_end = std::to_string(::dup(receiver.child_end()));
  struct Case {
    std::string value;
    bool is_taken;
  };
  for (const Case& each :
       {Case{"2", false}, Case{"-1", false}, Case{"", false}, Case{"99999999999999999999", false},
        Case{pipe_end + "x", false}, Case{pipe_end, true}}) {
    ASSERT_EQ(::setenv(LivenessSender::kDescriptorVariable, each.value.c_str(), 1), 0);
    LivenessSender sender;
    sender.on_loop(kStart, InFlight::kNo);
    EXPECT_EQ(receiver.take().any, each.is_taken) << each.value;
    EXPECT_EQ(std::getenv(LivenessSender::kDescriptorVariable), nullptr)
        << "child processes do not inherit the descriptor";
  }
}

}  // namespace
}  // namespace vantage
