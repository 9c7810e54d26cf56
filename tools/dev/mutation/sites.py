"""Finds the places in a C++ file where one small bug can be inserted, from the syntax tree of libclang.

A site is one mutation: a part of the source and its replacement. The operators are kinds of bugs that
programmers make and tests miss:

  comparison  a < b -> a > b; also -> a <= b, except for floating point (equality is too rare); !a -> a
  sign        a + b -> a - b, a += b -> a -= b, -a -> a
  term        a + b -> a, -> b; likewise a * b, a && b, a || b; c ? a : b -> a, -> b
  constant    a number is doubled or halved
  minmax      min <-> max, also Eigen's and element-wise ones; clamp(x, low, high) -> x
  abs         abs(x) -> x
  index       a[i] -> a[i + 1], a[i - 1]; x() <-> y(), z() -> y(); front() <-> back()
  return      an early return, a continue, or a break out of a loop is removed
  reset       an assignment (=, +=, ++, ...), .reset(), .clear() or the like is removed
  swap        two neighbouring arguments or initialisers of the same type are swapped
  unit        a value with a unit in its name is scaled to another unit; a factor 1e3, 1e-6, 60, ... is removed

  Not mutated: comments and string literals, log messages, static assertions, declarations (parameters,
  template arguments, case labels, enumerators, bounds of arrays), and expansions of macros.
  """

import collections
import dataclasses
import hashlib
import os
import re
import sys

# Debian's module is pure Python, so any interpreter can import it.
sys.path.append("/usr/lib/python3/dist-packages")
try:
    from clang import cindex
    from clang.cindex import CursorKind as Kind
    from clang.cindex import TypeKind
except ImportError:
    cindex = None

OPERATORS = ("comparison", "sign", "term", "constant", "minmax", "abs", "index", "return", "reset",
             "swap", "unit")

TURNED = {"<": ">", ">": "<", "<=": ">=", ">=": "<=", "==": "!=", "!=": "=="}
EDGE = {"<": "<=", "<=": "<", ">": ">=", ">=": ">"}
SIGNS = {"+": "-", "-": "+", "+=": "-=", "-=": "+="}
ASSIGNS = {"=", "+=", "-=", "*=", "/=", "|=", "&=", "^=", "<<=", ">>="}
BINARY = set(TURNED) | set(SIGNS) | ASSIGNS | {"*", "/", "%", "&&", "||"}
OTHER_EXTREME = {"min": "max", "fmin": "fmax", "min_element": "max_element", "minCoeff": "maxCoeff",
                 "cwiseMin": "cwiseMax"}
OTHER_EXTREME |= {big: small for small, big in OTHER_EXTREME.items()}
NEIGHBOUR = {"x": "y", "y": "x", "z": "y", "front": "back", "back": "front"}
RESETS = {"reset", "clear", "fill", "setZero", "erase", "pop_front", "pop_back"}
SYMMETRIC = {"min", "max", "fmin", "fmax", "hypot", "swap"}
# For each unit suffix of a name: the factor between this unit and a similar unit that a bug may use.
UNIT_FACTORS = {"s": "1e-3", "ms": "1e3", "us": "1e3", "ns": "1e3", "m": "1e3", "mm": "1e-3",
                "rad": "57.29577951308232", "deg": "0.017453292519943295", "mps": "3.6",
                "radps": "57.29577951308232", "share": "100", "hz": "1e-3"}
UNIT_NAME = re.compile(r"_(" + "|".join(UNIT_FACTORS) + r")_?$")
UNIT_NUMBERS = {10.0 ** n for n in (-9, -6, -3, -2, 2, 3, 6, 9)} | {60.0, 3600.0, 180.0, 3.6}
NUMBER = re.compile(r"(\d[\d']*(?:\.\d*)?(?:[eE][-+]?\d+)?|\.\d+(?:[eE][-+]?\d+)?)([uUlLfFzZ]*)$")
SHOWN_MAX = 240
SHOWN_AROUND = 40
LENIENT = ("-Wno-everything", "-fconstexpr-steps=100000000")  # enough for constant expressions that GCC accepts
LOG = re.compile(r"\s*(spdlog::|logger?(\.|->|\())")


class CannotParse(Exception):
    pass


@dataclasses.dataclass(frozen=True)
class Site:
    id: str
    file: str
    line: int
    operator: str
    before: str  # the expression or statement that is changed, in one line
    after: str
    begin: int  # byte offset in the file where the replaced part begins
    end: int
    replacement: bytes

    def apply(self, source):
        return source[:self.begin] + self.replacement + source[self.end:]


@dataclasses.dataclass(frozen=True)
class Body:
    """Content between the braces of a function, as byte offsets in its file."""
    begin: int
    end: int
    is_void: bool  # the function may end without a return


def is_available():
    return cindex is not None


def parse_arguments(command):
    """Returns the arguments of a compiler's command line that libclang needs."""
    kept = []
    words = iter(command)
    for word in words:
        if word in ("-isystem", "-I", "-D"):
            kept += [word, next(words)]
        elif word.startswith(("-I", "-D", "-std=", "-isystem", "-march=")):
            kept.append(word)
    return kept


def find_sites(path, name, arguments):
    """Returns the sites of the file at `path`, called `name` in the ledger, in the order of their offsets."""
    source, unit = _parsed(path, name, arguments)
    finder = _Finder(str(path), source)
    for cursor in unit.cursor.get_children():
        if cursor.location.file is not None and cursor.location.file.name == str(path):
            if cursor.kind == Kind.MACRO_INSTANTIATION:
                finder.macros.append((cursor.extent.start.offset, cursor.extent.end.offset))
    for cursor in unit.cursor.get_children():
        if cursor.location.file is not None and cursor.location.file.name == str(path):
            finder.walk(cursor, [])
    return _named(finder.found, source, name)


def find_bodies(path, name, arguments):
    """Returns the functions that the file defines, except constexpr and consteval ones, in the order of their offsets."""
    source, unit = _parsed(path, name, arguments)
    found = []

    def walk(cursor):
        for child in cursor.get_children():
            if child.location.file is None or child.location.file.name != str(path):
                continue
            if child.kind not in FUNCTIONS:
                walk(child)
                continue
            inner = [c for c in child.get_children() if c.kind == Kind.COMPOUND_STMT]
            begin = child.extent.start.offset
            if inner and not re.search(rb"\bconst(expr|eval)\b", source[begin:inner[-1].extent.start.offset]):
                found.append(Body(inner[-1].extent.start.offset + 1, inner[-1].extent.end.offset - 1,
                                  child.kind in (Kind.CONSTRUCTOR, Kind.DESTRUCTOR) or
                                  child.result_type.get_canonical().kind == TypeKind.VOID))

    walk(unit.cursor)
    return sorted(found, key=lambda body: body.begin)


def _parsed(path, name, arguments):
    """Returns the bytes of a file and its syntax tree."""
    with open(path, "rb") as file:
        source = file.read()
    read, unsaved = str(path), []
    if read.endswith(".hpp"):
        # Parses a file that includes the header, as in a build, because a header may include itself indirectly.
        read = f"{path}.cpp"
        unsaved = [(read, f'#include "{path}"\n')]
    unit = cindex.Index.create().parse(
        read, args=[*arguments, *LENIENT], unsaved_files=unsaved,
        options=cindex.TranslationUnit.PARSE_DETAILED_PROCESSING_RECORD)
    errors = [d for d in unit.diagnostics if d.severity >= cindex.Diagnostic.Error]
    if errors:
        raise CannotParse(f"{name}: libclang: {errors[0].spelling} ({errors[0].location})")
    return source, unit


def _named(found, source, name):
    """Returns the sites with ids. An id is a hash of function, expression, change and the index among equal changes. It
    does not depend on other lines."""
    sites = []
    same = collections.Counter()
    places = {}  # only the first of equal changes at a place is kept
    for entry in found:
        places.setdefault((entry[2], entry[3], entry[4]), entry)
    order = OPERATORS.index
    for place, entry in sorted(places.items(), key=lambda item: (item[0], order(item[1][0]))):
        operator, context, begin, end, replacement, outer, at = entry
        before = " ".join(source[outer[0]:outer[1]].decode().split())
        after = " ".join((source[outer[0]:begin] + replacement + source[end:outer[1]]).decode().split())
        if before == after:
            continue
        key = "\0".join((name, context, operator, before, after))
        same[key] += 1
        digest = hashlib.sha256(f"{key}\0{same[key]}".encode()).hexdigest()[:8]
        line = source.count(b"\n", 0, at) + 1
        sites.append(Site(digest, name, line, operator, *_shown(before, after), begin, end, replacement))
    return sites


def _shown(before, after):
    """Returns both texts, with long common parts shortened."""
    if max(len(before), len(after)) <= SHOWN_MAX:
        return before, after
    head = len(os.path.commonprefix((before, after)))
    tail = min(len(os.path.commonprefix((before[::-1], after[::-1]))), min(len(before), len(after)) - head)

    def cut(text):
        begin, end = max(0, head - SHOWN_AROUND), len(text) - max(0, tail - SHOWN_AROUND)
        middle = text[begin:end]
        if len(middle) > SHOWN_MAX:
            middle = f"{middle[:SHOWN_MAX // 2]} ... {middle[-SHOWN_MAX // 2:]}"
        return f"{'... ' if begin else ''}{middle}{' ...' if end < len(text) else ''}"

    return cut(before), cut(after)


if cindex is not None:
    FUNCTIONS = (Kind.FUNCTION_DECL, Kind.CXX_METHOD, Kind.CONSTRUCTOR, Kind.DESTRUCTOR,
                 Kind.CONVERSION_FUNCTION, Kind.FUNCTION_TEMPLATE)
    LOOPS = (Kind.FOR_STMT, Kind.WHILE_STMT, Kind.DO_STMT, Kind.CXX_FOR_RANGE_STMT)
    SKIPPED = (Kind.STATIC_ASSERT, Kind.PARM_DECL, Kind.ENUM_DECL, Kind.TYPE_REF, Kind.TEMPLATE_REF,
               Kind.NAMESPACE_REF, Kind.TEMPLATE_NON_TYPE_PARAMETER, Kind.TEMPLATE_TYPE_PARAMETER,
               Kind.TYPE_ALIAS_DECL, Kind.TYPEDEF_DECL, Kind.MACRO_DEFINITION,
               Kind.MACRO_INSTANTIATION, Kind.INCLUSION_DIRECTIVE, Kind.DECL_REF_EXPR,
               Kind.TYPE_ALIAS_TEMPLATE_DECL, Kind.FRIEND_DECL)
    FLOATING = (TypeKind.FLOAT, TypeKind.DOUBLE, TypeKind.LONGDOUBLE)


def _is_floating(type_):
    return type_.get_canonical().kind in FLOATING


def _is_integer(type_):
    return TypeKind.BOOL.value < type_.get_canonical().kind.value <= TypeKind.INT128.value


def _is_number(type_):
    return _is_floating(type_) or _is_integer(type_)


def _is_text_or_place(type_):
    """Returns true for a string, pointer, path or iterator, whose + and - are not arithmetic."""
    canonical = type_.get_canonical()
    name = canonical.spelling
    return canonical.kind in (TypeKind.POINTER, TypeKind.CONSTANTARRAY, TypeKind.INCOMPLETEARRAY) or \
        any(word in name for word in ("basic_string", "iterator", "path"))


def _plain(type_):
    name = type_.get_canonical().spelling
    return re.sub(r"\bconst\b|\bvolatile\b|&", "", name).strip()


class _Finder:
    def __init__(self, path, source):
        self.path = path
        self.source = source
        self.macros = []
        self.found = []

    # --- text of the source ---

    def extent(self, cursor):
        return cursor.extent.start.offset, cursor.extent.end.offset

    def text(self, begin, end):
        return self.source[begin:end].decode()

    def text_of(self, cursor):
        return self.text(*self.extent(cursor))

    def bare(self, begin, end):
        """Returns the text without comments, and without blanks at its ends."""
        return re.sub(r"//[^\n]*|/\*.*?\*/", "", self.text(begin, end), flags=re.S).strip()

    def add(self, operator, stack, begin, end, replacement, outer=None, at=None):
        outer = outer or (begin, end)
        if not outer[0] <= begin <= end <= outer[1] or outer[0] == outer[1]:
            return
        if any(low < outer[1] and outer[0] < high for low, high in self.macros):
            return
        context = "::".join(c.spelling for c in stack if c.kind in FUNCTIONS or c.kind.is_declaration())
        self.found.append((operator, context, begin, end, replacement.encode(), outer,
                           begin if at is None else at))

    # --- nodes of the tree ---

    def walk(self, cursor, stack):
        kind = cursor.kind
        if kind in SKIPPED:
            if kind == Kind.DECL_REF_EXPR:
                self.unit_of_name(cursor, stack)
            return
        children = list(cursor.get_children())
        self.look(cursor, children, stack)
        inner = stack + [cursor]
        if kind == Kind.CALL_EXPR and LOG.match(self.text_of(cursor)):
            return
        if kind in FUNCTIONS:
            # Only the initialisers of members and the body are executed. The rest is the declaration, which is skipped.
            children = [c for c in children if c.extent.start.offset > cursor.location.offset and
                        (c.kind.is_expression() or c.kind.is_statement())]
        elif kind in (Kind.VAR_DECL, Kind.FIELD_DECL):
            # Skips the type, which is before the name.
            children = [c for c in children if c.extent.start.offset > cursor.location.offset and
                        not self.is_bound(c)]
        elif kind == Kind.MEMBER_REF_EXPR:
            children = [c for c in children if c.extent.start.offset < cursor.location.offset]
        elif kind == Kind.CASE_STMT:
            children = children[1:]
        for child in children:
            self.walk(child, inner)

    def is_bound(self, cursor):
        before = self.source[:cursor.extent.start.offset].rstrip()
        return before.endswith(b"[")

    def look(self, cursor, children, stack):
        kind = cursor.kind
        if kind in (Kind.BINARY_OPERATOR, Kind.COMPOUND_ASSIGNMENT_OPERATOR) and len(children) == 2:
            self.binary(cursor, children[0], children[1], stack)
        elif kind == Kind.UNARY_OPERATOR and len(children) == 1:
            self.unary(cursor, children[0], stack)
        elif kind == Kind.CONDITIONAL_OPERATOR and len(children) == 3:
            for kept in children[1:]:
                self.add("term", stack, *self.extent(cursor), f"({self.text_of(kept)})")
        elif kind in (Kind.FLOATING_LITERAL, Kind.INTEGER_LITERAL):
            self.number(cursor, stack)
        elif kind == Kind.CALL_EXPR:
            self.call(cursor, children, stack)
        elif kind == Kind.INIT_LIST_EXPR:
            self.swaps(cursor, children, stack)
        elif kind == Kind.ARRAY_SUBSCRIPT_EXPR and len(children) == 2:
            self.index(cursor, children[1], stack)
        elif kind == Kind.MEMBER_REF_EXPR:
            self.unit_of_name(cursor, stack)
        elif kind in (Kind.RETURN_STMT, Kind.CONTINUE_STMT, Kind.BREAK_STMT):
            self.leaving(cursor, stack)
        if kind in (Kind.COMPOUND_STMT, Kind.CASE_STMT, Kind.DEFAULT_STMT):
            for child in children[1:] if kind == Kind.CASE_STMT else children:
                self.statement(child, stack + [cursor])

    def binary(self, cursor, left, right, stack):
        begin, end = self.extent(cursor)
        left_end, right_begin = left.extent.end.offset, right.extent.start.offset
        operator = self.bare(left_end, right_begin)
        if operator not in BINARY or not begin <= left_end <= right_begin <= end:
            return
        at = left_end + self.text(left_end, right_begin).index(operator)
        at_end = at + len(operator)
        whole = (begin, end)
        keep_left = self.text(begin, left_end)
        keep_right = self.text(right_begin, end)
        is_odd = _is_text_or_place(left.type) or _is_text_or_place(cursor.type) or \
            _is_text_or_place(right.type)
        if operator in TURNED:
            self.add("comparison", stack, at, at_end, TURNED[operator], whole)
            if operator in EDGE and not _is_floating(left.type) and not _is_floating(right.type):
                self.add("comparison", stack, at, at_end, EDGE[operator], whole)
        if operator in SIGNS and not is_odd and self.fits(left, cursor):
            self.add("sign", stack, at, at_end, SIGNS[operator], whole)
        is_product = operator in ("*", "/") and _is_number(left.type) and _is_number(right.type)
        if operator in ("&&", "||") or (operator in ("+", "-") and not is_odd) or is_product:
            if self.fits(left, cursor):
                self.add("term", stack, begin, end, f"({keep_left})", at=at)
            if operator != "/" and self.fits(right, cursor):
                minus = "-" if operator == "-" else ""
                self.add("term", stack, begin, end, f"({minus}{keep_right})", at=at)
        if is_product:
            for side in (left, right):
                text = self.text_of(side)
                if NUMBER.match(text) and self.value(text) in UNIT_NUMBERS:
                    self.add("unit", stack, *self.extent(side), "1.0", whole)

    @staticmethod
    def fits(part, whole):
        """Returns true if an expression `part` can replace `whole`. (A time cannot replace a difference of two times.)"""
        names = _plain(part.type), _plain(whole.type)
        return all(_is_number(c.type) or "Eigen" in name for c, name in zip((part, whole), names)) or \
            names[0] == names[1]

    def unary(self, cursor, operand, stack):
        begin, end = self.extent(cursor)
        operator = self.bare(begin, operand.extent.start.offset)
        kept = f"({self.text_of(operand)})"
        if operator == "!":
            self.add("comparison", stack, begin, end, kept)
        elif operator == "-":
            self.add("sign", stack, begin, end, kept)

    @staticmethod
    def value(text):
        match = NUMBER.match(text)
        return float(match.group(1).replace("'", ""))

    def number(self, cursor, stack):
        text = self.text_of(cursor)
        match = NUMBER.match(text)
        if not match or self.value(text) == 0.0 or self.is_bound(cursor):
            return
        if any(c.kind == Kind.ARRAY_SUBSCRIPT_EXPR or c.spelling in ("operator[]", "operator()")
               for c in stack[-3:]):
            return  # a number that is an index is mutated by index()
        digits = match.group(1).replace("'", "")
        if digits.isdigit() and not digits.startswith("0"):
            doubled, halved = (f"{n}{match.group(2)}" for n in (2 * int(digits), int(digits) // 2))
        else:
            doubled, halved = f"(2 * {text})", f"({text} / 2)"
        begin, end = self.extent(cursor)
        outer = self.shown_around(cursor, stack)
        self.add("constant", stack, begin, end, doubled, outer)
        self.add("constant", stack, begin, end, halved, outer)

    def shown_around(self, cursor, stack):
        """Returns the extent to show for a number: the innermost expression or declaration around it."""
        own = self.extent(cursor)
        for around in reversed(stack):
            begin, end = self.extent(around)
            if begin <= own[0] and own[1] <= end and end - begin > own[1] - own[0]:
                is_small = around.kind.is_expression() or around.kind in (Kind.VAR_DECL, Kind.FIELD_DECL)
                return (begin, end) if is_small and end - begin < 200 else own
        return own

    def callee(self, cursor, children):
        """Returns (begin, end, name) of the called function's name; None if it cannot be found."""
        if not children:
            return None
        first = children[0]
        begin, end = self.extent(first)
        if begin != cursor.extent.start.offset or end >= cursor.extent.end.offset:
            return None
        match = re.search(r"([A-Za-z_]\w*)\s*(<[^<>()]*>)?\s*$", self.text(begin, end))
        if not match:
            return None
        return begin + match.start(1), begin + match.end(1), match.group(1)

    def arguments(self, cursor):
        begin, end = self.extent(cursor)
        out = []
        for argument in cursor.get_arguments():
            if argument is None:
                continue
            low, high = self.extent(argument)
            if begin < low < high <= end and argument.location.file is not None:
                out.append(argument)
        return out

    def call(self, cursor, children, stack):
        name = cursor.spelling
        whole = self.extent(cursor)
        arguments = self.arguments(cursor)
        if name.startswith("operator") and not name[8:9].isalnum():
            self.called_operator(cursor, children, stack)
            return
        callee = self.callee(cursor, children)
        if callee:
            low, high, word = callee
            if word in OTHER_EXTREME and "numeric_limits" not in self.text(whole[0], high) and \
                    "::max()" not in self.text(*whole):
                self.add("minmax", stack, low, high, OTHER_EXTREME[word], whole)
            elif word == "clamp" and len(arguments) == 3:
                self.add("minmax", stack, *whole, f"({self.text_of(arguments[0])})")
            elif word in ("abs", "fabs") and len(arguments) == 1:
                self.add("abs", stack, *whole, f"({self.text_of(arguments[0])})")
            elif word == "cwiseAbs" and self.text(*whole).endswith(".cwiseAbs()"):
                self.add("abs", stack, *whole, self.text(whole[0], whole[1] - len(".cwiseAbs()")))
            elif word in NEIGHBOUR and not arguments and self.source[low - 1:low] in (b".", b">"):
                self.add("index", stack, low, high, NEIGHBOUR[word], whole)
            elif word == "at" and len(arguments) == 1:
                self.index(cursor, arguments[0], stack)
            elif word == "to_seconds" and len(arguments) == 1:
                self.add("unit", stack, *whole, f"(1e-3 * {self.text(*whole)})")
            elif word == "from_seconds" and len(arguments) == 1:
                argument = self.extent(arguments[0])
                self.add("unit", stack, *argument, f"1e-3 * ({self.text(*argument)})", whole)
            if word in SYMMETRIC:
                return
        self.swaps(cursor, arguments, stack)

    def called_operator(self, cursor, children, stack):
        begin, end = self.extent(cursor)
        inside = [c for c in children if begin <= c.extent.start.offset < c.extent.end.offset <= end]
        if cursor.spelling in ("operator[]", "operator()"):
            for argument in self.arguments(cursor):
                if argument.extent.start.offset > begin:
                    self.index(cursor, argument, stack)
            return
        inside.sort(key=lambda c: c.extent.start.offset)
        at = [i for i, c in enumerate(inside) if self.text_of(c) in BINARY]
        if len(at) == 1 and at[0] == 1 and len(inside) == 3:
            self.binary(cursor, inside[0], inside[2], stack)
        elif cursor.spelling in ("operator-", "operator!") and len(inside) == 2:
            self.unary(cursor, inside[1], stack)

    def swaps(self, cursor, arguments, stack):
        whole = self.extent(cursor)
        for one, other in zip(arguments, arguments[1:]):
            first, second = self.extent(one), self.extent(other)
            texts = self.text(*first), self.text(*second)
            if not whole[0] <= first[0] < first[1] <= second[0] < second[1] <= whole[1]:
                continue
            if texts[0] == texts[1] or texts[0].startswith(".") or _plain(one.type) != _plain(other.type):
                continue
            if "char" in _plain(one.type) and _is_text_or_place(one.type):
                continue  # string literals
            between = self.text(first[1], second[0])
            self.add("swap", stack, first[0], second[1], texts[1] + between + texts[0], whole)

    def index(self, cursor, argument, stack):
        if not _is_integer(argument.type):
            return
        begin, end = self.extent(argument)
        text = self.text(begin, end)
        whole = self.extent(cursor)
        self.add("index", stack, begin, end, f"{text} + 1", whole)
        if text != "0":
            self.add("index", stack, begin, end, f"{text} - 1", whole)

    def unit_of_name(self, cursor, stack):
        match = UNIT_NAME.search(cursor.spelling)
        is_read = stack and stack[-1].kind == Kind.UNEXPOSED_EXPR and \
            self.extent(stack[-1]) == self.extent(cursor)
        if not match or not is_read or not _is_floating(cursor.type):
            return
        begin, end = self.extent(cursor)
        factor = UNIT_FACTORS[match.group(1)]
        self.add("unit", stack, begin, end, f"({factor} * {self.text(begin, end)})")

    def body_around(self, stack):
        """Returns the innermost function or lambda and the part of the stack within it."""
        for depth in range(len(stack) - 1, -1, -1):
            if stack[depth].kind in FUNCTIONS or stack[depth].kind == Kind.LAMBDA_EXPR:
                return stack[depth], stack[depth + 1:]
        return None, []

    def leaving(self, cursor, stack):
        function, inner = self.body_around(stack)
        if function is None or not inner:
            return
        if cursor.kind == Kind.RETURN_STMT:
            last = list(inner[0].get_children())[-1]
            is_last = self.extent(last) == self.extent(cursor)
            # A return may be removed only if the function then still ends in another return.
            if is_last or (list(cursor.get_children()) and last.kind != Kind.RETURN_STMT):
                return
            if self.extent(last)[0] <= self.extent(cursor)[0] < self.extent(last)[1] and \
                    list(cursor.get_children()):
                return
        if cursor.kind == Kind.BREAK_STMT:
            around = [c.kind for c in inner if c.kind in LOOPS or c.kind == Kind.SWITCH_STMT]
            if not around or around[-1] == Kind.SWITCH_STMT:
                return
        outer = self.extent(cursor)
        holders = [c for c in inner if c.kind == Kind.IF_STMT]
        if holders:
            begin, end = self.extent(holders[-1])
            if end - begin < 300:
                outer = (begin, end)
        self.add("return", stack, *self.extent(cursor), "", outer)

    def statement(self, cursor, stack):
        inner = cursor
        while inner.kind == Kind.UNEXPOSED_EXPR:
            children = list(inner.get_children())
            if len(children) != 1:
                break
            inner = children[0]
        children = list(inner.get_children())
        is_reset = inner.kind == Kind.COMPOUND_ASSIGNMENT_OPERATOR
        if inner.kind == Kind.BINARY_OPERATOR and len(children) == 2:
            is_reset = self.bare(children[0].extent.end.offset, children[1].extent.start.offset) == "="
        elif inner.kind == Kind.UNARY_OPERATOR:
            is_reset = any(sign in self.text_of(inner) for sign in ("++", "--"))
        elif inner.kind == Kind.CALL_EXPR:
            name = inner.spelling
            callee = self.callee(inner, children)
            is_reset = (name.startswith("operator") and name[8:] in ASSIGNS | {"++", "--"}) or \
                (callee is not None and callee[2] in RESETS)
        if is_reset:
            self.add("reset", stack, *self.extent(cursor), "")
