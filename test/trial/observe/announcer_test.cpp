#include "trial/observe/announcer.hpp"

#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "bus/node/bus.hpp"

namespace vantage::trial {
namespace {

using std::chrono::microseconds;
using std::chrono::seconds;

constexpr Time kStart = from_utime(1'700'000'000'000'000);

class AnnouncerTest : public ::testing::Test {
 protected:
  AnnouncerTest() {
    scenario_.source_text = "name: some\nseed: 7\n";
    receiving_bus_.subscribe<models::ScenarioNotice>(
        bus::kScenario,
        [this](const models::ScenarioNotice& notice) { notices_.push_back(notice); });
  }
  /// Returns the notices published since the last call.
  std::vector<models::ScenarioNotice> received() {
    while (receiving_bus_.handle(microseconds(0)) > 0) {
    }
    return std::exchange(notices_, {});
  }

  bus::InProcessHub hub_;
  std::unique_ptr<bus::Transport> announcing_end_ = hub_.connect();
  std::unique_ptr<bus::Transport> receiving_end_ = hub_.connect();
  bus::Bus announcing_bus_{*announcing_end_, 1};
  bus::Bus receiving_bus_{*receiving_end_, 2};
  scenario::Scenario scenario_;
  std::vector<models::ScenarioNotice> notices_;
};

TEST_F(AnnouncerTest, PublishesTheScenarioAtOnceAndEveryFiveSeconds) {
  Announcer announcer(announcing_bus_, scenario_, "some process");
  EXPECT_TRUE(received().empty());
  std::vector<Time> published_at;
  for (int half_s = 0; half_s <= 31; ++half_s) {
    const Time now = kStart + half_s * microseconds(500'000);
    announcer.tick(now);
    for (const models::ScenarioNotice& notice : received()) {
      published_at.push_back(notice.stamp.time);
      EXPECT_EQ(notice.yaml, scenario_.source_text);
      EXPECT_EQ(notice.process, "some process");
      EXPECT_EQ(notice.version, version());
    }
    EXPECT_GT(announcer.next_tick(), now);
  }
  EXPECT_EQ(published_at, (std::vector<Time>{kStart, kStart + seconds(5), kStart + seconds(10),
                                             kStart + seconds(15)}));
  EXPECT_FALSE(version().empty());
}

TEST_F(AnnouncerTest, WaitsFiveSecondsAfterItsLastMessage) {
  Announcer announcer(announcing_bus_, scenario_, "p");
  announcer.tick(kStart);
  announcer.tick(kStart + microseconds(4'999'999));
  EXPECT_EQ(received().size(), 1U);
  announcer.publish(kStart + seconds(2));
  EXPECT_EQ(received().size(), 1U) << "published at any time on request";
  EXPECT_EQ(announcer.next_tick(), kStart + seconds(7));
  announcer.tick(kStart + microseconds(6'999'999));
  EXPECT_TRUE(received().empty());
  announcer.tick(kStart + seconds(7));
  EXPECT_EQ(received().size(), 1U);
}

}  // namespace
}  // namespace vantage::trial
