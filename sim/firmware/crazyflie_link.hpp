#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include <netinet/in.h>

#include "core/deadline.hpp"
#include "sim/firmware/firmware_link.hpp"

namespace vantage::sim {

/// Returns the body of a Crazyflie 2.1: 27 g, motors 46 mm from the centre, and the thrust that its
/// firmware expects.
MultirotorParameters crazyflie_body();
/// Returns the errors of a Crazyflie's sensors.
SensorNoise crazyflie_noise();

/// Link to Crazyflie firmware compiled for a computer (wire/sitl). The firmware uses its own clock
/// and sends its answers to the last sender, so it communicates only with this link. The link
/// relays the packets between the firmware and one client, the newest that sent a packet.
class CrazyflieLink : public FirmwareLink {
 public:
  /// Ports on this host, 127.0.0.1.
  struct Ports {
    int firmware = 0;  ///< port to which the firmware sends its first packet
    int client = 0;
  };
  /// Returns the ports of `instance`: firmware 19950 + instance, client 19850 + instance.
  static Ports ports_of(int instance);

  using Clock = std::function<std::int64_t()>;

  /// @param clock  returns ns of a monotonic clock
  /// @throws StartupError if a port cannot be opened.
  explicit CrazyflieLink(const Ports& ports, Clock clock = monotonic_ns);
  ~CrazyflieLink() override;

  [[nodiscard]] Duration period() const override { return Duration{1'000}; }
  [[nodiscard]] bool is_lockstep() const override { return false; }
  /// Sends the sample unless the previous one was sent less than half a period ago. The firmware
  /// queues only 5 packets. If a late simulator sends many samples at once, the queue is full, and
  /// packets from the client (the driver) are lost.
  bool send(const FirmwareSensors& sensors) override;
  /// Relays all packets of the firmware, and one of the client per period; returns the newest motor
  /// command.
  std::optional<MotorCommand> receive(Duration timeout) override;
  [[nodiscard]] std::int64_t dropped() const override {
    return counts_.forged + counts_.bad_length + counts_.no_peer + counts_.unsent;
  }

  /// Counts of packets, of datagrams that were dropped, and of samples that were not sent.
  struct Counts {
    std::int64_t hellos = 0;       ///< answered hellos of the firmware, at least one per start
    std::int64_t to_firmware = 0;  ///< packets of the client for the firmware
    std::int64_t to_client = 0;
    std::int64_t forged = 0;      ///< packets of a client on the simulator's port
    std::int64_t bad_length = 0;  ///< datagrams with no bytes or more than 31
    std::int64_t no_peer = 0;     ///< datagrams for a peer that has not sent a packet yet
    std::int64_t unsent = 0;      ///< datagrams that the system refused to send
    std::int64_t crowded = 0;     ///< samples that followed the previous one too closely
  };
  [[nodiscard]] const Counts& counts() const { return counts_; }

 private:
  using Bytes = std::span<const std::uint8_t>;
  std::optional<Bytes> read(int fd, sockaddr_in& from);
  bool write(int fd, const std::optional<sockaddr_in>& to, Bytes packet);
  void relay_client();
  void relay_firmware(std::optional<MotorCommand>& newest);

  int firmware_fd_ = -1;
  int client_fd_ = -1;
  std::optional<sockaddr_in> firmware_;
  std::optional<sockaddr_in> client_;
  Clock clock_;
  std::int64_t sampled_ns_ = 0;  ///< time of the last sample
  std::int64_t relayed_ns_ = 0;  ///< time of the last packet of the client
  std::int64_t samples_ = 0;
  std::array<std::uint8_t, 64> buffer_{};
  Counts counts_;
};

}  // namespace vantage::sim
