// Custom sensor with its own parameter. It measures how far ahead of the robot a target is.
#include <cmath>
#include <cstdio>

#include <vantage/models/sensor/law.hpp>
#include <vantage/planner/search/arvi.hpp>

using namespace vantage;
using namespace vantage::models;
constexpr SensorParameter kOwn[] = {{"variance_m2", "m²", 0.02, ParameterRule::kAboveZero, "σ²"}};
MeasurementVector row(double z) { return MeasurementVector::Constant(1, z); }
Eigen::Vector3d ahead(const Viewpoint& from) {
  return {std::cos(from.world_from_body.yaw_rad), std::sin(from.world_from_body.yaw_rad), 0.0};
}
const SensorLaw kDepth{
    .name = "depth",
    .parameters = kOwn,
    .measurement_dim = [](int) { return 1; },
    .observe = [](const SensorModel&, const Viewpoint& from, const SightLine& to,
                  int) { return row(ahead(from).dot(to.offset_world_m)); },
    .jacobian = [](const SensorModel&, const Viewpoint& from, const SightLine&,
                   int dim) -> MeasurementJacobian { return ahead(from).head(dim).transpose(); },
    .variances = [](const SensorModel& sensor, const Viewpoint&, const SightLine&,
                    int) { return row(own_parameter(sensor, 0)); },
    .information_bound = [](const SensorModel& sensor,  // maximum information, for bounds of plans
                            const ReachedDistances&) { return 1.0 / own_parameter(sensor, 0); }};
int main() {
  SensorModel sensor;
  sensor.kind = SensorKind(kDepth);
  sensor.own[0] = 0.01;  // variance_m2
  planner::SearchProblem problem;
  problem.controls = standard_primitives();
  problem.sensors = {sensor};
  problem.targets.push_back(
      {{.q = 0.05}, {Eigen::Vector2d{6.0, 3.0}, Eigen::Matrix2d::Identity()}});
  planner::ReducedValueIteration search(planner::SearchCapacity{});
  const auto& plan = search.plan(problem, {}, Deadline::nodes(100'000));
  std::printf("cost %.12f nats, lower bound %.12f\n", plan.cost, plan.lower_bound);
  return plan.found ? 0 : 1;
}
