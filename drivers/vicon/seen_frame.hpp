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

/// An instant on both clocks: the stack's, for content, and a steady one (since any start), for
/// ages and time-outs, which a step of the first must not disturb.
struct Moment {
  Time utime{};
  Duration steady{};
};

inline constexpr double kMetresPerMillimetre = 1e-3;  ///< servers of Vicon speak of millimetres

/// What a server said of one body.
enum class Sight {
  kSeen,
  kAbsent,    ///< it exists, but the frame has no pose of it
  kZero,      ///< a pose that is exactly nothing: some servers' word for "not seen"
  kNotAPose,  ///< not finite, not a rotation, or beyond any room
};

struct SeenBody {
  std::string name;
  Sight sight = Sight::kAbsent;
  Pose3 world_from_body;  ///< z up, metres; of a seen one
};

/// The answer to a ping, by the steady clock.
struct Echo {
  Duration sent{};
  Duration arrived{};
};

/// One frame as a server sent it, before any judgement. Its memory is reused from frame to frame.
class SeenFrame {
 public:
  Moment arrival;
  std::optional<std::uint32_t> number;         ///< of protocols that number their frames
  std::optional<std::int64_t> server_time_us;  ///< of those that stamp them, by the server's clock
  std::optional<double> latency_s;             ///< of protocols that tell; not yet believed
  double rate_hz = 0.0;      ///< at which numbers count, by the server's word; 0: not stated
  std::optional<Echo> echo;  ///< newest one that arrived before this frame, behind earlier ones
  bool is_complete_list = false;  ///< a body not in it does not exist any more

  void clear() { size_ = 0; }
  SeenBody& add();
  [[nodiscard]] std::span<const SeenBody> bodies() const { return std::span(bodies_).first(size_); }
  [[nodiscard]] bool has(std::string_view name) const;

 private:
  std::vector<SeenBody> bodies_;
  std::size_t size_ = 0;
};

/// Turns what is on the wire into a body's sight: of a pose with `rotation` absent when it was
/// none. `is_zero`: every number of it was exactly nothing.
void set_pose(SeenBody& body, const Eigen::Vector3d& position_m,
              const std::optional<Quaternion>& rotation, bool is_zero, bool is_y_up);

}  // namespace vantage::drivers::vicon
