#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""declare.py OUT.py HEADER...: writes the public C headers' enums, structs and prototypes as declarations of ctypes.

The headers are the only source, so that the package's structs cannot drift from the library's. A statement that this program does not
understand is an error: nothing is left out in silence. Headers follow each other as stratus.h includes them: declarations
come before their uses.
"""
import re
import sys

SCALARS = {
    "char": "c_char", "int": "c_int", "float": "c_float", "double": "c_double", "size_t": "c_size_t", "int8_t": "c_int8", "uint8_t": "c_uint8",
    "int16_t": "c_int16", "uint16_t": "c_uint16", "int32_t": "c_int32", "uint32_t": "c_uint32", "int64_t": "c_int64", "uint64_t": "c_uint64",
}


class Headers:
    def __init__(self):
        self.constants, self.enums, self.structs, self.callbacks, self.functions, self.opaque = {}, {}, {}, {}, {}, set()

    def read(self, text):
        text = re.sub(r"/\*.*?\*/", " ", text, flags=re.S)
        text = re.sub(r"#ifdef __cplusplus\n.*?#endif\n", "", text, flags=re.S)
        lines = []
        for line in text.splitlines():
            macro = re.match(r"\s*#\s*define\s+(STRATUS_\w+)\s+(\S+)\s*$", line)
            if macro and re.match(r"[0-9.]", macro[2]):
                self.constants[macro[1]] = number(macro[2])
            elif not line.lstrip().startswith("#"):
                lines.append(line)
        for statement in statements(" ".join(lines)):
            self.declare(re.sub(r"\s+", " ", statement).strip())

    def declare(self, statement):
        enum = re.fullmatch(r"typedef enum (\w+) \{(.*)\} \1", statement)
        struct = re.fullmatch(r"typedef struct (\w+) \{(.*)\} \1", statement)
        callback = re.fullmatch(r"typedef (.+)\(\*(\w+)\)\((.*)\)", statement)
        opaque = re.fullmatch(r"(?:typedef )?struct (\w+)(?: \1)?", statement)
        function = re.fullmatch(r"(?:STRATUS_API|STRATUS_EXPERIMENTAL) (.*?)(\w+)\((.*)\)", statement)
        if enum:
            self.enums[enum[1]] = {}
            following = 0
            for entry in filter(None, (part.strip() for part in enum[2].split(","))):
                name, _, value = (part.strip() for part in entry.partition("="))
                following = number(value) if value else following
                self.enums[enum[1]][name] = following
                following += 1
        elif struct:
            fields = [field for line in filter(str.strip, struct[2].split(";")) for field in self.fields(line.strip())]
            self.structs[struct[1]] = fields
        elif callback:
            self.callbacks[callback[2]] = self.signature(callback[1], callback[3])
        elif opaque:
            self.opaque.add(opaque[1])
        elif function:
            self.functions[function[2]] = self.signature(function[1], function[3])
        else:
            raise SystemExit(f"declare.py does not understand: {statement}")

    def signature(self, result, parameters):
        types = []
        for parameter in ([] if parameters.strip() == "void" else parameters.split(",")):
            (name, kind), = self.fields(parameter.strip(), of_function=True)
            types.append(kind)
        return (self.kind(result), types)

    def fields(self, line, of_function=False):
        """Yields name and type of each declarator, as of `double center[3], radius`."""
        first, *others = line.split(",")
        match = re.fullmatch(r"((?:const |struct )*\w+(?: const)?)([ *]+)(\w+)((?:\[\w+\])*)", first.strip())
        if not match:
            raise SystemExit(f"declare.py does not understand: {line}")
        declarators = [(match[2].replace(" ", ""), match[3], match[4])]
        for other in others:
            part = re.fullmatch(r"\s*(\**)(\w+)((?:\[\w+\])*)", other)
            if not part:
                raise SystemExit(f"declare.py does not understand: {line}")
            declarators.append((part[1], part[2], part[3]))
        result = []
        for stars, name, extents in declarators:
            extents = re.findall(r"\[(\w+)\]", extents)
            if of_function and extents:
                stars, extents = stars + "*", []
            kind = self.kind(match[1] + stars)
            for extent in reversed(extents):
                known = dict(self.constants, **{name: value for entries in self.enums.values() for name, value in entries.items()})
                kind = f"{kind} * {known[extent] if extent in known else number(extent)}"
                kind = f"({kind})" if len(extents) > 1 else kind
            result.append((name, kind))
        return result

    def kind(self, text):
        """Returns the type of ctypes. An address of numbers, or of a struct that only the core reads, is a plain address (c_void_p)."""
        text = re.sub(r"\b(const|struct)\b", "", text).strip()
        stars = text.count("*")
        name = text.replace("*", "").strip()
        if stars == 0:
            if name == "void":
                return "None"
            if name in self.enums:
                return "c_int"
            if name in SCALARS:
                return SCALARS[name]
            if name in self.structs or name in self.callbacks:
                return name
        elif name in SCALARS or name == "void" or name in self.opaque or name in self.structs or name in self.enums:
            if stars == 1 and name == "char":
                return "c_char_p"
            if stars == 1 and name in self.structs:
                return f"POINTER({name})"
            return "c_void_p" if stars == 1 else "POINTER(c_void_p)"
        raise SystemExit(f"declare.py does not know the type {text}")

    def write(self, file):
        print("# SPDX-License-Identifier: BSD-3-Clause\n# Written by declare.py from the public headers: do not edit.", file=file)
        print('"""The public C headers as declarations of ctypes."""', file=file)
        print("from ctypes import (CFUNCTYPE, POINTER, Structure, c_char, c_char_p, c_double, c_float, c_int, c_int8, c_int16, c_int32, c_int64,"
              " c_size_t,\n                    c_uint8, c_uint16, c_uint32, c_uint64, c_void_p)\n", file=file)
        for name, value in self.constants.items():
            print(f"{name} = {value!r}", file=file)
        for name, entries in self.enums.items():
            print(f"\n# enum {name}", file=file)
            for entry, value in entries.items():
                print(f"{entry} = {value}", file=file)
        print(file=file)
        for name in self.structs:
            print(f"\n\nclass {name}(Structure):\n    pass", file=file)
        print("\n", file=file)
        for name, (result, parameters) in self.callbacks.items():
            print(f"{name} = CFUNCTYPE({', '.join([result, *parameters])})", file=file)
        for name, fields in self.structs.items():
            print(f"{name}._fields_ = [", file=file)
            for field, kind in fields:
                print(f'    ("{field}", {kind}),', file=file)
            print("]", file=file)
        print("\nCONSTANTS = {" + ", ".join(f'"{name}": {name}' for name in self.constants) + "}", file=file)
        print("ENUMS = {", file=file)
        for name, entries in self.enums.items():
            print(f'    "{name}": {entries!r},', file=file)
        print("}\nSTRUCTS = {" + ", ".join(f'"{name}": {name}' for name in self.structs) + "}", file=file)
        print("# name: type of the result, types of the parameters\nFUNCTIONS = {", file=file)
        for name, (result, parameters) in self.functions.items():
            print(f'    "{name}": ({result}, [{", ".join(parameters)}]),', file=file)
        print("}", file=file)


def number(text):
    text = re.sub(r"(?i)(?<=[0-9a-f])[ul]+$", "", text) if text.lower().startswith("0x") or "." not in text else text
    return int(text, 0) if re.fullmatch(r"-?(0[xX][0-9a-fA-F]+|\d+)", text) else float(text)


def statements(text):
    """Yields what ends with a semicolon outside of braces."""
    depth, begin = 0, 0
    for at, letter in enumerate(text):
        depth += (letter == "{") - (letter == "}")
        if letter == ";" and depth == 0:
            yield text[begin:at]
            begin = at + 1
    if text[begin:].strip():
        raise SystemExit(f"declare.py does not understand the end: {text[begin:].strip()}")


def main():
    if len(sys.argv) < 3:
        raise SystemExit(__doc__)
    headers = Headers()
    for path in sys.argv[2:]:
        with open(path, encoding="utf-8") as file:
            headers.read(file.read())
    # Structs that are defined are no longer opaque; those that a header only mentions stay so.
    headers.opaque -= set(headers.structs)
    with open(sys.argv[1], "w", encoding="utf-8") as file:
        headers.write(file)


if __name__ == "__main__":
    main()
