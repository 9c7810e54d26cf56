#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "logs/foxglove/parts.hpp"
#include "logs/metrics/team_estimate.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

// What vantage's values look like: foxglove.SceneUpdate messages, in metres. Bodies are drawn in
// frames of their own name ("Q1"), which foxglove.FrameTransforms move; so a body is described once
// and not at each mocap frame. Pure.

namespace vantage::logs::foxglove {

/// What tells one robot from another wherever it is drawn or charted: by its place in the scenario,
/// whatever is heard first: the body's of robot_look() (logs/look). nullopt of what is no robot of
/// the scenario.
std::optional<Colour> robot_colour(const scenario::Scenario& scenario, const std::string& robot);

/// Bounds, obstacles and regions.
Json world_scene(const models::World& world, Time time);

/// Every robot in its colour, from the ninth on with a core of another; the `jammed` in red, their
/// own colour as the core.
Json robots_scene(const scenario::Scenario& scenario, const std::set<std::string>& jammed,
                  Time time);

/// What each robot's sensor can see of the ground when nothing stands in its way; red when jammed.
Json views_scene(const scenario::Scenario& scenario, const std::set<std::string>& jammed,
                 Time time);

/// Every target as it really is (in the frame that mocap or truth gives it).
Json targets_scene(const scenario::Scenario& scenario, Time time);

/// One committed trajectory: its line at its height, a mark where it ends. Grey when it was not
/// searched but shifted or braked, orange when it was late.
/// @param of_robot  the robot's colour; nullopt while no scenario tells it: the first one's
Json plan_scene(const models::RobotPlan& plan, const std::optional<Colour>& of_robot);

/// A proposed solution of the team, all its trajectories as thin dashes in the proposer's colour,
/// from when it was `heard` until they would start, the end of the round. Those of robots next to
/// each other in the scenario fill each other's gaps where they agree.
/// Preconditions: heard < proposal.stamp.time, the proposer is a robot of the scenario.
Json proposal_scene(const models::TeamProposal& proposal, const scenario::Scenario& scenario,
                    Time heard);

/// One target as somebody knows it.
struct EstimateView {
  int target_id = 0;
  std::string name;
  PositionEstimate estimate;
  std::optional<double> error_m;  ///< against the truth
  Duration lifetime{0};           ///< how long it is shown without news; 0: until it is gone
};

/// Ellipses of probability 0.95 and means, one entity `<prefix>/<name>` each; metadata say who
/// knows it and how well. `gone` are those that nobody knows (any more).
Json estimates_scene(const std::string& prefix, const std::vector<EstimateView>& estimates,
                     const std::vector<std::string>& gone, Time time);

/// The boundary of {p : (p − μ)ᵀ Σ⁻¹ (p − μ) = look().ellipse_radius()²} of the first two
/// coordinates, in `count` points, at the third coordinate of the mean (0 for a planar one).
std::vector<Eigen::Vector3d> ellipse(const PositionEstimate& estimate, int count);

/// Where a body has been, oldest first. `of_robot`: the robot's colour; nullopt of a target.
Json track_entity(const std::string& body, const std::vector<Eigen::Vector3d>& points,
                  const std::optional<Colour>& of_robot, Time time);

/// Lines from a sensor to what it saw. Detections that tell no position alone (range or bearing
/// only), or that another kind of sensor made, are left out.
Json measurement_scene(const models::DetectionSet& detections, const models::SensorModel& sensor,
                       int position_dim);

}  // namespace vantage::logs::foxglove
