#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

namespace vantage {

/// Reserved address space of a fixed size. It reads as zeros; the system assigns memory to a page
/// when the page is first written. So a reservation for the worst case uses physical memory only
/// for pages that were written.
class ReservedBytes {
 public:
  ReservedBytes() = default;
  /// @throws std::bad_alloc when the system refuses the address space.
  explicit ReservedBytes(std::size_t size);
  ~ReservedBytes();
  ReservedBytes(const ReservedBytes&) = delete;
  ReservedBytes& operator=(const ReservedBytes&) = delete;
  ReservedBytes(ReservedBytes&& other) noexcept
      : begin_(std::exchange(other.begin_, nullptr)), size_(std::exchange(other.size_, 0)) {}
  ReservedBytes& operator=(ReservedBytes&& other) noexcept {
    std::swap(begin_, other.begin_);
    std::swap(size_, other.size_);
    return *this;
  }

  [[nodiscard]] void* begin() const { return begin_; }
  [[nodiscard]] std::size_t size() const { return size_; }
  /// Commits the first MiB: no page fault occurs there later. The content does not change.
  void prefault();
  /// Returns the committed bytes, in whole pages. For tests and reports; needs a system call.
  [[nodiscard]] std::size_t committed_bytes() const;

 private:
  void* begin_ = nullptr;
  std::size_t size_ = 0;
};

/// Fixed-size array in ReservedBytes. All bytes are initially zero; no constructor of T is called.
template <class T>
class ReservedArray {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  ReservedArray() = default;
  explicit ReservedArray(std::size_t size) : bytes_(size * sizeof(T)), size_(size) {}
  ~ReservedArray() = default;
  ReservedArray(const ReservedArray&) = delete;
  ReservedArray& operator=(const ReservedArray&) = delete;
  ReservedArray(ReservedArray&& other) noexcept
      : bytes_(std::move(other.bytes_)), size_(std::exchange(other.size_, 0)) {}
  ReservedArray& operator=(ReservedArray&& other) noexcept {
    bytes_ = std::move(other.bytes_);
    std::swap(size_, other.size_);
    return *this;
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] T* data() { return static_cast<T*>(bytes_.begin()); }
  [[nodiscard]] const T* data() const { return static_cast<const T*>(bytes_.begin()); }
  [[nodiscard]] T* begin() { return data(); }
  [[nodiscard]] T* end() { return data() + size_; }
  [[nodiscard]] const T* begin() const { return data(); }
  [[nodiscard]] const T* end() const { return data() + size_; }
  T& operator[](std::size_t i) { return data()[i]; }
  const T& operator[](std::size_t i) const { return data()[i]; }

  void prefault() { bytes_.prefault(); }
  [[nodiscard]] std::size_t committed_bytes() const { return bytes_.committed_bytes(); }

 private:
  ReservedBytes bytes_;
  std::size_t size_ = 0;
};

}  // namespace vantage
