#include "python/task/team_task.hpp"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "core/check.hpp"
#include "core/index.hpp"
#include "sim/random.hpp"

namespace vantage::python {

TeamTask::TeamTask(int robots, int steps_max, const JammerSpec& jammer)
    : robots_(robots), steps_max_(steps_max), jammer_(jammer) {
  constexpr int kRobotsMax = 64;
  require(robots >= 1 && robots <= kRobotsMax,
          fmt::format("robots: must be ≥ 1 and ≤ {}, got {}", kRobotsMax, robots));
  require(steps_max >= 1, fmt::format("episode_steps: must be ≥ 1, got {}", steps_max));
  require(jammer.attacks >= 0 && jammer.attacks <= robots,
          fmt::format("attacks: must be ≥ 0 and ≤ robots ({}), got {}", robots, jammer.attacks));
  require(jammer.period_steps >= 1,
          fmt::format("attack_period_steps: must be ≥ 1, got {}", jammer.period_steps));
  jammed_.assign(static_cast<std::size_t>(robots), 0);
  seen_.assign(static_cast<std::size_t>(robots), 0.0);
}

void TeamTask::reset(std::uint64_t seed) {
  attacker_ = sim::random_stream(seed, "task attack");
  seed_ = seed;
  steps_ = 0;
  std::fill(seen_.begin(), seen_.end(), 0.0);
  choose_jammed();
  on_reset(seed);
}

double TeamTask::step(std::span<const std::int64_t> actions) {
  require_actions(actions, 1, *this);
  if (is_over()) {
    throw UsageError("the episode is over: call reset() before the next step()");
  }
  if (steps_ > 0 && steps_ % jammer_.period_steps == 0) {
    choose_jammed();
  }
  ++steps_;
  return on_step(actions);
}

// require() is not used, because its message would be formatted even if all actions are valid.
void require_actions(std::span<const std::int64_t> actions, std::size_t tasks,
                     const TeamTask& task) {
  const auto robots = static_cast<std::size_t>(task.robots());
  if (actions.size() != tasks * robots) {
    throw UsageError(
        fmt::format("actions: must contain {} numbers for {} robots in each of {} tasks, got {}",
                    tasks * robots, robots, tasks, actions.size()));
  }
  const int choices = task.actions();
  for (const std::int64_t action : actions) {
    if (action < 0 || action >= choices) {
      throw UsageError(fmt::format("action: must be ≥ 0 and < {}, got {}", choices, action));
    }
  }
}

void TeamTask::choose_jammed() {
  std::fill(jammed_.begin(), jammed_.end(), 0);
  if (jammer_.attacks == 0) {
    return;
  }
  std::vector<std::size_t> order(seen_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  // Shuffles explicitly because std::shuffle differs between standard libraries.
  for (std::size_t i = order.size() - 1; i > 0; --i) {
    std::swap(order[i], order[attacker_() % (i + 1)]);
  }
  if (jammer_.is_greedy) {
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return seen_[a] > seen_[b]; });
  }
  for (int i = 0; i < jammer_.attacks; ++i) {
    jammed_[order[index(i)]] = 1;
  }
  std::fill(seen_.begin(), seen_.end(), 0.0);
}

void TeamTask::observe(std::span<float> out) const {
  const auto size = static_cast<std::size_t>(observation_size());
  for (int robot = 0; robot < robots_; ++robot) {
    observe(robot, out.subspan(static_cast<std::size_t>(robot) * size, size));
  }
}

}  // namespace vantage::python
