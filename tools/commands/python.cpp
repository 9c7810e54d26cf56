#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <unistd.h>

#include "core/check.hpp"
#include "tools/commands/commands.hpp"

namespace vantage::tools {
namespace {

/// Returns the folder of the Python packages in the build that contains this program. Returns an
/// empty string if the program is installed, because Python then finds the packages by itself.
std::string package_folder() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  const auto folder = program.parent_path().parent_path() / "python";
  return !error && std::filesystem::exists(folder / "vantage" / "__init__.py") ? folder.string()
                                                                               : std::string();
}

bool has_module(const std::filesystem::path& package) {
  for (const auto& entry : std::filesystem::directory_iterator(package)) {
    const std::string name = entry.path().filename();
    if (name.starts_with("_vantage.") && name.ends_with(".so")) {
      return true;
    }
  }
  return false;
}

int run(const std::vector<std::string>& words) {
  const std::string folder = package_folder();
  if (!folder.empty()) {
    if (!has_module(std::filesystem::path(folder) / "vantage")) {
      throw StartupError(
          "python: this build has no Python module; install what it needs (tools/setup) and build "
          "the target vantage_python");
    }
    const char* const before = std::getenv("PYTHONPATH");
    const std::string path = before == nullptr ? folder : folder + ":" + before;
    ::setenv("PYTHONPATH", path.c_str(), 1);
  }
  std::vector<std::string> arguments{VANTAGE_PYTHON_EXECUTABLE};
  arguments.insert(arguments.end(), words.begin(), words.end());
  std::vector<char*> pointers;
  for (std::string& argument : arguments) {
    pointers.push_back(argument.data());
  }
  pointers.push_back(nullptr);
  ::execv(pointers.front(), pointers.data());
  throw StartupError(fmt::format("python: {}: {}", arguments.front(), std::strerror(errno)));
}

}  // namespace

void add_python_command(CLI::App& root, Runner& chosen) {
  CLI::App* command =
      root.add_subcommand("python", "Run Python with the packages vantage and vantage_lcm.");
  command->prefix_command();
  command->footer(
      "Arguments are those of python3. The packages are found without an installation.\n"
      "Examples:\n"
      "  vantage python                      # interactive\n"
      "  vantage python -m vantage           # overview of the package\n"
      "  vantage python my_experiment.py");
  command->callback(
      [&chosen, command] { chosen = [words = command->remaining()] { return run(words); }; });
}

}  // namespace vantage::tools
