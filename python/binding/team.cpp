#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "core/check.hpp"
#include "python/binding/bind.hpp"
#include "python/binding/interruption.hpp"
#include "python/binding/planning.hpp"
#include "python/task/team_decision.hpp"

namespace vantage::python {
namespace {

using Costs = std::map<std::string, double>;
// one entry for all robots, or one entry per robot
using TeamCosts = std::variant<Costs, std::vector<Costs>>;

planner::EnergyModel energy_of(const Costs& costs) {
  planner::EnergyModel energy;
  const std::map<std::string, double*> fields{{"move_cost", &energy.move_cost},
                                              {"price_nats", &energy.price_nats},
                                              {"rest_cost", &energy.rest_cost},
                                              {"turn_cost", &energy.turn_cost}};
  for (const auto& [name, value] : costs) {
    *kind_of(name, fields, "energy") = value;
    require(std::isfinite(value) && value >= 0.0,
            fmt::format("energy: {}: must be ≥ 0, got {}", name, value));
  }
  return energy;
}

std::vector<planner::EnergyModel> energies_of(const TeamCosts& costs, std::size_t robots) {
  std::vector<planner::EnergyModel> energies;
  if (const auto* one = std::get_if<Costs>(&costs)) {
    if (!one->empty()) {
      energies.assign(robots, energy_of(*one));
    }
  } else {
    for (const Costs& own : std::get<std::vector<Costs>>(costs)) {
      energies.push_back(energy_of(own));
    }
  }
  return energies;
}

planner::InformationMeasure measure_of(const std::string& word) {
  static const std::map<std::string, planner::InformationMeasure> kMeasures{
      {"mutual", planner::InformationMeasure::kMutual},
      {"logdet", planner::InformationMeasure::kLogDet}};
  return kind_of(word, kMeasures, "measure");
}

// Returns the search problems in `sources`. `kept` receives references to the objects that own the
// problems' worlds.
std::vector<planner::SearchProblem> problems_of(const py::sequence& sources, py::list& kept) {
  std::vector<planner::SearchProblem> problems;
  for (const py::handle each : sources) {
    kept.append(py::isinstance<Problem>(each) ? py::reinterpret_borrow<py::object>(each)
                                              : py::type::of<Problem>()(each));
    problems.push_back(py::cast<const Problem&>(kept[kept.size() - 1])
                           .exclusively([](const tools::PlanningProblem& p) { return p.problem; }));
  }
  return problems;
}

std::unique_ptr<Decision> decided(std::vector<planner::SearchProblem> problems, TeamRequest request,
                                  Planner* planner) {
  if (planner != nullptr) {
    request.search = [planner](const planner::SearchProblem& problem) {
      return planner->solve(problem).result;
    };
  }
  request.is_cancelled = Interruption::has_raised;
  const Interruption interruption;
  std::unique_ptr<Decision> decision;
  {
    const py::gil_scoped_release release;
    decision = std::make_unique<Decision>(std::move(problems), request);
  }
  interruption.rethrow();
  return decision;
}

// Applies `of` to the chosen candidate of each robot; for a robot without a choice, to an empty
// candidate.
template <class Of>
py::list per_robot(const Decision& decision, const Of& of) {
  static const planner::Candidate kNothing;
  py::list out;
  const auto chosen = decision.chosen();
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    out.append(of(chosen[i] ? decision.team().candidates[i][*chosen[i]] : kNothing));
  }
  return out;
}

py::array_t<std::int64_t> controls_of(const planner::Candidate& candidate) {
  py::array_t<std::int64_t> out(static_cast<py::ssize_t>(candidate.controls.size()));
  std::copy(candidate.controls.begin(), candidate.controls.end(), out.mutable_data());
  return out;
}

py::list candidates_of(const Decision& decision) {
  py::list out;
  for (const std::vector<planner::Candidate>& own : decision.team().candidates) {
    py::array_t<std::int64_t> rows({static_cast<py::ssize_t>(own.size()),
                                    static_cast<py::ssize_t>(decision.team().horizon_steps)});
    std::int64_t* next = rows.mutable_data();
    for (const planner::Candidate& candidate : own) {
      next = std::copy(candidate.controls.begin(), candidate.controls.end(), next);
    }
    out.append(rows);
  }
  return out;
}

// Long function: it lists the Python names, one entry each.
void bind_decision(py::module_& module) {
  py::class_<Decision>(module, "Decision",
                       "Decision of a team: one entry per robot, in the order of the problems.")
      .def_property_readonly("algorithm", &Decision::algorithm, "Name in team_algorithms().")
      .def_property_readonly(
          "value", &Decision::value,
          "J: information gain of all plans together minus the cost of motion, nats.")
      .def_property_readonly(
          "bound", &Decision::bound,
          R"(Proven upper bound of J over all choices of these candidates; equal to J for exhaustive.

None for rain, which searches instead of choosing, and for measure logdet.)")
      .def_property_readonly(
          "choice", &Decision::chosen,
          "Chosen row of `candidates` for each robot; None for a robot without a plan.")
      .def_property_readonly(
          "candidates", &candidates_of,
          "For each robot (N, T): controls of its candidates; with rain, only its plan.")
      .def_property_readonly(
          "controls", [](const Decision& d) { return per_robot(d, &controls_of); },
          "For each robot (T,): rows of its Problem.controls; (0,) without a plan.")
      .def_property_readonly(
          "states",
          [](const Decision& d) {
            return per_robot(d, [](const planner::Candidate& candidate) {
              return poses_array(candidate.poses, candidate.poses.size());
            });
          },
          "For each robot (T, 3): x, y in m and yaw in rad after each step.")
      .def_property_readonly(
          "bait", &Decision::bait,
          "Robots that are expected to be attacked: the others plan without their observations.")
      .def_property_readonly("oracle_calls", &Decision::oracle_calls,
                             "Number of evaluated sets of plans.")
      .def_property_readonly("messages", &Decision::messages,
                             "Number of broadcasts; 0 for a central decision.")
      .def(
          "worst_attack",
          [](const Decision& d, int attacks_max) {
            planner::Attack attack;
            {
              const py::gil_scoped_release release;
              attack = d.worst_attack(attacks_max);
            }
            return std::pair(attack.robots, attack.value);
          },
          py::arg("attacks_max"),
          R"(Returns (robots, value): the worst attack on at most attacks_max robots and its J.

All attacks are enumerated.)")
      .def(
          "paths_bound",
          [](const Decision& d, int attacks_max, std::int64_t nodes) {
            const Interruption interruption;
            double nats = 0.0;
            {
              const py::gil_scoped_release release;
              nats = d.paths_bound(attacks_max, nodes, Interruption::has_raised);
            }
            interruption.rethrow();
            return std::isfinite(nats) ? std::optional<double>(nats) : std::nullopt;
          },
          py::arg("attacks_max") = 0, py::arg("nodes") = 4'000'000,
          R"(Returns a proven upper bound of J over all paths that the robots' controls allow, nats.

It ignores obstacles and the cost of motion. With attacks_max it bounds the value that remains after
the worst attack on that number of robots. More nodes give a tighter bound and take about 0.1 s
per million. None: no bound is known (for example for targets in 3-D).)")
      .def("__repr__", [](const Decision& d) {
        return "<vantage.Decision " + d.algorithm() + ": " + std::to_string(d.value()) + " nats>";
      });
}

}  // namespace

// Long function: it lists the Python names, one entry each.
void bind_team(py::module_& module) {
  bind_decision(module);
  module.def(
      "team_algorithms",
      [] {
        py::dict out;
        for (const planner::DecisionAlgorithm& each : team_algorithms()) {
          out[py::str(std::string(each.name))] = std::string(each.what);
        }
        return out;
      },
      "Returns {name: description} of all decision algorithms.");
  module.def(
      "decide",
      [](const py::sequence& sources, const std::string& algorithm, const std::string& measure,
         std::size_t candidates_max, std::int64_t nodes, double epsilon, double delta_m,
         int attacks_max, const std::vector<int>& order, int rounds_max, double alpha,
         const TeamCosts& energy, Planner* planner) {
        py::list kept;
        std::vector<planner::SearchProblem> problems = problems_of(sources, kept);
        TeamRequest request;
        request.algorithm = algorithm;
        request.measure = measure_of(measure);
        request.candidates.candidates_max = candidates_max;
        request.nodes = nodes;
        request.candidates.epsilon = epsilon;
        request.candidates.delta_m = delta_m;
        request.options.attacks_max = attacks_max;
        request.options.order = order;
        request.options.rounds_max = rounds_max;
        request.options.alpha = alpha;
        request.energy = energies_of(energy, problems.size());
        return decided(std::move(problems), std::move(request), planner);
      },
      py::arg("problems"), py::arg("algorithm") = "coordinate_descent", py::kw_only(),
      py::arg("measure") = "mutual", py::arg("candidates_max") = 200, py::arg("nodes") = 20'000,
      py::arg("epsilon") = 1.0, py::arg("delta_m") = 1.0, py::arg("attacks_max") = 0,
      py::arg("order") = std::vector<int>{}, py::arg("rounds_max") = 1, py::arg("alpha") = 1.0,
      py::arg("energy") = Costs{}, py::arg("planner") = py::none(),
      R"(Returns a Decision: a plan for each robot of a team. The result is reproducible.

problems: one per robot, each with its own start, controls, sensor and map, and with the same
targets, T and tau; dicts and paths are accepted. A search with `nodes` nodes (epsilon and delta_m
as in Planner) gives each robot at most candidates_max candidates. The team chooses among them by
`algorithm`, one of team_algorithms(); with rain each robot searches by `planner` or `nodes`.
J is the information of all observations about the targets, nats, minus the cost of motion. measure
mutual: I(y_1:T; z_1:T), for which the algorithms have guarantees; logdet: ½ Σ log det Σ⁰_t / Σ_t.
energy: one dict for all robots or one per robot, with price_nats per unit of cost and the costs of
a step: rest_cost, turn_cost (turning without driving) and move_cost.

attacks_max: number of jammed robots that resilient, resilient_exhaustive, max_min and rain expect.
order: order in which the robots choose; rounds_max: maximum number of rounds; both only for
coordinate_descent.
alpha: each step of a local search multiplies J by at least 1 + alpha/N⁴, with N candidates.)");
}

}  // namespace vantage::python
