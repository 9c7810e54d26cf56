#include "tools/view/history.hpp"

#include <map>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "bus/node/clock.hpp"

namespace vantage::tools {
namespace {

using logs::foxglove::Schema;
using nlohmann::json;

/// A sink that requests every topic and counts the records.
class Counter : public logs::foxglove::Sink {
 public:
  bool wants(const std::string& topic, Schema /*schema*/, bool /*is_state*/) override {
    ++requested[topic];
    return wants_all;
  }
  void write(const std::string& topic, Time /*time*/, const json& /*content*/) override {
    ++written[topic];
  }
  bool wants_all = true;
  std::map<std::string, int> requested;
  std::map<std::string, int> written;
};

void write_at(History& history, bus::VirtualClock& clock, const std::string& topic, Schema schema,
              const json& content, std::int64_t at_us) {
  clock.set(from_utime(at_us));
  if (history.wants(topic, schema, true)) {
    history.write(topic, clock.now(), content);
  }
}

TEST(History, ThinsFrequentTopicsButForwardsAll) {
  bus::VirtualClock clock(Time{});
  Counter audience;
  History history(clock, audience, History::Forwarding::kRecords, 1U << 20U);
  const json place{
      {"transforms", json::array({{{"child_frame_id", "Q1"},
                                   {"translation", {{"x", 1.234}, {"y", 2}, {"z", 3}}}}})}};
  for (int i = 0; i < 100; ++i) {
    const std::int64_t at_us = 1'000'000 + 20'000 * i;
    write_at(history, clock, "/vehicle/Q1", Schema::kVehicle, {{"i", i}}, at_us);
    write_at(history, clock, "/transforms", Schema::kFrameTransforms, place, at_us);
    write_at(history, clock, "/team", Schema::kTeam, {{"i", i}}, at_us);
    write_at(history, clock, "/robots", Schema::kSceneUpdate, {{"i", i}}, at_us);
  }
  std::map<std::string, int> kept;
  json way;
  for (const json& record : json::parse(history.text())) {
    ++kept[record[0].get<std::string>()];
    way = record[0] == "/paths" ? record[2] : way;
  }
  EXPECT_EQ(kept, (std::map<std::string, int>{{"/team", 100}, {"/vehicle/Q1", 2}, {"/paths", 10}}));
  EXPECT_EQ(way, (json{{"Q1", {1.23, 2.0, 3.0}}})) << "rounded to a centimetre";
  for (const char* topic : {"/vehicle/Q1", "/transforms", "/team", "/robots"}) {
    EXPECT_EQ(audience.written[topic], 100) << topic;
  }
}

TEST(History, KeepsRecordsWithoutSubscribers) {
  bus::VirtualClock clock(Time{});
  Counter audience;
  audience.wants_all = false;
  History history(clock, audience, History::Forwarding::kRecords, 1U << 20U);
  write_at(history, clock, "/events", Schema::kLog, {{"message", "a"}}, 5);
  write_at(history, clock, "/robots", Schema::kSceneUpdate, {{"i", 1}}, 6);
  EXPECT_EQ(json::parse(history.text()), json::parse(R"([["/events", 5, {"message": "a"}]])"));
  EXPECT_TRUE(audience.written.empty());
  EXPECT_EQ(audience.requested["/robots"], 1);
}

TEST(History, IsBoundedAndDropsTheOldest) {
  bus::VirtualClock clock(Time{});
  Counter audience;
  History history(clock, audience, History::Forwarding::kRecords, 4000);
  for (int i = 0; i < 1000; ++i) {
    write_at(history, clock, "/team", Schema::kTeam, {{"i", i}}, i);
  }
  const json kept = json::parse(history.text());
  EXPECT_LT(history.text().size(), 4500U);
  EXPECT_GT(kept.size(), 50U);
  EXPECT_EQ(kept.back()[1], 999);
  EXPECT_EQ(kept.front()[1], 1000 - static_cast<int>(kept.size()));
}

}  // namespace
}  // namespace vantage::tools
