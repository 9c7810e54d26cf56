#include "planner/search/catalogue.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "core/check.hpp"
#include "models/sensor/law.hpp"
#include "models/target/law.hpp"
#include "planner/search/astar.hpp"
#include "planner/search/beam.hpp"
#include "planner/search/sampling_tree.hpp"
#include "scenario/search_name.hpp"

namespace vantage::planner {
namespace {

template <class Planner, class Options>
class Adapter final : public Search {
 public:
  Adapter(const SearchCapacity& capacity, const Options& options)
      : search_(capacity), options_(options) {}
  const SearchResult& plan(const SearchProblem& problem, const Deadline& deadline) override {
    const SearchResult& result = search_.plan(problem, options_, deadline);
    peak_bytes_ = result.peak_bytes;
    return result;
  }
  void prefault() override {
    if constexpr (requires { search_.prefault(); }) {
      search_.prefault();
    }
  }
  [[nodiscard]] std::size_t peak_bytes() const override { return peak_bytes_; }

 private:
  Planner search_;
  Options options_;
  std::size_t peak_bytes_ = 0;
};

using BeamAdapter = Adapter<RefiningBeam, BeamOptions>;
using RandomWalkAdapter = Adapter<RandomWalk, RandomWalkOptions>;
using LawnMowerAdapter = Adapter<LawnMower, SweepShare>;

/// Makes an algorithm with the options ε and δ; `tell` sets its other options.
template <class Planner, class Options>
Algorithm with_bounds(std::string_view name, std::string_view what, bool makes_candidates,
                      const Options& own, void (*tell)(const AlgorithmOptions&, Options&)) {
  return {name,
          what,
          1.0,
          false,
          makes_candidates,
          [own, tell](const SearchCapacity& capacity, const AlgorithmOptions& asked) {
            Options options = own;
            options.epsilon = asked.epsilon;
            options.delta_m = asked.delta_m;
            tell(asked, options);
            return std::make_unique<Adapter<Planner, Options>>(capacity, options);
          }};
}

Algorithm best_first(std::string_view name, std::string_view what, BestFirst kind) {
  BestFirstOptions own;
  own.search = kind;
  return with_bounds<BestFirstSearch, BestFirstOptions>(
      name, what, false, own, [](const AlgorithmOptions& asked, BestFirstOptions& options) {
        options.weight = asked.weight;
        options.yaw_weight_m_per_rad = asked.yaw_weight_m_per_rad;
      });
}

Algorithm reduced(std::string_view name, std::string_view what, ReducedSearch kind) {
  const bool makes_candidates =
      kind == ReducedSearch::kAnytime || kind == ReducedSearch::kSinglePass;
  ReducedOptions own;
  own.search = kind;
  return with_bounds<ReducedValueIteration, ReducedOptions>(
      name, what, makes_candidates, own,
      [](const AlgorithmOptions& asked, ReducedOptions& options) {
        options.yaw_weight_m_per_rad = asked.yaw_weight_m_per_rad;
      });
}

// Long function: it contains a table with one entry per search.
std::vector<Algorithm>& algorithms() {
  static std::vector<Algorithm> all = {
      {"beam", "anytime beam search: each pass is wider and has smaller diversity cells", 0.25,
       false, false,
       [](const SearchCapacity& capacity, const AlgorithmOptions&) {
         return std::make_unique<BeamAdapter>(capacity, BeamOptions{});
       }},
      reduced("arvi", "anytime reduced value iteration: passes with decreasing (epsilon, delta)",
              ReducedSearch::kAnytime),
      reduced("rvi", "reduced value iteration: one pass with fixed (epsilon, delta)",
              ReducedSearch::kSinglePass),
      reduced("fvi", "forward value iteration: complete search without pruning",
              ReducedSearch::kExhaustive),
      best_first("astar", "A*: the plan is proven optimal if the search completes",
                 BestFirst::kAStar),
      best_first("wastar", "weighted A*: faster than A*; --weight bounds the loss of optimality",
                 BestFirst::kWeightedAStar),
      best_first("aegis", "AEGIS: A* without the nodes that are (epsilon, delta)-dominated",
                 BestFirst::kAegis),
      reduced("greedy", "picks the best next step, once per step of the horizon",
              ReducedSearch::kGreedy),
      with_bounds<SamplingTree, SamplingTreeOptions>(
          "sampling_tree", "grows random branches; converges to the optimum over the controls",
          false, SamplingTreeOptions{},
          [](const AlgorithmOptions& asked, SamplingTreeOptions& options) {
            options.yaw_weight_m_per_rad = asked.yaw_weight_m_per_rad;
          }),
      {"random_walk", "a random safe path, determined by the problem's seed", 1.0, false, false,
       [](const SearchCapacity& capacity, const AlgorithmOptions&) {
         return std::make_unique<RandomWalkAdapter>(capacity, RandomWalkOptions{});
       }},
      {"lawn_mower", "sweeps the robot's strip of the world in rows, independent of beliefs", 1.0,
       true, false,
       [](const SearchCapacity& capacity, const AlgorithmOptions& options) {
         return std::make_unique<LawnMowerAdapter>(capacity, options.sweep);
       }},
  };
  return all;
}

}  // namespace

const std::vector<Algorithm>& all_algorithms() { return algorithms(); }

void add_algorithm(Algorithm algorithm) {
  scenario::add_search_name(std::string(algorithm.name));
  algorithms().push_back(std::move(algorithm));
}

const Algorithm& algorithm_called(std::string_view name) {
  const auto& all = all_algorithms();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Algorithm& a) { return a.name == name; });
  if (found == all.end()) {
    std::string names;
    for (const Algorithm& each : all) {
      names.append(names.empty() ? "" : ", ").append(each.name);
    }
    throw UsageError("algorithm: must be one of " + names + ", got " + std::string(name));
  }
  return *found;
}

std::string_view default_algorithm(const SearchProblem& problem) {
  const auto stands_still = [](const SearchTarget& target) {
    return target.model.kind.law().is_constant;
  };
  const auto only_ranges = [](const models::SensorModel& sensor) {
    const models::SensorLaw& law = sensor.kind.law();
    return law.measures_range && !law.measures_bearing;
  };
  const bool is_mapping =
      std::all_of(problem.targets.begin(), problem.targets.end(), stands_still) &&
      std::all_of(problem.sensors.begin(), problem.sensors.end(), only_ranges);
  return is_mapping ? "astar" : "beam";
}

SearchCapacity capacity_for(const Algorithm& algorithm, const SearchProblem& problem,
                            std::size_t memory_bytes, std::size_t nodes_max) {
  // Bytes of a node with its record and its entries in lists, index or cells, plus its share of the
  // blocks, which only expanded nodes have.
  constexpr std::size_t kNodeBytes = 48 + 12 + 200;
  constexpr std::size_t kBlockDoubleBytes = 9;
  constexpr std::size_t kDoublesPerNode = 12;
  constexpr std::size_t kLeastNodes = 20'000;
  SearchCapacity capacity;
  const std::size_t affordable = memory_bytes / (kNodeBytes + kDoublesPerNode * kBlockDoubleBytes);
  const auto kept = static_cast<std::size_t>(algorithm.kept_share * static_cast<double>(nodes_max));
  capacity.nodes_max = std::clamp(kept, kLeastNodes, std::max(kLeastNodes, affordable));
  capacity.block_doubles_max =
      std::max(kDoublesPerNode * capacity.nodes_max,
               40 * problem.targets.size() * static_cast<std::size_t>(problem.horizon_steps + 1));
  capacity.targets_max = static_cast<int>(problem.targets.size());
  capacity.horizon_max = problem.horizon_steps;
  capacity.teammates_max = static_cast<int>(problem.teammates.size());
  return capacity;
}

std::size_t nodes_within(double budget_s) {
  constexpr double kNodesPerSecondMax = 60e6;
  constexpr double kMost = 4e9;  // handles have 32 bits
  return static_cast<std::size_t>(std::min(kMost, kNodesPerSecondMax * budget_s));
}

}  // namespace vantage::planner
