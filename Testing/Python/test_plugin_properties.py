# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""A trace and a state restore every property, also changed ones, of all filters but SPH Projection. Runs in pvpython and computes nothing, because
many of the changed values make no sense together."""
import os
import pathlib
import re
import subprocess

from paraview import smstate, smtrace
from paraview.simple import (Delete, FindSource, GetSources, LoadPlugin, LoadState, Plane, PointSource, RenameSource,
                             SaveState, XMLPolyDataReader)


def properties_of(proxy):
    iterator = proxy.SMProxy.NewPropertyIterator()
    iterator.Begin()
    while not iterator.IsAtEnd():
        found = iterator.GetProperty()
        if found.IsA("vtkSMVectorProperty") and not found.GetInformationOnly():
            yield iterator.GetKey(), found
        iterator.Next()


def values_of(proxy):
    return {name: [found.GetElement(i) for i in range(found.GetNumberOfElements())]
            for name, found in properties_of(proxy)}


def other_int(found, before):
    choices = found.FindDomain("vtkSMEnumerationDomain")
    if choices:
        return next(value for value in (choices.GetEntryValue(i) for i in range(choices.GetNumberOfEntries()))
                    if value != before)
    return 1 - before if found.FindDomain("vtkSMBooleanDomain") else before + (1 if before < 20 else -1)


def other_text(found, before):
    names = found.FindDomain("vtkSMArrayListDomain")
    if names:
        return next(name for name in (names.GetString(i) for i in range(names.GetNumberOfStrings())) if name != before)
    return before + "x"


def change(found):
    """Gives a property another value: changes all its numbers, or, if it holds texts, the last one."""
    count = found.GetNumberOfElements()
    if count == 0:  # a list of any length
        found.SetNumberOfElements(1)
        found.SetElement(0, other_text(found, "") if found.IsA("vtkSMStringVectorProperty") else 1.5)
    elif found.IsA("vtkSMStringVectorProperty"):
        last = count - 1  # The last of the five elements names an array.
        found.SetElement(last, other_text(found, found.GetElement(last)))
    elif found.IsA("vtkSMIntVectorProperty"):
        for i in range(count):
            found.SetElement(i, other_int(found, found.GetElement(i)))
    else:
        for i in range(count):
            found.SetElement(i, 0.8 * found.GetElement(i) + 0.011 * (i + 1))


def choose_all(make):
    """Makes the filter and changes every property. Returns the filter, the trace and the new values."""
    smtrace.start_trace()
    proxy = make("traced")
    before = values_of(proxy)
    applied = smtrace.PropertiesModified(proxy)  # The window does this around Apply.
    for _, found in properties_of(proxy):
        change(found)
    proxy.UpdateVTKObjects()
    applied.finalize()
    trace = smtrace.stop_trace()
    after = values_of(proxy)
    same = [name for name in after if after[name] == before[name]]
    assert not same and len(after) > 3, same
    return proxy, trace, after


def check(name, make):
    known = set(GetSources())
    proxy, trace, wanted = choose_all(make)
    lines = trace.splitlines()
    first = next(i for i, line in enumerate(lines) if f"= {name}(" in line)
    RenameSource("stored " + name, proxy)
    names = dict(globals())
    for (source, _), found in GetSources().items():
        names[source.lower().replace(".", "")] = found
    exec("\n".join(lines[first:]), names)  # pylint: disable=exec-used
    replayed = FindSource("traced")
    compare(name + ", trace", values_of(replayed), wanted)
    Delete(replayed)

    path = os.path.join(os.environ["MCOR_TEST_OUTPUT"], f"{name}_{os.getpid()}.pvsm")
    SaveState(path)
    RenameSource("before " + name, proxy)
    LoadState(path)
    os.remove(path)
    compare(name + ", state", values_of(FindSource("stored " + name)), wanted)
    for key, source in list(GetSources().items()):
        if key not in known:  # Each state would otherwise hold all earlier sources twice.
            Delete(source)
    print(f"{name}: {len(wanted)} properties come back", flush=True)


def compare(what, found, wanted):
    lost = {name: (found.get(name), value) for name, value in wanted.items() if found.get(name) != value}
    assert not lost, (what, lost)


def run_alone(script):
    path = os.path.join(os.environ["MCOR_TEST_OUTPUT"], f"state_{os.getpid()}.py")
    pathlib.Path(path).write_text(script, encoding="utf-8")
    done = subprocess.run([os.environ["MCOR_TEST_PVPYTHON"], path], capture_output=True, text=True, check=False)
    os.remove(path)
    return done.stdout + done.stderr


def check_python_state():
    """A state that was saved as Python can be loaded if the line that the guide gives is run first."""
    source = PointSource(NumberOfPoints=100)
    made = SPHContourIsosurfaceFreeSurface(registrationName="found", Input=source)  # noqa: F821, pylint: disable=undefined-variable
    state = smstate.get_state() + '\nprint("found:", FindSource("found").CubeSizeFactor)\n'
    guide = pathlib.Path(__file__).resolve().parents[2] / "Documentation" / "Guide" / "paraview.md"
    text = guide.read_text(encoding="utf-8")
    line, error = re.search("^    (LoadPlugin.*)$", text, re.M).group(1), re.search("NameError: ([^`]*)`", text).group(1)
    plugin = re.sub('"/[^"]*"', f'"{os.environ["MCOR_TEST_PLUGIN"]}"', line)
    begin = "from paraview.simple import *\n"
    assert begin in state and state.replace(begin, begin + plugin + "\n") != state
    assert "NameError: " + error in run_alone(state), run_alone(state)
    found = run_alone(state.replace(begin, begin + plugin + "\n"))
    assert "found: 0.5" in found and "Error" not in found, found
    Delete(made)
    Delete(source)
    print("the guide's line makes a state run", flush=True)


def main():
    LoadPlugin(os.environ["MCOR_TEST_PLUGIN"], remote=False, ns=globals())
    check_python_state()  # The state has only these sources.
    data = os.path.join(os.environ["MCOR_TEST_DATA"], "dam_break_45k.vtp")
    reader = XMLPolyDataReader(registrationName="reader", FileName=[data])
    reader.UpdatePipeline()
    plane = Plane(registrationName="plane")
    # pylint: disable=undefined-variable
    check("SPHContourIsosurfaceFreeSurface",
          lambda name: SPHContourIsosurfaceFreeSurface(registrationName=name, Input=reader))  # noqa: F821
    check("SPHProbe", lambda name: SPHProbe(registrationName=name, Points=plane, Particles=reader))  # noqa: F821
    for name in ("SPHSlice", "SPHLine", "SPHVolume"):
        check(name, lambda own, made=globals()[name]: made(registrationName=own, Input=reader))
    check("SPHDerivatives", lambda name: SPHDerivatives(registrationName=name, Input=reader))  # noqa: F821
    check("SPHFlux", lambda name: SPHFlux(registrationName=name, Particles=reader))  # noqa: F821
    check("SPHGauge", lambda name: SPHGauge(registrationName=name, Particles=reader))  # noqa: F821
    check("SPHPieces", lambda name: SPHPieces(registrationName=name, Surface=plane, Particles=reader))  # noqa: F821
    check("SPHTemporalInterpolator",
          lambda name: SPHTemporalInterpolator(registrationName=name, Input=reader))  # noqa: F821


main()
