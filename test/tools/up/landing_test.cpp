#include "tools/up/landing.hpp"

#include <gtest/gtest.h>

namespace vantage::tools {
namespace {

using Step = Landing::Step;
using std::chrono::seconds;

constexpr Time kStart = from_utime(1'000'000'000);

TEST(Landing, EndsWhenAllVehiclesAreDown) {
  Landing landing(kStart);
  EXPECT_EQ(landing.step(false, false, kStart), Step::kWait);
  EXPECT_EQ(landing.step(true, false, kStart + seconds(20)), Step::kOver);
}

TEST(Landing, HurriesOnceWhenTheUserRepeatsTheRequest) {
  Landing landing(kStart);
  EXPECT_EQ(landing.step(false, true, kStart + seconds(1)), Step::kRequestAgain);
  EXPECT_EQ(landing.step(false, true, kStart + seconds(2)), Step::kWait);
  EXPECT_EQ(landing.step(false, true, kStart + seconds(1) + Landing::kHurriedPatience),
            Step::kOver);
}

TEST(Landing, HurriesAfterOneMinute) {
  Landing landing(kStart);
  EXPECT_EQ(landing.step(false, false, kStart + Landing::kPatience - Duration{1}), Step::kWait);
  EXPECT_EQ(landing.step(false, false, kStart + Landing::kPatience), Step::kRequestAgain);
  EXPECT_EQ(landing.step(false, false, kStart + Landing::kPatience + Landing::kHurriedPatience),
            Step::kOver);
}

}  // namespace
}  // namespace vantage::tools
