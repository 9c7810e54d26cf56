#include "bus/node/publisher_watch.hpp"

#include <gtest/gtest.h>

#include "bus/convert/convert.hpp"

namespace vantage::bus {
namespace {

struct Row {
  const char* what;
  const char* channel;
  std::vector<std::int64_t> runs;
  bool has_two;
};

TEST(PublisherWatch, DistinguishesTwoPublishersFromARestart) {
  const std::vector<Row> rows = {
      {"one publisher", "PLAN_Q1", {5, 5, 5, 5, 5}, false},
      {"restart", "PLAN_Q1", {5, 5, 6, 6, 7, 7}, false},
      {"restart with a delayed message", "PLAN_Q1", {5, 6, 5, 6, 6}, false},
      {"three restarts with a delayed message each",
       "PLAN_Q1",
       {5, 6, 5, 6, 7, 6, 7, 8, 7, 8},
       false},
      {"two publishers", "PLAN_Q1", {5, 6, 5, 6, 5, 6}, true},
      {"two publishers of different rates", "PLAN_Q1", {5, 5, 6, 5, 5, 5, 6, 5, 5, 6}, true},
      {"three publishers", "PLAN_Q1", {5, 6, 7, 5, 6, 7, 5, 6, 7}, true},
      {"two publishers, one of them restarted", "PLAN_Q1", {5, 6, 5, 7, 5, 7, 5, 7}, true},
      {"messages without a run id", "PLAN_Q1", {0, 5, 0, 5, 0, 5, 0, 5}, false},
      {"consoles", "COMMAND", {5, 6, 5, 6, 5, 6}, false},
      {"simulator and contact judge", "COLLISION", {5, 6, 5, 6, 5, 6}, false},
      {"answers of an external planner", "EXTERNAL_PLAN_Q1", {5, 6, 5, 6, 5, 6}, false}};
  for (const Row& row : rows) {
    PublisherWatch watch;
    int reports = 0;
    for (const std::int64_t run : row.runs) {
      reports += watch.on_run(row.channel, run) ? 1 : 0;
    }
    EXPECT_EQ(reports, row.has_two ? 1 : 0) << row.what;
    EXPECT_EQ(watch.contested(),
              row.has_two ? std::vector<std::string>{row.channel} : std::vector<std::string>{})
        << row.what;
  }
}

TEST(PublisherWatch, SeparatesChannelsAndLimitsTheirNumber) {
  PublisherWatch watch;
  for (int k = 0; k < 6; ++k) {
    for (int channel = 0; channel < 20'000; ++channel) {
      watch.on_run("MEASUREMENT_" + std::to_string(channel), channel % 2 == 0 ? 1 : 1 + k % 2);
    }
  }
  EXPECT_EQ(watch.contested().size(), 16'384U / 2);
}

TEST(RunIdOf, ReadsTheIdOfAnEncodedMessage) {
  vantage_lcm::attack_t attack{};
  attack.run_id = 0x1122334455667788;
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(attack.getEncodedSize()));
  ASSERT_EQ(attack.encode(bytes.data(), 0, static_cast<int>(bytes.size())),
            static_cast<int>(bytes.size()));
  EXPECT_EQ(run_id_of(bytes), attack.run_id);
  bytes.resize(23);
  EXPECT_EQ(run_id_of(bytes), 0);
}

}  // namespace
}  // namespace vantage::bus
