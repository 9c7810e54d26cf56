// Tests the link between the simulator and Crazyflie firmware, with the bytes of one session of the
// real firmware (test/data/crazyflie/link_session.txt).

#include "sim/firmware/crazyflie_link.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/address.hpp"
#include "core/axes.hpp"
#include "core/check.hpp"
#include "test/support/free_port.hpp"

namespace vantage::sim {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr Duration kLong = std::chrono::seconds(5);

/// Socket of a firmware or a client on this host.
class Peer {
 public:
  Peer() {
    const sockaddr_in any = address_of(INADDR_LOOPBACK, 0);
    EXPECT_EQ(bind(fd_, as_sockaddr(any), sizeof any), 0);
  }
  ~Peer() { close(fd_); }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;
  Peer(Peer&&) = delete;
  Peer& operator=(Peer&&) = delete;
  void send(int port, const Bytes& bytes) const {
    const sockaddr_in to = address_of(INADDR_LOOPBACK, port);
    ASSERT_EQ(sendto(fd_, bytes.data(), bytes.size(), 0, as_sockaddr(to), sizeof to),
              static_cast<ssize_t>(bytes.size()));
  }
  /// Returns the waiting packets; on this host they arrive before sendto() returns.
  [[nodiscard]] std::vector<Bytes> received() const {
    std::vector<Bytes> out;
    std::array<std::uint8_t, 64> buffer{};
    ssize_t got = 0;
    while ((got = recv(fd_, buffer.data(), buffer.size(), MSG_DONTWAIT)) >= 0) {
      out.emplace_back(buffer.begin(), buffer.begin() + got);
    }
    return out;
  }

 private:
  int fd_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
};

class CrazyflieLinkTest : public testing::Test {
 protected:
  CrazyflieLinkTest() {
    ports = {test::free_port(), test::free_port()};
    link = std::make_unique<CrazyflieLink>(ports, [this] { return now_ns += step_ns; });
  }
  void connect() {
    firmware.send(ports.firmware, {0xF3});
    EXPECT_FALSE(link->receive(kLong));
    ASSERT_EQ(firmware.received(), (std::vector<Bytes>{{0xF3}}));
  }

  std::int64_t now_ns = 0;
  std::int64_t step_ns = 1'000'000;  ///< ns; time that passes with each reading of the clock
  CrazyflieLink::Ports ports;
  std::unique_ptr<CrazyflieLink> link;
  Peer firmware;
  Peer client;
};

TEST_F(CrazyflieLinkTest, SendsSensorsOnlyAfterTheFirmwaresHello) {
  EXPECT_FALSE(link->send({}));
  connect();
  EXPECT_TRUE(link->send({}));
  const auto packets = firmware.received();
  ASSERT_EQ(packets.size(), 2U);
  EXPECT_EQ(packets[0].size(), 14U);
  EXPECT_EQ(packets[1].size(), 8U) << "the magnetometer follows the first sample";
}

// At rest the firmware's body axes (x forward, y left, z up) measure + 1 g along z.
TEST_F(CrazyflieLinkTest, EncodesSensorsInTheFirmwaresAxesAndUnits) {
  connect();
  FirmwareSensors sensors;
  sensors.specific_force_body_mps2 = convert_axes(Eigen::Vector3d(0.0, 4.905, 9.81));
  sensors.gyro_body_radps = convert_axes(Eigen::Vector3d(std::acos(-1.0) / 180.0, 0.0, -100.0));
  sensors.magnetic_field_body_gauss = convert_axes(Eigen::Vector3d(0.3, -0.3, 0.0));
  ASSERT_TRUE(link->send(sensors));
  const auto packets = firmware.received();
  ASSERT_EQ(packets.size(), 2U);
  // 1 g = 2048, 1 °/s = 16.384, and 100 rad/s saturates.
  EXPECT_EQ(packets[0], (Bytes{0xE0, 0, 0, 0, 0, 4, 0, 8, 16, 0, 0, 0, 0, 0x80}));
  EXPECT_EQ(packets[1], (Bytes{0xE0, 1, 200, 0, 0x38, 0xFF, 0, 0}));
}

TEST_F(CrazyflieLinkTest, SendsMagnetometerAndBarometerInTurnAt50Hz) {
  connect();
  std::vector<std::size_t> kinds(3, 0);
  for (int ms = 0; ms < 100; ++ms) {
    ASSERT_TRUE(link->send({}));
    for (const Bytes& packet : firmware.received()) {
      ++kinds.at(packet.at(1));
    }
  }
  EXPECT_EQ(kinds, (std::vector<std::size_t>{100, 5, 5}));
  EXPECT_EQ(link->period(), Duration{1'000});
  EXPECT_FALSE(link->is_lockstep());
}

// Motors M1 to M4 are front right, rear right, rear left and front left. Throttles have the order
// front right, rear left, front left, rear right.
TEST_F(CrazyflieLinkTest, ReturnsTheNewestDutyCycleOfEachMotor) {
  connect();
  EXPECT_FALSE(link->receive(Duration{0}));
  firmware.send(ports.firmware, {0xE0, 9, 9, 9, 9, 9, 9, 9, 9});
  firmware.send(ports.firmware, {0xE0, 0xFF, 0xFF, 0x33, 0x33, 0x66, 0x66, 0, 0});
  const auto motors = link->receive(kLong);
  ASSERT_TRUE(motors);
  EXPECT_EQ(motors->throttles, (Throttles{1.0, 0.4, 0.0, 0.2}));
  EXPECT_FALSE(link->receive(Duration{0}));
}

TEST_F(CrazyflieLinkTest, RelaysBetweenFirmwareAndNewestClient) {
  const Peer second;
  client.send(ports.client, {0xDD, 0x00});
  EXPECT_FALSE(link->receive(kLong));
  EXPECT_EQ(link->counts().no_peer, 1) << "no firmware has started";
  connect();
  for (const Peer* peer : std::array<const Peer*, 3>{&client, &second, &client}) {
    peer->send(ports.client, {0xDD, 0x00});
    EXPECT_FALSE(link->receive(kLong));
    EXPECT_EQ(firmware.received(), (std::vector<Bytes>{{0xDD, 0x00}}));
    firmware.send(ports.firmware, {0xD1, 0x00, 12, 0, 0, 0});
    EXPECT_FALSE(link->receive(kLong));
    EXPECT_EQ(peer->received(), (std::vector<Bytes>{{0xD1, 0x00, 12, 0, 0, 0}}));
  }
  EXPECT_TRUE(second.received().empty());
  EXPECT_EQ(link->counts().to_firmware, 3);
  EXPECT_EQ(link->counts().to_client, 3);
}

// The firmware's own messages to the simulator do not reach a client, and a client cannot send
// sensor values.
TEST_F(CrazyflieLinkTest, DropsAndCountsPacketsThatItMustNotRelay) {
  connect();
  client.send(ports.client, {0xEC, 0, 1, 2, 3});
  client.send(ports.client, {});
  client.send(ports.client, Bytes(32, 0x6D));
  client.send(ports.client, Bytes(31, 0x6D));
  EXPECT_FALSE(link->receive(kLong));
  EXPECT_EQ(firmware.received(), (std::vector<Bytes>{Bytes(31, 0x6D)}));
  EXPECT_EQ(link->counts().forged, 1);
  EXPECT_EQ(link->counts().bad_length, 2);
  EXPECT_EQ(link->dropped(), 3);
  firmware.send(ports.firmware, {0xE0, 0x01});
  firmware.send(ports.firmware, {0xE0, 0, 0, 0, 0, 0, 0, 0});  // a byte short
  EXPECT_FALSE(link->receive(kLong));
  EXPECT_TRUE(client.received().empty());
}

// The firmware has room for 5 packets. A late simulator does not send all missed samples at once.
TEST_F(CrazyflieLinkTest, SkipsSamplesThatFollowTooClosely) {
  connect();
  step_ns = 0;
  now_ns += 1'000'000;
  ASSERT_TRUE(link->send({}));
  EXPECT_FALSE(link->send({}));
  now_ns += 499'999;
  EXPECT_FALSE(link->send({}));
  EXPECT_EQ(firmware.received().size(), 2U) << "one sample and the magnetometer";
  EXPECT_EQ(link->counts().crowded, 2);
  now_ns += 1;
  EXPECT_TRUE(link->send({}));
  EXPECT_EQ(firmware.received().size(), 1U);
}

TEST_F(CrazyflieLinkTest, RelaysOnePacketOfTheClientPerMillisecond) {
  connect();
  step_ns = 0;
  now_ns += 1'000'000;
  for (std::uint8_t k = 0; k < 3; ++k) {
    client.send(ports.client, {0xFC, k});
  }
  for (std::uint8_t k = 0; k < 3; ++k) {
    EXPECT_FALSE(link->receive(Duration{0}));
    EXPECT_FALSE(link->receive(Duration{0}));
    EXPECT_EQ(firmware.received(), (std::vector<Bytes>{{0xFC, k}}));
    now_ns += 1'000'000;
  }
  EXPECT_EQ(link->dropped(), 0);
}

TEST_F(CrazyflieLinkTest, FollowsRestartedFirmware) {
  connect();
  const Peer restarted;
  restarted.send(ports.firmware, {0xF3});
  EXPECT_FALSE(link->receive(kLong));
  EXPECT_EQ(restarted.received(), (std::vector<Bytes>{{0xF3}}));
  ASSERT_TRUE(link->send({}));
  EXPECT_FALSE(restarted.received().empty());
  EXPECT_TRUE(firmware.received().empty());
  EXPECT_EQ(link->counts().hellos, 2);
}

TEST_F(CrazyflieLinkTest, ReportsUnavailablePort) {
  for (const CrazyflieLink::Ports taken : {CrazyflieLink::Ports{ports.firmware, ports.firmware},
                                           CrazyflieLink::Ports{ports.client, 0}}) {
    try {
      const CrazyflieLink second(taken);
      FAIL();
    } catch (const StartupError& error) {
      EXPECT_EQ(std::string(error.what()), "crazyflie firmware: UDP port " +
                                               std::to_string(taken.firmware) +
                                               " on this host: Address already in use");
    }
  }
}

/// Packet of a recorded session.
struct Recorded {
  int ms = 0;
  char from = ' ';  ///< c client, f firmware
  Bytes bytes;
};
std::vector<Recorded> recorded_session() {
  std::vector<Recorded> out;
  std::ifstream file(VANTAGE_SOURCE_DIR "/test/data/crazyflie/link_session.txt");
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line.substr(0, line.find('#')));
    Recorded packet;
    std::string hex;
    if (words >> packet.ms >> packet.from >> hex) {
      for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
        packet.bytes.push_back(static_cast<std::uint8_t>(std::stoi(hex.substr(i, 2), nullptr, 16)));
      }
      out.push_back(packet);
    }
  }
  return out;
}

// The recorded firmware takes off to 0.5 m and lands. The client receives all its answers, and the
// simulator all motor commands.
TEST_F(CrazyflieLinkTest, SeparatesAnswersAndMotorCommandsOfARecordedSession) {
  const std::vector<Recorded> session = recorded_session();
  ASSERT_GT(session.size(), 100U);
  int motors = 0;
  double greatest = 0.0;
  std::vector<Bytes> expected_at_client;
  for (const Recorded& packet : session) {
    (packet.from == 'c' ? client : firmware)
        .send(packet.from == 'c' ? ports.client : ports.firmware, packet.bytes);
    const auto command = link->receive(kLong);
    const bool is_motors =
        packet.from == 'f' && packet.bytes.size() == 9 && packet.bytes[0] == 0xE0;
    ASSERT_EQ(command.has_value(), is_motors) << packet.ms;
    if (command) {
      ++motors;
      greatest = std::max(greatest, command->throttles[0]);
    } else if (packet.from == 'c') {
      EXPECT_EQ(firmware.received(), (std::vector<Bytes>{packet.bytes})) << packet.ms;
    } else if (packet.bytes == Bytes{0xF3}) {
      EXPECT_EQ(firmware.received(), (std::vector<Bytes>{{0xF3}}));
    } else if (packet.bytes[0] >> 4 != 14) {
      expected_at_client.push_back(packet.bytes);
    }
  }
  EXPECT_EQ(client.received(), expected_at_client);
  EXPECT_GT(expected_at_client.size(), 10U);
  EXPECT_GT(motors, 20);
  EXPECT_GT(greatest, 0.5);
  EXPECT_LT(greatest, 1.0);
  EXPECT_EQ(link->dropped(), 0);
}

// Four motors carry 27 g at the duty cycle that the firmware's thrust curve gives.
TEST(CrazyflieBody, HoversAtTheDutyCycleOfTheFirmwaresThrustCurve) {
  const MultirotorParameters body = crazyflie_body();
  const double per_motor_n = body.mass_kg * 9.81 / 4.0;
  const double e = body.thrust_expo;
  const double t = per_motor_n / body.motor_thrust_max_n;
  const double duty = (-(1.0 - e) + std::sqrt((1.0 - e) * (1.0 - e) + 4.0 * e * t)) / (2.0 * e);
  EXPECT_NEAR(0.09149 * duty * duty + 0.06767 * duty, per_motor_n, 1e-12);
  constexpr double kRecordedHover = 36'600.0 / 65'535.0;  // link_session.txt, 6.5 to 8.5 s
  EXPECT_NEAR(duty, kRecordedHover, 0.005);
  EXPECT_NEAR(std::hypot(body.arm_x_m, body.arm_y_m), 0.046, 1e-12);
}

}  // namespace
}  // namespace vantage::sim
