# SPDX-License-Identifier: Apache-2.0
"""Messages of the scene reader in the words of dicts: elements of scene files become entries."""
from __future__ import annotations

import re

#: An element with its attributes, or a bare tag. Text of the user stands in quotes and is left alone.
_ELEMENT = re.compile(r'(?<!")<(?P<tag>[a-z]+)(?P<attributes>(?:\s+[a-z_]+="[^"]*")*)(?:\s*/|\s+\.\.\.)?>(?!")')
_ATTRIBUTE = re.compile(r'([a-z_]+)="([^"]*)"')
#: Names of bare tags in messages, where they differ from the tag.
_NAMES = {"scene": "the scene", "ref": '{"type": "ref", "id": ...}', "given": "an object of this program", "rgb": '{"type": "rgb", "value": ...}',
          "spectrum": '{"type": "spectrum", "value": ...}', "string": "a string", "boolean": "True or False", "lookat": "look_at"}


def in_python(message: str) -> str:
    """The message with each element, such as ``<string name="length_unit" value="mm"/>``, as the entry ``"length_unit": "mm"``."""
    return _ELEMENT.sub(_entry, message)


def python_names(message: str) -> str:
    """The message with options of the command line by the names of the arguments: ``--pixel-size`` becomes ``pixel_size``."""
    return re.sub(r"--([a-z]+(?:-[a-z]+)*)", lambda m: m[1].replace("-", "_"), message)


def _entry(element: "re.Match[str]") -> str:
    tag, attributes = element["tag"], dict(_ATTRIBUTE.findall(element["attributes"]))
    if not attributes:
        return _NAMES.get(tag, tag)
    name = attributes.pop("name", None)
    value = _value(tag, attributes)
    return value if name is None else f'"{name}": {value}'


def _value(tag: str, attributes: "dict[str, str]") -> str:
    text = attributes.get("value", "...")
    if "type" in attributes:
        return f'{{"type": "{attributes["type"]}"}}'
    if tag == "ref":
        return f'{{"type": "ref", "id": "{attributes.get("id", "...")}"}}'
    if tag == "string":
        return f'"{text}"'
    if tag == "boolean":
        return text.capitalize()
    if tag == "rgb":
        return f'{{"type": "rgb", "value": [{text}]}}'
    if tag == "spectrum" and "unit" in attributes:
        return f'{{"type": "spectrum", "unit": "{attributes["unit"]}", "value": ...}}'
    if tag == "spectrum":
        pairs = ", ".join(f"({nm.strip()}, {value.strip()})" for nm, _, value in (p.partition(":") for p in text.split(",")))
        return f'{{"type": "spectrum", "value": {f"[{pairs}]" if ":" in text else text}}}'
    return f"[{text}]" if tag in ("vector", "point") else text
