/* Declares musl's functions (libm.cmake) under separate symbol names for all code that includes
   <cmath> (first/cmath). Assembler names are used instead of macros, so that the templates of Eigen
   and libstdc++, which call std::log, use these functions as well.

   Functions that IEEE 754 rounds correctly are absent, because their results are the same everywhere:
   sqrt, fma, fmod, remainder, floor, ceil, trunc, round, ldexp, …
   `const`: the functions keep no state and do not change errno. */
#ifndef VANTAGE_CORE_LIBM_NAMES_H
#define VANTAGE_CORE_LIBM_NAMES_H

extern "C" {
#define VANTAGE_LIBM_1(name) \
  double name(double) noexcept __asm__("vantage_" #name) __attribute__((const));
#define VANTAGE_LIBM_2(name) \
  double name(double, double) noexcept __asm__("vantage_" #name) __attribute__((const));

VANTAGE_LIBM_1(sin)
VANTAGE_LIBM_1(cos)
VANTAGE_LIBM_1(tan)
VANTAGE_LIBM_1(asin)
VANTAGE_LIBM_1(acos)
VANTAGE_LIBM_1(atan)
VANTAGE_LIBM_2(atan2)
VANTAGE_LIBM_1(exp)
VANTAGE_LIBM_1(exp2)
VANTAGE_LIBM_1(expm1)
VANTAGE_LIBM_1(log)
VANTAGE_LIBM_1(log10)
VANTAGE_LIBM_1(log1p)
VANTAGE_LIBM_2(pow)
VANTAGE_LIBM_2(hypot)
VANTAGE_LIBM_1(erf)
VANTAGE_LIBM_1(erfc)

#undef VANTAGE_LIBM_1
#undef VANTAGE_LIBM_2
}
#endif
