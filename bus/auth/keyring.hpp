#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bus/auth/secret.hpp"
#include "bus/auth/trailer.hpp"

// The keys of a trial, in a folder of their own that no log and no scenario ever holds:
//
//   ROLE-ID.key     what this role signs with. 32 bytes; of the operator 64: MAC key, public key
//   ROLE-ID.next    the same, accepted only: what it will sign with, while keys are rotated
//   ROLE-ID.old     the same, accepted only: what it signed with before
//   operator-ID.sign  32 bytes, the seed of the Ed25519 pair: on operator stations alone
//
// ID is eight hexadecimal digits, made of the key, so a file that was renamed is noticed.

namespace vantage::bus::auth {

inline constexpr std::size_t kMacKeyBytes = 32;
inline constexpr std::size_t kPublicKeyBytes = 32;
inline constexpr std::size_t kSeedBytes = 32;

enum class KeyUse { kSigns, kNext, kOld };
/// "key", "next", "old": as files are called.
const char* name_of(KeyUse use);

struct Key {
  std::uint32_t id = 0;
  Role role = Role::kNode;
  KeyUse use = KeyUse::kSigns;
  Secret mac{kMacKeyBytes};
  std::array<std::uint8_t, kPublicKeyBytes> public_key{};  ///< of the operator
  std::optional<Secret> signing;  ///< 64 bytes, Ed25519's secret key: an operator station's
  /// Whether this process may sign with it.
  [[nodiscard]] bool can_sign() const {
    return use == KeyUse::kSigns && (role != Role::kOperator || signing.has_value());
  }
};

/// The first 32 bits of BLAKE2b-128("vantage key" ‖ role ‖ what the file ROLE-ID.key holds).
std::uint32_t key_id(Role role, std::span<const std::uint8_t> file_bytes);
/// The first 32 bits of BLAKE2b-128 of a vehicle's name.
std::uint32_t destination_of(std::string_view robot);

/// "mocap-0a1b2c3d".
std::string key_name(const Key& key);

/// The keys that a process knows. Cheap to look into, made once at start.
class Keyring {
 public:
  /// @throws UsageError for two keys of one id, or two that one role signs with.
  void add(Key key);
  [[nodiscard]] const Key* find(std::uint32_t id) const;
  /// What this process signs with as `role`; nullptr: nothing.
  [[nodiscard]] const Key* signing(Role role) const;
  [[nodiscard]] const std::vector<Key>& keys() const { return keys_; }

 private:
  std::vector<Key> keys_;
};

/// A new key from the system's random numbers; an operator's with both halves.
Key make_key(Role role);
/// The Ed25519 pair of `seed` put into an operator's key. Precondition: 32 bytes.
void set_seed(Key& key, std::span<const std::uint8_t> seed);

/// Reads the folder. @throws StartupError naming the file and the rule: the folder is missing, is
/// another's or may be changed by others; a file is not 0600 or not ours, has the wrong length, is
/// not what its name says; one role signs with two keys. Files of other names are left alone.
Keyring load_keyring(const std::string& folder);

/// Writes the key as new files into `folder`. @throws StartupError when it cannot.
void store_key(const std::string& folder, const Key& key);
/// Makes `folder` (0700) with a key of each role in it. @throws StartupError when it has keys.
void make_keys(const std::string& folder);
/// A key more of each role (or of one), accepted everywhere before anybody signs with it.
/// @throws StartupError when there is one already.
void begin_rotation(const std::string& folder, std::optional<Role> role);
/// From the next start on each role signs with its new key, and accepts the one before.
/// @throws StartupError when there is no new key.
void end_rotation(const std::string& folder, std::optional<Role> role);
/// Removes the key of that id, or of that name. @throws StartupError when there is none.
void revoke_key(const std::string& folder, const std::string& name);

}  // namespace vantage::bus::auth
