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

// Keys of a trial. They are in a separate folder; logs and scenarios do not contain them.
//
//   ROLE-ID.key     key that this role signs with. 32 bytes; operator: 64, MAC key and public key
//   ROLE-ID.next    as .key, but not used for signing: the next key during a rotation
//   ROLE-ID.old     as .key, but not used for signing: the previous key
//   operator-ID.sign  32 bytes, the seed of the Ed25519 pair; only on operator stations
//
// ID has eight hexadecimal digits and is derived from the key, so a renamed file is detected.

namespace vantage::bus::auth {

inline constexpr std::size_t kMacKeyBytes = 32;
inline constexpr std::size_t kPublicKeyBytes = 32;
inline constexpr std::size_t kSeedBytes = 32;

enum class KeyUse { kSigns, kNext, kOld };
/// Returns the file suffix: "key", "next" or "old".
const char* name_of(KeyUse use);

struct Key {
  std::uint32_t id = 0;
  Role role = Role::kNode;
  KeyUse use = KeyUse::kSigns;
  Secret mac{kMacKeyBytes};
  /// public key; only for the role operator
  std::array<std::uint8_t, kPublicKeyBytes> public_key{};
  std::optional<Secret> signing;  ///< Ed25519 secret key, 64 bytes; only on operator stations
  /// True if this process may sign with the key.
  [[nodiscard]] bool can_sign() const {
    return use == KeyUse::kSigns && (role != Role::kOperator || signing.has_value());
  }
};

/// Returns the first 32 bits of BLAKE2b-128("vantage key" ‖ role ‖ content of ROLE-ID.key).
std::uint32_t key_id(Role role, std::span<const std::uint8_t> file_bytes);
/// Returns the first 32 bits of BLAKE2b-128 of a vehicle's name.
std::uint32_t destination_of(std::string_view robot);

/// Returns a name such as "mocap-0a1b2c3d".
std::string key_name(const Key& key);

/// Keys of a process, loaded once at its start.
class Keyring {
 public:
  /// @throws UsageError when two keys have the same id, or a role has two signing keys.
  void add(Key key);
  [[nodiscard]] const Key* find(std::uint32_t id) const;
  /// Returns the key with which this process signs as `role`; nullptr if there is none.
  [[nodiscard]] const Key* signing(Role role) const;
  [[nodiscard]] const std::vector<Key>& keys() const { return keys_; }

 private:
  std::vector<Key> keys_;
};

/// Returns a new key from the system's random numbers. An operator's key includes the public and
/// the signing key.
Key make_key(Role role);
/// Sets the Ed25519 pair derived from `seed` in an operator's key. Precondition: 32 bytes.
void set_seed(Key& key, std::span<const std::uint8_t> seed);

/// Loads the keys in `folder`. @throws StartupError that names the file and the rule. The folder
/// must exist, belong to this user and not be writable by others. Each file must have mode 0600 or
/// less, the right owner and length, and a name that matches its key. Each role may only have one
/// signing key. Files with other names are ignored.
Keyring load_keyring(const std::string& folder);

/// Writes the key to new files in `folder`. @throws StartupError on failure.
void store_key(const std::string& folder, const Key& key);
/// Creates `folder` (0700) with a key for each role. @throws StartupError when it contains keys.
void make_keys(const std::string& folder);
/// Adds a next key for each role (or for `role` only). Processes accept messages signed with a next
/// key, but do not sign with it.
/// @throws StartupError when there is a next key already.
void begin_rotation(const std::string& folder, std::optional<Role> role);
/// Makes the next key of each role the signing key, and the current signing key an old key.
/// Processes use the changed keys from their next start on.
/// @throws StartupError when no new key exists.
void end_rotation(const std::string& folder, std::optional<Role> role);
/// Removes the key with the id or name `name`. @throws StartupError when there is none.
void revoke_key(const std::string& folder, const std::string& name);

}  // namespace vantage::bus::auth
