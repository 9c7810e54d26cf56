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
  enum class Kind { kCommand, kSelect, kQuit, kHelp };
  Kind kind = Kind::kHelp;
  models::OperatorAction action = models::OperatorAction::kHold;  ///< of kCommand
  std::string robot;  ///< of kCommand and kSelect; empty: all
};

/// One key of the terminal, as key_bytes() has it: a arm, t take off, f follow, h hold, l land,
/// space or e emergency stop, q quit, 0 all robots, 1–9 one robot; commands go to `selected`.
/// nullopt for any other key.
std::optional<OperatorRequest> request_from_key(std::string_view key,
                                                const std::vector<std::string>& robots,
                                                const std::string& selected);

/// One line of text: "hold", "land Q1", "estop", "take-off all", "quit". The Error says what was
/// expected. Actions are understood in any letter case; whether there is that robot is not asked.
Result<OperatorRequest> request_from_line(const std::string& line);

/// The word for an action, as request_from_line reads it.
std::string word_for(models::OperatorAction action);

}  // namespace vantage::tools
