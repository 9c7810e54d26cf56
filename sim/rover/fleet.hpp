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
/// Every decision keeps one invariant: the ground that each rover sweeps until it has stopped, if
/// it brakes from now on, touches neither an obstacle nor the ground that any other rover sweeps
/// so. A new command is taken only if it keeps that; braking always does. Hence no rover ever
/// touches anything (that stood clear of it at the start), and the price is a stop now and then.
class RoverFleet {
 public:
  /// How long a command is held.
  static constexpr double kDecisionPeriodS = 0.05;

  struct Start {
    Pose2 world_from_body;
    double radius_m = 0.2;
  };

  RoverFleet(const models::World& world, const scenario::TargetTruthSpec& truth,
             const std::vector<Start>& starts, std::uint64_t seed,
             const RoverParameters& parameters = {});

  /// From now on rovers come no nearer than `distance_m`, centre to centre, to these points; one
  /// that is nearer already comes no nearer still.
  void keep_out(std::vector<Eigen::Vector2d> centres_m, double distance_m);
  /// Chooses the commands for the next period; to be called every kDecisionPeriodS or earlier.
  void decide(double elapsed_s);
  /// Drives on for `dt_s`.
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
    std::vector<Eigen::Vector2d> path;  ///< to the way point; empty while it waits
    std::size_t passed = 0;             ///< points of `path` already behind
    double leg_speed_mps = 0.0;
    double pause_s = 0.0;
    double stuck_s = 0.0;  ///< since it last made headway
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
  /// Where a rover's committed path is, at most: side by side, for looking who is near among many.
  struct Around {
    Eigen::Vector2d first_m;
    double reach_m = 0.0;  ///< of its disc's edge
  };
  std::vector<Rover> rovers_;
  std::vector<Around> around_;  ///< of rovers_
  std::vector<Eigen::Vector2d> kept_out_m_;
  double keep_out_m_ = 0.0;
  std::int64_t way_points_reached_ = 0;
  std::int64_t way_points_abandoned_ = 0;
};

}  // namespace vantage::sim
