#include "tools/view/broker.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "test/view/viewer_words.hpp"
#include "tools/view/outbox.hpp"
#include "tools/view/protocol.hpp"

namespace vantage::tools {
namespace {

using logs::foxglove::Schema;
using nlohmann::json;
using test::control;
using test::flow;
using test::pop_text;
using test::put;
using test::state;

TEST(Outbox, DropsOldDataButNoControlMessages) {
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

TEST(Outbox, KeepsOnlyTheNewestFrameOfAState) {
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

TEST(Outbox, SendsOneFrameOfAnySize) {
  Outbox outbox(100);
  outbox.push(flow(500));
  EXPECT_EQ(outbox.pop()->size(), 500U);
}

TEST(Outbox, ClosesAViewerThatNeverReads) {
  Outbox outbox(100, 3);
  for (int i = 0; i < 4; ++i) {
    EXPECT_FALSE(outbox.is_overflowing());
    outbox.push(control("x"));
  }
  EXPECT_TRUE(outbox.is_overflowing());
}

TEST(Broker, SendsTopicsAndStatesToNewViewer) {
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

TEST(Broker, WantsFlowRecordsOnlyWithSubscribers) {
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

TEST(Broker, AdvertisesATopicToConnectedViewers) {
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

TEST(Broker, RefusesDuplicateAndUnknownSubscriptions) {
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
  EXPECT_TRUE(broker.take_controls().empty()) << "a live bus has no seek";
  broker.disconnect(client);
}

TEST(Broker, SendsOnlyLastRecordAfterHold) {
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
  // A viewer that subscribes between hold() and release() also receives only the last record.
  broker.hold();
  put(broker, "/flow", 4, false);
  const auto newcomer = broker.connect(true);
  pop_text(*newcomer);
  pop_text(*newcomer);
  broker.on_request(*newcomer, Subscribe{{{9, 1}}});
  put(broker, "/flow", 5, false);
  broker.release();
  EXPECT_EQ(newcomer->wait_pop()->head, message_head(9, from_utime(5)));
  broker.disconnect(newcomer);
  broker.disconnect(client);
}

TEST(Broker, SendsPlaybackStateToNewViewer) {
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
    EXPECT_TRUE(pop_text(*client).empty()) << "no other text";
    broker.disconnect(client);
  }
}

TEST(Broker, CountsAndReportsMissedMessagesOfASlowViewer) {
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
  EXPECT_GE(broker.dropped(), 12) << "counted also after the viewer has left";
}

TEST(Broker, CountsRecordsWithoutSubscribers) {
  Broker broker({"test", "s", std::nullopt});
  for (int i = 0; i < 7; ++i) {
    put(broker, "/flow", i, false);
  }
  EXPECT_EQ(json::parse(broker.topics_text()),
            json::parse(R"({"topics": [{"topic": "/flow", "schema": "vantage.Team", "count": 7}],
                            "jumps": 0, "time_s": null})"));
}

// Each text contains the counts with their log time and the number of jumps, so that a viewer
// computes no rate across a jump.
TEST(Broker, ReportsLogTimeAndJumpsWithCounts) {
  Broker broker({"test", "s", std::pair(from_utime(0), from_utime(9'000'000))});
  const auto counted = [&broker] {
    const json all = json::parse(broker.topics_text());
    return std::pair(all["jumps"], all["time_s"]);
  };
  broker.reached(from_utime(2'500'000));
  EXPECT_EQ(counted(), std::pair(json(0), json(2.5)));
  broker.reached(from_utime(2'750'000));
  EXPECT_EQ(counted(), std::pair(json(0), json(2.75)));
  for (int jumps = 1; jumps <= 2; ++jumps) {
    broker.forget();
    EXPECT_EQ(counted(), std::pair(json(jumps), json())) << "no numbers during a seek";
    broker.reached(from_utime(1'000'000));
    EXPECT_EQ(counted(), std::pair(json(jumps), json(1.0)));
  }
}

TEST(Broker, SendsRawMessagesOnlyToSubscribers) {
  Broker broker({"test", "s", std::pair(Time{}, from_utime(10))});
  EXPECT_FALSE(broker.wants("/lcm/PLAN_Q1", Schema::kLcm, false));
  const auto client = broker.connect(true);
  broker.on_request(*client, Subscribe{{{1, 1}}});
  broker.hold();
  EXPECT_TRUE(broker.wants("/lcm/PLAN_Q1", Schema::kLcm, false)) << "also during a seek";
}

TEST(Broker, SendsStatusUntilWithdrawn) {
  Broker broker({"test", "s", std::pair(from_utime(0), from_utime(9))});
  const auto client = broker.connect(true);
  pop_text(*client);
  pop_text(*client);
  broker.set_status("reading", "3 % read");
  broker.set_status("other", "as well");
  broker.set_status("reading", "4 % read");
  for (const char* words : {"3 % read", "as well", "4 % read"}) {
    const json message = pop_text(*client);
    EXPECT_EQ(message["op"], "status");
    EXPECT_EQ(message["level"], 0);
    EXPECT_EQ(message["message"], words);
    EXPECT_EQ(message["id"], words[0] == 'a' ? "other" : "reading");
  }
  const auto newcomer = broker.connect(false);
  pop_text(*newcomer);
  pop_text(*newcomer);
  EXPECT_EQ(pop_text(*newcomer)["message"], "as well");
  EXPECT_EQ(pop_text(*newcomer)["message"], "4 % read") << "only the newest status";
  broker.set_status("reading", "");
  for (const auto& each : {client, newcomer}) {
    EXPECT_EQ(pop_text(*each), (json{{"op", "removeStatus"}, {"statusIds", {"reading"}}}));
    broker.disconnect(each);
  }
  const auto late = broker.connect(true);
  pop_text(*late);
  pop_text(*late);
  EXPECT_EQ(pop_text(*late)["message"], "as well");
  late->push(control("{}"));
  EXPECT_TRUE(pop_text(*late).empty()) << "no further status";
  broker.disconnect(late);
}

TEST(Broker, StartsANewSessionWhenTheLogGrows) {
  const std::pair range(from_utime(1'000'000), from_utime(9'000'000));
  Broker broker({"test", "s", range});
  put(broker, "/state", 1, true);
  const auto client = broker.connect(true);
  EXPECT_EQ(pop_text(*client)["sessionId"], "s");
  pop_text(*client);
  broker.set_range(range.first, range.second);
  client->push(control("{}"));
  EXPECT_TRUE(pop_text(*client).empty()) << "unchanged";
  broker.set_range(range.first, from_utime(12'000'000));
  const json info = pop_text(*client);
  EXPECT_EQ(info["op"], "serverInfo");
  EXPECT_NE(info["sessionId"], "s");
  EXPECT_EQ(info["dataStartTime"]["sec"], 1);
  EXPECT_EQ(info["dataEndTime"]["sec"], 12);
  const json channels = pop_text(*client)["channels"];
  ASSERT_EQ(channels.size(), 1U) << "a new session advertises the channels again";
  EXPECT_EQ(channels[0]["topic"], "/state");
  broker.disconnect(client);
  const auto newcomer = broker.connect(true);
  EXPECT_EQ(pop_text(*newcomer)["sessionId"], info["sessionId"]);
  broker.disconnect(newcomer);
}

}  // namespace
}  // namespace vantage::tools
