#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "planner/robot/robot_planner.hpp"
#include "planner/robot/round.hpp"
#include "planner/robot/trajectory_tools.hpp"
#include "test/planner/robot/team_scenario.hpp"

namespace vantage::planner {
namespace {

using test::energy_scenario;
using test::first_inputs;

// One round of all robots of a scenario in which messages are lost with a given probability.
class Round {
 public:
  Round(const scenario::Scenario& scenario, unsigned seed) : scenario_(scenario), seed_(seed) {
    for (const scenario::RobotSpec& robot : scenario.robots) {
      planners_.push_back(std::make_unique<RobotPlanner>(scenario, robot.name));
    }
    solutions_.resize(planners_.size());
    exchanges_.resize(planners_.size());
  }

  [[nodiscard]] PlanInputs inputs_of(std::size_t robot) const {
    PlanInputs inputs = first_inputs(scenario_, robot, seed_);
    inputs.attack = attack;
    inputs.solution = solutions_[robot];
    inputs.team_plans = plans_;
    inputs.team_plans.erase(scenario_.robots[robot].name);
    return inputs;
  }

  void exchange(double lost) {
    std::mt19937_64 rng(seed_);
    for (std::size_t robot = 0; robot < planners_.size(); ++robot) {
      exchanges_[robot] = planners_[robot]->begin_exchange(
          inputs_of(robot), Deadline::nodes(scenario_.planner.node_budget));
      ASSERT_TRUE(exchanges_[robot]);
    }
    bool is_going_on = true;
    while (is_going_on) {
      is_going_on = false;
      for (std::size_t robot = 0; robot < planners_.size(); ++robot) {
        auto proposal = exchanges_[robot]->improve(Deadline::never());
        if (!proposal) {
          continue;
        }
        is_going_on = true;
        for (std::size_t to = 0; to < planners_.size(); ++to) {
          const bool is_heard = std::uniform_real_distribution(0.0, 1.0)(rng) >= lost;
          if (to != robot && is_heard &&
              exchanges_[to]->receive(*proposal) == ReceiveOutcome::kTaken) {
            solutions_[to] = proposal;
          }
        }
        bases_.emplace_back(solutions_[robot]);
        solutions_[robot] = proposal;
        proposals_.push_back(*proposal);
      }
    }
  }

  // Plans for all robots in slot order, each with the newest plans of the others.
  void plan() {
    for (std::size_t robot = 0; robot < planners_.size(); ++robot) {
      const auto plan = planners_[robot]->plan(inputs_of(robot), Deadline::never());
      ASSERT_TRUE(plan);
      plans_[scenario_.robots[robot].name] = *plan;
    }
  }

  std::optional<models::AttackNotice> attack;
  scenario::Scenario scenario_;
  unsigned seed_;
  std::vector<std::unique_ptr<RobotPlanner>> planners_;
  std::vector<std::unique_ptr<TeamExchange>> exchanges_;
  std::vector<std::optional<models::TeamProposal>> solutions_;
  std::vector<std::optional<models::TeamProposal>> bases_;  ///< solutions that proposals_ improved
  std::vector<models::TeamProposal> proposals_;
  std::map<std::string, models::RobotPlan> plans_;
};

TEST(RoundSchedule, LetsAllRobotsShareTheFirstHalfInALocalSearch) {
  scenario::PlannerSpec spec;
  spec.team_algorithm = scenario::TeamAlgorithm::kLocalSearch;
  const int robots = 5;
  for (int i = 0; i < robots; ++i) {
    const RoundSchedule schedule(spec, i, robots);
    const auto exchange = schedule.proposal_slot(9);
    EXPECT_TRUE(exchange.is_proposal);
    EXPECT_EQ(exchange.begin, RoundSchedule(spec, 0, robots).proposal_slot(9).begin);
    EXPECT_EQ(exchange.end, RoundSchedule(spec, 0, robots).slot(9).begin);
    EXPECT_EQ(schedule.next_slot(exchange.begin - Duration{1}).begin, exchange.begin);
    EXPECT_EQ(schedule.next_slot(exchange.begin).begin, schedule.slot(9).begin);
  }
}

void expect_safe(const Round& round, const std::string& what) {
  const scenario::Scenario& scenario = round.scenario_;
  for (std::size_t a = 0; a < scenario.robots.size(); ++a) {
    const scenario::RobotSpec& robot = scenario.robots[a];
    const models::RobotPlan& plan = round.plans_.at(robot.name);
    EXPECT_TRUE(models::is_clear(scenario.world, plan.trajectory, plan.trajectory.start_time,
                                 robot.limits.radius_m))
        << what;
    EXPECT_EQ(plan.trajectory.start.position_m(), robot.start.position_m());
    EXPECT_EQ(plan.trajectory.start_time, round.inputs_of(a).slot.activation);
    for (std::size_t b = a + 1; b < scenario.robots.size(); ++b) {
      EXPECT_TRUE(models::keeps_separation(
          plan.trajectory, round.plans_.at(scenario.robots[b].name).trajectory,
          plan.trajectory.start_time, scenario.planner.separation_m))
          << what;
    }
  }
}

TEST(RobotPlanner, FliesTeamSolution) {
  const scenario::Scenario scenario = energy_scenario();
  int flown = 0;
  int rests = 0;
  for (unsigned seed = 0; seed < 15; ++seed) {
    Round round(scenario, seed);
    round.exchange(0.0);
    round.plan();
    expect_safe(round, "seed " + std::to_string(seed));
    ASSERT_FALSE(round.proposals_.empty());
    for (std::size_t robot = 0; robot < scenario.robots.size(); ++robot) {
      ASSERT_TRUE(round.solutions_[robot]);
      EXPECT_EQ(round.solutions_[robot]->history, round.solutions_[0]->history)
          << "all robots agree";
      const std::string& name = scenario.robots[robot].name;
      const models::RobotPlan& plan = round.plans_.at(name);
      EXPECT_EQ(plan.source, models::PlanSource::kSearched) << name << " seed " << seed;
      if (const models::TeamChoice* choice = round.solutions_[robot]->find(name)) {
        EXPECT_EQ(plan.trajectory.segments.size(), choice->trajectory.segments.size());
        EXPECT_EQ(models::at(plan.trajectory, Time::max()).world_from_body.x_m,
                  models::at(choice->trajectory, Time::max()).world_from_body.x_m);
        EXPECT_GT(choice->information_nats, choice->energy_nats)
            << "the information exceeds the energy cost";
        flown += choice->energy_nats > 0.0 ? 1 : 0;
      } else {
        EXPECT_TRUE(plan.trajectory.segments.empty()) << "the robot was stationary and rests";
        ++rests;
      }
    }
  }
  EXPECT_GE(flown, 15);
  EXPECT_GE(rests, 1);
}

TEST(RobotPlanner, StaysSafeWhenProposalsAreLost) {
  const scenario::Scenario scenario = energy_scenario();
  int disagreed = 0;
  for (unsigned seed = 0; seed < 15; ++seed) {
    for (const double lost : {0.5, 1.0}) {
      Round round(scenario, seed);
      round.exchange(lost);
      round.plan();
      expect_safe(round, "seed " + std::to_string(seed));
      // A robot that neither received nor sent a proposal has no solution.
      const auto is_as_the_first = [&](const std::optional<models::TeamProposal>& solution) {
        const auto& first = round.solutions_[0];
        return solution.has_value() == first.has_value() &&
               (!solution || solution->history == first->history);
      };
      for (const auto& solution : round.solutions_) {
        disagreed += is_as_the_first(solution) ? 0 : 1;
      }
    }
  }
  EXPECT_GE(disagreed, 15);
}

// A logged proposal can be repeated from its inputs, its node count and the solution that it
// improved on.
TEST(RobotPlanner, ProposalIsReproducibleFromInputs) {
  const scenario::Scenario scenario = energy_scenario();
  int again = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    Round round(scenario, seed);
    round.exchange(0.3);
    for (std::size_t i = 0; i < round.proposals_.size(); ++i) {
      const models::TeamProposal& sent = round.proposals_[i];
      const auto robot =
          static_cast<std::size_t>(scenario.find_robot(sent.robot) - scenario.robots.data());
      RobotPlanner fresh(scenario, sent.robot);
      const auto exchange =
          fresh.begin_exchange(first_inputs(scenario, robot, seed), Deadline::nodes(sent.nodes));
      ASSERT_TRUE(exchange);
      if (round.bases_[i]) {
        ASSERT_EQ(exchange->receive(*round.bases_[i]), ReceiveOutcome::kTaken);
      }
      const auto proposal = exchange->improve(Deadline::never());
      ASSERT_TRUE(proposal);
      EXPECT_EQ(proposal->value_nats, sent.value_nats);
      EXPECT_EQ(proposal->history, sent.history);
      ++again;
    }
  }
  EXPECT_GE(again, 15);
}

TEST(RobotPlanner, RefusesInvalidProposals) {
  const scenario::Scenario scenario = energy_scenario();
  Round round(scenario, 3);
  round.exchange(0.0);
  models::TeamProposal sent = round.proposals_.back();
  RobotPlanner fresh(scenario, "Q3");
  const auto exchange = fresh.begin_exchange(first_inputs(scenario, 2, 3),
                                             Deadline::nodes(scenario.planner.node_budget));
  ASSERT_TRUE(exchange);
  const std::vector<std::string> names{"Q1", "Q2", "Q3"};
  ASSERT_FALSE(sent.choices.empty());
  ASSERT_FALSE(sent.choices[0].trajectory.segments.empty());
  models::TeamProposal endless = sent;
  endless.choices[0].trajectory.segments.back().duration_s = 1e12;
  endless.history.back() = fingerprint(names, endless.choices);
  EXPECT_EQ(exchange->receive(endless), ReceiveOutcome::kRefused);
  models::TeamProposal forged = sent;
  forged.history.back() ^= 1;
  EXPECT_EQ(exchange->receive(forged), ReceiveOutcome::kRefused);
  EXPECT_EQ(exchange->receive(sent), ReceiveOutcome::kTaken);
  EXPECT_EQ(exchange->receive(sent), ReceiveOutcome::kNotBetter)
      << "compared with the same solution";
  models::TeamProposal late = sent;
  --late.round;
  EXPECT_EQ(exchange->receive(late), ReceiveOutcome::kOtherRound);
}

// Each team algorithm uses one kind of message only.
TEST(RobotPlanner, SendsOnlyTheMessagesOfItsTeamAlgorithm) {
  scenario::Scenario scenario = energy_scenario();
  const PlanInputs inputs = first_inputs(scenario, 0, 3);
  const Deadline deadline = Deadline::nodes(scenario.planner.node_budget);
  EXPECT_TRUE(RobotPlanner(scenario, "Q1").begin_exchange(inputs, deadline));
  EXPECT_FALSE(RobotPlanner(scenario, "Q1").propose(inputs, deadline));
  EXPECT_FALSE(RobotPlanner(scenario, "Q1").next_slot_index(inputs)) << "slots are not shared";
  scenario.planner.team_algorithm = scenario::TeamAlgorithm::kCoordinateDescent;
  EXPECT_FALSE(RobotPlanner(scenario, "Q1").begin_exchange(inputs, deadline));
  EXPECT_FALSE(RobotPlanner(scenario, "Q1").propose(inputs, deadline))
      << "this planner uses candidates";
  scenario.robots[0].energy.price_nats = 0.0;
  EXPECT_FALSE(RobotPlanner(scenario, "Q1").begin_exchange(inputs, deadline));
  EXPECT_TRUE(RobotPlanner(scenario, "Q1").propose(inputs, deadline));
  scenario.planner.algorithm = "external";
  EXPECT_FALSE(RobotPlanner(scenario, "Q1").begin_exchange(inputs, deadline));
  EXPECT_FALSE(RobotPlanner(scenario, "Q1").propose(inputs, deadline));
}

// Without a pose the round cannot begin, so no proposal is sent or used.
TEST(RobotPlanner, StartsNoExchangeWithoutAPose) {
  const scenario::Scenario scenario = energy_scenario();
  PlanInputs inputs = first_inputs(scenario, 0, 3);
  inputs.mocap.reset();
  RobotPlanner planner(scenario, "Q1");
  EXPECT_FALSE(planner.begin_exchange(inputs, Deadline::nodes(scenario.planner.node_budget)));
  EXPECT_EQ(planner.counts().no_pose, 1);
}

TEST(RobotPlanner, PlansNoMotionForJammedRobot) {
  const scenario::Scenario scenario = energy_scenario();
  for (unsigned seed = 0; seed < 5; ++seed) {
    Round round(scenario, seed);
    round.attack = models::AttackNotice{{}, {"Q2"}};
    round.exchange(0.0);
    round.plan();
    for (const models::TeamProposal& sent : round.proposals_) {
      EXPECT_EQ(sent.find("Q2"), nullptr);
    }
    EXPECT_TRUE(round.plans_.at("Q2").trajectory.segments.empty());
  }
}

TEST(RobotPlanner, IncludesEnergyInCoordinateDescent) {
  scenario::Scenario scenario = energy_scenario();
  scenario.planner.team_algorithm = scenario::TeamAlgorithm::kCoordinateDescent;
  const Deadline deadline = Deadline::nodes(scenario.planner.node_budget);
  int moving = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::vector<double> ways_m;
    for (const double price_nats : {1e-9, 1e6}) {
      scenario.robots[0].energy.price_nats = price_nats;
      RobotPlanner planner(scenario, "Q1");
      const auto plan = planner.plan(first_inputs(scenario, 0, seed), deadline);
      ASSERT_TRUE(plan);
      EXPECT_EQ(plan->source, models::PlanSource::kSearched);
      ways_m.push_back((models::at(plan->trajectory, Time::max()).world_from_body.position_m() -
                        plan->trajectory.start.position_m())
                           .norm());
      RobotPlanner fresh(scenario, "Q1");
      const auto again = fresh.plan(first_inputs(scenario, 0, seed), Deadline::nodes(plan->nodes));
      ASSERT_TRUE(again);
      EXPECT_EQ(models::at(again->trajectory, Time::max()).world_from_body,
                models::at(plan->trajectory, Time::max()).world_from_body);
    }
    moving += ways_m[0] > 0.5 ? 1 : 0;
    EXPECT_EQ(ways_m[1], 0.0) << "no information is worth that energy";
  }
  EXPECT_GE(moving, 4);
}

// The work after the search does not check the deadline but must end before the deadline, so the
// search stops after a third of the time. The test repeats because a busy machine may delay the
// checks.
TEST(RobotPlanner, SearchesForAThirdOfItsTimeBeforeAnExchange) {
  static std::int64_t asked_ns = 0;
  constexpr std::int64_t kTime_ns = 200'000'000;
  const auto note = [] {
    asked_ns = monotonic_ns();
    return false;
  };
  scenario::Scenario scenario = energy_scenario();
  scenario.planner.team_algorithm = scenario::TeamAlgorithm::kCoordinateDescent;
  RobotPlanner planner(scenario, "Q1");
  planner.prefault();
  const PlanInputs inputs = first_inputs(scenario, 0, 3);
  bool was_in_time = false;
  for (int i = 0; i < 20 && !was_in_time; ++i) {
    const std::int64_t begin_ns = monotonic_ns();
    const auto plan =
        planner.plan(inputs, Deadline::at(begin_ns + kTime_ns).with_cancellation(note));
    ASSERT_TRUE(plan);
    EXPECT_GT(asked_ns, begin_ns);
    was_in_time = asked_ns < begin_ns + kTime_ns / 2;
    EXPECT_EQ(
        models::at(plan->trajectory, Time::max()).world_from_body,
        models::at(planner.plan(inputs, Deadline::nodes(plan->nodes))->trajectory, Time::max())
            .world_from_body)
        << "with the same number of nodes";
  }
  EXPECT_TRUE(was_in_time);
}

TEST(RobotPlanner, HoversWithoutCurrentSolution) {
  const scenario::Scenario scenario = energy_scenario();
  int moving = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    Round round(scenario, seed);
    round.exchange(0.0);
    round.plan();
    PlanInputs inputs = round.inputs_of(0);
    inputs.own_plan = round.plans_.at("Q1");
    inputs.slot.round += 1;
    inputs.slot.activation += from_seconds(1.0);
    for (const bool is_of_this_round : {false, true}) {
      if (is_of_this_round) {
        inputs.solution->round += 1;
        inputs.solution->stamp.time = inputs.slot.activation;
        std::erase_if(inputs.solution->choices,
                      [](const auto& each) { return each.robot == "Q1"; });
      }
      RobotPlanner planner(scenario, "Q1");
      const auto plan = planner.plan(inputs, Deadline::never());
      ASSERT_TRUE(plan);
      // The robot has no motion in this case: it hovers, or turns in front of a box that is too
      // near.
      EXPECT_EQ(planner.counts().rest_rounds + planner.counts().turns_away, 1);
      const double way_m = (models::at(plan->trajectory, Time::max()).world_from_body.position_m() -
                            plan->trajectory.start.position_m())
                               .norm();
      EXPECT_LE(way_m, 0.26) << "v² / 2a";
      moving += way_m > 0.1 ? 1 : 0;
    }
  }
  EXPECT_GE(moving, 1);
}

// A solution begins at the position that the team assumed for this robot. The robot flies the
// solution only within the tracking tolerance of that position, in any direction.
TEST(RobotPlanner, RefusesSolutionsWithAnotherStart) {
  const scenario::Scenario scenario = energy_scenario();
  const double tolerance_m = scenario.planner.tracking_tolerance_m;
  int flown = 0;
  int refused = 0;
  for (unsigned seed = 0; seed < 8; ++seed) {
    Round round(scenario, seed);
    round.exchange(0.0);
    for (int bearing = 0; bearing < 4; ++bearing) {
      for (const double share : {0.99, 1.01}) {
        PlanInputs inputs = round.inputs_of(0);
        ASSERT_TRUE(inputs.solution);
        for (models::TeamChoice& choice : inputs.solution->choices) {
          if (choice.robot == "Q1") {
            choice.trajectory.start.x_m += share * tolerance_m * std::cos(0.5 * kPi * bearing);
            choice.trajectory.start.y_m += share * tolerance_m * std::sin(0.5 * kPi * bearing);
          }
        }
        const models::TeamChoice* choice = inputs.solution->find("Q1");
        if (choice == nullptr) {
          continue;
        }
        RobotPlanner planner(scenario, "Q1");
        const auto plan = planner.plan(inputs, Deadline::never());
        ASSERT_TRUE(plan);
        const bool flies_it =
            plan->trajectory.start.position_m() == choice->trajectory.start.position_m();
        EXPECT_EQ(planner.counts().checks_failed, flies_it ? 0 : 1);
        if (share > 1.0) {
          EXPECT_FALSE(flies_it) << "seed " << seed << " bearing " << bearing;
          ++refused;
        }
        flown += flies_it ? 1 : 0;
      }
    }
  }
  EXPECT_GE(refused, 16);
  EXPECT_GE(flown, 8) << "some solutions that start near enough must be clear";
}

}  // namespace
}  // namespace vantage::planner
