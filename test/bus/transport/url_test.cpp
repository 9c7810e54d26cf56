#include "bus/transport/url.hpp"

#include <cstdlib>
#include <optional>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "bus/transport/transport.hpp"
#include "core/check.hpp"

namespace vantage::bus {
namespace {

TEST(ParseUrl, ReturnsSchemeAddressAndOptions) {
  const Url url = parse_url("file:///tmp/a log?mode=r&speed=0");
  EXPECT_EQ(url.scheme, "file");
  EXPECT_EQ(url.target, "/tmp/a log");
  EXPECT_EQ(url.options, (std::map<std::string, std::string>{{"mode", "r"}, {"speed", "0"}}));
}

TEST(ParseUrl, RefusesMalformedUrls) {
  EXPECT_THROW(parse_url("239.255.76.67:7667"), StartupError);
  EXPECT_THROW(parse_url("://x"), StartupError);
  EXPECT_THROW(parse_url("udpm://?ttl"), StartupError);
  EXPECT_THROW(parse_url("udpm://?ttl=0&ttl=1"), StartupError);
}

TEST(ParseUdpm, AppliesDefaults) {
  const UdpmAddress plain = parse_udpm(parse_url("udpm://"));
  EXPECT_EQ(plain.group, "239.255.76.67");
  EXPECT_EQ(plain.port, 7667);
  EXPECT_EQ(plain.ttl, 0);
  EXPECT_EQ(plain.recv_buf_bytes, 4 << 20);
  EXPECT_EQ(plain.message_bytes_max, 4 << 20);
  EXPECT_EQ(plain.interface, "");
  const UdpmAddress full =
      parse_udpm(parse_url("udpm://239.1.2.3:7000?ttl=1&recv_buf_size=9000&max_message_size=5000"
                           "&interface=wlp2s0"));
  EXPECT_EQ(full.interface, "wlp2s0");
  EXPECT_EQ(full.group, "239.1.2.3");
  EXPECT_EQ(full.port, 7000);
  EXPECT_EQ(full.ttl, 1);
  EXPECT_EQ(full.recv_buf_bytes, 9000);
  EXPECT_EQ(full.message_bytes_max, 5000);
}

TEST(ParseUdpm, ReadsPeers) {
  const UdpmAddress address =
      parse_udpm(parse_url("udpm://239.1.2.3:7000?peers=10.0.0.1:7001,10.0.0.2:7002"));
  EXPECT_EQ(address.peers, (std::vector<UdpmPeer>{{"10.0.0.1", 7001}, {"10.0.0.2", 7002}}));
}

TEST(ParseUdpm, RefusesInvalidPeers) {
  for (const char* options :
       {"peers=", "peers=10.0.0.1", "peers=10.0.0.1:0", "peers=host:7001", "peers=10.0.0.1:7001x",
        "peers=239.1.2.3:7001", "peers=10.0.0.1:7001,10.0.0.1:7001", "ttl=1&peers=10.0.0.1:7001",
        "interface=wlan0&peers=10.0.0.1:7001"}) {
    EXPECT_THROW(parse_udpm(parse_url(std::string("udpm://?") + options)), StartupError) << options;
  }
}

TEST(WithUdpmOption, AddsAMissingOption) {
  const std::pair<const char*, const char*> cases[] = {
      {"udpm://", "udpm://?max_message_size=9000"},
      {"udpm://239.255.76.67:7667?ttl=1", "udpm://239.255.76.67:7667?ttl=1&max_message_size=9000"},
      {"udpm://?max_message_size=5000", "udpm://?max_message_size=5000"},
      {"memq://", "memq://"},
      {"file://a?mode=r", "file://a?mode=r"}};
  for (const auto& [url, wanted] : cases) {
    EXPECT_EQ(with_udpm_option(url, "max_message_size", "9000"), wanted);
  }
}

TEST(ParseUdpm, RefusesUnsupportedOptions) {
  for (const char* url :
       {"udpm://192.168.1.1:7667", "udpm://localhost:7667", "udpm://239.255.76.67:0",
        "udpm://239.255.76.67:70000", "udpm://239.255.76.67:76x", "udpm://?ttl=256",
        "udpm://?ttl=-1", "udpm://?ttl=", "udpm://?recv_buf_size=1", "udpm://?colour=red",
        "udpm://?interface=", "udpm://?interface=a/b", "udpm://?interface=sixteen-letters0"}) {
    EXPECT_THROW(parse_udpm(parse_url(url)), StartupError) << url;
  }
}

std::string refusal(const std::string& url) {
  try {
    static_cast<void>(parse_udpm(parse_url(url)));
  } catch (const StartupError& error) {
    return error.what();
  }
  return "taken";
}

TEST(ParseUdpm, AcceptsTheFullRangeOfEachNumber) {
  const auto taken = [](const std::string& url) { return refusal(url) == "taken"; };
  EXPECT_TRUE(taken("udpm://239.255.76.67:1") && taken("udpm://239.255.76.67:65535"));
  EXPECT_FALSE(taken("udpm://239.255.76.67:0") || taken("udpm://239.255.76.67:65536"));
  EXPECT_TRUE(taken("udpm://?ttl=0") && taken("udpm://?ttl=255"));
  EXPECT_FALSE(taken("udpm://?ttl=-1") || taken("udpm://?ttl=256"));
  for (const char* const name : {"recv_buf_size", "max_message_size"}) {
    const std::string url = std::string("udpm://?") + name + "=";
    EXPECT_TRUE(taken(url + "2048") && taken(url + "1073741824")) << name;
    EXPECT_FALSE(taken(url + "2047") || taken(url + "1073741825")) << name;
    EXPECT_FALSE(taken(url + "4096k") || taken(url)) << name;
  }
  EXPECT_EQ(refusal("udpm://?recv_buf_size=1"),
            "LCM url: recv_buf_size is '1', must be a whole number in [2048, 1073741824]");
  for (const char* const group : {"224.0.0.0", "239.255.255.255"}) {
    EXPECT_EQ(parse_udpm(parse_url(std::string("udpm://") + group)).group, group);
  }
  EXPECT_FALSE(taken("udpm://223.255.255.255") || taken("udpm://240.0.0.0"));
}

TEST(ParseUdpm, AcceptsValidInterfaceNames) {
  const auto card = [](const std::string& name) { return refusal("udpm://?interface=" + name); };
  EXPECT_EQ(card("fifteen-letters"), "taken");
  EXPECT_EQ(card("10.0.0.1"), "taken");
  for (const char* const bad : {"sixteen-letters-", "a b", "a\tb", "a%b", "/a", ""}) {
    EXPECT_NE(card(bad), "taken") << bad;
  }
}

TEST(ParseUrl, SplitsOptions) {
  const Url url = parse_url("udpm://239.1.2.3:7000?a=1&b=x=y&c=");
  EXPECT_EQ(url.target, "239.1.2.3:7000");
  EXPECT_EQ(url.options, (std::map<std::string, std::string>{{"a", "1"}, {"b", "x=y"}, {"c", ""}}));
  EXPECT_EQ(parse_url("a://").scheme, "a");
  EXPECT_TRUE(parse_url("memq://").target.empty());
  EXPECT_THROW(parse_url("udpm://?=1"), StartupError);
  EXPECT_THROW(parse_url("udpm://?a=1&&b=2"), StartupError);
}

/// Sets $LCM_DEFAULT_URL during its lifetime and then restores the previous value.
class DefaultUrl {
 public:
  explicit DefaultUrl(const char* url) {
    if (const char* const before = std::getenv(kName)) {
      before_ = before;
    }
    ::setenv(kName, url, 1);
  }
  ~DefaultUrl() {
    if (before_) {
      ::setenv(kName, before_->c_str(), 1);
    } else {
      ::unsetenv(kName);
    }
  }
  DefaultUrl(const DefaultUrl&) = delete;
  DefaultUrl& operator=(const DefaultUrl&) = delete;
  DefaultUrl(DefaultUrl&&) = delete;
  DefaultUrl& operator=(DefaultUrl&&) = delete;

 private:
  static constexpr const char* kName = "LCM_DEFAULT_URL";
  std::optional<std::string> before_;
};

TEST(OpenTransport, UsesTheUrlOfTheEnvironmentByDefault) {
  const DefaultUrl memory("memq://");
  EXPECT_NO_THROW(open_transport(""));
  EXPECT_THROW(open_transport("tcpq://localhost"), StartupError) << "an explicit URL has priority";
  const DefaultUrl unknown("tcpq://localhost");
  EXPECT_THROW(open_transport(""), StartupError);
  EXPECT_NO_THROW(open_transport("memq://"));
}

TEST(OpenTransport, RefusesUnknownSchemesAndMissingLogs) {
  EXPECT_THROW(open_transport("tcpq://localhost"), StartupError);
  EXPECT_THROW(open_transport("file:///nowhere/there/is/none?mode=r"), StartupError);
}

}  // namespace
}  // namespace vantage::bus
