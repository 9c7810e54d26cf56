#include "planner/search/near_bound.hpp"

#include <algorithm>
#include <cmath>

#include "core/infinity.hpp"

namespace vantage::planner {
namespace {

constexpr double kMargin_m = 1e-6;
constexpr double kRadii_m[] = {0.5, 0.2, 0.1};  // disc radii, largest first
constexpr int kAskEvery = 64;                   // recursion steps between deadline checks
constexpr std::int64_t kStepsMax = 60'000;      // recursion steps per disc size

}  // namespace

NearBound::NearBound(int targets_max, int horizon_max) {
  const std::size_t size = index(targets_max) * index(horizon_max + 1);
  targets_.reserve(index(targets_max));
  takes_part_.reserve(index(targets_max));
  for (std::vector<double>* table : {&radii_m_, &near_, &outside_, &savings_, &chains_}) {
    table->reserve(size);
  }
}

void NearBound::reset(const SearchProblem& problem, const BeliefTable& beliefs,
                      const InformationHeuristic& heuristic) {
  begin(problem, beliefs, heuristic);
  constexpr int kStepsAtMost = 30;  // events are bits of a 32-bit integer
  for (int m = 0; m < beliefs.target_count() && horizon_ <= kStepsAtMost; ++m) {
    if (heuristic.is_averaged(m) && !heuristic.has_only_own_information(m)) {
      targets_.push_back(m);
      takes_part_[index(m)] = 1;
    }
  }
  for (std::vector<double>* table : {&radii_m_, &near_, &outside_, &savings_, &chains_}) {
    table->assign(targets_.size() * index(horizon_ + 1), 0.0);
  }
  if (!targets_.empty()) {
    tabulate_hops();
  }
}

void NearBound::tabulate_hops() {
  constexpr std::size_t kControlsMax = 12;  // 12³ end poses are computed quickly
  hops_[1] = hops_[2] = hops_[3] = {kInfinity, 0.0};
  const auto add = [](Hop& hop, const Pose2& to) {
    hop.least_m = std::min(hop.least_m, to.position_m().norm());
    hop.most_m = std::max(hop.most_m, to.position_m().norm());
  };
  const bool few = problem_->controls.size() <= kControlsMax;
  for (const models::UnicycleControl& a : problem_->controls) {
    const Pose2 first = models::step_unicycle({}, a, problem_->step_s);
    add(hops_[1], first);
    for (const models::UnicycleControl& b : problem_->controls) {
      const Pose2 second = models::step_unicycle(first, b, problem_->step_s);
      add(hops_[2], second);
      for (std::size_t c = 0; few && c < problem_->controls.size(); ++c) {
        add(hops_[3], models::step_unicycle(second, problem_->controls[c], problem_->step_s));
      }
    }
  }
  if (!few) {
    hops_[3] = {0.0, kInfinity};
  }
}

double NearBound::strongest_from(int m, double least_m) const {
  const double sight_m = heuristic_->sight_m(m);
  if (least_m > sight_m + kMargin_m) {
    return 0.0;
  }
  const double from_m = std::max(0.0, least_m - kMargin_m);
  return heuristic_->look_bound(m, from_m, from_m + 2.0 * sight_m, 0).average();
}

void NearBound::set_discs(double radius_m) {
  const Eigen::Vector2d start_m = problem_->start.position_m();
  for (int i = 0; i < static_cast<int>(targets_.size()); ++i) {
    const int m = targets_[index(i)];
    for (int k = 1; k <= horizon_; ++k) {
      const Eigen::Vector2d mean_m = beliefs_->mean_m(m, k).head<2>();
      double nearest_m = kInfinity;
      for (const int other : targets_) {
        if (other != m) {
          nearest_m = std::min(nearest_m, (beliefs_->mean_m(other, k).head<2>() - mean_m).norm());
        }
      }
      const double rho_m = std::min(radius_m, 0.5 * nearest_m);
      const double reached_m =
          std::max(0.0, (mean_m - start_m).norm() - k * heuristic_->step_m() - kMargin_m);
      radii_m_[at(i, k)] = rho_m;
      near_[at(i, k)] = reached_m < rho_m ? strongest_from(m, reached_m) : 0.0;
      outside_[at(i, k)] = strongest_from(m, std::max(reached_m, rho_m - kMargin_m));
      savings_[at(i, k)] = 0.0;
    }
  }
}

bool NearBound::can_follow(int i, int k, int j, int l) const {
  if (l - k > kHopsMax) {
    return true;
  }
  const double apart_m = (beliefs_->mean_m(targets_[index(j)], l).head<2>() -
                          beliefs_->mean_m(targets_[index(i)], k).head<2>())
                             .norm();
  const double play_m = radii_m_[at(i, k)] + radii_m_[at(j, l)] + kMargin_m;
  const Hop& hop = hops_[l - k];
  return apart_m + play_m > hop.least_m && apart_m - play_m < hop.most_m;
}

double NearBound::stage(const AveragedBlock& block) const {
  return beliefs_->cost() == CostKind::kTrace ? block.trace() : std::log(block.determinant());
}

bool NearBound::work() {
  --steps_left_;
  if (--steps_until_asking_ <= 0) {
    steps_until_asking_ = kAskEvery;
    ++*work_nodes_;
    expired_ = expired_ || deadline_->expired(*work_nodes_);
  }
  return !expired_ && steps_left_ > 0;
}

double NearBound::remaining_cost_outside(int i, int k, AveragedBlock block) {
  double cost = 0.0;
  for (int l = k + 1; l <= horizon_ && work(); ++l) {
    block.predict(heuristic_->motion(targets_[index(i)]));
    block.update(outside_[at(i, l)]);
    cost += stage(block);
  }
  return cost;
}

void NearBound::save(int i, int k, const AveragedBlock& block, std::uint32_t events) {
  if (k > horizon_ || !work()) {
    return;
  }
  AveragedBlock predicted = block;
  predicted.predict(heuristic_->motion(targets_[index(i)]));
  AveragedBlock from_afar = predicted;
  from_afar.update(outside_[at(i, k)]);
  bool can_be = near_[at(i, k)] > outside_[at(i, k)];
  for (int l = std::max(1, k - kHopsMax); can_be && l < k; ++l) {
    can_be = (events >> l & 1U) == 0 || can_follow(i, l, i, k);
  }
  if (can_be) {
    AveragedBlock beside = predicted;
    beside.update(near_[at(i, k)]);
    const double saved = stage(from_afar) + remaining_cost_outside(i, k, from_afar) -
                         (stage(beside) + remaining_cost_outside(i, k, beside));
    savings_[at(i, k)] = std::max(savings_[at(i, k)], saved);
    save(i, k + 1, beside, events | 1U << k);
  }
  save(i, k + 1, from_afar, events);
}

double NearBound::best_chain() const {
  const int count = static_cast<int>(targets_.size());
  double best = 0.0;
  for (int k = 1; k <= horizon_; ++k) {
    for (int i = 0; i < count; ++i) {
      double before = 0.0;
      for (int l = 1; savings_[at(i, k)] > 0.0 && l < k; ++l) {
        for (int j = 0; j < count; ++j) {
          if (chains_[at(j, l)] > before && can_follow(j, l, i, k)) {
            before = chains_[at(j, l)];
          }
        }
      }
      chains_[at(i, k)] = savings_[at(i, k)] > 0.0 ? savings_[at(i, k)] + before : 0.0;
      best = std::max(best, chains_[at(i, k)]);
    }
  }
  return best;
}

NearBound::Answer NearBound::cost(const Deadline& deadline, std::int64_t& work_nodes) {
  deadline_ = &deadline;
  work_nodes_ = &work_nodes;
  steps_until_asking_ = 0;
  expired_ = false;
  double best = -kInfinity;
  for (const double radius_m : kRadii_m) {
    set_discs(radius_m);
    steps_left_ = kStepsMax;
    double from_afar = 0.0;
    for (int i = 0; i < static_cast<int>(targets_.size()); ++i) {
      const int m = targets_[index(i)];
      const AveragedBlock prior(beliefs_->layout(m), beliefs_->open_loop(m, 0));
      from_afar += remaining_cost_outside(i, 0, prior);
      save(i, 1, prior, 0);
    }
    if (expired_) {
      return {best, true};
    }
    if (steps_left_ > 0) {
      best = std::max(best, from_afar - best_chain());
    }
  }
  return {std::isnan(best) ? -kInfinity : best, false};
}

}  // namespace vantage::planner
