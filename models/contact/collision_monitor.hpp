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

/// Detects contacts between spheres, boxes, walls and a ceiling, and robots that are nearer to each
/// other than allowed.
///
/// Two methods check every pair at every step: the FCL library at the current positions, and
/// closed-form distances over the straight motion since the last step. The closed forms detect
/// contacts that begin and end within a step. Either method can report a collision; differences
/// between the two are counted. A contact is reported once, when it begins. The same two bodies are
/// reported again only after they have been more than kReleaseM apart.
///
/// Positions come from the simulator's truth or from the cameras. FCL objects are created in the
/// constructor and by add(). Not copyable, not thread-safe.
class CollisionMonitor {
 public:
  static constexpr double kReleaseM = 0.02;

  struct Body {
    std::string name;
    double radius_m = 0.0;
    bool is_robot = false;  ///< true: must keep separation from other robots
  };

  CollisionMonitor(const World& world, const std::vector<Body>& bodies, double separation_m);
  ~CollisionMonitor();
  CollisionMonitor(const CollisionMonitor&) = delete;
  CollisionMonitor& operator=(const CollisionMonitor&) = delete;
  CollisionMonitor(CollisionMonitor&&) = delete;
  CollisionMonitor& operator=(CollisionMonitor&&) = delete;

  /// Appends a body to the list of bodies. Precondition: radius_m > 0.
  void add(const Body& body);
  /// Makes the next update() check positions only, without the motion since the last update(). Call
  /// this function after a time in which the bodies were not observed.
  void forget_motion() { old_m_.clear(); }

  /// Checks the bodies' centres at `now`, in the order in which the bodies were added. Appends the
  /// contacts that began since the last call to `new_contacts`. A centre that is not finite is
  /// counted and excluded, because FCL reports some such poses as collision-free. The first call
  /// checks positions only.
  void update(Time now, std::span<const Eigen::Vector3d> centres_m,
              std::vector<CollisionReport>& new_contacts);

  /// Returns the smallest distance so far between the centres of two robots, including the motion
  /// between steps; ∞ without a pair.
  [[nodiscard]] double min_separation_m() const { return min_separation_m_; }
  [[nodiscard]] std::int64_t non_finite() const { return non_finite_; }
  /// Returns how often FCL and the closed form differed by more than rounding (1 µm).
  [[nodiscard]] std::int64_t disagreements() const { return disagreements_; }

 private:
  struct Geometry;  // defined in the source file, so that this header does not include FCL
  struct Contact {
    bool touching = false;
    bool too_near = false;
  };
  struct ContactCheck {
    bool fcl_hit = false;
    double distance_m = 0.0;        ///< m; distance between the surfaces at the current step
    double swept_distance_m = 0.0;  ///< smallest distance since the last step
  };

  void update_contact(Time now, const ContactCheck& check, const std::string& a,
                      const std::string& b, Contact& contact,
                      std::vector<CollisionReport>& new_contacts);
  void check_separation(Time now, std::size_t i, std::size_t j, double centres_apart_m,
                        Contact& contact, std::vector<CollisionReport>& new_contacts);
  void check_pairs(Time now, std::vector<CollisionReport>& new_contacts);
  void check_pair(Time now, std::size_t i, std::size_t j,
                  std::vector<CollisionReport>& new_contacts);
  /// Returns the distance beyond which a pair cannot have been in contact or too close since the
  /// last step.
  [[nodiscard]] double check_distance_m() const;
  void check_surroundings(Time now, std::size_t i, std::vector<CollisionReport>& new_contacts);

  World world_;
  std::vector<Body> bodies_;
  double separation_m_;
  std::unique_ptr<Geometry> geometry_;
  std::vector<Eigen::Vector3d> old_m_;
  std::vector<Eigen::Vector3d> new_m_;
  NearPairs near_;
  std::vector<NearPairs::Pair> candidates_;
  std::vector<NearPairs::Pair>
      in_contact_;              ///< pairs that touched or were too near at the last step, ascending
  std::vector<Contact> pairs_;  ///< pair i < j has the index j (j − 1) / 2 + i
  std::vector<Contact> obstacles_;  ///< index: body · number of obstacles + obstacle
  std::vector<Contact> bounds_;     ///< contact of each body with the bounds
  std::vector<std::string> obstacle_names_;
  double min_separation_m_;
  std::int64_t non_finite_ = 0;
  std::int64_t disagreements_ = 0;
};

}  // namespace vantage::models
