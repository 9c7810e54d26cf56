#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "logs/file/event_table.hpp"
#include "test/logs/file_support.hpp"
#include "tools/view/broker.hpp"
#include "tools/view/feed.hpp"
#include "tools/view/history.hpp"
#include "tools/view/log_view.hpp"
#include "tools/view/outbox.hpp"
#include "tools/view/playback.hpp"
#include "tools/view/protocol.hpp"
#include "tools/view/welcome.hpp"

namespace vantage::tools {
namespace {

using logs::foxglove::Schema;
using nlohmann::json;

Frame flow(std::size_t bytes) {
  return {Frame::Kind::kFlow, false, 1, std::string(bytes, 'x'), nullptr};
}
Frame state(std::uint32_t id, const std::string& content) {
  return {Frame::Kind::kState, false, id, content, nullptr};
}
Frame control(const std::string& content) {
  return {Frame::Kind::kControl, true, 0, content, nullptr};
}

/// The bytes of a playback control request, as a client makes them.
std::string playback_request(std::uint8_t command, float speed, bool had_seek,
                             std::uint64_t seek_ns, const std::string& id) {
  std::string out("\x03", 1);
  const auto put = [&](std::uint64_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) {
      out.push_back(static_cast<char>(value >> (8 * i) & 0xFFU));
    }
  };
  put(command, 1);
  put(std::bit_cast<std::uint32_t>(speed), 4);
  put(had_seek ? 1 : 0, 1);
  put(seek_ns, 8);
  put(id.size(), 4);
  return out + id;
}

TEST(ServerInfoText, OffersPlaybackOfALogAlone) {
  const json live = json::parse(server_info_text({"a", "s", std::nullopt}, true));
  EXPECT_EQ(live["op"], "serverInfo");
  EXPECT_TRUE(live["capabilities"].empty());
  const json log = json::parse(
      server_info_text({"a", "s", std::pair(from_utime(1'500'000), from_utime(61'000'000))}, true));
  EXPECT_EQ(log["capabilities"], json({"time", "playbackControl"}));
  const json old =
      json::parse(server_info_text({"a", "s", std::pair(from_utime(0), from_utime(1))}, false));
  EXPECT_EQ(old["capabilities"], json({"time"})) << "the older subprotocol has no playback";
  EXPECT_EQ(log["dataStartTime"], json({{"sec", 1}, {"nsec", 500'000'000}}));
}

TEST(MessageHead, IsOpcodeSubscriptionAndNanosecondsLittleEndian) {
  const std::string head = message_head(0x01020304, from_utime(1));
  EXPECT_EQ(head, std::string("\x01\x04\x03\x02\x01\xE8\x03\0\0\0\0\0\0", 13));
}

TEST(ParseBinary, ReadsAPlaybackRequest) {
  const Request request = parse_binary(playback_request(0, 2.5F, true, 7'000'000'000, "ab"));
  const auto& control = std::get<PlaybackControl>(request);
  EXPECT_TRUE(control.play);
  EXPECT_EQ(control.speed, 2.5F);
  EXPECT_EQ(control.seek, from_utime(7'000'000));
  EXPECT_EQ(control.request_id, "ab");
}

TEST(ParseBinary, RefusesEveryTornOrImpossibleRequest) {
  const std::string whole = playback_request(1, 1.0F, false, 0, "id");
  ASSERT_TRUE(std::holds_alternative<PlaybackControl>(parse_binary(whole)));
  for (std::size_t size = 1; size < whole.size(); ++size) {
    EXPECT_TRUE(std::holds_alternative<Malformed>(parse_binary(whole.substr(0, size)))) << size;
  }
  EXPECT_TRUE(std::holds_alternative<Malformed>(parse_binary(whole + "x")));
  EXPECT_TRUE(std::holds_alternative<Malformed>(
      parse_binary(playback_request(0, std::nanf(""), false, 0, ""))));
  EXPECT_TRUE(
      std::holds_alternative<Malformed>(parse_binary(playback_request(2, 1.0F, false, 0, ""))));
  EXPECT_TRUE(std::holds_alternative<Declined>(parse_binary("")));
}

TEST(ParseText, SurvivesWhatNoViewerShouldSend) {
  for (const char* text :
       {"", "{", "[]", "{\"op\":7}", R"({"op":"subscribe","subscriptions":3})",
        R"({"op":"subscribe","subscriptions":[1]})",
        R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})",
        R"({"op":"subscribe","subscriptions":[{"id":5000000000,"channelId":1}]})",
        R"({"op":"unsubscribe","subscriptionIds":["a"]})"}) {
    EXPECT_TRUE(std::holds_alternative<Malformed>(parse_text(text))) << text;
  }
  EXPECT_TRUE(std::holds_alternative<Declined>(parse_text(R"({"op":"advertise"})")));
  const Request good =
      parse_text(R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":4294967295}]})");
  EXPECT_EQ(std::get<Subscribe>(good).pairs.front(),
            (std::pair<std::uint32_t, std::uint32_t>(0, 4294967295U)));
}

TEST(OffersOurProtocol, FindsItInAList) {
  EXPECT_TRUE(offers_our_protocol("foxglove.sdk.v1"));
  EXPECT_TRUE(offers_our_protocol("chat, foxglove.websocket.v1"));
  EXPECT_FALSE(offers_our_protocol("foxglove.websocket.v2"));
  EXPECT_FALSE(offers_our_protocol(""));
}

TEST(Outbox, DropsTheOldestFlowAndNeverControl) {
  Outbox outbox(100);
  outbox.push(control("hello"));
  for (int i = 0; i < 50; ++i) {
    outbox.push(flow(10));
  }
  EXPECT_EQ(outbox.dropped(), 40);
  EXPECT_LE(outbox.bytes(), 105U);
  EXPECT_EQ(outbox.pop()->head, "hello");
  int left = 0;
  while (outbox.pop()) {
    ++left;
  }
  EXPECT_EQ(left, 10);
  EXPECT_EQ(outbox.bytes(), 0U);
}

TEST(Outbox, KeepsOnlyTheNewestOfAState) {
  Outbox outbox(100);
  for (int i = 0; i < 1000; ++i) {
    outbox.push(state(1, "old"));
    outbox.push(state(2, "other"));
  }
  outbox.push(state(1, "new"));
  EXPECT_EQ(outbox.pop()->head, "other");
  EXPECT_EQ(outbox.pop()->head, "new");
  EXPECT_FALSE(outbox.pop());
  EXPECT_EQ(outbox.dropped(), 0);
}

TEST(Outbox, LetsOneFrameThroughHoweverLarge) {
  Outbox outbox(100);
  outbox.push(flow(500));
  EXPECT_EQ(outbox.pop()->size(), 500U);
}

TEST(Outbox, GivesUpOnAViewerThatNeverReads) {
  Outbox outbox(100, 3);
  for (int i = 0; i < 4; ++i) {
    EXPECT_FALSE(outbox.is_hopeless());
    outbox.push(control("x"));
  }
  EXPECT_TRUE(outbox.is_hopeless());
}

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

json pop_text(Client& client) {
  const auto frame = client.wait_pop();
  EXPECT_TRUE(frame && frame->is_text);
  return frame ? json::parse(frame->head) : json();
}

void put(Broker& broker, const std::string& topic, int value, bool is_state) {
  if (broker.wants(topic, Schema::kTeam, is_state)) {
    broker.write(topic, from_utime(value), json{{"known", value}});
  }
}

TEST(Broker, TellsANewcomerWhatThereIsAndTheStates) {
  Broker broker({"test", "s", std::nullopt});
  put(broker, "/state", 1, true);
  put(broker, "/flow", 2, false);
  const auto client = broker.connect(true);
  EXPECT_EQ(pop_text(*client)["op"], "serverInfo");
  const json advertised = pop_text(*client);
  ASSERT_EQ(advertised["channels"].size(), 2U);
  EXPECT_EQ(advertised["channels"][0]["topic"], "/state");
  broker.on_request(*client, Subscribe{{{7, 1}, {8, 2}}});
  const auto frame = client->wait_pop();
  EXPECT_EQ(frame->head, message_head(7, from_utime(1)));
  EXPECT_EQ(*frame->body, R"({"known":1})");
  put(broker, "/flow", 3, false);
  EXPECT_EQ(client->wait_pop()->head, message_head(8, from_utime(3)));
  broker.disconnect(client);
  EXPECT_FALSE(client->wait_pop());
}

TEST(Broker, WantsAFlowOnlyWhileSomebodyWatches) {
  Broker broker({"test", "s", std::nullopt});
  EXPECT_FALSE(broker.wants("/flow", Schema::kTeam, false));
  EXPECT_TRUE(broker.wants("/state", Schema::kTeam, true));
  const auto client = broker.connect(true);
  broker.on_request(*client, Subscribe{{{1, 1}}});
  EXPECT_TRUE(broker.wants("/flow", Schema::kTeam, false));
  broker.on_request(*client, Unsubscribe{{1}});
  EXPECT_FALSE(broker.wants("/flow", Schema::kTeam, false));
  broker.on_request(*client, Subscribe{{{2, 1}}});
  broker.disconnect(client);
  EXPECT_FALSE(broker.wants("/flow", Schema::kTeam, false));
}

TEST(Broker, AdvertisesATopicToThoseAlreadyThere) {
  Broker broker({"test", "s", std::nullopt});
  const auto client = broker.connect(true);
  pop_text(*client);
  pop_text(*client);
  put(broker, "/new", 1, true);
  put(broker, "/new", 2, true);
  const json advertised = pop_text(*client);
  EXPECT_EQ(advertised["channels"][0]["topic"], "/new");
  EXPECT_EQ(advertised["channels"][0]["schemaName"], "vantage.Team");
  broker.disconnect(client);
}

TEST(Broker, RefusesDoubleAndUnknownSubscriptionsAndChangesNothing) {
  Broker broker({"test", "s", std::nullopt});
  put(broker, "/flow", 1, false);
  const auto client = broker.connect(true);
  pop_text(*client);
  pop_text(*client);
  broker.on_request(*client, Subscribe{{{1, 1}, {1, 1}, {2, 9}, {3, 0}}});
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(pop_text(*client)["level"], 2);
  }
  broker.on_request(*client, Declined{"advertise"});
  EXPECT_EQ(pop_text(*client)["level"], 1);
  broker.on_request(*client, PlaybackControl{});
  EXPECT_TRUE(broker.take_controls().empty()) << "a live bus cannot be sought in";
  broker.disconnect(client);
}

TEST(Broker, HoldsBackTheWayToAnInstantAndSendsWhereItLed) {
  Broker broker({"test", "s", std::pair(from_utime(0), from_utime(9))});
  put(broker, "/flow", 1, false);
  const auto client = broker.connect(true);
  pop_text(*client);
  pop_text(*client);
  broker.on_request(*client, Subscribe{{{1, 1}}});
  EXPECT_EQ(client->wait_pop()->head, message_head(1, from_utime(1)));
  broker.hold();
  put(broker, "/flow", 2, false);
  put(broker, "/flow", 3, false);
  broker.release();
  EXPECT_EQ(client->wait_pop()->head, message_head(1, from_utime(3)));
  broker.disconnect(client);
}

TEST(Broker, TellsANewcomerWhereThePlayerIs) {
  Broker broker({"test", "s", std::pair(from_utime(0), from_utime(9'000'000))});
  const PlaybackState state{PlaybackStatus::kPlaying, from_utime(1'000'000), 2.0F, true, "r"};
  broker.broadcast_playback(state);
  broker.broadcast_time(from_utime(5'000'000));
  for (const bool speaks_sdk : {true, false}) {
    const auto client = broker.connect(speaks_sdk);
    pop_text(*client);
    pop_text(*client);
    EXPECT_EQ(client->wait_pop()->head, time_frame(from_utime(5'000'000)));
    if (speaks_sdk) {
      EXPECT_EQ(
          client->wait_pop()->head,
          playback_state_frame({PlaybackStatus::kPlaying, from_utime(5'000'000), 2.0F, false, ""}));
    }
    client->push(control("{}"));
    EXPECT_TRUE(pop_text(*client).empty()) << "nothing else";
    broker.disconnect(client);
  }
}

TEST(Broker, CountsWhatASlowViewerMissesAndTellsIt) {
  Broker broker({"test", "s", std::nullopt});
  put(broker, "/flow", 0, false);
  const auto client = broker.connect(true);
  broker.on_request(*client, Subscribe{{{1, 1}}});
  const json large{{"yaml", std::string(1U << 20U, 'x')}};
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(broker.wants("/flow", Schema::kTeam, false));
    broker.write("/flow", from_utime(i), large);
  }
  EXPECT_GE(broker.dropped(), 12);
  EXPECT_LE(broker.dropped(), 13);
  broker.disconnect(client);
  EXPECT_GE(broker.dropped(), 12) << "also after it has gone";
}

bool unpack_sample(const std::string& path) {
  return std::system(("xz -dkc " + std::string(VANTAGE_SOURCE_DIR) +
                      "/logs/sample/lab_60s.lcmlog.xz > " + path + " 2>/dev/null")
                         .c_str()) == 0;
}

TEST(LogView, ShowsTheSameInstantHoweverItCameThere) {
  const logs::test::TemporaryFolder folder;
  if (!unpack_sample(folder.file("lab.lcmlog"))) {
    GTEST_SKIP() << "no xz";
  }
  const logs::IndexedLog indexed(folder.file("lab.lcmlog"));
  const logs::EventTable log(indexed);
  const Time instant = log.start() + std::chrono::seconds(40);
  const auto newest = [&](bool goes_back_first) {
    Broker broker({"test", "s", std::pair(log.start(), log.end())});
    LogView view(log, broker);
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

TEST(LogHistory, HoldsTheNumbersOfTheWholeLogInOrder) {
  const logs::test::TemporaryFolder folder;
  if (!unpack_sample(folder.file("lab.lcmlog"))) {
    GTEST_SKIP() << "no xz";
  }
  const logs::IndexedLog indexed(folder.file("lab.lcmlog"));
  const logs::EventTable log(indexed);
  Broker broker({"test", "s", std::pair(log.start(), log.end())});
  const json history = json::parse(log_history(log, broker));
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

TEST(LogSeries, IsOneNumberOfATopicOverTheWholeLog) {
  const logs::test::TemporaryFolder folder;
  if (!unpack_sample(folder.file("lab.lcmlog"))) {
    GTEST_SKIP() << "no xz";
  }
  const logs::IndexedLog indexed(folder.file("lab.lcmlog"));
  const logs::EventTable log(indexed);
  const json battery = json::parse(log_series(log, "/vehicle/Q1", "/battery_share"));
  EXPECT_GT(battery.size(), 100U);
  EXPECT_GT(battery.front()[1].get<double>(), battery.back()[1].get<double>());
  // The same plans as they are on the bus and as viewers are told them.
  const json raw = json::parse(log_series(log, "/lcm/PLAN_Q1", "/nodes"));
  const json told = json::parse(log_series(log, "/plan/Q1/status", "/nodes"));
  EXPECT_NEAR(static_cast<double>(raw.size()), 60.0, 3.0);
  EXPECT_EQ(raw, told);
  const json late = json::parse(log_series(log, "/plan/Q1/status", "/late"));
  EXPECT_EQ(late.front()[1], 0.0) << "false is a number, too";
  EXPECT_TRUE(json::parse(log_series(log, "/vehicle/Q1", "/nowhere")).empty());
  EXPECT_TRUE(json::parse(log_series(log, "/vehicle/Q1", "battery_share")).empty());
  EXPECT_TRUE(json::parse(log_series(log, "/nobody", "/a")).empty());
}

TEST(FirstPicture, IsWhereEveryRobotHasAPlaceAndAPlanAndSomethingIsKnown) {
  const logs::test::TemporaryFolder folder;
  if (!unpack_sample(folder.file("lab.lcmlog"))) {
    GTEST_SKIP() << "no xz";
  }
  const logs::IndexedLog indexed(folder.file("lab.lcmlog"));
  const logs::EventTable log(indexed);
  const Time first = first_picture(log);
  EXPECT_GT(to_seconds(first - log.start()), 0.5);
  EXPECT_LT(to_seconds(first - log.start()), 10.0);
  Broker broker({"test", "s", std::pair(log.start(), log.end())});
  const LogView view(log, broker, first);
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

/// Wants everything, and counts it.
class Counter : public logs::foxglove::Sink {
 public:
  bool wants(const std::string& topic, Schema /*schema*/, bool /*is_state*/) override {
    ++asked[topic];
    return wants_all;
  }
  void write(const std::string& topic, Time /*time*/, const json& /*content*/) override {
    ++written[topic];
  }
  bool wants_all = true;
  std::map<std::string, int> asked;
  std::map<std::string, int> written;
};

void tell(History& history, bus::VirtualClock& clock, const std::string& topic, Schema schema,
          const json& content, std::int64_t at_us) {
  clock.set(from_utime(at_us));
  if (history.wants(topic, schema, true)) {
    history.write(topic, clock.now(), content);
  }
}

TEST(History, ThinsWhatComesOftenAndPassesOnAllOfIt) {
  bus::VirtualClock clock(Time{});
  Counter audience;
  History history(clock, audience, History::Audience::kHears, 1U << 20U);
  const json place{
      {"transforms", json::array({{{"child_frame_id", "Q1"},
                                   {"translation", {{"x", 1.234}, {"y", 2}, {"z", 3}}}}})}};
  for (int i = 0; i < 100; ++i) {
    const std::int64_t at_us = 1'000'000 + 20'000 * i;
    tell(history, clock, "/vehicle/Q1", Schema::kVehicle, {{"i", i}}, at_us);
    tell(history, clock, "/transforms", Schema::kFrameTransforms, place, at_us);
    tell(history, clock, "/team", Schema::kTeam, {{"i", i}}, at_us);
    tell(history, clock, "/robots", Schema::kSceneUpdate, {{"i", i}}, at_us);
  }
  std::map<std::string, int> kept;
  json way;
  for (const json& record : json::parse(history.text())) {
    ++kept[record[0].get<std::string>()];
    way = record[0] == "/ways" ? record[2] : way;
  }
  EXPECT_EQ(kept, (std::map<std::string, int>{{"/team", 100}, {"/vehicle/Q1", 2}, {"/ways", 10}}));
  EXPECT_EQ(way, (json{{"Q1", {1.23, 2.0, 3.0}}})) << "to a centimetre";
  for (const char* topic : {"/vehicle/Q1", "/transforms", "/team", "/robots"}) {
    EXPECT_EQ(audience.written[topic], 100) << topic;
  }
}

TEST(History, KeepsForLaterWhatNobodyHearsNow) {
  bus::VirtualClock clock(Time{});
  Counter audience;
  audience.wants_all = false;
  History history(clock, audience, History::Audience::kHears, 1U << 20U);
  tell(history, clock, "/events", Schema::kLog, {{"message", "a"}}, 5);
  tell(history, clock, "/robots", Schema::kSceneUpdate, {{"i", 1}}, 6);
  EXPECT_EQ(json::parse(history.text()), json::parse(R"([["/events", 5, {"message": "a"}]])"));
  EXPECT_TRUE(audience.written.empty());
  EXPECT_EQ(audience.asked["/robots"], 1);
}

TEST(History, IsBoundedAndForgetsTheOldest) {
  bus::VirtualClock clock(Time{});
  Counter audience;
  History history(clock, audience, History::Audience::kHears, 4000);
  for (int i = 0; i < 1000; ++i) {
    tell(history, clock, "/team", Schema::kTeam, {{"i", i}}, i);
  }
  const json kept = json::parse(history.text());
  EXPECT_LT(history.text().size(), 4500U);
  EXPECT_GT(kept.size(), 50U);
  EXPECT_EQ(kept.back()[1], 999);
  EXPECT_EQ(kept.front()[1], 1000 - static_cast<int>(kept.size()));
}

TEST(Broker, CountsRecordsOfATopicThatNobodyHears) {
  Broker broker({"test", "s", std::nullopt});
  for (int i = 0; i < 7; ++i) {
    put(broker, "/flow", i, false);
  }
  EXPECT_EQ(json::parse(broker.topics_text()),
            json::parse(R"([{"topic": "/flow", "schema": "vantage.Team", "count": 7}])"));
}

TEST(Broker, KeepsRawMessagesOfALogForWhoSubscribesAlone) {
  Broker broker({"test", "s", std::pair(Time{}, from_utime(10))});
  EXPECT_FALSE(broker.wants("/lcm/PLAN_Q1", Schema::kLcm, false));
  const auto client = broker.connect(true);
  broker.on_request(*client, Subscribe{{{1, 1}}});
  broker.hold();
  EXPECT_TRUE(broker.wants("/lcm/PLAN_Q1", Schema::kLcm, false)) << "also on the way to an instant";
}

TEST(RawMessage, TellsAForeignTypeByItsFingerprint) {
  const std::vector<std::uint8_t> foreign{1, 2, 3, 4, 5, 6, 7, 0xab, 9, 9};
  EXPECT_EQ(raw_message(foreign), (json{{"foreign_type", "0x01020304050607ab"}, {"bytes", 10}}));
  EXPECT_EQ(raw_message({}), (json{{"foreign_type", "0x"}, {"bytes", 0}}));
}

TEST(IsOurHost, IsAnAddressThisMachineOrWhatWasNamed) {
  const std::vector<std::string> more{"lab-wall"};
  for (const char* ours : {"127.0.0.1:8765", "10.0.0.7", "[::1]:8765", "localhost:8765",
                           "LocalHost", "lab-wall:8765", "Lab-Wall"}) {
    EXPECT_TRUE(is_our_host(ours, more)) << ours;
  }
  for (const char* strange : {"evil.example:8765", "127.0.0.1.evil.example",
                              "localhost.evil.example", "", "[evil]", "1.2.3"}) {
    EXPECT_FALSE(is_our_host(strange, more)) << strange;
  }
}

TEST(IsKnownOrigin, IsOurPageFoxgloveOrOfThisMachine) {
  const std::vector<std::string> more{"https://viewer.example"};
  const std::string host = "10.0.0.7:8765";
  for (const char* known :
       {"http://10.0.0.7:8765", "https://app.foxglove.dev", "file://", "http://localhost:8080",
        "http://127.0.0.1:3000", "https://viewer.example"}) {
    EXPECT_TRUE(is_known_origin(known, host, more)) << known;
  }
  for (const char* strange : {"http://10.0.0.8:8765", "http://10.0.0.7:80", "https://evil.example",
                              "null", "", "http://localhost.evil.example",
                              "https://app.foxglove.dev.evil.example", "10.0.0.7:8765"}) {
    EXPECT_FALSE(is_known_origin(strange, host, more)) << strange;
  }
}

}  // namespace
}  // namespace vantage::tools
