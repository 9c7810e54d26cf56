#include "logs/types/lcm_language.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <limits>
#include <map>
#include <utility>

#include "core/check.hpp"

namespace vantage::logs {
namespace {

constexpr std::array<std::string_view, 9> kBasic = {
    "int8_t", "int16_t", "int32_t", "int64_t", "byte", "float", "double", "string", "boolean"};
constexpr std::string_view kSingle = "();\",:'[]{}=";  // each character is a separate token

bool is_word(std::string_view token) {
  return !token.empty() &&
         (std::isalpha(static_cast<unsigned char>(token.front())) != 0 || token.front() == '_');
}

bool is_integer_type(std::string_view type) { return type.starts_with("int"); }

class Parser {
 public:
  Parser(std::string_view text, const std::string& path) : left_(text), path_(path) { advance(); }

  std::vector<LcmStruct> parse() {
    while (!token_.empty()) {
      const std::string what = take("package, struct or enum");
      if (what == "package") {
        package_ = name("a package");
        expect(";");
      } else if (what == "struct") {
        parse_struct();
      } else if (what == "enum") {
        skip_enum();
      } else {
        fail("expected package, struct or enum, not " + what);
      }
    }
    return std::move(structs_);
  }

 private:
  void parse_struct() {
    LcmStruct made;
    made.line = line_;
    made.name = with_package(name("a struct"));
    constants_.clear();
    expect("{");
    while (!try_take("}")) {
      if (try_take("const")) {
        parse_constants(made);
      } else {
        parse_members(made);
      }
    }
    const bool is_known = std::any_of(structs_.begin(), structs_.end(), [&](const LcmStruct& each) {
      return each.name == made.name;
    });
    if (is_known) {
      fail("struct " + made.name + " is defined twice");
    }
    structs_.push_back(std::move(made));
  }

  void parse_constants(const LcmStruct& made) {
    const std::string type = name("the constant's type");
    do {
      const std::string constant = new_name(made);
      expect("=");
      constants_[constant] = {type, take("its value")};
    } while (try_take(","));
    expect(";");
  }

  void parse_members(LcmStruct& made) {
    const std::string type = name("a type");
    if (type == "struct" || type == "enum") {
      fail(type + " inside a struct is not allowed");
    }
    do {
      LcmMember member{is_basic_lcm_type(type) ? type : with_package(type), new_name(made), {}};
      while (try_take("[")) {
        member.dimensions.push_back(parse_dimension(made));
        expect("]");
      }
      made.members.push_back(std::move(member));
    } while (try_take(","));
    expect(";");
  }

  LcmDimension parse_dimension(const LcmStruct& made) {
    const std::string size = take("an array's size");
    if (std::isdigit(static_cast<unsigned char>(size.front())) != 0) {
      return {size, constant_size(size), -1};
    }
    if (const auto known = constants_.find(size); known != constants_.end()) {
      if (!is_integer_type(known->second.first)) {
        fail("the array size " + size + " is not an integer");
      }
      return {known->second.second, constant_size(known->second.second), -1};
    }
    const auto found = std::find_if(made.members.begin(), made.members.end(),
                                    [&](const LcmMember& each) { return each.name == size; });
    if (found == made.members.end()) {
      fail("the array size " + size + " is not a constant or an earlier member");
    }
    if (!is_integer_type(found->type) || !found->dimensions.empty()) {
      fail("the array size " + size + " is not an integer");
    }
    return {size, 0, static_cast<std::int32_t>(found - made.members.begin())};
  }

  std::int32_t constant_size(const std::string& text) {
    char* end = nullptr;
    const long size = std::strtol(text.c_str(), &end, 0);  // as in C: 0x10 and 020 are 16
    if (*end != '\0' || size <= 0 || size > std::numeric_limits<std::int32_t>::max()) {
      fail("an array's size must be a whole number above 0, not " + text);
    }
    return static_cast<std::int32_t>(size);
  }

  // Skips an enum: it does not affect the wire format.
  void skip_enum() {
    static_cast<void>(name("an enum"));
    expect("{");
    while (!try_take("}")) {
      static_cast<void>(take("}"));
    }
  }

  std::string with_package(const std::string& type) const {
    return package_.empty() || type.find('.') != std::string::npos ? type : package_ + "." + type;
  }

  std::string new_name(const LcmStruct& made) {
    std::string found = name("a member's name");
    const bool is_taken = constants_.contains(found) ||
                          std::any_of(made.members.begin(), made.members.end(),
                                      [&](const LcmMember& each) { return each.name == found; });
    if (is_taken) {
      fail(found + " is defined twice in " + made.name);
    }
    return found;
  }

  std::string name(const std::string& what) {
    std::string found = take(what);
    if (!is_word(found)) {
      fail("expected " + what + ", not " + found);
    }
    return found;
  }

  void expect(const std::string& wanted) {
    if (const std::string found = take(wanted); found != wanted) {
      fail("expected " + wanted + ", not " + found);
    }
  }

  bool try_take(std::string_view wanted) {
    if (token_ != wanted) {
      return false;
    }
    advance();
    return true;
  }

  std::string take(const std::string& what) {
    if (token_.empty()) {
      line_ = next_line_;
      fail("expected " + what + ", but the file ends");
    }
    std::string taken(token_);
    line_ = token_line_;
    advance();
    return taken;
  }

  [[noreturn]] void fail(const std::string& why) const {
    throw StartupError(path_ + ":" + std::to_string(line_) + ": " + why);
  }

  /// Advances token_ to the next token; empty at the end.
  void advance() {
    skip_blanks();
    token_line_ = next_line_;
    std::size_t size = left_.empty() ? 0 : 1;
    if (size > 0 && kSingle.find(left_.front()) == std::string_view::npos) {
      while (size < left_.size() && kSingle.find(left_[size]) == std::string_view::npos &&
             std::isspace(static_cast<unsigned char>(left_[size])) == 0 &&
             !left_.substr(size).starts_with("//") && !left_.substr(size).starts_with("/*")) {
        ++size;
      }
    }
    token_ = left_.substr(0, size);
    left_.remove_prefix(size);
  }

  void skip_blanks() {
    while (!left_.empty()) {
      std::size_t size = 0;
      if (std::isspace(static_cast<unsigned char>(left_.front())) != 0) {
        size = 1;
      } else if (left_.starts_with("//")) {
        size = std::min(left_.find('\n'), left_.size());
      } else if (left_.starts_with("/*")) {
        const std::size_t end = left_.find("*/", 2);
        if (end == std::string_view::npos) {
          line_ = next_line_;
          fail("a comment is not closed");
        }
        size = end + 2;
      } else {
        return;
      }
      next_line_ += static_cast<std::size_t>(
          std::count(left_.begin(), left_.begin() + static_cast<std::ptrdiff_t>(size), '\n'));
      left_.remove_prefix(size);
    }
  }

  std::string_view left_;
  const std::string& path_;
  std::string_view token_;
  std::size_t next_line_ = 1;   ///< line of the unread text
  std::size_t token_line_ = 1;  ///< line of the text in token_
  std::size_t line_ = 1;        ///< line of the token that was read last
  std::string package_;
  /// Constants of the current struct: type and value by name.
  std::map<std::string, std::pair<std::string, std::string>> constants_;
  std::vector<LcmStruct> structs_;
};

}  // namespace

bool is_basic_lcm_type(std::string_view type) {
  return std::find(kBasic.begin(), kBasic.end(), type) != kBasic.end();
}

std::vector<LcmStruct> parse_lcm(std::string_view text, const std::string& path) {
  return Parser(text, path).parse();
}

}  // namespace vantage::logs
