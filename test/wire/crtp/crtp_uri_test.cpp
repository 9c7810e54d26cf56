#include <array>

#include <gtest/gtest.h>

#include "wire/crtp/link_uri.hpp"

namespace vantage::wire::crtp {
namespace {

TEST(CrtpUri, ReadsRadioAndUdp) {
  const auto radio = parse_link_uri("radio://1/80/250K/E7E7E7E701");
  ASSERT_TRUE(radio.ok());
  const auto& on_air = std::get<RadioUri>(radio.value());
  EXPECT_EQ(on_air.dongle, 1);
  EXPECT_EQ(on_air.address, (RadioAddress{80, DataRate::k250Kbps, {0xE7, 0xE7, 0xE7, 0xE7, 0x01}}));
  const auto udp = parse_link_uri("udp://127.0.0.1:19850");
  ASSERT_TRUE(udp.ok());
  EXPECT_EQ(std::get<UdpUri>(udp.value()).host, "127.0.0.1");
  EXPECT_EQ(std::get<UdpUri>(udp.value()).port, 19850);
}

TEST(CrtpUri, RefusesIncompleteAddresses) {
  for (const char* bad :
       {"", "radio://", "radio://0/80/2M", "radio://0/126/2M/E7E7E7E7E7",
        "radio://16/80/2M/E7E7E7E7E7", "radio://0/80/3M/E7E7E7E7E7", "radio://0/80/2M/E7E7E7E7",
        "radio://0/80/2M/E7E7E7E7G7", "radio://0/80/2M/E7E7E7E7E7/", "radio://x/80/2M/E7E7E7E7E7",
        "radio://-1/80/2M/E7E7E7E7E7", "udp://", "udp://127.0.0.1", "udp://:19850", "udp://h:0",
        "usb://0", "tcp://h:1"}) {
    const auto uri = parse_link_uri(bad);
    EXPECT_FALSE(uri.ok()) << bad;
    if (!uri.ok()) {
      EXPECT_TRUE(uri.error().message.starts_with(bad)) << "the message states the address";
    }
  }
}

}  // namespace
}  // namespace vantage::wire::crtp
