#include "drivers/crazyflie/radio_link.hpp"

#include <memory>

#include <gtest/gtest.h>

#include "drivers/crazyflie/radio_port.hpp"
#include "test/drivers/crazyflie/emulated_radio.hpp"

namespace vantage::test {
namespace {

using drivers::RadioDongle;
using drivers::RadioLink;
using wire::crtp::DataRate;
using wire::crtp::RadioAddress;

class CrazyflieRadio : public ::testing::Test {
 protected:
  static RadioAddress address(int channel, std::uint8_t last) {
    return {channel, DataRate::k2Mbps, {0xE7, 0xE7, 0xE7, 0xE7, last}};
  }
  EmulatedPeer& peer(const RadioAddress& at) { return air.peers[{at.channel, at.address}]; }
  void exchange(int count) {
    for (int i = 0; i < count; ++i) {
      now += Duration{1'000};
      dongle.exchange(now);
    }
  }
  /// Returns packet number `i` of a service that must not lose packets.
  static RadioBytes numbered(int i) {
    return {0x2C, static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i >> 8)};
  }
  static std::vector<RadioBytes> read_all(RadioLink& link) {
    std::vector<RadioBytes> out;
    while (auto packet = link.read()) {
      if ((packet->front() & 0xF3U) != 0xF3U) {
        packet->front() |= 0x0CU;
        out.push_back(*packet);
      }
    }
    return out;
  }

  EmulatedRadio::Air air;
  RadioDongle dongle{std::make_unique<EmulatedRadio>(air)};
  Time now = from_utime(1'700'000'000'000'000);
};

TEST_F(CrazyflieRadio, SafeLinkDeliversEachPacketOnceInOrder) {
  for (const double loss : {0.0, 0.05, 0.2, 0.6}) {
    const RadioAddress at = address(80, static_cast<std::uint8_t>(100.0 * loss));
    RadioLink link(at);
    RadioDongle own(std::make_unique<EmulatedRadio>(air));
    own.add(link);
    EmulatedPeer& vehicle = peer(at);
    air.loss = 0.0;
    for (int i = 0; i < 3; ++i) {
      own.exchange(now += Duration{1'000});
    }
    ASSERT_TRUE(link.has_safe_link());
    air.loss = loss;
    std::vector<RadioBytes> up;
    std::vector<RadioBytes> down;
    std::vector<RadioBytes> got;
    for (int i = 0; i < 300; ++i) {
      up.push_back(numbered(i));
      down.push_back(numbered(1000 + i));
      link.write(up.back(), now);
      vehicle.to_send.push_back(down.back());
      for (int k = 0; k < 8; ++k) {
        own.exchange(now += Duration{1'000});
      }
      for (const RadioBytes& each : read_all(link)) {
        got.push_back(each);
      }
    }
    air.loss = 0.0;
    for (int k = 0; k < 200; ++k) {
      own.exchange(now += Duration{1'000});
    }
    for (const RadioBytes& each : read_all(link)) {
      got.push_back(each);
    }
    EXPECT_EQ(vehicle.received, up) << loss;
    EXPECT_EQ(got, down) << loss;
    EXPECT_EQ(link.counts().dropped, 0);
    EXPECT_EQ(link.counts().lost == 0, loss < 0.1) << link.counts().lost;
  }
}

TEST_F(CrazyflieRadio, WorksWithoutSafeLink) {
  const RadioAddress at = address(80, 1);
  RadioLink link(at);
  peer(at).offers_safe_link = false;
  dongle.add(link);
  exchange(12);
  EXPECT_FALSE(link.has_safe_link());
  link.write(numbered(1), now);
  exchange(1);
  EXPECT_EQ(peer(at).received, std::vector<RadioBytes>{numbered(1)});
}

TEST_F(CrazyflieRadio, SeveralVehiclesShareADongle) {
  std::vector<std::unique_ptr<RadioLink>> links;
  for (std::uint8_t i = 0; i < 4; ++i) {
    links.push_back(std::make_unique<RadioLink>(address(80 + i % 2, i)));
    peer(links.back()->address());
    dongle.add(*links.back());
  }
  exchange(8);
  for (int i = 0; i < 4; ++i) {
    links[static_cast<std::size_t>(i)]->write(numbered(i), now);
  }
  exchange(4);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(peer(links[static_cast<std::size_t>(i)]->address()).received,
              std::vector<RadioBytes>{numbered(i)});
  }
}

TEST_F(CrazyflieRadio, TunesOnlyWhenTheVehicleChanges) {
  const RadioAddress at = address(80, 1);
  RadioLink link(at);
  peer(at);
  dongle.add(link);
  exchange(1);
  const int before = air.settings;
  exchange(50);
  EXPECT_EQ(air.settings, before);
}

TEST_F(CrazyflieRadio, ContinuesWhenTheDongleIsReconnected) {
  const RadioAddress at = address(80, 1);
  RadioLink link(at);
  peer(at);
  dongle.add(link);
  exchange(5);
  air.is_plugged = false;
  link.write(numbered(1), now);
  exchange(1000);
  EXPECT_TRUE(peer(at).received.empty());
  air.is_plugged = true;
  exchange(300);
  EXPECT_EQ(peer(at).received, std::vector<RadioBytes>{numbered(1)});
  EXPECT_EQ(dongle.opened(), 2);
}

TEST_F(CrazyflieRadio, FindsSafeLinkAgainAfterTheVehicleRestarts) {
  const RadioAddress at = address(80, 1);
  RadioLink link(at);
  peer(at);
  dongle.add(link);
  exchange(5);
  ASSERT_TRUE(link.has_safe_link());
  air.peers.clear();
  exchange(300);
  EXPECT_FALSE(link.has_safe_link());
  peer(at);
  exchange(20);
  link.write(numbered(7), now);
  exchange(120);
  EXPECT_FALSE(peer(at).received.empty());
}

// A set-point that is too old is not sent, and a new set-point replaces a waiting one. "Set-points
// end" must be sent after the last set-point.
TEST_F(CrazyflieRadio, SendsOnlyTheNewestSetpoint) {
  const RadioAddress at = address(80, 1);
  RadioLink link(at);
  peer(at);
  dongle.add(link);
  exchange(5);
  const RadioBytes first{0x7C, 7, 1};
  const RadioBytes second{0x7C, 7, 2};
  const RadioBytes end{0x7D, 0, 0, 0, 0, 0};
  link.write(first, now);
  link.write(second, now);
  link.write(end, now);
  exchange(10);
  EXPECT_EQ(peer(at).received, (std::vector<RadioBytes>{second, end}));
  air.is_plugged = false;
  link.write(first, now);
  exchange(300);
  air.is_plugged = true;
  exchange(300);
  EXPECT_EQ(peer(at).received.size(), 2U) << "the old set-point was dropped";
}

TEST_F(CrazyflieRadio, BroadcastsWithoutAcknowledgement) {
  const RadioAddress at = address(80, 1);
  RadioLink link(at);
  peer(at);
  dongle.add(link);
  exchange(5);
  const RadioBytes stop{0x9D, 3};
  EXPECT_TRUE(dongle.broadcast(at, stop));
  EXPECT_EQ(air.broadcasts, std::vector<RadioBytes>{stop});
  link.write(numbered(1), now);
  exchange(2);
  EXPECT_EQ(peer(at).received, std::vector<RadioBytes>{numbered(1)});
}

TEST_F(CrazyflieRadio, PortReportsLossAndLatency) {
  const RadioAddress at = address(80, 1);
  peer(at);
  const auto port = drivers::open_radio_port(std::make_unique<EmulatedRadio>(air), at);
  const RadioBytes packet = numbered(5);
  port->write(packet, now);
  std::array<std::uint8_t, 64> buffer{};
  bool is_reported = false;
  // The number of reads is bounded; the port's thread answers within milliseconds.
  for (int i = 0; i < 10'000'000 && !is_reported; ++i) {
    static_cast<void>(port->read(buffer, now));
    const auto counts = port->counters();
    is_reported = std::ranges::any_of(
        counts, [](const models::NamedCount& each) { return each.name == "radio.latency_p50_us"; });
  }
  EXPECT_TRUE(is_reported);
}

}  // namespace
}  // namespace vantage::test
