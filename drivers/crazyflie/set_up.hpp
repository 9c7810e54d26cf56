#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "drivers/crazyflie/table_fetch.hpp"
#include "drivers/crazyflie/telemetry.hpp"
#include "wire/crtp/tables.hpp"

namespace vantage::drivers {

/// Set-up of a connected Crazyflie: writes the parameters that a flight requires, and starts the
/// log blocks. One request is under way at a time; it is repeated until the vehicle answers.
class CrazyflieSetUp {
 public:
  /// Begins the set-up.
  /// @param writes_parameters  false while the vehicle flies: then only the log is started
  /// @param start pose on the ground, from which the estimate restarts; absent: it restarts from
  ///   the origin
  void begin(const TableFetch& parameters, const TableFetch& logs, bool writes_parameters,
             const std::optional<Pose3>& start);
  /// Processes a packet of the vehicle.
  void receive(const wire::crtp::Packet& packet);
  /// Returns the request that is due.
  std::optional<wire::crtp::Packet> tick(Time now);

  [[nodiscard]] bool is_done() const { return steps_.size() == done_ && !fault_; }
  /// Returns the reason why the vehicle cannot be used; nullopt if it can be used or the set-up is
  /// not finished.
  [[nodiscard]] const std::optional<std::string>& fault() const { return fault_; }
  [[nodiscard]] bool has_battery() const { return has_battery_; }

 private:
  struct Step {
    wire::crtp::Packet request;
    std::string name;
  };
  void add_parameter(const TableFetch& table, const char* name, double value);
  void add_block(const TableFetch& table, std::uint8_t block);
  void finish_step() {
    ++done_;
    next_ = Time{};
  }

  std::vector<Step> steps_;
  std::size_t done_ = 0;
  Time next_{};
  bool has_battery_ = false;
  std::optional<std::string> fault_;
};

}  // namespace vantage::drivers
