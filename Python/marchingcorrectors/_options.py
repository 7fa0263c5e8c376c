# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The options that all functions share: their types and what they mean. Names are as in mcor.h."""
import ctypes
import difflib
import inspect
import re
import textwrap
from pathlib import Path
from typing import Callable, Literal, TypeVar, Union
from xml.etree import ElementTree

from . import _structs as c
from ._library import lib

BOUNDS = "six bounds (x0, x1, y0, y1, z0, z1)"
Function = TypeVar("Function", bound=Callable)  # Type checkers see the function as it is written.


def camel(name):
    """Returns VTK's spelling: "cube_size" becomes CubeSize."""
    return "".join(part.capitalize() for part in name.split("_"))


# Outputs are bits of one number in mcor_options. Here each bit becomes a member.
OUTPUTS = {name[len("MCOR_OUT_"):].lower(): bit for name, bit in c.ENUMS["mcor_output"].items()}


def output_property(bit):
    def put(options, wanted):
        options.outputs = options.outputs | bit if wanted else options.outputs & ~bit

    return property(lambda options: int(options.outputs & bit != 0), put)


for _name, _bit in OUTPUTS.items():
    setattr(c.mcor_options, _name, output_property(_bit))


class Options(c.CoreOptions, total=False):
    """Keywords of isosurface(). Each of the other functions takes the keywords that matter to it. CoreOptions has the
    options of core/mcor_options.def."""

    smoothing_length_is_support_radius: bool
    estimate_smoothing_length: Union[bool, str]
    scalar_component: Union[int, Literal["magnitude"]]
    ignore_solids: bool
    particles_version: int
    scalar_version: int
    attributes_version: int


def of_panel(name):
    """Returns the panel's text on a property. Leaves out the default at the text's end, unless the default has a comma: such a
    default is more than a word or a number."""
    text = " ".join(PANEL.find(f".//*[@name='{name}']/Documentation").text.split())
    said, _, default = text.partition(" Default: ")
    return text if ", " in default else said


PANEL = ElementTree.parse(Path(__file__).with_name("MarchingCorrectors.xml"))
# These are texts on options; the panel's texts serve for other options.
WORDS = {
    "field": "what is contoured: Shepard's mean of the particles around, the plain SPH sum, or the sum of the "
             "weights, which is the free surface and needs no scalar. probe(): the mean or the sum.",
    "node_threshold": "cubes with a corner of a lower weight sum are left out; probe(): such points are not valid.",
    "wall_share": "above 0, the surface also ends where solids have a greater share of the weight: with 0.5 where they "
                  "weigh more than the fluid, with \"measured\" on the layer of solids that faces it. 0: it does not "
                  "end at solids. \"auto\": \"measured\" for a scalar, 0 for the free surface.",
    "memory_limit": "maximum bytes of device memory; 0: no limit.",
    "box": f"{BOUNDS}: only the cells with their centres in this box; sides may be infinite.",
    "periodic": f"{BOUNDS}: the particles repeat along each axis with x0 < x1; or three lengths, 0 along axes that are not "
                "periodic; or \"auto\", where a file or a data set tells it.",
    "capping": of_panel("Capping"),
    "smooth": "True: for pictures: smooth water, and fewer and better triangles. Stands for compact (not with filled), and for "
              "widen=2 unless another factor is given.",
    "dimension": of_panel("Dimension").replace("Auto:", "0:"),
    "gradients": "True: the gradient of the field; probe(): of every attribute.",
    "iso_value": "True: the iso value of each point.",
    "nearest_particle": "True: the index of the fluid particle that is nearest to each point.",
    "mean_curvature": "True: the mean curvature of the field's own surface, 1 / R for a drop of radius R; in two dimensions that "
                      "of the line.",
    "gauss_curvature": "True: its Gaussian curvature.",
    "point_keys": "True: numbers that are equal for the same point in the surfaces of neighbouring boxes.",
    "triangle_keys": "True: numbers by which triangles of neighbouring boxes can be put in order.",
    "triangle_normals": "True: normals are means over triangles, not from the field's gradient.",
    "smoothing_length_is_support_radius": "True: smoothing_length is the radius at which the kernel ends.",
    "estimate_smoothing_length": "True: 1.3 times the median particle distance; smoothing_length is not needed. "
                                 "\"neighbours\", or \"neighbours=ETA\": for each particle the h with h^3 sum W = ETA^3, "
                                 "ETA 1.3 unless given (in a plane squares).",
    "scalar_component": "which component of a vector is taken: 0, 1, ..., or its magnitude.",
    "ignore_solids": "True: walls do not add to the weights that trim the surface.",
    "particles_version": "equal numbers above 0 in two calls with one context promise that positions, smoothing "
                         "lengths, volumes and solids are the same: they stay on the device.",
    "scalar_version": "the same promise for the scalar.",
    "attributes_version": "the same promise for probe()'s attributes.",
}
WORDS = {**{name: of_panel(panel) for name, (_, _, panel) in c.OPTIONS.items() if panel and name not in WORDS},
         **{name: of_panel("Compute" + camel(name)) for name in OUTPUTS if name not in WORDS}, **WORDS}

# These are the options of each function.
ISOSURFACE = tuple(Options.__annotations__)
FREE_SURFACE = tuple(name for name in ISOSURFACE if name not in (
    "field", "seeds", "node_threshold", "boundary_detection", "vertex_threshold", "scalar_component",
    "scalar_version", "attributes_version"))
EVERY = ("smoothing_length_is_support_radius", "estimate_smoothing_length", "ignore_solids", "particles_version")
WIDENS = ("widen", "smooth")
DERIVATIVES, GAUGE, PROBE, PROJECT, WIDENING = (
    more + tuple(name for name, (_, scope, _) in c.OPTIONS.items() if {"ALL", kind} & set(scope)) + EVERY
    for kind, more in (("DERIVE", ()), ("GAUGE", WIDENS), ("PROBE", (*WIDENS, "gradients", "attributes_version")),
                       ("PROJECT", (*WIDENS, "scalar_component")),
                       ("WIDENING", ("widen", "cube_size", "cube_size_factor", "wall_share"))))
# Most people need these keywords: the program's table marks their options as "usual". Signatures and help texts begin with them.
USUAL = [member for _, _, modes, member in c.PROGRAM.values() if "usual" in modes]


def words_of(name):
    """Returns {word: number} of an option, or of derivatives()' form."""
    if name == "form":
        return {word[len("MCOR_GRADIENT_"):].lower(): number for word, number in c.ENUMS["mcor_gradient"].items()}
    return {"magnitude": -1} if name == "scalar_component" else c.OPTIONS.get(name, ({},))[0]


def kind_of(name):
    if name in OUTPUTS:
        return "int"
    return c.KINDS["mcor_options" if name in c.KINDS["mcor_options"] else "mcor_input"][name]


def default_of(name):
    """Returns an option's default value, as a user would write it."""
    options = c.mcor_options()
    lib.mcor_set_default_options(ctypes.byref(options))
    value = -1 if name == "scalar_component" else getattr(options, name, 0)
    for word, number in words_of(name).items():
        if number == value:
            return word
    if isinstance(value, ctypes.Array):
        return None
    return bool(value) if Options.__annotations__[name] is bool or name == "estimate_smoothing_length" else value


def did_you_mean(name, known):
    """Returns " Did you mean '...'?", or "" if no known name is close."""
    close = difflib.get_close_matches(str(name), [str(other) for other in known], 1)
    if not close:  # "kernel" is short for sph_kernel.
        close = [other for other in known if len(str(name)) > 3 and str(name).lower() in str(other).lower()][:1]
    return f" Did you mean '{close[0]}'?" if close else ""


# People try these names, or know them from other packages.
SYNONYMS = {"h": "smoothing_length", "hsml": "smoothing_length", "radius": "smoothing_length",
            "support_radius": "smoothing_length_is_support_radius", "spacing": "volume", "dp": "volume", "dx": "volume",
            "rho": "density", "m": "mass", "value": "iso", "isovalue": "iso", "level": "iso", "threshold": "iso",
            "walls": "solid", "boundary": "solid", "arrays": "attributes", "fields": "attributes", "period": "periodic"}


def check_names(function, given, options):
    """Raises Python's TypeError for an unknown keyword, with a suggestion."""
    parameters = inspect.signature(function).parameters
    for name in given:
        if name not in parameters:
            meant = SYNONYMS.get(name.lower())
            hint = f" Did you mean '{meant}'{', which is spacing**3' * (meant == 'volume')}?" if meant in parameters \
                else did_you_mean(name, parameters)
            raise TypeError(f"{function.__name__}() has no option '{name}'."
                            + (hint or f" Its options are {', '.join(options)}."))


def describe(names):
    """Returns the lines of the help text on these options."""
    lines = []
    for name in names:
        choices = " | ".join(f'"{word}"' for word in words_of(name))
        choices += ": " if choices else ""
        lines += textwrap.wrap(f"{name}: {choices}{WORDS[name]}", 100, subsequent_indent="    ")
    return lines


def show(function, keywords, options):
    """Puts keywords, {name: type}, and options, a list of names, into the function's signature, and the texts on the
    options into the function's docstring, in place of {options}."""
    def parameter(name, default, kind):
        return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default,
                                 annotation=getattr(kind, "__forward_arg__", kind))

    signature = inspect.signature(function)
    shown = {name: p for name, p in signature.parameters.items() if p.kind != p.VAR_KEYWORD}
    options = sorted(options, key=lambda name: (name in OUTPUTS, name not in USUAL))
    for name in sorted((*keywords, *options), key=lambda name: (name in OUTPUTS, name not in USUAL, name not in keywords)):
        shown.setdefault(name, parameter(name, None, keywords[name]) if name in keywords else
                         parameter(name, default_of(name), Options.__annotations__[name]))
    function.__signature__ = signature.replace(parameters=list(shown.values()))
    function.__doc__ = re.sub(r"^( *)\{options\}$", lambda found: textwrap.indent("\n".join(describe(options)), found[1]),
                              function.__doc__ or "", flags=re.M)
