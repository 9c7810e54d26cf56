#include "wire/qualisys/body_names.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

namespace vantage::wire::qualisys {
namespace {

constexpr std::size_t kDepthMax = 32;
constexpr std::string_view kSpaces = " \t\r\n";

constexpr std::array<std::pair<std::string_view, char>, 5> kEntities{
    {{"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}}};

/// Replaces entities by their characters. Returns nullopt for an unknown entity.
std::optional<std::string> plain_text(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    if (text[0] != '&') {
      out += text[0];
      text.remove_prefix(1);
      continue;
    }
    const auto entity = std::ranges::find_if(
        kEntities, [&](const auto& each) { return text.starts_with(each.first); });
    if (entity == kEntities.end()) {
      return std::nullopt;
    }
    out += entity->second;
    text.remove_prefix(entity->first.size());
  }
  return out;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kSpaces);
  if (begin == std::string_view::npos) {
    return {};
  }
  return text.substr(begin, text.find_last_not_of(kSpaces) + 1 - begin);
}

bool is_name_char(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-' || c == '.' || c == ':';
}

/// Reader of one document; is_ok() is false after the first error.
class XmlReader {
 public:
  explicit XmlReader(std::string_view xml) : rest_(xml) {}

  /// Reads the whole document and collects the bodies.
  bool read(std::vector<BodyName>& out) {
    while (is_ok_ && !rest_.empty()) {
      if (rest_[0] != '<') {
        read_text(out);
      } else if (rest_.starts_with("<!--")) {
        skip_past("-->");
      } else if (rest_.starts_with("<?")) {
        skip_past("?>");
      } else if (rest_.starts_with("</")) {
        read_end(out);
      } else {
        read_start(out);
      }
    }
    return is_ok_ && path_.empty() && has_root_;
  }

 private:
  void skip_past(std::string_view end) {
    const std::size_t at = rest_.find(end);
    is_ok_ = at != std::string_view::npos;
    rest_.remove_prefix(is_ok_ ? at + end.size() : rest_.size());
  }
  void skip_spaces() {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(kSpaces), rest_.size()));
  }
  bool take(std::string_view text) {
    const bool is_next = rest_.starts_with(text);
    rest_.remove_prefix(is_next ? text.size() : 0);
    return is_next;
  }
  std::string_view take_name() {
    const auto end = std::ranges::find_if_not(rest_, is_name_char);
    const std::string_view name = rest_.substr(0, static_cast<std::size_t>(end - rest_.begin()));
    rest_.remove_prefix(name.size());
    is_ok_ = is_ok_ && !name.empty();
    return name;
  }

  void read_text(std::vector<BodyName>& out) {
    const std::string_view text = rest_.substr(0, rest_.find('<'));
    rest_.remove_prefix(text.size());
    const std::optional<std::string> plain = plain_text(trimmed(text));
    is_ok_ = plain && (!path_.empty() || plain->empty());
    if (is_ok_ && is_child_of_body("Name")) {
      out.back().name += *plain;
    } else if (is_ok_ && is_child_of_body("Enabled")) {
      out.back().is_enabled = *plain != "false";
    }
  }

  void read_start(std::vector<BodyName>& out) {
    is_ok_ = take("<") && path_.size() < kDepthMax && (!path_.empty() || !has_root_);
    has_root_ = true;
    path_.push_back(take_name());
    for (skip_spaces(); is_ok_ && !rest_.empty() && is_name_char(rest_[0]); skip_spaces()) {
      take_name();
      skip_spaces();
      is_ok_ = is_ok_ && take("=");
      skip_spaces();
      const char quote = rest_.empty() ? '\0' : rest_[0];
      is_ok_ = is_ok_ && (quote == '"' || quote == '\'');
      if (is_ok_) {
        rest_.remove_prefix(1);
        skip_past({&quote, 1});
      }
    }
    if (is_body()) {
      out.emplace_back();
    }
    if (take("/>")) {
      on_end(out);
    } else {
      is_ok_ = is_ok_ && take(">");
    }
  }

  void read_end(std::vector<BodyName>& out) {
    is_ok_ = take("</") && !path_.empty() && take_name() == path_.back();
    skip_spaces();
    is_ok_ = is_ok_ && take(">");
    if (is_ok_) {
      on_end(out);
    }
  }

  void on_end(std::vector<BodyName>& out) {
    is_ok_ = is_ok_ && (!is_body() || !out.back().name.empty());
    path_.pop_back();
  }

  /// True in an element `Body` of `The_6D`, outside its children.
  [[nodiscard]] bool is_body() const {
    return path_.size() >= 2 && path_.back() == "Body" && path_[path_.size() - 2] == "The_6D";
  }
  [[nodiscard]] bool is_child_of_body(std::string_view name) const {
    return path_.size() >= 3 && path_.back() == name && path_[path_.size() - 2] == "Body" &&
           path_[path_.size() - 3] == "The_6D";
  }

  std::string_view rest_;
  std::vector<std::string_view> path_;  ///< names of the open elements
  bool has_root_ = false;
  bool is_ok_ = true;
};

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const auto entity = std::ranges::find(kEntities, c, &std::pair<std::string_view, char>::second);
    out += entity == kEntities.end() ? std::string(1, c) : std::string(entity->first);
  }
  return out;
}

}  // namespace

std::optional<std::vector<BodyName>> decode_body_names(std::string_view xml) {
  std::vector<BodyName> out;
  return XmlReader(xml).read(out) ? std::optional(std::move(out)) : std::nullopt;
}

std::string encode_body_names(const std::vector<std::string>& bodies) {
  std::string out = "<QTM_Parameters_Ver_1.25>\n  <The_6D>\n";
  for (const std::string& body : bodies) {
    out += "    <Body>\n      <Name>" + escaped(body) +
           "</Name>\n      <Enabled>true</Enabled>\n      <Color R=\"0\" G=\"255\" B=\"0\"/>\n"
           "      <Mesh><Name>drone</Name></Mesh>\n"
           "      <Points><Point X=\"10\" Y=\"0\" Z=\"0\"/></Points>\n    </Body>\n";
  }
  return out + "  </The_6D>\n</QTM_Parameters_Ver_1.25>\n";
}

}  // namespace vantage::wire::qualisys
