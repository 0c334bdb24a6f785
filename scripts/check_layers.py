#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Checks the include rules of the house (ARCHITECTURE.md, "Rules").

1. An algorithm sees no LCM, generated type, clock, thread, file, environment or stdout.
2. A module includes no other module.
3. Apart from tests and benchmarks, only common/bus includes <lcm/...>, only drivers/serial/serial_port.cpp libserialport, and nothing OctoMap.
4. The simulator includes no driver.
5. Of the tools only trial, the closed loop, includes drivers and modules, and evaluate the relocalisation of slam2d, which it measures;
   the others may use what turns messages into Foxglove's schemas (modules/viewer/foxglove).
6. From the process manager the viewer uses protocol and configuration, and nothing of deputy and sheriff.
7. Time is a type (common/geometry/time.hpp): in the rooms of TYPED_TIME no integer of microseconds is declared, but where INTEGER_TIME says so and
   in the modules' tests, which fill messages.
8. What a test file defines is in a namespace named after the file, as several are compiled as one (nodmap_join_sources).
9. A function whose name asks a question (is_, has_, may_) changes nothing: as a member it is const, and no argument is a reference to what is not const.
10. /// documents what a header promises; comments in a .cpp file are //.
11. A header includes what it uses of the standard library and of Eigen: it compiles whatever comes before it.
12. Neighbouring folders do not include each other, neither directly nor through others.
Besides: every source file names its licence, and a transform is called T_a_b, never a_to_b or a2b.
"""
import collections
import graphlib
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
DOCUMENTS = re.compile(r"\s*///")
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]')
# The shell of a module: the files that may meet the world.
SHELL = re.compile(r"^(node|display|.*_node|.*_publisher|.*_reader|main|messages|senders|results|.*_file|.*_image|registered_cloud|occupancy_mapper|thread_executor)\.(hpp|cpp)$")
# Modules that are nothing but a shell: they move bytes or images, there is no algorithm to keep clean.
SHELL_MODULES = {"logger", "viewer"}
WORLD = re.compile(
    r"^(lcm/|nodmap/|common/(bus|node|drawing|formats)/|common/geometry/clock\.hpp|spdlog/|fmt/|nlohmann/|yaml-cpp/|CLI/|png\.h"
    r"|chrono$|ctime$|thread$|mutex$|atomic$|future$|condition_variable$|shared_mutex$"
    r"|fstream$|filesystem$|cstdio$|iostream$|unistd\.h$|fcntl\.h$|sys/)")
TOOL_MAY_USE = {"evaluate": ("modules/slam2d/",)}
# Where a library may be included, and what is wrong elsewhere.
LIBRARIES = {"lcm/": ("common/bus/", "only common/bus includes LCM"),
             "libserialport.h": ("drivers/serial/serial_port.cpp", "only serial_port.cpp includes libserialport"),
             "octomap/": (None, "only tests include OctoMap: they compare our implementation with it")}
TYPED_TIME = ("bench/", "common/", "drivers/", "modules/", "procman/", "sim/", "tests/", "tools/")
# What messages, logs and files hold as it is.
INTEGER_TIME = ("common/bus/event_log", "common/bus/message_log", "common/formats/", "common/geometry/", "common/node/messages", "common/scan/",
                "tests/replay/", "tools/convert/", "tools/evaluate/")
MICROSECONDS = re.compile(r"\bint64_t>?[ &]+(\w+_us_?|k\w+Us)\b")
# A function that is named like a question: its name, its parameters, and what stands behind them.
QUESTION = re.compile(r"^( *)(?:\[\[nodiscard\]\] )?((?:virtual |static |constexpr |inline |friend )*)bool ((?:\w+::)*(?:is|has|may)_\w+)\(([^;{}]*)\)([^;{}()]*)[;{]", re.M)
# Parameters that a question may change: a cache.
CACHES = re.compile(r"\bLookup& ")
# What a header needs for each name that it uses: <X> for std::X, except for these; and for Eigen any of Eigen's headers.
SAME_NAME = ("array atomic bitset chrono deque exception filesystem future initializer_list list map mutex numbers optional regex set span string"
             " string_view thread tuple unordered_map unordered_set variant vector")
NAMES = {
    "algorithm": "clamp max min minmax ranges sort",
    "cmath": "abs atan2 ceil cos exp floor fmod hypot isfinite isnan lround pow remainder round sin sqrt tan",
    "cstddef": "byte ptrdiff_t size_t",
    "cstdint": "int8_t int16_t int32_t int64_t uint8_t uint16_t uint32_t uint64_t uintptr_t",
    "fstream": "ifstream ofstream",
    "functional": "function hash reference_wrapper",
    "limits": "numeric_limits",
    "memory": "make_shared make_unique shared_ptr unique_ptr weak_ptr",
    "numeric": "accumulate iota",
    "optional": "nullopt",
    "random": "mt19937 mt19937_64 normal_distribution uniform_int_distribution uniform_real_distribution",
    "stdexcept": "invalid_argument logic_error out_of_range runtime_error",
    "string": "to_string",
    "system_error": "error_code system_error",
    "type_traits": "conditional_t decay_t is_enum_v is_same_v remove_cvref_t underlying_type_t",
    "utility": "exchange forward in_place move pair swap",
}
HEADER_OF = {name: name for name in SAME_NAME.split()} | {name: header for header, names in NAMES.items() for name in names.split()}
COMMENT_OR_TEXT = re.compile(r'//.*|"(?:[^"\\\n]|\\.)*"')
USED_NAME = re.compile(r"\b(std|Eigen)::(\w+)")
BAD_NAME = re.compile(r"\b(base|map|odom|laser|mount|body|sensor|world)(_to_|2)(base|map|odom|laser|mount|body|sensor|world)\b")


def is_test(path):
    return "test" in path.parts or path.parts[0] in ("tests", "bench")


def has_typed_time(path):
    return (str(path).startswith(TYPED_TIME) and not str(path).startswith(INTEGER_TIME)
            and not (path.parts[0] == "modules" and is_test(path)))


def sources():
    for pattern in ("*.hpp", "*.cpp"):
        for top in ("common", "modules", "drivers", "procman", "sim", "tools", "tests", "bench"):
            for path in sorted((ROOT / top).rglob(pattern)):
                yield path.relative_to(ROOT)


def include_errors(path, include):
    """What is wrong with this include in this file, if anything."""
    top, module = path.parts[0], path.parts[1]
    for library, (place, error) in LIBRARIES.items():
        if include.startswith(library) and not (place and str(path).startswith(place)):
            yield error
    if top == "modules":
        if include.startswith("modules/") and include.split("/")[1] != module:
            yield "a module never includes another module"
        core = module not in SHELL_MODULES and not SHELL.match(path.name)
        if core and WORLD.match(include):
            yield "an algorithm sees no message, clock, thread, file or stream"
    if top == "common" and include.startswith(("modules/", "drivers/", "sim/", "tools/", "procman/")):
        yield "common knows nobody above it"
    if top == "modules" and include.startswith("procman/") and not include.startswith(("procman/config/", "procman/protocol/")):
        yield "deputy and sheriff are nobody's library: use procman/protocol and procman/config"
    if top == "tools" and module != "trial" and include.startswith(("modules/", "drivers/")) and not include.startswith(TOOL_MAY_USE.get(module, ())) and not include.startswith("modules/viewer/foxglove/"):
        yield "of the tools only the closed loop joins modules and drivers"
    if top == "sim" and include.startswith("drivers/"):
        yield "the simulator includes no driver: a parser's bug must show"


def neighbours(path, include):
    """The two neighbouring folders of which the one, with this file, includes the other; None if one contains the other."""
    own, other = path.parent.parts, pathlib.PurePath(include).parent.parts
    for depth, (a, b) in enumerate(zip(own, other), 1):
        if a != b:
            return "/".join(own[:depth]), "/".join(other[:depth])
    return None


def folder_circles(includes):
    """Folders that include each other, given (file, include) pairs: one error, or none."""
    included_by = collections.defaultdict(set)
    for path, include in includes:
        if pair := neighbours(path, include):
            included_by[pair[0]].add(pair[1])
    try:
        graphlib.TopologicalSorter(included_by).prepare()
    except graphlib.CycleError as error:
        yield "folders include each other: " + ", which is included by ".join(error.args[1])


def missing_includes(text):
    """The names that a header uses, each with the header that it does not include for it."""
    lines = text.splitlines()
    included = {match.group(1) for line in lines if (match := INCLUDE.match(line))}
    if any(header.startswith("Eigen/") for header in included):
        included.add("Eigen/Core")
    if "common/geometry/time.hpp" in included:
        included.add("chrono")  # an algorithm has it from there only
    for number, line in enumerate(lines, 1):
        for room, name in USED_NAME.findall("" if INCLUDE.match(line) else COMMENT_OR_TEXT.sub("", line)):
            header = "Eigen/Core" if room == "Eigen" else HEADER_OF.get(name)
            if header and header not in included:
                included.add(header)  # one error for each
                yield number, f"uses {room}::{name} without #include <{header}>"


def question_errors(text):
    """The functions that are named like a question and change something: line and what is wrong."""
    for match in QUESTION.finditer(text):
        indent, specifiers, name, parameters, behind = match.groups()
        number = 1 + text.count("\n", 0, match.start())
        is_member = indent and not re.search("static|friend", specifiers)
        if is_member and "const" not in behind:
            yield number, f"{name}() asks, so it is const"
        for parameter in parameters.split(","):
            if re.search(r"[^&]& ?\w*$", parameter) and "const " not in parameter and not CACHES.search(parameter):
                yield number, f"{name}() asks, so it changes no argument: {parameter.strip()}"


def main():
    errors = []
    includes = []
    for path in sources():
        text = (ROOT / path).read_text()
        lines = text.splitlines()
        if not lines or "SPDX-License-Identifier: BSD-3-Clause" not in lines[0]:
            errors.append(f"{path}:1: the first line names the licence")
        errors += [f"{path}:{number}: {error}" for number, error in question_errors(text)]
        if path.suffix == ".hpp":
            errors += [f"{path}:{number}: {error}" for number, error in missing_includes(text)]
        for number, line in enumerate(lines, 1):
            if BAD_NAME.search(line):
                errors.append(f"{path}:{number}: write T_a_b: {line.strip()}")
            if has_typed_time(path) and MICROSECONDS.search(line):
                errors.append(f"{path}:{number}: time is a type, see common/geometry/time.hpp: {line.strip()}")
            if line == "namespace {" and path.name.endswith("_test.cpp") and any(l.startswith("TEST") for l in lines):
                errors.append(f"{path}:{number}: a test's namespace is named after its file: namespace {path.stem} {{")
            if path.suffix == ".cpp" and DOCUMENTS.match(line):
                errors.append(f"{path}:{number}: /// documents what a header promises; a comment in a source is //")
            match = INCLUDE.match(line)
            if not match:
                continue
            include = match.group(1)
            if not is_test(path):
                includes.append((path, include))
                errors += [f"{path}:{number}: {reason}: {line.strip()}" for reason in include_errors(path, include)]
    errors += folder_circles(includes)
    print("\n".join(errors) if errors else "include rules hold")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
