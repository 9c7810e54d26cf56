#include "estimator/ranges/range_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include <Eigen/LU>

#include "core/check.hpp"
#include "core/index.hpp"
#include "core/infinity.hpp"
#include "estimator/ranges/range_only.hpp"
#include "estimator/ranges/range_refinement.hpp"

namespace vantage::estimator {
namespace {

/// Number of evenly spaced ranges per beacon from which initial values are computed.
constexpr std::size_t kDrawn = 300;
constexpr std::array kScales = {0.8, 0.9, 1.0, 1.12, 1.25};
constexpr std::array kBiases_m = {-1.5, 0.0, 1.5};
constexpr int kRoundsOfStart = 30;
constexpr int kRounds = 200;

using Places = std::vector<Eigen::Vector2d>;
using RangesOfBeacons = std::vector<std::vector<TakenRange>>;

RangesOfBeacons by_beacon(std::span<const TakenRange> ranges, int beacons) {
  require(beacons >= 1, "the number of beacons must be at least 1");
  RangesOfBeacons out(index(beacons));
  for (const TakenRange& range : ranges) {
    require(range.beacon >= 0 && range.beacon < beacons,
            "each range must have the index of a beacon");
    require(is_within_bound(range), "each range must be finite and within the limit of the fit");
    out[index(range.beacon)].push_back(range);
  }
  for (const auto& of : out) {
    require(of.size() >= index(kRangesOfBeaconMin),
            "each beacon must have enough ranges for a fit");
  }
  return out;
}

std::vector<TakenRange> drawn(const std::vector<TakenRange>& ranges) {
  if (ranges.size() <= kDrawn) {
    return ranges;
  }
  std::vector<TakenRange> out;
  for (std::size_t k = 0; k < kDrawn; ++k) {
    out.push_back(ranges[k * ranges.size() / kDrawn]);
  }
  return out;
}

double quantile(std::vector<double> values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Returns the possible positions of a beacon under the calibration in `spec`, most likely first.
Places places_by(const std::vector<TakenRange>& ranges, const RangeOnlySpec& spec) {
  RangeOnlyFilter filter(spec);
  for (const TakenRange& range : ranges) {
    filter.update(range.robot_m, range.range_m);
  }
  constexpr double kTrustMin = 0.01;
  Places out;
  for (const BeaconHypothesis& hypothesis : filter.hypotheses()) {
    if (hypothesis.weight >= kTrustMin) {
      out.push_back(hypothesis.mean_m);
    }
  }
  return out;
}

/// Fit of one beacon with fixed calibration, and its log posterior.
struct Alone {
  RangeState state;
  double nats = 0.0;
};

class Search {
 public:
  Search(std::span<const TakenRange> ranges, int beacons, const RangeFitSpec& spec)
      : by_beacon_(by_beacon(ranges, beacons)), found_(index(beacons)) {
    std::vector<double> sizes_m;
    for (const TakenRange& range : ranges) {
      sizes_m.push_back(std::abs(range.range_m));
    }
    median_m_ = quantile(sizes_m, 0.5);
    for (const auto& of : by_beacon_) {
      drawn_.push_back(drawn(of));
      all_drawn_.insert(all_drawn_.end(), drawn_.back().begin(), drawn_.back().end());
    }
    whole_ = {ranges, std::max(quantile(sizes_m, 0.95), 1e-3), {}, spec};
    part_ = whole_;
    part_.ranges = all_drawn_;
  }

  RangeFit fit() {
    RangeState best = best_start();
    for (int again = 0; again < 3 && exchange_places(best); ++again) {
      refine(part_, best, kRounds);
    }
    refine(whole_, best, kRounds);
    RangeFit fit = fit_at(whole_, best);
    for (int b = 0; b < static_cast<int>(found_.size()); ++b) {
      weigh_others(best, b, fit);
    }
    return fit;
  }

 private:
  /// Returns the best refined state over the grid of calibrations and noise widths.
  RangeState best_start() {
    RangeState best;
    double best_nats = -kInfinity;
    for (const double scale : kScales) {
      for (const double bias_m : kBiases_m) {
        for (const double wider : {1.0, 3.0}) {
          RangeState state = start({scale, bias_m}, wider);
          const double nats = refine(part_, state, kRoundsOfStart);
          if (nats > best_nats) {
            best_nats = nats;
            best = std::move(state);
          }
        }
      }
    }
    require(!best.noise.empty(),
            "no calibration fits the ranges: the likelihood is not finite for any calibration");
    refine(part_, best, kRounds);
    return best;
  }

  RangeState start(const models::RangeCalibration& calibration, double wider) {
    RangeOnlySpec spec;
    spec.calibration = calibration;
    // Every calibration within the bounds of the grid is within 6 % of the scale and within 0.75 m
    // of the bias of a grid point.
    spec.range_sigma_m = wider * std::hypot(0.04 * median_m_, 0.4);
    spec.outlier_share = 0.2;
    spec.outlier_span_m = whole_.outlier_span_m;
    RangeState state;
    state.calibration = calibration;
    for (std::size_t b = 0; b < found_.size(); ++b) {
      Places places = places_by(drawn_[b], spec);
      if (places.empty()) {
        places.push_back(drawn_[b].front().robot_m);
      }
      state.beacons_m.push_back(places.front());
      found_[b].insert(found_[b].end(), places.begin(), places.end());
    }
    guess_noise(part_, state);
    return state;
  }

  /// Refines the position of one beacon from `beacon_m`, with the calibration of `state` fixed.
  static Alone alone(const RangeProblem& like, std::vector<TakenRange> ranges,
                     const RangeState& state, const Eigen::Vector2d& beacon_m) {
    for (TakenRange& range : ranges) {
      range.beacon = 0;
    }
    constexpr double kHeld = 1e-9;
    const RangeProblem problem{ranges, like.outlier_span_m, state.calibration, {kHeld, kHeld}};
    Alone out{{state.calibration, {beacon_m}, {}}, 0.0};
    guess_noise(problem, out.state);
    out.nats = refine(problem, out.state, kRoundsOfStart);
    return out;
  }

  /// Returns the distinct local maxima that are reached from the beacon's positions in all starts.
  std::vector<Alone> tops(const RangeState& state, std::size_t beacon) const {
    std::vector<Alone> out;
    const auto add = [&](const Eigen::Vector2d& from_m) {
      Alone top = alone(part_, drawn_[beacon], state, from_m);
      const auto same = [&](const Alone& other) {
        const double apart_m = (other.state.beacons_m[0] - top.state.beacons_m[0]).norm();
        return apart_m < other.state.noise[0].width_m;
      };
      if (std::none_of(out.begin(), out.end(), same)) {
        out.push_back(std::move(top));
      }
    };
    add(state.beacons_m[beacon]);
    Places tried;
    const double near_m = 0.02 * median_m_;
    for (const Eigen::Vector2d& beacon_m : found_[beacon]) {
      if (std::none_of(tried.begin(), tried.end(), [&](const Eigen::Vector2d& other_m) {
            return (other_m - beacon_m).norm() < near_m;
          })) {
        tried.push_back(beacon_m);
        add(beacon_m);
      }
    }
    return out;
  }

  /// Moves each beacon to its most likely position for this calibration. Returns true if any beacon
  /// moved.
  bool exchange_places(RangeState& state) const {
    bool moved = false;
    for (std::size_t b = 0; b < found_.size(); ++b) {
      const std::vector<Alone> all = tops(state, b);
      const auto best = std::max_element(
          all.begin(), all.end(), [](const Alone& x, const Alone& y) { return x.nats < y.nats; });
      if (best->nats > all.front().nats + 1e-3) {
        state.beacons_m[b] = best->state.beacons_m[0];
        state.noise[b] = best->state.noise[0];
        moved = true;
      }
    }
    return moved;
  }

  /// Computes the probabilities of the alternative positions from the subset of the ranges.
  /// Positions that coincide are counted once.
  void weigh_others(const RangeState& state, int beacon, RangeFit& fit) const {
    const std::vector<Alone> all = tops(state, index(beacon));
    FittedBeacon& of = fit.beacons[index(beacon)];
    const double thinner = static_cast<double>(by_beacon_[index(beacon)].size()) /
                           static_cast<double>(drawn_[index(beacon)].size());
    double others = 0.0;
    double likeliest = 1e-3;  // smallest odds of an alternative position that is reported
    for (std::size_t k = 1; k < all.size(); ++k) {
      const double nats = thinner * (all[k].nats - all.front().nats) / fit.correlation;
      const double odds = std::exp(std::min(nats, 50.0));
      others += odds;
      if (odds > likeliest) {
        likeliest = odds;
        of.other = all[k].state.beacons_m[0];
      }
    }
    of.probability = 1.0 / (1.0 + others);
  }

  RangesOfBeacons by_beacon_;
  RangesOfBeacons drawn_;
  std::vector<TakenRange> all_drawn_;
  std::vector<Places> found_;  ///< by beacon: its positions in all starts
  double median_m_ = 0.0;
  RangeProblem whole_;
  RangeProblem part_;
};

}  // namespace

bool is_within_bound(const TakenRange& range) {
  const auto is_within = [](double x_m) {
    return std::abs(x_m) <= kRangeBound_m;
  };  // false for NaN
  return is_within(range.range_m) && is_within(range.robot_m.x()) && is_within(range.robot_m.y());
}

RangeFit fit_ranges(std::span<const TakenRange> ranges, int beacons, const RangeFitSpec& spec) {
  return Search(ranges, beacons, spec).fit();
}

InnovationScore judge(const RangeFit& fit, std::span<const TakenRange> ranges) {
  InnovationScore out;
  double sum = 0.0;
  for (const TakenRange& range : ranges) {
    const FittedBeacon& beacon = fit.beacons.at(index(range.beacon));
    const Eigen::Vector2d away_m = beacon.position_m - range.robot_m;
    const double distance_m = std::max(away_m.norm(), 1e-6);
    const double nu =
        range.range_m - fit.calibration.range_scale * distance_m - fit.calibration.range_bias_m;
    const Eigen::Vector2d H = fit.calibration.range_scale / distance_m * away_m;
    const Eigen::Vector4d J(distance_m, 1.0, H.x(), H.y());
    const double S = J.dot(beacon.joint * J) + beacon.range_sigma_m * beacon.range_sigma_m;
    constexpr double kOutlier = 16.0;  // 4σ, squared
    if (nu * nu > kOutlier * S) {
      ++out.outliers;
      continue;
    }
    ++out.inliers;
    sum += nu * nu / S;
  }
  out.nees = out.inliers > 0 ? sum / out.inliers : 0.0;
  return out;
}

}  // namespace vantage::estimator
