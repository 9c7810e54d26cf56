#pragma once

#include <cstdint>
#include <span>

#include "planner/problem/belief_table.hpp"
#include "planner/problem/information_measure.hpp"
#include "planner/problem/log_product.hpp"

namespace vantage::planner {

/// What one look along a trajectory tells of one target.
struct Look {
  std::uint16_t target = 0;
  std::uint16_t step = 0;  ///< 1 … T: on arrival there
  PackedInformation information;
};

/// How the belief in each target goes on while robots look at it, and what that is worth.
class TargetCourses {
 public:
  /// The targets of `problem`, their motion, the horizon, and what teammates are sure to see.
  TargetCourses(const SearchProblem& problem, InformationMeasure measure);

  [[nodiscard]] const BeliefTable& beliefs() const { return beliefs_; }

  /// One target's belief after a step, and what was gained of it until then.
  struct Course {
    double block[kMaxPacked] = {};
    LogProduct gained;  ///< of e^{2 · nats}
    bool is_seen = false;
  };
  /// One robot's looks at one target, by step.
  using Looks = std::span<const Look>;

  /// The course after `step`, until which nobody looks.
  [[nodiscard]] Course unseen(int target, int step = 0) const;
  /// Carries `course` from step `from` through the looks of several robots, added up in the order
  /// given; returns the nats gained by the end. Where `kept` is not null the course after each
  /// step t > from is written to kept[t]. A pure function of the looks, to the bit, whatever
  /// `from` it is taken up at: that is why no search of this room can go in circles.
  /// The spans of `looks` are used up.
  double follow(int target, int from, Course course, std::span<Looks> looks, Course* kept) const;

 private:
  BeliefTable beliefs_;
  int horizon_steps_;
  InformationMeasure measure_;
};

/// Calls of(target, its looks) for every target that is looked at, in order.
/// Precondition: `looks` are ordered by target.
template <class Of>
void for_each_target(std::span<const Look> looks, Of&& of) {
  for (std::size_t begin = 0; begin < looks.size();) {
    std::size_t end = begin + 1;
    while (end < looks.size() && looks[end].target == looks[begin].target) {
      ++end;
    }
    of(static_cast<int>(looks[begin].target), looks.subspan(begin, end - begin));
    begin = end;
  }
}

}  // namespace vantage::planner
