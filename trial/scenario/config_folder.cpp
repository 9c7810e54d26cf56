#include "trial/scenario/config_folder.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "core/check.hpp"
#include "scenario/reader/value.hpp"

namespace vantage::trial {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSuffix = ".yaml";

// Returns the possible folders of scenario files, in the order of preference.
std::array<fs::path, 2> candidate_folders() {
  std::error_code error;
  const fs::path programs = fs::read_symlink("/proc/self/exe", error).parent_path();
  return {programs.parent_path() / "share/vantage/config", fs::path(VANTAGE_CONFIG_FOLDER)};
}

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

bool has_config(const std::string& name) {
  const auto all = candidate_folders();
  const auto folder = std::find_if(all.begin(), all.end(), is_folder);
  std::error_code error;
  return folder != all.end() && fs::exists(*folder / (name + kSuffix), error);
}

}  // namespace

std::string config_folder() {
  const auto all = candidate_folders();
  const auto found = std::find_if(all.begin(), all.end(), is_folder);
  if (found == all.end()) {
    throw StartupError("folder of scenarios not found: tried " + all[0].string() + " and " +
                       all[1].string());
  }
  return found->string();
}

std::vector<std::string> config_names() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(config_folder())) {
    if (entry.path().extension() == kSuffix) {
      names.push_back(entry.path().stem());
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string config_path(const std::string& name) {
  const std::string stem = name.ends_with(kSuffix)
                               ? name.substr(0, name.size() - std::string_view(kSuffix).size())
                               : name;
  const std::vector<std::string> names = config_names();
  if (std::find(names.begin(), names.end(), stem) == names.end()) {
    const std::vector<std::string_view> views(names.begin(), names.end());
    const std::string nearest = scenario::nearest_word(stem, views);
    throw StartupError("no scenario is called '" + name + "'; " +
                       (nearest.empty() ? "available: " + scenario::comma_separated(views)
                                        : "did you mean '" + nearest + "'?"));
  }
  return (fs::path(config_folder()) / (stem + kSuffix)).string();
}

std::string scenario_path(const std::string& word) {
  std::error_code error;
  if (word.empty() || fs::exists(word, error)) {
    return word;
  }
  const fs::path file = word;
  const bool is_path = file.has_parent_path() || file.extension() == kSuffix;
  if (!is_path) {
    return config_path(word);
  }
  const std::string name = file.stem();
  throw StartupError(word + ": no such file" +
                     (has_config(name) ? "; '" + name + "' comes with vantage" : ""));
}

}  // namespace vantage::trial
