#include <algorithm>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "scenario/reader/scenario_sections_yaml.hpp"

namespace vantage::scenario {
namespace {

constexpr std::size_t kAttacksMax = 1000;
constexpr double kTimeMaxS = 1e6;

void read_attack(Mapping& from, const Scenario& scenario, AttackSpec& attack) {
  from.require("to_s");
  from.number("from_s", attack.from_s, from_to(0.0, kTimeMaxS));
  from.number("to_s", attack.to_s, above_to(0.0, kTimeMaxS));
  if (!(attack.to_s > attack.from_s)) {
    from.refuse("to_s",
                fmt::format("must be above from_s ({}), but is {}", attack.from_s, attack.to_s));
  }
  if (const std::optional<Value> robots = from.find_required("robots")) {
    for (const Value& item : robots->items()) {
      const std::string robot = item.text();
      if (scenario.find_robot(robot) == nullptr) {
        item.refuse("must be the name of a robot, is '" + robot + "'");
      }
      attack.robots.push_back(robot);
    }
  }
}

}  // namespace

void read_attacks(Mapping& top, Scenario& scenario) {
  const int robots = static_cast<int>(scenario.robots.size());
  if (scenario.planner.attacks_max > 0 && scenario.planner.attacks_max >= robots) {
    top.refuse("planner",
               fmt::format("attacks_max must be below the number of robots ({}), but is {}", robots,
                           scenario.planner.attacks_max));
  }
  const std::optional<Value> list = top.find("attacks");
  if (!list) {
    return;
  }
  const std::vector<Value> items = list->items();
  if (items.size() > kAttacksMax) {
    list->refuse(
        fmt::format("must contain at most {} attacks, contains {}", kAttacksMax, items.size()));
  }
  for (const Value& item : items) {
    AttackSpec attack;
    read_mapping({item}, [&](Mapping& from) { read_attack(from, scenario, attack); });
    scenario.attacks.push_back(std::move(attack));
  }
}

}  // namespace vantage::scenario
