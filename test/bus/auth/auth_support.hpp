#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "bus/auth/authenticator.hpp"
#include "bus/auth/keyring.hpp"
#include "test/support/temporary_folder.hpp"

namespace vantage::test {

/// Returns a key whose bytes are `first`, `first` + 1, …; the operator's seed is the next 32 bytes.
inline bus::auth::Key key_of(bus::auth::Role role, std::uint8_t first) {
  bus::auth::Key key;
  key.role = role;
  std::iota(key.mac.bytes().begin(), key.mac.bytes().end(), first);
  std::vector<std::uint8_t> contents(key.mac.bytes().begin(), key.mac.bytes().end());
  if (role == bus::auth::Role::kOperator) {
    std::vector<std::uint8_t> seed(bus::auth::kSeedBytes);
    std::iota(seed.begin(), seed.end(), static_cast<std::uint8_t>(first + 32));
    bus::auth::set_seed(key, seed);
    contents.insert(contents.end(), key.public_key.begin(), key.public_key.end());
  }
  key.id = bus::auth::key_id(role, contents);
  return key;
}

/// Returns one key of each role, with the signing seeds. Another `shift` gives another trial's
/// keys.
inline std::shared_ptr<const bus::auth::Keyring> keys_of_a_trial(std::uint8_t shift = 0) {
  auto out = std::make_shared<bus::auth::Keyring>();
  for (const bus::auth::Role role : bus::auth::kRoles) {
    out->add(key_of(role, static_cast<std::uint8_t>(shift + 40 * static_cast<int>(role))));
  }
  return out;
}

inline std::unique_ptr<bus::auth::Authenticator> authenticator(
    const std::shared_ptr<const bus::auth::Keyring>& keys,
    const bus::auth::Authenticator::Rules& rules = {}) {
  return std::make_unique<bus::auth::Authenticator>(keys, rules);
}

}  // namespace vantage::test
