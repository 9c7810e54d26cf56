#include "estimator/posterior/missed_detection.hpp"

#include <Eigen/Cholesky>

#include "estimator/posterior/moment_matching.hpp"

namespace vantage::estimator {

bool can_report(const models::SensorModel& sensor, const models::Viewpoint& from,
                const models::World& world, const models::PositionVector& target_m) {
  return models::in_view(sensor, from, target_m) &&
         models::line_of_sight(world, from.world_from_body.position_m(), target_m.head<2>());
}

models::Gaussian missed_detection(const models::Gaussian& belief, const models::SensorModel& sensor,
                                  const models::Viewpoint& from, const models::World& world,
                                  double detection_probability, double* probability) {
  if (probability != nullptr) {
    *probability = 1.0;
  }
  const Eigen::Index n = belief.mean.size() == 3 ? 3 : 2;
  const Eigen::LLT<models::PositionMatrix> root(belief.covariance.topLeftCorner(n, n));
  if (detection_probability <= 0.0 || root.info() != Eigen::Success) {
    return belief;
  }
  const Eigen::Vector2d eye_m = from.world_from_body.position_m();
  const double reach_m = ProductRule::of(n).reach_m(root.matrixL());
  if ((belief.mean.head<2>() - eye_m).norm() - reach_m > sensor.range_max_m) {
    return belief;
  }
  const auto is_not_reported = [&](const models::PositionVector& y_m) {
    return can_report(sensor, from, world, y_m) ? 1.0 - detection_probability : 1.0;
  };
  return reweighted(belief, is_not_reported, probability);
}

}  // namespace vantage::estimator
