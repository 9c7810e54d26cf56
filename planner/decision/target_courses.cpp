#include "planner/decision/target_courses.hpp"

#include <algorithm>

namespace vantage::planner {

TargetCourses::TargetCourses(const SearchProblem& problem, InformationMeasure measure)
    : beliefs_(static_cast<int>(problem.targets.size()), problem.horizon_steps),
      horizon_steps_(problem.horizon_steps),
      measure_(measure) {
  beliefs_.reset(problem);
}

TargetCourses::Course TargetCourses::open_loop_course(int target, int step) const {
  Course course;
  std::copy_n(beliefs_.open_loop(target, step), packed_size(beliefs_.layout(target)), course.block);
  return course;
}

double TargetCourses::follow(int target, int from, Course course,
                             std::span<Measurements> measurements, Course* kept) const {
  const BlockLayout layout = beliefs_.layout(target);
  const int entries = layout == BlockLayout::kSpatial ? 6 : 3;
  const bool is_mutual = measure_ == InformationMeasure::kMutual;
  int last = kept != nullptr || !is_mutual ? horizon_steps_ : 0;
  for (Measurements& of_robot : measurements) {
    while (!of_robot.empty() && of_robot.front().step <= from) {
      of_robot = of_robot.subspan(1);
    }
    last = of_robot.empty() ? last : std::max<int>(last, of_robot.back().step);
  }
  for (int t = from + 1; t <= last; ++t) {
    beliefs_.predict_into(target, t, course.block, course.block);
    PackedInformation M;
    bool is_seen = false;
    for (Measurements& of_robot : measurements) {
      if (of_robot.empty() || of_robot.front().step != t) {
        continue;
      }
      const PackedInformation& added = of_robot.front().information;
      for (int i = 0; i < (added.is_of_state ? kMaxPacked : entries); ++i) {
        M.m[i] += added.m[i];
      }
      M.is_of_state = M.is_of_state || added.is_of_state;
      of_robot = of_robot.subspan(1);
      is_seen = true;
    }
    if (is_seen) {
      if (is_mutual) {
        course.gained.multiply(gain(layout, M, course.block));
      }
      update(layout, M, course.block, course.block);
      course.is_seen = true;
    }
    if (!is_mutual && course.is_seen) {
      course.gained.multiply(beliefs_.open_loop_measure(target, t) /
                             determinant(layout, course.block));
    }
    if (kept != nullptr) {
      kept[t] = course;
    }
  }
  return 0.5 * course.gained.log();
}

}  // namespace vantage::planner
