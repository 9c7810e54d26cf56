#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "models/motion/unicycle.hpp"
#include "models/sensor/sensor.hpp"
#include "models/target/target_model.hpp"
#include "models/world/world.hpp"
#include "planner/decision/attack.hpp"

namespace vantage::experiments {

/// Surveillance of landmarks at known positions by a team under attack on its sensors.
struct WatchSetting {
  models::World world;  ///< an obstacle blocks robots less than `overfly_m` above it
  double overfly_m = 1.0;
  double clearance_m = 0.5;  ///< m; radius of the free disc around a robot
  std::vector<models::PositionVector> landmarks_m;
  models::TargetModel landmark_model;  ///< model of the growth of each landmark's uncertainty
  double prior_sigma_m = 1.0;          ///< 1σ of each coordinate at the start
  models::SensorModel sensor;          ///< visibility depends only on range, not on obstacles
  std::vector<models::UnicycleControl> controls;
  double step_s = 1.0;
  int task_steps = 300;
  int plan_steps = 10;
  int replan_steps = 10;  ///< ≤ plan_steps
  int attacks = 0;        ///< α: number of attacked sensors, for which a resilient team plans
  planner::Attacker attacker = planner::Attacker::kGreedy;
  /// Index of the robot with a permanently attacked sensor; −1: the attacker chooses `attacks`
  /// robots at each planning.
  int jammed_robot = -1;
  double delta_m = 2.0;  ///< m; δ of the reduced value iteration that computes the plans
};

/// Record of a run after each step; `poses` includes the start.
struct WatchRun {
  std::vector<std::vector<Pose2>> poses;    ///< indexed by [0 … steps][robot]
  std::vector<std::vector<char>> attacked;  ///< indexed by [step][robot]
  /// [step][landmark]; nonzero if observed by a robot that is not attacked
  std::vector<std::vector<char>> seen;
  std::vector<double> entropy_nats;  ///< indexed by step; mean entropy over landmarks
  int turns_on_the_spot = 0;         ///< number of robot steps without any collision-free control
};

/// Simulates surveillance. Every `replan_steps` all robots plan `plan_steps` ahead. A resilient
/// team uses RAIN: the bait robots plan alone, the others by coordinate descent as if the bait did
/// not exist. Other teams use coordinate descent. Then the attacker chooses the sensors. Beliefs
/// are those of a team that shares all observations. Only covariances are estimated, because the
/// landmark positions are known. Nothing is random. Robots are separated only by their heights. A
/// robot without any collision-free control turns on the spot.
///
/// Growing uncertainty adds q k I in the step after k steps without observation; it adds nothing
/// for landmarks in view. A plan uses each landmark's k at the time of planning for all steps.
/// @throws UsageError when a start is not free or the search refuses its problem
/// Source: dissertation Alg. 9 and 10, sections 4.F.3 and 4.F.4.
WatchRun watch(const WatchSetting& setting, std::span<const models::Viewpoint> starts,
               bool is_resilient);

/// Returns `setting.world` with the obstacles that block a robot at `height_m`.
models::World world_at(const WatchSetting& setting, double height_m);

/// Numbers of steps for which landmarks are unobserved. A landmark observed at step k and next at
/// step k + l has an interval of l. A landmark that stays in view has intervals of 1.
struct Revisits {
  double interval = 0.0;  ///< mean interval between two observations; NaN if there is none
  /// As `interval`, but the times from the start to the first observation and from the last
  /// observation to the end also count as intervals. Landmarks that are never observed thus count.
  double interval_with_ends = 0.0;
  /// Mean over landmarks of each landmark's mean interval, with the ends.
  double interval_by_landmark = 0.0;
  double age = 0.0;      ///< steps since the last observation, mean over landmarks and steps
  double absence = 0.0;  ///< mean of the intervals above 1, in which a landmark was out of view
  int longest = 0;       ///< longest interval, with the ends
  int never_seen = 0;    ///< number of landmarks never observed
};
/// Computes the revisit times of WatchRun::seen.
Revisits revisits(const std::vector<std::vector<char>>& seen);

}  // namespace vantage::experiments
