#pragma once

#include <cstdint>
#include <optional>

#include "core/time.hpp"

namespace vantage {

/// Flight state of a driver's vehicle (in the air or moving), as far as the driver knows.
enum class InFlight { kUnknown, kNo, kYes };

/// Write end of the pipe by which a process shows its supervisor that the process is alive. Writes
/// one byte per kPeriod, and one when the flight state changes; at most one byte per loop. The byte
/// contains the flight state. Writing never blocks.
class LivenessSender {
 public:
  static constexpr Duration kPeriod = std::chrono::milliseconds(100);
  /// Environment variable that contains the number of the descriptor to write to.
  static constexpr const char* kDescriptorVariable = "VANTAGE_LIFE_FD";

  /// Uses the descriptor named in the environment. If none is named, nothing is written.
  LivenessSender();
  /// Uses `descriptor` and closes it in the destructor.
  explicit LivenessSender(int descriptor) : descriptor_(descriptor) {}
  ~LivenessSender();
  LivenessSender(const LivenessSender&) = delete;
  LivenessSender& operator=(const LivenessSender&) = delete;
  LivenessSender(LivenessSender&&) = delete;
  LivenessSender& operator=(LivenessSender&&) = delete;

  /// Must be called in each loop. Writes when kPeriod has passed since the last byte, or when
  /// `in_flight` has changed.
  void on_loop(Time now, InFlight in_flight);

 private:
  int descriptor_;
  std::optional<Time> last_;
  InFlight sent_ = InFlight::kUnknown;
};

/// Supervisor end of the pipe of a LivenessSender, one for each start of a process.
class LivenessReceiver {
 public:
  LivenessReceiver() = default;
  ~LivenessReceiver();
  LivenessReceiver(const LivenessReceiver&) = delete;
  LivenessReceiver& operator=(const LivenessReceiver&) = delete;
  LivenessReceiver(LivenessReceiver&& other) noexcept;
  LivenessReceiver& operator=(LivenessReceiver&& other) noexcept;

  /// Opens a new pipe. Both ends are non-blocking and closed by exec. Returns false if the system
  /// cannot open a pipe.
  [[nodiscard]] bool open();
  /// Returns the write end, for the child process; −1 after close_child_end().
  [[nodiscard]] int child_end() const { return write_; }
  /// Closes the write end in the supervisor. Only the child process then has the write end open.
  void close_child_end();

  /// Content of the bytes received since the last call of take().
  struct Report {
    bool any = false;
    InFlight in_flight = InFlight::kUnknown;  ///< newest known flight state; kUnknown if none
  };
  [[nodiscard]] Report take();

 private:
  void close_all();
  int read_ = -1;
  int write_ = -1;
};

}  // namespace vantage
