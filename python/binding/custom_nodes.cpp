#include "python/binding/custom_nodes.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include <pybind11/stl.h>

#include "bus/convert/external_channels.hpp"
#include "core/check.hpp"
#include "core/index.hpp"
#include "drivers/sensor/pose_sensor.hpp"
#include "models/belief/gaussian.hpp"

namespace vantage::python {

// Returns a shared function. Its deleter acquires the interpreter's lock, because any thread may
// release the last reference.
KeptFunction kept(const py::function& function) {
  return {new py::function(function), [](py::function* each) {
            const py::gil_scoped_acquire acquire;
            delete each;
          }};
}

PythonSensor::PythonSensor(const scenario::Scenario& scenario, const std::string& robot,
                           KeptFunction measure)
    : robot_(robot), measure_(std::move(measure)) {
  const scenario::RobotSpec* spec = scenario.find_robot(robot);
  measurement_dim_ = spec->sensor.measurement_dim(scenario.estimator.target_model.position_dim);
  for (const scenario::TargetSpec& target : scenario.targets) {
    ids_[target.name] = target.id;
  }
}

std::optional<models::RobotMeasurement> PythonSensor::operator()(const models::MocapFrame& frame,
                                                                 bool jammed) const {
  std::optional<models::RobotMeasurement> seen = drivers::empty_measurement(frame, robot_, jammed);
  if (!seen || jammed) {
    return seen;
  }
  const py::gil_scoped_acquire acquire;
  const Pose2& pose = seen->viewpoint.world_from_body;
  py::dict targets;
  for (const models::MocapBody& body : frame.bodies) {
    const auto id = ids_.find(body.name);
    if (id != ids_.end() && !body.occluded) {
      targets[py::int_(id->second)] = array_of(body.world_from_body.translation_m);
    }
  }
  const py::object result = (*measure_)(
      array_of(Eigen::Vector4d(pose.x_m, pose.y_m, seen->viewpoint.height_m, pose.yaw_rad)),
      targets, to_seconds(frame.stamp.time.time_since_epoch()));
  for (const py::handle item : py::iter(result)) {
    const auto [id, z, V] = py::cast<std::tuple<int, Doubles, Doubles>>(item);
    const auto n = static_cast<py::ssize_t>(measurement_dim_);
    require_shape(z, {n}, "z");
    require_shape(V, {n, n}, "V");
    models::Detection detection;
    detection.target_id = id;
    detection.measurement.z.resize(n);
    detection.measurement.V.resize(n, n);
    for (py::ssize_t i = 0; i < n; ++i) {
      detection.measurement.z(i) = z.at(i);
      for (py::ssize_t j = 0; j < n; ++j) {
        detection.measurement.V(i, j) = V.at(i, j);
      }
    }
    seen->detections.push_back(detection);
  }
  std::sort(seen->detections.begin(), seen->detections.end(),
            [](const auto& a, const auto& b) { return a.target_id < b.target_id; });
  return seen;
}

PythonFilter::PythonFilter(const scenario::Scenario& scenario, KeptFunction filter)
    : filter_(std::move(filter)), dim_(scenario.estimator.target_model.dim()) {}

std::vector<models::TargetBelief> PythonFilter::operator()(
    Time t, const std::vector<estimator::NamedMessage<models::RobotMeasurement>>& looks) {
  const py::gil_scoped_acquire acquire;
  py::list scans;
  for (const auto& look : looks) {
    const models::RobotMeasurement& set = *look.content;
    const Pose2& pose = set.viewpoint.world_from_body;
    py::list seen;
    for (const models::Detection& each : set.detections) {
      seen.append(py::make_tuple(each.target_id, array_of(each.measurement.z),
                                 matrix_array(each.measurement.V)));
      Time& last = last_seen_[each.target_id];
      last = std::max(last, set.stamp.time);
    }
    scans.append(py::make_tuple(
        array_of(Eigen::Vector4d(pose.x_m, pose.y_m, set.viewpoint.height_m, pose.yaw_rad)), seen));
  }
  const py::dict beliefs = (*filter_)(scans, to_seconds(t.time_since_epoch()));
  std::vector<models::TargetBelief> targets;
  for (const auto& [id, gaussian] : beliefs) {
    const auto [mean, covariance] = py::cast<std::tuple<Doubles, Doubles>>(gaussian);
    const auto n = static_cast<py::ssize_t>(dim_);
    require_shape(mean, {n}, "mean");
    require_shape(covariance, {n, n}, "covariance");
    models::Gaussian belief{models::StateVector(dim_), models::StateMatrix(dim_, dim_)};
    for (py::ssize_t i = 0; i < n; ++i) {
      belief.mean(i) = mean.at(i);
      for (py::ssize_t j = 0; j < n; ++j) {
        belief.covariance(i, j) = covariance.at(i, j);
      }
    }
    const auto information = models::to_information(belief);
    require(information.has_value(), "covariance: must be positive definite");
    const int target_id = py::cast<int>(id);
    targets.push_back({target_id, *information, last_seen_[target_id]});
  }
  std::sort(targets.begin(), targets.end(),
            [](const auto& a, const auto& b) { return a.target_id < b.target_id; });
  return targets;
}

PythonPlannerNode::PythonPlannerNode(bus::Bus& bus, const scenario::Scenario& scenario,
                                     const std::string& robot, KeptFunction plan)
    : bus_(bus), scenario_(scenario), robot_(robot), plan_(std::move(plan)) {
  bus_.subscribe<models::RobotBelief>(bus::belief_channel(robot),
                                      [this](const auto& belief) { belief_ = belief; });
  for (const scenario::RobotSpec& each : scenario.robots) {
    if (each.name != robot) {
      bus_.subscribe<models::RobotPlan>(bus::plan_channel(each.name),
                                        [this](const auto& team_plan) {
                                          team_plans_.insert_or_assign(team_plan.robot, team_plan);
                                        });
    }
  }
  bus_.subscribe<models::RobotPlan>(bus::external_request_channel(robot),
                                    [this](const auto& request) { reply(request); });
}

py::dict PythonPlannerNode::request_dict(const models::RobotPlan& request) const {
  const scenario::RobotSpec& robot = *scenario_.find_robot(robot_);
  const Time start = request.trajectory.start_time;
  const double step_s = request.step_s;
  py::dict out;
  out["robot"] = robot_;
  out["round"] = request.round;
  out["time_s"] = to_seconds(start.time_since_epoch());
  const Pose2& pose = request.trajectory.start;
  out["pose"] = array_of(Eigen::Vector3d(pose.x_m, pose.y_m, pose.yaw_rad));
  out["speed_mps"] = models::at(request.trajectory, start).control.speed_mps;
  out["height_m"] = request.trajectory.height_m;
  out["horizon_steps"] = request.horizon_steps;
  out["step_s"] = step_s;
  Eigen::Matrix<double, Eigen::Dynamic, 2> controls(std::ssize(robot.primitives), 2);
  for (Eigen::Index i = 0; i < controls.rows(); ++i) {
    const auto& control = robot.primitives[index(i)];
    controls.row(i) << control.speed_mps, control.yaw_rate_radps;
  }
  out["controls"] = matrix_array(controls);
  py::dict beliefs;
  if (belief_) {
    const double ahead_s = to_seconds(start - belief_->stamp.time);
    for (const models::TargetBelief& target : belief_->targets) {
      if (const auto gaussian = models::to_gaussian(target.information)) {
        const models::Gaussian then = models::predict_unseen(
            *gaussian, scenario_.estimator.target_model, ahead_s,
            std::max(0.0, to_seconds(belief_->stamp.time - target.last_seen)), step_s);
        beliefs[py::int_(target.target_id)] =
            py::make_tuple(array_of(then.mean), matrix_array(then.covariance));
      }
    }
  }
  out["beliefs"] = beliefs;
  py::dict team;
  for (const auto& [name, plan] : team_plans_) {
    std::vector<Pose2> poses;
    for (int k = 0; k <= request.horizon_steps; ++k) {
      poses.push_back(
          models::at(plan.trajectory, start + from_seconds(k * step_s)).world_from_body);
    }
    team[py::str(name)] = poses_array(poses, poses.size());
  }
  out["team"] = team;
  return out;
}

void PythonPlannerNode::reply(const models::RobotPlan& request) {
  models::RobotPlan reply = request;
  {
    const py::gil_scoped_acquire acquire;
    const py::object result = (*plan_)(request_dict(request));
    if (result.is_none()) {
      return;
    }
    const auto rows = py::cast<Doubles>(result);
    require_shape(rows, {-1, 3}, "plan");
    reply.trajectory.segments.clear();
    for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
      reply.trajectory.segments.push_back({{rows.at(i, 0), rows.at(i, 1)}, rows.at(i, 2), 0.0});
    }
  }
  bus_.publish(bus::external_plan_channel(robot_), reply);
}

}  // namespace vantage::python
