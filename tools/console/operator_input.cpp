#include "tools/console/operator_input.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <sstream>
#include <string_view>
#include <utility>

namespace vantage::tools {
namespace {

using models::OperatorAction;

struct Word {
  std::string_view text;
  OperatorAction action;
};

// The first word of each action is the one that word_for() writes.
constexpr std::array<Word, 9> kWords = {{{"arm", OperatorAction::kArm},
                                         {"take-off", OperatorAction::kTakeOff},
                                         {"takeoff", OperatorAction::kTakeOff},
                                         {"follow", OperatorAction::kFollow},
                                         {"hold", OperatorAction::kHold},
                                         {"land", OperatorAction::kLand},
                                         {"estop", OperatorAction::kEmergencyStop},
                                         {"e-stop", OperatorAction::kEmergencyStop},
                                         {"stop", OperatorAction::kEmergencyStop}}};

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace

std::string word_for(OperatorAction action) {
  const auto* word = std::find_if(kWords.begin(), kWords.end(),
                                  [&](const Word& each) { return each.action == action; });
  return word == kWords.end() ? "heartbeat" : std::string(word->text);
}

std::optional<OperatorRequest> request_from_key(std::string_view key,
                                                const std::vector<std::string>& robots,
                                                const std::string& selected) {
  const auto command = [&selected](OperatorAction action) {
    return OperatorRequest{OperatorRequest::Kind::kCommand, action, selected};
  };
  if (key.size() != 1) {
    return std::nullopt;
  }
  const char letter = key[0];
  switch (std::tolower(static_cast<unsigned char>(letter))) {
    case 'a':
      return command(OperatorAction::kArm);
    case 't':
      return command(OperatorAction::kTakeOff);
    case 'f':
      return command(OperatorAction::kFollow);
    case 'h':
      return command(OperatorAction::kHold);
    case 'l':
      return command(OperatorAction::kLand);
    case ' ':
    case 'e':
      return command(OperatorAction::kEmergencyStop);
    case 'q':
      return OperatorRequest{OperatorRequest::Kind::kQuit, OperatorAction::kHold, ""};
    case '?':
      return OperatorRequest{OperatorRequest::Kind::kHelp, OperatorAction::kHold, ""};
    default:
      break;
  }
  if (letter == '0') {
    return OperatorRequest{OperatorRequest::Kind::kSelect, OperatorAction::kHold, ""};
  }
  if (letter >= '1' && letter <= '9' && letter - '1' < std::ssize(robots)) {
    return OperatorRequest{OperatorRequest::Kind::kSelect, OperatorAction::kHold,
                           robots[static_cast<std::size_t>(letter - '1')]};
  }
  return std::nullopt;
}

Result<OperatorRequest> request_from_line(const std::string& line) {
  std::istringstream words(line);
  std::string verb;
  std::string robot;
  std::string rest;
  words >> verb >> robot >> rest;
  verb = lower(verb);
  if (!rest.empty()) {
    return Error{"one action and at most one robot a line, as in 'land Q1'"};
  }
  if (verb == "quit" || verb == "q") {
    return OperatorRequest{OperatorRequest::Kind::kQuit, OperatorAction::kHold, ""};
  }
  if (verb == "help" || verb == "?") {
    return OperatorRequest{OperatorRequest::Kind::kHelp, OperatorAction::kHold, ""};
  }
  const auto* word = std::find_if(kWords.begin(), kWords.end(),
                                  [&](const Word& each) { return each.text == verb; });
  if (word == kWords.end()) {
    return Error{"'" + verb + "' is none of arm, take-off, follow, hold, land, estop, quit"};
  }
  if (robot == "all") {
    robot.clear();
  }
  return OperatorRequest{OperatorRequest::Kind::kCommand, word->action, robot};
}

}  // namespace vantage::tools
