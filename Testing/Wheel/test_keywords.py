# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Gives every keyword to every function (with arrays, with a file, and as a method of PyVista's accessor), with a value that must matter: the
result differs, or one sentence says why the keyword cannot act. No keyword is ignored in silence."""
import inspect
import tempfile
import unittest
import warnings
from pathlib import Path

import numpy as np
import pyvista

import marchingcorrectors as mc

N = 8
X = np.stack(np.meshgrid(*[np.arange(N)] * 3, indexing="ij"), -1).reshape(-1, 3) * 0.1 - 0.35
COUNT = len(X)
ARRAYS = {"Radius": np.linalg.norm(X, axis=1), "Noise": np.sin(12.9898 * np.arange(COUNT) ** 2 + 78.233 * np.arange(COUNT)),
          "Velocity": 0.1 * X + [0.3, 0, 0], "Spin": np.stack([X[:, 1] - 1, 0 * X[:, 0], 0 * X[:, 0] + 0.5], axis=1),
          "Kind": (X[:, 0] > 0.2).astype(np.int32), "SmoothingLength": np.where(X[:, 0] < 0.1, 0.13, 0.27),
          "Mass": np.full(COUNT, 1.0), "Density": 1000 + 50 * X[:, 1], "Space": np.full(COUNT, 0.0008)}
ARRAYS["Blob"] = 1e-6 + 0.0016 * np.abs(ARRAYS["Noise"])
LINES, SECTIONS = {"a": ((-1, 0.01, 0), (1, 0.01, 0))}, {"a": ("disc", (0.17, 0, 0), (1, 0, 0), 0.6)}
POINTS = np.stack([0.04 * np.arange(20) - 0.3, 0.02 + 0 * np.arange(20), 0.03 + 0 * np.arange(20)], axis=1)
# What each function needs; particles' arrays are given by their names.
CALLS = {"isosurface": {"scalar": "Radius", "iso": 0.3}, "free_surface": {}, "probe": {"points": POINTS, "attributes": ["Radius"]}, "derivatives": {"attributes": ["Velocity"]},
         "widening": {}, "gauge": {"lines": LINES}, "flux": {"velocity": "Velocity", "sections": SECTIONS}, "project": {"resolution": 20}}
NOISE = {"scalar": "Noise", "iso": 0.1, "cube_size_factor": 1.0}
SOLIDS, COMPUTED = {"fluid": ("Kind", 0)}, {"volume": "computed", "mass": None, "density": None}
BOX = (-0.15, 0.15, -0.4, 0.4, -0.4, 0.02)


def closed():
    context = mc.Context()
    context.close()
    return context


# {keyword: (value to try, other keywords of both calls: the call with this keyword and the call without)}
TRIALS = {
    "scalar": ("Noise", {}), "iso": (0.25, {}), "scalar_dot": ("Spin", {"scalar": "Velocity", "iso": 0.01}), "points": (POINTS + 0.1, {}),
    "attributes": (["Noise"], {}), "array": ("Spin", {}), "form": ("standard", {}), "return_volume": (True, {}),
    "lines": ({"a": ((-1, 0.1, 0), (1, 0.1, 0))}, {}), "sections": ({"a": ("disc", (0, 0, 0), (1, 0, 0), 0.2)}, {}), "velocity": ("Spin", {}),
    "direction": ("x", {}), "resolution": (9, {}), "weighted_by": ("Noise", {"scalar": "Radius"}), "fluid": (("Kind", 0), {}),
    "solid": ("Kind", {}), "smoothing_length": (0.2, {}), "outputs": ("gradients", {}), "volume": ("Space", {}), "mass": (0.5, {"form": "standard"}),
    "density": (2000.0, {}), "within": ((-0.2, 1, -1, 1, -1, 1), {}), "only": ({"Kind": 0}, {}), "context": (closed, {}), "device": ("nonesuch", {}),
    "progress": (lambda *_: False, {}), "smoothing_length_is_support_radius": (True, {}), "estimate_smoothing_length": (True, {}),
    "scalar_component": (0, {"scalar": "Velocity", "iso": 0.3}), "ignore_solids": (True, {**SOLIDS, **COMPUTED}), "particles_version": (1, {}),
    "scalar_version": (1, {}), "attributes_version": (1, {}), "periodic": ((1, 1, 1), {}), "sph_kernel": ("wendland", {}), "dimension": (2, {}),
    "h_scale": (0.8, {}), "widen": (2, {}), "field": ("sum", {}), "cube_size_factor": (0.7, {}), "cube_size": (0.05, {}), "level_limit": (0, {}),
    "seeds": ("pairs", {"level_limit": 0, **NOISE}), "topology": ("field", NOISE), "box": (BOX, {}), "capping": (True, {"box": BOX}),
    "compact": (True, {}), "smooth": (True, {}), "filled": (True, {}), "preview": (True, {}), "tolerance": (0.1, {}),
    "iteration_limit": (1, NOISE), "node_threshold": (0.9, {}), "boundary_detection": ("eigenvalue", {"iso": 0.4}),
    "vertex_threshold": (0.95, {}), "wall_share": (0.3, SOLIDS), "precision": ("double", {}), "memory_limit": (1, {}),
    "normals": (False, {}), "triangle_normals": (True, {})}
# {(function, keyword): trial}, for functions that need another trial of the keyword.
DROPS, SCALAR = {"volume": "Blob", "smoothing_length": 0.1, "cube_size_factor": 1.0}, {"scalar": "Radius"}
OTHER_TRIALS = {
    ("free_surface", "topology"): ("field", DROPS), ("widening", "wall_share"): (0.3, {**SOLIDS, **COMPUTED}), ("flux", "ignore_solids"): (True, SOLIDS), **{(function, "ignore_solids"): (True, {**SOLIDS, **COMPUTED, "wall_share": 0.3}) for function in (
            "free_surface", "widening")}, ("widening", "widen"): (3, {}), ("project", "volume"): ("Space", SCALAR),
    ("project", "density"): (2000.0, SCALAR), ("project", "precision"): ("double", {**SCALAR, **COMPUTED}),
    ("project", "memory_limit"): (1, {**SCALAR, **COMPUTED}), ("project", "ignore_solids"): (True, {**SCALAR, **SOLIDS, **COMPUTED})}
# Keywords that change nothing, and why.
HOLDS = {("accessor", "isosurface", "seeds")}  # Pairs miss nothing of this surface; its statistics, which PyVista lacks, differ.


def names_as_arrays(words):
    """Returns the keywords of a call, with NumPy arrays in place of the names of arrays."""
    named = {name: ARRAYS[value] if isinstance(value, str) and value in ARRAYS and name in ("scalar", "scalar_dot", "velocity", "weighted_by", "solid", "volume")
             else {each: ARRAYS[each] for each in value} if name == "attributes" else value for name, value in words.items()}
    return {"smoothing_length": ARRAYS["SmoothingLength"], "mass": ARRAYS["Mass"], "density": ARRAYS["Density"], **named}


class Keywords(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.data = pyvista.PolyData(X)
        for name, array in ARRAYS.items():
            cls.data[name] = array
        with tempfile.TemporaryDirectory() as folder:
            cls.data.save(Path(folder) / "particles.vtp")
            cls.file = mc.io.read(Path(folder) / "particles.vtp")
            cls.file.positions
            for name in cls.file.arrays:
                cls.file.array(name)
        cls.kept = {}  # These are results without the keyword.

    def call(self, interface, function, words):
        """Calls the function. Returns its result, and its warnings or error."""
        words = {name: value() if value is closed else value for name, value in {**CALLS[function], **words}.items()}
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            try:
                if interface == "arrays":
                    words = names_as_arrays(words)
                    if "attributes" in inspect.signature(getattr(mc, function)).parameters and "only" in words:
                        words["attributes"] = {**words.get("attributes", {}), "Kind": ARRAYS["Kind"]}
                    if "fluid" in words:
                        words["fluid"] = ARRAYS["Kind"], words["fluid"][1]
                    result = getattr(mc, function)(X, **words)
                elif interface == "file":
                    result = getattr(mc, function)(self.file, **words)
                else:
                    if function == "derivatives" and "attributes" in words:
                        words["array"] = words.pop("attributes")[0]
                    result = getattr(self.data.sph, function)(**words)
            except (mc.Error, TypeError) as error:
                return None, [str(error)]
        return result, [str(each.message) for each in caught]

    def judge(self, interface, function, keyword):
        """Returns what a keyword does in a function, or None if it does nothing."""
        value, context = OTHER_TRIALS.get((function, keyword), TRIALS.get(keyword, (True, {})))  # All other keywords ask for outputs.
        parameters = inspect.signature(getattr(mc if interface != "accessor" else self.data.sph, function)).parameters
        context = {name: each for name, each in context.items() if name in parameters}
        key = interface, function, repr(context)
        if key not in self.kept:
            self.kept[key] = self.call(interface, function, context)
        base, said = self.kept[key]
        self.assertIsNotNone(base, f"{interface}.{function}({context}) fails without {keyword}: {said}")
        result, told = self.call(interface, function, {**context, keyword: value})
        new = [sentence for sentence in told if sentence not in said]
        if keyword not in parameters:
            self.assertRegex(told[0], f"has no option '{keyword}'|unexpected keyword", f"{interface}.{function}")
            return "refused"
        if keyword == "seeds" and interface != "accessor" and base is not None:  # Seeds change a result only where pairs miss something.
            return "acts" if base.statistics["seed_cells"] != result.statistics["seed_cells"] else None
        return "; ".join(new) if new else None if same(base, result) else "acts"

    def test_every_keyword_in_every_function(self):
        keywords = sorted({name for function in CALLS for name in inspect.signature(getattr(mc, function)).parameters} - {"positions"})
        self.assertEqual(set(TRIALS) - set(keywords) - {"array"}, set())
        nothing, acts = set(), 0
        for interface in ("arrays", "file", "accessor"):
            for function in CALLS:
                for keyword in keywords if interface != "accessor" or function != "widening" else ():
                    if keyword == "array" or interface == "accessor" and keyword == "attributes" and function not in ("isosurface", "free_surface", "probe"):
                        continue
                    found = self.judge(interface, function, keyword)
                    acts += found == "acts"
                    if found is None:
                        nothing.add((interface, function, keyword))
        self.assertEqual(nothing, HOLDS)
        self.assertGreater(acts, 300)


def same(one, other):
    if isinstance(one, pyvista.DataSet):
        return one == other
    return np.array_equal(one, other) if isinstance(one, np.ndarray) else one == other


if __name__ == "__main__":
    unittest.main()
