#!/bin/bash
# one_libm.sh PROGRAM…: checks that no program calls sin, exp, log, … of the C library. Their last
# bits depend on the library's version and the processor; core/libm replaces them
# (docs/decisions/0014). If a refused function is needed: call it with double arguments, or add it
# to core/libm.
set -euo pipefail
one='sin|cos|tan|sincos|asin|acos|atan|atan2|sinh|cosh|tanh|asinh|acosh|atanh|exp|exp2|exp10|expm1'
one+='|log|log2|log10|log1p|pow|cbrt|hypot|erf|erfc|tgamma|lgamma|lgamma_r|j0|j1|jn|y0|y1|yn'
status=0
for program in "$@"; do
  # Checks functions of double and float. The only function of long double in use is logl: libstdc++'s
  # generate_canonical computes a generator's number of bits with it, where the last digit has no effect.
  if nm --dynamic --undefined-only "$program" | grep --extended-regexp " ($one)f?(@|\$)"; then
    echo "$program asks the C library for these" >&2
    status=1
  fi
done
exit $status
