#include "planner/decision/candidate.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/check.hpp"
#include "core/index.hpp"
#include "planner/problem/information_at.hpp"
#include "planner/problem/motion_table.hpp"
#include "planner/search/crossing_index.hpp"
#include "scenario/energy_cost.hpp"

namespace vantage::planner {
namespace {

// Packed covariances of all targets at the end of a trajectory.
using LastBlocks = std::vector<double>;

// Maker of the candidates for one problem; computes the problem's predicted means only once.
class CandidateMaker {
 public:
  CandidateMaker(const SearchProblem& problem, const EnergyModel& energy)
      : problem_(problem),
        energy_(energy),
        courses_(problem, InformationMeasure::kMutual),
        beliefs_(courses_.beliefs()),
        kept_(static_cast<std::size_t>(problem.horizon_steps) + 1) {
    for (const models::SensorModel& sensor : problem.sensors) {
      range_max_m_ = std::max(range_max_m_, sensor.range_max_m);
      measures_velocity_ = measures_velocity_ || models::measures_velocity(sensor);
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
          continue;  // out of range: the spatial distance is at least the planar distance
        }
        const models::Viewpoint from{poses[t], problem_.height_m};
        PredictedMeasurement seen{
            static_cast<std::uint16_t>(m), static_cast<std::uint16_t>(t + 1), {}};
        if (measures_velocity_ && beliefs_.layout(m) == BlockLayout::kMoving) {
          models::StateVector state(4);
          state << mean_m.head<2>(), beliefs_.velocity_mps(m, static_cast<int>(t) + 1);
          const models::StateMatrix M =
              state_information_at(sight_world(problem_), problem_.sensors, from, state);
          if (M.isZero(0.0)) {
            continue;
          }
          pack(BlockLayout::kMoving, M, seen.information.m);
          seen.information.is_of_state = true;
        } else {
          const models::PositionVector target_m = mean_m.head(spatial ? 3 : 2);
          const models::PositionMatrix M =
              information_at(sight_world(problem_), problem_.sensors, from, target_m);
          if (M.isZero(0.0)) {
            continue;
          }
          pack(spatial ? BlockLayout::kSpatial : BlockLayout::kPlanar, M, seen.information.m);
        }
        candidate.measurements.push_back(seen);
      }
    }
    candidate.controls = std::move(controls);
    candidate.poses = std::move(poses);
    return candidate;
  }

  // Propagates the beliefs to the horizon's end with the measurements of `candidate` alone. Returns
  // the final beliefs and sets the candidate's gain.
  LastBlocks follow(Candidate& candidate) {
    LastBlocks blocks(static_cast<std::size_t>(beliefs_.target_count()) * kMaxPacked);
    for (int m = 0; m < beliefs_.target_count(); ++m) {
      std::copy_n(beliefs_.open_loop(m, problem_.horizon_steps), packed_size(beliefs_.layout(m)),
                  &blocks[index(m) * kMaxPacked]);
    }
    double gained_nats = 0.0;
    for_each_target(candidate.measurements, [&](int m, TargetCourses::Measurements measurements) {
      const int before = measurements.front().step - 1;
      gained_nats += courses_.follow(m, before, courses_.open_loop_course(m, before),
                                     {&measurements, 1}, kept_.data());
      std::copy_n(kept_.back().block, packed_size(beliefs_.layout(m)),
                  &blocks[index(m) * kMaxPacked]);
    });
    if (!beliefs_.has_fixed()) {
      candidate.mutual_nats = gained_nats;
    }
    return blocks;
  }

  // True if every block of `a`, plus εI, dominates the corresponding block of `b`.
  [[nodiscard]] bool is_redundant(const LastBlocks& a, double epsilon, const LastBlocks& b) const {
    for (int m = 0; m < beliefs_.target_count(); ++m) {
      const std::size_t at = index(m) * kMaxPacked;
      if (!dominates(beliefs_.layout(m), &a[at], epsilon, &b[at])) {
        return false;
      }
    }
    return true;
  }

 private:
  const SearchProblem& problem_;
  const EnergyModel& energy_;
  TargetCourses courses_;
  const BeliefTable& beliefs_;
  std::vector<TargetCourses::Course> kept_;  // working memory of follow(), by step
  double range_max_m_ = 0.0;
  bool measures_velocity_ = false;
};

struct Leaf {
  double order = 0.0;  ///< sort key, ascending
  NodeId id = kNoNode;
};

// Returns the energy cost of the path to `leaf`, nats.
double energy_of(const Tree& tree, NodeId leaf, const SearchProblem& problem,
                 const EnergyModel& energy) {
  double used = 0.0;
  for (NodeId id = leaf; tree[id].parent != kNoNode; id = tree[id].parent) {
    used += scenario::step_cost(energy, problem.world, problem.controls[index(tree[id].control)],
                                tree[tree[id].parent].world_from_body.position_m());
  }
  return energy.price_nats * used;
}

std::vector<Candidate> ordered_by(const std::vector<NodeId>& places,
                                  std::vector<Candidate> candidates) {
  std::vector<std::size_t> order(places.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return places[a] < places[b]; });
  std::vector<Candidate> ordered;
  ordered.reserve(order.size());
  for (const std::size_t i : order) {
    ordered.push_back(std::move(candidates[i]));
  }
  return ordered;
}

}  // namespace

double energy_used(const EnergyModel& energy, const SearchProblem& problem,
                   const std::vector<int>& controls, const std::vector<Pose2>& poses) {
  double used = 0.0;
  Pose2 at = problem.start;
  for (std::size_t t = 0; t < controls.size(); ++t) {
    used += scenario::step_cost(energy, problem.world, problem.controls[index(controls[t])],
                                at.position_m());
    at = poses[t];
  }
  return used;
}

Candidate make_candidate(const SearchProblem& problem, const EnergyModel& energy,
                         std::vector<int> controls) {
  require_valid(problem);
  require(controls.size() == static_cast<std::size_t>(problem.horizon_steps),
          "candidate: must have one control per step");
  std::vector<Pose2> poses;
  Pose2 at = problem.start;
  for (const int c : controls) {
    require(c >= 0 && c < static_cast<int>(problem.controls.size()),
            "candidate: controls must be indices into the problem's controls");
    at = models::step_unicycle(at, problem.controls[index(c)], problem.step_s);
    poses.push_back(at);
  }
  return CandidateMaker(problem, energy).make(std::move(controls), std::move(poses));
}

Candidate make_candidate(const SearchProblem& problem, const EnergyModel& energy,
                         const SearchResult& result) {
  require_valid(problem);
  require(result.found && result.poses.size() == static_cast<std::size_t>(problem.horizon_steps),
          "candidate: the search result must have one pose per step");
  return CandidateMaker(problem, energy).make(result.controls, result.poses);
}

Candidate make_candidate(const SearchProblem& problem, const models::SensorModel* sensor,
                         const models::Trajectory& trajectory, double energy_cost) {
  SearchProblem seen = problem;
  seen.height_m = trajectory.height_m;
  seen.sensors.clear();
  if (sensor != nullptr) {
    seen.sensors.push_back(*sensor);
  }
  std::vector<Pose2> poses;
  for (int t = 1; t <= problem.horizon_steps; ++t) {
    const Duration passed = from_seconds(static_cast<double>(t) * problem.step_s);
    poses.push_back(models::at(trajectory, problem.start_time + passed).world_from_body);
  }
  Candidate candidate = CandidateMaker(seen, {}).make({}, std::move(poses));
  candidate.energy_cost = energy_cost;
  return candidate;
}

// Long function: one loop over the leaves compares each leaf with all selected leaves.
std::vector<Candidate> candidate_trajectories(const SearchProblem& problem,
                                              const EnergyModel& energy,
                                              ReducedValueIteration& search,
                                              const CandidateOptions& options,
                                              const Deadline& deadline) {
  require(std::isfinite(options.epsilon) && std::isfinite(options.delta_m),
          "candidates: epsilon and delta_m must be finite");
  ReducedOptions pass;
  pass.search = options.is_anytime ? ReducedSearch::kAnytime : ReducedSearch::kSinglePass;
  pass.epsilon = options.epsilon;
  pass.delta_m = options.delta_m;
  pass.yaw_weight_m_per_rad = options.yaw_weight_m_per_rad;
  pass.keeps_leaves = true;
  search.plan(problem, pass, deadline);

  MotionTable motion(static_cast<int>(problem.controls.size()), problem.horizon_steps,
                     static_cast<int>(problem.teammates.size()));
  motion.reset(problem);
  const Tree& tree = search.tree();
  std::vector<Leaf> leaves;
  for (NodeId id = 0; id < static_cast<NodeId>(tree.node_count()); ++id) {
    const Node& node = tree[id];
    if (node.depth == problem.horizon_steps &&
        motion.can_stop(node.world_from_body, node.control, node.depth)) {
      leaves.push_back(
          {options.is_anytime ? 0.5 * node.cost + energy_of(tree, id, problem, energy) : node.cost,
           id});
    }
  }
  std::stable_sort(leaves.begin(), leaves.end(),
                   [](const Leaf& a, const Leaf& b) { return a.order < b.order; });
  leaves.resize(std::min(leaves.size(), options.leaves_max));

  CandidateMaker maker(problem, energy);
  const PoseMetric metric{options.yaw_weight_m_per_rad};
  CrossingIndex index(leaves.size());
  index.reset(options.delta_m);
  std::vector<Candidate> candidates;
  std::vector<LastBlocks> blocks;  // by candidate: covariances at the end
  std::vector<NodeId> places;      // per candidate: its leaf in the tree
  for (const auto& [order, leaf] : leaves) {
    if (candidates.size() == options.candidates_max) {
      break;
    }
    const Node& last = tree[leaf];
    std::vector<int> controls(last.depth);
    std::vector<Pose2> poses(last.depth);
    for (NodeId id = leaf; tree[id].parent != kNoNode; id = tree[id].parent) {
      controls[tree[id].depth - 1U] = tree[id].control;
      poses[tree[id].depth - 1U] = tree[id].world_from_body;
    }
    Candidate candidate = maker.make(std::move(controls), std::move(poses));
    LastBlocks own = maker.follow(candidate);
    bool is_redundant = false;
    index.near(last.world_from_body, [&](std::uint32_t kept) {
      is_redundant =
          metric.crosses(candidates[kept].poses.back(), last.world_from_body, options.delta_m) &&
          maker.is_redundant(own, options.epsilon, blocks[kept]);
      return !is_redundant;
    });
    if (!is_redundant) {
      index.insert(last.world_from_body, static_cast<std::uint32_t>(candidates.size()));
      candidates.push_back(std::move(candidate));
      blocks.push_back(std::move(own));
      places.push_back(leaf);
    }
  }
  return ordered_by(places, std::move(candidates));
}

}  // namespace vantage::planner
