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

// What somebody writes in Python and flies in a trial. Called by the trial's thread, without the
// interpreter's lock, which each takes for as long as it calls.

namespace vantage::python {

/// A Python function that may be copied and freed without the interpreter's lock.
using KeptFunction = std::shared_ptr<py::function>;
KeptFunction kept(const py::function& function);

/// What a sensor says of a frame.
class PythonSensor {
 public:
  PythonSensor(const scenario::Scenario& scenario, const std::string& robot, KeptFunction look);
  std::optional<models::DetectionSet> operator()(const models::MocapFrame& frame,
                                                 bool jammed) const;

 private:
  std::string robot_;
  KeptFunction look_;
  int measurement_dim_ = 0;
  std::map<std::string, int> ids_;
};

/// What a filter believes of the targets after the looks of a step.
class PythonFilter {
 public:
  PythonFilter(const scenario::Scenario& scenario, KeptFunction filter);
  std::vector<models::TargetBelief> operator()(
      Time t, const std::vector<estimator::Heard<models::DetectionSet>>& looks);

 private:
  KeptFunction filter_;
  Eigen::Index dim_ = 0;
  std::map<int, Time> last_seen_;  ///< newest look at each target
};

/// Answers one robot's EXTERNAL_REQUEST_R by what a function makes of it.
class PythonPlannerNode : public bus::Node {
 public:
  PythonPlannerNode(bus::Bus& bus, const scenario::Scenario& scenario, const std::string& robot,
                    KeptFunction plan);
  [[nodiscard]] std::string name() const override { return "EXTERNAL_" + robot_; }
  [[nodiscard]] Time next_tick() const override { return Time::max(); }
  void tick(Time /*now*/) override {}

 private:
  void answer(const models::RobotPlan& question);
  /// What the function is asked. Under the interpreter's lock.
  [[nodiscard]] py::dict question_dict(const models::RobotPlan& question) const;

  bus::Bus& bus_;
  const scenario::Scenario& scenario_;
  std::string robot_;
  KeptFunction plan_;
  std::optional<models::RobotBelief> belief_;
  std::map<std::string, models::RobotPlan> team_plans_;
};

}  // namespace vantage::python
