#pragma once

#include <cstdint>
#include <optional>

#include "core/time.hpp"

namespace vantage {

/// Whether the vehicle of a driver may be in the air or move, as far as the driver knows.
enum class InFlight { kUnknown, kNo, kYes };

/// The end of the pipe by which a process shows its supervisor that it runs. One byte per loop, at
/// most every kPeriod; the byte also contains what the process knows of its vehicle. Never waits.
class LifeSign {
 public:
  static constexpr Duration kPeriod = std::chrono::milliseconds(100);
  /// Environment variable: the number of the descriptor to write to.
  static constexpr const char* kHandedOn = "VANTAGE_LIFE_FD";

  /// Takes the descriptor that the environment names; without one nothing is written.
  LifeSign();
  /// Writes to `descriptor` and closes it at the end.
  explicit LifeSign(int descriptor) : descriptor_(descriptor) {}
  ~LifeSign();
  LifeSign(const LifeSign&) = delete;
  LifeSign& operator=(const LifeSign&) = delete;
  LifeSign(LifeSign&&) = delete;
  LifeSign& operator=(LifeSign&&) = delete;

  /// To be called in each loop: writes when kPeriod has passed since the last sign, or when
  /// `in_flight` differs from the last one.
  void on_loop(Time now, InFlight in_flight);

 private:
  int descriptor_;
  std::optional<Time> last_;
  InFlight said_ = InFlight::kUnknown;
};

/// The supervisor's end of that pipe, one for each start of a process.
class LifeLine {
 public:
  LifeLine() = default;
  ~LifeLine();
  LifeLine(const LifeLine&) = delete;
  LifeLine& operator=(const LifeLine&) = delete;
  LifeLine(LifeLine&& other) noexcept;
  LifeLine& operator=(LifeLine&& other) noexcept;

  /// Opens a new pipe; both ends are closed by exec and never wait. False when the system has none.
  [[nodiscard]] bool open();
  /// The end for the process; −1 once it is closed here.
  [[nodiscard]] int child_end() const { return write_; }
  /// Closes the end of the process here, so that it alone has it.
  void close_child_end();

  /// The signs that have come since the last call.
  struct Signs {
    bool any = false;
    InFlight in_flight = InFlight::kUnknown;  ///< the newest that is known; else kUnknown
  };
  [[nodiscard]] Signs take();

 private:
  void close_all();
  int read_ = -1;
  int write_ = -1;
};

}  // namespace vantage
