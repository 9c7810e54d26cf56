#include "python/binding/scenario.hpp"

#include <map>
#include <optional>
#include <string>
#include <utility>

#include <pybind11/stl.h>

#include "core/check.hpp"
#include "python/binding/bind.hpp"
#include "scenario/reader/overrides.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "trial/scenario/config_folder.hpp"

namespace vantage::python {
namespace {

std::shared_ptr<Scenario> parsed(const std::string& yaml, const std::string& name) {
  const py::gil_scoped_release release;
  return std::make_shared<Scenario>(Scenario{scenario::parse_scenario(yaml, name), name});
}

std::shared_ptr<Scenario> scenario_of(const py::object& source) {
  if (py::isinstance<py::dict>(source)) {
    return parsed(json_text(source), "scenario");
  }
  const std::string word = path_text(source);
  const py::gil_scoped_release release;
  const std::string path = trial::scenario_path(word);
  return std::make_shared<Scenario>(Scenario{scenario::load_scenario(path), path});
}

}  // namespace

// Long function: it lists the Python names, one entry each.
void bind_scenario(py::module_& module) {
  py::class_<Scenario, std::shared_ptr<Scenario>>(module, "Scenario",
                                                  R"(Complete description of a trial.

Scenario(source) reads the YAML file at a path, an installed scenario by its name ("lab"), or
a dict with the keys of such a file (`vantage config copy lab` writes one). Invalid input
raises StartupError with line, key, rule, value and a probable correction.)")
      .def(py::init(&scenario_of), py::arg("source"))
      .def_static("parse", &parsed, py::arg("yaml"), py::arg("name") = "scenario",
                  "Reads YAML text. Messages use `name` instead of a file name.")
      .def(
          "replace",
          [](const Scenario& self, std::optional<std::uint64_t> seed,
             std::optional<double> duration_s, std::optional<std::string> planner,
             std::optional<double> communication_range_m, std::optional<std::int64_t> node_budget,
             std::map<std::string, std::string> keys) {
            scenario::Overrides overrides;
            overrides.seed = seed;
            overrides.duration_s = duration_s;
            overrides.planner = std::move(planner);
            overrides.communication_range_m = communication_range_m;
            overrides.node_budget = node_budget;
            overrides.keys = std::move(keys);
            return parsed(scenario::apply_overrides(self.value.source_text, overrides),
                          overrides.is_empty() ? self.source : self.source + " with options");
          },
          py::kw_only(), py::arg("seed") = py::none(), py::arg("duration_s") = py::none(),
          py::arg("planner") = py::none(), py::arg("communication_range_m") = py::none(),
          py::arg("node_budget") = py::none(),
          py::arg("keys") = std::map<std::string, std::string>(),
          "Returns a copy with these options changed, as the flags of `vantage trial` do. `keys` "
          "maps "
          "full paths of other keys to values in YAML: "
          "{\"robot_defaults.sensor.range_sigma_m\": \"0.3\"}.")
      .def_property_readonly("name", [](const Scenario& self) { return self.value.name; })
      .def_property_readonly("source", [](const Scenario& self) { return self.source; })
      .def_property_readonly(
          "text", [](const Scenario& self) { return self.value.source_text; },
          "YAML text, as stored in every log.")
      .def_property_readonly("seed", [](const Scenario& self) { return self.value.seed; })
      .def_property_readonly("duration_s",
                             [](const Scenario& self) { return self.value.duration_s; })
      .def_property_readonly(
          "step_s", [](const Scenario& self) { return self.value.planner.step_s; },
          "Duration of a planning step τ, s.")
      .def_property_readonly(
          "robots",
          [](const Scenario& self) {
            std::vector<std::string> names;
            for (const scenario::RobotSpec& robot : self.value.robots) {
              names.push_back(robot.name);
            }
            return names;
          },
          "Names in the order of the file.")
      .def_property_readonly(
          "targets",
          [](const Scenario& self) {
            std::vector<std::string> names;
            for (const scenario::TargetSpec& target : self.value.targets) {
              names.push_back(target.name);
            }
            return names;
          },
          "Names. A target's id is its index.")
      .def_property_readonly(
          "bounds",
          [](const Scenario& self) {
            const models::Rectangle& b = self.value.world.bounds;
            return array_of(Eigen::Vector4d(b.min_m.x(), b.min_m.y(), b.max_m.x(), b.max_m.y()));
          },
          "(4,): xmin, ymin, xmax, ymax in m.")
      .def_property_readonly(
          "obstacles",
          [](const Scenario& self) {
            Eigen::Matrix<double, Eigen::Dynamic, 4> out(
                static_cast<Eigen::Index>(self.value.world.obstacles.size()), 4);
            Eigen::Index row = 0;
            for (const models::Obstacle& o : self.value.world.obstacles) {
              out.row(row++) << o.footprint.min_m.transpose(), o.footprint.max_m.transpose();
            }
            return matrix_array(out);
          },
          "(n, 4): xmin, ymin, xmax, ymax in m.")
      .def_property_readonly(
          "world", [](const Scenario& self) { return self.value.world; }, "Bounds and obstacles.")
      .def_property_readonly(
          "target_model", [](const Scenario& self) { return self.value.estimator.target_model; },
          "Target model of the estimators.")
      .def(
          "sensor",
          [](const Scenario& self, const std::string& robot) {
            const scenario::RobotSpec* spec = self.value.find_robot(robot);
            require(spec != nullptr, "robot: the scenario has no robot " + robot);
            return spec->sensor;
          },
          py::arg("robot"), "Returns the SensorModel of the robot.")
      .def(
          "clearance_m",
          [](const Scenario& self, const std::string& robot) {
            const scenario::RobotSpec* spec = self.value.find_robot(robot);
            require(spec != nullptr, "robot: the scenario has no robot " + robot);
            return spec->limits.radius_m + self.value.planner.obstacle_margin_m;
          },
          py::arg("robot"), "Returns the minimum distance of the robot's plans from walls, m.")
      .def("__repr__", [](const Scenario& self) {
        return "<vantage.Scenario " + self.value.name + ": " +
               std::to_string(self.value.robots.size()) + " robots, " +
               std::to_string(self.value.targets.size()) + " targets>";
      });
}

}  // namespace vantage::python
