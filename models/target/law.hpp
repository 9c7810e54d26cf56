#pragma once

#include <optional>
#include <string_view>

#include "models/target/target_model.hpp"

// The motion model of a target kind (TargetLaw). Planner, estimator, scenario reader and Python use
// only this model and never test for a specific kind.

namespace vantage::models {

/// One kind of target motion, y' = c + A (y − c) + w, w ~ N(0, W). Functions are pure and do not
/// allocate.
struct TargetLaw {
  std::string_view name;  ///< name in scenarios
  /// True: the state is (y₁, y₂, ẏ₁, ẏ₂), and A and W couple only the position and velocity of the
  /// same axis. False: the state is the position, A = I and W is a multiple of I.
  bool has_velocity = false;
  /// The state never changes: A = I and W = 0 for all times.
  bool is_constant = false;
  bool uses_q = false;           ///< W is proportional to TargetModel::q
  bool uses_oscillator = false;  ///< the kind has the parameters TargetModel::oscillator
  /// Returns A, dim × dim; null: A = I.
  StateMatrix (*transition)(const TargetModel&, double dt_s) = nullptr;
  /// Returns W, dim × dim. `steps_unseen`: steps since the target was last seen, at the start of
  /// this step.
  StateMatrix (*process_noise)(const TargetModel&, double dt_s, int steps_unseen) = nullptr;
  /// Returns the position part of c; null: c = 0.
  Eigen::Vector2d (*center_m)(const TargetModel&) = nullptr;
  /// Returns W accumulated from `from_steps` to `to_steps` after the target was last seen. For
  /// kinds whose W depends on the time since then; null for other kinds.
  StateMatrix (*unseen_noise)(const TargetModel&, double from_steps, double to_steps) = nullptr;
  /// See TargetModel::as_planned(); null: unchanged.
  TargetModel (*as_planned)(const TargetModel&, double steps_unseen, double step_s) = nullptr;
  /// Returns the velocity variances, m²/s², of a target that has just been discovered; null: the
  /// scenario states these variances.
  Eigen::Vector2d (*velocity_variance)(const TargetModel&) = nullptr;
  /// Returns the rule that the parameters break, starting with the parameter's name; nullopt if it
  /// breaks none.
  std::optional<std::string_view> (*broken_rule)(const TargetModel&) = nullptr;
};

/// Returns the first rule that `model` breaks, for example "q: must be ≥ 0"; nullopt if it breaks
/// none.
std::optional<std::string_view> broken_rule(const TargetModel& model);

}  // namespace vantage::models
