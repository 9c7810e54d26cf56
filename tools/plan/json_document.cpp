#include "tools/plan/json_document.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/check.hpp"
#include "core/utf8.hpp"

namespace vantage::tools {
namespace {

using scenario::Node;

/// Scanner that finds the lines of tokens. It reads the text in parallel with the parser, because
/// the parser does not report positions.
class Tokens {
 public:
  explicit Tokens(std::string_view text) : text_(text) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    at_ = text_.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
  }

  /// Returns the next token, without commas and colons. Precondition: the parser has read it.
  std::string_view next() {
    constexpr std::string_view kBetween = " \t\r\n,:";
    for (; kBetween.find(text_[at_]) != std::string_view::npos; ++at_) {
      line_ += text_[at_] == '\n' ? 1 : 0;
    }
    const std::size_t begin = at_;
    const char first = text_[at_++];
    if (first == '"') {
      for (; text_[at_] != '"'; ++at_) {
        at_ += text_[at_] == '\\' ? 1U : 0U;
      }
      ++at_;
    } else if (std::string_view("{}[]").find(first) == std::string_view::npos) {
      at_ = std::min(text_.find_first_of(" \t\r\n,]}", at_), text_.size());
    }
    return text_.substr(begin, at_ - begin);
  }
  /// Returns the line of the token that next() returned.
  [[nodiscard]] int line() const { return line_; }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1;
};

// Returns the last part of "[json.exception.parse_error.101] parse error at line 1, column 2:
// syntax error …".
std::string reason_of(const nlohmann::json::exception& error) {
  constexpr std::size_t kShown = 120;
  const std::string what = error.what();
  const std::size_t place = what.find("parse error at ");
  const std::size_t start = place == std::string::npos ? what.find("] ") : what.find(": ", place);
  return readable(
      scenario::shortened(start == std::string::npos ? what : what.substr(start + 2), kShown));
}

/// Handler of the events of nlohmann's parser that builds a tree.
class JsonEvents : public nlohmann::json_sax<nlohmann::json> {
 public:
  JsonEvents(std::string_view text, const std::string& file)
      : text_(text), file_(file), tokens_(text), tree_(file) {}

  [[nodiscard]] const scenario::TreeBuilder& tree() const { return tree_; }

  bool null() override { return add(Node::Kind::kNothing, ""); }
  bool boolean(bool value) override { return add(Node::Kind::kLiteral, value ? "true" : "false"); }
  bool number_integer(std::int64_t /*value*/) override { return add_as_written(); }
  bool number_unsigned(std::uint64_t /*value*/) override { return add_as_written(); }
  bool number_float(double value, const std::string& written) override {
    constexpr double kExactMax = 9'007'199'254'740'992.0;  // 2⁵³; larger doubles may not be exact
    const bool is_whole = value == std::floor(value) && std::abs(value) <= kExactMax;
    // Numbers that round to zero, such as 1e-400, and -0.0 are kept as written.
    if (!is_whole || (value == 0.0 && written != "0.0")) {
      return add_as_written();
    }
    return add(Node::Kind::kLiteral, fmt::format("{}", static_cast<std::int64_t>(value)));
  }
  bool string(std::string& value) override { return add(Node::Kind::kText, value); }
  bool binary(nlohmann::json::binary_t& /*value*/) override { return false; }
  bool start_object(std::size_t /*count*/) override { return add(Node::Kind::kMapping, ""); }
  bool key(std::string& value) override { return add(Node::Kind::kText, value); }
  bool end_object() override { return close(); }
  bool start_array(std::size_t /*count*/) override { return add(Node::Kind::kList, ""); }
  bool end_array() override { return close(); }
  bool parse_error(std::size_t byte, const std::string& /*token*/,
                   const nlohmann::json::exception& error) override {
    const std::string_view before = text_.substr(0, byte == 0 ? 0 : byte - 1);
    const std::size_t line_begin = before.rfind('\n') + 1;  // 0 on the first line
    throw StartupError(fmt::format("{}:{}:{}: not JSON: {}", file_,
                                   1 + std::count(before.begin(), before.end(), '\n'),
                                   1 + before.size() - line_begin, reason_of(error)));
  }

 private:
  bool add(Node::Kind kind, std::string text) {
    static_cast<void>(tokens_.next());
    tree_.add(kind, tokens_.line(), std::move(text));
    return true;
  }
  bool add_as_written() {
    const std::string_view written = tokens_.next();
    tree_.add(Node::Kind::kLiteral, tokens_.line(), std::string(written));
    return true;
  }
  bool close() {
    static_cast<void>(tokens_.next());
    tree_.close();
    return true;
  }

  std::string_view text_;
  std::string file_;
  Tokens tokens_;
  scenario::TreeBuilder tree_;
};

}  // namespace

scenario::Value parse_json(const std::string& text, const std::string& name) {
  scenario::check_text(text, name, kProblemText);
  constexpr std::string_view kBlank = " \t\r\n";
  if (text.find_first_not_of(kBlank) == std::string::npos) {
    throw StartupError(fmt::format("{}:1: empty file; expected {}", name, kProblemText.expected));
  }
  JsonEvents events(text, name);
  static_cast<void>(nlohmann::json::sax_parse(text, &events));
  return {events.tree().root(), name, "", 1};
}

}  // namespace vantage::tools
