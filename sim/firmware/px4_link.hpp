#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/firmware/firmware_link.hpp"
#include "wire/mavlink/parser.hpp"

namespace vantage::sim {

/// Link to PX4's simulator interface: sends HIL_SENSOR and receives HIL_ACTUATOR_CONTROLS, as
/// MAVLink on a byte stream. A PX4 process connects to a TCP port. Its clock is set by the
/// sensor messages, and it answers each HIL_SENSOR once (lockstep). A board with SYS_HITL set uses
/// a serial line or USB and its own clock; the link does not wait for its answers.
class Px4Link : public FirmwareLink {
 public:
  static constexpr int kPort = 4560;

  /// Creates the link for PX4 instance `instance` on this host: listens at 127.0.0.1, port 4560 +
  /// instance. The newest connection replaces the previous one, so restarted firmware can connect.
  /// @throws StartupError if the port cannot be opened.
  static std::unique_ptr<Px4Link> listening(int instance);
  /// Creates the link for a board at `line`: DEVICE or DEVICE:BAUD, by default 921600 baud (ignored
  /// over USB). The device may disconnect and reconnect.
  /// @throws StartupError for an unsupported baud rate.
  static std::unique_ptr<Px4Link> on_serial_line(const std::string& line);
  ~Px4Link() override;

  [[nodiscard]] Duration period() const override { return Duration{4'000}; }
  [[nodiscard]] bool is_lockstep() const override { return is_lockstep_; }
  bool send(const FirmwareSensors& sensors) override;
  /// Returns the newest motor command. In lockstep only the answer to the last sensor message is
  /// accepted; late answers to earlier messages are dropped. Throttles are 0 while the motors are
  /// not armed.
  std::optional<MotorCommand> receive(Duration timeout) override;

  /// Numbers of frames that could not be sent in time and of answers that were too late.
  struct Counts {
    std::int64_t unsent = 0;
    std::int64_t stale = 0;
  };
  [[nodiscard]] const Counts& counts() const { return counts_; }

 private:
  Px4Link(int listener, bool is_lockstep, std::function<int()> open);
  /// Writes as many of the waiting bytes as the line accepts; returns false if it accepts none.
  bool write_some();
  template <class Message>
  bool write(const Message& message);
  void hang_up();
  void connect();
  void read();
  void handle(const wire::mavlink::Frame& frame);

  int listener_;  ///< file descriptor; −1: none
  bool is_lockstep_;
  std::function<int()> open_;  ///< returns a new descriptor; −1: none
  int line_ = -1;
  wire::mavlink::Parser parser_;
  std::uint8_t sequence_ = 0;
  std::int64_t samples_ = 0;
  std::uint64_t last_sent_usec_ = 0;
  std::optional<MotorCommand> newest_;
  std::vector<std::uint8_t> waiting_;  ///< unsent bytes of a partly sent frame
  std::array<std::uint8_t, 2048> buffer_{};
  Counts counts_;
};

}  // namespace vantage::sim
