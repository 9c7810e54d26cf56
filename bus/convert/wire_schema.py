#!/usr/bin/env python3
"""Prints the layout of .lcm types as C++ tables for bus/convert/wire_walk.hpp.

Usage: wire_schema.py A.lcm B.lcm … > wire_schema.cpp. Reads the part of the LCM language that the
project uses: one struct per file, without its constants, and arrays whose dimensions are constants or
earlier fields.
"""

import re
import sys

DIMS = 4  # kWireDims of bus/convert/wire_walk.hpp
WIDTH = {"int8_t": 1, "byte": 1, "boolean": 1, "int16_t": 2, "int32_t": 4, "float": 4,
         "int64_t": 8, "double": 8}
NUMBER = {"boolean": "kBoolean", "byte": "kByte", "int8_t": "kInt8", "int16_t": "kInt16",
          "int32_t": "kInt32", "int64_t": "kInt64", "float": "kFloat", "double": "kDouble"}
INTEGERS = {"int8_t", "int16_t", "int32_t", "int64_t"}
FIELD = re.compile(r"(\w+)\s+(\w+)((?:\[\w+\])*)$")


def read(path):
    text = re.sub(r"//[^\n]*|/\*.*?\*/", "", open(path, encoding="utf-8").read(), flags=re.S)
    found = re.search(r"struct\s+(\w+)\s*\{(.*)\}", text, flags=re.S)
    fields = []
    for statement in (s.strip() for s in found.group(2).split(";")):
        if statement and not statement.startswith("const "):
            kind, name, dims = FIELD.match(statement).groups()
            fields.append((kind, name, re.findall(r"\[(\w+)\]", dims)))
    return found.group(1), fields


def least_bytes(structs, kind):
    if kind in WIDTH:
        return WIDTH[kind]
    if kind == "string":
        return 5
    total = 0
    for inner, _, dims in structs[kind]:
        count = 1
        for dim in dims:
            count *= int(dim) if dim.isdigit() else 0
        total += count * least_bytes(structs, inner)
    return total


def in_order(structs):
    done = []

    def visit(name):
        if name not in done:
            for kind, _, _ in structs[name]:
                if kind in structs:
                    visit(kind)
            done.append(name)

    for name in structs:
        visit(name)
    return done


def field_text(structs, fields, index):
    kind, own_name, dims = fields[index]
    names = [name for _, name, _ in fields[:index]]
    if len(dims) > DIMS:
        raise SystemExit(f"{kind}: more than {DIMS} dimensions")
    shape = [f"{{{dim}, -1}}" if dim.isdigit() else f"{{0, {names.index(dim)}}}" for dim in dims]
    shape += ["{1, -1}"] * (DIMS - len(shape))
    what = ("kString" if kind == "string" else "kStruct" if kind in structs
            else "kInteger" if kind in INTEGERS else "kBytes")
    nested = f"&k_{kind}" if kind in structs else "nullptr"
    number = NUMBER.get(kind, "kNone")
    return (f"    {{WireKind::{what}, {least_bytes(structs, kind)}, {nested}, "
            f"{{{{{', '.join(shape)}}}}}, \"{own_name}\", WireNumber::{number}, {len(dims)}}},")


def main():
    structs = dict(read(path) for path in sys.argv[1:])
    print('#include "bus/convert/wire_walk.hpp"\n\nnamespace vantage::bus {\nnamespace {\n')
    for name in in_order(structs):
        fields = structs[name]
        print(f"constexpr WireField kFieldsOf_{name}[] = {{")
        print("\n".join(field_text(structs, fields, i) for i in range(len(fields))))
        print(f"}};\nconstexpr WireSchema k_{name}{{\"{name}\", kFieldsOf_{name}}};\n")
    print("}  // namespace\n\nconst WireSchema* find_wire_schema(std::string_view type) {")
    for name in structs:
        print(f"  if (type == k_{name}.name) {{\n    return &k_{name};\n  }}")
    print("  return nullptr;\n}\n\n}  // namespace vantage::bus")


main()
