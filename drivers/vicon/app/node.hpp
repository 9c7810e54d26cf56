#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/node.hpp"
#include "core/latency_record.hpp"
#include "core/time.hpp"
#include "drivers/vicon/driver.hpp"
#include "drivers/vicon/socket_link.hpp"
#include "drivers/vicon/virtual_bodies.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// Bus node of a mocap driver: receives the frames of a mocap server and publishes VICON. Bodies
/// that a simulator publishes on TRUTH are added to the frames of a real mocap. Each new status is
/// passed to `report`.
class ViconNode : public bus::Node {
 public:
  /// @throws StartupError if the scenario's mocap is `direct`, since the simulator then publishes
  /// VICON.
  ViconNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
            std::function<void(const std::string&)> report);
  /// As above, for the mocap protocol that the table row `row` describes.
  ViconNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
            const vicon::SessionRow& row, std::function<void(const std::string&)> report);

  [[nodiscard]] std::string name() const override { return name_; }
  [[nodiscard]] Time next_tick() const override { return next_tick_; }
  void tick(Time now) override;
  [[nodiscard]] int wakes_on() const override { return link_.wake_fd(); }
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;

  [[nodiscard]] const vicon::ViconDriver& driver() const { return driver_; }

 private:
  [[nodiscard]] vicon::Moment moment() const;
  void report_status(const std::string& status);

  std::string prefix_;  ///< prefix of counters: name of the driver
  std::string name_;    ///< name of the driver in capitals
  bus::Bus& bus_;
  const bus::Clock& clock_;
  vicon::VirtualBodies virtual_bodies_;
  vicon::ViconDriver driver_;
  vicon::SocketLink link_;
  std::function<void(const std::string&)> report_;
  LatencyRecord latency_;  ///< time from the arrival of a frame to its publication
  std::string status_;
  std::vector<std::string> reported_;  ///< statuses reported since frames were last received
  Time next_tick_;
};

}  // namespace vantage::drivers
