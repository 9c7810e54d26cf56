#include "tools/console/operator_input.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <sstream>
#include <string_view>
#include <utility>

#include "core/index.hpp"

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

/// Selects the robot with that name, or the only robot with a name that begins with it.
OperatorRequest request_of_name(const std::string& name, const std::vector<std::string>& robots) {
  std::vector<std::string> found;
  for (const std::string& robot : robots) {
    if (lower(robot) == lower(name)) {
      return {OperatorRequest::Kind::kSelect, OperatorAction::kHold, robot};
    }
    if (lower(robot).starts_with(lower(name))) {
      found.push_back(robot);
    }
  }
  if (found.size() == 1) {
    return {OperatorRequest::Kind::kSelect, OperatorAction::kHold, found.front()};
  }
  return {OperatorRequest::Kind::kNoRobot, OperatorAction::kHold, name};
}

}  // namespace

std::string word_for(OperatorAction action) {
  const auto* word = std::find_if(kWords.begin(), kWords.end(),
                                  [&](const Word& each) { return each.action == action; });
  return word == kWords.end() ? "heartbeat" : std::string(word->text);
}

std::string_view obstacle(OperatorAction action, models::FlightState state) {
  using models::FlightState;
  const bool needs_ground = action == OperatorAction::kArm || action == OperatorAction::kTakeOff;
  switch (state) {
    case FlightState::kIdle:
      return action == OperatorAction::kFollow ? "not in operation; arm and take off first" : "";
    case FlightState::kFollow:
    case FlightState::kHold:
      return needs_ground ? "already in operation" : "";
    case FlightState::kLand:
      return needs_ground || action == OperatorAction::kFollow || action == OperatorAction::kHold
                 ? "is landing"
                 : "";
    case FlightState::kKilled:
      return action == OperatorAction::kTakeOff || action == OperatorAction::kFollow
                 ? "stopped; arm it first"
                 : "";
  }
  return "";
}

std::optional<OperatorRequest> KeyInput::on_name_key(char key,
                                                     const std::vector<std::string>& robots) {
  constexpr std::size_t kNameBytesMax = 64;
  switch (key) {
    case '\r':
    case '\n': {
      const std::string name = *std::exchange(name_, std::nullopt);
      return name.empty() ? std::nullopt : std::optional(request_of_name(name, robots));
    }
    case '\x1b':
      name_.reset();
      return std::nullopt;
    case '\b':
    case '\x7f':
      name_->resize(name_->empty() ? 0 : name_->size() - 1);
      return std::nullopt;
    default:
      if (std::isgraph(static_cast<unsigned char>(key)) != 0 && name_->size() < kNameBytesMax) {
        *name_ += key;
      }
      return std::nullopt;
  }
}

std::optional<OperatorRequest> KeyInput::on_key(std::string_view key,
                                                const std::vector<std::string>& robots,
                                                const std::string& selected) {
  const auto select = [](const std::string& robot) {
    return OperatorRequest{OperatorRequest::Kind::kSelect, OperatorAction::kHold, robot};
  };
  if (key.size() != 1) {
    return std::nullopt;
  }
  const char letter = key[0];
  if (letter == ' ') {
    name_.reset();
    return OperatorRequest{OperatorRequest::Kind::kCommand, OperatorAction::kEmergencyStop, ""};
  }
  if (name_) {
    return on_name_key(letter, robots);
  }
  constexpr std::string_view kLetters = "atfhle";
  constexpr std::array kActions{OperatorAction::kArm,    OperatorAction::kTakeOff,
                                OperatorAction::kFollow, OperatorAction::kHold,
                                OperatorAction::kLand,   OperatorAction::kEmergencyStop};
  const int lower_case = std::tolower(static_cast<unsigned char>(letter));
  if (const auto at = kLetters.find(static_cast<char>(lower_case)); at != std::string_view::npos) {
    return OperatorRequest{OperatorRequest::Kind::kCommand, kActions[at], selected};
  }
  switch (lower_case) {
    case 'q':
      return OperatorRequest{OperatorRequest::Kind::kQuit, OperatorAction::kHold, ""};
    case '?':
      return OperatorRequest{OperatorRequest::Kind::kHelp, OperatorAction::kHold, ""};
    case 'r':
      name_.emplace();
      return std::nullopt;
    case '0':
      return select("");
    case '\t': {
      const auto now = std::find(robots.begin(), robots.end(), selected);
      const auto next = now == robots.end() ? robots.begin() : now + 1;
      return select(next == robots.end() ? "" : *next);
    }
    default:
      break;
  }
  if (letter >= '1' && letter <= '9' && letter - '1' < std::ssize(robots)) {
    return select(robots[index(letter - '1')]);
  }
  return std::nullopt;
}

std::string KeyInput::prompt() const {
  return name_ ? "robot: " + *name_ + "_  (ENTER selects, ESC cancels)" : "";
}

Result<OperatorRequest> request_from_line(const std::string& line) {
  std::istringstream words(line);
  std::string verb;
  std::string robot;
  std::string rest;
  words >> verb >> robot >> rest;
  verb = lower(verb);
  if (!rest.empty()) {
    return Error{"too many words: type one action and at most one robot per line, as in 'land Q1'"};
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
    return Error{"unknown command '" + verb +
                 "': use arm, take-off, follow, hold, land, estop or quit"};
  }
  if (robot == "all") {
    robot.clear();
  }
  return OperatorRequest{OperatorRequest::Kind::kCommand, word->action, robot};
}

}  // namespace vantage::tools
