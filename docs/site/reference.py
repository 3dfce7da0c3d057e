# SPDX-License-Identifier: BSD-3-Clause
"""Sphinx directives that write the references of the command line and of Python from the sources, which need not be built:

- `command-line-reference`: the text of `stratus --help`, from Applications/stratus/options.cxx
- `python-reference [MODULE [NAME...]]`: the functions and classes that a module of Python/stratus_volume shows, with their docstrings"""
import ast
import inspect
import os
import re

from docutils import nodes
from docutils.statemachine import StringList
from sphinx.util.docutils import SphinxDirective

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))


sources = set()  # the files that were read


def read(*path):
    sources.add(os.path.join(ROOT, *path))
    with open(os.path.join(ROOT, *path), encoding="utf-8") as file:
        return file.read()


def escaped(text):
    """Return a text whose Markdown is shown as it is, apart from code in backquotes."""
    parts = re.split(r"(`[^`\n]+`)", text)
    return "".join(part if i % 2 else re.sub(r"([\\*_<>\[\]{}#|~^$])", r"\\\1", part) for i, part in enumerate(parts))


def listed(lines, entry):
    """Return Markdown of a text whose entries have a name and, from a column on, what it means. entry: matches an entry's first line.
    Lines that are indented further than names continue the entry; other lines are paragraphs."""
    result, open_entry = [], ""  # open_entry: a fence of Markdown or an indentation, which continues the entry
    for line in lines:
        found = entry.match(line)
        if found:
            name = found[1].strip()
            if name.startswith("-"):  # Sphinx's search knows options
                result += ([":::"] if open_entry == ":::" else []) + ["", f":::{{option}} {name}", escaped(found[2])]
                open_entry = ":::"
            else:
                result += ["", f"`{name}`"] + ([f": {escaped(found[2])}"] if found[2] else [])
                open_entry = "  "
        elif not line.strip():
            result += [":::", ""] if open_entry == ":::" else [""]
            open_entry = ""
        elif open_entry and line.startswith("    "):
            result.append(open_entry.strip(":") + escaped(line.strip()))
        else:
            result += [":::", ""] if open_entry == ":::" else [""] if open_entry else []
            open_entry = ""
            text = line.strip()
            result.append("- " + escaped(text[2:]) if text.startswith("- ") else ("  " if line.startswith("    ") else "") + escaped(text))
    return result + ([":::"] if open_entry == ":::" else [])


def command_line():
    """Return the sections of the help text as Markdown."""
    source = read("Applications", "stratus", "options.cxx")
    text = re.search(r'std::string help\(\)\n\{\n  return R"\((.*)\n\)";\n\}', source, re.S)[1]
    colors = re.findall(r'^  \{ "([\w.-]+)",', read("Core", "base", "color_maps.c"), re.M)
    methods = re.findall(r'"([\w-]+)"', re.search(r"method_names\[STRATUS_TREE_METHODS\] = \{(.*?)\}", read("Core", "tree", "tree.c"), re.S)[1])
    text = re.sub(r'\)" \+\s*wrapped\(color_names.*?R"\(', lambda _: ", ".join(colors), text, flags=re.S)
    text = re.sub(r'\)" \+\s*method_names\(\) \+ R"\(', lambda _: ", ".join(methods + ["ac-edges", "hybrid-paper-raw"]), text)
    assert 'R"(' not in text and len(colors) > 20 and len(methods) > 8, "options.cxx is written in another way than docs/site/reference.py reads"
    entry = re.compile(r"  (stratus .*?|--?\w.*?)(?: {2,}| *$)(.*)$")
    result = ["## Commands", ""]
    for block in text.split("\n\n"):
        lines = block.split("\n")
        if len(lines) > 1 and not lines[0].startswith(" "):
            # "Section: a sentence about it", or only sentences
            name, _, rest = lines[0].partition(": ")
            if name.startswith("INPUT"):
                name, rest = "Inputs", lines[0]
            elif not rest and not lines[1].startswith("  "):
                name, rest = "Exit status and examples", lines[0]
            lines = ([rest[:1].upper() + rest[1:], ""] if rest else []) + lines[1:]
            result += ["", f"## {name}", ""]
        result += listed(lines, entry) + [""]
    return result


class Module:
    """A module of the package, by its source."""

    def __init__(self, name):
        self.tree = ast.parse(read("Python", "stratus_volume", name + ".py"))
        self.own = {node.name: node for node in self.tree.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
        self.imported = {alias.asname or alias.name: (node.module, alias.name) for node in self.tree.body
                         if isinstance(node, ast.ImportFrom) and node.level == 1 for alias in node.names}

    def names(self):
        for node in self.tree.body:
            if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "__all__":
                return [element.value for element in node.value.elts]
        return [name for name in self.own if not name.startswith("_")]

    def find(self, name):
        if name in self.own:
            return self.own[name]
        module, name = self.imported[name]
        return Module(module).find(name)


def documented(node, module, indent=0, of=None):
    """Return Markdown of a function or class: a Sphinx object, so that search and index know it."""
    is_class = isinstance(node, ast.ClassDef)
    fence = ":" * (5 - indent)
    function = next((each for each in node.body if getattr(each, "name", "") == "__init__"), None) if is_class else node
    decorators = [ast.unparse(each) for each in node.decorator_list]
    arguments = ast.unparse(function.args) if function else ""
    if is_class or (of and "staticmethod" not in decorators):
        arguments = re.sub(r"^(self|cls)(, )?", "", arguments)
    kind = "class" if is_class else "property" if "property" in decorators else "method" if of else "function"
    signature = node.name if kind == "property" else f"{node.name}({arguments})"
    prefix = "" if of else module + "."
    result = ["", f"{fence}{{py:{kind}}} {prefix}{signature}", ""]
    entry = re.compile(r"(\w[\w, ]*?)(?: {2,})(\S.*)$")
    result += listed(inspect.cleandoc(ast.get_docstring(node) or "").split("\n"), entry)
    if is_class:
        for each in node.body:
            if isinstance(each, ast.FunctionDef) and not each.name.startswith("_") and ast.get_docstring(each):
                if any(decorator.endswith(".setter") for decorator in map(ast.unparse, each.decorator_list)):
                    continue
                result += documented(each, module, indent + 1, node.name)
    return result + [fence, ""]


def python(module, names):
    """Return the reference of a module, or of the given names of it, as Markdown."""
    source = Module(module or "__init__")
    name = "stratus_volume" + ("." + module if module else "")
    result = []
    for each in names or source.names():
        result += documented(source.find(each), name)
    return result


class Written(SphinxDirective):
    """A directive that is replaced by Markdown."""
    optional_arguments = 1
    final_argument_whitespace = True

    def lines(self):
        raise NotImplementedError

    def run(self):
        lines = StringList(self.lines(), source=self.env.docname)
        for path in sources | {os.path.abspath(__file__)}:  # a change of them writes the page anew
            self.env.note_dependency(path)
        node = nodes.section()
        node.document = self.state.document
        self.state.nested_parse(lines, 0, node, match_titles=True)
        return node.children


class CommandLine(Written):
    def lines(self):
        return command_line()


class Python(Written):
    def lines(self):
        module, *names = " ".join(self.arguments).split() or [""]
        return python(module, names)


def setup(app):
    app.add_directive("command-line-reference", CommandLine)
    app.add_directive("python-reference", Python)
    return {"parallel_read_safe": True}
