#include <algorithm>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bus/auth/keyring.hpp"
#include "core/check.hpp"
#include "tools/command_line/numbers.hpp"
#include "tools/commands/commands.hpp"
#include "tools/live/screen.hpp"

namespace vantage::tools {
namespace {

namespace auth = bus::auth;

struct KeysArguments {
  std::string folder;
  std::string key;
  std::string role;
  bool is_signing = false;
  bool as_json = false;
};

std::optional<auth::Role> role_named(const std::string& name) {
  for (const auth::Role role : auth::kRoles) {
    if (name == auth::name_of(role)) {
      return role;
    }
  }
  return std::nullopt;
}

const char* use_of(const auth::Key& key) {
  if (key.use == auth::KeyUse::kSigns) {
    return key.can_sign() ? "signs" : "public half only; another host signs with it";
  }
  return key.use == auth::KeyUse::kNext ? "accepted; becomes the signing key at `rotate --sign`"
                                        : "accepted; no longer signs";
}

int show(const KeysArguments& arguments) {
  const auth::Keyring keyring = auth::load_keyring(arguments.folder);
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const auth::Key& key : keyring.keys()) {
    if (arguments.as_json) {
      list.push_back({{"role", auth::name_of(key.role)},
                      {"id", fmt::format("{:08x}", key.id)},
                      {"file", auth::key_name(key) + "." + auth::name_of(key.use)},
                      {"signs", key.can_sign()}});
    } else {
      print_line(fmt::format("{:<8}  {:08x}  {}", auth::name_of(key.role), key.id, use_of(key)));
    }
  }
  if (arguments.as_json) {
    print_json(list);
  }
  if (keyring.keys().empty()) {
    throw StartupError(arguments.folder + ": contains no keys; create them: vantage keys new " +
                       arguments.folder);
  }
  return 0;
}

int rotate(const KeysArguments& arguments) {
  const std::optional<auth::Role> role = role_named(arguments.role);
  if (arguments.is_signing) {
    auth::end_rotation(arguments.folder, role);
  } else {
    auth::begin_rotation(arguments.folder, role);
  }
  return show(arguments);
}

}  // namespace

void add_keys_command(CLI::App& root, Runner& chosen) {
  CLI::App* command =
      root.add_subcommand("keys", "Create, show, rotate and revoke the keys that sign messages.");
  command->require_subcommand(1);
  auto arguments = std::make_shared<KeysArguments>();
  const auto add = [&](const char* name, const char* description, auto&& act) {
    CLI::App* one = command->add_subcommand(name, description);
    one->add_option("folder", arguments->folder, "folder that contains the keys")->required();
    one->add_flag("--json", arguments->as_json, "print one JSON array");
    one->callback(
        [&chosen, arguments, act] { chosen = [arguments, act] { return act(*arguments); }; });
    return one;
  };
  add("new", "Create a folder with one key per role.", [](const KeysArguments& given) {
    auth::make_keys(given.folder);
    return show(given);
  });
  add("show", "List the keys without their secrets.",
      [](const KeysArguments& given) { return show(given); });
  CLI::App* turn = add("rotate", "Create the next keys; with --sign, switch to signing with them.",
                       [](const KeysArguments& given) { return rotate(given); });
  turn->add_option("--role", arguments->role,
                   "rotate only the key of this role (default: all roles)")
      ->check(one_of({"mocap", "planner", "vehicle", "operator", "node"}));
  turn->add_flag(
      "--sign", arguments->is_signing,
      "sign with the keys that an earlier rotate created; the current keys stay accepted");
  CLI::App* revoke = add("revoke", "Remove a key; messages signed with it are rejected.",
                         [](const KeysArguments& given) {
                           auth::revoke_key(given.folder, given.key);
                           return show(given);
                         });
  revoke->add_option("key", arguments->key, "ID or ROLE-ID, as listed by `vantage keys show`")
      ->required();
  command->footer(
      "Processes read keys only when they start. docs/guide/security.md explains which files "
      "each host needs.\n"
      "Examples:\n"
      "  vantage keys new keys\n"
      "  vantage keys rotate keys --role operator");
}

}  // namespace vantage::tools
