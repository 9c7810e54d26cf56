#include "scenario/reader/yaml_document.hpp"

#include <algorithm>
#include <map>
#include <sstream>

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include "core/check.hpp"
#include "scenario/reader/text_file.hpp"

namespace vantage::scenario {
namespace {

/// Converter of yaml-cpp events to a tree. An alias refers to the same node, not to a copy.
class YamlEvents : public YAML::EventHandler {
 public:
  explicit YamlEvents(std::string file) : file_(std::move(file)), tree_(file_) {}

  [[nodiscard]] const TreeBuilder& tree() const { return tree_; }

  void OnDocumentStart(const YAML::Mark& /*mark*/) override { ++documents_; }
  void OnDocumentEnd() override {}
  // yaml-cpp gives the position of the following node, so the line is not used.
  void OnNull(const YAML::Mark& /*mark*/, YAML::anchor_t anchor) override {
    add(Node::Kind::kNothing, -1, anchor);
  }
  void OnAlias(const YAML::Mark& /*mark*/, YAML::anchor_t anchor) override {
    tree_.add_alias(*anchored_.at(anchor));
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& text) override {
    add(tag == "?" ? Node::Kind::kWord : Node::Kind::kText, mark.line, anchor, text);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value /*style*/) override {
    add(Node::Kind::kList, mark.line, anchor);
  }
  void OnSequenceEnd() override { tree_.close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value /*style*/) override {
    add(Node::Kind::kMapping, mark.line, anchor);
  }
  void OnMapEnd() override { tree_.close(); }

 private:
  void add(Node::Kind kind, int line_before, YAML::anchor_t anchor, const std::string& text = "") {
    if (documents_ > 1) {
      throw StartupError(
          fmt::format("{}:{}: a second YAML document begins here; a file may contain only one",
                      file_, std::max(line_before, 0) + 1));
    }
    const Node& node = tree_.add(kind, line_before + 1, text);
    if (anchor != YAML::NullAnchor) {
      anchored_[anchor] = &node;
    }
  }

  std::string file_;
  TreeBuilder tree_;
  std::map<YAML::anchor_t, const Node*> anchored_;
  int documents_ = 0;
};

}  // namespace

Value parse_yaml(const std::string& text, const std::string& name) {
  // Needed because yaml-cpp silently replaces invalid bytes and accepts some tabs.
  check_text(text, name, kScenarioText);
  YamlEvents events(name);
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(events)) {
    }
  } catch (const YAML::Exception& problem) {
    throw StartupError(
        fmt::format("{}:{}: not YAML: {}", name, std::max(problem.mark.line, 0) + 1, problem.msg));
  }
  const std::shared_ptr<const Node> root = events.tree().root();
  if (root == nullptr || root->kind == Node::Kind::kNothing) {
    throw StartupError(fmt::format("{}:1: empty file; expected {}", name, kScenarioText.expected));
  }
  return {root, name, "", 1};
}

}  // namespace vantage::scenario
