#include "logs/record/recorder.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/deadline.hpp"
#include "logs/file/log_event.hpp"
#include "test/logs/fake_disk.hpp"

namespace vantage::logs {
namespace {

constexpr Time kNow = from_utime(1'700'000'000'000'000);

TEST(Recorder, RecordsSelectedChannelsWithValidNames) {
  bus::InProcessHub hub;
  const auto receiver = hub.connect();
  const auto mouth = hub.connect();
  bus::VirtualClock clock(kNow);
  std::vector<std::string> recorded;
  const Recorder recorder(
      *receiver, clock,
      [&](Time time, std::string_view channel, std::span<const std::uint8_t> data) {
        EXPECT_EQ(time, kNow);
        EXPECT_EQ(data.size(), 3U);
        recorded.emplace_back(channel);
        return true;
      },
      ChannelFilter({}, {"SCAN_.*"}));
  const std::vector<std::uint8_t> data = {1, 2, 3};
  for (const char* channel : {"VICON", "SCAN_Q1", "A\n\xff", "\x7f\xfe", "PLAN_Q1"}) {
    mouth->publish(channel, data);
  }
  receiver->handle(std::chrono::microseconds(0));
  EXPECT_EQ(recorded, (std::vector<std::string>{"VICON", "PLAN_Q1"}));
  EXPECT_EQ(recorder.received(), 2);
  EXPECT_EQ(recorder.names_refused(), 2);
}

TEST(RecorderNode, ReportsAndCountsWriteErrorsAtOnce) {
  bus::InProcessHub hub;
  const auto receiver = hub.connect();
  const auto mouth = hub.connect();
  bus::VirtualClock clock(kNow);
  test::FakeDisk disk;
  disk.set_room(50);
  SpoolOptions options;
  options.path = "flight.lcmlog";
  LogSpool spool(options, disk.opener());
  std::vector<std::string> notices;
  RecorderNode node(*receiver, clock, spool, {},
                    [&](const std::string& words) { notices.push_back(words); });
  const auto count_of = [](const std::vector<models::NamedCount>& counts, const std::string& name) {
    const auto found = std::find_if(counts.begin(), counts.end(),
                                    [&](const auto& count) { return count.name == name; });
    return found == counts.end() ? -1 : found->count;
  };
  EXPECT_EQ(count_of(node.traffic(), "log.is_written"), 1);
  mouth->publish("VICON", std::vector<std::uint8_t>(100));
  receiver->handle(std::chrono::microseconds(0));
  const std::int64_t give_up_ns = monotonic_ns() + 20'000'000'000;
  while (notices.empty() && monotonic_ns() < give_up_ns) {
    node.tick(kNow);
  }
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_EQ(notices[0],
            "LOG NOT WRITTEN: flight.lcmlog: cannot be written: No space left on device");
  EXPECT_EQ(count_of(node.traffic(), "log.is_written"), 0);
  EXPECT_EQ(count_of(node.counters(), "log.write_errors"), 1);
  spool.close();
  EXPECT_EQ(count_of(node.counters(), "log.events_lost"), 1);
  EXPECT_TRUE(disk.bytes("flight.lcmlog").empty()) << "no incomplete event";
}

TEST(RecorderNode, ReportsWrittenEvents) {
  bus::InProcessHub hub;
  const auto receiver = hub.connect();
  const auto mouth = hub.connect();
  bus::VirtualClock clock(kNow);
  test::FakeDisk disk;
  SpoolOptions options;
  options.path = "flight.lcmlog";
  LogSpool spool(options, disk.opener());
  RecorderNode node(*receiver, clock, spool, ChannelFilter({}, {"SCAN_.*"}),
                    [](const std::string& words) { ADD_FAILURE() << words; });
  EXPECT_EQ(node.name(), "RECORDER");
  EXPECT_EQ(node.next_tick(), kNow);
  node.tick(kNow + Duration{7});
  EXPECT_EQ(node.next_tick(), kNow + Duration{7} + std::chrono::milliseconds(50));
  for (const char* channel : {"VICON", "SCAN_Q1", "\xff\x01", "VICON"}) {
    mouth->publish(channel, std::vector<std::uint8_t>(100));
  }
  receiver->handle(std::chrono::microseconds(0));
  EXPECT_EQ(node.received(), 2);
  spool.close();
  std::map<std::string, std::int64_t> counts;
  for (const auto& list : {node.counters(), node.traffic()}) {
    for (const models::NamedCount& each : list) {
      EXPECT_TRUE(counts.emplace(each.name, each.count).second) << each.name;
    }
  }
  counts.erase("log.at_risk_worst_us");  // depends on the machine
  counts.erase("log.syncs_late");
  EXPECT_EQ(counts, (std::map<std::string, std::int64_t>{{"log.events_lost", 0},
                                                         {"log.write_errors", 0},
                                                         {"log.sync_errors", 0},
                                                         {"log.names_refused", 1},
                                                         {"log.is_written", 1},
                                                         {"log.events", 2},
                                                         {"log.bytes", 2 * (28 + 5 + 100)},
                                                         {"log.files", 1},
                                                         {"log.queue_bytes", 0},
                                                         {"log.free_bytes", 0}}))
      << "the free space of this disk is unknown";
}

}  // namespace
}  // namespace vantage::logs
