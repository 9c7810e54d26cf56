#include "tools/up/pilot.hpp"

#include "core/check.hpp"
#include "tools/up/process_plan.hpp"

namespace vantage::tools {

Pilot::Pilot(bus::Bus& bus, const scenario::Scenario& scenario, Time start)
    : now_(start), sender_(bus, {true}, start), program_(robots_with_driver(scenario)) {
  for (const scenario::RobotSpec& robot : scenario.robots) {
    if (robot.device == scenario::DeviceSource::kReal) {
      throw StartupError(
          "robot " + robot.name +
          " is real: --fly cannot arm it; a person must arm it with `vantage console`");
    }
  }
  bus.subscribe<models::VehicleStatus>(
      bus::vehicle_channel("*"),
      [this](const models::VehicleStatus& status) { program_.on_status(status); });
  bus.subscribe<models::OperatorCommand>(
      bus::kCommand, [this, own = bus.run_id()](const models::OperatorCommand& command) {
        if (command.stamp.run_id != own) {
          program_.on_other_station(command, now_);
        }
      });
}

std::string Pilot::tick(Time now) {
  now_ = now;
  std::string news;
  if (sender_.tick(now) && !sender_.station().sends_heartbeat()) {
    news = std::string("operator: ") + explain(sender_.station().role());
  }
  if (sender_.station().role() == Station::Role::kListening) {
    return news;
  }
  for (const FlightProgram::Order& order : program_.due(now)) {
    sender_.send(now, order.action, order.robot);  // refused while another station is in charge
  }
  return news;
}

}  // namespace vantage::tools
