#include "test/bench/dense_reference.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "planner/problem/motion_table.hpp"

namespace vantage::bench {
namespace {

struct DenseNode {
  Pose2 world_from_body;
  Eigen::MatrixXd covariance;
  double cost = 0.0;
};

struct Joint {
  Eigen::MatrixXd A;
  Eigen::MatrixXd W;
  Eigen::MatrixXd covariance;
  Eigen::VectorXd mean;
  std::vector<Eigen::Index> begin;  ///< first row of each target's state
};

Joint joint_of(const planner::SearchProblem& problem) {
  Joint joint;
  Eigen::Index n = 0;
  for (const planner::SearchTarget& target : problem.targets) {
    joint.begin.push_back(n);
    n += target.model.dim();
  }
  joint.A = joint.W = joint.covariance = Eigen::MatrixXd::Zero(n, n);
  joint.mean = Eigen::VectorXd::Zero(n);
  for (std::size_t m = 0; m < problem.targets.size(); ++m) {
    const planner::SearchTarget& target = problem.targets[m];
    const Eigen::Index d = target.model.dim();
    const Eigen::Index at = joint.begin[m];
    joint.A.block(at, at, d, d) = target.model.transition(problem.step_s);
    joint.W.block(at, at, d, d) = target.model.process_noise(problem.step_s);
    joint.covariance.block(at, at, d, d) = target.prior.covariance;
    joint.mean.segment(at, d) = target.prior.mean;
  }
  return joint;
}

// Updates `covariance` with measurements from the pose `at` of targets at `mean`.
void look(const planner::SearchProblem& problem, const Joint& joint, const Eigen::VectorXd& mean,
          const Pose2& at, Eigen::MatrixXd& covariance) {
  const models::Viewpoint from{at, problem.height_m};
  const Eigen::Index n = covariance.rows();
  Eigen::MatrixXd H(0, n);
  Eigen::MatrixXd V(0, 0);
  for (std::size_t m = 0; m < problem.targets.size(); ++m) {
    const Eigen::Vector2d target_m = mean.segment(joint.begin[m], 2);
    for (const models::SensorModel& sensor : problem.sensors) {
      if (!models::in_view(sensor, from, target_m) ||
          (problem.world != nullptr &&
           !models::line_of_sight(*problem.world, at.position_m(), target_m))) {
        continue;
      }
      const models::MeasurementJacobian rows = models::observation_jacobian(sensor, from, target_m);
      const Eigen::Index before = H.rows();
      const Eigen::Index added = rows.rows();
      H.conservativeResize(before + added, n);
      H.bottomRows(added).setZero();
      H.block(before, joint.begin[m], added, 2) = rows;
      V.conservativeResize(before + added, before + added);
      V.bottomRows(added).setZero();
      V.rightCols(added).setZero();
      V.bottomRightCorner(added, added) = models::noise_covariance(sensor, from, target_m);
    }
  }
  if (H.rows() == 0) {
    return;
  }
  const Eigen::MatrixXd cross = covariance * H.transpose();
  const Eigen::LLT<Eigen::MatrixXd> innovation(H * cross + V);
  covariance -= cross * innovation.solve(cross.transpose());
}

double log_det(const Eigen::MatrixXd& covariance) {
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  return 2.0 * factor.matrixLLT().diagonal().array().log().sum();
}

}  // namespace

DenseResult dense_value_iteration(const planner::SearchProblem& problem) {
  const Joint joint = joint_of(problem);
  DenseResult result;
  result.cost = std::numeric_limits<double>::infinity();
  std::vector<DenseNode> level = {{problem.start, joint.covariance, 0.0}};
  Eigen::VectorXd mean = joint.mean;
  for (int t = 1; t <= problem.horizon_steps; ++t) {
    mean = joint.A * mean;
    std::vector<DenseNode> next;
    for (const DenseNode& parent : level) {
      for (const models::UnicycleControl& control : problem.controls) {
        if (problem.world != nullptr &&
            !planner::arc_is_clear(*problem.world, parent.world_from_body, control, problem.step_s,
                                   problem.clearance_m)) {
          continue;
        }
        DenseNode child;
        child.world_from_body =
            models::step_unicycle(parent.world_from_body, control, problem.step_s);
        child.covariance = joint.A * parent.covariance * joint.A.transpose() + joint.W;
        look(problem, joint, mean, child.world_from_body, child.covariance);
        child.cost = parent.cost + log_det(child.covariance);
        ++result.nodes;
        if (t == problem.horizon_steps) {
          result.cost = std::min(result.cost, child.cost);
        } else {
          next.push_back(std::move(child));
        }
      }
    }
    level = std::move(next);
  }
  return result;
}

}  // namespace vantage::bench
