#include "tools/experiment/experiment_files.hpp"

#include <chrono>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/check.hpp"
#include "tools/observe/announcer.hpp"
#include "tools/picture/picture.hpp"
#include "tools/supervisor/child.hpp"

namespace vantage::tools {
namespace {

std::string manifest_of(const Experiment& experiment, const ExperimentOptions& options,
                        const ExperimentResult& result) {
  nlohmann::ordered_json manifest;
  manifest["experiment"] = experiment.name;
  manifest["version"] = version();
  manifest["seed"] = options.seed;
  manifest["smoke"] = options.smoke;
  for (const auto& [name, value] : result.settings) {
    manifest["settings"][name] = value;
  }
  for (const auto& [name, text] : result.files) {
    manifest["files"].push_back(name);
  }
  return manifest.dump(2) + "\n";
}

// Runs the script with gnuplot; what to tell of it.
std::string draw(const std::string& directory, const std::string& script_path) {
  const std::string enter = "cd '" + directory + "'";
  Result<Child> child = Child::start({"gnuplot", "-e", enter, script_path});
  if (!child.ok()) {
    return "no figures: gnuplot is not installed (apt install gnuplot-nox)";
  }
  const std::optional<ChildExit> ended = std::move(child).value().wait(std::chrono::seconds(60));
  return ended && ended->is_success() ? "figures in " + directory
                                      : "no figures: gnuplot failed on " + script_path;
}

}  // namespace

std::vector<std::string> run_experiment(const Experiment& experiment,
                                        const ExperimentOptions& options,
                                        const std::string& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) {
    throw StartupError(directory + ": cannot be made: " + error.message());
  }
  const ExperimentResult result = experiment.run(options);
  for (const auto& [name, text] : result.files) {
    write_text(directory + "/" + name, text);
  }
  write_text(directory + "/manifest.json", manifest_of(experiment, options, result));
  std::vector<std::string> lines = result.report;
  if (!result.figure.empty()) {
    const std::string script = directory + "/" + experiment.name + ".gp";
    write_text(script, result.figure);
    lines.push_back(draw(directory, std::filesystem::absolute(script)));
  }
  return lines;
}

}  // namespace vantage::tools
