#include "bus/node/flights.hpp"

namespace vantage::bus {

void Flights::on_status(const models::VehicleStatus& status, Time now) {
  if (robots_.count(status.robot) == 0) {
    return;
  }
  const bool is_at_rest =
      status.state == models::FlightState::kIdle || status.state == models::FlightState::kKilled;
  if (is_at_rest) {
    seen_in_flight_.erase(status.robot);
  } else {
    seen_in_flight_[status.robot] = now;
  }
}

std::vector<std::string> Flights::in_flight(Time now) const {
  std::vector<std::string> out;
  for (const auto& [robot, seen] : seen_in_flight_) {
    if (now - seen <= kKnownFor) {
      out.push_back(robot);
    }
  }
  return out;
}

int EndAfterFlights::requests(int requests, bool is_any_in_flight, Time now) {
  if (requests == 0) {
    return 0;
  }
  first_ = first_.value_or(now);
  const bool waits = requests == 1 && is_any_in_flight && now - *first_ <= kPatience;
  return waits ? 0 : requests;
}

}  // namespace vantage::bus
