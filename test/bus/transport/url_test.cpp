#include "bus/transport/url.hpp"

#include <gtest/gtest.h>

#include "bus/transport/transport.hpp"
#include "core/check.hpp"

namespace vantage::bus {
namespace {

TEST(ParseUrl, TakesAnUrlApart) {
  const Url url = parse_url("file:///tmp/a log?mode=r&speed=0");
  EXPECT_EQ(url.scheme, "file");
  EXPECT_EQ(url.target, "/tmp/a log");
  EXPECT_EQ(url.options, (std::map<std::string, std::string>{{"mode", "r"}, {"speed", "0"}}));
}

TEST(ParseUrl, RefusesWhatIsNotOne) {
  EXPECT_THROW(parse_url("239.255.76.67:7667"), StartupError);
  EXPECT_THROW(parse_url("://x"), StartupError);
  EXPECT_THROW(parse_url("udpm://?ttl"), StartupError);
  EXPECT_THROW(parse_url("udpm://?ttl=0&ttl=1"), StartupError);
}

TEST(ParseUdpm, FillsInWhatIsLeftOut) {
  const UdpmAddress plain = parse_udpm(parse_url("udpm://"));
  EXPECT_EQ(plain.group, "239.255.76.67");
  EXPECT_EQ(plain.port, 7667);
  EXPECT_EQ(plain.ttl, 0);
  EXPECT_EQ(plain.recv_buf_bytes, 4 << 20);
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

TEST(ParseUdpm, RefusesWhatItCannotDo) {
  for (const char* url :
       {"udpm://192.168.1.1:7667", "udpm://localhost:7667", "udpm://239.255.76.67:0",
        "udpm://239.255.76.67:70000", "udpm://239.255.76.67:76x", "udpm://?ttl=256",
        "udpm://?ttl=-1", "udpm://?ttl=", "udpm://?recv_buf_size=1", "udpm://?colour=red",
        "udpm://?interface=", "udpm://?interface=a/b", "udpm://?interface=sixteen-letters0"}) {
    EXPECT_THROW(parse_udpm(parse_url(url)), StartupError) << url;
  }
}

TEST(OpenTransport, RefusesUnknownSchemesAndMissingLogs) {
  EXPECT_THROW(open_transport("tcpq://localhost"), StartupError);
  EXPECT_THROW(open_transport("file:///nowhere/there/is/none?mode=r"), StartupError);
}

}  // namespace
}  // namespace vantage::bus
