#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "scenario/scenario.hpp"
#include "sim/rover/route.hpp"
#include "sim/rover/rover.hpp"

namespace vantage::sim {

/// Rovers that drive to random way points around obstacles and each other.
///
/// Every decision preserves one invariant. The *stopping area* of a rover is the ground that it
/// sweeps if it brakes to a stop from now on. This area is clear of all obstacles and of all other
/// stopping areas. A new command is accepted only if it preserves the invariant; braking always
/// preserves it. A rover that was clear of all bodies and obstacles at the start therefore never
/// touches a body or obstacle, but it may stop occasionally.
class RoverFleet {
 public:
  /// s; time for which a command is applied.
  static constexpr double kDecisionPeriodS = 0.05;

  struct Start {
    Pose2 world_from_body;
    double radius_m = 0.2;
  };

  RoverFleet(const models::World& world, const scenario::TargetTruthSpec& truth,
             const std::vector<Start>& starts, std::uint64_t seed,
             const RoverParameters& parameters = {});

  /// Keeps the centres of rovers at least `distance_m` from these points from now on. A rover that
  /// is already nearer does not come nearer.
  void keep_out(std::vector<Eigen::Vector2d> centres_m, double distance_m);
  /// Chooses the commands for the next period. Call this at least every kDecisionPeriodS.
  void decide(double elapsed_s);
  /// Moves all rovers for `dt_s`.
  void step(double dt_s);

  [[nodiscard]] std::size_t size() const { return rovers_.size(); }
  [[nodiscard]] const RoverState& state(std::size_t i) const { return rovers_[i].state; }
  [[nodiscard]] double radius_m(std::size_t i) const { return rovers_[i].radius_m; }
  [[nodiscard]] std::int64_t way_points_reached() const { return way_points_reached_; }
  [[nodiscard]] std::int64_t way_points_abandoned() const { return way_points_abandoned_; }

 private:
  struct Rover {
    RoverState state;
    RoverCommand command;
    StoppingPath committed;
    double radius_m = 0.0;
    std::mt19937_64 rng;
    std::vector<Eigen::Vector2d> path;  ///< path to the way point; empty while the rover waits
    std::size_t passed = 0;             ///< number of points of `path` already passed
    double leg_speed_mps = 0.0;
    double pause_s = 0.0;
    double stuck_s = 0.0;  ///< s; time since the rover's last progress
    bool rerouted = false;
    Eigen::Vector2d headway_m = Eigen::Vector2d::Zero();
  };

  [[nodiscard]] std::vector<Disc> neighbours(std::size_t i) const;
  void choose_way_point(std::size_t i);
  void supervise(std::size_t i, double elapsed_s);
  [[nodiscard]] RoverCommand desired(Rover& rover) const;
  void commit(std::size_t i, const StoppingPath& path);
  [[nodiscard]] bool is_safe(std::size_t i, const StoppingPath& path) const;

  models::World world_;
  scenario::TargetTruthSpec truth_;
  RoverParameters parameters_;
  RouteMap map_;
  /// Disc around a rover's stopping path. All discs are in one array, for a fast search of near
  /// rovers.
  struct Reach {
    Eigen::Vector2d first_m;
    double reach_m = 0.0;  ///< m; distance from first_m to the farthest point of the rover's body
  };
  std::vector<Rover> rovers_;
  std::vector<Reach> reaches_;  ///< disc of each rover's stopping path
  std::vector<Eigen::Vector2d> kept_out_m_;
  double keep_out_m_ = 0.0;
  std::int64_t way_points_reached_ = 0;
  std::int64_t way_points_abandoned_ = 0;
};

}  // namespace vantage::sim
