#!/bin/bash
# unfused.sh PROGRAM…: checks that no program computes a product and a sum with one rounding
# (docs/decisions/0014). Compilers do this at some levels of optimisation unless they are prevented.
# OBJDUMP: disassembler for the programs' processor; objdump unless set.
set -euo pipefail
status=0
code=$(mktemp)
trap 'rm -f "$code"' EXIT
for program in "$@"; do
  "${OBJDUMP:-objdump}" --disassemble --demangle --no-show-raw-insn "$program" >"$code"
  if awk '/^[0-9a-f]+ <.*>:$/ { where = $0 }
         /\t(vfn?m(add|sub)|fn?m(add|sub)|fml[as])/ { if (where != said) { print where; said = where } print; found = 1 }
         END { exit !found }' "$code"; then
    echo "$program has fused products" >&2
    status=1
  fi
done
exit $status
