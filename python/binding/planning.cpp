#include "python/binding/planning.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include <pybind11/stl.h>

#include "core/check.hpp"
#include "python/binding/bind.hpp"
#include "python/binding/interruption.hpp"
#include "tools/plan/plan_report.hpp"

namespace vantage::python {
namespace {

using planner::SearchResult;
using tools::PlanOutcome;

// C++ object behind Python's vantage.Plan. A plan remains valid after its problem is deleted.
struct Plan {
  PlanOutcome outcome;
  int horizon_steps = 0;
  bool is_complete = false;

  [[nodiscard]] const SearchResult& result() const { return outcome.result; }
};

Plan plan_of(Planner& planner, const Problem& problem) {
  const Interruption interruption;
  Plan plan = problem.exclusively([&](const tools::PlanningProblem& planning) {
    Plan found;
    found.outcome = planner.solve(planning.problem);
    found.outcome.source = problem.source();
    found.horizon_steps = planning.problem.horizon_steps;
    found.is_complete = tools::is_complete(planning.problem, found.outcome.result);
    return found;
  });
  interruption.rethrow();
  return plan;
}

tools::PlanRequest request_of(const std::string& algorithm, std::optional<double> budget_s,
                              std::optional<std::int64_t> nodes, double epsilon, double delta_m,
                              double weight, std::size_t memory_mb) {
  require(!budget_s || !nodes, "budget_s, nodes: only one of them may be given");
  tools::PlanRequest request;
  request.algorithm = algorithm;
  request.budget_s = budget_s.value_or(request.budget_s);
  request.nodes = nodes;
  request.options.epsilon = epsilon;
  request.options.delta_m = delta_m;
  request.options.weight = weight;
  request.memory_mb = memory_mb;
  return request;
}

std::unique_ptr<Problem> problem_of(const py::object& source) {
  if (py::isinstance<py::dict>(source)) {
    const std::string name = "problem";
    return std::make_unique<Problem>(tools::parse_problem(json_text(source), name), name);
  }
  const std::string path = path_text(source);
  const py::gil_scoped_release release;
  return std::make_unique<Problem>(tools::load_problem(path), path);
}

py::array_t<double> controls_array(const Problem& problem) {
  const auto controls =
      problem.exclusively([](const tools::PlanningProblem& p) { return p.problem.controls; });
  py::array_t<double> out({static_cast<py::ssize_t>(controls.size()), py::ssize_t{2}});
  for (std::size_t i = 0; i < controls.size(); ++i) {
    out.mutable_at(static_cast<py::ssize_t>(i), 0) = controls[i].speed_mps;
    out.mutable_at(static_cast<py::ssize_t>(i), 1) = controls[i].yaw_rate_radps;
  }
  return out;
}

std::vector<planner::SearchTarget> targets_of(const Problem& problem) {
  return problem.exclusively([](const tools::PlanningProblem& p) { return p.problem.targets; });
}

py::array_t<double> means_array(const Problem& problem) {
  const auto targets = targets_of(problem);
  const auto dim = static_cast<py::ssize_t>(targets.front().prior.mean.size());
  py::array_t<double> out({static_cast<py::ssize_t>(targets.size()), dim});
  for (std::size_t m = 0; m < targets.size(); ++m) {
    for (py::ssize_t i = 0; i < dim; ++i) {
      out.mutable_at(static_cast<py::ssize_t>(m), i) =
          targets[m].prior.mean(static_cast<Eigen::Index>(i));
    }
  }
  return out;
}

py::array_t<double> covariances_array(const Problem& problem) {
  const auto targets = targets_of(problem);
  const auto dim = static_cast<py::ssize_t>(targets.front().prior.mean.size());
  py::array_t<double> out({static_cast<py::ssize_t>(targets.size()), dim, dim});
  auto view = out.mutable_unchecked<3>();
  for (std::size_t m = 0; m < targets.size(); ++m) {
    for (py::ssize_t i = 0; i < dim; ++i) {
      for (py::ssize_t j = 0; j < dim; ++j) {
        view(static_cast<py::ssize_t>(m), i, j) =
            targets[m].prior.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      }
    }
  }
  return out;
}

void set_beliefs(Problem& problem, const Doubles& means, const Doubles& covariances) {
  const auto dim = static_cast<py::ssize_t>(targets_of(problem).front().prior.mean.size());
  require_shape(means, {-1, dim}, "means");
  require_shape(covariances, {means.shape(0), dim, dim}, "covariances");
  if (means.shape(0) == 0) {
    throw py::value_error("means: must contain at least one target");
  }
  std::vector<models::Gaussian> beliefs(static_cast<std::size_t>(means.shape(0)));
  for (std::size_t m = 0; m < beliefs.size(); ++m) {
    const auto row = static_cast<py::ssize_t>(m);
    beliefs[m].mean.resize(dim);
    beliefs[m].covariance.resize(dim, dim);
    for (py::ssize_t i = 0; i < dim; ++i) {
      beliefs[m].mean(i) = means.at(row, i);
      for (py::ssize_t j = 0; j < dim; ++j) {
        beliefs[m].covariance(i, j) = covariances.at(row, i, j);
      }
    }
  }
  problem.change([&](planner::SearchProblem& p) {
    p.targets.resize(beliefs.size(), p.targets.front());
    for (std::size_t m = 0; m < beliefs.size(); ++m) {
      p.targets[m].prior = beliefs[m];
    }
  });
}

double score(const Problem& problem, const Doubles& poses) {
  require_shape(poses, {-1, 3}, "poses");
  std::vector<Pose2> along;
  for (py::ssize_t t = 0; t < poses.shape(0); ++t) {
    along.push_back({poses.at(t, 0), poses.at(t, 1), poses.at(t, 2)});
  }
  return problem.exclusively([&](const tools::PlanningProblem& p) {
    require(std::ssize(along) == p.problem.horizon_steps,
            "poses: must have one row per step, " + std::to_string(p.problem.horizon_steps) +
                ", got " + std::to_string(along.size()));
    return planner::score(p.problem, along);
  });
}

py::object number_or_none(double value) {
  return std::isfinite(value) ? py::object(py::float_(value)) : py::object(py::none());
}

double gap_of(const Plan& plan) {
  return plan.is_complete ? std::max(0.0, plan.result().cost - plan.result().lower_bound)
                          : std::numeric_limits<double>::infinity();
}

// Long function: it lists the Python names, one entry each.
void bind_problem(py::module_& module) {
  py::class_<Problem>(
      module, "Problem",
      R"(Planning problem of one robot, as described in docs/guide/planning-problems.md.

Problem(source) reads a dict with the keys of that page, or the JSON file at a path.
Invalid input raises StartupError with the message of `vantage plan`.)")
      .def(py::init(&problem_of), py::arg("source"))
      .def_static(
          "parse",
          [](const std::string& text, const std::string& name) {
            return std::make_unique<Problem>(tools::parse_problem(text, name), name);
          },
          py::arg("text"), py::arg("name") = "problem",
          "Reads JSON text. Messages use `name` instead of a file name.")
      .def_property_readonly("name",
                             [](const Problem& p) {
                               return p.exclusively([](const tools::PlanningProblem& planning) {
                                 return planning.name;
                               });
                             })
      .def_property_readonly("source", &Problem::source)
      .def_property_readonly(
          "horizon_steps",
          [](const Problem& p) {
            return p.exclusively(
                [](const auto& planning) { return planning.problem.horizon_steps; });
          },
          "Horizon T, steps.")
      .def_property_readonly(
          "step_s",
          [](const Problem& p) {
            return p.exclusively([](const auto& planning) { return planning.problem.step_s; });
          },
          "Duration of each control, s.")
      .def_property_readonly("controls", &controls_array,
                             "(U, 2): speed in m/s and yaw rate in rad/s; an action is a row.")
      .def_property(
          "start",
          [](const Problem& p) {
            const Pose2 start =
                p.exclusively([](const auto& planning) { return planning.problem.start; });
            return array_of(Eigen::Vector3d(start.x_m, start.y_m, start.yaw_rad));
          },
          [](Problem& p, const Doubles& start) {
            Pose2 pose = pose_of(start, "start");
            pose.yaw_rad = wrap_to_pi(pose.yaw_rad);
            p.change([&](planner::SearchProblem& problem) { problem.start = pose; });
          },
          "(3,): x, y in m and yaw in rad, world from body. Can be set.")
      .def_property_readonly("means", &means_array,
                             "(M, n): x, y in m of each target, and vx, vy in m/s if it moves.")
      .def_property_readonly("covariances", &covariances_array,
                             "(M, n, n): covariances of `means`.")
      .def("set_beliefs", &set_beliefs, py::arg("means"), py::arg("covariances"),
           R"(Replaces the beliefs: means (M, n), covariances (M, n, n).

M may change. Raises UsageError unless each covariance is symmetric and positive definite.)")
      .def("score", &score, py::arg("poses"),
           R"(Returns the cost of the path with the poses (T, 3), one after each step.

Nats for cost logdet, m² for trace. Reachability and clearance of the poses are not checked.)")
      .def("__repr__", [](const Problem& p) {
        return p.exclusively([&](const tools::PlanningProblem& planning) {
          return "<vantage.Problem " + (planning.name.empty() ? p.source() : planning.name) + ": " +
                 std::to_string(planning.problem.targets.size()) + " targets, " +
                 std::to_string(planning.problem.horizon_steps) + " steps>";
        });
      });
}

// Long function: it lists the Python names, one entry each.
void bind_plan(py::module_& module) {
  const auto integer = [](std::int64_t SearchResult::*member) {
    return [member](const Plan& p) { return p.result().*member; };
  };
  py::class_<Plan>(module, "Plan", "Result of a search. Unknown numbers are None.")
      .def_property_readonly(
          "found", [](const Plan& p) { return p.is_complete; },
          "True if there is a plan of all T steps.")
      .def_property_readonly(
          "cost",
          [](const Plan& p) {
            return p.is_complete ? number_or_none(p.result().cost) : py::object(py::none());
          },
          "Sum over steps and targets: nats (logdet) or m² (trace).")
      .def_property_readonly(
          "lower_bound", [](const Plan& p) { return number_or_none(p.result().lower_bound); },
          "Proven lower bound of the cost of all plans.")
      .def_property_readonly(
          "gap", [](const Plan& p) { return number_or_none(gap_of(p)); }, "cost − lower_bound.")
      .def_property_readonly(
          "controls",
          [](const Plan& p) {
            py::array_t<std::int64_t> out(static_cast<py::ssize_t>(p.result().controls.size()));
            std::copy(p.result().controls.begin(), p.result().controls.end(), out.mutable_data());
            return out;
          },
          "(T,): rows of Problem.controls; fewer if no complete plan was found.")
      .def_property_readonly(
          "states",
          [](const Plan& p) { return poses_array(p.result().poses, p.result().controls.size()); },
          "(T, 3): x, y in m and yaw in rad after each step, without the start.")
      .def_property_readonly(
          "algorithm", [](const Plan& p) { return p.outcome.algorithm; }, "Name of the search.")
      .def_property_readonly(
          "epsilon", [](const Plan& p) { return number_or_none(p.result().epsilon); },
          "epsilon of the last finished pass.")
      .def_property_readonly(
          "delta_m", [](const Plan& p) { return number_or_none(p.result().delta_m); },
          "delta of the last finished pass, m.")
      .def_property_readonly("nodes_generated", integer(&SearchResult::nodes_generated))
      .def_property_readonly("nodes_expanded", integer(&SearchResult::nodes_expanded))
      .def_property_readonly("work_nodes", integer(&SearchResult::work_nodes),
                             "Amount of search work, in the unit of Planner(nodes=…).")
      .def_property_readonly("passes", integer(&SearchResult::passes))
      .def_property_readonly(
          "elapsed_s", [](const Plan& p) { return p.outcome.elapsed_s; },
          "Wall time of the search alone, s.")
      .def_property_readonly(
          "cpu_s", [](const Plan& p) { return p.outcome.cpu_s; },
          "CPU time of the search alone, s.")
      .def_property_readonly(
          "peak_bytes", [](const Plan& p) { return p.outcome.peak_bytes; },
          "Memory of nodes, blocks and lists in use.")
      .def_property_readonly(
          "stop_reason", [](const Plan& p) { return tools::word_of(p.result().stop_reason); },
          "Reason for the end of the search: finished, converged, deadline or memory.")
      .def_property_readonly(
          "history",
          [](const Plan& p) {
            const auto& history = p.result().history;
            py::array_t<double> out({static_cast<py::ssize_t>(history.size()), py::ssize_t{4}});
            for (std::size_t i = 0; i < history.size(); ++i) {
              const auto row = static_cast<py::ssize_t>(i);
              out.mutable_at(row, 0) = history[i].epsilon;
              out.mutable_at(row, 1) = history[i].delta_m;
              out.mutable_at(row, 2) = history[i].cost;
              out.mutable_at(row, 3) = static_cast<double>(history[i].work_nodes);
            }
            return out;
          },
          "(passes, 4): epsilon, delta in m, cost and work_nodes of each finished pass.")
      .def("__repr__", [](const Plan& p) {
        return "<vantage.Plan " + p.outcome.algorithm +
               (p.is_complete ? ": cost " + std::to_string(p.result().cost) + ">" : ": none>");
      });
}

void bind_planner(py::module_& module) {
  py::class_<Planner>(module, "Planner", R"(A search with reusable memory.

Planner(algorithm="default", *, budget_s=None, nodes=None, epsilon=1.0, delta_m=1.0, weight=1.0,
memory_mb=512) has the options of `vantage plan`; the default budget is one second. With nodes the
result is reproducible bit for bit and equals the result of the command. Other threads run during
the search; a Planner solves one problem at a time.)")
      .def(py::init([](const std::string& algorithm, std::optional<double> budget_s,
                       std::optional<std::int64_t> nodes, double epsilon, double delta_m,
                       double weight, std::size_t memory_mb) {
             return std::make_unique<Planner>(
                 request_of(algorithm, budget_s, nodes, epsilon, delta_m, weight, memory_mb));
           }),
           py::arg("algorithm") = "default", py::kw_only(), py::arg("budget_s") = py::none(),
           py::arg("nodes") = py::none(), py::arg("epsilon") = 1.0, py::arg("delta_m") = 1.0,
           py::arg("weight") = 1.0, py::arg("memory_mb") = 512)
      .def("plan", &plan_of, py::arg("problem"),
           R"(Returns the best plan at the deadline.

The first call for a problem size allocates memory. Ctrl-C raises KeyboardInterrupt.
A Python signal handler must not use the Planner or the Problem of an interrupted call.)")
      .def(
          "prepare",
          [](Planner& self, const Problem& problem) {
            problem.exclusively([&](const tools::PlanningProblem& p) { self.prepare(p.problem); });
          },
          py::arg("problem"), "Allocates the memory for problems of this size in advance.");
  module.def(
      "algorithms",
      [] {
        py::dict out;
        for (const planner::Algorithm& each : planner::all_algorithms()) {
          out[py::str(std::string(each.name))] = std::string(each.what);
        }
        return out;
      },
      "Returns {name: description} of all searches.");
  module.def(
      "plan",
      [](const py::object& problem, const py::kwargs& options) {
        py::object of = problem;
        if (!py::isinstance<Problem>(problem)) {
          of = py::type::of<Problem>()(problem);
        }
        return py::type::of<Planner>()(**options).attr("plan")(of);
      },
      py::arg("problem"),
      "Returns Planner(**options).plan(problem); `problem` may also be a dict or a path.");
}

}  // namespace

PlanOutcome Planner::solve(const planner::SearchProblem& problem) {
  const std::lock_guard lock(mutex_);
  return solver_.solve(problem, Interruption::has_raised);
}

void Planner::prepare(const planner::SearchProblem& problem) {
  const std::lock_guard lock(mutex_);
  solver_.prepare(problem);
}

void bind_planning(py::module_& module) {
  bind_problem(module);
  bind_plan(module);
  bind_planner(module);
}

}  // namespace vantage::python
