#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::tools {

/// Request of an operator.
struct OperatorRequest {
  enum class Kind {
    kCommand,
    kSelect,
    kNoRobot,  ///< a typed name that matches no robot, or several robots
    kQuit,
    kHelp
  };
  Kind kind = Kind::kHelp;
  models::OperatorAction action = models::OperatorAction::kHold;  ///< action of kCommand
  std::string robot;  ///< robot of kCommand, kSelect and kNoRobot; empty: all robots
};

/// Converts keys of a terminal (see key_bytes()) into requests. SPACE always sends an emergency
/// stop to all vehicles. Keys for the selected robot: a arm, t take off, f follow, h hold, l land,
/// e emergency stop. Selection: 0 all, 1 to 9 the first nine, TAB the next, r and a name any robot.
/// q quits.
///
/// After r the keys spell a name until ENTER selects the robot or ESC cancels. The beginning of a
/// name is enough if it is unique among the robots; letter case is ignored.
class KeyInput {
 public:
  /// Returns the request of a key; nullopt if there is none.
  std::optional<OperatorRequest> on_key(std::string_view key,
                                        const std::vector<std::string>& robots,
                                        const std::string& selected);
  /// Returns the name typed so far, as "robot: Q1_" and a hint; empty if no name is being typed.
  [[nodiscard]] std::string prompt() const;

 private:
  std::optional<OperatorRequest> on_name_key(char key, const std::vector<std::string>& robots);
  std::optional<std::string> name_;  ///< name typed so far; nullopt if none is being typed
};

/// Parses one line of text: "hold", "land Q1", "estop", "take-off all", "quit". The letter case of
/// the action is ignored. Does not check whether the robot exists. The Error states what was
/// expected.
Result<OperatorRequest> request_from_line(const std::string& line);

/// Returns the word by which request_from_line() recognises an action.
std::string word_for(models::OperatorAction action);

/// Returns the reason why a vehicle in `state` ignores an order; empty if it obeys, or if its own
/// status names the reason.
std::string_view obstacle(models::OperatorAction action, models::FlightState state);

}  // namespace vantage::tools
