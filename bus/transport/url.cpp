#include "bus/transport/url.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <sstream>

#include <arpa/inet.h>
#include <net/if.h>
#include <netinet/in.h>

#include "core/check.hpp"

namespace vantage::bus {
namespace {

int number_in(const std::string& text, int min, int max, const std::string& what) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value < min || value > max) {
    throw StartupError("LCM url: " + what + " is '" + text + "', must be a whole number in [" +
                       std::to_string(min) + ", " + std::to_string(max) + "]");
  }
  return value;
}

std::string checked_interface(const std::string& text) {
  const bool is_name = !text.empty() && text.size() < IF_NAMESIZE &&
                       text.find_first_of("/ \t%") == std::string::npos;
  if (!is_name) {
    throw StartupError("LCM url: interface is '" + text +
                       "', must be the name of a network card (see 'ip link') or its IPv4 address");
  }
  return text;
}

std::vector<UdpmPeer> checked_peers(const std::string& text) {
  constexpr std::size_t kPeersMax = 256;
  std::vector<UdpmPeer> peers;
  std::istringstream list(text);
  for (std::string item; std::getline(list, item, ',');) {
    const std::size_t colon = item.find(':');
    in_addr host{};
    const std::string address = item.substr(0, colon);
    if (colon == std::string::npos || inet_pton(AF_INET, address.c_str(), &host) != 1 ||
        IN_MULTICAST(ntohl(host.s_addr))) {
      throw StartupError("LCM url: peer is '" + item +
                         "', must be the IPv4 address of a host and a port, such as "
                         "192.168.1.21:7668");
    }
    const UdpmPeer peer{address, number_in(item.substr(colon + 1), 1, 65'535, "port of a peer")};
    if (std::find(peers.begin(), peers.end(), peer) != peers.end()) {
      throw StartupError("LCM url: peer '" + item + "' is given twice");
    }
    peers.push_back(peer);
  }
  if (peers.empty() || peers.size() > kPeersMax) {
    throw StartupError("LCM url: peers has " + std::to_string(peers.size()) +
                       " entries, must have 1 to " + std::to_string(kPeersMax));
  }
  return peers;
}

}  // namespace

Url parse_url(const std::string& url) {
  const std::size_t colon = url.find("://");
  if (colon == std::string::npos || colon == 0) {
    throw StartupError("LCM url '" + url + "' does not have the form of " + kDefaultUrl);
  }
  Url parsed;
  parsed.scheme = url.substr(0, colon);
  const std::size_t question = url.find('?', colon + 3);
  parsed.target = url.substr(colon + 3, question - (colon + 3));
  if (question == std::string::npos) {
    return parsed;
  }
  std::istringstream options(url.substr(question + 1));
  for (std::string option; std::getline(options, option, '&');) {
    const std::size_t equals = option.find('=');
    const bool is_pair = equals != std::string::npos && equals > 0;
    if (!is_pair ||
        !parsed.options.emplace(option.substr(0, equals), option.substr(equals + 1)).second) {
      throw StartupError("LCM url '" + url + "': option '" + option +
                         "' is not name=value, or is given twice");
    }
  }
  return parsed;
}

std::string url_or_default(const std::string& url) {
  const char* from_environment = std::getenv("LCM_DEFAULT_URL");
  if (!url.empty()) {
    return url;
  }
  return from_environment != nullptr && *from_environment != '\0' ? from_environment : kDefaultUrl;
}

std::string with_udpm_option(const std::string& url, const std::string& name,
                             const std::string& value) {
  const Url parsed = parse_url(url);
  if (parsed.scheme != "udpm" || parsed.options.contains(name)) {
    return url;
  }
  return url + (parsed.options.empty() && url.find('?') == std::string::npos ? "?" : "&") + name +
         "=" + value;
}

UdpmAddress parse_udpm(const Url& url) {
  constexpr int kBytesMin = 2048;
  constexpr int kBytesMax = 1 << 30;
  UdpmAddress address;
  const std::size_t colon = url.target.find(':');
  if (!url.target.empty()) {
    address.group = url.target.substr(0, colon);
  }
  if (colon != std::string::npos) {
    address.port = number_in(url.target.substr(colon + 1), 1, 65'535, "port");
  }
  in_addr group{};
  if (inet_pton(AF_INET, address.group.c_str(), &group) != 1 ||
      !IN_MULTICAST(ntohl(group.s_addr))) {
    throw StartupError("LCM url: '" + address.group +
                       "' is not an IPv4 multicast address (224.0.0.0 to 239.255.255.255)");
  }
  for (const auto& [name, value] : url.options) {
    if (name == "ttl") {
      address.ttl = number_in(value, 0, 255, name);
    } else if (name == "recv_buf_size") {
      address.recv_buf_bytes = number_in(value, kBytesMin, kBytesMax, name);
    } else if (name == "max_message_size") {
      address.message_bytes_max = number_in(value, kBytesMin, kBytesMax, name);
    } else if (name == "interface") {
      address.interface = checked_interface(value);
    } else if (name == "peers") {
      address.peers = checked_peers(value);
    } else {
      throw StartupError("LCM url: udpm has no option '" + name +
                         "' (ttl, recv_buf_size, max_message_size, interface, peers)");
    }
  }
  if (!address.peers.empty() && address.ttl > 0) {
    throw StartupError("LCM url: ttl is " + std::to_string(address.ttl) +
                       ", must be 0 with peers: messages leave this host by unicast");
  }
  if (!address.peers.empty() && !address.interface.empty()) {
    throw StartupError("LCM url: interface is " + address.interface +
                       ", must be left out with peers: the routes to the peers choose the card");
  }
  return address;
}

}  // namespace vantage::bus
