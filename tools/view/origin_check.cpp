#include "tools/view/origin_check.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include <arpa/inet.h>
#include <unistd.h>

namespace vantage::tools {
namespace {

// Returns the host name in lower case: "lab-pc" of "lab-pc:8765", "::1" of "[::1]:8765".
std::string name_of(std::string_view host) {
  if (host.starts_with('[')) {
    host = host.substr(1, std::min(host.find(']'), host.size()) - 1);
  } else {
    host = host.substr(0, host.find(':'));
  }
  std::string out(host);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

bool is_address(const std::string& name) {
  in6_addr parsed{};
  return ::inet_pton(AF_INET, name.c_str(), &parsed) == 1 ||
         ::inet_pton(AF_INET6, name.c_str(), &parsed) == 1;
}

std::string own_name() {
  char name[256] = "";
  return ::gethostname(name, sizeof name - 1) == 0 ? name_of(name) : "";
}

// Returns "host:port" of "http://host:port"; empty for another scheme than http and https.
std::string_view host_of(std::string_view origin) {
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (origin.starts_with(scheme)) {
      return origin.substr(scheme.size());
    }
  }
  return {};
}

}  // namespace

bool is_our_host(std::string_view header, std::span<const std::string> more) {
  const std::string name = name_of(header);
  const std::string own = own_name();
  return name == "localhost" || is_address(name) ||
         (!own.empty() && (name == own || name == own + ".local")) ||
         std::any_of(more.begin(), more.end(),
                     [&](const std::string& each) { return name_of(each) == name; });
}

bool is_known_origin(std::string_view origin, std::string_view host,
                     std::span<const std::string> more) {
  constexpr std::array<std::string_view, 3> kFoxglove = {"https://app.foxglove.dev",
                                                         "https://studio.foxglove.dev", "file://"};
  const std::string_view from = host_of(origin);
  const std::string name = name_of(from);
  return (!from.empty() && from == host) || name == "localhost" || name == "127.0.0.1" ||
         name == "::1" ||
         std::find(kFoxglove.begin(), kFoxglove.end(), origin) != kFoxglove.end() ||
         std::find(more.begin(), more.end(), origin) != more.end();
}

bool is_same_origin(std::string_view origin, std::string_view host) {
  const std::string_view from = host_of(origin);
  return !from.empty() && from == host;
}

bool is_loopback(std::string_view address) {
  return address == "localhost" || address == "::1" || address.starts_with("127.");
}

}  // namespace vantage::tools
