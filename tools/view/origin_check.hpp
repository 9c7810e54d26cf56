#pragma once

#include <span>
#include <string>
#include <string_view>

// Checks of a browser's Host and Origin headers. Pure, except that the host's name is read.

namespace vantage::tools {

/// True if a Host header ("lab-pc:8765") contains an IP address, localhost, this host's own name
/// (with or without .local) or one of `more`. An attacker can make other names resolve to this
/// server's address (DNS rebinding).
bool is_our_host(std::string_view header, std::span<const std::string> more);

/// True if an Origin header names this server's own page (from `host`), a page of localhost,
/// Foxglove's application or site, or one of `more`.
bool is_known_origin(std::string_view origin, std::string_view host,
                     std::span<const std::string> more);

/// True if an Origin header names exactly the server that the Host header names. Requests that
/// change something must pass this check: a browser sends the Origin with every POST, and a page of
/// another site or port cannot change it.
bool is_same_origin(std::string_view origin, std::string_view host);

/// True if an address to serve on can be reached from this machine only.
bool is_loopback(std::string_view address);

}  // namespace vantage::tools
