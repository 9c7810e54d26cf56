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

// Drawings of vantage's values as foxglove.SceneUpdate messages, in metres. Bodies are drawn in
// frames of their own name ("Q1"), which foxglove.FrameTransforms move. So a body is described once
// instead of at each mocap frame. Free of side effects.

namespace vantage::logs::foxglove {

/// Returns the colour that identifies a robot in drawings and charts: the body colour of
/// robot_appearance() (logs/appearance). It depends on the robot's index in the scenario, so the
/// order of messages does not matter. Returns nullopt if `robot` is not a robot of the scenario.
std::optional<Colour> robot_colour(const scenario::Scenario& scenario, const std::string& robot);

/// Draws bounds, obstacles and regions.
Json world_scene(const models::World& world, Time time);

/// Draws every robot in its colour, with a core of another colour from the ninth robot on. The
/// `jammed` robots are red, with their own colour as core.
Json robots_scene(const scenario::Scenario& scenario, const std::set<std::string>& jammed,
                  Time time);

/// Draws the ground area that each robot's sensor covers without occlusion, in red for jammed
/// robots.
Json views_scene(const scenario::Scenario& scenario, const std::set<std::string>& jammed,
                 Time time);

/// Draws every target at its true pose (in its frame from mocap or truth).
Json targets_scene(const scenario::Scenario& scenario, Time time);

/// Draws one committed trajectory: a line at its height, and a mark at its end. The line is grey if
/// the plan was shifted or braked instead of searched, and orange if the plan was late.
/// @param of_robot  the robot's colour; nullopt (no scenario yet): the first robot's colour is used
Json plan_scene(const models::RobotPlan& plan, const std::optional<Colour>& of_robot);

/// Draws all trajectories of a team proposal as thin dashes in the proposer's colour, from its
/// reception at `received_at` until the trajectories would start at the end of the round. Robots
/// that are adjacent in the scenario have complementary dashes, so that equal trajectories remain
/// distinguishable. Preconditions: `received_at` < proposal.stamp.time, the proposer is a robot of
/// the scenario.
Json proposal_scene(const models::TeamProposal& proposal, const scenario::Scenario& scenario,
                    Time received_at);

/// One target as a robot or the team estimates it.
struct EstimateView {
  int target_id = 0;
  std::string name;
  PositionEstimate estimate;
  std::optional<double> error_m;  ///< m; distance of the mean from the true position
  Duration lifetime{0};           ///< display time without an update; 0: until it is deleted
};

/// Draws means and ellipses of probability 0.95, one entity `<prefix>/<name>` each, with metadata
/// on the robot and the quality. `gone`: targets without an estimate; their entities are deleted.
Json estimates_scene(const std::string& prefix, const std::vector<EstimateView>& estimates,
                     const std::vector<std::string>& gone, Time time);

/// Returns `count` points of {p : (p − μ)ᵀ Σ⁻¹ (p − μ) = appearance().ellipse_radius()²} in the
/// first two coordinates, at the third coordinate of the mean (0 for a planar mean).
std::vector<Eigen::Vector3d> ellipse(const PositionEstimate& estimate, int count);

/// Draws the past path of a body, oldest point first. `of_robot`: the robot's colour; nullopt for a
/// target.
Json track_entity(const std::string& body, const std::vector<Eigen::Vector3d>& points,
                  const std::optional<Colour>& of_robot, Time time);

/// Draws lines from a sensor to its detections. Detections without a full position (range or
/// bearing only), or of another sensor kind, are left out.
Json measurement_scene(const models::RobotMeasurement& detections,
                       const models::SensorModel& sensor, int position_dim);

}  // namespace vantage::logs::foxglove
