# SPDX-License-Identifier: Apache-2.0
"""Scenes of bench/scenes for eradiate-mitsuba, whose file reader does not know its bounds of grids (`extremum_grid`)."""
import xml.etree.ElementTree as ElementTree

RESOLUTION = 32  # of the bounds, along each side
PLAIN = {"float": float, "integer": int, "string": str, "boolean": lambda v: v == "true"}


def numbers(text):
    return [float(x) for x in text.replace(",", " ").split()]


def point(element):
    if "value" in element.attrib:
        values = numbers(element.get("value"))
        return values * 3 if len(values) == 1 else values
    return [float(element.get(axis, 0)) for axis in "xyz"]


def transform(mi, element):
    total = mi.ScalarTransform4f()
    for step in element:
        if step.tag == "lookat":
            new = mi.ScalarTransform4f().look_at(*(numbers(step.get(k)) for k in ("origin", "target", "up")))
        elif step.tag == "rotate":
            new = mi.ScalarTransform4f().rotate(point(step), float(step.get("angle")))
        else:
            new = getattr(mi.ScalarTransform4f(), step.tag)(point(step))
        total = new @ total
    return total


def spectrum(text):
    if ":" not in text:
        return {"type": "uniform", "value": float(text)}
    pairs = [pair.split(":") for pair in text.split(",")]
    return {"type": "irregular", "wavelengths": ", ".join(p[0].strip() for p in pairs),
            "values": ", ".join(p[1].strip() for p in pairs)}


def dictionary(mi, element, defines):
    """The dict of an object for mi.load_dict. Objects without a name are named after their position."""
    made = {"type": element.get("type", element.tag)}
    for i, child in enumerate(element):
        name, value = child.get("name", f"{child.tag}{i}"), child.get("value", "")
        if value.startswith("$"):
            child.set("value", value := defines[value[1:]])
        if child.get("type", "").startswith("$"):
            child.set("type", defines[child.get("type")[1:]])
        if child.tag == "default":
            defines.setdefault(name, value)
        elif child.tag in PLAIN:
            made[name] = PLAIN[child.tag](value)
        elif child.tag in ("point", "vector"):
            made[name] = point(child)
        elif child.tag == "transform":
            made[name] = transform(mi, child)
        elif child.tag == "spectrum":
            made[name] = spectrum(value)
        else:
            made[name] = dictionary(mi, child, defines)
    return made


def add_bounds(mi, made):
    """Gives every medium of a grid the bounds of that grid."""
    for value in list(made.values()):
        if isinstance(value, dict):
            add_bounds(mi, value)
    if made["type"] == "heterogeneous":
        made["extremum"] = {"type": "extremum_grid", "volume": dict(made["sigma_t"]), "scale": made["scale"],
                            "resolution": mi.ScalarVector3i(RESOLUTION)}


def load(mi, file, defines, sampler):
    made = dictionary(mi, ElementTree.parse(file).getroot(), dict(defines))
    add_bounds(mi, made)
    sensor = next(v for v in made.values() if isinstance(v, dict) and v["type"] == "perspective")
    next(v for v in sensor.values() if isinstance(v, dict) and v["type"] == "independent")["type"] = sampler
    return mi.load_dict(made)
