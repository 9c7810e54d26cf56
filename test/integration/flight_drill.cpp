// hold_drill SCENARIO HOLDS SEED
//
// The operator of a flight that `vantage up` runs: arms everybody, has them follow, and then says
// `hold` and `follow` HOLDS times, to one vehicle or to all, at seeded moments; lands them. What
// the vehicles made of it is in the log (hil_check, "stops"). Exit code 0 when all came down.

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

#include "bus/bus.hpp"
#include "bus/channels.hpp"
#include "bus/clock.hpp"
#include "bus/scenario_yaml.hpp"
#include "bus/transport.hpp"
#include "tools/console/console.hpp"
#include "tools/up/flight_program.hpp"
#include "tools/up/process_plan.hpp"

namespace {

using namespace vantage;  // NOLINT(google-build-using-namespace): a test's main alone
using models::OperatorAction;

constexpr double kRestS = 2.5;
constexpr double kGiveUpS = 120.0;

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::printf("usage: hold_drill SCENARIO HOLDS SEED\n");
    return 2;
  }
  const models::Scenario scenario = bus::load_scenario(argv[1]);
  int holds_left = std::atoi(argv[2]);
  std::mt19937_64 rng(std::strtoull(argv[3], nullptr, 10));
  const auto transport = bus::open_transport(scenario.network.url);
  bus::Bus bus(*transport, bus::random_run_id());
  const bus::SystemClock clock;
  const Time start = clock.now();
  tools::OperatorDesk desk(bus, false, start);
  const std::vector<std::string> robots = tools::robots_with_driver(scenario);
  tools::FlightProgram program(robots);
  std::map<std::string, models::FlightState> states;
  bus.subscribe<models::VehicleStatus>(bus::quadrotor_channel("*"),
                                       [&](const models::VehicleStatus& status) {
                                         program.on_status(status);
                                         states[status.robot] = status.state;
                                       });
  std::uniform_real_distribution<double> flown_s(2.0, 5.0);
  std::uniform_int_distribution<std::size_t> whom(0, robots.size());  // the last: all
  std::optional<Time> next_hold;
  std::optional<Time> next_follow;
  std::string held;
  Time program_until = clock.now();
  while (to_seconds(clock.now() - program_until) < kGiveUpS &&
         (states.empty() || !program.is_down())) {
    bus.handle(std::chrono::milliseconds(10));
    const Time now = clock.now();
    desk.tick(now);
    if (!desk.station().beats()) {
      continue;
    }
    bool all_follow = states.size() == robots.size();
    for (const auto& [robot, state] : states) {
      all_follow = all_follow && state == models::FlightState::kFollow;
    }
    if (next_follow) {
      if (now >= *next_follow) {
        desk.send(now, OperatorAction::kFollow, held);
        next_follow.reset();
        program_until = now;
      }
    } else if (next_hold && now >= *next_hold) {
      const std::size_t chosen = whom(rng);
      held = chosen < robots.size() ? robots[chosen] : "";
      desk.send(now, OperatorAction::kHold, held);
      std::printf("hold %s\n", held.empty() ? "all" : held.c_str());
      --holds_left;
      next_hold.reset();
      next_follow = now + from_seconds(kRestS);
    } else if (!next_hold && all_follow) {
      if (holds_left == 0) {
        program.bring_down();
      } else {
        next_hold = now + from_seconds(flown_s(rng));
      }
    }
    if (!next_follow) {
      for (const auto& order : program.due(now)) {
        desk.send(now, order.action, order.robot);
      }
    }
  }
  std::printf("%d holds were not said\n", holds_left);
  return program.is_down() && holds_left == 0 ? 0 : 1;
}
