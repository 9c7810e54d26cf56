#include "core/address.hpp"

#include <tuple>

#include <gtest/gtest.h>

#include "core/check.hpp"

namespace vantage {
namespace {

constexpr in_addr_t kDocumentation = 0xC0000207;  // 192.0.2.7

TEST(FindHost, ParsesNumericAddresses) {
  const Result<sockaddr_in> found = find_host("192.0.2.7", 14540);
  ASSERT_TRUE(found.ok());
  const sockaddr_in expected = address_of(kDocumentation, 14540);
  EXPECT_EQ(found.value().sin_family, AF_INET);
  EXPECT_EQ(found.value().sin_addr.s_addr, expected.sin_addr.s_addr);
  EXPECT_EQ(found.value().sin_port, expected.sin_port);
}

TEST(FindHost, ResolvesLocalhost) {
  EXPECT_EQ(require_host("localhost", 0).sin_addr.s_addr,
            address_of(INADDR_LOOPBACK, 0).sin_addr.s_addr);
}

// A host name contains no blank, so no DNS query is sent.
TEST(FindHost, NamesAnUnknownHostInItsError) {
  const Result<sockaddr_in> found = find_host("no such", 80);
  ASSERT_FALSE(found.ok());
  EXPECT_TRUE(found.error().message.starts_with("no such host: no such ("))
      << found.error().message;
  EXPECT_THROW(require_host("no such", 80), StartupError);
}

TEST(SplitAddress, SplitsAtTheLastColonAndRequiresAnIntegerPort) {
  for (const auto& [text, host, port] :
       {std::tuple{"localhost:1", "localhost", 1}, std::tuple{":65535", "", 65535},
        std::tuple{"fe80::1:14550", "fe80::1", 14550}}) {
    const Result<HostAndPort> parts = split_address(text);
    ASSERT_TRUE(parts.ok()) << text;
    EXPECT_EQ(parts.value().host, host);
    EXPECT_EQ(parts.value().port, port);
  }
  for (const char* text :
       {"", "localhost", "localhost:", "localhost:0", "localhost:65536", "localhost:-1",
        "localhost:14550x", "localhost: 14550", "localhost:99999999999"}) {
    ASSERT_FALSE(split_address(text).ok()) << text;
    EXPECT_EQ(split_address(text).error().message,
              "a port from 1 to 65535 is expected after the last ':'");
  }
}

TEST(AddressOf, UsesNetworkByteOrder) {
  const sockaddr_in address = address_of(kDocumentation, 0x1234);
  const auto* bytes = reinterpret_cast<const unsigned char*>(&address.sin_addr);
  EXPECT_EQ(bytes[0], 192);
  EXPECT_EQ(bytes[3], 7);
  EXPECT_EQ(reinterpret_cast<const unsigned char*>(&address.sin_port)[0], 0x12);
}

}  // namespace
}  // namespace vantage
