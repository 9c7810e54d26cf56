#include "drivers/vehicle/driver_end.hpp"

#include <string>

#include <gtest/gtest.h>

namespace vantage::drivers {
namespace {

using std::chrono::seconds;

constexpr Time kStart = from_utime(1'700'000'000'000'000);
constexpr Duration kLanding = seconds(45);

/// The end logic of a driver that was started one hour ago.
struct Driver {
  DriverEnd end{kStart - std::chrono::hours(1), kLanding};
  bool may_end(const EndFacts& facts, Duration since) {
    end.step(facts, kStart + since);
    return end.may_end();
  }
};

constexpr EndFacts kFlies{.in_flight = InFlight::kYes};
constexpr EndFacts kRests{.in_flight = InFlight::kNo};

TEST(DriverEnd, DoesNotEndWithoutARequest) {
  Driver driver;
  EXPECT_FALSE(driver.may_end(kRests, seconds(0)));
}

TEST(DriverEnd, EndsWhenTheVehicleIsStationaryOnTheGround) {
  Driver driver;
  driver.end.request(1, kStart);
  EXPECT_FALSE(driver.may_end(kFlies, seconds(0)));
  EXPECT_FALSE(driver.may_end(kFlies, seconds(44)));
  EXPECT_TRUE(driver.may_end(kRests, seconds(44)));
  EXPECT_EQ(driver.end.fault(), "");
  EXPECT_FALSE(driver.end.is_hurried());
}

TEST(DriverEnd, LeavesTheLandingToTheAutopilotAfterASecondRequestOrTimeOut) {
  for (const bool is_asked_again : {true, false}) {
    Driver driver;
    driver.end.request(1, kStart);
    const Duration hurries = is_asked_again ? Duration(seconds(5)) : kLanding;
    EXPECT_FALSE(driver.may_end({InFlight::kYes, false, true}, hurries - Duration{1}));
    if (is_asked_again) {
      driver.end.request(2, kStart + hurries);
    }
    EXPECT_FALSE(driver.may_end(kFlies, hurries));
    EXPECT_TRUE(driver.end.is_hurried());
    EXPECT_TRUE(driver.may_end({InFlight::kYes, false, true}, hurries + seconds(1)))
        << "the autopilot lands it";
    EXPECT_EQ(driver.end.fault(), "");
  }
}

TEST(DriverEnd, ReportsThatNoLandingWasConfirmed) {
  Driver driver;
  driver.end.request(2, kStart);
  EXPECT_FALSE(driver.may_end(kFlies, DriverEnd::kHurry - Duration{1}));
  EXPECT_TRUE(driver.may_end(kFlies, DriverEnd::kHurry));
  EXPECT_NE(driver.end.fault(), "");
}

TEST(DriverEnd, EndsWhileAPilotFlies) {
  Driver driver;
  driver.end.request(1, kStart);
  EXPECT_TRUE(driver.may_end({InFlight::kYes, true, false}, seconds(0)));
  EXPECT_NE(driver.end.fault().find("a pilot flies"), std::string::npos);
}

// A driver restarts in flight and receives an end request before it has received anything from the
// vehicle.
TEST(DriverEnd, WaitsForItsVehicleBeforeItEnds) {
  DriverEnd end(kStart, kLanding);
  end.request(1, kStart);
  end.step({}, kStart + DriverEnd::kSearch - Duration{1});
  EXPECT_FALSE(end.may_end());
  end.step({}, kStart + DriverEnd::kSearch);
  EXPECT_TRUE(end.may_end());
}

}  // namespace
}  // namespace vantage::drivers
