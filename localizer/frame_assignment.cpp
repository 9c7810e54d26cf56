#include "localizer/frame_assignment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "core/angle.hpp"
#include "localizer/sighting_model.hpp"

namespace vantage::localizer {
namespace {

constexpr std::size_t kHypothesesMax = 12;
constexpr double kMatchSigma = 4.0;      // σ; a sighting with a larger error does not fit a body
constexpr double kUnmatchedCost = 14.0;  // cost of a sighting that shows no body
constexpr double kAmbiguousCost = 1.0;   // hypotheses are equally likely within this difference

/// Assignment of one sighting to one body.
struct Match {
  double cost = std::numeric_limits<double>::infinity();  ///< −2 ln of the density; ∞: does not fit
  Eigen::Vector2d residual;
  Eigen::Matrix<double, 2, 3> by_pose;
  Eigen::Matrix2d by_point;
  Eigen::Matrix2d S;  ///< covariance of the residual
};

Match match(const FrameScene& scene, const ObserverView& view, const models::Sighting& sighting,
            const CandidateBody& body) {
  const ExpectedSighting expected =
      expected_sighting(scene.sensor, view.world_from_body, body.position_m);
  Match out;
  out.residual << sighting.range_m - expected.range_m,
      wrap_to_pi(sighting.bearing_rad - expected.bearing_rad);
  out.by_pose = expected.by_pose;
  out.by_point = expected.by_point;
  Eigen::Matrix2d R = sighting_covariance(scene.noise, expected, body.is_mate);
  R(1, 1) += scene.noise.frame_bearing_sigma_rad * scene.noise.frame_bearing_sigma_rad;
  out.S = R + out.by_pose * view.covariance * out.by_pose.transpose() +
          out.by_point * body.covariance * out.by_point.transpose();
  const double squared = out.residual.dot(out.S.inverse() * out.residual);
  if (squared < kMatchSigma * kMatchSigma) {
    // The density is relative to that for a certain pose, so that a good match costs about 2.
    out.cost = squared + std::log(out.S.determinant() / (R(0, 0) * R(1, 1)));
  }
  return out;
}

/// First assignment of a hypothesis.
struct Seed {
  double cost = 0.0;
  std::size_t sighting = 0;
  std::size_t body = 0;
};

/// The seeds with the lowest cost, in ascending order.
struct Seeds {
  std::array<Seed, kHypothesesMax> best;
  std::size_t count = 0;

  void add(const Seed& seed) {
    if (count == kHypothesesMax && seed.cost >= best.back().cost) {
      return;
    }
    count = std::min(count + 1, kHypothesesMax);
    std::size_t place = count - 1;
    for (; place > 0 && best[place - 1].cost > seed.cost; --place) {
      best[place] = best[place - 1];
    }
    best[place] = seed;
  }
};

struct Hypothesis {
  double cost = 0.0;
  std::array<int, kFrameSightingsMax> ids{};
};

/// Returns the observer's view, corrected by the sighting of `seed`.
ObserverView corrected(const FrameScene& scene, const ObserverView& view, const Seed& seed) {
  const CandidateBody& body = scene.bodies[seed.body];
  const Match first = match(scene, view, scene.sightings[seed.sighting], body);
  const Eigen::Matrix<double, 3, 2> PHt =
      view.covariance * first.by_pose.transpose() + body.cross * first.by_point.transpose();
  const Eigen::Matrix<double, 3, 2> gain = PHt * first.S.inverse();
  const Eigen::Vector3d step = gain * first.residual;
  const Pose2& pose = view.world_from_body;
  return {{pose.x_m + step.x(), pose.y_m + step.y(), wrap_to_pi(pose.yaw_rad + step.z())},
          view.covariance - gain * PHt.transpose()};
}

/// Completes the hypothesis that begins with `seed`. `given`: ids of the identified sightings.
Hypothesis complete(const FrameScene& scene, const ObserverView& prior, const Seed& seed,
                    std::span<const int> given) {
  const ObserverView view = corrected(scene, prior, seed);
  Hypothesis out;
  out.cost = seed.cost;
  out.ids.fill(kNoBodyId);
  std::copy(given.begin(), given.end(), out.ids.begin());
  out.ids[seed.sighting] = scene.bodies[seed.body].id;
  for (std::size_t k = 0; k < given.size(); ++k) {
    if (out.ids[k] != kNoBodyId) {
      continue;
    }
    double least = kUnmatchedCost;
    int found = kNoBodyId;
    for (const CandidateBody& body : scene.bodies) {
      if (std::find(out.ids.begin(), out.ids.end(), body.id) != out.ids.end()) {
        continue;
      }
      if (const double cost = match(scene, view, scene.sightings[k], body).cost; cost < least) {
        least = cost;
        found = body.id;
      }
    }
    out.ids[k] = found;
    out.cost += least;
  }
  return out;
}

}  // namespace

void assign_frame(const FrameScene& scene, const ObserverView& observer, std::span<int> ids) {
  Seeds seeds;
  for (std::size_t k = 0; k < ids.size(); ++k) {
    for (std::size_t body = 0; ids[k] == kNoBodyId && body < scene.bodies.size(); ++body) {
      const double cost = match(scene, observer, scene.sightings[k], scene.bodies[body]).cost;
      if (std::isfinite(cost)) {
        seeds.add({cost, k, body});
      }
    }
  }
  std::array<Hypothesis, kHypothesesMax> hypotheses;
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t h = 0; h < seeds.count; ++h) {
    hypotheses[h] = complete(scene, observer, seeds.best[h], ids);
    best = std::min(best, hypotheses[h].cost);
  }
  for (std::size_t k = 0; k < ids.size(); ++k) {
    if (ids[k] != kNoBodyId) {
      continue;
    }
    bool is_first = true;
    for (std::size_t h = 0; h < seeds.count; ++h) {
      if (hypotheses[h].cost <= best + kAmbiguousCost) {
        const int id = hypotheses[h].ids[k];
        ids[k] = is_first || ids[k] == id ? id : kAmbiguousId;
        is_first = false;
      }
    }
  }
}

}  // namespace vantage::localizer
