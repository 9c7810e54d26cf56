#include "models/contact/collision_monitor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/collision_object.h>

#include "core/check.hpp"
#include "models/contact/shapes.hpp"

namespace vantage::models {
namespace {

using Object = fcl::CollisionObject<double>;

constexpr double kRoundingM = 1e-6;

bool fcl_hit(const Object& a, const Object& b) {
  fcl::CollisionRequest<double> request;
  fcl::CollisionResult<double> result;
  return fcl::collide(&a, &b, request, result) > 0;
}

Object make_box(const Box3& box) {
  const Eigen::Vector3d size_m = box.max_m - box.min_m;
  const Eigen::Vector3d centre_m = 0.5 * (box.min_m + box.max_m);
  return {std::make_shared<fcl::Boxd>(size_m), Eigen::Matrix3d::Identity(), centre_m};
}

}  // namespace

struct CollisionMonitor::Geometry {
  std::vector<Object> bodies;
  std::vector<Object> obstacles;
  std::vector<Box3> boxes;
  std::vector<Object> walls;  ///< half-spaces outside the bounds
};

CollisionMonitor::CollisionMonitor(const World& world, const std::vector<Body>& bodies,
                                   double separation_m)
    : world_(world),
      separation_m_(separation_m),
      geometry_(std::make_unique<Geometry>()),
      min_separation_m_(std::numeric_limits<double>::infinity()) {
  for (std::size_t k = 0; k < world_.obstacles.size(); ++k) {
    geometry_->boxes.push_back(box_of(world_.obstacles[k]));
    geometry_->obstacles.push_back(make_box(geometry_->boxes.back()));
    obstacle_names_.push_back("obstacle:" + std::to_string(k));
  }
  // A half-space is {x : n·x ≤ d}.
  const Eigen::Vector2d& low_m = world_.bounds.min_m;
  const Eigen::Vector2d& high_m = world_.bounds.max_m;
  const std::array<std::pair<Eigen::Vector3d, double>, 5> outside{
      {{Eigen::Vector3d::UnitX(), low_m.x()},
       {Eigen::Vector3d::UnitY(), low_m.y()},
       {-Eigen::Vector3d::UnitX(), -high_m.x()},
       {-Eigen::Vector3d::UnitY(), -high_m.y()},
       {-Eigen::Vector3d::UnitZ(), -world_.ceiling_m}}};
  for (const auto& [normal, offset_m] : outside) {
    geometry_->walls.emplace_back(std::make_shared<fcl::Halfspaced>(normal, offset_m));
  }
  for (const Body& body : bodies) {
    add(body);
  }
}

void CollisionMonitor::add(const Body& body) {
  require(std::isfinite(body.radius_m) && body.radius_m > 0.0,
          "body " + body.name + ": radius_m must be positive");
  geometry_->bodies.emplace_back(std::make_shared<fcl::Sphered>(body.radius_m));
  pairs_.resize(pairs_.size() + bodies_.size());
  obstacles_.resize(obstacles_.size() + world_.obstacles.size());
  bounds_.emplace_back();
  bodies_.push_back(body);
  if (!old_m_.empty()) {
    old_m_.push_back(Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
  }
}

CollisionMonitor::~CollisionMonitor() = default;

void CollisionMonitor::update(Time now, std::span<const Eigen::Vector3d> centres_m,
                              std::vector<CollisionReport>& new_contacts) {
  require(centres_m.size() == bodies_.size(),
          "the number of centres must equal the number of bodies");
  new_m_.assign(centres_m.begin(), centres_m.end());
  if (old_m_.empty()) {
    old_m_ = new_m_;
  }
  for (std::size_t i = 0; i < new_m_.size(); ++i) {
    if (!new_m_[i].allFinite()) {
      ++non_finite_;
      continue;
    }
    if (!old_m_[i].allFinite()) {
      old_m_[i] = new_m_[i];
    }
    geometry_->bodies[i].setTranslation(new_m_[i]);
    geometry_->bodies[i].computeAABB();
  }
  check_pairs(now, new_contacts);
  for (std::size_t i = 0; i < new_m_.size(); ++i) {
    if (new_m_[i].allFinite()) {
      check_surroundings(now, i, new_contacts);
    }
  }
  old_m_.swap(new_m_);
}

double CollisionMonitor::check_distance_m() const {
  double radius_m = 0.0;
  double travelled_m = 0.0;
  int robots = 0;
  // Distance between an arbitrary pair of robots: an upper bound of the smallest distance. Because
  // of this bound, the first call does not have to check all pairs.
  double some_pair_m = min_separation_m_;
  std::size_t last = 0;
  for (std::size_t i = 0; i < new_m_.size(); ++i) {
    radius_m = std::max(radius_m, bodies_[i].radius_m);
    if (bodies_[i].is_robot && new_m_[i].allFinite()) {
      if (robots > 0) {
        some_pair_m = std::min(some_pair_m, (new_m_[i] - new_m_[last]).norm());
      }
      last = i;
      ++robots;
    }
    if (new_m_[i].allFinite()) {
      travelled_m = std::max(travelled_m, (new_m_[i] - old_m_[i]).norm());
    }
  }
  // Pairs that stay farther apart than min_separation_m_ during the complete step do not affect the
  // result.
  const double separation_m = robots < 2 ? 0.0 : std::max(some_pair_m, separation_m_ + kReleaseM);
  return std::max(2.0 * radius_m + kReleaseM, separation_m) + 2.0 * travelled_m + kRoundingM;
}

void CollisionMonitor::check_pairs(Time now, std::vector<CollisionReport>& new_contacts) {
  const std::vector<NearPairs::Pair>& near = near_.find(new_m_, check_distance_m());
  candidates_.clear();
  std::set_union(near.begin(), near.end(), in_contact_.begin(), in_contact_.end(),
                 std::back_inserter(candidates_));
  in_contact_.clear();
  for (const auto& [i, j] : candidates_) {
    if (new_m_[i].allFinite() && new_m_[j].allFinite()) {
      check_pair(now, i, j, new_contacts);
    }
    const Contact& contact = pairs_[std::size_t{j} * (j - 1) / 2 + i];
    if (contact.touching || contact.too_near) {
      in_contact_.emplace_back(i, j);
    }
  }
}

void CollisionMonitor::check_pair(Time now, std::size_t i, std::size_t j,
                                  std::vector<CollisionReport>& new_contacts) {
  const std::size_t pair = j * (j - 1) / 2 + i;
  const double radii_m = bodies_[i].radius_m + bodies_[j].radius_m;
  const double apart_m = closest_approach_m(old_m_[i], new_m_[i], old_m_[j], new_m_[j]);
  const ContactCheck check{fcl_hit(geometry_->bodies[i], geometry_->bodies[j]),
                           (new_m_[i] - new_m_[j]).norm() - radii_m, apart_m - radii_m};
  update_contact(now, check, bodies_[i].name, bodies_[j].name, pairs_[pair], new_contacts);
  if (bodies_[i].is_robot && bodies_[j].is_robot) {
    check_separation(now, i, j, apart_m, pairs_[pair], new_contacts);
  }
}

void CollisionMonitor::check_surroundings(Time now, std::size_t i,
                                          std::vector<CollisionReport>& new_contacts) {
  const double radius_m = bodies_[i].radius_m;
  const double travelled_m = (new_m_[i] - old_m_[i]).norm();
  for (std::size_t k = 0; k < geometry_->boxes.size(); ++k) {
    ContactCheck check;
    check.fcl_hit = fcl_hit(geometry_->bodies[i], geometry_->obstacles[k]);
    check.distance_m = signed_distance_m(geometry_->boxes[k], new_m_[i]) - radius_m;
    check.swept_distance_m =
        check.distance_m > travelled_m
            ? check.distance_m
            : swept_distance_m(geometry_->boxes[k], old_m_[i], new_m_[i]) - radius_m;
    update_contact(now, check, bodies_[i].name, obstacle_names_[k],
                   obstacles_[i * geometry_->boxes.size() + k], new_contacts);
  }
  ContactCheck check;
  for (const Object& wall : geometry_->walls) {
    check.fcl_hit = fcl_hit(geometry_->bodies[i], wall) || check.fcl_hit;
  }
  check.distance_m = distance_to_bounds_m(world_, new_m_[i]) - radius_m;
  // The space inside the bounds is convex, so a straight motion is nearest to the bounds at one end
  // of the motion.
  check.swept_distance_m =
      std::min(check.distance_m, distance_to_bounds_m(world_, old_m_[i]) - radius_m);
  update_contact(now, check, bodies_[i].name, "bounds", bounds_[i], new_contacts);
}

void CollisionMonitor::update_contact(Time now, const ContactCheck& check, const std::string& a,
                                      const std::string& b, Contact& contact,
                                      std::vector<CollisionReport>& new_contacts) {
  if (check.fcl_hit != (check.distance_m <= 0.0) && std::abs(check.distance_m) > kRoundingM) {
    ++disagreements_;
  }
  const bool hit = check.fcl_hit || check.swept_distance_m <= 0.0;
  if (hit && !contact.touching) {
    CollisionReport report;
    report.stamp.time = now;
    report.kind = CollisionKind::kCollision;
    report.body_a = a;
    report.body_b = b;
    report.distance_m = std::min(check.swept_distance_m, 0.0);
    new_contacts.push_back(std::move(report));
  }
  // The contact ends if the bodies are apart at the end of the step, even if they touched during
  // the step.
  contact.touching = (hit || contact.touching) && check.distance_m <= kReleaseM;
}

void CollisionMonitor::check_separation(Time now, std::size_t i, std::size_t j,
                                        double centres_apart_m, Contact& contact,
                                        std::vector<CollisionReport>& new_contacts) {
  min_separation_m_ = std::min(min_separation_m_, centres_apart_m);
  const bool too_near = centres_apart_m < separation_m_;
  if (too_near && !contact.too_near) {
    CollisionReport report;
    report.stamp.time = now;
    report.kind = CollisionKind::kNearMiss;
    report.body_a = bodies_[i].name;
    report.body_b = bodies_[j].name;
    report.distance_m = centres_apart_m - bodies_[i].radius_m - bodies_[j].radius_m;
    new_contacts.push_back(std::move(report));
  }
  const double now_apart_m = (new_m_[i] - new_m_[j]).norm();
  contact.too_near = (too_near || contact.too_near) && now_apart_m <= separation_m_ + kReleaseM;
}

}  // namespace vantage::models
