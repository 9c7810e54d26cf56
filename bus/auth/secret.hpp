#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace vantage::bus::auth {

/// Initializes libsodium; cheap after the first call. @throws StartupError on failure.
void start_sodium();

/// Secret in its own memory pages. The pages are locked against swapping (as far as RLIMIT_MEMLOCK
/// allows), excluded from core dumps, enclosed by guard pages, and wiped on destruction. Can be
/// moved but not copied. Not for use in loops, because construction needs system calls.
class Secret {
 public:
  /// Creates `size` zero bytes. @throws StartupError when allocation fails.
  explicit Secret(std::size_t size);

  [[nodiscard]] std::span<std::uint8_t> bytes() { return {bytes_.get(), size_}; }
  [[nodiscard]] std::span<const std::uint8_t> bytes() const { return {bytes_.get(), size_}; }

 private:
  struct Wipe {
    void operator()(std::uint8_t* bytes) const;
  };
  std::unique_ptr<std::uint8_t[], Wipe> bytes_;  // NOLINT(modernize-avoid-c-arrays): libsodium
  std::size_t size_ = 0;
};

/// Reads `file` into `out`; `what` names the file in messages ("signing key").
/// @throws StartupError if the file cannot be read, is not a regular file, is a link, has another
/// length than `out`, belongs to another user, or is accessible to other users (mode must be 0600
/// or less). `out` is then wiped.
void read_secret_file(const std::string& file, std::span<std::uint8_t> out,
                      const std::string& what);

/// Creates `file` with mode 0600 and content `bytes`; the data is on disk on return.
/// @throws StartupError when the file exists or cannot be written.
void write_secret_file(const std::string& file, std::span<const std::uint8_t> bytes);

}  // namespace vantage::bus::auth
