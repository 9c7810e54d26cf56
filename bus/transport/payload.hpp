#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

namespace vantage::bus {

/// Decoded message of bytes that several subscribers share: the first subscriber decodes the bytes
/// for all subscribers. Thread-safe.
class Decoded {
 public:
  /// Returns the decoded message; null when the bytes were not decoded yet, or were decoded to
  /// another type.
  template <class Message>
  [[nodiscard]] std::shared_ptr<const Message> get() const {
    const std::lock_guard lock(mutex_);
    return kind_ == kind_of<Message>() ? std::static_pointer_cast<const Message>(message_)
                                       : nullptr;
  }
  template <class Message>
  void keep(std::shared_ptr<const Message> message) {
    const std::lock_guard lock(mutex_);
    kind_ = kind_of<Message>();
    message_ = std::move(message);
  }

 private:
  template <class Message>
  static const void* kind_of() {
    static constexpr char kKind = 0;
    return &kKind;  // a distinct address for each type
  }

  mutable std::mutex mutex_;
  const void* kind_ = nullptr;
  std::shared_ptr<const void> message_;
};

/// Bytes of a message as a handler receives them.
struct Payload : std::span<const std::uint8_t> {
  Payload(std::span<const std::uint8_t> bytes, Decoded* decoded_once = nullptr)  // NOLINT: implicit
      : std::span<const std::uint8_t>(bytes), decoded(decoded_once) {}
  Payload(const std::vector<std::uint8_t>& bytes)  // NOLINT: implicit
      : Payload(std::span<const std::uint8_t>(bytes)) {}

  Decoded* decoded = nullptr;  ///< null: the bytes are not shared
  std::uint64_t source = 0;    ///< sender's address and port, as far as visible; 0: unknown
};

}  // namespace vantage::bus
