#include "planner/decision/decision.hpp"

#include <cmath>
#include <tuple>

#include "core/check.hpp"
#include "core/index.hpp"

namespace vantage::planner {

ImprovementRule::ImprovementRule(const TeamOracle& oracle, double alpha, double least_rise)
    : factor_(1.0 + alpha / std::pow(std::max(1, oracle.candidate_count()), 4)),
      offset_(oracle.offset()),
      least_rise_(least_rise) {
  require(alpha > 0.0 && std::isfinite(alpha), "local search: alpha must be > 0");
  require(least_rise >= 0.0 && std::isfinite(least_rise), "local search: least_rise must be ≥ 0");
}

bool is_preferred(const Proposal& a, const Proposal& b) {
  // As an unsigned number, −1 ("none") is the largest and therefore last.
  const auto order = [](const Proposal& p) {
    return std::tuple(-p.value, static_cast<std::uint32_t>(p.add),
                      static_cast<std::uint32_t>(p.drop_robot));
  };
  return order(a) < order(b);
}

Choice adopt(const TeamOracle& oracle, Choice choice, const Proposal& proposal) {
  if (proposal.drop_robot >= 0) {
    choice[index(proposal.drop_robot)] = kNoCandidate;
  }
  if (proposal.add != kNoCandidate) {
    choice[index(oracle.robot_of(proposal.add))] = proposal.add;
  }
  return choice;
}

}  // namespace vantage::planner
