#include "planner/decision/proposal_search.hpp"

#include <algorithm>
#include <numeric>

#include "core/index.hpp"

namespace vantage::planner {

ProposalSearch::ProposalSearch(const TeamOracle& oracle, const ImprovementRule& rule, int robot,
                               bool lazy)
    : oracle_(&oracle), rule_(&rule), robot_(robot), lazy_(lazy), team_(oracle) {
  const auto sorted = oracle.by_value(robot);
  order_.assign(sorted.begin(), sorted.end());
  if (!lazy) {
    std::iota(order_.begin(), order_.end(), oracle.begin(robot));
  }
}

void ProposalSearch::begin(const Choice& choice, double value, std::span<const char> excluded) {
  choice_ = choice;
  value_ = value;
  excluded_ = excluded;
  team_.become(choice);
  turn_ = 0;
  is_adding_ = false;
  proposal_ = {};
}

ProposalSearch::State ProposalSearch::propose(CandidateId add, double value) {
  proposal_ = {drop_robot_, add, value};
  return State::kProposes;
}

bool ProposalSearch::turn_to_next_deletion() {
  const int robots = oracle_->robot_count();
  while (turn_ <= robots) {
    const int turn = turn_++;
    if (turn == 0) {
      if (chosen_by(robot_) == kNoCandidate) {
        drop_robot_ = -1;
        return true;
      }
      continue;
    }
    // Tries to delete this robot's trajectory first, then those of the others in ascending order.
    drop_robot_ = turn == 1 ? robot_ : turn - 2 < robot_ ? turn - 2 : turn - 1;
    if (chosen_by(drop_robot_) != kNoCandidate) {
      return true;
    }
  }
  return false;
}

void ProposalSearch::end_additions() {
  is_adding_ = false;
  if (drop_robot_ >= 0) {
    team_.add(chosen_by(drop_robot_));
  }
}

ProposalSearch::State ProposalSearch::advance() {
  for (;;) {
    if (!is_adding_) {
      if (!turn_to_next_deletion()) {
        return State::kNothing;
      }
      const bool is_deletion = drop_robot_ >= 0;
      const double without = is_deletion ? team_.value_without(drop_robot_) : value_;
      if (is_deletion && rule_->improves(value_, without)) {
        return propose(kNoCandidate, without);
      }
      if (drop_robot_ == robot_ || chosen_by(robot_) == kNoCandidate) {
        is_adding_ = true;
        next_addition_ = 0;
        needed_ = rule_->least(value_) - without;
        if (is_deletion) {
          team_.drop(drop_robot_);
        }
      }
      if (is_deletion) {
        return State::kSearching;
      }
    }
    while (next_addition_ < order_.size()) {
      const CandidateId id = order_[next_addition_++];
      if (lazy_ && oracle_->individual_value(id) < needed_ - kGainRounding_nats) {
        break;
      }
      if (excluded_[index(id)] != 0 || id == chosen_by(robot_)) {
        continue;
      }
      const double value = team_.value_with(id);
      if (rule_->improves(value_, value)) {
        return propose(id, value);
      }
      return State::kSearching;
    }
    end_additions();
  }
}

}  // namespace vantage::planner
