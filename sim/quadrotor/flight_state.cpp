#include "sim/quadrotor/flight_state.hpp"

namespace vantage::sim {

using models::FlightState;
using models::OperatorAction;

FlightState after_command(FlightState state, OperatorAction action, bool on_ground) {
  switch (action) {
    case OperatorAction::kHeartbeat:
      return state;
    case OperatorAction::kArm:
      return state == FlightState::kKilled && on_ground ? FlightState::kIdle : state;
    case OperatorAction::kTakeOff:
      return state == FlightState::kIdle ? FlightState::kHold : state;
    case OperatorAction::kFollow:
      return state == FlightState::kHold ? FlightState::kFollow : state;
    case OperatorAction::kHold:
      return state == FlightState::kFollow ? FlightState::kHold : state;
    case OperatorAction::kLand:
      return state == FlightState::kFollow || state == FlightState::kHold ? FlightState::kLand
                                                                          : state;
    case OperatorAction::kEmergencyStop:
      return FlightState::kKilled;
  }
  return state;
}

}  // namespace vantage::sim
