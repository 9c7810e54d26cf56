#include "planner/team/decision/candidate.hpp"

#include <algorithm>
#include <span>

#include "core/check.hpp"
#include "planner/search/belief_table.hpp"
#include "planner/search/motion_table.hpp"
#include "planner/team/look.hpp"

namespace vantage::planner {
namespace {

double state_cost(const EnergyModel& energy, const models::World* world,
                  const Eigen::Vector2d& at_m) {
  double cost = 0.0;
  if (world == nullptr) {
    return cost;
  }
  for (const models::Region& region : world->regions) {
    const bool pays = std::find(energy.regions.begin(), energy.regions.end(), region.name) !=
                      energy.regions.end();
    cost += pays && region.footprint.contains(at_m) ? region.cost_per_step : 0.0;
  }
  return cost;
}

double control_cost(const EnergyModel& energy, const models::UnicycleControl& control) {
  if (control.speed_mps != 0.0) {
    return energy.move_cost;
  }
  return control.yaw_rate_radps != 0.0 ? energy.turn_cost : energy.rest_cost;
}

// Candidates of one problem, whose predicted means are worked out once.
class CandidateMaker {
 public:
  CandidateMaker(const SearchProblem& problem, const EnergyModel& energy)
      : problem_(problem),
        energy_(energy),
        beliefs_(static_cast<int>(problem.targets.size()), problem.horizon_steps) {
    beliefs_.reset(problem);
    for (const models::SensorModel& sensor : problem.sensors) {
      range_max_m_ = std::max(range_max_m_, sensor.range_max_m);
    }
  }

  [[nodiscard]] Candidate make(std::vector<int> controls, std::vector<Pose2> poses) const {
    Candidate candidate;
    candidate.energy_cost = energy_.price_nats * energy_used(energy_, problem_, controls, poses);
    for (int m = 0; m < beliefs_.target_count(); ++m) {
      const bool spatial = beliefs_.layout(m) == BlockLayout::kSpatial;
      for (std::size_t t = 0; t < poses.size(); ++t) {
        const Eigen::Vector3d& mean_m = beliefs_.mean_m(m, static_cast<int>(t) + 1);
        if ((mean_m.head<2>() - poses[t].position_m()).squaredNorm() >=
            range_max_m_ * range_max_m_) {
          continue;  // no sensor reaches it: ranges are never shorter than on the ground
        }
        const models::PositionVector target_m = mean_m.head(spatial ? 3 : 2);
        const models::PositionMatrix M =
            look(problem_.world, problem_.sensors, {poses[t], problem_.height_m}, target_m);
        if (M.isZero(0.0)) {
          continue;
        }
        Look seen{static_cast<std::uint16_t>(m), static_cast<std::uint16_t>(t + 1), {}};
        pack(spatial ? BlockLayout::kSpatial : BlockLayout::kPlanar, M, seen.information.m);
        candidate.looks.push_back(seen);
      }
    }
    candidate.controls = std::move(controls);
    candidate.poses = std::move(poses);
    return candidate;
  }

 private:
  const SearchProblem& problem_;
  const EnergyModel& energy_;
  BeliefTable beliefs_;
  double range_max_m_ = 0.0;
};

}  // namespace

double energy_used(const EnergyModel& energy, const SearchProblem& problem,
                   const std::vector<int>& controls, const std::vector<Pose2>& poses) {
  double used = 0.0;
  Pose2 at = problem.start;
  for (std::size_t t = 0; t < controls.size(); ++t) {
    used += control_cost(energy, problem.controls[static_cast<std::size_t>(controls[t])]) +
            state_cost(energy, problem.world, at.position_m());
    at = poses[t];
  }
  return used;
}

Candidate make_candidate(const SearchProblem& problem, const EnergyModel& energy,
                         std::vector<int> controls) {
  require_valid(problem);
  require(controls.size() == static_cast<std::size_t>(problem.horizon_steps),
          "candidate: one control for every step");
  std::vector<Pose2> poses;
  Pose2 at = problem.start;
  for (const int c : controls) {
    require(c >= 0 && c < static_cast<int>(problem.controls.size()),
            "candidate: controls are indices into the problem's");
    at = models::step_unicycle(at, problem.controls[static_cast<std::size_t>(c)], problem.step_s);
    poses.push_back(at);
  }
  return CandidateMaker(problem, energy).make(std::move(controls), std::move(poses));
}

std::vector<Candidate> candidate_trajectories(const SearchProblem& problem,
                                              const EnergyModel& energy,
                                              ReducedValueIteration& search,
                                              const CandidateOptions& options) {
  ReducedOptions pass;
  pass.search = ReducedSearch::kSinglePass;
  pass.epsilon = options.epsilon;
  pass.delta_m = options.delta_m;
  pass.yaw_weight_m_per_rad = options.yaw_weight_m_per_rad;
  search.plan(problem, pass, Deadline::never());

  const CandidateMaker maker(problem, energy);
  MotionTable motion(static_cast<int>(problem.controls.size()), problem.horizon_steps,
                     static_cast<int>(problem.teammates.size()));
  motion.reset(problem);
  const Tree& tree = search.tree();
  std::vector<Candidate> candidates;
  for (NodeId leaf = 0; leaf < static_cast<NodeId>(tree.node_count()); ++leaf) {
    const Node& last = tree[leaf];
    if (last.depth != problem.horizon_steps ||
        !motion.can_stop(last.world_from_body, last.control, last.depth)) {
      continue;
    }
    std::vector<int> controls(last.depth);
    std::vector<Pose2> poses(last.depth);
    for (NodeId id = leaf; tree[id].parent != kNoNode; id = tree[id].parent) {
      controls[tree[id].depth - 1U] = tree[id].control;
      poses[tree[id].depth - 1U] = tree[id].world_from_body;
    }
    candidates.push_back(maker.make(std::move(controls), std::move(poses)));
  }
  return candidates;
}

}  // namespace vantage::planner
