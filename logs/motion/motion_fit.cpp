#include "logs/motion/motion_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "core/index.hpp"

namespace vantage::logs {
namespace {

constexpr std::size_t kHorizons = kHorizons_s.size();

std::int64_t steps_of(double time_s) { return std::llround(time_s / TargetCourse::kCourseStep_s); }

double log_likelihood(double squared_error, double variance) {
  return -0.5 * (std::log(2.0 * kPi * variance) + squared_error / variance);
}

/// Prediction of one coordinate y for the time t + h: mean a y + b ẏ, variance w.
struct Prediction {
  double a = 1.0;
  double b = 0.0;
  double w = 0.0;
};

Prediction predict_coordinate(const models::TargetModel& model, Eigen::Index axis,
                              double horizon_s) {
  const models::StateMatrix A = model.transition(horizon_s);
  const models::StateMatrix W = model.process_noise(horizon_s);
  return {A(axis, axis), model.has_velocity() ? A(axis, axis + 2) : 0.0, W(axis, axis)};
}

using Point = Eigen::Vector3d;

/// Returns the minimum of `cost` near `start`, by a simplex search with initial edges of `edge`.
template <class Cost>
Point minimise(const Cost& cost, const Point& start, double edge) {
  struct Corner {
    Point at;
    double cost;
  };
  const auto corner = [&](const Point& at) { return Corner{at, cost(at)}; };
  std::array<Corner, 4> simplex = {corner(start), corner(start + edge * Point::UnitX()),
                                   corner(start + edge * Point::UnitY()),
                                   corner(start + edge * Point::UnitZ())};
  constexpr int kRoundsMax = 500;
  constexpr double kEnough = 1e-10;
  for (int round = 0; round < kRoundsMax; ++round) {
    std::sort(simplex.begin(), simplex.end(),
              [](const Corner& a, const Corner& b) { return a.cost < b.cost; });
    if (simplex.back().cost - simplex.front().cost < kEnough) {
      break;
    }
    const Point middle = (simplex[0].at + simplex[1].at + simplex[2].at) / 3.0;
    const Point back = middle - simplex.back().at;
    const Corner reflected = corner(middle + back);
    if (reflected.cost < simplex.front().cost) {
      const Corner expanded = corner(middle + 2.0 * back);
      simplex.back() = expanded.cost < reflected.cost ? expanded : reflected;
    } else if (reflected.cost < simplex[2].cost) {
      simplex.back() = reflected;
    } else if (const Corner contracted = corner(middle - 0.5 * back);
               contracted.cost < simplex.back().cost) {
      simplex.back() = contracted;
    } else {
      for (std::size_t i = 1; i < simplex.size(); ++i) {
        simplex[i] = corner(0.5 * (simplex[0].at + simplex[i].at));
      }
    }
  }
  return simplex.front().at;
}

/// Returns the oscillator of one coordinate with the given logarithms of σ_p, σ_v and γ.
models::TargetModel oscillator(const Point& logarithms, Eigen::Index axis) {
  models::TargetModel model{models::TargetKind::kDampedOscillator};
  model.oscillator.position_sigma_m(axis) = std::exp(logarithms.x());
  model.oscillator.velocity_sigma_mps(axis) = std::exp(logarithms.y());
  model.oscillator.damping_per_s(axis) = std::exp(logarithms.z());
  return model;
}

}  // namespace

void TargetCourse::add(Time time, const Eigen::Vector2d& position_m) {
  if (last_ && time <= *last_) {
    return;
  }
  const std::int64_t step_us = from_seconds(kCourseStep_s).count();
  if (last_ && time - *last_ <= from_seconds(kGapMax_s)) {
    const std::int64_t from_us = to_utime(*last_);
    const std::int64_t to_us = to_utime(time);
    for (std::int64_t step = from_us / step_us + 1; step * step_us <= to_us; ++step) {
      const double share =
          static_cast<double>(step * step_us - from_us) / static_cast<double>(to_us - from_us);
      places_m_.emplace_hint(places_m_.end(), step, last_m_ + share * (position_m - last_m_));
    }
  }
  last_ = time;
  last_m_ = position_m;
}

double MotionMoments::mean_square(const Eigen::Vector3d& weights) const {
  return samples == 0 ? 0.0 : weights.dot(sum * weights) / static_cast<double>(samples);
}

void MotionSample::add(const TargetCourse& course, std::int64_t begin, std::int64_t end,
                       double from_share, double to_share) {
  const auto at_share = [&](double share) {
    return begin + std::llround(share * static_cast<double>(end - begin));
  };
  const std::int64_t first = at_share(from_share);
  const std::int64_t last = at_share(to_share);
  const auto& positions_m = course.positions_m();
  for (auto now = positions_m.lower_bound(first + 1);
       now != positions_m.end() && now->first <= last; ++now) {
    const auto before = positions_m.find(now->first - 1);
    if (before == positions_m.end() || before->first < first) {
      continue;
    }
    const Eigen::Vector2d velocity_mps =
        (now->second - before->second) / TargetCourse::kCourseStep_s;
    for (std::size_t h = 0; h < kHorizons; ++h) {
      const auto later = positions_m.find(now->first + steps_of(kHorizons_s[h]));
      if (later == positions_m.end() || later->first > last) {
        continue;
      }
      for (Eigen::Index axis = 0; axis < 2; ++axis) {
        const Eigen::Vector3d each(later->second(axis) - center_m(axis),
                                   now->second(axis) - center_m(axis), velocity_mps(axis));
        MotionMoments& sums = moments[index(axis)][h];
        sums.sum += each * each.transpose();
        ++sums.samples;
      }
    }
  }
}

MotionScore judge(const models::TargetModel& model, const MotionSample& sample) {
  MotionScore score;
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    for (std::size_t h = 0; h < kHorizons; ++h) {
      const Prediction next = predict_coordinate(model, axis, kHorizons_s[h]);
      const MotionMoments& moments = sample.moments[index(axis)][h];
      const double error = moments.squared_error(next.a, next.b);
      score.nats += log_likelihood(error, next.w) / static_cast<double>(kHorizons);
      score.nees[h] += error / next.w;
      score.displacements[index(axis)][h] = {
          moments.squared_error(1.0, 0.0),
          moments.mean_square({0.0, next.a - 1.0, next.b}) + next.w};
    }
  }
  return score;
}

models::TargetModel fit_free(models::TargetKind kind, const MotionSample& sample) {
  models::TargetModel model{kind, 2, 1.0};
  double sum = 0.0;
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    for (std::size_t h = 0; h < kHorizons; ++h) {
      const Prediction next = predict_coordinate(model, axis, kHorizons_s[h]);
      sum += sample.moments[index(axis)][h].squared_error(next.a, next.b) / next.w;
    }
  }
  model.q = sum / (2.0 * static_cast<double>(kHorizons));
  return model;
}

models::TargetModel fit_oscillator(const MotionSample& sample) {
  models::TargetModel fitted{models::TargetKind::kDampedOscillator};
  fitted.oscillator.center_m = sample.center_m;
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    const auto& moments = sample.moments[index(axis)];
    const auto cost = [&](const Point& logarithms) {
      const models::TargetModel model = oscillator(logarithms, axis);
      double sum = 0.0;
      for (std::size_t h = 0; h < kHorizons; ++h) {
        const Prediction next = predict_coordinate(model, axis, kHorizons_s[h]);
        if (!(next.w > 0.0)) {
          return std::numeric_limits<double>::infinity();
        }
        sum -= log_likelihood(moments[h].squared_error(next.a, next.b), next.w);
      }
      return sum;
    };
    // The search starts at the root mean squares of position and velocity, with a damping of 1/s.
    const Eigen::Matrix3d mean = moments.front().sum / static_cast<double>(moments.front().samples);
    constexpr double kLeast = 1e-12;  // lower bound of a mean square, for targets that did not move
    const Point start(0.5 * std::log(std::max(mean(1, 1), kLeast)),
                      0.5 * std::log(std::max(mean(2, 2), kLeast)), 0.0);
    const models::DampedOscillator best = oscillator(minimise(cost, start, 0.3), axis).oscillator;
    fitted.oscillator.position_sigma_m(axis) = best.position_sigma_m(axis);
    fitted.oscillator.velocity_sigma_mps(axis) = best.velocity_sigma_mps(axis);
    fitted.oscillator.damping_per_s(axis) = best.damping_per_s(axis);
  }
  return fitted;
}

std::vector<FittedMotion> fit_motion(std::span<const std::vector<TargetCourse>> logs,
                                     const Eigen::Vector2d& center_m, double fitted_share) {
  MotionSample fitted;
  MotionSample held_back;
  fitted.center_m = held_back.center_m = center_m;
  for (const std::vector<TargetCourse>& courses : logs) {
    std::int64_t begin = std::numeric_limits<std::int64_t>::max();
    std::int64_t end = std::numeric_limits<std::int64_t>::min();
    for (const TargetCourse& course : courses) {
      if (!course.positions_m().empty()) {
        begin = std::min(begin, course.positions_m().begin()->first);
        end = std::max(end, course.positions_m().rbegin()->first);
      }
    }
    if (begin > end) {
      continue;  // no target has a position in this log
    }
    for (const TargetCourse& course : courses) {
      fitted.add(course, begin, end, 0.0, fitted_share);
      held_back.add(course, begin, end, fitted_share, 1.0);
    }
  }
  for (const MotionSample* sample : {&fitted, &held_back}) {
    for (const MotionMoments& moments : sample->moments[0]) {
      require(moments.samples > 0,
              "fit-motion: too few target positions; the part of the log used for the fit and the "
              "rest must each be longer than 8 s");
    }
  }
  std::vector<FittedMotion> all;
  for (const models::TargetModel& model :
       {fit_free(models::TargetKind::kRandomWalk, fitted),
        fit_free(models::TargetKind::kDoubleIntegrator, fitted), fit_oscillator(fitted)}) {
    all.push_back({model, judge(model, fitted), judge(model, held_back)});
  }
  return all;
}

}  // namespace vantage::logs
