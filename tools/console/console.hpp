#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bus/auth/authenticator.hpp"
#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "models/exchange/messages.hpp"
#include "tools/console/operator_input.hpp"
#include "tools/console/station.hpp"

namespace vantage::tools {

/// Options of an operator station.
struct StationOptions {
  /// true: wait as a standby while another station is in charge (Station)
  bool is_allowed_second = false;
  /// Authenticator of the bus, which must outlive the sender; nullptr: messages are not signed.
  const bus::auth::Authenticator* authenticator = nullptr;
};

/// Sender of operator commands (channel COMMAND): sends the orders that its station is permitted to
/// send. While the station is in charge it also sends the heartbeat, without which every vehicle
/// lands. The robots are those that publish VEHICLE_*.
///
/// Vehicles obey only recent commands, so commands are stamped in the vehicles' clock. The offset
/// of that clock is the smallest offset among the vehicle statuses of the last second; an offset up
/// to kApartMaxS counts as zero. An emergency stop is also stamped with this station's clock.
///
/// Vehicle statuses are refused as stale if the station's clock is wrong or a log is played. Then
/// hold, land and emergency stop are also sent with the clock of these statuses. A superfluous stop
/// does no harm.
///
/// Datagrams may get lost, so hold, land and emergency stop are sent kTransmissions times. The
/// first pause is kFirstPause, and each further pause is twice as long. The repetitions outlast a
/// burst of losses of 0.5 s. A repetition has the stamp of the first transmission. If no vehicle
/// status had been received before the first transmission, the repetition has a stamp in the
/// vehicles' clock. A later order to the same vehicles ends the repetition, so that `hold`,
/// `follow` ends with following. An order to one vehicle does not end the repetition of an
/// emergency stop of all vehicles.
class OrderSender {
 public:
  static constexpr double kHeartbeatPeriod_s = 0.2;
  static constexpr double kApartMaxS = 1.0;
  /// s; a vehicle without a status for this time is silent
  static constexpr double kSilentAfterS = 1.0;
  static constexpr double kLogReportS = 3.0;
  static constexpr std::size_t kVehiclesMax = 1024;
  /// s; vehicles with a status within this time are not evicted
  static constexpr double kKeptS = 3.0;
  static constexpr int kTransmissions = 5;
  static constexpr Duration kFirstPause = std::chrono::milliseconds(50);

  OrderSender(bus::Bus& bus, const StationOptions& options, Time start);
  OrderSender(const OrderSender&) = delete;
  OrderSender& operator=(const OrderSender&) = delete;
  OrderSender(OrderSender&&) = delete;
  OrderSender& operator=(OrderSender&&) = delete;
  ~OrderSender() = default;

  /// Sends the heartbeat and the repetitions that are due. Returns true if the station's role
  /// changed.
  bool tick(Time now);
  /// Sets whether an operator is present (initially true). Without an operator no heartbeat is
  /// sent. When an operator returns, the station first listens for other stations. Returns true on
  /// a change.
  bool set_attended(bool is_attended, Time now);
  /// Sends an order. Returns false and sends nothing if the station is not permitted to send it.
  bool send(Time now, models::OperatorAction action, const std::string& robot);
  /// True while repetitions are still to be sent.
  [[nodiscard]] bool is_repeating() const { return !repeating_.empty(); }
  /// True if other processes sign their messages and this station does not: vehicles that require
  /// signatures ignore it.
  [[nodiscard]] bool lacks_signature() const { return bus_.receives_signed(); }
  [[nodiscard]] const Station& station() const { return station_; }
  /// Returns the offset of the vehicles' clock from this station's clock; 0 if small or unknown.
  [[nodiscard]] Duration vehicles_ahead(Time now) const;
  [[nodiscard]] std::vector<std::string> robots() const;
  struct ReceivedStatus {
    models::VehicleStatus status;
    Time at{};
  };
  /// Returns the newest status of each vehicle.
  [[nodiscard]] const std::map<std::string, ReceivedStatus>& vehicles() const { return vehicles_; }
  /// Returns the reason why vehicles in their newest state will not obey an order, such as "no
  /// effect on Q1: not in operation; arm and take off first". Returns an empty string if all
  /// vehicles will obey, or if no status was received recently.
  [[nodiscard]] std::string without_effect(Time now, models::OperatorAction action,
                                           const std::string& robot) const;
  /// True if a process that records reported within kLogReportS that the log cannot be written.
  [[nodiscard]] bool is_log_lost(Time now) const;
  /// Returns a heading and one line per vehicle. Selected vehicles are marked. A vehicle without a
  /// status for 1 s is marked SILENT. Then come warnings about statuses refused as stale, unsigned
  /// commands and a log that is not written.
  [[nodiscard]] std::vector<std::string> vehicle_table(Time now, const std::string& selected) const;

 private:
  struct Order {
    models::OperatorAction action = models::OperatorAction::kHold;
    std::string robot;
    Time given{};
    std::optional<Duration> ahead;  ///< offset of the vehicles' clock; nullopt: unknown
    int sent = 0;
    Time next{};
  };
  [[nodiscard]] std::optional<Duration> ahead_of(Time now) const;
  void publish_order(const Order& order);
  void repeat(Time now);
  [[nodiscard]] static bool ends(const Order& later, const Order& earlier);
  void publish(Time stamp, models::OperatorAction action, const std::string& robot);
  /// Frees an entry for one more vehicle, if necessary by evicting the vehicle that has been silent
  /// longest. Returns false if no entry is free.
  bool make_room();

  static constexpr std::size_t kLogsMax = 64;  ///< maximum number of processes that report a log
  std::vector<Order> repeating_;
  bus::Bus& bus_;
  const bus::auth::Authenticator* authenticator_;
  Station station_;
  Time now_;
  Time next_heartbeat_{};
  bool is_attended_ = true;
  std::map<std::string, ReceivedStatus> vehicles_;
  std::map<std::string, Time>
      log_lost_;  ///< time of the last report of an unwritten log, by process
};

/// Runs the console on standard input and output until quit, end of input or `stop`. Orders go
/// through an OrderQueue. Each loop sends heartbeat and orders before it draws the screen, and
/// output never blocks (NonBlockingOutput). Returns false if a request was refused or could not be
/// parsed.
bool run_console(bus::Bus& bus, const bus::Clock& clock, const StationOptions& options,
                 const std::function<bool()>& stop);

}  // namespace vantage::tools
