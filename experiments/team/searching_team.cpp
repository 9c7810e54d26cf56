#include "experiments/team/searching_team.hpp"

#include "core/index.hpp"
#include "models/motion/unicycle.hpp"
#include "planner/decision/resilient.hpp"
#include "planner/problem/fixed_information.hpp"

namespace vantage::experiments {

namespace {

// Plans for one robot, given the plans of `planned_robots`. Returns the gain of the plan, nats.
double plan_robot(SearchingTeam& team, int robot, const std::vector<int>& planned_robots,
                  const SearchingTeam::Search& search) {
  planner::SearchProblem& problem = team.problems[index(robot)];
  std::vector<planner::FixedTeammate> teammates;
  for (const int other : planned_robots) {
    const planner::SearchProblem& theirs = team.problems[index(other)];
    teammates.push_back(
        {planner::to_trajectory(theirs, team.plans[index(other)]), theirs.sensors.front(), false});
  }
  problem.fixed_information = planner::fixed_information(problem, teammates);
  team.plans[index(robot)] = search(problem);
  planner::SearchProblem blind = problem;
  blind.sensors.clear();
  const planner::SearchResult& plan = team.plans[index(robot)];
  return 0.5 * (planner::score(blind, plan.poses) - plan.cost);
}

}  // namespace

void SearchingTeam::plan(const std::vector<planner::SearchTarget>& targets, int attacks_max,
                         const Search& search) {
  plans.resize(problems.size());
  for (planner::SearchProblem& problem : problems) {
    problem.targets = targets;
    problem.fixed_information.clear();
  }
  planner::plan_resiliently(static_cast<int>(problems.size()), attacks_max,
                            [&](int robot, const std::vector<int>& planned_robots) {
                              return plan_robot(*this, robot, planned_robots, search);
                            });
}

std::vector<char> SearchingTeam::attacked(planner::Attacker attacker, int attacks) const {
  const planner::SearchProblem& first = problems.front();
  planner::TeamProblem team;
  team.targets = first.targets;
  team.horizon_steps = first.horizon_steps;
  team.step_s = first.step_s;
  team.measure = planner::InformationMeasure::kLogDet;
  planner::Choice everybody;
  for (std::size_t i = 0; i < problems.size(); ++i) {
    team.candidates.push_back({planner::make_candidate(problems[i], {}, plans[i])});
    everybody.push_back(static_cast<planner::CandidateId>(i));
  }
  const planner::TeamOracle oracle(team);
  std::vector<char> attacked(problems.size(), 0);
  for (const int robot : planner::attack_by(attacker, oracle, everybody, attacks).robots) {
    attacked[index(robot)] = 1;
  }
  return attacked;
}

int SearchingTeam::move(int step_of_plan, double idle_turn_radps) {
  int idle = 0;
  for (std::size_t i = 0; i < problems.size(); ++i) {
    Pose2& at = problems[i].start;
    if (step_of_plan < plans[i].moving_steps) {
      at = plans[i].poses[index(step_of_plan)];
    } else {
      at = models::step_unicycle(at, {0.0, idle_turn_radps}, problems[i].step_s);
      ++idle;
    }
  }
  return idle;
}

std::vector<Pose2> SearchingTeam::poses() const {
  std::vector<Pose2> poses;
  for (const planner::SearchProblem& problem : problems) {
    poses.push_back(problem.start);
  }
  return poses;
}

}  // namespace vantage::experiments
