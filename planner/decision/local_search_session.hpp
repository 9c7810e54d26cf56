#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "core/deadline.hpp"
#include "models/exchange/messages.hpp"
#include "planner/decision/best_addition.hpp"
#include "planner/decision/proposal_search.hpp"

namespace vantage::planner {

/// What one robot brings to a round of local search by messages.
struct SessionSetup {
  std::vector<std::string> robots;  ///< the whole team, in the same order everywhere
  int robot = 0;                    ///< this one
  std::int64_t round = 0;
  Time activation{};
  TeamProblem problem;                  ///< its beliefs; of candidates its own alone, or nobody's
  std::vector<models::TeamChoice> own;  ///< the motion of each of its candidates, in their order
  /// What a teammate's choice is, as far as this robot's beliefs go.
  std::function<Candidate(const models::TeamChoice&)> effect_of;
  /// Whether both motions may be flown at once; empty: always.
  std::function<bool(const models::TeamChoice&, const models::TeamChoice&)> keep_apart;
  /// What teammates do anyway, if anything: then the search begins beside it, not from nothing, and
  /// values count what is added to it.
  std::optional<std::vector<models::TeamChoice>> committed = std::nullopt;
};

/// One robot's part in a round of distributed local search by messages that may be lost, late,
/// doubled or overtaken. Every message is a whole solution with the value it has reached; a robot
/// holds the best that it has heard or found (greater value, then the earlier proposer, then the
/// lower fingerprint: the tie rule that all share), searches for a local operation on it with its
/// own candidates, and proposes what it finds. Holding the greatest is idempotent and indifferent
/// to order, so whoever has heard the same holds the same, and a later message mends an earlier
/// loss.
///
/// Values: a proposal states the value of what it improves on plus the rise as its proposer counts
/// it, at least kLeastRise_nats; so values rise along every chain of proposals, whoever believes
/// what. No proposal leads back to a solution of its own history, so none goes in circles even
/// where beliefs differ. With equal beliefs and no loss it ends in a local optimum (to the least
/// rise) of the neighbourhood of distributed_local_search, of one round of it: from nothing, by the
/// best addition while the robot has none, then by the first deletion, addition or swap that
/// improves.
///
/// Pure: knows no clock; the caller says how much work may be done. What is proposed is a function
/// of the setup and of the solution improved on, not of when it was heard.
/// Source: dissertation Alg. 7, 8; docs/decisions/0006.
class LocalSearchSession {
 public:
  static constexpr double kLeastRise_nats = 1e-6;
  static constexpr std::size_t kHistoryMax = 256;

  /// Counts what each own candidate gains alone into its choice.
  /// @throws UsageError as TeamOracle does, when candidates and choices are not as many, or when
  /// something is committed of this robot or of an unknown one
  explicit LocalSearchSession(SessionSetup setup);
  ~LocalSearchSession() = default;
  LocalSearchSession(const LocalSearchSession&) = delete;  // what it holds refers to its setup
  LocalSearchSession& operator=(const LocalSearchSession&) = delete;
  LocalSearchSession(LocalSearchSession&&) = delete;
  LocalSearchSession& operator=(LocalSearchSession&&) = delete;

  /// Takes a teammate's (or a former own) proposal when it is better than what is held; whether it
  /// was. Refused: of another round, with unknown robots, with a motion of this robot that it does
  /// not have (it has started again since), with a history that does not end in it.
  bool hear(const models::TeamProposal& heard);

  /// Whether `heard` is of this round, and whether it can be what it says.
  [[nodiscard]] bool is_of_round(const models::TeamProposal& heard) const;
  [[nodiscard]] bool can_be(const models::TeamProposal& heard) const;

  /// The next proposal, which is held from then on; nullopt when there is none, or none yet: then
  /// is_searching(). `deadline` counts oracle calls of this call as nodes and is asked after each.
  /// Robot, round, time, value, choices and history are set.
  std::optional<models::TeamProposal> improve(const Deadline& deadline);

  [[nodiscard]] bool is_searching() const { return phase_ != Phase::kDone; }
  /// The best solution known, or what is committed; nullopt: nobody does anything.
  [[nodiscard]] const std::optional<models::TeamProposal>& held() const { return held_; }
  /// Oracle calls so far, those that value each candidate alone not counted.
  [[nodiscard]] std::int64_t calls() const { return calls_; }

 private:
  enum class Phase { kAdding, kSearching, kDone };

  /// Begins to search about what is held.
  void begin();
  void begin_beside(const std::vector<models::TeamChoice>& committed);
  std::optional<models::TeamProposal> try_proposal(const Proposal& found);
  [[nodiscard]] bool is_compatible(const models::TeamProposal& solution) const;
  [[nodiscard]] int index_of(const std::string& robot) const;
  [[nodiscard]] models::TeamProposal solution_of(const Choice& choice) const;
  const Candidate& effect(const models::TeamChoice& choice);

  SessionSetup setup_;
  std::map<std::int64_t, std::size_t> own_;               ///< index by fingerprint
  using Said = std::tuple<std::int64_t, double, double>;  ///< fingerprint, information, energy
  std::map<Said, Candidate> effects_;                     ///< of teammates' choices
  std::optional<models::TeamProposal> held_;
  Phase phase_ = Phase::kDone;
  std::int64_t calls_ = 0;

  // Of the search about what is held; each refers to those before it.
  std::unique_ptr<TeamOracle> oracle_;
  std::unique_ptr<ImprovementRule> rule_;
  std::unique_ptr<TeamSet> team_;
  std::unique_ptr<BestAddition> addition_;
  std::unique_ptr<ProposalSearch> search_;
  std::vector<char> excluded_;
};

/// 64 bits that stand for a robot's motion, and for the motions of a solution in the order of
/// `robots`: equal for equal bits, on every machine of one byte order.
std::int64_t fingerprint(const models::TeamChoice& choice);
std::int64_t fingerprint(const std::vector<std::string>& robots,
                         const std::vector<models::TeamChoice>& choices);

/// Information that `candidate` alone gives about the targets of `problem`, nats.
double information_alone(const TeamProblem& problem, const Candidate& candidate);

}  // namespace vantage::planner
