#include "core/life_line.hpp"

#include <cstdlib>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

namespace vantage {
namespace {

using std::chrono::milliseconds;

constexpr Time kStart = from_utime(1'000'000'000);

struct Pipe {
  LifeLine line;
  LifeSign sign{child_end_of(line)};

  /// Returns the only descriptor of the child's end.
  static int child_end_of(LifeLine& line) {
    EXPECT_TRUE(line.open());
    const int descriptor = ::dup(line.child_end());
    line.close_child_end();
    return descriptor;
  }
};

TEST(LifeSign, IsWrittenAtMostTenTimesPerSecond) {
  Pipe pipe;
  int arrived = 0;
  for (int ms = 0; ms < 1'000; ms += 5) {
    pipe.sign.on_loop(kStart + milliseconds(ms), InFlight::kUnknown);
    arrived += pipe.line.take().any ? 1 : 0;
  }
  EXPECT_EQ(arrived, 10);
}

TEST(LifeSign, IsWrittenAtOnceWhenTheVehicleTakesOff) {
  Pipe pipe;
  pipe.sign.on_loop(kStart, InFlight::kNo);
  EXPECT_EQ(pipe.line.take().in_flight, InFlight::kNo);
  pipe.sign.on_loop(kStart + milliseconds(5), InFlight::kYes);
  EXPECT_EQ(pipe.line.take().in_flight, InFlight::kYes);
  pipe.sign.on_loop(kStart + milliseconds(10), InFlight::kYes);
  EXPECT_FALSE(pipe.line.take().any);
}

TEST(LifeLine, KeepsTheNewestKnownStateOfTheVehicle) {
  Pipe pipe;
  pipe.sign.on_loop(kStart, InFlight::kYes);
  pipe.sign.on_loop(kStart + milliseconds(200), InFlight::kUnknown);
  const LifeLine::Signs signs = pipe.line.take();
  EXPECT_TRUE(signs.any);
  EXPECT_EQ(signs.in_flight, InFlight::kYes);
}

// A supervisor that hangs must not block a driver.
TEST(LifeSign, NeverBlocksOnAStalledSupervisor) {
  Pipe pipe;
  for (int i = 0; i < 200'000; ++i) {  // more than a pipe holds
    pipe.sign.on_loop(kStart + i * milliseconds(100), InFlight::kNo);
  }
  EXPECT_TRUE(pipe.line.take().any);
}

TEST(LifeSign, AcceptsOnlyAPipeFromTheEnvironment) {
  LifeLine line;
  ASSERT_TRUE(line.open());
  const std::string pipe_end = std::to_string(::dup(line.child_end()));
  struct Case {
    std::string value;
    bool is_taken;
  };
  for (const Case& each :
       {Case{"2", false}, Case{"-1", false}, Case{"", false}, Case{"99999999999999999999", false},
        Case{pipe_end + "x", false}, Case{pipe_end, true}}) {
    ASSERT_EQ(::setenv(LifeSign::kHandedOn, each.value.c_str(), 1), 0);
    LifeSign sign;
    sign.on_loop(kStart, InFlight::kNo);
    EXPECT_EQ(line.take().any, each.is_taken) << each.value;
    EXPECT_EQ(std::getenv(LifeSign::kHandedOn), nullptr) << "nothing it starts has a part in it";
  }
}

}  // namespace
}  // namespace vantage
