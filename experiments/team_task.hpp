#pragma once

namespace vantage::experiments {

/// A team's task in equal steps, as the parts of a round.
template <class Task>
concept TeamTask = requires(Task task, int step_of_plan) {
  task.plan();    // all robots plan until the next planning
  task.attack();  // the attacker, knowing the plans, chooses the sensors that fail until then
  task.move(step_of_plan);  // robots move by this step of their plans, targets by one step
  task.look();              // robots that are not attacked observe; beliefs are updated to now
  task.judge();             // records the result of the step
};

/// Runs `steps` steps in rounds of `replan_steps` ≥ 1: plan, attack, and for each step move, look,
/// judge. Steps of a plan count from 0.
/// Source: dissertation Alg. 9.
template <TeamTask Task>
void run_team_task(Task& task, int steps, int replan_steps) {
  for (int step = 0; step < steps; ++step) {
    const int step_of_plan = step % replan_steps;
    if (step_of_plan == 0) {
      task.plan();
      task.attack();
    }
    task.move(step_of_plan);
    task.look();
    task.judge();
  }
}

}  // namespace vantage::experiments
