#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "planner/search/belief_table.hpp"
#include "planner/search/log_product.hpp"
#include "planner/team/decision/candidate.hpp"

namespace vantage::planner {

/// How the information that a team's looks give is measured. Both are 0 without a look, never
/// fall when a trajectory is added, and are in nats.
enum class InformationMeasure {
  /// I(y_{1:T}; z_{1:T}) = ½ Σ_t (log det Σᵖ_t − log det Σ_t), Σᵖ_t predicted with all looks
  /// before t. Submodular: every guarantee of this room is for it.
  kMutual,
  /// ½ Σ_t (log det Σ⁰_t − log det Σ_t), Σ⁰_t without any look: the sum of I(y_t; z_{1:t}). What
  /// single-robot searches maximise. Not submodular when targets move.
  kLogDet,
};

/// Index of a candidate among all of the team's, robot after robot.
using CandidateId = std::int32_t;
inline constexpr CandidateId kNoCandidate = -1;

/// S: the candidate of each robot, or kNoCandidate. At most one a robot (a partition matroid).
using Choice = std::vector<CandidateId>;

/// Choose at most one candidate for each robot such that J(S) = I(S) − C(S) is largest.
/// Source: dissertation Problem 4 (eq. 3.13).
struct TeamProblem {
  std::vector<SearchTarget> targets;  ///< in the order that the looks count them
  int horizon_steps = 10;
  double step_s = 0.5;
  InformationMeasure measure = InformationMeasure::kMutual;
  std::vector<std::vector<Candidate>> candidates;  ///< [robot]
};

/// What does not depend on S: candidates by number, the targets' motion, the value of each
/// candidate alone. Sets are valued by TeamSet.
class TeamOracle {
 public:
  /// Values every candidate alone: candidate_count() oracle calls. `problem` must outlive this.
  /// @throws UsageError when a look is out of range or order, or a cost is negative
  explicit TeamOracle(const TeamProblem& problem);

  [[nodiscard]] int robot_count() const { return static_cast<int>(problem_->candidates.size()); }
  /// N, of the whole team.
  [[nodiscard]] CandidateId candidate_count() const { return begin_.back(); }
  /// The candidates of a robot are begin(robot) … end(robot) − 1.
  [[nodiscard]] CandidateId begin(int robot) const { return begin_[index(robot)]; }
  [[nodiscard]] CandidateId end(int robot) const { return begin_[index(robot) + 1]; }
  [[nodiscard]] int robot_of(CandidateId id) const { return robot_of_[index(id)]; }
  [[nodiscard]] const Candidate& candidate(CandidateId id) const { return *candidates_[index(id)]; }

  /// J({id}), nats; J(∅) = 0.
  [[nodiscard]] double alone(CandidateId id) const { return alone_[index(id)]; }
  /// The robot's candidates from the best alone to the worst, equals by number.
  [[nodiscard]] std::span<const CandidateId> by_value(int robot) const;
  /// O = Σ_i max_a r_i C_i(a), so that g = J + O ≥ 0 everywhere.
  [[nodiscard]] double offset() const { return offset_; }
  [[nodiscard]] bool is_submodular() const {
    return problem_->measure == InformationMeasure::kMutual;
  }
  [[nodiscard]] const TeamProblem& problem() const { return *problem_; }
  [[nodiscard]] int target_count() const { return beliefs_.target_count(); }

  /// One target's belief after a step, and what was gained of it until then.
  struct Course {
    double block[kMaxPacked] = {};
    LogProduct gained;  ///< of e^{2 · nats}
    bool is_seen = false;
  };
  /// One robot's looks at one target, by step.
  using Looks = std::span<const Look>;

  /// The course before the first step.
  [[nodiscard]] Course start_of(int target) const;
  /// Carries `course` from step `from` through the looks of several robots, added up in the order
  /// given; returns the nats gained by the end. Where `kept` is not null the course after each
  /// step t > from is written to kept[t]. A pure function of the looks, to the bit, whatever
  /// `from` it is taken up at: that is why no search of this room can go in circles.
  /// The spans of `looks` are used up.
  double follow(int target, int from, Course course, std::span<Looks> looks, Course* kept) const;

 private:
  template <class Integer>
  [[nodiscard]] static std::size_t index(Integer i) {
    return static_cast<std::size_t>(i);
  }
  void check() const;

  const TeamProblem* problem_;
  BeliefTable beliefs_;
  std::vector<CandidateId> begin_;  ///< per robot, and the end
  std::vector<int> robot_of_;
  std::vector<const Candidate*> candidates_;
  std::vector<double> alone_;
  std::vector<CandidateId> by_value_;
  double offset_ = 0.0;
};

}  // namespace vantage::planner
