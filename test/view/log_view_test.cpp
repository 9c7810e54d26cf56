#include "tools/view/log_view.hpp"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <vantage_lcm/attack_t.hpp>

#include "bus/node/clock.hpp"
#include "bus/transport/transport.hpp"
#include "logs/file/seekable_log.hpp"
#include "test/logs/file_support.hpp"
#include "test/view/viewer_words.hpp"
#include "tools/view/broker.hpp"
#include "tools/view/feed.hpp"
#include "tools/view/history.hpp"
#include "tools/view/playback.hpp"
#include "tools/view/protocol.hpp"
#include "tools/view/seek_preroll.hpp"

namespace vantage::tools {
namespace {

using nlohmann::json;
using test::control;
using test::playback_request;
using test::pop_text;
using test::subscribe;

constexpr std::int64_t kSecond_ns = 1'000'000'000;

/// Returns the newest record of each topic that a new viewer receives.
std::map<std::string, std::string> records_for_new_viewer(Broker& broker) {
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
  for (auto frame = newcomer->wait_pop(); frame; frame = newcomer->wait_pop()) {
    if (frame->is_text && frame->head == "{}") {
      break;
    }
    if (!frame->is_text && frame->head[0] == 1) {  // other frames: status, time, playback
      content[topics.at(static_cast<unsigned char>(frame->head[1]))] = *frame->body;
    }
  }
  broker.disconnect(newcomer);
  return content;
}

TEST(PlaybackClock, RunsAtItsSpeedAndStopsAtTheEnd) {
  PlaybackClock clock(from_utime(0), from_utime(10'000'000));
  EXPECT_EQ(clock.state(5).status, PlaybackStatus::kPaused);
  clock.control({true, 2.0F, std::nullopt, ""}, 0);
  EXPECT_EQ(clock.position(3 * kSecond_ns), from_utime(6'000'000));
  EXPECT_EQ(clock.state(9 * kSecond_ns).status, PlaybackStatus::kEnded);
  EXPECT_EQ(clock.position(9 * kSecond_ns), from_utime(10'000'000));
}

TEST(PlaybackClock, KeepsItsPositionAcrossPausesAndSpeedChanges) {
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
  EXPECT_EQ(again.time, from_utime(0)) << "play at the end restarts";
  EXPECT_TRUE(again.did_seek);
}

// A fixture with the log of the sample flight; its tests are skipped if the log cannot be unpacked.
class SampleLog : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string path = folder_.file("lab.lcmlog");
    if (std::system(("xz -dkc " + std::string(VANTAGE_SOURCE_DIR) +
                     "/logs/sample/lab_60s.lcmlog.xz > " + path + " 2>/dev/null")
                        .c_str()) != 0) {
      GTEST_SKIP() << "xz is not installed";
    }
    log_.emplace(path);
  }
  [[nodiscard]] const logs::SeekableLog& log_of_sample() const { return *log_; }

 private:
  logs::test::TemporaryFolder folder_;
  std::optional<logs::SeekableLog> log_;
};

TEST_F(SampleLog, ShowsSameSceneAfterDirectAndIndirectSeek) {
  const logs::SeekableLog& log = log_of_sample();
  const Time instant = log.range().first + std::chrono::seconds(40);
  const auto newest = [&](bool goes_back_first) {
    Broker broker({"test", "s", log.range()});
    const logs::TypeLibrary types;
    LogView view(log, types, broker, log.range().first);
    const auto client = broker.connect(true);
    const auto ask = [&](Time to) {
      const auto requests = parse_binary(
          playback_request(1, 1.0F, true, static_cast<std::uint64_t>(to_utime(to)) * 1000, "x"));
      broker.on_request(*client, requests);
      view.tick(0);
    };
    if (goes_back_first) {
      ask(log.range().second);
      ask(log.range().first);
    }
    ask(instant);
    broker.disconnect(client);
    // Returns what a new viewer receives: the scene at that instant of the log.
    return records_for_new_viewer(broker);
  };
  const auto straight = newest(false);
  const auto roundabout = newest(true);
  EXPECT_GT(straight.size(), 15U);
  for (const char* topic : {"/transforms", "/plan/Q1", "/estimates", "/grid", "/vehicle/Q2"}) {
    ASSERT_TRUE(straight.contains(topic)) << topic;
  }
  EXPECT_EQ(straight, roundabout);
}

TEST_F(SampleLog, SeekShowsStateOfFullReplay) {
  const logs::SeekableLog& log = log_of_sample();
  const logs::TypeLibrary types;
  for (const int at_s : {3, 15, 45}) {  // 20 s before the instant suffice, also for 45 s
    const Time instant = log.range().first + std::chrono::seconds(at_s);
    Broker broker({"test", "s", log.range()});
    const LogView view(log, types, broker, instant);

    Broker whole({"test", "s", log.range()});
    bus::VirtualClock clock(log.range().first);
    bus::InProcessHub hub;
    const auto source = hub.connect();
    const auto endpoint = hub.connect();
    Feed feed(*endpoint, clock, whole, types);
    const Time from = instant - std::chrono::seconds(20);
    const auto play = [&](const std::vector<logs::LocatedEvent>& events) {
      for (const logs::LocatedEvent& event : events) {
        clock.set(event.time);
        source->publish(std::string(event.channel), event.data);
        feed.handle(std::chrono::microseconds(0));
      }
    };
    play(log.newest_before(from));
    play(log.events(from, instant + Duration{1}));

    const auto records = records_for_new_viewer(broker);
    EXPECT_GT(records.size(), 15U);
    EXPECT_EQ(records, records_for_new_viewer(whole)) << at_s << " s";
    EXPECT_EQ(json::parse(broker.topics_text())["topics"],
              json::parse(whole.topics_text())["topics"])
        << "all are counted";
  }
}

/// A viewer that plays a log from 20 s after its begin.
struct PlayingViewer {
  explicit PlayingViewer(const logs::SeekableLog& log)
      : broker({"test", "s", log.range()}),
        begin(log.range().first + std::chrono::seconds(20)),
        view(log, types, broker, begin),
        client(broker.connect(true)) {}
  ~PlayingViewer() { broker.disconnect(client); }

  /// Seeks to `to` and reads the log.
  void go_to(Time to) {
    const auto time_ns = static_cast<std::uint64_t>(to_utime(to)) * 1000;
    broker.on_request(*client, parse_binary(playback_request(1, 1.0F, true, time_ns, "x")));
    view.tick(0);
  }

  logs::TypeLibrary types;
  Broker broker;
  Time begin;
  LogView view;
  std::shared_ptr<Client> client;
};

TEST_F(SampleLog, StepsShortSeeksForwardAndJumpsOtherwise) {
  PlayingViewer viewer(log_of_sample());
  pop_text(*viewer.client);
  subscribe(viewer.broker, *viewer.client, pop_text(*viewer.client), "/transforms");
  // Returns the number of received poses, and true if a jump was reported.
  const auto ask = [&](Time to) {
    viewer.go_to(to);
    viewer.client->push(control("{}"));
    std::pair<int, bool> received;
    for (auto frame = viewer.client->wait_pop(); frame && !frame->is_text;
         frame = viewer.client->wait_pop()) {
      received.first += frame->head[0] == 1 ? 1 : 0;
      received.second = received.second || (frame->head[0] == 5 && frame->head[14] != 0);
    }
    return received;
  };
  ask(viewer.begin);
  const auto [poses, jumps] = ask(viewer.begin + std::chrono::milliseconds(100));
  EXPECT_GT(poses, 1) << "all poses in between, as during playback";
  EXPECT_FALSE(jumps);
  EXPECT_EQ(ask(viewer.begin + std::chrono::milliseconds(100)), (std::pair(1, true)));
  EXPECT_EQ(ask(viewer.begin + std::chrono::seconds(5)), (std::pair(1, true)));
  EXPECT_EQ(ask(viewer.begin), (std::pair(1, true)));
}

// The rate is twenty poses per second anywhere in the log. Data that a seek reads is not included.
TEST_F(SampleLog, PoseRateIsTheSameAnywhereInTheLog) {
  PlayingViewer viewer(log_of_sample());
  const auto go = [&](Time to) {
    viewer.go_to(to);
    const json counts = json::parse(viewer.broker.topics_text());
    EXPECT_NEAR(counts["time_s"].get<double>(), to_seconds(to.time_since_epoch()), 1e-5);
    double poses = 0.0;
    for (const json& topic : counts["topics"]) {
      poses += topic["topic"] == "/transforms" ? topic["count"].get<double>() : 0.0;
    }
    return std::tuple(counts["jumps"].get<int>(), counts["time_s"].get<double>(), poses);
  };
  const int jumps_before = std::get<0>(go(viewer.begin));
  for (const int leg : {0, 1, 2}) {
    const Time from = viewer.begin + std::chrono::seconds(leg == 1 ? 30 : 2 * leg);
    const auto [jumps, from_s, poses_before] = go(from);
    EXPECT_EQ(jumps, jumps_before + leg + 1);
    for (int step = 1; step < 20; ++step) {
      go(from + step * std::chrono::milliseconds(100));
    }
    const auto [same_jumps, to_s, poses] = go(from + std::chrono::seconds(2));
    EXPECT_EQ(same_jumps, jumps);
    EXPECT_NEAR((poses - poses_before) / (to_s - from_s), 20.0, 0.5) << "leg " << leg;
  }
}

TEST_F(SampleLog, HistoryContainsTheWholeLogInOrder) {
  const logs::SeekableLog& log = log_of_sample();
  Broker broker({"test", "s", log.range()});
  const json history = json::parse(log_history(log, {}, broker));
  const auto client = broker.connect(true);
  pop_text(*client);
  EXPECT_GT(pop_text(*client)["channels"].size(), 30U) << "a new viewer receives every topic";
  broker.disconnect(client);
  std::map<std::string, int> records;
  std::int64_t last = 0;
  for (const json& record : history) {
    ++records[record[0]];
    EXPECT_GE(record[1].get<std::int64_t>(), last);
    last = record[1];
  }
  EXPECT_NEAR(records["/team"], 120, 3);           // two steps per second
  EXPECT_NEAR(records["/plan/Q1/status"], 60, 3);  // one round per second
  EXPECT_NEAR(records["/vehicle/Q3"], 60, 3);
}

TEST_F(SampleLog, ReturnsOneNumberOfATopicOverTime) {
  const logs::SeekableLog& log = log_of_sample();
  const json battery = json::parse(log_series(log, {}, "/vehicle/Q1", "/battery_share"));
  EXPECT_GT(battery.size(), 100U);
  EXPECT_GT(battery.front()[1].get<double>(), battery.back()[1].get<double>());
  // The plans as received on the bus and as sent to viewers have the same values.
  const json raw = json::parse(log_series(log, {}, "/lcm/PLAN_Q1", "/nodes"));
  const json counts = json::parse(log_series(log, {}, "/plan/Q1/status", "/nodes"));
  EXPECT_NEAR(static_cast<double>(raw.size()), 60.0, 3.0);
  EXPECT_EQ(raw, counts);
  const json late = json::parse(log_series(log, {}, "/plan/Q1/status", "/late"));
  EXPECT_EQ(late.front()[1], 0.0) << "false is charted as 0";
  EXPECT_TRUE(json::parse(log_series(log, {}, "/vehicle/Q1", "/nowhere")).empty());
  EXPECT_TRUE(json::parse(log_series(log, {}, "/vehicle/Q1", "battery_share")).empty());
  EXPECT_TRUE(json::parse(log_series(log, {}, "/nobody", "/a")).empty());
}

TEST_F(SampleLog, StartsWhereRobotsPlansAndEstimatesExist) {
  const logs::SeekableLog& log = log_of_sample();
  const Time first = first_picture(log);
  EXPECT_GT(to_seconds(first - log.range().first), 0.5);
  EXPECT_LT(to_seconds(first - log.range().first), 10.0);
  Broker broker({"test", "s", log.range()});
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

TEST(SeekPreroll, CountsRecordsAndSendsLastOfEachTopic) {
  using logs::foxglove::Schema;
  Broker broker({"test", "s", std::pair(from_utime(0), from_utime(9))});
  SeekPreroll preroll(broker);
  std::vector<int> made;
  const auto write_three = [&] {
    for (const int value : {1, 2, 3}) {
      if (preroll.wants("/often", Schema::kTeam, false)) {
        made.push_back(value);
        preroll.write("/often", from_utime(value), json{{"known", value}});
      }
      if (value == 2 && preroll.wants("/once", Schema::kTeam, true)) {
        made.push_back(20);
        preroll.write("/once", from_utime(value), json{{"known", 20}});
      }
    }
  };
  preroll.count();
  write_three();
  EXPECT_TRUE(made.empty());
  EXPECT_EQ(json::parse(broker.topics_text())["topics"], json::array()) << "no topic was requested";
  preroll.make_last();
  write_three();
  EXPECT_EQ(made, (std::vector{20, 3}));
  preroll.end();
  write_three();
  EXPECT_EQ(made, (std::vector{20, 3, 1, 2, 20, 3})) << "each series again";
  const json counts = json::parse(broker.topics_text());
  for (const json& topic : counts["topics"]) {
    EXPECT_EQ(topic["count"], topic["topic"] == "/often" ? 6 : 2) << "requested for each topic";
  }
}

/// A log of 60 s and 24 MB, of which 8 MiB are read at first. Q1 is jammed until 25 s, then Q2.
class UnreadLog : public ::testing::Test {
 protected:
  static constexpr std::int64_t kStart_us = 1'000'000'000;

  void append_attack(std::int64_t utime, const char* jammed) {
    vantage_lcm::attack_t attack{};
    attack.utime = utime;
    attack.run_id = 1;
    attack.sequence = utime > kStart_us ? 1 : 0;
    attack.num_jammed = 1;
    attack.jammed = {jammed};
    logs::test::append_message(attack, number_++, utime, "ATTACK", bytes_);
  }
  void append_filler(int from_s, int to_s) {
    const logs::test::Bytes data(1000, 7);
    for (std::int64_t i = 400 * from_s; i < 400 * to_s; ++i) {
      logs::append_event({number_++, from_utime(kStart_us + 2500 * i + 1), "FILLER", data}, bytes_);
    }
  }

  UnreadLog() {
    append_attack(kStart_us, "Q1");
    append_filler(0, 25);
    append_attack(kStart_us + 25'000'000, "Q2");
    append_filler(25, 60);
  }
  [[nodiscard]] std::string write() const {
    logs::test::write_file(folder_.file("a.lcmlog"), bytes_);
    return folder_.file("a.lcmlog");
  }
  static std::string jammed(Broker& broker) {
    return json::parse(records_for_new_viewer(broker).at("/attack"))["jammed"].dump();
  }

  logs::test::Bytes bytes_;
  std::int64_t number_ = 0;

 private:
  logs::test::TemporaryFolder folder_;
};

TEST_F(UnreadLog, IsShownCompletelyAfterItsFirstPass) {
  logs::SeekableLog log(write());
  ASSERT_FALSE(log.is_surveyed());
  Broker broker({"test", "s", log.range()});
  const logs::TypeLibrary types;
  const Time instant = from_utime(kStart_us + 50'000'000);
  LogView view(log, types, broker, instant);
  view.play(0);
  EXPECT_EQ(jammed(broker), R"(["Q1"])") << "messages beyond the read part are missing";
  view.tick(0);
  EXPECT_EQ(jammed(broker), R"(["Q1"])");
  const auto client = broker.connect(true);
  pop_text(*client);
  subscribe(broker, *client, pop_text(*client), "/attack");
  client->push(control("{}"));
  while (!client->wait_pop()->is_text) {
  }

  // Viewers receive the progress of the pass, and at its end the status is withdrawn.
  read_first_pass(log, broker, [] { return false; });
  ASSERT_TRUE(log.is_surveyed());
  client->push(control("{}"));
  std::vector<int> percents;
  bool is_withdrawn = false;
  for (json message = pop_text(*client); !message.empty(); message = pop_text(*client)) {
    if (message["op"] == "status") {
      EXPECT_FALSE(is_withdrawn);
      EXPECT_EQ(message["id"], "reading");
      const std::string words = message["message"];
      percents.push_back(std::stoi(words));
      EXPECT_EQ(words, std::to_string(percents.back()) + " % read");
    } else {
      EXPECT_EQ(message, (json{{"op", "removeStatus"}, {"statusIds", {"reading"}}}));
      is_withdrawn = true;
    }
  }
  EXPECT_TRUE(is_withdrawn);
  EXPECT_GT(percents.size(), 10U);
  EXPECT_TRUE(std::is_sorted(percents.begin(), percents.end()));
  EXPECT_GT(percents.front(), 8) << "the start was read before";
  EXPECT_LT(percents.front(), 50);
  EXPECT_GT(percents.back(), 90);

  // After the pass, the instant is sent again, as after a seek; playing continues.
  view.tick(3 * kSecond_ns);
  EXPECT_EQ(jammed(broker), R"(["Q2"])");
  client->push(control("{}"));
  std::string last_attack;
  int states = 0;
  for (auto frame = client->wait_pop(); !frame->is_text; frame = client->wait_pop()) {
    if (frame->head[0] == 1) {
      last_attack = *frame->body;
    } else if (frame->head[0] == 5) {
      ++states;
      EXPECT_EQ(frame->head,
                playback_state_frame(
                    {PlaybackStatus::kPlaying, instant + std::chrono::seconds(3), 1.0F, true, ""}));
    }
  }
  EXPECT_EQ(states, 1) << "viewers start again there";
  EXPECT_EQ(json::parse(last_attack)["jammed"].dump(), R"(["Q2"])");
  view.tick(3 * kSecond_ns);
  client->push(control("{}"));
  for (auto frame = client->wait_pop(); !frame->is_text; frame = client->wait_pop()) {
    EXPECT_NE(frame->head[0], 5) << "the instant was sent again already";
  }
  broker.disconnect(client);
}

TEST_F(UnreadLog, StartsANewSessionWhenItGrows) {
  append_attack(kStart_us - 5'000'000, "Q3");
  append_filler(60, 61);
  logs::SeekableLog log(write());
  ASSERT_FALSE(log.is_surveyed());
  const auto range = log.range();
  Broker broker({"test", "s", range});
  const logs::TypeLibrary types;
  const Time instant = from_utime(kStart_us + 10'000'000);
  LogView view(log, types, broker, instant);
  const auto client = broker.connect(true);
  const json before = pop_text(*client);
  pop_text(*client);
  read_first_pass(log, broker, [] { return false; });
  EXPECT_EQ(log.range(), std::pair(from_utime(kStart_us - 5'000'000), range.second));
  view.tick(0);
  client->push(control("{}"));
  std::vector<json> infos;
  for (auto frame = client->wait_pop(); frame->head != "{}"; frame = client->wait_pop()) {
    const json message = frame->is_text ? json::parse(frame->head) : json::object();
    if (message.value("op", "") == "serverInfo") {
      infos.push_back(message);
    }
  }
  ASSERT_EQ(infos.size(), 1U);
  EXPECT_NE(infos[0]["sessionId"], before["sessionId"]);
  EXPECT_EQ(infos[0]["dataStartTime"]["sec"], (kStart_us - 5'000'000) / 1'000'000);
  broker.disconnect(client);
  const auto asker = broker.connect(true);
  broker.on_request(*asker, parse_binary(playback_request(1, 1.0F, true, 0, "x")));
  view.tick(0);
  EXPECT_EQ(jammed(broker), R"(["Q3"])") << "a seek to the new beginning is accepted";
  broker.disconnect(asker);
}

}  // namespace
}  // namespace vantage::tools
