#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>

#include <netinet/in.h>
#include <sys/socket.h>

namespace vantage {

/// One datagram from recvmsg(): sender, size, and one ancillary value of type `Ancillary` from the
/// kernel, for example of SO_TIMESTAMPNS or SO_RXQ_OVFL.
template <class Ancillary>
class Reception {
 public:
  /// Receives into `buffer`. `flags` and the mode of the socket determine whether the call blocks.
  Reception(int fd, std::span<std::uint8_t> buffer, int flags)
      : piece_{buffer.data(), buffer.size()} {
    message_.msg_name = &from_;
    message_.msg_namelen = sizeof from_;
    message_.msg_iov = &piece_;
    message_.msg_iovlen = 1;
    message_.msg_control = extra_.data();
    message_.msg_controllen = extra_.size();
    size_ = recvmsg(fd, &message_, flags);
  }
  Reception(const Reception&) = delete;
  Reception& operator=(const Reception&) = delete;
  Reception(Reception&&) = delete;
  Reception& operator=(Reception&&) = delete;
  ~Reception() = default;

  /// Returns the size in bytes; < 0: nothing received, errno is set.
  [[nodiscard]] ssize_t size() const { return size_; }
  [[nodiscard]] const sockaddr_in& from() const { return from_; }

  /// Returns the ancillary value of `type` at SOL_SOCKET; nullopt if there is none.
  [[nodiscard]] std::optional<Ancillary> ancillary(int type) {
    std::optional<Ancillary> out;
    for (cmsghdr* part = CMSG_FIRSTHDR(&message_); part != nullptr;
         part = CMSG_NXTHDR(&message_, part)) {
      if (part->cmsg_level == SOL_SOCKET && part->cmsg_type == type) {
        std::memcpy(&out.emplace(), CMSG_DATA(part), sizeof(Ancillary));
      }
    }
    return out;
  }

 private:
  sockaddr_in from_{};
  iovec piece_;
  alignas(cmsghdr) std::array<std::uint8_t, CMSG_SPACE(sizeof(Ancillary))> extra_{};
  msghdr message_{};
  ssize_t size_ = -1;
};

}  // namespace vantage
