#pragma once

#include <string>
#include <utility>
#include <variant>

namespace vantage {

/// Reason why an operation returned no value. The text explains to the reader of a log how to
/// react.
struct Error {
  std::string message;
};

/// Either a T or the Error that explains its absence (std::expected in C++23). For failures that
/// are expected in a running robot: a singular matrix, a truncated packet.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::move(value)) {}      // NOLINT(google-explicit-constructor)
  Result(Error error) : content_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool ok() const { return std::holds_alternative<T>(content_); }
  /// Returns the value. Precondition: ok(), otherwise throws std::bad_variant_access.
  [[nodiscard]] const T& value() const& { return std::get<T>(content_); }
  [[nodiscard]] T&& value() && { return std::get<T>(std::move(content_)); }
  /// Returns the error. Precondition: !ok().
  [[nodiscard]] const Error& error() const { return std::get<Error>(content_); }

 private:
  std::variant<T, Error> content_;
};

}  // namespace vantage
