#include "trial/scenario/config_folder.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "core/check.hpp"
#include "scenario/reader/yaml_value.hpp"

namespace vantage::trial {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSuffix = ".yaml";

}  // namespace

std::string config_folder() {
  std::error_code error;
  const fs::path programs = fs::read_symlink("/proc/self/exe", error).parent_path();
  const std::array<fs::path, 2> places = {programs.parent_path() / "share/vantage/config",
                                          fs::path(VANTAGE_CONFIG_FOLDER)};
  const auto found = std::find_if(places.begin(), places.end(), [&](const fs::path& place) {
    return fs::is_directory(place, error);
  });
  if (found == places.end()) {
    throw StartupError("no scenarios: neither " + places[0].string() + " nor " +
                       places[1].string() + " is a folder");
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
                       (nearest.empty() ? "there are " + scenario::comma_separated(views)
                                        : "did you mean '" + nearest + "'?"));
  }
  return (fs::path(config_folder()) / (stem + kSuffix)).string();
}

}  // namespace vantage::trial
