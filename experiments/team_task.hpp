#pragma once

namespace vantage::experiments {

/// What a team does in equal steps, whatever it looks for, as the parts of a round.
template <class Task>
concept TeamTask = requires(Task task, int step_of_plan) {
  task.plan();              // all decide what they do until they plan again
  task.attack();            // who knows these plans decides who loses its sensor until then
  task.move(step_of_plan);  // all that moves does so for a step, robots by that one of their plans
  task.look();              // who is not attacked looks, and what the team knows is of now
  task.judge();             // how it was after the step is taken down
};

/// `steps` steps in rounds of `replan_steps` ≥ 1: plan, attack, and for each step move, look,
/// judge. Steps of a plan count from 0. Source: dissertation Alg. 9.
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
