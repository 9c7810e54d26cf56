#pragma once

#include <optional>
#include <string>
#include <utility>

#include "models/exchange/messages.hpp"
#include "planner/problem/problem.hpp"
#include "planner/robot/planner_counts.hpp"
#include "planner/robot/round.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// A plan of that slot that says nothing yet: no motion, no cost, nothing proven.
models::RobotPlan blank_plan(const scenario::PlannerSpec& planner, const std::string& robot,
                             const RoundSchedule::Slot& slot);

/// What is published in one slot: a motion that was found, where the closing check lets it pass;
/// else the last plan, shifted and checked again; else braking to a hover. A rung that does not
/// bear gives nullopt; fall_back() always bears. Counts which it was.
class PlanLadder {
 public:
  /// All but `blank` must outlive it. `committed` is the robot's motion from the problem's start.
  PlanLadder(const SearchProblem& problem, const models::Trajectory& committed,
             models::RobotPlan blank, PlannerCounts& counts)
      : problem_(problem), committed_(committed), plan_(std::move(blank)), counts_(counts) {}

  /// Says of every plan what work it took.
  void set_nodes(std::int64_t nodes) { plan_.nodes = nodes; }

  /// What a search found; nullopt when that is nothing, or not safe.
  [[nodiscard]] std::optional<models::RobotPlan> searched(const SearchResult& result);
  /// A motion that was chosen or answered.
  [[nodiscard]] std::optional<models::RobotPlan> chosen(const models::Trajectory& motion);
  /// The robot's own proposal; nullopt, not counted, when it was not searched or is not safe now.
  [[nodiscard]] std::optional<models::RobotPlan> proposed(const models::RobotPlan& proposal) const;
  /// Stops and rests, which is what the search found.
  [[nodiscard]] std::optional<models::RobotPlan> rest();
  /// A turn on the spot, safe wherever hovering is.
  [[nodiscard]] models::RobotPlan turned(models::Trajectory turning);
  /// Braking to a hover where that is safe, else as fall_back().
  [[nodiscard]] models::RobotPlan stopped();
  /// Shifted or braking, whichever is first safe.
  [[nodiscard]] models::RobotPlan fall_back();

 private:
  [[nodiscard]] models::RobotPlan plan_of(models::Trajectory motion,
                                          models::PlanSource source) const;
  [[nodiscard]] models::Trajectory stop() const;

  const SearchProblem& problem_;
  const models::Trajectory& committed_;
  models::RobotPlan plan_;
  PlannerCounts& counts_;
};

}  // namespace vantage::planner
