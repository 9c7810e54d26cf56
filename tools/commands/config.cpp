#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/check.hpp"
#include "core/write_file.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "scenario/reader/text_file.hpp"
#include "tools/commands/commands.hpp"
#include "tools/live/screen.hpp"
#include "trial/scenario/config_folder.hpp"

namespace vantage::tools {
namespace {

struct CopyArguments {
  std::string name;
  std::string output;
  bool force = false;
};

int copy(const CopyArguments& arguments) {
  const std::string source = trial::config_path(arguments.name);
  const std::string output = arguments.output.empty()
                                 ? std::filesystem::path(source).filename().string()
                                 : arguments.output;
  std::error_code error;
  if (!arguments.force && std::filesystem::exists(output, error)) {
    throw StartupError(output + ": file exists; use --force to overwrite it");
  }
  require_writable(output);
  write_file(output, scenario::read_text_file(source));
  print_line(output);
  print_line("check    vantage check " + shell_quoted(output));
  return 0;
}

/// Returns the first sentence of the comment at the start of a file.
std::string first_sentence(const std::string& path) {
  std::ifstream file(path);
  std::string text;
  for (std::string line; std::getline(file, line) && line.starts_with('#');) {
    const std::size_t begin = line.find_first_not_of("# ");
    text += begin == std::string::npos ? "" : (text.empty() ? "" : " ") + line.substr(begin);
  }
  return text.substr(0, text.find(". ")) + (text.find(". ") == std::string::npos ? "" : ".");
}

// Prints the name of each supplied scenario with the first sentence of its file.
int list() {
  constexpr std::size_t kColumns = 80;
  for (const std::string& name : trial::config_names()) {
    std::string line = fmt::format("{:14}", name);
    std::istringstream words(first_sentence(trial::config_path(name)));
    for (std::string word; words >> word;) {
      if (line.size() + 1 + word.size() > kColumns) {
        print_line(line);
        line = std::string(14, ' ');
      }
      line += " " + word;
    }
    print_line(line);
  }
  return 0;
}

// Returns the scenarios that come with vantage, except templates that the user has to complete.
std::vector<std::string> complete_scenarios() {
  std::vector<std::string> names = trial::config_names();
  std::erase_if(names, [](const std::string& name) {
    try {
      scenario::load_scenario(trial::config_path(name));
      return false;
    } catch (const StartupError&) {
      return true;
    }
  });
  return names;
}

// Prints the keys of all `scenarios`, or of the scenarios that come with vantage if `scenarios` is
// empty.
int list_keys(const std::vector<std::string>& scenarios, bool as_json) {
  scenario::KeyTable table;
  nlohmann::ordered_json places = nlohmann::ordered_json::object();
  for (const std::string& name : scenarios.empty() ? complete_scenarios() : scenarios) {
    const std::string path = trial::scenario_path(name);
    for (const scenario::KeyRule& rule : scenario::keys_of_scenario(path)) {
      table.note(rule);
      if (rule.line > 0) {
        places[rule.path].push_back({path, rule.line});
      }
    }
  }
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const scenario::KeyRule& rule : table.rules()) {
    const std::string initial = rule.is_required ? "required" : rule.initial;
    if (as_json) {
      all.push_back({{"key", rule.path},
                     {"values", rule.values},
                     {"default", initial},
                     {"places", places[rule.path]}});
    } else {
      print_line(fmt::format("{:44} {:12} {}", rule.path, initial, rule.values));
    }
  }
  if (as_json) {
    print_line(all.dump(1));
  }
  return 0;
}

}  // namespace

void add_config_command(CLI::App& root, Runner& chosen) {
  CLI::App* config =
      root.add_subcommand("config", "List or copy the scenarios that come with vantage.");
  config->require_subcommand(1);
  CLI::App* list_command =
      config->add_subcommand("list", "List the scenarios that come with vantage.");
  list_command->footer("Example:\n  vantage config list");
  list_command->callback([&chosen] { chosen = list; });

  CLI::App* copy_command =
      config->add_subcommand("copy", "Copy a scenario that comes with vantage, to edit it.");
  auto arguments = std::make_shared<CopyArguments>();
  copy_command
      ->add_option("name", arguments->name,
                   "scenario to copy, see `vantage config list`: lab, field, …")
      ->required();
  copy_command->add_option("file", arguments->output,
                           "output file (default: NAME.yaml in this folder)");
  copy_command->add_flag("--force", arguments->force, "overwrite an existing file");
  copy_command->footer(
      "Examples:\n"
      "  vantage config copy lab\n"
      "  vantage config copy field mine.yaml");
  copy_command->callback(
      [&chosen, arguments] { chosen = [arguments] { return copy(*arguments); }; });

  CLI::App* keys_command = config->add_subcommand(
      "keys", "List all keys of scenario files: default and allowed values.");
  auto scenarios = std::make_shared<std::vector<std::string>>();
  auto as_json = std::make_shared<bool>(false);
  keys_command->add_option(
      "scenario", *scenarios,
      "scenario files (default: all that come with vantage); lists and sections "
      "that no file contains are not shown");
  keys_command->add_flag("--json", *as_json, "print JSON, with the file and line of each key");
  keys_command->footer(
      "Examples:\n"
      "  vantage config keys\n"
      "  vantage config keys mine.yaml --json");
  keys_command->callback([&chosen, scenarios, as_json] {
    chosen = [scenarios, as_json] { return list_keys(*scenarios, *as_json); };
  });
}

}  // namespace vantage::tools
