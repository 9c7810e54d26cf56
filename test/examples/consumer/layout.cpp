// Prints size and alignment of the types that are passed between the library and a program.
#include <cstdio>

#include "every_header.hpp"

template <class Type>
void print(const char* name) {
  std::printf("%-28s %6zu %3zu\n", name, sizeof(Type), alignof(Type));
}
#define PRINT(Type) print<Type>(#Type)

using namespace vantage;

int main() {
  PRINT(Eigen::Vector2d);
  PRINT(Eigen::Vector3d);
  PRINT(Eigen::Matrix3d);
  PRINT(Pose2);
  PRINT(Pose3);
  PRINT(models::PositionVector);
  PRINT(models::PositionMatrix);
  PRINT(models::MeasurementMatrix);
  PRINT(models::MeasurementJacobian);
  PRINT(models::StateVector);
  PRINT(models::StateMatrix);
  PRINT(models::Gaussian);
  PRINT(models::Information);
  PRINT(models::Measurement);
  PRINT(scenario::Scenario);
  PRINT(models::World);
  PRINT(models::MocapBody);
  PRINT(models::RobotBelief);
  PRINT(models::RobotPlan);
  PRINT(models::TargetBelief);
  PRINT(planner::SearchProblem);
  PRINT(planner::SearchResult);
  PRINT(planner::SearchTarget);
  PRINT(planner::ReducedValueIteration);
  PRINT(planner::RefiningBeam);
  PRINT(planner::Expander);
  PRINT(planner::RobotPlanner);
  PRINT(estimator::DistributedFilter);
  PRINT(estimator::FilterSpec);
  PRINT(estimator::StepInput);
  PRINT(estimator::Track);
}
