#include "estimator/ranges/range_refinement.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <utility>

#include <Eigen/Cholesky>

#include "core/index.hpp"
#include "estimator/ranges/range_only.hpp"

namespace vantage::estimator {
namespace {

constexpr double kFreedom = 5.0;              ///< degrees of freedom of Student's t
constexpr double kPeak = 0.3796066898224944;  ///< density of Student's t at 0: Γ(3)/(Γ(5/2) √(5π))
/// Weight of the noise of all beacons together in the noise estimate of one beacon, as a number of
/// ranges. It matters only for a beacon with few ranges.
constexpr double kBorrowed = 20.0;

Eigen::Index row_of(int beacon) { return 2 + 2 * Eigen::Index{beacon}; }

/// Returns ∂r/∂(scale, bias, x, y).
Eigen::Vector4d jacobian(const RangeState& state, const TakenRange& range) {
  const Eigen::Vector2d away_m = state.beacons_m[index(range.beacon)] - range.robot_m;
  const double distance_m = std::max(away_m.norm(), kRangeNearest_m);
  const Eigen::Vector2d H = state.calibration.range_scale / distance_m * away_m;
  return {distance_m, 1.0, H.x(), H.y()};
}

/// Adds c J Jᵀ to the blocks of `sum` that belong to the calibration and to this beacon.
void add_outer(Eigen::MatrixXd& sum, int beacon, double c, const Eigen::Vector4d& J) {
  const Eigen::Index row = row_of(beacon);
  const Eigen::Matrix4d outer = c * J * J.transpose();
  sum.topLeftCorner<2, 2>() += outer.topLeftCorner<2, 2>();
  sum.block<2, 2>(row, row) += outer.bottomRightCorner<2, 2>();
  sum.block<2, 2>(row, 0) += outer.bottomLeftCorner<2, 2>();
  sum.block<2, 2>(0, row) += outer.topRightCorner<2, 2>();
}

Eigen::Vector2d prior_precision(const RangeFitSpec& spec) {
  return {1.0 / (spec.range_scale_sigma * spec.range_scale_sigma),
          1.0 / (spec.range_bias_sigma_m * spec.range_bias_sigma_m)};
}

Eigen::Vector2d off_prior(const RangeProblem& problem, const RangeState& state) {
  return {problem.prior.range_scale - state.calibration.range_scale,
          problem.prior.range_bias_m - state.calibration.range_bias_m};
}

/// Sets the most likely noise widths and outlier shares, given the current outlier probability of
/// each residual.
void update_noise(const RangeProblem& problem, RangeState& state) {
  struct Sums {
    double ranges = 0.0;
    double inliers = 0.0;
    double squares_m2 = 0.0;
  };
  std::vector<Sums> sums(state.noise.size());
  Sums all;
  for (const TakenRange& range : problem.ranges) {
    const double r = residual_m(state, range);
    const RangeNoise& noise = state.noise[index(range.beacon)];
    const ResidualDensity density = residual_density(r, noise, problem.outlier_span_m);
    const double squared_m2 = density.weight * r * r * noise.width_m * noise.width_m;
    for (Sums* of : {&sums[index(range.beacon)], &all}) {
      of->ranges += 1.0;
      of->inliers += density.inlier_probability;
      of->squares_m2 += squared_m2;
    }
  }
  const double width_m2 = all.squares_m2 / all.inliers;
  const double inlier_share = all.inliers / all.ranges;
  constexpr double kWidthMin_m = 1e-3;
  constexpr double kShareMin = 1e-3;
  constexpr double kShareMax = 0.7;
  for (std::size_t b = 0; b < sums.size(); ++b) {
    const double variance_m2 =
        (sums[b].squares_m2 + kBorrowed * width_m2) / (sums[b].inliers + kBorrowed);
    const double share =
        1.0 - (sums[b].inliers + kBorrowed * inlier_share) / (sums[b].ranges + kBorrowed);
    state.noise[b] = {std::max(std::sqrt(variance_m2), kWidthMin_m),
                      std::clamp(share, kShareMin, kShareMax)};
  }
}

RangeState moved(const RangeState& from, const Eigen::VectorXd& step) {
  RangeState to = from;
  to.calibration.range_scale += step(0);
  to.calibration.range_bias_m += step(1);
  for (std::size_t b = 0; b < to.beacons_m.size(); ++b) {
    to.beacons_m[b] += step.segment<2>(row_of(static_cast<int>(b)));
  }
  return to;
}

/// Makes one Gauss-Newton step, halved until the posterior increases. Returns the length of the
/// step in σ, or 0 if no step increases the posterior.
double climb(const RangeProblem& problem, RangeState& state, double& height) {
  const Eigen::Index size = row_of(static_cast<int>(state.beacons_m.size()));
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size);
  A.diagonal().head<2>() = prior_precision(problem.spec);
  gradient.head<2>() = prior_precision(problem.spec).cwiseProduct(off_prior(problem, state));
  for (const TakenRange& range : problem.ranges) {
    const double r = residual_m(state, range);
    const ResidualDensity density =
        residual_density(r, state.noise[index(range.beacon)], problem.outlier_span_m);
    const Eigen::Vector4d J = jacobian(state, range);
    add_outer(A, range.beacon, density.weight, J);
    gradient.head<2>() += density.score * J.head<2>();
    gradient.segment<2>(row_of(range.beacon)) += density.score * J.tail<2>();
  }
  A.diagonal() *= 1.0 + 1e-9;  // keeps a beacon in place if all its ranges are outliers
  A.diagonal().array() += 1e-9;
  const Eigen::VectorXd step = A.ldlt().solve(gradient);
  const double length = std::sqrt(std::max(step.dot(gradient), 0.0));
  for (double share = 1.0; share > 0.01; share *= 0.5) {
    RangeState tried = moved(state, share * step);
    const double reached = log_posterior(problem, tried);
    if (tried.calibration.range_scale > 0.0 && reached >= height) {
      state = std::move(tried);
      height = reached;
      return share * length;
    }
  }
  return 0.0;
}

/// Standardised scores of one beacon's ranges, sorted by time, with the robot's positions.
struct ScoreSeries {
  std::vector<double> scores;
  std::vector<Eigen::Vector2d> robots_m;
};

/// Returns 1 + 2 Σ ρ, with ρ the autocorrelation of the scores. The sum ends at the first lag where
/// the sum of two adjacent ρ is not significant.
double correlation_in_time(const std::vector<ScoreSeries>& series, double squares, double count) {
  const auto correlation = [&](std::size_t lag) {
    double sum = 0.0;
    double pairs = 0.0;
    for (const ScoreSeries& of : series) {
      for (std::size_t i = lag; i < of.scores.size(); ++i) {
        sum += of.scores[i] * of.scores[i - lag];
        pairs += 1.0;
      }
    }
    return pairs > 0.0 ? sum / pairs / (squares / count) : 0.0;
  };
  constexpr std::size_t kLagMax = 1000;
  const double chance = 2.0 * std::sqrt(2.0 / count);
  double time = 1.0 + 2.0 * correlation(1);
  for (std::size_t lag = 2; lag < kLagMax; lag += 2) {
    const double pair = correlation(lag) + correlation(lag + 1);
    if (pair < chance) {
      break;
    }
    time += 2.0 * pair;
  }
  return std::max(time, 1.0);
}

/// Returns the median distance of the robot between successive ranges to one beacon, m.
double median_spacing_m(const std::vector<ScoreSeries>& series) {
  std::vector<double> spacings_m;
  for (const ScoreSeries& of : series) {
    for (std::size_t i = 1; i < of.robots_m.size(); ++i) {
      spacings_m.push_back((of.robots_m[i] - of.robots_m[i - 1]).norm());
    }
  }
  if (spacings_m.empty()) {
    return 0.0;
  }
  const auto middle = spacings_m.begin() + static_cast<std::ptrdiff_t>(spacings_m.size() / 2);
  std::nth_element(spacings_m.begin(), middle, spacings_m.end());
  return *middle;
}

/// Returns the correlation over pairs of ranges of one beacon, binned by the distance between the
/// robot's positions. Errors caused by a position recur when the robot returns to it. Uses at most
/// kPaired random ranges per beacon: regular subsampling of a periodic path would select the same
/// few positions in every lap.
double correlation_in_space(const std::vector<ScoreSeries>& series, double squares, double count) {
  constexpr std::size_t kPaired = 800;
  constexpr std::size_t kBins = 200;
  struct Bin {
    double pairs = 0.0;
    double products = 0.0;
    double all_products = 0.0;  ///< sum extrapolated from the subset of ranges to all ranges
  };
  std::vector<Bin> bins(kBins);
  const double bin_m = std::max(median_spacing_m(series), kRangeNearest_m);
  double paired = 0.0;
  for (const ScoreSeries& of : series) {
    const std::size_t n = of.scores.size();
    const std::size_t taken = std::min(n, kPaired);
    const double more = static_cast<double>(n) / static_cast<double>(taken);
    paired += static_cast<double>(taken);
    std::mt19937_64 rng(n);
    std::vector<std::size_t> at(taken);
    for (std::size_t i = 0; i < taken; ++i) {
      const std::size_t from = i * n / taken;
      at[i] = from + rng() % ((i + 1) * n / taken - from);
    }
    for (std::size_t i = 0; i < taken; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const std::size_t a = at[i];
        const std::size_t b = at[j];
        const double bin = (of.robots_m[a] - of.robots_m[b]).norm() / bin_m;
        if (bin < static_cast<double>(kBins)) {
          Bin& in = bins[static_cast<std::size_t>(bin)];
          const double product = of.scores[a] * of.scores[b];
          in.pairs += 1.0;
          in.products += product;
          in.all_products += more * more * product;
        }
      }
    }
  }
  double space = 1.0;
  for (const Bin& bin : bins) {
    if (bin.pairs == 0.0) {
      continue;
    }
    // Pairs of recurring errors are not independent; there are at most as many independent pairs as
    // independent errors.
    const double independent = std::min(bin.pairs, paired) / space;
    if (bin.products * count / squares < 2.0 * bin.pairs / std::sqrt(independent)) {
      break;
    }
    space += 2.0 * bin.all_products / squares;
  }
  return space;
}

double correlation_of(const std::vector<ScoreSeries>& series) {
  double squares = 0.0;
  double count = 0.0;
  for (const ScoreSeries& of : series) {
    for (const double score : of.scores) {
      squares += score * score;
      count += 1.0;
    }
  }
  if (squares <= 0.0) {
    return 1.0;
  }
  return std::max(correlation_in_time(series, squares, count),
                  correlation_in_space(series, squares, count));
}

/// Sums over the residuals of one beacon.
struct Shape {
  double ranges = 0.0;
  double inliers = 0.0;
  double scores = 0.0;      ///< Σ ψ², in 1/width²
  double slopes = 0.0;      ///< Σ ψ′, in 1/width²
  double squares_m2 = 0.0;  ///< Σ of r² times the weight of the fit

  void add(const Shape& other, double share) {
    ranges += share * other.ranges;
    inliers += share * other.inliers;
    scores += share * other.scores;
    slopes += share * other.slopes;
    squares_m2 += share * other.squares_m2;
  }
};

struct Residuals {
  std::vector<Shape> shapes;
  std::vector<ScoreSeries> series;
};

Residuals residuals_of(const RangeProblem& problem, const RangeState& state) {
  Residuals out;
  out.shapes.resize(state.beacons_m.size());
  out.series.resize(state.beacons_m.size());
  for (const TakenRange& range : problem.ranges) {
    const double r = residual_m(state, range);
    const RangeNoise& noise = state.noise[index(range.beacon)];
    const ResidualDensity density = residual_density(r, noise, problem.outlier_span_m);
    const double score = density.score * noise.width_m;
    const double w2 = noise.width_m * noise.width_m;
    out.shapes[index(range.beacon)].add({1.0, density.inlier_probability, score * score,
                                         density.slope * w2, density.inlier_probability * r * r},
                                        1.0);
    out.series[index(range.beacon)].scores.push_back(score);
    out.series[index(range.beacon)].robots_m.push_back(range.robot_m);
  }
  return out;
}

}  // namespace

ResidualDensity residual_density(double residual_m, const RangeNoise& noise,
                                 double outlier_span_m) {
  const double x = residual_m / noise.width_m;
  const double q = 1.0 + x * x / kFreedom;
  const double inlier = (1.0 - noise.outlier_share) * kPeak / noise.width_m / (q * q * q);
  const double density = inlier + noise.outlier_share / outlier_span_m;
  const double beta = inlier / density;
  const double u = (kFreedom + 1.0) / (kFreedom * q);
  const double w2 = noise.width_m * noise.width_m;
  const double slope = beta * u * (1.0 - (1.0 - beta) * u * x * x - 2.0 * x * x / (kFreedom * q));
  return {std::log(density), beta, beta * u * x / noise.width_m, slope / w2, beta * u / w2};
}

double residual_m(const RangeState& state, const TakenRange& range) {
  const double distance_m = (state.beacons_m[index(range.beacon)] - range.robot_m).norm();
  return range.range_m - state.calibration.range_scale * distance_m -
         state.calibration.range_bias_m;
}

void guess_noise(const RangeProblem& problem, RangeState& state) {
  std::vector<std::vector<double>> sizes_m(state.beacons_m.size());
  for (const TakenRange& range : problem.ranges) {
    sizes_m[index(range.beacon)].push_back(std::abs(residual_m(state, range)));
  }
  state.noise.assign(state.beacons_m.size(), RangeNoise{});
  for (std::size_t b = 0; b < sizes_m.size(); ++b) {
    if (sizes_m[b].empty()) {
      continue;
    }
    const auto middle = sizes_m[b].begin() + static_cast<std::ptrdiff_t>(sizes_m[b].size() / 2);
    std::nth_element(sizes_m[b].begin(), middle, sizes_m[b].end());
    constexpr double kSigmaOfMedian = 1.4826;
    constexpr double kWidthMin_m = 0.01;
    state.noise[b].width_m = std::max(kSigmaOfMedian * *middle, kWidthMin_m);
  }
}

double log_posterior(const RangeProblem& problem, const RangeState& state) {
  const Eigen::Vector2d off = off_prior(problem, state);
  double sum = -0.5 * off.dot(prior_precision(problem.spec).cwiseProduct(off));
  for (const TakenRange& range : problem.ranges) {
    sum += residual_density(residual_m(state, range), state.noise[index(range.beacon)],
                            problem.outlier_span_m)
               .nats;
  }
  return sum;
}

double refine(const RangeProblem& problem, RangeState& state, int rounds) {
  constexpr double kStill = 1e-4;  // in σ; shorter steps count as converged
  constexpr double kLevel = 1e-6;  // nats; a smaller increase counts as converged
  double before = -std::numeric_limits<double>::infinity();
  for (int round = 0; round < rounds; ++round) {
    update_noise(problem, state);
    double height = log_posterior(problem, state);
    if (climb(problem, state, height) < kStill && height - before < kLevel) {
      return height;
    }
    before = height;
  }
  return log_posterior(problem, state);
}

RangeFit fit_at(const RangeProblem& problem, const RangeState& state) {
  const int beacons = static_cast<int>(state.beacons_m.size());
  const Residuals residuals = residuals_of(problem, state);
  Shape all;
  for (const Shape& shape : residuals.shapes) {
    all.add(shape, 1.0);
  }
  RangeFit fit;
  fit.calibration = state.calibration;
  fit.correlation = correlation_of(residuals.series);

  // Expected slope, and expected square of the score, per range of each beacon.
  std::vector<double> slope(state.beacons_m.size());
  std::vector<double> square(state.beacons_m.size());
  for (int b = 0; b < beacons; ++b) {
    Shape shape = residuals.shapes[index(b)];
    const double spent = 2.0 + 2.0 / beacons;  // fitted parameters per beacon, calibration included
    const double effective_count = shape.inliers / fit.correlation;
    const double small = effective_count / std::max(effective_count - spent, 1.0);
    shape.add(all, kBorrowed / all.ranges);
    const double w2 = state.noise[index(b)].width_m * state.noise[index(b)].width_m;
    slope[index(b)] = std::max(shape.slopes / shape.ranges, 1e-3) / w2;
    square[index(b)] = fit.correlation * small * shape.scores / shape.ranges / w2;
    fit.beacons.push_back({.position_m = state.beacons_m[index(b)],
                           .range_sigma_m = std::sqrt(shape.squares_m2 / shape.inliers),
                           .outlier_share = state.noise[index(b)].outlier_share,
                           .other = {}});
  }
  const Eigen::Index size = row_of(beacons);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(size, size);
  A.diagonal().head<2>() = prior_precision(problem.spec);
  A.diagonal().tail(size - 2).array() = 1e-9;
  Eigen::MatrixXd B = A;
  for (const TakenRange& range : problem.ranges) {
    const Eigen::Vector4d J = jacobian(state, range);
    add_outer(A, range.beacon, slope[index(range.beacon)], J);
    add_outer(B, range.beacon, square[index(range.beacon)], J);
  }
  const Eigen::MatrixXd inverse = A.ldlt().solve(Eigen::MatrixXd::Identity(size, size));
  const Eigen::MatrixXd C = inverse * B * inverse.transpose();
  for (int b = 0; b < beacons; ++b) {
    CalibratedCovariance& joint = fit.beacons[index(b)].joint;
    joint.topLeftCorner<2, 2>() = C.topLeftCorner<2, 2>();
    joint.bottomRightCorner<2, 2>() = C.block<2, 2>(row_of(b), row_of(b));
    joint.bottomLeftCorner<2, 2>() = C.block<2, 2>(row_of(b), 0);
    joint.topRightCorner<2, 2>() = C.block<2, 2>(0, row_of(b));
  }
  fit.range_scale_sigma = std::sqrt(C(0, 0));
  fit.range_bias_sigma_m = std::sqrt(C(1, 1));
  return fit;
}

}  // namespace vantage::estimator
