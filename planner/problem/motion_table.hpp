#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "planner/problem/problem.hpp"
#include "planner/problem/sight.hpp"

namespace vantage::planner {

/// The controls of a problem, worked out once in the body frame, and what they may not touch: the
/// world's obstacles and walls (a disc) and the teammates' committed motion (a distance in space).
///
/// Everything a child node costs besides its information. reset() allocates up to the sizes asked
/// for at construction; the queries allocate nothing.
class MotionTable {
 public:
  static constexpr int kPieces = 5;  ///< straight pieces that an arc is checked as
  static constexpr int kParts = 16;  ///< parts that an arc is held against the field in

  MotionTable(int controls_max, int horizon_max, int teammates_max);

  /// Tables `problem`, which must outlive the queries.
  void reset(const SearchProblem& problem);

  /// The pose after control `c`, given the cosine and sine of the heading at `from`.
  [[nodiscard]] Pose2 child(const Pose2& from, double cos_yaw, double sin_yaw, int c) const {
    const Primitive& p = primitives_[static_cast<std::size_t>(c)];
    return {from.x_m + cos_yaw * p.end.x_m - sin_yaw * p.end.y_m,
            from.y_m + sin_yaw * p.end.x_m + cos_yaw * p.end.y_m,
            wrap_turn(from.yaw_rad + p.end.yaw_rad)};
  }
  /// Places and headings after each control in turn, side by side: child() without the yaw.
  void children(const Pose2& from, double cos_yaw, double sin_yaw, Views& out) const;
  /// Yaw after control `c`.
  [[nodiscard]] double child_yaw_rad(const Pose2& from, int c) const {
    return wrap_turn(from.yaw_rad + primitives_[static_cast<std::size_t>(c)].end.yaw_rad);
  }

  /// True when control `c` from `from` at depth `depth` (before the step) touches nothing.
  [[nodiscard]] bool is_free(const Pose2& from, double cos_yaw, double sin_yaw, int c,
                             int depth) const;

  /// True when the vehicle, arriving at `at` by control `c` at depth `depth`, can stop straight
  /// ahead and hover there for ever, clear and apart. True when no stop is demanded.
  [[nodiscard]] bool can_stop(const Pose2& at, int c, int depth) const {
    return can_stop_at(at, primitives_[static_cast<std::size_t>(c)].control.speed_mps, depth);
  }
  /// The same at the very start, with the problem's start speed.
  [[nodiscard]] bool can_stop_from_start() const {
    return can_stop_at(problem_->start, problem_->start_speed_mps, 0);
  }

  /// True when no obstacle or wall can be touched within one step of `p_m` by any control.
  [[nodiscard]] bool is_open_space(const Eigen::Vector2d& p_m) const;

  [[nodiscard]] int control_count() const { return static_cast<int>(primitives_.size()); }
  /// Longest way of one step, m.
  [[nodiscard]] double reach_m() const { return reach_m_; }

 private:
  /// wrap_to_pi, to the bit, without a division where the sum of two wrapped angles is given.
  [[nodiscard]] static double wrap_turn(double sum_rad) {
    const double wrapped = sum_rad > kPi     ? sum_rad - 2.0 * kPi
                           : sum_rad <= -kPi ? sum_rad + 2.0 * kPi
                                             : sum_rad;
    return std::abs(wrapped) < kPi ? wrapped : wrap_to_pi(sum_rad);
  }
  [[nodiscard]] bool can_stop_at(const Pose2& at, double speed_mps, int depth) const;

  struct Primitive {
    Pose2 end;                             ///< body at start from body at end
    Eigen::Vector2d piece_end_m[kPieces];  ///< in the body frame at the start
    Pose2 along[kParts];                   ///< in the body frame, after k parts of kParts
    double length_m = 0.0;
    double sagitta_m = 0.0;  ///< of one piece
    models::UnicycleControl control;
  };
  struct TeammatePiece {
    Eigen::Vector3d from_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d to_m = Eigen::Vector3d::Zero();
    double slack_m = 0.0;  ///< how far the true path may be from the straight piece
  };

  [[nodiscard]] bool is_apart(const Pose2& from, double cos_yaw, double sin_yaw,
                              const Primitive& primitive, int depth) const;

  /// Whether parts `begin` … `end` touch the world: by the distance field where that can tell, by
  /// exact distances where it cannot.
  [[nodiscard]] bool is_clear(const Pose2& from, double cos_yaw, double sin_yaw,
                              const Primitive& primitive, int begin, int end) const;

  const SearchProblem* problem_ = nullptr;
  std::vector<Primitive> primitives_;
  Views ends_;  ///< the primitives' ends in the body frame, side by side
  double reach_m_ = 0.0;
  int pieces_each_ = 0;                         ///< of one teammate: until everybody hovers
  std::vector<TeammatePiece> teammate_pieces_;  ///< [teammate][depth][piece]
  std::vector<double> step_ways_m_;             ///< [teammate][depth]: at most, in one step
  std::vector<double> kept_m_;                  ///< [teammate]: kept_separation_m
};

/// True when a disc of `radius_m` carried along `control` for `duration_s` stays clear of the
/// world. Exact for a straight line; to 1e-6 m for an arc, which is halved until each part is clear
/// by its middle's clearance or touches. No allocation; cost grows with the closeness of obstacles.
bool arc_is_clear(const models::World& world, const Pose2& from,
                  const models::UnicycleControl& control, double duration_s, double radius_m);

}  // namespace vantage::planner
