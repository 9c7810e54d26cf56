#include "bus/auth/keyring.hpp"

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <sodium.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/check.hpp"

namespace vantage::bus::auth {
namespace {

namespace fs = std::filesystem;

constexpr std::array kUses{KeyUse::kSigns, KeyUse::kNext, KeyUse::kOld};
constexpr const char* kSeedSuffix = ".sign";

static_assert(kMacKeyBytes == crypto_generichash_KEYBYTES);
static_assert(kPublicKeyBytes == crypto_sign_ed25519_PUBLICKEYBYTES);
static_assert(kSeedBytes == crypto_sign_ed25519_SEEDBYTES);

std::uint32_t first_32_bits(const std::array<std::uint8_t, 16>& hash) {
  return static_cast<std::uint32_t>(hash[0]) << 24U | static_cast<std::uint32_t>(hash[1]) << 16U |
         static_cast<std::uint32_t>(hash[2]) << 8U | hash[3];
}

std::size_t file_bytes_of(Role role) {
  return role == Role::kOperator ? kMacKeyBytes + kPublicKeyBytes : kMacKeyBytes;
}

/// Returns the bytes of the key's file.
Secret contents_of(const Key& key) {
  Secret out(file_bytes_of(key.role));
  std::copy(key.mac.bytes().begin(), key.mac.bytes().end(), out.bytes().begin());
  if (key.role == Role::kOperator) {
    std::copy(key.public_key.begin(), key.public_key.end(),
              out.bytes().begin() + static_cast<std::ptrdiff_t>(kMacKeyBytes));
  }
  return out;
}

/// Parts of a key's file name. parse_name() returns nullopt for other files.
struct FileName {
  Role role;
  std::uint32_t id;
  KeyUse use;
};
std::optional<FileName> parse_name(const fs::path& path) {
  const std::string stem = path.stem().string();
  const std::size_t dash = stem.find('-');
  if (dash == std::string::npos || stem.size() != dash + 9 ||
      stem.find_first_not_of("0123456789abcdef", dash + 1) != std::string::npos) {
    return std::nullopt;
  }
  for (const Role role : kRoles) {
    for (const KeyUse use : kUses) {
      if (stem.substr(0, dash) == name_of(role) &&
          path.extension() == std::string(".") + name_of(use)) {
        return FileName{
            role, static_cast<std::uint32_t>(std::stoul(stem.substr(dash + 1), nullptr, 16)), use};
      }
    }
  }
  return std::nullopt;
}

void check_folder(const std::string& folder) {
  struct stat status {};
  if (stat(folder.c_str(), &status) != 0 || !S_ISDIR(status.st_mode)) {
    throw StartupError(folder + ": no such folder of keys; create it: vantage keys new " + folder);
  }
  if (status.st_uid != geteuid() || (status.st_mode & (S_IWGRP | S_IWOTH)) != 0) {
    throw StartupError(
        folder + ": other users may change this folder of keys; it must belong to this user; " +
        "chmod 700 " + folder);
  }
}

Key read_key(const fs::path& path, const FileName& name) {
  Key key;
  key.role = name.role;
  key.use = name.use;
  Secret contents(file_bytes_of(name.role));
  read_secret_file(path.string(), contents.bytes(), "key");
  std::copy_n(contents.bytes().begin(), kMacKeyBytes, key.mac.bytes().begin());
  if (name.role == Role::kOperator) {
    std::copy_n(contents.bytes().begin() + static_cast<std::ptrdiff_t>(kMacKeyBytes),
                kPublicKeyBytes, key.public_key.begin());
  }
  key.id = key_id(name.role, contents.bytes());
  if (key.id != name.id) {
    throw StartupError(
        fmt::format("{}: the file contains the key {}, but its name contains another key",
                    path.string(), key_name(key)));
  }
  const fs::path seed_path = fs::path(path).replace_extension(kSeedSuffix);
  if (name.role == Role::kOperator && fs::exists(fs::symlink_status(seed_path))) {
    Secret seed(kSeedBytes);
    read_secret_file(seed_path.string(), seed.bytes(), "operator's seed");
    const auto expected = key.public_key;
    set_seed(key, seed.bytes());
    if (key.public_key != expected) {
      throw StartupError(seed_path.string() + ": does not belong to " + path.string());
    }
  }
  return key;
}

fs::path path_of(const std::string& folder, const Key& key) {
  return fs::path(folder) / (key_name(key) + "." + name_of(key.use));
}

void move_file(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::rename(from, to, error);
  if (error) {
    throw StartupError(from.string() + ": cannot be renamed to " + to.string() + ": " +
                       error.message());
  }
}

bool is_meant(const Key& key, std::optional<Role> role) { return !role || key.role == *role; }

}  // namespace

const char* name_of(KeyUse use) {
  switch (use) {
    case KeyUse::kSigns:
      return "key";
    case KeyUse::kNext:
      return "next";
    case KeyUse::kOld:
      return "old";
  }
  return "unknown";
}

std::uint32_t key_id(Role role, std::span<const std::uint8_t> file_bytes) {
  start_sodium();
  constexpr std::string_view kDomain = "vantage key";
  std::array<std::uint8_t, 16> hash{};
  crypto_generichash_state state;
  crypto_generichash_init(&state, nullptr, 0, hash.size());
  crypto_generichash_update(&state, reinterpret_cast<const unsigned char*>(kDomain.data()),
                            kDomain.size());
  const auto number = static_cast<std::uint8_t>(role);
  crypto_generichash_update(&state, &number, 1);
  crypto_generichash_update(&state, file_bytes.data(), file_bytes.size());
  crypto_generichash_final(&state, hash.data(), hash.size());
  sodium_memzero(&state, sizeof state);
  return first_32_bits(hash);
}

std::uint32_t destination_of(std::string_view robot) {
  start_sodium();
  std::array<std::uint8_t, 16> hash{};
  crypto_generichash(hash.data(), hash.size(), reinterpret_cast<const unsigned char*>(robot.data()),
                     robot.size(), nullptr, 0);
  return first_32_bits(hash);
}

std::string key_name(const Key& key) { return fmt::format("{}-{:08x}", name_of(key.role), key.id); }

void Keyring::add(Key key) {
  for (const Key& known : keys_) {
    require(known.id != key.id, "two keys have the same id: " + key_name(key));
    require(known.role != key.role || known.use != KeyUse::kSigns || key.use != KeyUse::kSigns,
            fmt::format("the role {} has two signing keys, {} and {}; rename one to .next or .old",
                        name_of(key.role), key_name(known), key_name(key)));
  }
  keys_.push_back(std::move(key));
}

const Key* Keyring::find(std::uint32_t id) const {
  const auto found =
      std::find_if(keys_.begin(), keys_.end(), [id](const Key& key) { return key.id == id; });
  return found == keys_.end() ? nullptr : &*found;
}

const Key* Keyring::signing(Role role) const {
  const auto found = std::find_if(keys_.begin(), keys_.end(), [role](const Key& key) {
    return key.role == role && key.can_sign();
  });
  return found == keys_.end() ? nullptr : &*found;
}

Key make_key(Role role) {
  start_sodium();
  Key key;
  key.role = role;
  randombytes_buf(key.mac.bytes().data(), key.mac.bytes().size());
  if (role == Role::kOperator) {
    Secret seed(kSeedBytes);
    randombytes_buf(seed.bytes().data(), seed.bytes().size());
    set_seed(key, seed.bytes());
  }
  key.id = key_id(role, contents_of(key).bytes());
  return key;
}

void set_seed(Key& key, std::span<const std::uint8_t> seed) {
  assert(seed.size() == kSeedBytes);
  key.signing.emplace(crypto_sign_ed25519_SECRETKEYBYTES);
  crypto_sign_ed25519_seed_keypair(key.public_key.data(), key.signing->bytes().data(), seed.data());
}

Keyring load_keyring(const std::string& folder) {
  check_folder(folder);
  std::vector<fs::path> paths;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    paths.push_back(entry.path());
  }
  if (error) {
    throw StartupError(folder + ": cannot read the folder of keys: " + error.message());
  }
  std::sort(paths.begin(), paths.end());
  Keyring keyring;
  for (const fs::path& path : paths) {
    if (const auto name = parse_name(path)) {
      try {
        keyring.add(read_key(path, *name));
      } catch (const UsageError& fault) {
        throw StartupError(path.string() + ": " + fault.what());
      }
    }
  }
  return keyring;
}

void store_key(const std::string& folder, const Key& key) {
  const fs::path path = path_of(folder, key);
  write_secret_file(path.string(), contents_of(key).bytes());
  if (key.signing) {
    Secret seed(kSeedBytes);
    crypto_sign_ed25519_sk_to_seed(seed.bytes().data(), key.signing->bytes().data());
    write_secret_file(fs::path(path).replace_extension(kSeedSuffix).string(), seed.bytes());
  }
}

void make_keys(const std::string& folder) {
  if (mkdir(folder.c_str(), S_IRWXU) != 0 && errno != EEXIST) {
    throw StartupError(folder + ": cannot be created: " + std::system_category().message(errno));
  }
  if (!load_keyring(folder).keys().empty()) {
    throw StartupError(
        folder + ": the folder has keys already; to replace them: vantage keys rotate " + folder);
  }
  for (const Role role : kRoles) {
    store_key(folder, make_key(role));
  }
}

void begin_rotation(const std::string& folder, std::optional<Role> role) {
  const Keyring keyring = load_keyring(folder);
  for (const Key& key : keyring.keys()) {
    if (key.use == KeyUse::kNext && is_meant(key, role)) {
      throw StartupError(path_of(folder, key).string() +
                         ": a rotation is in progress; finish it: vantage keys rotate --sign " +
                         folder);
    }
  }
  for (const Role each : kRoles) {
    if (!role || each == *role) {
      Key key = make_key(each);
      key.use = KeyUse::kNext;
      store_key(folder, key);
    }
  }
}

void end_rotation(const std::string& folder, std::optional<Role> role) {
  const Keyring keyring = load_keyring(folder);
  const auto has_next = [&](Role of) {
    return std::any_of(keyring.keys().begin(), keyring.keys().end(),
                       [of](const Key& key) { return key.role == of && key.use == KeyUse::kNext; });
  };
  if (std::none_of(kRoles.begin(), kRoles.end(),
                   [&](Role each) { return (!role || each == *role) && has_next(each); })) {
    throw StartupError(folder + ": no new key to sign with; create one: vantage keys rotate " +
                       folder);
  }
  for (const KeyUse use :
       {KeyUse::kSigns, KeyUse::kNext}) {  // this order of renames never leaves two signing keys
    for (const Key& key : keyring.keys()) {
      if (key.use == use && is_meant(key, role) && has_next(key.role)) {
        const fs::path path = path_of(folder, key);
        move_file(path, fs::path(path).replace_extension(use == KeyUse::kSigns ? ".old" : ".key"));
      }
    }
  }
}

void revoke_key(const std::string& folder, const std::string& name) {
  const Keyring keyring = load_keyring(folder);
  for (const Key& key : keyring.keys()) {
    if (name == key_name(key) || name == fmt::format("{:08x}", key.id)) {
      const fs::path path = path_of(folder, key);
      std::error_code error;
      fs::remove(fs::path(path).replace_extension(kSeedSuffix), error);
      fs::remove(path, error);
      if (error) {
        throw StartupError(path.string() + ": cannot be removed: " + error.message());
      }
      return;
    }
  }
  throw StartupError(folder + ": no key " + name + "; list the keys: vantage keys show " + folder);
}

}  // namespace vantage::bus::auth
