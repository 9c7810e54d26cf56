#include <algorithm>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bus/auth/keyring.hpp"
#include "core/check.hpp"
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
    return key.can_sign() ? "signs" : "is signed with elsewhere";
  }
  return key.use == auth::KeyUse::kNext ? "accepted; signs after rotate --sign"
                                        : "accepted; signed before";
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
    throw StartupError(arguments.folder + ": there are no keys; vantage keys new " +
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
      root.add_subcommand("keys", "The keys that sign messages: make, show, change, take away.");
  command->require_subcommand(1);
  auto arguments = std::make_shared<KeysArguments>();
  const auto add = [&](const char* name, const char* description, auto&& act) {
    CLI::App* one = command->add_subcommand(name, description);
    one->add_option("folder", arguments->folder, "folder of keys")->required();
    one->add_flag("--json", arguments->as_json, "print one JSON array");
    one->callback(
        [&chosen, arguments, act] { chosen = [arguments, act] { return act(*arguments); }; });
    return one;
  };
  add("new", "Make a folder with a key of each role.", [](const KeysArguments& given) {
    auth::make_keys(given.folder);
    return show(given);
  });
  add("show", "Say which keys are there. No secret is printed.",
      [](const KeysArguments& given) { return show(given); });
  CLI::App* turn = add("rotate", "Make the next keys; with --sign, sign with them from now on.",
                       [](const KeysArguments& given) { return rotate(given); });
  turn->add_option("--role", arguments->role, "of this role alone")
      ->check(CLI::IsMember({"mocap", "planner", "vehicle", "operator", "node"}));
  turn->add_flag("--sign", arguments->is_signing,
                 "sign with what a rotation before has made; the key until now is still accepted");
  CLI::App* revoke =
      add("revoke", "Remove a key: what it signed is refused.", [](const KeysArguments& given) {
        auth::revoke_key(given.folder, given.key);
        return show(given);
      });
  revoke->add_option("key", arguments->key, "ID or ROLE-ID, as `show` says")->required();
  command->footer(
      "Processes read their keys when they start. docs/guide/security.md tells which files go "
      "where.\n"
      "Examples:\n"
      "  vantage keys new keys\n"
      "  vantage keys rotate keys --role operator");
}

}  // namespace vantage::tools
