// replay_check ORIGINAL.lcmlog REPLAYED.lcmlog ROBOT MIN_COUNT
//
// Compares what one robot's estimator and planner said in a trial with what fresh processes said of
// the same inputs (published under REPLAY_): beliefs by step to 1e-9, plans by round bit for bit.
// Exit code 0 when at least MIN_COUNT of each were compared and none differs.

#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

#include <lcm/lcm-cpp.hpp>

#include "bus/convert.hpp"
#include "estimator/app/replay_node.hpp"
#include "planner/app/replay_node.hpp"

namespace {

using namespace vantage;  // NOLINT(google-build-using-namespace): a test's main alone

struct Said {
  std::map<std::int64_t, models::RobotBelief> beliefs;  // by step
  std::map<std::int64_t, models::RobotPlan> plans;      // by round
};

template <class Wire>
bool decode(const lcm::LogEvent& event, Wire& wire) {
  return wire.decode(event.data, 0, event.datalen) == event.datalen;
}

Said read(const std::string& path, const std::string& prefix, const std::string& robot) {
  lcm::LogFile log(path, "r");
  Said said;
  if (!log.good()) {
    std::printf("cannot read %s\n", path.c_str());
    std::exit(2);
  }
  while (const lcm::LogEvent* event = log.readNextEvent()) {
    if (event->channel == prefix + "BELIEF_" + robot) {
      vantage_lcm::belief_t wire;
      if (decode(*event, wire)) {
        said.beliefs[wire.step] = bus::from_wire(wire).value();
      }
    } else if (event->channel == prefix + "PLAN_" + robot) {
      vantage_lcm::plan_t wire;
      if (decode(*event, wire)) {
        said.plans[wire.round] = bus::from_wire(wire).value();
      }
    }
  }
  return said;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::printf("usage: replay_check ORIGINAL REPLAYED ROBOT MIN_COUNT\n");
    return 2;
  }
  const Said logged = read(argv[1], "", argv[3]);
  const Said replayed = read(argv[2], "REPLAY_", argv[3]);
  const int least = std::atoi(argv[4]);
  int beliefs = 0;
  int plans = 0;
  int different = 0;
  for (const auto& [step, belief] : replayed.beliefs) {
    const auto original = logged.beliefs.find(step);
    ++beliefs;
    different +=
        original != logged.beliefs.end() && estimator::same_content(belief, original->second, 1e-9)
            ? 0
            : 1;
  }
  for (const auto& [round, plan] : replayed.plans) {
    const auto original = logged.plans.find(round);
    ++plans;
    different +=
        original != logged.plans.end() && planner::is_same_decision(plan, original->second) ? 0 : 1;
  }
  std::printf("%s: %d of %zu beliefs and %d of %zu plans replayed, %d different\n", argv[3],
              beliefs, logged.beliefs.size(), plans, logged.plans.size(), different);
  return different == 0 && beliefs >= least && plans >= least ? 0 : 1;
}
