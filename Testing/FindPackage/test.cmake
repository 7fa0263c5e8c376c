# Installs the project, then configures, builds and runs the third project against the install tree.
# Variables: BUILD (build tree), LIBRARIES (its folder of libraries), SOURCE (this folder), WORK (scratch), PYTHON,
# WITH_VTK, and DEFINITIONS, the cache entries with which the SDK was found.
function (run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status)
  if (status)
    message(FATAL_ERROR "failed (${status}): ${ARGN}")
  endif ()
endfunction ()

file(REMOVE_RECURSE "${WORK}")
run("${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${WORK}/install")
run("${PYTHON}" "${SOURCE}/../library_paths.py" "${BUILD}/bin" "${BUILD}/${LIBRARIES}" "${WORK}/install")

# Kernels that the build keeps are installed on its own machine, and are no part of a package for others.
function (find_kept variable folder)
  set(name marching-correctors-kernels)
  file(GLOB kept RELATIVE "${folder}" "${folder}/lib*/${name}/*.ready" "${folder}/lib*/*/${name}/*.ready")
  set("${variable}" "${kept}" PARENT_SCOPE)
endfunction ()
find_kept(built "${BUILD}")
find_kept(installed "${WORK}/install")
run("${CMAKE_COMMAND}" -E env "DESTDIR=${WORK}/package"
  "${CMAKE_COMMAND}" --install "${BUILD}" --prefix /usr)
find_kept(packaged "${WORK}/package/usr")
if (NOT built STREQUAL installed OR packaged)
  message(FATAL_ERROR "Kernels built: ${built}\ninstalled: ${installed}\npackaged: ${packaged}")
endif ()
run("${CMAKE_COMMAND}" -S "${SOURCE}" -B "${WORK}/build" "-DCMAKE_PREFIX_PATH=${WORK}/install"
  -DCMAKE_BUILD_TYPE=Release ${DEFINITIONS})
run("${CMAKE_COMMAND}" --build "${WORK}/build")
run("${WORK}/build/uses_core")
if (WITH_VTK)
  run("${WORK}/build/uses_filter")
endif ()
