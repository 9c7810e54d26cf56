#!/bin/bash
# unfused.sh PROGRAM…: none of them computes a product and a sum with one rounding (docs/decisions/0014);
# compilers do so where they are not kept from it, at one level of optimisation and not at another.
set -euo pipefail
status=0
for program in "$@"; do
  if objdump --disassemble --demangle --no-show-raw-insn "$program" |
    awk '/^[0-9a-f]+ <.*>:$/ { where = $0 }
         /\tvfn?m(add|sub)/ { if (where != said) { print where; said = where } print; found = 1 }
         END { exit !found }'; then
    echo "$program has fused products" >&2
    status=1
  fi
done
exit $status
