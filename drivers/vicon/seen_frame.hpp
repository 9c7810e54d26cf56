#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/linear.hpp"
#include "core/pose.hpp"
#include "core/time.hpp"

namespace vantage::drivers::vicon {

/// Instant on two clocks: the stack's clock for message content, and a steady clock (with any
/// origin) for ages and timeouts. The steady clock does not change when the stack's clock is set.
struct Moment {
  Time utime{};
  Duration steady{};
};

inline constexpr double kMetresPerMillimetre = 1e-3;  ///< m/mm; Vicon servers use millimetres

/// State of one body in a server's frame.
enum class PoseState {
  kSeen,
  kAbsent,    ///< the body exists, but has no pose in the frame
  kZero,      ///< exact zeros, by which some servers report unseen bodies
  kNotAPose,  ///< not finite, not a rotation, or an impossibly large position
};

struct SeenBody {
  std::string name;
  PoseState pose_state = PoseState::kAbsent;
  Pose3 world_from_body;  ///< m, z up; valid only if the state is kSeen
};

/// Answer to a ping: sending and arrival times by the steady clock.
struct Echo {
  Duration sent{};
  Duration arrived{};
};

/// Frame as the server sent it, not yet checked. Its memory is reused for the next frame.
class SeenFrame {
 public:
  Moment arrival;
  std::optional<std::uint32_t> number;  ///< only in protocols with frame numbers
  /// µs, by the server's clock; only in protocols with stamps
  std::optional<std::int64_t> server_time_us;
  std::optional<double> latency_s;  ///< s; only in protocols that state a latency; not yet checked
  double rate_hz = 0.0;      ///< Hz; rate of the frame numbers stated by the server; 0: not stated
  std::optional<Echo> echo;  ///< newest echo before this frame
  /// Steady time at which the server sent the frame; only if the server's clock is known.
  std::optional<Duration> sent;
  bool is_complete_list = false;  ///< the frame lists all existing bodies

  void clear() { size_ = 0; }
  SeenBody& add();
  [[nodiscard]] std::span<const SeenBody> bodies() const { return std::span(bodies_).first(size_); }
  [[nodiscard]] bool has(std::string_view name) const;

 private:
  std::vector<SeenBody> bodies_;
  std::size_t size_ = 0;
};

/// Sets the state and pose of `body` from a received pose. `rotation` is nullopt if the received
/// numbers were not a rotation. `is_zero`: all received numbers were exactly zero.
void set_pose(SeenBody& body, const Eigen::Vector3d& position_m,
              const std::optional<Quaternion>& rotation, bool is_zero, bool is_y_up);

}  // namespace vantage::drivers::vicon
