#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/index.hpp"
#include "core/pose.hpp"
#include "planner/problem/problem.hpp"
#include "planner/problem/sight.hpp"

namespace vantage::planner {

/// The controls of a problem, precomputed in the body frame, and their collision checks: against
/// the world's obstacles and walls (a disc) and the teammates' committed motion (a distance in
/// space).
///
/// Provides the poses and the feasibility of child nodes, but not their information. reset()
/// allocates only up to the sizes given to the constructor; the queries allocate nothing.
class MotionTable {
 public:
  static constexpr int kPieces = 5;  ///< number of straight pieces per arc in separation checks
  static constexpr int kParts = 16;  ///< number of parts per arc in checks with the distance field

  /// `steps_max`: steps from the start until every teammate hovers and this robot's last stop has
  /// ended.
  MotionTable(int controls_max, int steps_max, int teammates_max);

  /// Tabulates `problem`, which must outlive the queries.
  void reset(const SearchProblem& problem);

  /// Returns the pose after control `c`, given the cosine and sine of the heading at `from`.
  [[nodiscard]] Pose2 child(const Pose2& from, double cos_yaw, double sin_yaw, int c) const {
    const Primitive& p = primitives_[index(c)];
    return {from.x_m + cos_yaw * p.end.x_m - sin_yaw * p.end.y_m,
            from.y_m + sin_yaw * p.end.x_m + cos_yaw * p.end.y_m,
            wrap_turn(from.yaw_rad + p.end.yaw_rad)};
  }
  /// Computes the resulting position and heading vector for each control, four controls at a time.
  /// Unlike child(), it does not compute the yaw.
  void children(const Pose2& from, double cos_yaw, double sin_yaw, Views& out) const;
  /// Returns the yaw after control `c`, rad.
  [[nodiscard]] double child_yaw_rad(const Pose2& from, int c) const {
    return wrap_turn(from.yaw_rad + primitives_[index(c)].end.yaw_rad);
  }

  /// True if control `c` from `from`, at depth `depth` before the step, collides with nothing.
  [[nodiscard]] bool is_free(const Pose2& from, double cos_yaw, double sin_yaw, int c,
                             int depth) const;

  /// True if the vehicle, arriving at `at` by control `c` at depth `depth`, can brake straight
  /// ahead and then hover without collision. Always true if the problem requires no stop.
  [[nodiscard]] bool can_stop(const Pose2& at, int c, int depth) const {
    return can_stop_at(at, primitives_[index(c)].control.speed_mps, depth);
  }
  /// As can_stop(), at the start pose with the problem's start speed.
  [[nodiscard]] bool can_stop_from_start() const {
    return can_stop_at(problem_->start, problem_->start_speed_mps, 0);
  }

  /// True if no control can reach an obstacle or wall within one step of `p_m`.
  [[nodiscard]] bool is_open_space(const Eigen::Vector2d& p_m) const;

  [[nodiscard]] int control_count() const { return static_cast<int>(primitives_.size()); }
  /// Returns the length of the longest step, m.
  [[nodiscard]] double reach_m() const { return reach_m_; }

 private:
  /// Returns the same result as wrap_to_pi, bit for bit. Needs no division if the argument is a sum
  /// of two wrapped angles.
  [[nodiscard]] static double wrap_turn(double sum_rad) {
    const double wrapped = sum_rad > kPi     ? sum_rad - 2.0 * kPi
                           : sum_rad <= -kPi ? sum_rad + 2.0 * kPi
                                             : sum_rad;
    return std::abs(wrapped) < kPi ? wrapped : wrap_to_pi(sum_rad);
  }
  [[nodiscard]] bool can_stop_at(const Pose2& at, double speed_mps, int depth) const;

  struct Primitive {
    Pose2 end;                             ///< pose at the end, in the body frame at the start
    Eigen::Vector2d piece_end_m[kPieces];  ///< ends of the pieces, in the body frame at the start
    Pose2 along[kParts];  ///< poses after k of the kParts parts of the arc, in the body frame
    double length_m = 0.0;
    double sagitta_m = 0.0;  ///< m; deviation of one piece of the arc from its chord
    models::UnicycleControl control;
  };
  struct TeammatePiece {
    Eigen::Vector3d from_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d to_m = Eigen::Vector3d::Zero();
    double slack_m = 0.0;  ///< m: maximum deviation of the true path from the straight piece
  };

  [[nodiscard]] bool is_apart(const Pose2& from, double cos_yaw, double sin_yaw,
                              const Primitive& primitive, int depth) const;

  /// True if parts `begin` … `end` are clear of obstacles and walls. Uses the distance field, and
  /// exact distances where the field does not decide.
  [[nodiscard]] bool is_clear(const Pose2& from, double cos_yaw, double sin_yaw,
                              const Primitive& primitive, int begin, int end) const;

  const SearchProblem* problem_ = nullptr;
  std::vector<Primitive> primitives_;
  Views ends_;  ///< end poses of the controls in the body frame
  double reach_m_ = 0.0;
  int pieces_each_ = 0;  ///< number of pieces per teammate, until all vehicles hover
  std::vector<TeammatePiece> teammate_pieces_;  ///< indexed by [teammate][depth][piece]
  std::vector<double>
      step_distances_m_;            ///< [teammate][depth]: maximum distance covered in one step
  std::vector<double> required_m_;  ///< [teammate]: required_separation_m()
};

/// True if a disc of `radius_m` that moves along `control` for `duration_s` stays clear of
/// obstacles and walls. Exact for a straight line; accurate to 1e-6 m for an arc, which is bisected
/// until each part is decided by the clearance at its middle. Does not allocate; the cost grows as
/// obstacles come closer.
bool arc_is_clear(const models::World& world, const Pose2& from,
                  const models::UnicycleControl& control, double duration_s, double radius_m);

}  // namespace vantage::planner
