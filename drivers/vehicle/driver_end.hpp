#pragma once

#include <optional>
#include <string>

#include "core/liveness.hpp"
#include "core/time.hpp"

namespace vantage::drivers {

/// State of a vehicle after its driver was requested to end.
struct EndFacts {
  InFlight in_flight = InFlight::kUnknown;  ///< kNo: vehicle stationary, motors off
  bool is_pilots = false;                   ///< a pilot controls the vehicle
  bool lands_itself = false;                ///< the autopilot has confirmed its landing mode
};

/// State machine that decides when a driver may end after a request. The driver may end once its
/// vehicle is stationary with motors off. After a second request it may also end once the autopilot
/// has confirmed its own landing mode. Both waits are bounded. Pure.
class DriverEnd {
 public:
  /// Time for which a new driver waits for a message of its vehicle before it ends.
  static constexpr Duration kSearch = std::chrono::seconds(3);
  /// Time for the autopilot's confirmation after a second request.
  static constexpr Duration kHurry = std::chrono::seconds(3);

  /// @param landing  time for the vehicle to stop; afterwards the driver continues as after a
  /// second request
  DriverEnd(Time started, Duration landing) : started_(started), landing_(landing) {}

  /// Reports that the driver received a request to end; `requests` is the number of requests.
  void request(int requests, Time now);
  /// Updates the decision. Call it in each loop after a request.
  void step(const EndFacts& facts, Time now);

  [[nodiscard]] bool is_hurried() const { return hurried_at_.has_value(); }
  [[nodiscard]] bool may_end() const { return may_end_; }
  /// Returns a text about the actions that failed before the end; empty if none failed or the
  /// driver may not end yet.
  [[nodiscard]] const std::string& fault() const { return fault_; }

 private:
  void end(const char* fault = "") {
    may_end_ = true;
    fault_ = fault;
  }

  Time started_;
  Duration landing_;
  std::optional<Time> requested_at_;
  std::optional<Time> hurried_at_;
  bool may_end_ = false;
  std::string fault_;
};

}  // namespace vantage::drivers
