#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/node/bus.hpp"
#include "bus/node/node.hpp"
#include "estimator/app/step_material.hpp"
#include "python/binding/bind.hpp"
#include "scenario/scenario.hpp"

// Sensors, filters and planners of a trial that are Python functions. The trial's thread runs
// without the interpreter's lock; each of these nodes acquires the lock for its Python calls.

namespace vantage::python {

/// Shared Python function that may be copied and freed without the interpreter's lock.
using KeptFunction = std::shared_ptr<py::function>;
KeptFunction kept(const py::function& function);

/// Sensor that takes its detections from a Python function.
class PythonSensor {
 public:
  PythonSensor(const scenario::Scenario& scenario, const std::string& robot, KeptFunction measure);
  std::optional<models::RobotMeasurement> operator()(const models::MocapFrame& frame,
                                                     bool jammed) const;

 private:
  std::string robot_;
  KeptFunction measure_;
  int measurement_dim_ = 0;
  std::map<std::string, int> ids_;
};

/// Filter that takes its beliefs after each step from a Python function.
class PythonFilter {
 public:
  PythonFilter(const scenario::Scenario& scenario, KeptFunction filter);
  std::vector<models::TargetBelief> operator()(
      Time t, const std::vector<estimator::NamedMessage<models::RobotMeasurement>>& looks);

 private:
  KeptFunction filter_;
  Eigen::Index dim_ = 0;
  std::map<int, Time> last_seen_;  ///< time of the newest scan of each target
};

/// Node that answers one robot's EXTERNAL_REQUEST_R with the result of a Python function.
class PythonPlannerNode : public bus::Node {
 public:
  PythonPlannerNode(bus::Bus& bus, const scenario::Scenario& scenario, const std::string& robot,
                    KeptFunction plan);
  [[nodiscard]] std::string name() const override { return "EXTERNAL_" + robot_; }
  [[nodiscard]] Time next_tick() const override { return Time::max(); }
  void tick(Time /*now*/) override {}

 private:
  void reply(const models::RobotPlan& request);
  /// Returns the argument of the Python function for `request`. Requires the interpreter's lock.
  [[nodiscard]] py::dict request_dict(const models::RobotPlan& request) const;

  bus::Bus& bus_;
  const scenario::Scenario& scenario_;
  std::string robot_;
  KeptFunction plan_;
  std::optional<models::RobotBelief> belief_;
  std::map<std::string, models::RobotPlan> team_plans_;
};

}  // namespace vantage::python
