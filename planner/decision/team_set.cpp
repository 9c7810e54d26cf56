#include "planner/decision/team_set.hpp"

#include <algorithm>

#include "core/index.hpp"

namespace vantage::planner {
TeamSet::TeamSet(const TeamOracle& oracle)
    : oracle_(&oracle),
      depths_(index(oracle.problem().horizon_steps + 1)),
      choice_(index(oracle.robot_count()), kNoCandidate),
      observers_(index(oracle.target_count())),
      courses_(index(oracle.target_count()) * depths_),
      values_(index(oracle.target_count())) {
  scratch_.reserve(choice_.size() + 1);
  for (int m = 0; m < oracle.target_count(); ++m) {
    std::fill_n(courses(m), depths_, TargetCourses::Course{});
    courses(m)[0] = oracle.courses().open_loop_course(m);
    values_[index(m)] = oracle.courses().follow(m, 0, courses(m)[0], {}, courses(m));
  }
}

double TeamSet::information() const {
  double total = 0.0;
  for (const double nats : values_) {
    total += nats;
  }
  return total;
}

double TeamSet::value_of_target(int target, int left_out, const Observer& added, int first,
                                bool keep) {
  scratch_.clear();
  bool is_added = added.measurements.empty();
  for (const Observer& observer : observers_[index(target)]) {
    if (!is_added && added.robot < observer.robot) {
      scratch_.push_back(added.measurements);
      is_added = true;
    }
    if (observer.robot != left_out) {
      scratch_.push_back(observer.measurements);
    }
  }
  if (!is_added) {
    scratch_.push_back(added.measurements);
  }
  return oracle_->courses().follow(target, first - 1, courses(target)[first - 1], scratch_,
                                   keep ? courses(target) : nullptr);
}

double TeamSet::sum_with(CandidateId id, int left_out) {
  const int adder = left_out < 0 ? oracle_->robot_of(id) : -1;
  double total = 0.0;
  int next = 0;
  for_each_target(
      oracle_->candidate(id).measurements, [&](int m, TargetCourses::Measurements measurements) {
        for (; next < m; ++next) {
          total += values_[index(next)];
        }
        const Observer added{adder, adder >= 0 ? measurements : TargetCourses::Measurements{}};
        total += value_of_target(m, left_out, added, measurements.front().step, false);
        next = m + 1;
      });
  for (; next < oracle_->target_count(); ++next) {
    total += values_[index(next)];
  }
  for (int robot = 0; robot < oracle_->robot_count(); ++robot) {
    const CandidateId chosen = robot == adder ? id : choice_[index(robot)];
    if (chosen != kNoCandidate && robot != left_out) {
      total += oracle_->candidate(chosen).unshared_nats - oracle_->candidate(chosen).energy_cost;
    }
  }
  return total;
}

double TeamSet::value_with(CandidateId id) {
  ++calls_;
  return sum_with(id, -1);
}

double TeamSet::value_without(int robot) {
  ++calls_;
  return sum_with(choice_[index(robot)], robot);
}

double TeamSet::information_gain(CandidateId id) {
  ++calls_;
  double gain = 0.0;
  for_each_target(
      oracle_->candidate(id).measurements, [&](int m, TargetCourses::Measurements measurements) {
        const Observer added{oracle_->robot_of(id), measurements};
        gain += value_of_target(m, -1, added, measurements.front().step, false) - values_[index(m)];
      });
  return gain;
}

void TeamSet::change(CandidateId id, int left_out) {
  value_ = sum_with(id, left_out);
  const int adder = left_out < 0 ? oracle_->robot_of(id) : -1;
  for_each_target(
      oracle_->candidate(id).measurements, [&](int m, TargetCourses::Measurements measurements) {
        const Observer added{adder, adder >= 0 ? measurements : TargetCourses::Measurements{}};
        values_[index(m)] = value_of_target(m, left_out, added, measurements.front().step, true);
        std::vector<Observer>& observers = observers_[index(m)];
        const auto at = std::find_if(
            observers.begin(), observers.end(),
            [&](const Observer& observer) { return observer.robot >= std::max(adder, left_out); });
        if (adder >= 0) {
          observers.insert(at, added);
        } else {
          observers.erase(at);
        }
      });
}

void TeamSet::add(CandidateId id) {
  change(id, -1);
  choice_[index(oracle_->robot_of(id))] = id;
}

void TeamSet::drop(int robot) {
  change(choice_[index(robot)], robot);
  choice_[index(robot)] = kNoCandidate;
}

void TeamSet::become(const Choice& choice) {
  for (int robot = 0; robot < oracle_->robot_count(); ++robot) {
    if (choice_[index(robot)] == choice[index(robot)]) {
      continue;
    }
    if (choice_[index(robot)] != kNoCandidate) {
      drop(robot);
    }
    if (choice[index(robot)] != kNoCandidate) {
      add(choice[index(robot)]);
    }
  }
}

}  // namespace vantage::planner
