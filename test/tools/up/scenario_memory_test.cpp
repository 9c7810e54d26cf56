#include "tools/up/scenario_memory.hpp"

#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/child.hpp"

namespace vantage::tools {
namespace {

std::string read(const std::string& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST(ScenarioMemory, IsReadableRepeatedlyAndByChildren) {
  const std::string yaml(200'000, 'x');
  const ScenarioMemory memory(yaml);
  EXPECT_EQ(read(memory.path()), yaml);
  EXPECT_EQ(read(memory.path()), yaml);
  const auto size_in_child = [&](const std::vector<int>& keep_open) {
    ChildOptions options;
    options.keep_open = keep_open;
    Child child =
        std::move(Child::start({"sh", "-c", "[ \"$(wc -c < " + memory.path() + ")\" = 200000 ]"},
                               options))
            .value();
    return child.wait(std::chrono::seconds(30))->is_success();
  };
  EXPECT_TRUE(size_in_child({memory.descriptor()}));
  EXPECT_FALSE(size_in_child({})) << "foreign programs do not inherit it";
}

TEST(ScenarioMemory, IsReadOnly) {
  const ScenarioMemory memory("name: lab");
  EXPECT_EQ(::write(memory.descriptor(), "x", 1), -1);
  EXPECT_EQ(::ftruncate(memory.descriptor(), 0), -1);
  EXPECT_EQ(read(memory.path()), "name: lab");
}

}  // namespace
}  // namespace vantage::tools
