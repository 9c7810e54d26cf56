#pragma once

namespace vantage::experiments {

/// The functions that a team's task must provide; each is one part of a round.
template <class Task>
concept TeamTask = requires(Task task, int step_of_plan) {
  task.plan();              // all robots plan for the time until they plan again
  task.attack();            // the attacker knows the plans and chooses the sensors that fail
  task.move(step_of_plan);  // robots move by this step of their plans, targets by one step
  task.observe();           // robots that are not attacked observe; beliefs are updated
  task.record();            // records the result of the step
};

/// Runs `steps` steps in rounds of `replan_steps` ≥ 1: plan, attack, and for each step move,
/// observe, record. Steps of a plan are counted from 0.
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
    task.observe();
    task.record();
  }
}

}  // namespace vantage::experiments
