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

/// Returns an empty plan of a slot, without motion, cost or bound.
models::RobotPlan blank_plan(const scenario::PlannerSpec& planner, const std::string& robot,
                             const RoundSchedule::Slot& slot);

/// Chooser of the motion to publish in a slot: a found motion if it passes the closing check;
/// otherwise the last plan, shifted and checked again; otherwise braking to a hover. Functions
/// return nullopt if their motion is not feasible; fall_back() always succeeds. Each choice is
/// counted.
class PlanLadder {
 public:
  /// All references must outlive this object. `committed` is the robot's motion from the problem's
  /// start.
  PlanLadder(const SearchProblem& problem, const models::Trajectory& committed,
             models::RobotPlan blank, PlannerCounts& counts)
      : problem_(problem), committed_(committed), plan_(std::move(blank)), counts_(counts) {}

  /// Sets the number of search nodes in every plan.
  void set_nodes(std::int64_t nodes) { plan_.nodes = nodes; }

  /// Returns the plan of a search result; nullopt if no motion was found or the motion is not safe.
  [[nodiscard]] std::optional<models::RobotPlan> searched(const SearchResult& result);
  /// Returns the plan of a chosen motion, or of one that an external planner sent; nullopt if the
  /// motion is not safe.
  [[nodiscard]] std::optional<models::RobotPlan> chosen(const models::Trajectory& motion);
  /// Returns the plan of the robot's own proposal; nullopt (not counted) if the proposal is not
  /// from a search or is not safe in this slot.
  [[nodiscard]] std::optional<models::RobotPlan> proposed(const models::RobotPlan& proposal) const;
  /// Returns the plan to stop and hover, marked as the result of a search; nullopt if stopping is
  /// not safe.
  [[nodiscard]] std::optional<models::RobotPlan> hovering();
  /// Returns a turn on the spot, which is safe wherever hovering is.
  [[nodiscard]] models::RobotPlan turned(models::Trajectory turning);
  /// Returns braking to a hover if that is safe, otherwise fall_back().
  [[nodiscard]] models::RobotPlan stopped();
  /// Returns the shifted plan if it is safe, otherwise braking to a hover.
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
