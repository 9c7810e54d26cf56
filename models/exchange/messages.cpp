#include "models/exchange/messages.hpp"

#include <algorithm>

namespace vantage::models {

const MocapBody* MocapFrame::find(const std::string& name) const {
  const auto found = std::find_if(bodies.begin(), bodies.end(),
                                  [&](const MocapBody& body) { return body.name == name; });
  return found == bodies.end() ? nullptr : &*found;
}

const MocapBody* MocapFrame::find(const std::string& name, std::size_t hint) const {
  return hint < bodies.size() && bodies[hint].name == name ? &bodies[hint] : find(name);
}

std::string round_text(std::int64_t round) {
  constexpr std::int64_t kShown = 100'000;
  return round < 0 ? "-" : std::to_string(round % kShown);
}

const char* name_of(FlightState state) {
  switch (state) {
    case FlightState::kIdle:
      return "idle";
    case FlightState::kFollow:
      return "follow";
    case FlightState::kHold:
      return "hold";
    case FlightState::kLand:
      return "land";
    case FlightState::kKilled:
      return "killed";
  }
  return "?";
}

const char* name_of(SupervisedPhase phase) {
  switch (phase) {
    case SupervisedPhase::kRunning:
      return "running";
    case SupervisedPhase::kWaiting:
      return "waiting";
    case SupervisedPhase::kGivenUp:
      return "given up";
    case SupervisedPhase::kEnded:
      return "ended";
  }
  return "?";
}

const char* name_of(PlanSource source) {
  switch (source) {
    case PlanSource::kSearched:
      return "searched";
    case PlanSource::kShifted:
      return "shifted";
    case PlanSource::kBraking:
      return "braking";
  }
  return "?";
}

bool is_of_belief(const BeliefMixture& mixture, const RobotBelief& belief) {
  return mixture.robot == belief.robot && mixture.step == belief.step &&
         mixture.stamp.run_id == belief.stamp.run_id && mixture.stamp.time == belief.stamp.time;
}

const TeamChoice* TeamProposal::find(const std::string& of_robot) const {
  const auto found = std::find_if(choices.begin(), choices.end(), [&](const TeamChoice& choice) {
    return choice.robot == of_robot;
  });
  return found == choices.end() ? nullptr : &*found;
}

}  // namespace vantage::models
