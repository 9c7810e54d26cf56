#include "test/drivers/safety/fault_parts.hpp"

namespace vantage::test::faults {

std::vector<Fault> operator_faults() {
  return {
      for_all(fault(17, "operator silent for 0.8 s", "no heartbeat",
                    lasting(0.8, sets(&RoomKnobs::operator_silent, true)), flies_on())),
      for_all(fault(17, "operator silent for 2 s", "no heartbeat",
                    lasting(2.0, sets(&RoomKnobs::operator_silent, true)),
                    ends(kHold, {{kHold, 1.0 + kTicks}}, "operator quiet"))),
      for_all(fault(17, "operator station lost", "no heartbeat",
                    sets(&RoomKnobs::operator_silent, true),
                    ends(kIdle, {{kHold, 1.0 + kTicks}, {kLand, 3.0 + kTicks}}, "operator lost"))),
      for_all(fault(
          17, "first station lost, a second sends heartbeats", "it also sends follow",
          both(sets(&RoomKnobs::operator_silent, true), sets(&RoomKnobs::second_station, true)),
          ends(kFollow, {{kHold, 1.0 + kTicks}}, "operator quiet"))),
      for_all(fault(36, "emergency stop", "", sends_command(OperatorAction::kEmergencyStop),
                    ends(kKilled, {{kKilled, kTicks}}, "emergency stop"))),
      for_all(fault(36, "emergency stop twice", "0.1 s apart",
                    both(sends_command(OperatorAction::kEmergencyStop),
                         sends_command(OperatorAction::kEmergencyStop, 0.1)),
                    ends(kKilled, {{kKilled, kTicks}}, "emergency stop"))),
      for_all(after(1.0, fault(36, "emergency stop while landing", "1 s after `land`",
                               both(sends_command(OperatorAction::kLand),
                                    sends_command(OperatorAction::kEmergencyStop, 1.0)),
                               ends(kKilled, {{kKilled, kTicks}}, "emergency stop")))),
      for_all(fault(36, "emergency stop from a second station", "not in charge",
                    at(0.0, sets(&RoomKnobs::second_command, OperatorAction::kEmergencyStop)),
                    ends(kKilled, {{kKilled, kTicks}}, "emergency stop"))),
      for_all(
          fault(36, "second station sends heartbeats too", "and sends follow and arm",
                both(sets(&RoomKnobs::second_station, true), sets(&RoomKnobs::second_arms, true)),
                flies_on_counting("command.refused"))),
      for_all(fault(36, "operator sends land", "", sends_command(OperatorAction::kLand),
                    ends(kIdle, {{kLand, kTicks}}))),
  };
}

}  // namespace vantage::test::faults
