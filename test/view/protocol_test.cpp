#include "tools/view/protocol.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "test/view/viewer_words.hpp"
#include "tools/view/feed.hpp"
#include "tools/view/origin_check.hpp"

namespace vantage::tools {
namespace {

using nlohmann::json;
using test::playback_request;

TEST(OriginCheck, AcceptsOrdersOnlyFromTheSameServer) {
  struct Row {
    const char* origin;
    const char* host;
    bool is_same;
  };
  for (const Row& row : {Row{"http://127.0.0.1:8765", "127.0.0.1:8765", true},
                         {"https://lab-pc", "lab-pc", true},
                         {"http://[::1]:8765", "[::1]:8765", true},
                         {"http://127.0.0.1:9000", "127.0.0.1:8765", false},
                         {"http://localhost:8765", "127.0.0.1:8765", false},
                         {"https://app.foxglove.dev", "127.0.0.1:8765", false},
                         {"null", "null", false},
                         {"", "", false},
                         {"file://", "", false}}) {
    EXPECT_EQ(is_same_origin(row.origin, row.host), row.is_same) << row.origin << " " << row.host;
  }
  for (const char* own : {"127.0.0.1", "127.1.2.3", "localhost", "::1"}) {
    EXPECT_TRUE(is_loopback(own)) << own;
  }
  for (const char* other : {"0.0.0.0", "::", "192.168.1.2", "lab-pc", ""}) {
    EXPECT_FALSE(is_loopback(other)) << other;
  }
}

TEST(ServerInfoText, OffersPlaybackOnlyForLogs) {
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

// An LCM channel name from any sender on the network may contain any bytes except NUL.
TEST(AdvertiseText, IsUtf8ForAnyChannelName) {
  const std::vector<ChannelInfo> channels = {{3, "/K\xd6RPER", {}}};
  std::string advertised;
  ASSERT_NO_THROW(advertised = advertise_text(channels));
  EXPECT_EQ(nlohmann::json::parse(advertised)["channels"][0]["topic"], "/K\xef\xbf\xbdRPER");
}

TEST(MessageHead, HasOpcodeSubscriptionAndNanoseconds) {
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

TEST(ParseBinary, RefusesTruncatedAndInvalidRequests) {
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

TEST(ParseText, SurvivesInvalidRequests) {
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

TEST(OffersOurProtocol, FindsTheProtocolInAList) {
  EXPECT_TRUE(offers_our_protocol("foxglove.sdk.v1"));
  EXPECT_TRUE(offers_our_protocol("chat, foxglove.websocket.v1"));
  EXPECT_FALSE(offers_our_protocol("foxglove.websocket.v2"));
  EXPECT_FALSE(offers_our_protocol(""));
}

TEST(RawMessage, ReportsFingerprintOfForeignType) {
  const std::vector<std::uint8_t> foreign{1, 2, 3, 4, 5, 6, 7, 0xab, 9, 9};
  EXPECT_EQ(raw_message(foreign, {}),
            (json{{"foreign_type", "0x01020304050607ab"}, {"bytes", 10}}));
  EXPECT_EQ(raw_message({}, {}), (json{{"foreign_type", "0x"}, {"bytes", 0}}));
}

TEST(IsOurHost, AcceptsAddressLocalHostOrGivenName) {
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

TEST(IsKnownOrigin, AcceptsOurPageFoxgloveAndThisMachine) {
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
