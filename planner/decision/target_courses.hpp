#pragma once

#include <cstdint>
#include <span>

#include "planner/problem/belief_table.hpp"
#include "planner/problem/information_measure.hpp"
#include "planner/problem/log_product.hpp"

namespace vantage::planner {

/// Information of one measurement along a trajectory about one target.
struct PredictedMeasurement {
  std::uint16_t target = 0;
  std::uint16_t step = 0;  ///< step, 1 … T; the measurement is made at its end
  PackedInformation information;
};

/// Calculator of each target's belief over time under the robots' measurements, and of the
/// information gain.
class TargetCourses {
 public:
  /// Copies from `problem` the targets, their motion, the horizon and the teammates' fixed
  /// information.
  TargetCourses(const SearchProblem& problem, InformationMeasure measure);

  [[nodiscard]] const BeliefTable& beliefs() const { return beliefs_; }

  /// One target's belief after a step and the gain accumulated until then.
  struct Course {
    double block[kMaxPacked] = {};
    LogProduct gained;  ///< information gain, as a product of e^{2 · nats}
    bool is_seen = false;
  };
  /// One robot's measurements of one target, by step.
  using Measurements = std::span<const PredictedMeasurement>;

  /// Returns the course after `step` without any measurement.
  [[nodiscard]] Course open_loop_course(int target, int step = 0) const;
  /// Propagates `course` from step `from` to the last measurement (or the horizon's end) with the
  /// measurements of several robots, summed in the order given. Returns the information gained at
  /// the end, nats. If `kept` is not null, writes the course after each step t > from to kept[t].
  /// The result is a pure function of the measurements, bit for bit, independent of `from`;
  /// therefore no search in planner/decision can cycle. Advances the spans of `measurements` to
  /// their ends.
  double follow(int target, int from, Course course, std::span<Measurements> measurements,
                Course* kept) const;

 private:
  BeliefTable beliefs_;
  int horizon_steps_;
  InformationMeasure measure_;
};

/// Calls of(target, measurements of the target) for every measured target, in order. Precondition:
/// `measurements` are sorted by target.
template <class Of>
void for_each_target(std::span<const PredictedMeasurement> measurements, Of&& of) {
  for (std::size_t begin = 0; begin < measurements.size();) {
    std::size_t end = begin + 1;
    while (end < measurements.size() && measurements[end].target == measurements[begin].target) {
      ++end;
    }
    of(static_cast<int>(measurements[begin].target), measurements.subspan(begin, end - begin));
    begin = end;
  }
}

}  // namespace vantage::planner
