#include "trial/scenario/config_folder.hpp"

#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "test/support/temporary_folder.hpp"

namespace vantage::trial {
namespace {

namespace fs = std::filesystem;

// A fixture that runs in its own temporary folder.
class ConfigFolder : public testing::Test {
 protected:
  ConfigFolder() { fs::current_path(folder_.path()); }
  ~ConfigFolder() override { fs::current_path(before_); }
  ConfigFolder(const ConfigFolder&) = delete;
  ConfigFolder& operator=(const ConfigFolder&) = delete;

  static std::string refusal(const std::string& word) {
    try {
      return "taken: " + scenario_path(word);
    } catch (const StartupError& error) {
      return error.what();
    }
  }

 private:
  fs::path before_ = fs::current_path();
  test::TemporaryFolder folder_;
};

TEST_F(ConfigFolder, PrefersAFileToAnInstalledName) {
  EXPECT_EQ(scenario_path("lab"), (fs::path(config_folder()) / "lab.yaml").string());
  std::ofstream("lab") << "mine";
  EXPECT_EQ(scenario_path("lab"), "lab");
  fs::create_directory("config");
  std::ofstream("config/lab.yaml") << "mine";
  EXPECT_EQ(scenario_path("config/lab.yaml"), "config/lab.yaml");
}

TEST_F(ConfigFolder, TreatsPathsAsFilesOnly) {
  EXPECT_EQ(refusal("lab.yaml"), "lab.yaml: no such file; 'lab' comes with vantage");
  EXPECT_EQ(refusal("config/lab.yaml"), "config/lab.yaml: no such file; 'lab' comes with vantage");
  EXPECT_EQ(refusal("config/mine.yaml"), "config/mine.yaml: no such file");
  EXPECT_EQ(refusal("lbb"), "no scenario is called 'lbb'; did you mean 'lab'?");
}

TEST_F(ConfigFolder, FindsEachInstalledName) {
  const auto names = config_names();
  EXPECT_GE(names.size(), 10U);
  for (const std::string& name : names) {
    EXPECT_TRUE(fs::is_regular_file(scenario_path(name))) << name;
  }
}

TEST_F(ConfigFolder, ListsInstalledScenariosInOrder) {
  std::set<std::string> files;
  for (const auto& entry : fs::directory_iterator(VANTAGE_SOURCE_DIR "/config")) {
    if (entry.path().extension() == ".yaml") {
      files.insert(entry.path().stem());
    }
  }
  EXPECT_EQ(config_names(), std::vector<std::string>(files.begin(), files.end()));
}

TEST_F(ConfigFolder, AcceptsNamesWithExtensionAndListsAlternatives) {
  const std::string lab = (fs::path(config_folder()) / "lab.yaml").string();
  EXPECT_EQ(config_path("lab"), lab);
  EXPECT_EQ(config_path("lab.yaml"), lab);
  EXPECT_EQ(scenario_path(""), "") << "the reader reports the error";
  std::string all;
  for (const std::string& name : config_names()) {
    all += (all.empty() ? "" : ", ") + name;
  }
  for (const std::string none : {"nothing-like-any-of-them", ".yaml", "autopilot"}) {
    try {
      ADD_FAILURE() << config_path(none);
    } catch (const StartupError& error) {
      EXPECT_EQ(error.what(), "no scenario is called '" + none + "'; available: " + all);
    }
  }
}

}  // namespace
}  // namespace vantage::trial
