#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <regex>
#include <set>
#include <stack>
#include <string>
#include <string_view>
#include <vector>

// Functions that read SVG text.

namespace vantage::test {

/// An XML tag: the text between < and >.
struct Tag {
  std::string name;
  bool is_closing = false;
  bool is_empty = false;
  bool is_good = false;  ///< name and attributes are well-formed
};

inline Tag parse_tag(std::string inside) {
  Tag tag;
  tag.is_closing = inside.starts_with('/');
  tag.is_empty = inside.ends_with('/');
  const std::size_t first = tag.is_closing ? 1 : 0;
  inside = inside.substr(first, inside.size() - first - (tag.is_empty ? 1 : 0));
  const std::size_t name_end = std::min(inside.find(' '), inside.size());
  tag.name = inside.substr(0, name_end);
  tag.is_good = !tag.name.empty() && !(tag.is_closing && name_end != inside.size());
  std::set<std::string> seen;
  std::size_t at = inside.find_first_not_of(' ', name_end);
  while (tag.is_good && at < inside.size()) {
    const std::size_t equals = inside.find("=\"", at);
    const std::size_t end = equals == std::string::npos ? equals : inside.find('"', equals + 2);
    const std::string key = inside.substr(at, equals == std::string::npos ? 0 : equals - at);
    tag.is_good = end != std::string::npos && !key.empty() &&
                  key.find_first_of(" <\"") == std::string::npos && seen.insert(key).second &&
                  (end + 1 == inside.size() || inside[end + 1] == ' ');
    at = tag.is_good ? inside.find_first_not_of(' ', end + 1) : at;
  }
  return tag;
}

/// Returns why `text` is not well-formed XML; empty if it is. Checks that tags are nested and
/// closed, that attributes are quoted and not repeated, and that all entities are known.
inline std::string xml_fault(const std::string& text) {
  constexpr std::array<std::string_view, 5> kEntities = {"&amp;", "&lt;", "&gt;", "&quot;",
                                                         "&apos;"};
  std::stack<std::string> open;
  const std::size_t prologue = text.find("?>");
  for (std::size_t at = prologue == std::string::npos ? 0 : prologue + 2; at < text.size(); ++at) {
    const std::string_view rest = std::string_view(text).substr(at);
    if (rest[0] == '&' && std::none_of(kEntities.begin(), kEntities.end(),
                                       [&](std::string_view e) { return rest.starts_with(e); })) {
      return "unknown entity: " + std::string(rest.substr(0, 60));
    }
    if (rest[0] != '<') {
      continue;
    }
    const std::size_t end = rest.find('>');
    const Tag tag = parse_tag(std::string(rest.substr(1, std::min(end, rest.size()) - 1)));
    if (end == std::string_view::npos || !tag.is_good) {
      return "cannot read: " + std::string(rest.substr(0, 60));
    }
    if (tag.is_closing && (open.empty() || open.top() != tag.name)) {
      return "closes " + tag.name + " that is not open";
    }
    if (tag.is_closing) {
      open.pop();
    } else if (!tag.is_empty) {
      open.push(tag.name);
    }
    at += end;
  }
  return open.empty() ? "" : "never closes " + open.top();
}

inline int count(const std::string& text, const std::string& what) {
  int found = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) {
    ++found;
  }
  return found;
}

/// Returns the attributes of each tag with this name; "words" is the text inside the tag.
inline std::vector<std::map<std::string, std::string>> elements(const std::string& svg,
                                                                const std::string& name) {
  static const std::regex kAttribute(R"re((\S+)="([^"]*)")re");
  std::vector<std::map<std::string, std::string>> out;
  for (auto at = svg.find("<" + name + " "); at != std::string::npos;
       at = svg.find("<" + name + " ", at + 1)) {
    const std::string tag = svg.substr(at, svg.find('>', at) - at);
    auto& attributes = out.emplace_back();
    for (std::sregex_iterator each(tag.begin(), tag.end(), kAttribute);
         each != std::sregex_iterator(); ++each) {
      attributes[(*each)[1]] = (*each)[2];
    }
    const std::size_t words = at + tag.size() + 1;
    attributes["words"] = svg.substr(words, svg.find('<', words) - words);
  }
  return out;
}

inline double number(const std::map<std::string, std::string>& attributes, const char* name) {
  return std::stod(attributes.at(name));
}

}  // namespace vantage::test
