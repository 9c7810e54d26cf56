#include "planner/decision/best_addition.hpp"

#include <algorithm>

#include "core/index.hpp"

namespace vantage::planner {
namespace {

bool is_excluded(std::span<const char> excluded, CandidateId id) {
  return !excluded.empty() && excluded[index(id)] != 0;
}

bool is_better(const Proposal& a, const Proposal& b) {
  return b.is_nothing() || is_preferred(a, b);
}

}  // namespace

BestAddition::BestAddition(const TeamOracle& oracle, int robot, bool lazy)
    : oracle_(&oracle), robot_(robot), lazy_(lazy) {
  for (const CandidateId id : oracle.by_value(robot)) {  // descending values already form a heap
    heap_.push_back({oracle.individual_value(id), id});
  }
}

Proposal BestAddition::find_among_all(TeamSet& team, std::span<const char> excluded) const {
  Proposal best;
  for (CandidateId id = oracle_->begin(robot_); id < oracle_->end(robot_); ++id) {
    if (is_excluded(excluded, id)) {
      continue;
    }
    const Proposal own{-1, id, team.value_with(id)};
    best = is_better(own, best) ? own : best;
  }
  return best;
}

Proposal BestAddition::find(TeamSet& team, std::span<const char> excluded) {
  if (!lazy_) {
    return find_among_all(team, excluded);
  }
  Proposal best;
  std::vector<Bound> asked;
  while (!heap_.empty() && (best.is_nothing() ||
                            heap_.front().gain >= best.value - team.value() - kGainRounding_nats)) {
    std::pop_heap(heap_.begin(), heap_.end());
    Bound top = heap_.back();
    heap_.pop_back();
    if (is_excluded(excluded, top.id)) {
      continue;
    }
    const Proposal own{-1, top.id, team.value_with(top.id)};
    top.gain = std::min(top.gain, own.value - team.value());
    asked.push_back(top);
    best = is_better(own, best) ? own : best;
  }
  for (const Bound& bound : asked) {
    heap_.push_back(bound);
    std::push_heap(heap_.begin(), heap_.end());
  }
  return best;
}

}  // namespace vantage::planner
