#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "core/check.hpp"
#include "core/write_file.hpp"
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
    throw StartupError(output + ": exists; --force writes over it");
  }
  require_writable(output);
  write_file(output, scenario::read_text_file(source));
  print_line(output);
  print_line("check    vantage check " + shell_quoted(output));
  return 0;
}

// Prints each name with the first line of its file, which describes it.
int list() {
  for (const std::string& name : trial::config_names()) {
    std::ifstream file(trial::config_path(name));
    std::string first;
    std::getline(file, first);
    const std::size_t begin = first.find_first_not_of("# ");
    print_line(fmt::format("{:14} {}", name,
                           begin == std::string::npos ? std::string() : first.substr(begin)));
  }
  return 0;
}

}  // namespace

void add_config_command(CLI::App& root, Runner& chosen) {
  CLI::App* config =
      root.add_subcommand("config", "The scenarios that come with vantage, to begin one's own.");
  config->require_subcommand(1);
  CLI::App* list_command = config->add_subcommand("list", "Name them.");
  list_command->footer("Example:\n  vantage config list");
  list_command->callback([&chosen] { chosen = list; });

  CLI::App* copy_command = config->add_subcommand("copy", "Write one of them to a file of yours.");
  auto arguments = std::make_shared<CopyArguments>();
  copy_command->add_option("name", arguments->name, "which: lab, field, …")->required();
  copy_command->add_option("file", arguments->output, "where to; NAME.yaml here when not given");
  copy_command->add_flag("--force", arguments->force, "write over what is there");
  copy_command->footer(
      "Examples:\n"
      "  vantage config copy lab\n"
      "  vantage config copy field mine.yaml");
  copy_command->callback(
      [&chosen, arguments] { chosen = [arguments] { return copy(*arguments); }; });
}

}  // namespace vantage::tools
