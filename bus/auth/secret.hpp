#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace vantage::bus::auth {

/// Makes libsodium ready; cheap when it is. @throws StartupError when it cannot be.
void start_sodium();

/// A secret in memory of its own: never swapped out (as far as RLIMIT_MEMLOCK lets it), in no core
/// dump, between guard pages, and wiped at its end. Moved, not copied. Not for loops: making one
/// takes system calls.
class Secret {
 public:
  /// `size` zeros. @throws StartupError when there is no memory.
  explicit Secret(std::size_t size);

  [[nodiscard]] std::span<std::uint8_t> bytes() { return {bytes_.get(), size_}; }
  [[nodiscard]] std::span<const std::uint8_t> bytes() const { return {bytes_.get(), size_}; }

 private:
  struct Wipe {
    void operator()(std::uint8_t* bytes) const;
  };
  std::unique_ptr<std::uint8_t[], Wipe> bytes_;  // NOLINT(modernize-avoid-c-arrays): libsodium's
  std::size_t size_ = 0;
};

/// Fills `out` from `file`; `what` names it in messages ("signing key").
/// @throws StartupError for a file that cannot be read, is a link or no file, is not exactly as
/// long as `out`, belongs to another user, or may be read or changed by others (its mode must be
/// 0600 or less). `out` is wiped then.
void read_secret_file(const std::string& file, std::span<std::uint8_t> out,
                      const std::string& what);

/// Makes `file`, mode 0600, with `bytes` in it, on the disk when it returns.
/// @throws StartupError when it is there already or cannot be written.
void write_secret_file(const std::string& file, std::span<const std::uint8_t> bytes);

}  // namespace vantage::bus::auth
