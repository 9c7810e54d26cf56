#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "models/world/near_pairs.hpp"
#include "models/world/world.hpp"

namespace vantage::models {

/// Detector of contacts between spheres, boxes, walls and a ceiling, and of robots that are closer
/// to each other than the separation distance.
///
/// Every pair is checked twice per step: by FCL at the current instant, and by closed forms over
/// the straight motion since the last step, so that no contact between two steps is missed. Either
/// check can report a collision; cases in which they differ are counted. A contact is reported
/// once, when it begins. It is reported again only after the two bodies were more than kReleaseM
/// apart.
///
/// Positions come from the simulator's truth or from the mocap system. FCL objects are created in
/// the constructor and by add(). Not copyable; for one thread.
class CollisionMonitor {
 public:
  static constexpr double kReleaseM = 0.02;

  struct Body {
    std::string name;
    double radius_m = 0.0;
    bool is_robot = false;  ///< robots keep separation from each other
  };

  CollisionMonitor(const World& world, const std::vector<Body>& bodies, double separation_m);
  ~CollisionMonitor();
  CollisionMonitor(const CollisionMonitor&) = delete;
  CollisionMonitor& operator=(const CollisionMonitor&) = delete;
  CollisionMonitor(CollisionMonitor&&) = delete;
  CollisionMonitor& operator=(CollisionMonitor&&) = delete;

  /// Adds a body, which becomes the last in the order. Precondition: radius_m > 0.
  void add(const Body& body);
  /// Makes the next update() check positions only, without the motion before it: the bodies were
  /// not observed in between.
  void forget_motion() { old_m_.clear(); }

  /// Checks the bodies at `now`, given their centres (world frame, m) in the order of registration.
  /// Appends contacts that began since the last call to `begun`. A centre that is not finite is
  /// skipped (FCL reports some such poses as free) and counted. The first call has no motion before
  /// it.
  void update(Time now, std::span<const Eigen::Vector3d> centres_m,
              std::vector<ContactReport>& begun);

  /// Returns the minimum distance so far between the centres of two robots, m, over the swept
  /// motion; ∞ with fewer than two robots.
  [[nodiscard]] double min_separation_m() const { return min_separation_m_; }
  [[nodiscard]] std::int64_t non_finite() const { return non_finite_; }
  /// Returns the number of checks in which FCL and the closed form differed by more than rounding
  /// (1 µm).
  [[nodiscard]] std::int64_t disagreements() const { return disagreements_; }

 private:
  struct Geometry;  // keeps FCL out of this header
  struct Contact {
    bool touching = false;
    bool near = false;
  };
  struct Judgement {
    bool fcl_hit = false;
    double distance_m = 0.0;        ///< between surfaces, at the current instant
    double swept_distance_m = 0.0;  ///< minimum since the last step
  };

  void judge(Time now, const Judgement& judgement, const std::string& a, const std::string& b,
             Contact& contact, std::vector<ContactReport>& begun);
  void watch_separation(Time now, std::size_t i, std::size_t j, double centres_apart_m,
                        Contact& contact, std::vector<ContactReport>& begun);
  void check_pairs(Time now, std::vector<ContactReport>& begun);
  void check_pair(Time now, std::size_t i, std::size_t j, std::vector<ContactReport>& begun);
  /// Returns the distance (m) beyond which a pair needs no check, whatever its motion since the
  /// last step.
  [[nodiscard]] double watched_m() const;
  void check_surroundings(Time now, std::size_t i, std::vector<ContactReport>& begun);

  World world_;
  std::vector<Body> bodies_;
  double separation_m_;
  std::unique_ptr<Geometry> geometry_;
  std::vector<Eigen::Vector3d> old_m_;
  std::vector<Eigen::Vector3d> new_m_;
  NearPairs near_;
  std::vector<NearPairs::Pair> candidates_;
  std::vector<NearPairs::Pair> in_contact_;  ///< touching or near at the last step, ascending
  std::vector<Contact> pairs_;               ///< index of i < j: j (j − 1) / 2 + i
  std::vector<Contact> obstacles_;           ///< index: body · number of obstacles + obstacle
  std::vector<Contact> bounds_;              ///< per body
  std::vector<std::string> obstacle_names_;
  double min_separation_m_;
  std::int64_t non_finite_ = 0;
  std::int64_t disagreements_ = 0;
};

}  // namespace vantage::models
