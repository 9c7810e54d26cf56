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

/// What became of a proposal that was heard.
enum class Heard {
  kTaken,       ///< it is the best known now
  kNotBetter,   ///< than what is known
  kOtherRound,  ///< it is of another round
  kRefused,     ///< it cannot be
};

/// One robot's round of local search on what it believes: makes its candidates, sees teammates'
/// motions through their sensors, keeps proposed motions apart. It is there from the round's begin
/// to its end, and nothing is heard or proposed without it.
class TeamExchange {
 public:
  /// What a round begins with, besides the problem.
  struct Start {
    std::int64_t round = 0;
    /// Stopping and hovering: a candidate too, for it may see something.
    models::Trajectory rest;
    std::vector<std::string> jammed;  ///< robots that see nothing
    /// As SessionSetup's.
    std::optional<std::vector<models::TeamChoice>> committed;
  };
  /// Candidates are what the search finds by `deadline` and the closing check lets pass. Teammates
  /// of `problem` are kept clear of; what they see, if anything, guides the search.
  /// `scenario` and the world of `problem` must outlive it; `search` serves others from then on.
  TeamExchange(const scenario::Scenario& scenario, int robot, ReducedValueIteration& search,
               const SearchProblem& problem, const Start& start, const Deadline& deadline);
  ~TeamExchange() = default;
  TeamExchange(const TeamExchange&) = delete;  // its session refers to it
  TeamExchange& operator=(const TeamExchange&) = delete;
  TeamExchange(TeamExchange&&) = delete;
  TeamExchange& operator=(TeamExchange&&) = delete;

  /// As LocalSearchSession's.
  [[nodiscard]] Heard hear(const models::TeamProposal& proposal);
  [[nodiscard]] std::optional<models::TeamProposal> improve(const Deadline& deadline);

  /// Of the search for the candidates: the node budget that repeats it.
  [[nodiscard]] std::int64_t nodes() const { return nodes_; }

 private:
  std::vector<Candidate> candidates_by(ReducedValueIteration& search, const Deadline& deadline);
  [[nodiscard]] SessionSetup setup_of(const Start& start, std::vector<Candidate> found) const;
  [[nodiscard]] Candidate effect_of(const models::TeamChoice& choice) const;
  [[nodiscard]] bool is_jammed(const std::string& robot) const;

  const std::vector<scenario::RobotSpec>& robots_;
  const scenario::PlannerSpec& planner_;
  int robot_;  ///< index into robots_
  SearchProblem problem_;
  TeamProblem beliefs_;  ///< without candidates
  std::vector<std::string> jammed_;
  std::int64_t nodes_ = 0;
  LocalSearchSession session_;
};

}  // namespace vantage::planner
