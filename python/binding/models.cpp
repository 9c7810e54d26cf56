#include <map>
#include <random>
#include <span>
#include <tuple>
#include <utility>

#include <pybind11/stl.h>

#include "core/check.hpp"
#include "core/index.hpp"
#include "estimator/posterior/confinement.hpp"
#include "estimator/posterior/missed_detection.hpp"
#include "estimator/tracks/gaussian/track.hpp"
#include "models/belief/gaussian.hpp"
#include "models/motion/unicycle.hpp"
#include "models/sensor/law.hpp"
#include "models/sensor/sensor.hpp"
#include "models/target/law.hpp"
#include "models/world/world.hpp"
#include "python/binding/bind.hpp"

namespace vantage::python {
namespace {

using models::Gaussian;
using models::SensorModel;
using models::TargetModel;
using models::Viewpoint;
using models::World;

template <class Kind>
std::map<std::string, Kind> by_name(std::span<const Kind> kinds) {
  std::map<std::string, Kind> named;
  for (const Kind kind : kinds) {
    named.emplace(kind.name(), kind);
  }
  return named;
}

Viewpoint viewpoint_of(const Doubles& from) {
  require_shape(from, {4}, "viewpoint");
  return {{from.at(0), from.at(1), from.at(3)}, from.at(2)};
}

models::PositionVector position_of(const Doubles& target) {
  if (target.ndim() != 1 || (target.shape(0) != 2 && target.shape(0) != 3)) {
    throw py::value_error("target: must have the shape (2) or (3)");
  }
  models::PositionVector position(target.shape(0));
  for (py::ssize_t i = 0; i < target.shape(0); ++i) {
    position(i) = target.at(i);
  }
  return position;
}

Gaussian gaussian_of(const Doubles& mean, const Doubles& covariance) {
  const py::ssize_t n = mean.ndim() == 1 ? mean.shape(0) : 0;
  if (n < 2 || n > models::kMaxTargetDim) {
    throw py::value_error("mean: must have the shape (2), (3) or (4)");
  }
  require_shape(covariance, {n, n}, "covariance");
  Gaussian belief;
  belief.mean.resize(n);
  belief.covariance.resize(n, n);
  for (py::ssize_t i = 0; i < n; ++i) {
    belief.mean(i) = mean.at(i);
    for (py::ssize_t j = 0; j < n; ++j) {
      belief.covariance(i, j) = covariance.at(i, j);
    }
  }
  return belief;
}

py::tuple pair_of(const Gaussian& belief) {
  return py::make_tuple(array_of(belief.mean), matrix_array(belief.covariance));
}

py::array_t<double> step_unicycle(const Doubles& pose, const Doubles& control, double duration_s) {
  const bool is_one = pose.ndim() == 1 && control.ndim() == 1;
  const Doubles poses = is_one ? Doubles(pose.attr("reshape")(1, 3)) : pose;
  const Doubles controls = is_one ? Doubles(control.attr("reshape")(1, 2)) : control;
  require_shape(poses, {-1, 3}, "pose");
  require_shape(controls, {poses.shape(0), 2}, "control");
  py::array_t<double> out({poses.shape(0), py::ssize_t{3}});
  auto view = out.mutable_unchecked<2>();
  for (py::ssize_t i = 0; i < poses.shape(0); ++i) {
    const Pose2 next = models::step_unicycle({poses.at(i, 0), poses.at(i, 1), poses.at(i, 2)},
                                             {controls.at(i, 0), controls.at(i, 1)}, duration_s);
    view(i, 0) = next.x_m;
    view(i, 1) = next.y_m;
    view(i, 2) = next.yaw_rad;
  }
  return is_one ? py::array_t<double>(out.attr("reshape")(3)) : out;
}

py::array_t<double> controls_array(const std::vector<models::UnicycleControl>& controls) {
  py::array_t<double> out({static_cast<py::ssize_t>(controls.size()), py::ssize_t{2}});
  for (std::size_t i = 0; i < controls.size(); ++i) {
    out.mutable_at(static_cast<py::ssize_t>(i), 0) = controls[i].speed_mps;
    out.mutable_at(static_cast<py::ssize_t>(i), 1) = controls[i].yaw_rate_radps;
  }
  return out;
}

World world_of(const Doubles& bounds, const Doubles& obstacles) {
  require_shape(bounds, {4}, "bounds");
  World world;
  const auto rectangle = [](double x0, double y0, double x1, double y1, const char* name) {
    require(
        x0 < x1 && y0 < y1,
        std::string(name) + ": must be xmin, ymin, xmax, ymax with xmin < xmax and ymin < ymax");
    return models::Rectangle{{x0, y0}, {x1, y1}};
  };
  world.bounds = rectangle(bounds.at(0), bounds.at(1), bounds.at(2), bounds.at(3), "bounds");
  if (obstacles.size() > 0) {
    require_shape(obstacles, {-1, 4}, "obstacles");
    for (py::ssize_t i = 0; i < obstacles.shape(0); ++i) {
      models::Obstacle box;
      box.footprint = rectangle(obstacles.at(i, 0), obstacles.at(i, 1), obstacles.at(i, 2),
                                obstacles.at(i, 3), "obstacles");
      world.obstacles.push_back(box);
    }
  }
  return world;
}

Eigen::Vector2d point_of(const Doubles& point) {
  require_shape(point, {2}, "point");
  return {point.at(0), point.at(1)};
}

void bind_motion(py::module_& module) {
  module.def("step_unicycle", &step_unicycle, py::arg("pose"), py::arg("control"),
             py::arg("duration_s"),
             R"(Returns the exact pose after holding a control: (3,) or (n, 3) like `pose`.

pose: x, y in m and yaw in rad; control (2,) or (n, 2): speed in m/s and yaw rate in rad/s.)");
  module.def(
      "standard_primitives", [] { return controls_array(models::standard_primitives()); },
      "(10, 2): {1, 3} m/s × {0, ±1, ±3} rad/s, the controls of the simulations.");
  module.def(
      "lab_primitives", [] { return controls_array(models::lab_primitives()); },
      "(5, 2): 1 m/s × {0, ±1, ±3} rad/s, the controls of the hardware experiment.");
  py::class_<TargetModel>(module, "TargetModel", R"(Linear motion of one target, y' = A y + w.

TargetModel(kind="random_walk", *, q=0.0, position_dim=2): kind static, random_walk (q in m²/s),
double_integrator (x, y, vx, vy; q in m²/s³) or growing_uncertainty (q in m²).
TargetModel("damped_oscillator", center_m, position_sigma_m, velocity_sigma_mps, damping_per_s):
(x, y, vx, vy) that stays near its centre, y' = c + A (y − c) + w; each argument is (x, y).)")
      .def(py::init([](const std::string& kind, double q, int position_dim, const Doubles& center_m,
                       const Doubles& position_sigma_m, const Doubles& velocity_sigma_mps,
                       const Doubles& damping_per_s) {
             TargetModel model{kind_of(kind, by_name(models::all_target_kinds())),
                               position_dim,
                               q,
                               {point_of(center_m), point_of(position_sigma_m),
                                point_of(velocity_sigma_mps), point_of(damping_per_s)}};
             if (const auto rule = models::broken_rule(model)) {
               throw UsageError(std::string(*rule));
             }
             return model;
           }),
           py::arg("kind") = "random_walk", py::kw_only(), py::arg("q") = 0.0,
           py::arg("position_dim") = 2, py::arg("center_m") = std::vector<double>{0.0, 0.0},
           py::arg("position_sigma_m") = std::vector<double>{1.0, 1.0},
           py::arg("velocity_sigma_mps") = std::vector<double>{1.0, 1.0},
           py::arg("damping_per_s") = std::vector<double>{1.0, 1.0})
      .def_property_readonly("kind", [](const TargetModel& m) { return m.kind.name(); })
      .def_readonly("q", &TargetModel::q)
      .def_readonly("position_dim", &TargetModel::position_dim)
      .def_property_readonly("dim", &TargetModel::dim, "n, dimension of the state.")
      .def(
          "transition",
          [](const TargetModel& m, double dt_s) { return matrix_array(m.transition(dt_s)); },
          py::arg("dt_s"), "A, (n, n).")
      .def(
          "process_noise",
          [](const TargetModel& m, double dt_s, int steps_unseen) {
            return matrix_array(m.process_noise(dt_s, steps_unseen));
          },
          py::arg("dt_s"), py::arg("steps_unseen") = 1, "W, (n, n).");
}

const std::vector<double> kAtRest{0.0, 0.0};  // m/s

std::string missing_parameter(const SensorModel& sensor, const std::string& name) {
  std::string own;
  for (const models::SensorParameter& each : sensor.kind.law().parameters) {
    own.append(own.empty() ? "" : ", ").append(each.name);
  }
  return "SensorModel has no " + name + "; own parameters of kind " +
         std::string(sensor.kind.name()) + ": " + (own.empty() ? "none" : own);
}

models::StateVector state_of(const Doubles& state) {
  require(state.ndim() == 1 && state.shape(0) >= 2 && state.shape(0) <= 4,
          "state: must have 2, 3 or 4 numbers");
  models::StateVector out(state.shape(0));
  for (py::ssize_t i = 0; i < state.shape(0); ++i) {
    out(i) = state.at(i);
  }
  return out;
}

// Long function: it lists the Python names, one entry each.
void bind_sensor(py::module_& module) {
  py::class_<SensorModel> sensor(module, "SensorModel",
                                 R"(A sensor model, z = h(x, y) + v.

SensorModel(kind="range_bearing", **fields): kind position, range, bearing, range_bearing, camera or
range_rate; the fields are the attributes below and the kind's own_parameters, units in their names.
A viewpoint is (4,): x, y, z in m and yaw in rad; a target (2,) or (3,) in m, a velocity (2,) in m/s
and a state (2,), (3,) or (x, y, vx, vy). z: position: target in the body frame, m; range: m;
bearing: rad from body x; range_bearing: (m, rad); camera: pixels; range_rate: (m, m/s), without the
sensor's own motion.)");
  sensor
      .def(py::init([](const std::string& kind, const py::kwargs& fields) {
             SensorModel model;
             model.kind = kind_of(kind, by_name(models::all_sensor_kinds()));
             py::object self = py::cast(model);
             for (const auto& [name, value] : fields) {
               if (!py::hasattr(self, name)) {
                 throw py::type_error(missing_parameter(model, py::cast<std::string>(name)));
               }
               self.attr(name) = value;
             }
             return py::cast<SensorModel>(self);
           }),
           py::arg("kind") = "range_bearing")
      .def_property_readonly("kind", [](const SensorModel& s) { return s.kind.name(); })
      .def_readwrite("range_max_m", &SensorModel::range_max_m)
      .def_readwrite("range_min_m", &SensorModel::range_min_m)
      .def_readwrite("fov_rad", &SensorModel::fov_rad, "Full opening angle.")
      .def_readwrite("range_sigma_m", &SensorModel::range_sigma_m)
      .def_readwrite("bearing_sigma_rad", &SensorModel::bearing_sigma_rad)
      .def_readwrite("position_sigma_m", &SensorModel::position_sigma_m)
      .def_readwrite("pixel_sigma", &SensorModel::pixel_sigma)
      .def_readwrite("focal_length_pixels", &SensorModel::focal_length_pixels)
      .def_readwrite("camera_tilt_rad", &SensorModel::camera_tilt_rad)
      .def_readwrite("depth_min_m", &SensorModel::depth_min_m)
      .def_readwrite("variance_grows_with_range", &SensorModel::variance_grows_with_range)
      .def_readwrite("variance_floor", &SensorModel::variance_floor)
      .def_property_readonly(
          "own_parameters",
          [](const SensorModel& s) {
            py::dict values;
            for (const models::SensorParameter& each : s.kind.law().parameters) {
              values[py::str(std::string(each.name))] =
                  models::own_parameter(s, *models::find_parameter(s.kind, each.name));
            }
            return values;
          },
          "Values of the parameters that only this kind has, by name; each is also an attribute.")
      .def(
          "__getattr__",
          [](const SensorModel& s, const std::string& name) {
            const auto i = models::find_parameter(s.kind, name);
            if (!i) {
              throw py::attribute_error(missing_parameter(s, name));
            }
            return models::own_parameter(s, *i);
          },
          py::arg("name"), "Returns one of own_parameters.")
      .def(
          "__setattr__",
          [](const py::object& self, const std::string& name, const py::object& value) {
            auto& s = py::cast<SensorModel&>(self);
            const auto i = models::find_parameter(s.kind, name);
            if (!i) {
              if (PyObject_GenericSetAttr(self.ptr(), py::str(name).ptr(), value.ptr()) != 0) {
                throw py::error_already_set();
              }
              return;
            }
            const double number = py::cast<double>(value);
            const models::SensorParameter& row = s.kind.law().parameters[index(*i)];
            require(models::is_allowed(row.rule, number),
                    std::string(row.name) + ": must be " + std::string(models::words_of(row.rule)) +
                        ", is " + std::to_string(number));
            s.own[index(*i)] = number;
          },
          py::arg("name"), py::arg("value"), "Sets a field or one of own_parameters.")
      .def(
          "in_view",
          [](const SensorModel& s, const Doubles& from, const Doubles& target) {
            return models::in_view(s, viewpoint_of(from), position_of(target));
          },
          py::arg("viewpoint"), py::arg("target"),
          "True if within range and field of view; World checks occlusion.")
      .def(
          "observe",
          [](const SensorModel& s, const Doubles& from, const Doubles& target,
             const Doubles& velocity) {
            return array_of(
                models::observe(s, viewpoint_of(from), position_of(target), point_of(velocity)));
          },
          py::arg("viewpoint"), py::arg("target"), py::arg("velocity") = kAtRest,
          "Returns h(x, y), (k,): z without noise.")
      .def(
          "noise_covariance",
          [](const SensorModel& s, const Doubles& from, const Doubles& target) {
            return matrix_array(
                models::noise_covariance(s, viewpoint_of(from), position_of(target)));
          },
          py::arg("viewpoint"), py::arg("target"), "V, (k, k).")
      .def(
          "jacobian",
          [](const SensorModel& s, const Doubles& from, const Doubles& target,
             const Doubles& velocity) {
            return matrix_array(models::observation_jacobian(
                s, viewpoint_of(from), position_of(target), point_of(velocity)));
          },
          py::arg("viewpoint"), py::arg("target"), py::arg("velocity") = kAtRest,
          "∂h/∂position, (k, 2) or (k, 3).")
      .def(
          "state_jacobian",
          [](const SensorModel& s, const Doubles& from, const Doubles& state) {
            return matrix_array(models::state_jacobian(s, viewpoint_of(from), state_of(state)));
          },
          py::arg("viewpoint"), py::arg("state"), "∂h/∂state, (k, n).")
      .def(
          "state_information",
          [](const SensorModel& s, const Doubles& from, const Doubles& state) {
            return matrix_array(models::state_information(s, viewpoint_of(from), state_of(state)));
          },
          py::arg("viewpoint"), py::arg("state"),
          "Hᵀ V⁻¹ H with H = state_jacobian, (n, n); zero when not in view.")
      .def(
          "information",
          [](const SensorModel& s, const Doubles& from, const Doubles& target) {
            return matrix_array(models::information(s, viewpoint_of(from), position_of(target)));
          },
          py::arg("viewpoint"), py::arg("target"), "M = Hᵀ V⁻¹ H; zero when not in view.")
      .def(
          "sample",
          [](const SensorModel& s, const Doubles& from, const Doubles& target, std::uint64_t seed,
             const Doubles& velocity) {
            std::mt19937_64 random(seed);
            const models::Measurement m = models::sample(s, viewpoint_of(from), position_of(target),
                                                         random, point_of(velocity));
            return py::make_tuple(array_of(m.z), matrix_array(m.V));
          },
          py::arg("viewpoint"), py::arg("target"), py::arg("seed"), py::arg("velocity") = kAtRest,
          "Returns (z (k,), V (k, k)) with noise that depends only on the seed.")
      .def(
          "position_from",
          [](const SensorModel& s, const Doubles& from, const Doubles& z,
             int position_dim) -> py::object {
            require_shape(z, {s.measurement_dim(position_dim)}, "z");
            models::MeasurementVector vector(z.shape(0));
            for (py::ssize_t i = 0; i < z.shape(0); ++i) {
              vector(i) = z.at(i);
            }
            const auto found = models::position_from(s, viewpoint_of(from), vector, position_dim);
            return found ? py::object(array_of(*found)) : py::object(py::none());
          },
          py::arg("viewpoint"), py::arg("z"), py::arg("position_dim") = 2,
          "Returns the target position that gives z exactly; None if z does not determine a "
          "position.");
}

void bind_world(py::module_& module) {
  py::class_<World>(module, "World", R"(A rectangle with box obstacles.

World(bounds, obstacles=()): bounds (4,) and obstacles (n, 4): xmin, ymin, xmax, ymax in m.)")
      .def(py::init(&world_of), py::arg("bounds"), py::arg("obstacles") = py::tuple())
      .def(
          "clearance_m",
          [](const World& w, const Doubles& point) {
            return models::clearance_m(w, point_of(point));
          },
          py::arg("point"),
          "Returns the distance to the nearest obstacle or wall, m; negative inside an obstacle or "
          "outside the world.")
      .def(
          "line_of_sight",
          [](const World& w, const Doubles& a, const Doubles& b) {
            return models::line_of_sight(w, point_of(a), point_of(b));
          },
          py::arg("a"), py::arg("b"), "True if no obstacle is between the points.");
}

// Long function: it lists the Python names, one entry each.
void bind_belief(py::module_& module) {
  module.def(
      "predict",
      [](const Doubles& mean, const Doubles& covariance, const TargetModel& model, double dt_s) {
        const Gaussian belief = gaussian_of(mean, covariance);
        require(belief.mean.size() == model.dim(), "mean: must have the target model's dimension");
        return pair_of(models::predict(belief, model, dt_s));
      },
      py::arg("mean"), py::arg("covariance"), py::arg("model"), py::arg("dt_s"),
      "Returns (mean, covariance) after dt_s: c + A (y − c), A Σ Aᵀ + W.");
  module.def(
      "measure",
      [](const Doubles& mean, const Doubles& covariance, const SensorModel& sensor,
         const Doubles& from, const Doubles& z, const Doubles& V, double gate_sigma) -> py::tuple {
        const Gaussian belief = gaussian_of(mean, covariance);
        const int position_dim = belief.mean.size() == 3 ? 3 : 2;
        const auto n = static_cast<py::ssize_t>(sensor.measurement_dim(position_dim));
        require_shape(z, {n}, "z");
        require_shape(V, {n, n}, "V");
        models::Measurement measurement;
        measurement.z.resize(n);
        measurement.V.resize(n, n);
        for (py::ssize_t i = 0; i < n; ++i) {
          measurement.z(i) = z.at(i);
          for (py::ssize_t j = 0; j < n; ++j) {
            measurement.V(i, j) = V.at(i, j);
          }
        }
        auto information = models::to_information(belief);
        require(information.has_value(), "covariance: must be positive definite");
        const estimator::Use use =
            estimator::measure(*information, sensor, viewpoint_of(from), measurement, gate_sigma);
        const auto after = models::to_gaussian(*information);
        const bool is_used = use == estimator::Use::kUsed && after.has_value();
        const Gaussian& result = is_used ? *after : belief;
        return py::make_tuple(array_of(result.mean), matrix_array(result.covariance), is_used);
      },
      py::arg("mean"), py::arg("covariance"), py::arg("sensor"), py::arg("viewpoint"), py::arg("z"),
      py::arg("V"), py::arg("gate_sigma") = 0.0,
      R"(Returns (mean, covariance, used) after one measurement, as the stack's estimator uses it.

Linearised at the mean, or at the position that z indicates if the belief is wide. gate_sigma > 0: a
measurement whose innovation exceeds this number of σ is not used.)");
  module.def(
      "miss",
      [](const Doubles& mean, const Doubles& covariance, const SensorModel& sensor,
         const Doubles& from, const World& world, double detection_probability) {
        return pair_of(estimator::missed_detection(gaussian_of(mean, covariance), sensor,
                                                   viewpoint_of(from), world,
                                                   detection_probability));
      },
      py::arg("mean"), py::arg("covariance"), py::arg("sensor"), py::arg("viewpoint"),
      py::arg("world"), py::arg("detection_probability") = 0.9,
      "Returns (mean, covariance) after a scan that did not detect the target.");
  module.def(
      "confine",
      [](const Doubles& mean, const Doubles& covariance, const World& world) {
        return pair_of(estimator::confine(gaussian_of(mean, covariance), world));
      },
      py::arg("mean"), py::arg("covariance"), py::arg("world"),
      "Returns (mean, covariance) of a target that is known to be in free space.");
  module.def(
      "log_det",
      [](const Doubles& covariance) {
        require_shape(covariance, {covariance.shape(0), covariance.shape(0)}, "covariance");
        const Doubles mean(std::vector<py::ssize_t>{covariance.shape(0)});
        return models::log_det(gaussian_of(mean, covariance).covariance);
      },
      py::arg("covariance"), "Returns log det Σ; −inf if it is singular.");
  module.def(
      "entropy_nats",
      [](const Doubles& covariance) {
        require_shape(covariance, {covariance.shape(0), covariance.shape(0)}, "covariance");
        const Doubles mean(std::vector<py::ssize_t>{covariance.shape(0)});
        return models::entropy_nats(gaussian_of(mean, covariance));
      },
      py::arg("covariance"), "Returns ½ log det(2πe Σ), nats.");
}

}  // namespace

void bind_models(py::module_& module) {
  bind_motion(module);
  bind_sensor(module);
  bind_world(module);
  bind_belief(module);
}

}  // namespace vantage::python
