#include "trial/trial.hpp"

#include <algorithm>
#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include <pybind11/stl.h>

#include "core/check.hpp"
#include "core/index.hpp"
#include "drivers/sensor/app/node.hpp"
#include "estimator/app/node.hpp"
#include "python/binding/bind.hpp"
#include "python/binding/custom_nodes.hpp"
#include "python/binding/scenario.hpp"
#include "scenario/node_budget.hpp"
#include "scenario/reader/overrides.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "scenario/search_name.hpp"

namespace vantage::python {
namespace {

using Functions = std::map<std::string, py::function>;  // by robot name

// Returns the scenario with a node budget and, if `has_planners`, with planner.algorithm: external.
std::shared_ptr<Scenario> as_run(const std::shared_ptr<Scenario>& scenario, bool has_planners) {
  scenario::Overrides overrides;
  if (scenario->value.planner.node_budget <= 0) {
    overrides.node_budget = scenario::kDefaultNodeBudget;
  }
  if (has_planners) {
    overrides.planner = scenario::kExternalSearch;
  }
  if (overrides.is_empty()) {
    return scenario;
  }
  const std::string name = scenario->source + " with options";
  return std::make_shared<Scenario>(
      Scenario{scenario::parse_scenario(
                   scenario::apply_overrides(scenario->value.source_text, overrides), name),
               name});
}

trial::NodeRecipe& recipe_of(const std::string& argument, const std::string& kind,
                             const std::string& robot, std::vector<trial::NodeRecipe>& recipes) {
  const auto recipe = std::find_if(recipes.begin(), recipes.end(),
                                   [&](const auto& each) { return each.name == kind + robot; });
  require(recipe != recipes.end(), argument + ": the scenario has no robot " + robot);
  return *recipe;
}

class Trial {
 public:
  Trial(const std::shared_ptr<Scenario>& scenario, const std::string& log_path,
        const Functions& sensors, const Functions& planners, const Functions& filters)
      : scenario_(as_run(scenario, !planners.empty())) {
    const scenario::Scenario& value = scenario_->value;
    std::vector<trial::NodeRecipe> recipes = trial::trial_recipes(value);
    for (const auto& [robot, look] : sensors) {
      recipe_of("sensors", "SENSOR_", robot, recipes).make =
          [&value, name = robot, call = kept(look)](bus::Bus& bus, const bus::Clock& clock) {
            return std::make_unique<drivers::SensorNode>(bus, clock, value, name,
                                                         PythonSensor(value, name, call));
          };
    }
    for (const auto& [robot, filter] : filters) {
      recipe_of("filters", "ESTIMATOR_", robot, recipes).make =
          [&value, name = robot, call = kept(filter)](bus::Bus& bus, const bus::Clock& clock) {
            return std::make_unique<estimator::EstimatorNode>(bus, clock, value, name,
                                                              PythonFilter(value, call));
          };
    }
    for (const scenario::RobotSpec& robot : value.robots) {
      require(!scenario::is_external(value.planner) || planners.contains(robot.name),
              "planners: must have an entry for each robot, has none for " + robot.name);
    }
    for (const auto& [robot, plan] : planners) {
      recipe_of("planners", "PLANNER_", robot, recipes);
      recipes.push_back(
          {"EXTERNAL_" + robot,
           [&value, name = robot, call = kept(plan)](bus::Bus& bus, const bus::Clock& /*clock*/) {
             return std::make_unique<PythonPlannerNode>(bus, value, name, call);
           },
           robot});
    }
    const py::gil_scoped_release release;
    trial_ = std::make_unique<trial::Trial>(value, recipes, log_path);
  }

  ~Trial() {
    const py::gil_scoped_release release;
    trial_.reset();  // closes the log
  }
  Trial(const Trial&) = delete;
  Trial& operator=(const Trial&) = delete;
  Trial(Trial&&) = delete;
  Trial& operator=(Trial&&) = delete;

  void advance(double seconds_s) {
    require(seconds_s >= 0.0 && seconds_s <= 1e6, "seconds: must be ≥ 0 and ≤ 1000000");
    const py::gil_scoped_release release;
    require(!is_at_work_.exchange(true),
            "the trial is already being stepped, by another thread or by the call of one of its "
            "functions");
    const AtWork at_work{is_at_work_};
    const std::lock_guard lock(mutex_);
    trial_->advance_to(trial_->time() + from_seconds(seconds_s));
  }

  void run(const py::object& progress) {
    constexpr double kPiece_s = 0.5;
    while (!is_over()) {
      advance(kPiece_s);
      if (PyErr_CheckSignals() != 0) {  // Ctrl-C
        throw py::error_already_set();
      }
      if (!progress.is_none()) {
        progress(time_s() / scenario_->value.duration_s);
      }
    }
  }

  // Calls `action` with exclusive access to the trial, without the interpreter's lock.
  template <class Action>
  auto exclusively(const Action& action) const {
    const py::gil_scoped_release release;
    const std::lock_guard lock(mutex_);
    return action(*trial_);
  }

  [[nodiscard]] double time_s() const {
    return exclusively([](trial::Trial& t) { return to_seconds(t.time() - t.start()); });
  }
  [[nodiscard]] bool is_over() const {
    return exclusively([](trial::Trial& t) { return t.time() >= t.planned_end(); });
  }
  [[nodiscard]] const std::shared_ptr<Scenario>& scenario() const { return scenario_; }

 private:
  struct AtWork {
    std::atomic<bool>& flag;
    ~AtWork() { flag = false; }
  };
  std::shared_ptr<Scenario> scenario_;
  /// Recursive, because a Python sensor may call functions of the trial that runs it.
  mutable std::recursive_mutex mutex_;
  std::atomic<bool> is_at_work_ = false;
  std::unique_ptr<trial::Trial> trial_;
};

// Returns the poses of the robots or of the targets in the newest TRUTH, in the scenario's order.
py::array_t<double> truth_array(const Trial& trial, bool of_targets) {
  const auto truth = trial.exclusively([](trial::Trial& t) { return t.observer().truth(); });
  const scenario::Scenario& scenario = trial.scenario()->value;
  std::vector<std::string> names;
  for (const scenario::RobotSpec& robot : scenario.robots) {
    names.push_back(robot.name);
  }
  if (of_targets) {
    names.clear();
    for (const scenario::TargetSpec& target : scenario.targets) {
      names.push_back(target.name);
    }
  }
  py::array_t<double> out({static_cast<py::ssize_t>(names.size()), py::ssize_t{7}});
  std::fill_n(out.mutable_data(), out.size(), std::numeric_limits<double>::quiet_NaN());
  auto view = out.mutable_unchecked<2>();
  if (!truth) {
    return out;
  }
  for (const models::TruthBody& body : truth->bodies) {
    const auto found = std::find(names.begin(), names.end(), body.name);
    if (found == names.end() || (body.target_id >= 0) != of_targets) {
      continue;
    }
    const auto row = static_cast<py::ssize_t>(found - names.begin());
    const Pose2 flat = flatten(body.world_from_body);
    for (py::ssize_t i = 0; i < 3; ++i) {
      view(row, i) = body.world_from_body.translation_m(i);
      view(row, 4 + i) = body.velocity_world_mps(i);
    }
    view(row, 3) = flat.yaw_rad;
  }
  return out;
}

py::array_t<std::int64_t> grid_array(const models::GridGeometry& grid,
                                     const std::vector<std::int64_t>& values) {
  py::array_t<std::int64_t> out(
      {static_cast<py::ssize_t>(grid.rows), static_cast<py::ssize_t>(grid.columns)});
  std::copy(values.begin(), values.end(), out.mutable_data());
  return out;
}

py::dict belief_dict(const models::RobotBelief& belief, Time start) {
  std::vector<int> ids;
  std::vector<double> last_seen_s;
  std::vector<models::Gaussian> gaussians;
  for (const models::TargetBelief& target : belief.targets) {
    if (const auto gaussian = models::to_gaussian(target.information)) {
      ids.push_back(target.target_id);
      last_seen_s.push_back(to_seconds(target.last_seen - start));
      gaussians.push_back(*gaussian);
    }
  }
  const auto count = static_cast<py::ssize_t>(ids.size());
  const auto dim =
      gaussians.empty() ? py::ssize_t{0} : static_cast<py::ssize_t>(gaussians[0].mean.size());
  py::array_t<std::int64_t> id_array(count);
  py::array_t<double> seen_array(count);
  py::array_t<double> means({count, dim});
  py::array_t<double> covariances({count, dim, dim});
  auto mean_view = means.mutable_unchecked<2>();
  auto covariance_view = covariances.mutable_unchecked<3>();
  for (py::ssize_t k = 0; k < count; ++k) {
    const auto at = index(k);
    id_array.mutable_at(k) = ids[at];
    seen_array.mutable_at(k) = last_seen_s[at];
    for (py::ssize_t i = 0; i < dim; ++i) {
      mean_view(k, i) = gaussians[at].mean(i);
      for (py::ssize_t j = 0; j < dim; ++j) {
        covariance_view(k, i, j) = gaussians[at].covariance(i, j);
      }
    }
  }
  py::dict out;
  out["time_s"] = to_seconds(belief.stamp.time - start);
  out["ids"] = id_array;
  out["means"] = means;
  out["covariances"] = covariances;
  out["last_seen_s"] = seen_array;
  out["grid_last_seen_utime"] = grid_array(belief.grid, belief.last_seen_utime);
  out["grid_origin_m"] = array_of(belief.grid.origin_m);
  out["grid_resolution_m"] = belief.grid.resolution_m;
  return out;
}

py::dict plan_dict(const models::RobotPlan& plan, Time start) {
  std::vector<Pose2> poses;
  for (int t = 0; t <= plan.horizon_steps; ++t) {
    poses.push_back(
        models::at(plan.trajectory, plan.trajectory.start_time + from_seconds(t * plan.step_s))
            .world_from_body);
  }
  py::dict out;
  out["round"] = plan.round;
  out["source"] = name_of(plan.source);
  out["start_s"] = to_seconds(plan.trajectory.start_time - start);
  out["step_s"] = plan.step_s;
  out["poses"] = poses_array(poses, poses.size());
  out["cost"] = plan.cost;
  out["lower_bound"] = plan.lower_bound;
  out["nodes"] = plan.nodes;
  out["late"] = plan.late;
  return out;
}

py::dict map_dict(const models::RobotMap& map, Time start) {
  py::array_t<std::int16_t> looks(
      {static_cast<py::ssize_t>(map.grid.rows), static_cast<py::ssize_t>(map.grid.columns)});
  std::copy(map.team_looks.begin(), map.team_looks.end(), looks.mutable_data());
  py::dict out;
  out["time_s"] = to_seconds(map.stamp.time - start);
  out["looks"] = looks;
  out["entropy_nats"] = map.entropy_nats;
  out["grid_origin_m"] = array_of(map.grid.origin_m);
  out["grid_resolution_m"] = map.grid.resolution_m;
  return out;
}

}  // namespace

// Long function: it lists the Python names, one entry each.
void bind_trial(py::module_& module) {
  py::class_<Trial>(module, "Trial",
                    R"(One trial in virtual time: simulator, sensors, estimators, planners.

Trial(scenario, *, log=None, sensors={}, planners={}, filters={}): the scenario may also be a path
or a dict. The result depends only on the scenario and its seed, not on how the trial is stepped,
and equals the result of `vantage trial`. Without planner.node_budget a search has 20 000 nodes per
slot, as in `vantage trial`. `log` is the path of an LCM log to write.

sensors={"Q1": look}: look(viewpoint, targets, time_s) replaces that robot's sensor at each planning
step. viewpoint (4,): x, y, z in m and yaw in rad; targets {id: (3,) m}; time_s since the Unix
epoch. It returns a list of (id, z (k,), V (k, k)). The function decides which targets are detected
and how accurately; the scenario's sensor kind defines the meaning of z.

planners={"Q1": plan, …}, one for each robot: plan(question) replaces the scenario's search once per
round; vantage.own.Search describes the question. It returns rows (n, 3) of speed in m/s, yaw rate
in rad/s and duration in s, or None. The result is checked like any plan; without a valid
result the robot uses its fallback. The scenario, also in logs, then contains planner.algorithm: external.

filters={"Q1": filter}: filter(looks, time_s) replaces the target estimation of that robot. looks is
a list of (viewpoint, [(id, z, V), …]) since the last step. It returns
{id: (mean (n,), covariance (n, n))}, where n is the dimension of the scenario's target model.

Functions hold the interpreter's lock. An exception in a function ends the step.

Times are seconds since the trial's start. Other threads run while the trial is stepped.)")
      .def(py::init([](const py::object& scenario, const py::object& log, const Functions& sensors,
                       const Functions& planners, const Functions& filters) {
             py::object of = scenario;
             if (!py::isinstance<Scenario>(scenario)) {
               of = py::type::of<Scenario>()(scenario);
             }
             return std::make_unique<Trial>(py::cast<std::shared_ptr<Scenario>>(of),
                                            log.is_none() ? "" : path_text(log), sensors, planners,
                                            filters);
           }),
           py::arg("scenario"), py::kw_only(), py::arg("log") = py::none(),
           py::arg("sensors") = Functions{}, py::arg("planners") = Functions{},
           py::arg("filters") = Functions{})
      .def_property_readonly("scenario", &Trial::scenario,
                             "The scenario as run, with its node budget.")
      .def_property_readonly("time_s", &Trial::time_s)
      .def_property_readonly("is_over", &Trial::is_over)
      .def("advance", &Trial::advance, py::arg("seconds"),
           "Advances by `seconds`, at most to the end of the scenario.")
      .def(
          "step",
          [](Trial& self, int steps) {
            require(steps >= 1, "steps: must be ≥ 1");
            self.advance(steps * self.scenario()->value.planner.step_s);
          },
          py::arg("steps") = 1, "Advances by `steps` planning steps of scenario.step_s.")
      .def("run", &Trial::run, py::arg("progress") = py::none(),
           "Advances to the end and calls progress(share) repeatedly. Ctrl-C interrupts it.")
      .def_property_readonly(
          "robots", [](const Trial& self) { return truth_array(self, false); },
          R"((N, 7): true x, y, z in m, yaw in rad, vx, vy, vz in m/s of each robot.

In the order of scenario.robots; nan before the first instant.)")
      .def_property_readonly(
          "targets", [](const Trial& self) { return truth_array(self, true); },
          "(M, 7): the same quantities of the targets.")
      .def_property_readonly(
          "beliefs",
          [](const Trial& self) {
            const auto [beliefs, start] = self.exclusively(
                [](trial::Trial& t) { return std::pair(t.observer().beliefs(), t.start()); });
            py::dict out;
            for (const auto& [robot, belief] : beliefs) {
              out[py::str(robot)] = belief_dict(belief, start);
            }
            return out;
          },
          R"({robot: its newest belief}: time_s; ids (K,), means (K, n), covariances (K, n, n) and
last_seen_s (K,) of its known targets; grid_last_seen_utime (rows, columns), 0 for never.)")
      .def_property_readonly(
          "plans",
          [](const Trial& self) {
            const auto [robots, start] = self.exclusively([](trial::Trial& t) {
              return std::pair(t.observer().metrics().robots(), t.start());
            });
            py::dict out;
            for (const auto& [robot, status] : robots) {
              if (status.plan) {
                out[py::str(robot)] = plan_dict(*status.plan, start);
              }
            }
            return out;
          },
          R"({robot: its newest plan}: poses (T + 1, 3) at start_s + k step_s, including the start;
cost and lower_bound in nats; source: searched, shifted or braking; nodes, round, late.)")
      .def_property_readonly(
          "maps",
          [](const Trial& self) {
            const auto [maps, start] = self.exclusively(
                [](trial::Trial& t) { return std::pair(t.observer().maps(), t.start()); });
            py::dict out;
            for (const auto& [robot, map] : maps) {
              out[py::str(robot)] = map_dict(map, start);
            }
            return out;
          },
          R"({robot: its newest map} of a mapping scenario: looks (rows, columns), the number of
scans that hit the cell minus the number that passed through it; entropy_nats.)")
      .def_property_readonly(
          "metrics",
          [](const Trial& self) {
            return from_json(self.exclusively([](trial::Trial& t) {
              return logs::to_json(t.result().summary)
                  .dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
            }));
          },
          "Results of the trial so far, with the keys of `vantage trial --json`.");
}

}  // namespace vantage::python
