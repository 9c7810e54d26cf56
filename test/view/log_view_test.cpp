#include "tools/view/log_view.hpp"

#include <cstdlib>
#include <map>
#include <optional>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "logs/file/event_table.hpp"
#include "test/logs/file_support.hpp"
#include "test/view/viewer_words.hpp"
#include "tools/view/broker.hpp"
#include "tools/view/history.hpp"
#include "tools/view/playback.hpp"
#include "tools/view/protocol.hpp"

namespace vantage::tools {
namespace {

using nlohmann::json;
using test::control;
using test::playback_request;
using test::pop_text;

constexpr std::int64_t kSecond_ns = 1'000'000'000;

TEST(PlaybackClock, GoesAtItsSpeedAndStopsAtTheEnd) {
  PlaybackClock clock(from_utime(0), from_utime(10'000'000));
  EXPECT_EQ(clock.state(5).status, PlaybackStatus::kPaused);
  clock.control({true, 2.0F, std::nullopt, ""}, 0);
  EXPECT_EQ(clock.position(3 * kSecond_ns), from_utime(6'000'000));
  EXPECT_EQ(clock.state(9 * kSecond_ns).status, PlaybackStatus::kEnded);
  EXPECT_EQ(clock.position(9 * kSecond_ns), from_utime(10'000'000));
}

TEST(PlaybackClock, KeepsItsPlaceOverAPauseAndAChangeOfSpeed) {
  PlaybackClock clock(from_utime(0), from_utime(100'000'000));
  clock.control({true, 1.0F, std::nullopt, ""}, 0);
  clock.control({false, 1.0F, std::nullopt, ""}, 2 * kSecond_ns);
  EXPECT_EQ(clock.position(50 * kSecond_ns), from_utime(2'000'000));
  clock.control({true, 4.0F, std::nullopt, ""}, 50 * kSecond_ns);
  EXPECT_EQ(clock.position(51 * kSecond_ns), from_utime(6'000'000));
}

TEST(PlaybackClock, SeeksWithinTheLogAndAnswersTheRequest) {
  PlaybackClock clock(from_utime(0), from_utime(10'000'000));
  const PlaybackState state = clock.control({false, 1.0F, from_utime(99'000'000), "r7"}, 0);
  EXPECT_EQ(state.time, from_utime(10'000'000));
  EXPECT_TRUE(state.did_seek);
  EXPECT_EQ(state.request_id, "r7");
  const PlaybackState again = clock.control({true, 1.0F, std::nullopt, "r8"}, 0);
  EXPECT_EQ(again.time, from_utime(0)) << "play at the end begins anew";
  EXPECT_TRUE(again.did_seek);
}

// The log of the sample flight; tests are skipped where it cannot be unpacked.
class SampleLog : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string path = folder_.file("lab.lcmlog");
    if (std::system(("xz -dkc " + std::string(VANTAGE_SOURCE_DIR) +
                     "/logs/sample/lab_60s.lcmlog.xz > " + path + " 2>/dev/null")
                        .c_str()) != 0) {
      GTEST_SKIP() << "no xz";
    }
    indexed_.emplace(path);
    log_.emplace(*indexed_);
  }
  [[nodiscard]] const logs::EventTable& log_of_sample() const { return *log_; }

 private:
  logs::test::TemporaryFolder folder_;
  std::optional<logs::IndexedLog> indexed_;
  std::optional<logs::EventTable> log_;
};

TEST_F(SampleLog, ShowsTheSameInstantHoweverItCameThere) {
  const logs::EventTable& log = log_of_sample();
  const Time instant = log.start() + std::chrono::seconds(40);
  const auto newest = [&](bool goes_back_first) {
    Broker broker({"test", "s", std::pair(log.start(), log.end())});
    const logs::TypeLibrary types;
    LogView view(log, types, broker, log.start());
    const auto client = broker.connect(true);
    const auto ask = [&](Time to) {
      const auto requests = parse_binary(
          playback_request(1, 1.0F, true, static_cast<std::uint64_t>(to_utime(to)) * 1000, "x"));
      broker.on_request(*client, requests);
      view.tick(0);
    };
    if (goes_back_first) {
      ask(log.end());
      ask(log.start());
    }
    ask(instant);
    // What a newcomer is told of the scene is what the log says of that instant.
    const auto newcomer = broker.connect(true);
    pop_text(*newcomer);
    const json advertised = pop_text(*newcomer);
    Subscribe all;
    std::map<std::uint32_t, std::string> topics;
    for (const json& channel : advertised["channels"]) {
      topics[channel["id"].get<std::uint32_t>()] = channel["topic"];
      all.pairs.emplace_back(channel["id"], channel["id"]);
    }
    broker.on_request(*newcomer, all);
    newcomer->push(control("{}"));
    std::map<std::string, std::string> content;
    for (auto frame = newcomer->wait_pop(); frame && !frame->is_text;
         frame = newcomer->wait_pop()) {
      if (frame->head[0] != 1) {
        continue;  // time and playback
      }
      const auto id = static_cast<unsigned char>(frame->head[1]);
      content[topics.at(id)] = *frame->body;
    }
    broker.disconnect(client);
    broker.disconnect(newcomer);
    return content;
  };
  const auto straight = newest(false);
  const auto roundabout = newest(true);
  EXPECT_GT(straight.size(), 15U);
  for (const char* topic : {"/transforms", "/plan/Q1", "/estimates", "/grid", "/vehicle/Q2"}) {
    ASSERT_TRUE(straight.contains(topic)) << topic;
  }
  EXPECT_EQ(straight, roundabout);
}

TEST_F(SampleLog, StepsOnWithoutBeginningAnewAndRepeatsAnInstantThatIsAskedForAgain) {
  const logs::EventTable& log = log_of_sample();
  const logs::TypeLibrary types;
  Broker broker({"test", "s", std::pair(log.start(), log.end())});
  const Time begin = log.start() + std::chrono::seconds(20);
  LogView view(log, types, broker, begin);
  const auto client = broker.connect(true);
  pop_text(*client);
  const json advertised = pop_text(*client);
  for (const json& channel : advertised["channels"]) {
    if (channel["topic"] == "/transforms") {
      broker.on_request(*client, Subscribe{{{7, channel["id"].get<std::uint32_t>()}}});
    }
  }
  // {poses that came, whether viewers were told of a jump}
  const auto ask = [&](Time to) {
    broker.on_request(*client,
                      parse_binary(playback_request(
                          1, 1.0F, true, static_cast<std::uint64_t>(to_utime(to)) * 1000, "x")));
    view.tick(0);
    client->push(control("{}"));
    std::pair<int, bool> heard;
    for (auto frame = client->wait_pop(); frame && !frame->is_text; frame = client->wait_pop()) {
      heard.first += frame->head[0] == 1 ? 1 : 0;
      heard.second = heard.second || (frame->head[0] == 5 && frame->head[14] != 0);
    }
    return heard;
  };
  ask(begin);
  const auto [poses, jumps] = ask(begin + std::chrono::milliseconds(100));
  EXPECT_GT(poses, 1) << "all that lies between, as in playing";
  EXPECT_FALSE(jumps);
  EXPECT_EQ(ask(begin + std::chrono::milliseconds(100)), (std::pair(1, true)));
  EXPECT_EQ(ask(begin + std::chrono::seconds(5)), (std::pair(1, true)));
  EXPECT_EQ(ask(begin), (std::pair(1, true)));
  broker.disconnect(client);
}

TEST_F(SampleLog, HoldsTheNumbersOfTheWholeLogInOrder) {
  const logs::EventTable& log = log_of_sample();
  Broker broker({"test", "s", std::pair(log.start(), log.end())});
  const json history = json::parse(log_history(log, {}, broker));
  const auto client = broker.connect(true);
  pop_text(*client);
  EXPECT_GT(pop_text(*client)["channels"].size(), 30U) << "a newcomer is told of every topic";
  broker.disconnect(client);
  std::map<std::string, int> records;
  std::int64_t last = 0;
  for (const json& record : history) {
    ++records[record[0]];
    EXPECT_GE(record[1].get<std::int64_t>(), last);
    last = record[1];
  }
  EXPECT_NEAR(records["/team"], 120, 3);           // two steps a second
  EXPECT_NEAR(records["/plan/Q1/status"], 60, 3);  // a round a second
  EXPECT_NEAR(records["/vehicle/Q3"], 60, 3);
}

TEST_F(SampleLog, GivesOneNumberOfATopicOverItsWholeLength) {
  const logs::EventTable& log = log_of_sample();
  const json battery = json::parse(log_series(log, {}, "/vehicle/Q1", "/battery_share"));
  EXPECT_GT(battery.size(), 100U);
  EXPECT_GT(battery.front()[1].get<double>(), battery.back()[1].get<double>());
  // The same plans as they are on the bus and as viewers are told them.
  const json raw = json::parse(log_series(log, {}, "/lcm/PLAN_Q1", "/nodes"));
  const json told = json::parse(log_series(log, {}, "/plan/Q1/status", "/nodes"));
  EXPECT_NEAR(static_cast<double>(raw.size()), 60.0, 3.0);
  EXPECT_EQ(raw, told);
  const json late = json::parse(log_series(log, {}, "/plan/Q1/status", "/late"));
  EXPECT_EQ(late.front()[1], 0.0) << "false is a number, too";
  EXPECT_TRUE(json::parse(log_series(log, {}, "/vehicle/Q1", "/nowhere")).empty());
  EXPECT_TRUE(json::parse(log_series(log, {}, "/vehicle/Q1", "battery_share")).empty());
  EXPECT_TRUE(json::parse(log_series(log, {}, "/nobody", "/a")).empty());
}

TEST_F(SampleLog, IsFirstShownWhereEveryRobotHasAPlaceAndAPlanAndSomethingIsKnown) {
  const logs::EventTable& log = log_of_sample();
  const Time first = first_picture(log);
  EXPECT_GT(to_seconds(first - log.start()), 0.5);
  EXPECT_LT(to_seconds(first - log.start()), 10.0);
  Broker broker({"test", "s", std::pair(log.start(), log.end())});
  const logs::TypeLibrary types;
  const LogView view(log, types, broker, first);
  const auto client = broker.connect(true);
  pop_text(*client);
  const json advertised = pop_text(*client);
  std::map<std::string, json> newest;
  for (const json& channel : advertised["channels"]) {
    const auto id = channel["id"].get<std::uint32_t>();
    broker.on_request(*client, Subscribe{{{id, id}}});
    client->push(control("{}"));
    for (auto frame = client->wait_pop(); frame && !frame->is_text; frame = client->wait_pop()) {
      if (frame->head[0] == 1) {
        newest[channel["topic"].get<std::string>()] = json::parse(*frame->body);
      }
    }
  }
  for (const char* robot : {"Q1", "Q2", "Q3"}) {
    EXPECT_TRUE(newest.contains(std::string("/plan/") + robot)) << robot;
  }
  EXPECT_GE(newest["/transforms"]["transforms"].size(), 3U);
  EXPECT_FALSE(newest["/estimates"]["entities"].empty());
  broker.disconnect(client);
}

}  // namespace
}  // namespace vantage::tools
