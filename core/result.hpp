#pragma once

#include <string>
#include <utility>
#include <variant>

namespace vantage {

/// Why an operation gave no value, in words that a log reader can act on.
struct Error {
  std::string message;
};

/// Either a T or the Error that explains its absence (C++23 would call it std::expected); for
/// failures that are expected in a running robot: a singular matrix, a truncated packet.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::move(value)) {}      // NOLINT(google-explicit-constructor)
  Result(Error error) : content_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool ok() const { return std::holds_alternative<T>(content_); }
  /// The value. Precondition: ok(), else std::bad_variant_access.
  [[nodiscard]] const T& value() const& { return std::get<T>(content_); }
  [[nodiscard]] T&& value() && { return std::get<T>(std::move(content_)); }
  /// The error. Precondition: !ok().
  [[nodiscard]] const Error& error() const { return std::get<Error>(content_); }

 private:
  std::variant<T, Error> content_;
};

}  // namespace vantage
