# Every example is run; each exits with a failure if its surface is empty.
set(particles "${CMAKE_CURRENT_SOURCE_DIR}/Data/dam_break_45k.vtp")
set(out "${CMAKE_CURRENT_BINARY_DIR}")

function (mcor_add_example_test name label)
  add_test(NAME "example.${name}" COMMAND ${ARGN})
  set_tests_properties("example.${name}" PROPERTIES LABELS "${label}" TIMEOUT 1500)
endfunction ()

mcor_add_example_test(c unit $<TARGET_FILE:extract_surface_c>
  "${out}/free_surface.obj" "${out}/temperature.obj")
if (NOT MCOR_BUILD_VTK OR mcor_lacking)
  return ()
endif ()

mcor_add_example_test(cxx vtk $<TARGET_FILE:ExtractSurface> "${particles}" "${out}/cxx.vtp")

set(with_display "${PROJECT_SOURCE_DIR}/Testing/with-display.sh")
if (MCOR_WRAP_PYTHON AND MCOR_VTK_PYTHON)
  mcor_add_example_test(python vtk "${MCOR_VTK_PYTHON}"
    "${CMAKE_CURRENT_SOURCE_DIR}/extract_surface.py" "${particles}" "${out}/free.vtp" "${out}/speed.vtp")
  mcor_add_example_test(gallery vtk "${with_display}" "${MCOR_VTK_PYTHON}"
    "${CMAKE_CURRENT_SOURCE_DIR}/Gallery/gallery.py" "${out}")
  set_tests_properties(example.python example.gallery PROPERTIES
    ENVIRONMENT "PYTHONPATH=${CMAKE_BINARY_DIR}/${MCOR_PYTHON_DESTINATION}")
endif ()

# Scripts from a solver's files, which they make here, to films and tables; they draw no plot, which would need
# matplotlib.
if (MCOR_VTK_PYTHON STREQUAL "/usr/bin/python3")
  foreach (script IN ITEMS dualsphysics:0.0266 splishsplash:0.0133 dam_break_2d:)
    string(REPLACE ":" ";" script "${script}")
    list(POP_FRONT script name)
    mcor_add_example_test(${name} vtk env "PATH=$<TARGET_FILE_DIR:marching-correctors>:$ENV{PATH}" PYTHON=true
      "${CMAKE_CURRENT_SOURCE_DIR}/${name}.sh" "${out}/${name}" ${script})
  endforeach ()
endif ()

# Runs the benchmark's cases on tiny sets in VTK's own Python; splashsurf is compared only if this Python has the
# package.
if (MCOR_WRAP_PYTHON AND MCOR_VTK_PYTHON)
  mcor_add_example_test(benchmark vtk "${MCOR_VTK_PYTHON}"
    "${CMAKE_CURRENT_SOURCE_DIR}/Benchmark/benchmark.py" $<TARGET_FILE:marching-correctors> --quick
    --tables a,b,c,adaptive,cancel,distance,plane,probe,smooth,walls
    --markdown "${out}/benchmark.md" --json "${out}/benchmark.json")
  set_tests_properties(example.benchmark PROPERTIES COST 130
    ENVIRONMENT "PYTHONPATH=${CMAKE_BINARY_DIR}/${MCOR_PYTHON_DESTINATION}")
endif ()

if (MCOR_BUILD_PLUGIN)
  find_program(MCOR_PVPYTHON pvpython DOC "ParaView's Python interpreter")
  mark_as_advanced(MCOR_PVPYTHON)
  if (MCOR_PVPYTHON)
    mcor_add_example_test(paraview paraview "${with_display}" "${MCOR_PVPYTHON}"
      "${CMAKE_CURRENT_SOURCE_DIR}/paraview_script.py" $<TARGET_FILE:MarchingCorrectors>
      "${out}/paraview.png")
    mcor_add_example_test(film paraview "${with_display}" "${MCOR_PVPYTHON}"
      "${CMAKE_CURRENT_SOURCE_DIR}/Gallery/film.py" $<TARGET_FILE:MarchingCorrectors> "${out}")
  endif ()
endif ()
