#include "sim/rover/starts.hpp"

#include <algorithm>
#include <random>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "sim/random.hpp"

namespace vantage::sim {
namespace {

constexpr double kFromRobotsM = 1.0;
constexpr double kFromTargetsM = 0.3;
constexpr double kFromWallsM = 0.1;
constexpr int kStartDrawsMax = 2000;
constexpr int kHalvingsMax = 4;

struct Placed {
  Eigen::Vector2d centre_m;
  double radius_m;
};

}  // namespace

std::vector<Pose2> target_starts(const scenario::Scenario& scenario, std::uint64_t seed) {
  std::mt19937_64 rng = random_stream(seed, "target starts");
  std::uniform_real_distribution<double> share(0.0, 1.0);
  const models::Rectangle& bounds = scenario.world.bounds;
  std::vector<Placed> placed;
  for (const scenario::TargetSpec& target : scenario.targets) {
    if (target.start) {
      placed.push_back({target.start->position_m(), target.radius_m});
    }
  }
  const auto is_free = [&](const Eigen::Vector2d& p_m, double radius_m, double relax) {
    return models::clearance_m(scenario.world, p_m) >= radius_m + kFromWallsM * relax &&
           std::all_of(scenario.robots.begin(), scenario.robots.end(),
                       [&](const scenario::RobotSpec& robot) {
                         return (robot.start.position_m() - p_m).norm() >= kFromRobotsM * relax;
                       }) &&
           std::all_of(placed.begin(), placed.end(), [&](const Placed& other) {
             return (other.centre_m - p_m).norm() >=
                    radius_m + other.radius_m + kFromTargetsM * relax;
           });
  };

  std::vector<Pose2> starts;
  for (const scenario::TargetSpec& target : scenario.targets) {
    if (target.start) {
      starts.push_back(*target.start);
      continue;
    }
    bool found = false;
    double relax = 1.0;
    for (int halving = 0; halving <= kHalvingsMax && !found; ++halving, relax *= 0.5) {
      for (int draw = 0; draw < kStartDrawsMax && !found; ++draw) {
        const double x_share = share(rng);
        const double y_share = share(rng);
        const Eigen::Vector2d p_m =
            bounds.min_m +
            (bounds.max_m - bounds.min_m).cwiseProduct(Eigen::Vector2d(x_share, y_share));
        found = is_free(p_m, target.radius_m, relax);
        if (found) {
          starts.push_back({p_m.x(), p_m.y(), wrap_to_pi(2.0 * kPi * share(rng))});
          placed.push_back({p_m, target.radius_m});
        }
      }
    }
    require(found, "target " + target.name +
                       ": no free start position left: " + std::to_string(starts.size()) + " of " +
                       std::to_string(scenario.targets.size()) + " targets have one");
  }
  return starts;
}

}  // namespace vantage::sim
