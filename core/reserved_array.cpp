#include "core/reserved_array.hpp"

#include <algorithm>
#include <new>
#include <vector>

#include <sys/mman.h>
#include <unistd.h>

namespace vantage {
namespace {

// Limit of prefault(): most reservations are many times larger than the memory that is used.
constexpr std::size_t kPrefaultMax_bytes = std::size_t{1} << 20U;

std::size_t page_bytes() { return static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)); }

}  // namespace

ReservedBytes::ReservedBytes(std::size_t size) : size_(size) {
  if (size == 0) {
    return;
  }
  begin_ = ::mmap(nullptr, size, PROT_READ | PROT_WRITE,
                  MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (begin_ == MAP_FAILED) {
    begin_ = nullptr;
    throw std::bad_alloc();
  }
}

ReservedBytes::~ReservedBytes() {
  if (begin_ != nullptr) {
    ::munmap(begin_, size_);
  }
}

void ReservedBytes::prefault() {
  auto* bytes = static_cast<volatile unsigned char*>(begin_);
  const std::size_t end = std::min(size_, kPrefaultMax_bytes);
  for (std::size_t at = 0; at < end; at += page_bytes()) {
    bytes[at] = bytes[at];
  }
}

std::size_t ReservedBytes::committed_bytes() const {
  if (size_ == 0) {
    return 0;
  }
  const std::size_t page = page_bytes();
  std::vector<unsigned char> resident((size_ + page - 1) / page);
  if (::mincore(begin_, size_, resident.data()) != 0) {
    return 0;
  }
  const auto count = std::count_if(resident.begin(), resident.end(),
                                   [](unsigned char each) { return (each & 1U) != 0; });
  return page * static_cast<std::size_t>(count);
}

}  // namespace vantage
