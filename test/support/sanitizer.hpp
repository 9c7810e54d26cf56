#pragma once

/// VANTAGE_IS_SANITIZED: 1 where the address or the thread sanitizer is built in, which replaces
/// the allocator, keeps memory that was given back and slows all down; else 0. GCC and Clang say it
/// differently.
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
