# SPDX-License-Identifier: BSD-3-Clause
"""Reads .lcm files, for the generators in this folder."""
import re

SIZES = {"int8_t": 1, "byte": 1, "boolean": 1, "int16_t": 2, "int32_t": 4, "float": 4, "int64_t": 8, "double": 8}


class Struct:
    """A message type: fields as (type, name, dimensions), constants as (type, name, value), all of them texts."""

    def __init__(self, package, name):
        self.package, self.name, self.fields, self.constants = package, name, [], []

    @property
    def full_name(self):
        return f"{self.package}.{self.name}"

    @property
    def cpp_name(self):
        return f"::{self.package}::{self.name}"


def parse(path):
    """The structs of one file. Raises ValueError with the offending statement."""
    text = re.sub(r"/\*.*?\*/|//[^\n]*", "", path.read_text(), flags=re.S)
    package = re.search(r"\bpackage\s+(\w+)\s*;", text)
    structs = []
    for name, body in re.findall(r"\bstruct\s+(\w+)\s*\{(.*?)\}", text, flags=re.S):
        struct = Struct(package.group(1) if package else "", name)
        for statement in filter(None, (s.strip() for s in body.split(";"))):
            parse_statement(path, statement, struct)
        structs.append(struct)
    return structs


def parse_statement(path, statement, struct):
    match = re.fullmatch(r"(const\s+)?([\w.]+)\s+(.+)", statement, flags=re.S)
    if not match:
        raise ValueError(f"{path}: cannot read '{statement}'")
    is_constant, kind, members = match.groups()
    member_form = r"\s*(\w+)\s*=\s*(\S+)\s*" if is_constant else r"\s*(\w+)\s*((?:\[\s*\w+\s*\]\s*)*)"
    for member in members.split(","):
        member_match = re.fullmatch(member_form, member)
        if not member_match:
            raise ValueError(f"{path}: cannot read '{member.strip()}' in '{statement}'")
        name, rest = member_match.groups()
        if is_constant:
            struct.constants.append((kind, name, rest))
        else:
            struct.fields.append((kind, name, re.findall(r"\[\s*(\w+)\s*\]", rest)))
