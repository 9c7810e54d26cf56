#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

namespace vantage::tools {

/// Outgoing WebSocket message to one client. The body is shared with other clients.
struct Frame {
  enum class Kind : std::uint8_t {
    kControl,  ///< control message, never dropped
    kState,    ///< replaced by a newer frame of the same subscription
    kFlow,     ///< dropped when the queue is full, the oldest first
  };
  Kind kind = Kind::kControl;
  bool is_text = false;
  std::uint32_t subscription_id = 0;  ///< subscription of a kState frame
  std::string head;
  std::shared_ptr<const std::string> body;  ///< null: the frame consists of `head` only

  [[nodiscard]] std::size_t size() const { return head.size() + (body ? body->size() : 0); }
};

/// Bounded queue of the frames for one client. A client that is too slow loses the oldest flow
/// frames and outdated states, but never a control message. Not thread-safe.
class Outbox {
 public:
  /// @param bytes_max   maximum size of all flow frames together; the newest is always kept
  /// @param control_max number of waiting control messages above which is_overflowing() is true
  explicit Outbox(std::size_t bytes_max = 8U << 20U, std::size_t control_max = 4096)
      : bytes_max_(bytes_max), control_max_(control_max) {}

  void push(Frame frame);
  /// Removes and returns the oldest frame; nullopt if there is none.
  std::optional<Frame> pop();

  [[nodiscard]] bool empty() const { return frames_.empty(); }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  /// Returns the number of flow frames dropped since the start.
  [[nodiscard]] std::int64_t dropped() const { return dropped_; }
  /// True if more than control_max control messages wait.
  [[nodiscard]] bool is_overflowing() const { return control_waiting_ > control_max_; }

 private:
  void make_room();

  std::size_t bytes_max_;
  std::size_t control_max_;
  std::deque<Frame> frames_;
  std::size_t bytes_ = 0;       ///< bytes; size of all frames
  std::size_t flow_bytes_ = 0;  ///< bytes; size of the flow frames
  std::size_t control_waiting_ = 0;
  std::int64_t dropped_ = 0;
};

}  // namespace vantage::tools
