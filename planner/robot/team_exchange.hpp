#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/deadline.hpp"
#include "models/exchange/messages.hpp"
#include "planner/decision/local_search_session.hpp"
#include "planner/search/arvi.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// Outcome of a received proposal.
enum class ReceiveOutcome {
  kTaken,       ///< adopted: it is now the best known proposal
  kNotBetter,   ///< not better than the best known proposal
  kOtherRound,  ///< belongs to another round
  kRefused,     ///< inconsistent or too long
};

/// One robot's round of local search on its own beliefs: makes its candidates, evaluates teammates'
/// motions with their sensors, and rejects proposed motions that come too close. It exists from the
/// start to the end of the round; outside this time no proposal is made or accepted.
class TeamExchange {
 public:
  /// Inputs of a round in addition to the problem.
  struct Start {
    std::int64_t round = 0;
    /// The motion that stops and hovers. It is also a candidate, because it may gain information.
    models::Trajectory rest;
    std::vector<std::string> jammed;  ///< robots without sensing
    /// Choices to which teammates are committed, as in SessionSetup.
    std::optional<std::vector<models::TeamChoice>> committed;
  };
  /// Candidates are the search results found by `deadline` that pass the closing check. They avoid
  /// the teammates of `problem`. The fixed information of `problem`, if any, guides the search.
  /// `scenario` and the world of `problem` must outlive this object; other objects may use `search`
  /// after construction.
  TeamExchange(const scenario::Scenario& scenario, int robot, ReducedValueIteration& search,
               const SearchProblem& problem, const Start& start, const Deadline& deadline);
  ~TeamExchange() = default;
  TeamExchange(const TeamExchange&) = delete;  // session_ refers to this object
  TeamExchange& operator=(const TeamExchange&) = delete;
  TeamExchange(TeamExchange&&) = delete;
  TeamExchange& operator=(TeamExchange&&) = delete;

  /// The following functions are described in LocalSearchSession.
  [[nodiscard]] ReceiveOutcome receive(const models::TeamProposal& proposal);
  [[nodiscard]] std::optional<models::TeamProposal> improve(const Deadline& deadline);

  /// Returns the node budget that reproduces the candidate search.
  [[nodiscard]] std::int64_t nodes() const { return nodes_; }

 private:
  std::vector<Candidate> candidates_by(ReducedValueIteration& search, const Deadline& deadline);
  [[nodiscard]] SessionSetup setup_of(const Start& start, std::vector<Candidate> found) const;
  [[nodiscard]] Candidate candidate_of(const models::TeamChoice& choice) const;
  [[nodiscard]] bool is_jammed(const std::string& robot) const;

  const std::vector<scenario::RobotSpec>& robots_;
  const scenario::PlannerSpec& planner_;
  int robot_;  ///< index into robots_
  SearchProblem problem_;
  TeamProblem beliefs_;  ///< problem of the team, without candidates
  std::vector<std::string> jammed_;
  std::int64_t nodes_ = 0;
  LocalSearchSession session_;
};

}  // namespace vantage::planner
