#include "scenario/reader/differences.hpp"

#include <algorithm>

#include <yaml-cpp/yaml.h>

namespace vantage::scenario {
namespace {

using Values = std::map<std::string, std::string>;

void add_values(const YAML::Node& node, const std::string& path, Values& values) {
  if (node.IsMap()) {
    for (const auto& entry : node) {
      const auto key = entry.first.as<std::string>();
      add_values(entry.second, path.empty() ? key : path + "." + key, values);
    }
    return;
  }
  YAML::Emitter text;
  text.SetSeqFormat(YAML::Flow);
  text.SetMapFormat(YAML::Flow);
  text << node;
  values[path] = text.c_str();
}

}  // namespace

std::map<std::string, std::vector<std::string>> differing_keys(
    const std::vector<std::string>& texts) {
  std::map<std::string, std::vector<std::string>> all;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    Values values;
    add_values(YAML::Load(texts[i]), "", values);
    for (auto& [path, value] : values) {
      std::vector<std::string>& column = all[path];
      column.resize(texts.size(), "-");
      column[i] = value;
    }
  }
  std::erase_if(all, [](const auto& entry) {
    return std::all_of(entry.second.begin(), entry.second.end(),
                       [&](const std::string& value) { return value == entry.second.front(); });
  });
  return all;
}

}  // namespace vantage::scenario
