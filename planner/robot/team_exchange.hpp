#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/deadline.hpp"
#include "models/exchange/messages.hpp"
#include "planner/decision/local_search_session.hpp"
#include "planner/search/arvi.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// One robot's rounds of local search on what it believes: makes its candidates, sees teammates'
/// motions through their sensors, keeps proposed motions apart.
class TeamExchange {
 public:
  /// `scenario` and `search` must outlive it; the search may serve others between the rounds.
  TeamExchange(const scenario::Scenario& scenario, int robot, ReducedValueIteration& search);
  ~TeamExchange() = default;
  TeamExchange(const TeamExchange&) = delete;  // a round refers to its exchange
  TeamExchange& operator=(const TeamExchange&) = delete;
  TeamExchange(TeamExchange&&) = delete;
  TeamExchange& operator=(TeamExchange&&) = delete;

  /// What a round begins with, besides the problem.
  struct Start {
    std::int64_t round = 0;
    /// Stopping and hovering: a candidate too, for it may see something.
    models::Trajectory rest;
    std::vector<std::string> jammed;  ///< robots that see nothing
    /// The closing check of a motion of this robot.
    std::function<bool(const models::Trajectory&)> is_safe;
  };
  /// Ends the last round and begins one (the world of `problem` must live as long as it does):
  /// candidates are what the search finds by `deadline` and is_safe lets pass. Teammates of
  /// `problem` are kept clear of; what they see, if anything, guides the search.
  void begin(const SearchProblem& problem, const Start& start, const Deadline& deadline);
  /// Ends the round: nothing is heard or proposed until the next begins.
  void end() { session_.reset(); }

  /// As LocalSearchSession's; nothing happens where no round is on.
  bool hear(const models::TeamProposal& proposal);
  std::optional<models::TeamProposal> improve(const Deadline& deadline);

  /// Coordinate descent: the candidate that adds most beside what the others are committed to;
  /// nullopt when each would take away. Ends the round.
  std::optional<models::TeamChoice> best_beside(const std::vector<models::TeamChoice>& others);

  /// Proposals of a round that was on which cannot be, since construction.
  [[nodiscard]] std::int64_t refused() const { return refused_; }
  /// Of the search for the candidates: the node budget that repeats it.
  [[nodiscard]] std::int64_t nodes() const { return nodes_; }

 private:
  [[nodiscard]] Candidate effect_of(const models::TeamChoice& choice) const;
  /// The distance that two motions have to keep.
  [[nodiscard]] double kept_m(const models::Trajectory& a, const models::Trajectory& b) const;
  [[nodiscard]] bool is_jammed(const std::string& robot) const;

  const std::vector<scenario::RobotSpec>& robots_;
  const scenario::PlannerSpec& planner_;
  int robot_;  ///< index into robots_
  ReducedValueIteration& search_;
  SearchProblem problem_;
  TeamProblem beliefs_;  ///< without candidates
  std::vector<std::string> jammed_;
  std::int64_t round_ = 0;
  std::int64_t nodes_ = 0;
  std::int64_t refused_ = 0;
  std::optional<LocalSearchSession> session_;
};

}  // namespace vantage::planner
