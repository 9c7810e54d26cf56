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

/// PX4's simulator interface: HIL_SENSOR there, HIL_ACTUATOR_CONTROLS back, as MAVLink on a stream
/// of bytes. PX4 in a process of its own is the client of a TCP port; its clock is that of the
/// sensors, and it answers each HIL_SENSOR once (lockstep). A board with SYS_HITL set speaks on a
/// serial line or USB, has a clock of its own and is not waited for.
class Px4Link : public FirmwareLink {
 public:
  static constexpr int kPort = 4560;

  /// For PX4 instance `instance` on this host: listens at 127.0.0.1, port 4560 + instance. The
  /// newest connection counts: a firmware that was started anew takes over.
  /// @throws StartupError when the port cannot be had.
  static std::unique_ptr<Px4Link> listening(int instance);
  /// For a board at `line`: DEVICE or DEVICE:BAUD, 921600 baud without one (over USB it means
  /// nothing). The device may come, go and come back.
  /// @throws StartupError for a baud rate that no line has.
  static std::unique_ptr<Px4Link> on_serial_line(const std::string& line);
  ~Px4Link() override;

  [[nodiscard]] Duration period() const override { return Duration{4'000}; }
  [[nodiscard]] bool is_lockstep() const override { return is_lockstep_; }
  bool send(const FirmwareSensors& sensors) override;
  /// In lockstep only what answers the sensors sent last: the motors of an earlier instant that
  /// come late are dropped. Motors that are not armed do not turn.
  std::optional<MotorCommand> receive(Duration timeout) override;

  /// Frames that the firmware did not take in time, and answers that came too late for theirs.
  struct Counts {
    std::int64_t unsent = 0;
    std::int64_t stale = 0;
  };
  [[nodiscard]] const Counts& counts() const { return counts_; }

 private:
  Px4Link(int listener, bool is_lockstep, std::function<int()> open);
  /// Of what waits, as much as the line takes; false when it takes nothing.
  bool write_some();
  template <class Message>
  bool write(const Message& message);
  void hang_up();
  void connect();
  void read();
  void hear(const wire::mavlink::Frame& frame);

  int listener_;  ///< −1: none
  bool is_lockstep_;
  std::function<int()> open_;  ///< a descriptor of a new line to the firmware; −1: there is none
  int line_ = -1;
  wire::mavlink::Parser parser_;
  std::uint8_t sequence_ = 0;
  std::int64_t samples_ = 0;
  std::uint64_t last_sent_usec_ = 0;
  std::optional<MotorCommand> newest_;
  std::vector<std::uint8_t> waiting_;  ///< of a frame that went out in part
  std::array<std::uint8_t, 2048> buffer_{};
  Counts counts_;
};

}  // namespace vantage::sim
