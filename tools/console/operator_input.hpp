#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::tools {

/// What an operator asked for.
struct OperatorRequest {
  enum class Kind {
    kCommand,
    kSelect,
    kNoRobot,  ///< a typed name that no robot has
    kQuit,
    kHelp
  };
  Kind kind = Kind::kHelp;
  models::OperatorAction action = models::OperatorAction::kHold;  ///< of kCommand
  std::string robot;  ///< of kCommand, kSelect and kNoRobot; empty: all
};

/// Makes requests of the keys of a terminal, as key_bytes() has them. SPACE: emergency stop of all
/// vehicles, always. To the selected robot: a arm, t take off, f follow, h hold, l land, e
/// emergency stop. Selection: 0 all, 1 to 9 the first nine, TAB the next, r and a name any robot. q
/// quits.
///
/// After r the keys spell a name until ENTER selects it or ESC abandons it; the beginning of a name
/// is enough if only one robot has it, in any letter case.
class KeyInput {
 public:
  /// nullopt: the key requests nothing.
  std::optional<OperatorRequest> on_key(std::string_view key,
                                        const std::vector<std::string>& robots,
                                        const std::string& selected);
  /// What has been typed of a name, "robot: Q1_"; empty when no name is being typed.
  [[nodiscard]] std::string prompt() const;

 private:
  std::optional<OperatorRequest> on_name_key(char key, const std::vector<std::string>& robots);
  std::optional<std::string> name_;  ///< while one is being typed
};

/// One line of text: "hold", "land Q1", "estop", "take-off all", "quit". The Error says what was
/// expected. Actions are understood in any letter case; whether there is that robot is not asked.
Result<OperatorRequest> request_from_line(const std::string& line);

/// The word for an action, as request_from_line reads it.
std::string word_for(models::OperatorAction action);

}  // namespace vantage::tools
