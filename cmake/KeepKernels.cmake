# Has PROGRAM, marching-correctors-compile, compile kernels into FOLDER, of SPH_KERNELS alone or of all.
# A machine that cannot do so is told, and builds on.
if (SPH_KERNELS STREQUAL "ON" OR SPH_KERNELS STREQUAL "all")
  set(SPH_KERNELS "")
endif ()
file(REMOVE_RECURSE "${FOLDER}")
set(ENV{MCOR_KERNEL_DIR} "${FOLDER}")
execute_process(COMMAND "${PROGRAM}" --keep ${SPH_KERNELS}
  TIMEOUT 900 RESULT_VARIABLE failed OUTPUT_QUIET ERROR_VARIABLE reason)
if (failed)
  file(REMOVE_RECURSE "${FOLDER}")
  string(STRIP "${reason}" reason)
  message(STATUS "No OpenCL kernels are compiled ahead of the first surface, which will wait for them "
    "(${failed}). ${reason} Later, ${PROGRAM} --keep does it.")
endif ()
