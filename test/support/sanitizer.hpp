#pragma once

/// VANTAGE_IS_SANITIZED: 1 with the address or the thread sanitizer, which replaces the allocator,
/// keeps freed memory and slows everything down; else 0. GCC and Clang use different macros.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define VANTAGE_IS_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define VANTAGE_IS_SANITIZED 1
#endif
#endif
#ifndef VANTAGE_IS_SANITIZED
#define VANTAGE_IS_SANITIZED 0
#endif
