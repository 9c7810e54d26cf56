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

/// Input of one robot to a round of local search by messages.
struct SessionSetup {
  std::vector<std::string> robots;  ///< the whole team, in the same order on every robot
  int robot = 0;                    ///< index of this robot
  std::int64_t round = 0;
  Time activation{};
  TeamProblem problem;  ///< problem with this robot's beliefs and only its candidates, if any
  std::vector<models::TeamChoice> own;  ///< motions of the candidates, in the same order
  /// Returns a teammate's choice as a candidate, evaluated on this robot's beliefs.
  std::function<Candidate(const models::TeamChoice&)> candidate_of;
  /// True if both motions may be flown at the same time; empty: always true.
  std::function<bool(const models::TeamChoice&, const models::TeamChoice&)> keep_apart;
  /// Choices to which teammates are committed, if any. The search then starts from them instead of
  /// the empty solution, and values count only what is added to them.
  std::optional<std::vector<models::TeamChoice>> committed = std::nullopt;
};

/// One robot's part in a round of distributed local search by messages that may be lost, delayed,
/// duplicated or reordered. Every message is a complete solution with its value. A robot keeps the
/// best solution that it has received or found: the one with the greater value; of equal values,
/// the one from the proposer of lower index, then with the lower fingerprint (the shared tie rule).
/// It searches for a local operation on that solution with its own candidates and proposes the
/// result. This selection is idempotent and independent of the order of messages: robots that
/// received the same messages have the same solution, and a later message compensates for a lost
/// one.
///
/// The value of a proposal is the value of its base solution plus the increase computed from the
/// proposer's beliefs, at least kLeastRise_nats. Values therefore increase along every chain of
/// proposals even if beliefs differ. No proposal returns to a solution in its own history, so the
/// search cannot cycle. With equal beliefs and no lost messages it ends in a local optimum (up to
/// kLeastRise_nats) of the neighbourhood of distributed_local_search, restricted to one round. The
/// search starts from the empty solution. It uses best additions while the robot has no candidate
/// in the solution, then the first deletion, addition or swap that improves.
///
/// Reads no clock; the caller limits the work. A proposal depends only on the setup and its base
/// solution, not on the time of reception.
/// Source: dissertation Alg. 7, 8; docs/decisions/0006.
class LocalSearchSession {
 public:
  static constexpr double kLeastRise_nats = 1e-6;
  static constexpr std::size_t kHistoryMax = 256;

  /// Writes the individual information gain of each own candidate into its choice.
  /// @throws UsageError as TeamOracle does, when the numbers of candidates and choices differ, or
  /// when a committed choice belongs to this robot or to an unknown robot
  explicit LocalSearchSession(SessionSetup setup);
  ~LocalSearchSession() = default;
  // not copyable, because members refer to setup_
  LocalSearchSession(const LocalSearchSession&) = delete;
  LocalSearchSession& operator=(const LocalSearchSession&) = delete;
  LocalSearchSession(LocalSearchSession&&) = delete;
  LocalSearchSession& operator=(LocalSearchSession&&) = delete;

  /// Adopts a proposal of a teammate (or an earlier one of this robot) if it is better than the
  /// best known one; returns true if it was adopted. Rejects a proposal of another round, with
  /// unknown robots, or with a history that does not end in its own solution. Also rejects a
  /// proposal that assigns this robot a motion that this robot does not have (after a restart).
  bool receive(const models::TeamProposal& received);

  /// True if the proposal belongs to this round.
  [[nodiscard]] bool belongs_to_round(const models::TeamProposal& received) const;
  /// True if the content of the proposal is consistent.
  [[nodiscard]] bool is_consistent(const models::TeamProposal& received) const;

  /// Returns the next proposal, which becomes the best known one. Returns nullopt if none exists,
  /// or if none was found yet (then is_searching() is true). `deadline` counts this call's oracle
  /// calls as nodes and is checked after each. Sets robot, round, time, value, choices and history.
  std::optional<models::TeamProposal> improve(const Deadline& deadline);

  [[nodiscard]] bool is_searching() const { return phase_ != Phase::kDone; }
  /// Returns the best known solution, or the committed choices; nullopt for the empty solution.
  [[nodiscard]] const std::optional<models::TeamProposal>& held() const { return held_; }
  /// Returns the oracle calls so far, excluding those for single candidates.
  [[nodiscard]] std::int64_t calls() const { return calls_; }

 private:
  enum class Phase { kAdding, kSearching, kDone };

  /// Starts a search around the best known solution.
  void begin();
  void begin_from_committed(const std::vector<models::TeamChoice>& committed);
  std::optional<models::TeamProposal> try_proposal(const Proposal& found);
  [[nodiscard]] bool is_compatible(const models::TeamProposal& solution) const;
  [[nodiscard]] int index_of(const std::string& robot) const;
  [[nodiscard]] models::TeamProposal solution_of(const Choice& choice) const;
  const Candidate& teammate_candidate(const models::TeamChoice& choice);

  SessionSetup setup_;
  std::map<std::int64_t, std::size_t> own_;                    ///< candidate index by fingerprint
  using ChoiceKey = std::tuple<std::int64_t, double, double>;  ///< fingerprint, information, energy
  std::map<ChoiceKey, Candidate> teammate_candidates_;         ///< candidates of teammates' choices
  std::optional<models::TeamProposal> held_;
  Phase phase_ = Phase::kDone;
  std::int64_t calls_ = 0;

  // State of the search around the best known solution; each member refers to those before it.
  std::unique_ptr<TeamOracle> oracle_;
  std::unique_ptr<ImprovementRule> rule_;
  std::unique_ptr<TeamSet> team_;
  std::unique_ptr<BestAddition> addition_;
  std::unique_ptr<ProposalSearch> search_;
  std::vector<char> excluded_;
};

/// Returns a 64-bit hash of a robot's motion, or of a solution's motions in the order of `robots`.
/// Equal bits give equal hashes on all machines with the same byte order.
std::int64_t fingerprint(const models::TeamChoice& choice);
std::int64_t fingerprint(const std::vector<std::string>& robots,
                         const std::vector<models::TeamChoice>& choices);

/// Returns the information that `candidate` alone gives about the targets of `problem`, nats.
double information_alone(const TeamProblem& problem, const Candidate& candidate);

}  // namespace vantage::planner
