#pragma once

#include <span>
#include <string>
#include <string_view>

// Which browsers' requests are meant for this server. Pure but for the host's own name.

namespace vantage::tools {

/// True for a Host header ("lab-pc:8765") that names an address, localhost, this host's own name
/// (with or without .local) or one of `more`. Another name may be anyone's who lets it mean our
/// address.
bool is_our_host(std::string_view header, std::span<const std::string> more);

/// True for an Origin header of our own page (that of `host`), of this machine's pages, of
/// Foxglove's application and site, or one of `more`.
bool is_known_origin(std::string_view origin, std::string_view host,
                     std::span<const std::string> more);

}  // namespace vantage::tools
