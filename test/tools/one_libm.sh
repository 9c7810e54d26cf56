#!/bin/bash
# one_libm.sh PROGRAM…: none of them asks the C library for sin, exp, log, …, whose last bits depend on
# the library's version and the processor; they have core/libm instead (docs/decisions/0014).
# A function that is refused here and wanted: from double arguments, or into core/libm.
set -euo pipefail
one='sin|cos|tan|sincos|asin|acos|atan|atan2|sinh|cosh|tanh|asinh|acosh|atanh|exp|exp2|exp10|expm1'
one+='|log|log2|log10|log1p|pow|cbrt|hypot|erf|erfc|tgamma|lgamma|lgamma_r|j0|j1|jn|y0|y1|yn'
status=0
for program in "$@"; do
  # Of double and of float. Of long double only logl is asked for, by libstdc++'s
  # generate_canonical: how many bits a generator has, the same whatever the last digit.
  if nm --dynamic --undefined-only "$program" | grep --extended-regexp " ($one)f?(@|\$)"; then
    echo "$program asks the C library for these" >&2
    status=1
  fi
done
exit $status
