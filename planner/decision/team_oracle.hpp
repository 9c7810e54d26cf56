#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/index.hpp"
#include "planner/decision/candidate.hpp"
#include "planner/decision/target_courses.hpp"

namespace vantage::planner {

/// Index of a candidate among all candidates of the team, sorted by robot.
using CandidateId = std::int32_t;
inline constexpr CandidateId kNoCandidate = -1;

/// The set S: for each robot its candidate or kNoCandidate. At most one candidate per robot (a
/// partition matroid).
using Choice = std::vector<CandidateId>;

/// A team's decision problem: choose at most one candidate per robot such that J(S) = I(S) − C(S)
/// is largest.
/// Source: dissertation Problem 4 (eq. 3.13).
struct TeamProblem {
  std::vector<SearchTarget> targets;  ///< targets, indexed by PredictedMeasurement::target
  int horizon_steps = 10;
  double step_s = 0.5;
  InformationMeasure measure = InformationMeasure::kMutual;
  std::vector<std::vector<Candidate>> candidates;  ///< indexed by [robot]
};

/// The data of a team problem that do not depend on the set S: candidates by id, target motion, and
/// the individual value of each candidate. TeamSet evaluates sets.
class TeamOracle {
 public:
  /// Evaluates every candidate alone, with one oracle call for each that lacks
  /// Candidate::mutual_nats. `problem` must outlive this object.
  /// @throws UsageError when a measurement has an invalid target, step or order, or a cost is
  /// negative
  explicit TeamOracle(const TeamProblem& problem);

  [[nodiscard]] int robot_count() const { return static_cast<int>(problem_->candidates.size()); }
  /// Returns N, the number of candidates of the whole team.
  [[nodiscard]] CandidateId candidate_count() const { return begin_.back(); }
  /// The candidates of a robot are begin(robot) … end(robot) − 1.
  [[nodiscard]] CandidateId begin(int robot) const { return begin_[index(robot)]; }
  [[nodiscard]] CandidateId end(int robot) const { return begin_[index(robot) + 1]; }
  [[nodiscard]] int robot_of(CandidateId id) const { return robot_of_[index(id)]; }
  [[nodiscard]] const Candidate& candidate(CandidateId id) const { return *candidates_[index(id)]; }

  /// Returns J({id}), nats; J(∅) = 0.
  [[nodiscard]] double individual_value(CandidateId id) const {
    return individual_values_[index(id)];
  }
  /// Returns the robot's candidates by descending individual value; equal values by id.
  [[nodiscard]] std::span<const CandidateId> by_value(int robot) const;
  /// Returns O = Σ_i max_a r_i C_i(a), so that g = J + O ≥ 0 everywhere.
  [[nodiscard]] double offset() const { return offset_; }
  [[nodiscard]] bool is_submodular() const {
    return problem_->measure == InformationMeasure::kMutual;
  }
  [[nodiscard]] const TeamProblem& problem() const { return *problem_; }
  [[nodiscard]] int target_count() const { return courses_.beliefs().target_count(); }

  [[nodiscard]] const TargetCourses& courses() const { return courses_; }
  /// Returns the number of oracle calls spent on single candidates.
  [[nodiscard]] std::int64_t calls() const { return calls_; }

 private:
  void check() const;

  const TeamProblem* problem_;
  TargetCourses courses_;
  std::int64_t calls_ = 0;
  std::vector<CandidateId> begin_;  ///< first id per robot; the last entry is the end
  std::vector<int> robot_of_;
  std::vector<const Candidate*> candidates_;
  std::vector<double> individual_values_;
  std::vector<CandidateId> by_value_;
  double offset_ = 0.0;
};

}  // namespace vantage::planner
