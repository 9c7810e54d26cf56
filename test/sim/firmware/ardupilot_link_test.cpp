#include "sim/firmware/ardupilot_link.hpp"

#include <memory>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/address.hpp"
#include "core/check.hpp"
#include "wire/sitl/json_physics.hpp"

namespace vantage::sim {
namespace {

constexpr Duration kLong = std::chrono::seconds(5);

/// A link on a free port of this machine, and a firmware that sends to it.
class ArdupilotLinkTest : public testing::Test {
 protected:
  ArdupilotLinkTest() : fd_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    for (int instance = 100 + getpid() % 1000; !link; ++instance) {
      try {
        link = std::make_unique<ArdupilotLink>(instance);
        at_ = address_of(INADDR_LOOPBACK, wire::sitl::kJsonPort + 10 * instance);
      } catch (const StartupError&) {
      }
    }
  }
  ~ArdupilotLinkTest() override { close(fd_); }

  void transmit(std::uint16_t first_us, std::uint16_t others_us) {
    wire::sitl::ServoOutputs outputs;
    outputs.frame_rate_hz = 1200;
    outputs.frame_count = ++frames_;
    outputs.pulse_us.fill(others_us);
    outputs.pulse_us[0] = first_us;
    const auto bytes = wire::sitl::format_servo_outputs(outputs);
    ASSERT_EQ(sendto(fd_, bytes.data(), bytes.size(), 0, as_sockaddr(at_), sizeof at_),
              static_cast<ssize_t>(bytes.size()));
  }

  std::unique_ptr<ArdupilotLink> link;

 private:
  int fd_;
  sockaddr_in at_{};
  std::uint32_t frames_ = 0;
};

TEST_F(ArdupilotLinkTest, MapsPulsesOfOneToTwoMillisecondsToThrottle) {
  struct Row {
    std::uint16_t pulse_us;
    double throttle;
  };
  for (const Row row : {Row{1'000, 0.0}, Row{1'250, 0.25}, Row{1'500, 0.5}, Row{1'900, 0.9},
                        Row{2'000, 1.0}, Row{2'200, 1.0}, Row{900, 0.0}, Row{0, 0.0}}) {
    transmit(row.pulse_us, 1'750);
    const auto motors = link->receive(kLong);
    ASSERT_TRUE(motors) << row.pulse_us;
    EXPECT_DOUBLE_EQ(motors->throttles[0], row.throttle) << row.pulse_us;
    EXPECT_DOUBLE_EQ(motors->throttles[3], 0.75) << row.pulse_us;
  }
}

TEST_F(ArdupilotLinkTest, AnswersEachDatagramOnce) {
  EXPECT_FALSE(link->send({})) << "no firmware has sent a packet";
  for (int time = 0; time < 2; ++time) {
    transmit(1'000, 1'000);
    ASSERT_TRUE(link->receive(kLong));
    EXPECT_TRUE(link->send({}));
    EXPECT_FALSE(link->send({}));
  }
}

}  // namespace
}  // namespace vantage::sim
