#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/deadline.hpp"
#include "models/exchange/messages.hpp"
#include "planner/decision/resilient.hpp"
#include "planner/mapping/map_planner.hpp"
#include "planner/problem/fixed_information.hpp"
#include "planner/robot/round.hpp"
#include "planner/robot/slot_colour.hpp"
#include "planner/robot/team_exchange.hpp"
#include "planner/robot/workspace.hpp"
#include "planner/search/catalogue.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// Everything that one robot's plan of one round is made from. Absent: not heard (yet).
struct PlanInputs {
  RoundSchedule::Slot slot;
  std::optional<models::RobotBelief> belief;                   ///< own
  std::optional<models::RobotMap> map;                         ///< own, of a scenario that maps
  std::optional<models::MocapFrame> mocap;                     ///< where everybody is
  std::optional<models::RobotPlan> own_plan;                   ///< last one published
  std::map<std::string, models::RobotPlan> team_plans;         ///< newest of each teammate
  std::map<std::string, models::VehicleStatus> team_statuses;  ///< do all follow their plans?
  std::map<std::string, models::PlanProposal> proposals;       ///< newest of each robot, own too
  std::optional<models::TeamProposal> solution;                ///< best known of a local search
  std::optional<models::AttackNotice> attack;
  std::optional<models::RobotPlan> answer;  ///< of the process that is asked for plans
};

/// What happened besides the plan, since construction.
struct PlannerCounts {
  std::int64_t fallbacks_shifted = 0;
  std::int64_t fallbacks_braking = 0;
  std::int64_t off_plan = 0;       ///< vehicle farther from its plan than the tolerance
  std::int64_t checks_failed = 0;  ///< searched plans that the closing check refused
  std::int64_t turns_away = 0;     ///< at rest too near a teammate or a wall, with no way out ahead
  std::int64_t baits = 0;          ///< rounds in which this robot was bait
  std::int64_t rests = 0;          ///< rounds in which no motion was worth its energy
  std::int64_t yields = 0;         ///< rounds in which its slot was another's, or only claimed
  std::int64_t no_pose = 0;        ///< rounds without any idea of where the robot is
  std::int64_t unknown_plan = 0;   ///< rounds in which it flew a plan of before a restart
  /// Targets that cannot be predicted (of a clock that was ahead, say) or that the scenario has
  /// not, and grids of another geometry.
  std::int64_t unusable_beliefs = 0;
  std::int64_t unusable_maps = 0;    ///< of another grid than the scenario's
  std::int64_t answers_refused = 0;  ///< that are no plan of their slot (motion_of_answer())
};

/// One robot's share of a planning round, as a function of its inputs (and, for the sweeping
/// baseline, of how far the sweep has got). Knows no clock: the caller says whether it was late.
///
/// The robot plans from where its committed plan has it at t_{k+1}, against the teammates' newest
/// plans (their information and their swept motion). A teammate that is silent is taken to go on
/// with its last plan, whose end is a hover; from one that says it does not follow plans its own
/// place is kept free as well. The ladder: the best complete plan; else the last one shifted and
/// checked again; else braking to a hover.
///
/// A planner that was started anew does not know what its robot flies, but every teammate does: it
/// waits until that plan has come to its hover, and plans from there.
///
/// Where slots are shared it searches in its slot only if no neighbour of lower index has it, and
/// not in the first round after it took it; else it goes on with what it is committed to.
///
/// What the search gains is the scenario's planner.objective: the targets' beliefs or the map. All
/// else is the same for both.
///
/// In a team that expects attacks (planner.attacks_max = α > 0) each robot first proposes what it
/// would do alone. The α proposals of greatest value are the bait: those robots do as they
/// proposed, and the others plan as if the bait saw nothing. Source: dissertation Alg. 9, 10
/// (RAIN).
///
/// In a team that plans by local search (planner.team_algorithm) robots exchange proposals instead,
/// begin_exchange() … improve(), and each plan does what the solution of its inputs gives the
/// robot: a motion, which passes the closing check or falls back, or rest: so does a robot
/// without any. A robot that pays for its energy (energy.price_nats > 0) weighs it in
/// coordinate descent too, where no attacks are expected. Source: docs/decisions/0006.
///
/// A robot of planner.algorithm `external` searches nothing: its plan is the answer in its inputs,
/// if that passes the closing check, else what it falls back on.
class RobotPlanner {
 public:
  RobotPlanner(const scenario::Scenario& scenario, const std::string& robot);
  /// One of several planners that take turns in one workspace.
  RobotPlanner(std::shared_ptr<Workspace> workspace, const std::string& robot);

  /// For real time: no page of the search's memory is faulted in later.
  void prefault() { workspace_->prefault(); }

  /// The plan of this slot. nullopt while the robot's pose was never known, and
  /// while it flies a plan from before a restart.
  std::optional<models::RobotPlan> plan(const PlanInputs& inputs, const Deadline& deadline);

  /// What the robot would do in this slot's round if it were the only one that looks; the
  /// teammates' committed motions are kept clear of. nullopt where plan() is.
  std::optional<models::PlanProposal> propose(const PlanInputs& inputs, const Deadline& deadline);

  /// Local search: begins the round of this slot, with candidates that are found by `deadline`.
  /// false where plan() is nullopt: then nothing is heard or proposed.
  bool begin_exchange(const PlanInputs& inputs, const Deadline& deadline);
  /// Precondition: the team plans by local search.
  [[nodiscard]] TeamExchange& exchange() { return *exchange_; }

  /// Of planner.algorithm `external`: what another process is asked. The committed motion from
  /// t_{k+1} on, as a plan that nobody searched; an answer begins where it does. nullopt where
  /// plan() is. Counts nothing.
  std::optional<models::RobotPlan> question(const PlanInputs& inputs);

  /// What to publish instead when the search ended after its slot: teammates may already count on
  /// the old plan, which every other committed plan is compatible with.
  std::optional<models::RobotPlan> plan_without_search(const PlanInputs& inputs);

  /// Which slot of the next round is the robot's, after it has published in its last one.
  [[nodiscard]] int next_place(const PlanInputs& inputs) const;

  [[nodiscard]] const PlannerCounts& counts() const { return counts_; }
  /// TEAM_PROPOSALs of a round that cannot be, since construction.
  [[nodiscard]] std::int64_t proposals_refused() const {
    return exchange_ ? exchange_->refused() : 0;
  }
  [[nodiscard]] int robot_index() const { return robot_index_; }
  [[nodiscard]] int robot_count() const { return static_cast<int>(scenario_.robots.size()); }

  /// The problem of the last plan(), for pictures and tests.
  [[nodiscard]] const SearchProblem& problem() const { return problem_; }

 private:
  [[nodiscard]] models::RobotPlan blank_plan(const PlanInputs& inputs) const;
  /// The motion that the robot is committed to, cut to start at t_{k+1}; nullopt, and counted,
  /// while its pose was never known or it moves as nobody here knows.
  std::optional<models::Trajectory> committed_motion(const PlanInputs& inputs);
  /// Where the vehicle holds, when it says so and that is off its plan.
  [[nodiscard]] std::optional<Pose2> hover_off_plan(const PlanInputs& inputs) const;
  /// The vehicle says that it follows a plan that can still be moving when the slot begins.
  [[nodiscard]] bool flies_unknown_plan(const PlanInputs& inputs) const;
  /// What the proposals of the slot's round that were heard make of it.
  [[nodiscard]] ResilientRound round_of(const PlanInputs& inputs) const;
  /// The teammates, in the scenario's order; those of `unseeing` robots tell nothing.
  [[nodiscard]] std::vector<FixedTeammate> fixed_teammates(const PlanInputs& inputs,
                                                           const std::vector<int>& unseeing) const;
  /// Whether the slot is this robot's alone among its neighbours.
  [[nodiscard]] bool has_slot(const PlanInputs& inputs) const;
  [[nodiscard]] std::vector<SlotHolder> slots_of_neighbours(const PlanInputs& inputs) const;
  /// Whether a teammate at `place` can matter to this slot's plan.
  [[nodiscard]] bool is_near(const Pose2& place) const;
  [[nodiscard]] std::size_t index_of(const scenario::RobotSpec& robot) const {
    return static_cast<std::size_t>(&robot - scenario_.robots.data());
  }
  /// Where teammates hover or stand that do not follow plans.
  [[nodiscard]] std::vector<models::Trajectory> hovers_of_those_who_wait(
      const PlanInputs& inputs) const;
  void set_up_problem(const PlanInputs& inputs, const models::Trajectory& committed,
                      const std::vector<int>& unseeing);
  [[nodiscard]] std::vector<int> all_robots() const;
  /// Makes `plan` of what a search found; false when that is nothing, or not safe.
  bool take(const SearchResult& result, models::RobotPlan& plan);
  /// Makes `plan` of what was proposed; false when that was not searched, or is not safe now.
  bool take(const models::RobotPlan& proposed, models::RobotPlan& plan) const;
  void add_targets(const models::RobotBelief& belief, Time start);
  void add_landmarks(const models::RobotBelief& belief, Time start);
  const SearchResult& search(const PlanInputs& inputs, const Deadline& deadline);
  [[nodiscard]] bool keeps_apart(const models::Trajectory& trajectory, double rounding_m) const;
  [[nodiscard]] bool is_safe(const models::Trajectory& trajectory) const;
  /// The nearest teammate that is nearer than asked for, by index; nullopt: none.
  [[nodiscard]] std::optional<std::size_t> too_near() const;
  /// On the spot, by an eighth of a turn: away from the teammate or, once it faces away, on and on,
  /// until some heading has a way out. Turning moves no disc, so it is safe wherever hovering is.
  void turn_away_from(std::size_t teammate, models::RobotPlan& plan);
  /// The same where walls or teammates are so near ahead that no motion can begin: towards the
  /// nearest heading with a way out. False, and nothing done, where there is one already, unless
  /// the search says otherwise (`is_boxed_in`: then on and on, to the left), and where there is
  /// none.
  bool turn_to_a_way_out(bool is_boxed_in, models::RobotPlan& plan);
  /// An eighth of a turn on the spot, to the side of `off_rad`; to the left when that is nearly
  /// ahead.
  void turn(double off_rad, models::RobotPlan& plan);
  void begin_candidates(const PlanInputs& inputs, const models::Trajectory& committed,
                        const Deadline& deadline);
  /// Coordinate descent over candidates, what they cost included.
  models::RobotPlan plan_by_worth(const PlanInputs& inputs, const models::Trajectory& committed,
                                  const Deadline& deadline);
  /// Stops and rests; false where that is not safe.
  bool rest(const models::Trajectory& committed, models::RobotPlan& plan);
  /// What `inputs.solution` gives this robot, checked.
  models::RobotPlan plan_of_solution(const PlanInputs& inputs, const models::Trajectory& committed);
  /// What `inputs.answer` gives this robot, checked.
  models::RobotPlan plan_of_answer(const PlanInputs& inputs, const models::Trajectory& committed);
  /// Shifted or braking, whichever is first safe.
  void fall_back(const models::Trajectory& committed, models::RobotPlan& plan);

  std::shared_ptr<Workspace> workspace_;
  const scenario::Scenario& scenario_;         ///< the workspace's
  const scenario::RobotSpec* spec_ = nullptr;  ///< of this robot, in scenario_
  int robot_index_ = 0;
  std::optional<RoundSchedule> schedule_;  ///< where slots may be shared
  /// One of them at most, by the scenario's objective and algorithm.
  std::optional<MapPlanner> mapping_;
  Search* search_ = nullptr;                ///< the workspace's, or own_search_
  std::unique_ptr<Search> own_search_;      ///< of one that remembers
  std::unique_ptr<TeamExchange> exchange_;  ///< where plans are chosen from candidates
  SearchProblem problem_;
  std::vector<std::size_t>
      teammates_;  ///< of problem_, those before who only waits: whose they are
  SearchResult mapping_result_;
  PlannerCounts counts_;
};

}  // namespace vantage::planner
