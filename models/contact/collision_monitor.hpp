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

/// Watches spheres among boxes, walls and a ceiling for contact, and flying robots for being
/// nearer to each other than they may.
///
/// Two judges look at every pair at every step: FCL at the instant, and closed forms over the
/// straight motion since the last step, so that nothing tunnels. Either can report a collision;
/// instants at which they differ are counted. A contact is reported once, when it begins, and
/// again only after the two have been apart by more than kReleaseM.
///
/// What it is told of is the simulator's truth or what cameras see. FCL objects are made in the
/// constructor and by add(). Not copyable; one thread.
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

  /// One more body, the last in the order from now on. Precondition: radius_m > 0.
  void add(const Body& body);
  /// The next update() has no motion before it: nobody saw how the bodies got there.
  void forget_motion() { old_m_.clear(); }

  /// The bodies' centres at `now`, in the order they were told; appends what has begun since the
  /// last call to `begun`. A centre that is not finite takes no part (FCL calls some such poses
  /// free) and is counted. The first call has no motion before it.
  void update(Time now, std::span<const Eigen::Vector3d> centres_m,
              std::vector<ContactReport>& begun);

  /// Least distance so far between the centres of two robots, swept; ∞ before there were two.
  [[nodiscard]] double min_separation_m() const { return min_separation_m_; }
  [[nodiscard]] std::int64_t non_finite() const { return non_finite_; }
  /// Instants at which FCL and the closed form differed by more than rounding (1 µm).
  [[nodiscard]] std::int64_t disagreements() const { return disagreements_; }

 private:
  struct Geometry;  // keeps FCL out of this header
  struct Contact {
    bool touching = false;
    bool near = false;
  };
  struct Judgement {
    bool fcl_hit = false;
    double distance_m = 0.0;        ///< between surfaces, at the instant
    double swept_distance_m = 0.0;  ///< the least since the last step
  };

  void judge(Time now, const Judgement& judgement, const std::string& a, const std::string& b,
             Contact& contact, std::vector<ContactReport>& begun);
  void watch_separation(Time now, std::size_t i, std::size_t j, double centres_apart_m,
                        Contact& contact, std::vector<ContactReport>& begun);
  void check_pairs(Time now, std::vector<ContactReport>& begun);
  void check_pair(Time now, std::size_t i, std::size_t j, std::vector<ContactReport>& begun);
  /// Pairs farther apart than this are no matter, whatever they did since the last step.
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
  std::vector<Contact> pairs_;               ///< i < j: j (j − 1) / 2 + i
  std::vector<Contact> obstacles_;           ///< body · obstacles + obstacle
  std::vector<Contact> bounds_;              ///< per body
  std::vector<std::string> obstacle_names_;
  double min_separation_m_;
  std::int64_t non_finite_ = 0;
  std::int64_t disagreements_ = 0;
};

}  // namespace vantage::models
