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

/// A team that watches landmarks whose places are known while sensors are taken from it.
struct WatchSetting {
  models::World world;  ///< what is lower than a robot by `overfly_m` does not hinder its way
  double overfly_m = 1.0;
  double clearance_m = 0.5;  ///< the disc around a robot that must be free
  std::vector<models::PositionVector> landmarks_m;
  models::TargetModel landmark_model;  ///< how what is known of each fades
  double prior_sigma_m = 1.0;          ///< 1σ of each coordinate at the start
  models::SensorModel sensor;          ///< obstacles do not hide a landmark: range alone counts
  std::vector<models::UnicycleControl> controls;
  double step_s = 1.0;
  int task_steps = 300;
  int plan_steps = 10;
  int replan_steps = 10;  ///< ≤ plan_steps
  int attacks = 0;        ///< α of a resilient team, and how many sensors are taken
  planner::Attacker attacker = planner::Attacker::kGreedy;
  /// The robot whose sensor is always taken; −1: those `attacks` that the attacker chooses at each
  /// planning, until the next.
  int jammed_robot = -1;
  double delta_m = 2.0;  ///< of the reduced value iteration that makes the plans
};

/// A run: what was after each step; poses of the start as well.
struct WatchRun {
  std::vector<std::vector<Pose2>> poses;    ///< [0 … steps][robot]
  std::vector<std::vector<char>> attacked;  ///< [step][robot]
  std::vector<std::vector<char>> seen;      ///< [step][landmark], by a robot that is not attacked
  std::vector<double> entropy_nats;         ///< [step], mean over landmarks
  int turns_on_the_spot = 0;                ///< robots' steps for want of any control that is free
};

/// Every `replan_steps` all plan `plan_steps` ahead, a resilient team by RAIN (the bait alone, the
/// rest by coordinate descent as if the bait did not exist), else by coordinate descent; then the
/// attacker chooses. Beliefs are those of a team that shares everything, without the measurements
/// themselves: landmarks are where they are known to be. Nothing in it is random. Robots keep apart
/// by their heights alone. A robot that no control is free for turns on the spot.
///
/// Growing uncertainty adds q k I in the step after k steps unseen: nothing to what is in view. A
/// plan takes each landmark's k as it is when it is made, for all of its steps.
/// @throws UsageError when a start is not free or a search's rule is broken
/// Source: dissertation Alg. 9, 10, ch. 4 F.3, F.4.
WatchRun watch(const WatchSetting& setting, std::span<const models::Viewpoint> starts,
               bool is_resilient);

/// `setting.world` as a robot at `height_m` finds it.
models::World world_at(const WatchSetting& setting, double height_m);

/// How long landmarks go unobserved, in steps. A landmark that is observed at step k and next at
/// step k + l has an interval of l; one that stays in view has intervals of 1.
struct Revisits {
  double interval = 0.0;  ///< mean of the intervals between two observations; NaN: there is none
  /// The same with the wait from the start to the first observation, and that from the last one to
  /// the end, as intervals: nothing that is never seen goes unnoticed.
  double interval_with_ends = 0.0;
  /// The mean over landmarks of each one's own mean interval, with the ends.
  double interval_by_landmark = 0.0;
  double age = 0.0;      ///< mean over landmarks and steps of the steps since it was observed
  double absence = 0.0;  ///< mean of the intervals above 1: from losing a landmark to its return
  int longest = 0;       ///< of all of these, with the ends
  int never_seen = 0;    ///< landmarks
};
/// Of WatchRun::seen.
Revisits revisits(const std::vector<std::vector<char>>& seen);

}  // namespace vantage::experiments
