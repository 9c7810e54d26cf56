// Custom sensor that measures how far ahead of the robot a target is. Needs component planner.
#include <cmath>
#include <cstdio>

#include <vantage/models/sensor/law.hpp>
#include <vantage/planner/search/arvi.hpp>

using namespace vantage;
using namespace vantage::models;

constexpr double kVariance_m2 = 0.02;
MeasurementVector row(double z) { return MeasurementVector::Constant(1, z); }
Eigen::Vector3d ahead(const Viewpoint& from) {
  return {std::cos(from.world_from_body.yaw_rad), std::sin(from.world_from_body.yaw_rad), 0.0};
}
const SensorLaw kDepth{
    .name = "depth",
    .measurement_dim = [](int) { return 1; },
    .observe = [](const SensorModel&, const Viewpoint& from, const SightLine& to,
                  int) { return row(ahead(from).dot(to.offset_world_m)); },
    .jacobian = [](const SensorModel&, const Viewpoint& from, const SightLine&,
                   int dim) -> MeasurementJacobian { return ahead(from).head(dim).transpose(); },
    .variances = [](const SensorModel&, const Viewpoint&, const SightLine&,
                    int) { return row(kVariance_m2); },
    .information_bound = [](const SensorModel&,  // maximum information, for bounds of plans
                            const ReachedDistances&) { return 1.0 / kVariance_m2; }};

int main() {
  SensorModel sensor;
  sensor.kind = SensorKind(kDepth);
  planner::SearchProblem problem;
  problem.controls = standard_primitives();
  problem.sensors = {sensor};
  problem.targets.push_back(
      {{.q = 0.05}, {Eigen::Vector2d{6.0, 3.0}, Eigen::Matrix2d::Identity()}});
  planner::ReducedValueIteration search(planner::SearchCapacity{});
  const planner::SearchResult& plan = search.plan(problem, {}, Deadline::nodes(100'000));
  std::printf("cost %.12f nats, lower bound %.12f\n", plan.cost, plan.lower_bound);
  return plan.found ? 0 : 1;
}
