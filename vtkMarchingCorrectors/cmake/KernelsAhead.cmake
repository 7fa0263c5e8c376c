# Compiles the kernels of the built-in device. mcor_ahead_objects: the object files, none without clang;
# mcor_ahead_sources: the same, and the C file that lists them (mcor_native_programs, see mcor_native.h).
set(MCOR_AHEAD usual CACHE STRING
  "Kernels compiled for the built-in device: usual, all (all SPH kernels, double precision, too), or OFF")
# To compile all kernels would take minutes more.
set(MCOR_AHEAD_USUAL "cubic;quadratic;mprime4;quintic;wendland" CACHE STRING "SPH kernels of MCOR_AHEAD=usual")
set_property(CACHE MCOR_AHEAD PROPERTY STRINGS usual all OFF)
find_program(MCOR_CLANG NAMES clang clang-19 clang-18 clang-17 clang-16 clang-15 clang-14 DOC "Compiles OpenCL kernels")
mark_as_advanced(MCOR_CLANG)
set(mcor_ahead_sources "")
set(mcor_ahead "${MCOR_AHEAD}")
if (mcor_ahead AND NOT MCOR_CLANG)
  message(STATUS "No built-in device: clang, which compiles its kernels, was not found. An OpenCL driver is needed.")
  set(mcor_ahead OFF)
endif ()

# INSTRUCTIONS FLAGS LANES of single precision, of each instruction set.
set(mcor_ahead_targets "")
if (CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$")
  set(mcor_ahead_targets "V3 -march=x86-64-v3 8" "V4 -march=x86-64-v4 16")
elseif (CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm64|ARM64)$")
  set(mcor_ahead_targets "BASE -mcpu=generic 8")
elseif (mcor_ahead)
  message(STATUS "No built-in device: none is known for the processor ${CMAKE_SYSTEM_PROCESSOR}. An OpenCL driver is needed.")
endif ()
# Vectors of 16 lanes are passed on the stack to a function that is not inlined.
set(MCOR_AHEAD_FLAGS "-O3 -mllvm -inline-threshold=800" CACHE STRING
  "Flags of clang for the kernels of the built-in device")
set(MCOR_AHEAD_INSTRUCTIONS "V3;V4;BASE" CACHE STRING
  "Instruction sets of these kernels, those of other processors are ignored: V3, V4 (x86-64), BASE (arm64)")
set(MCOR_AHEAD_KEPT "" CACHE PATH "Folder of another build's compiled kernels, taken where they were made of the same")
mark_as_advanced(MCOR_AHEAD_USUAL MCOR_AHEAD_FLAGS MCOR_AHEAD_INSTRUCTIONS MCOR_AHEAD_KEPT)
set(mcor_ahead_kept "${MCOR_AHEAD_KEPT}")
if (MCOR_BUILD_PYTHON_WHEEL AND NOT mcor_ahead_kept) # looks for kernels of builds in the sources' folder
  file(GLOB mcor_ahead_kept LIST_DIRECTORIES true "${PROJECT_SOURCE_DIR}/build*/vtkMarchingCorrectors/core/ahead")
  message(STATUS "Kernels are taken from ${mcor_ahead_kept} where they are made of the same")
endif ()
set(mcor_ahead_flags "${MCOR_AHEAD_FLAGS}")
if (CMAKE_CROSSCOMPILING)
  string(APPEND mcor_ahead_flags " --target=${MCOR_AHEAD_TRIPLE}")
endif ()

# Compiles sources into an object file for the built-in device, with a function `name`.
function (mcor_compile_ahead object name flags defines)
  set(prefix "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/../kernels/device/mcor_native.cl")
  set(script "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/CompileAhead.cmake")
  add_custom_command(
    OUTPUT  "${object}"
    COMMAND "${CMAKE_COMMAND}" "-DCOMPILER=${MCOR_CLANG}" "-DNAME=${name}" "-DFLAGS=${flags}"
            "-DDEFINES=${defines}" "-DPREFIX=${prefix}" "-DSOURCES=${ARGN}" "-DOUTPUT=${object}"
            "-DKEPT=${mcor_ahead_kept}" -P "${script}"
    DEPENDS ${ARGN} "${prefix}" "${script}"
    COMMENT "Compiling kernels ahead: ${name}"
    VERBATIM)
  set_source_files_properties("${object}" PROPERTIES EXTERNAL_OBJECT TRUE GENERATED TRUE)
endfunction ()

set(mcor_ahead_table "")
set(mcor_ahead_declared "")
# Compiles the library's program of this number, with options as mcor_program_options writes them.
macro (mcor_compile_program program name instructions flags defines)
  set(sources "")
  foreach (row IN LISTS mcor_program_sources)
    if ("${row}" MATCHES " ${program}( |:|$)" AND NOT "${row}" MATCHES " point$")
      string(REGEX REPLACE " .*" "" source "${row}")
      list(APPEND sources "${mcor_folder}/${source}")
    endif ()
  endforeach ()
  set(object "${CMAKE_CURRENT_BINARY_DIR}/ahead/${name}.o")
  mcor_compile_ahead("${object}" ${name} "${mcor_ahead_flags} ${flags}" "${defines}" ${sources})
  list(APPEND mcor_ahead_sources "${object}")
  string(APPEND mcor_ahead_declared "extern mcor_native_run ${name};
extern const char ${name}_kernels[], ${name}_arguments[];\n")
  string(APPEND mcor_ahead_table "  { \"${defines}\", MCOR_INSTRUCTIONS_${instructions}, ${name},
    ${name}_kernels, ${name}_arguments },\n")
endmacro ()

# Compiles all programs for an instruction set and a precision.
macro (mcor_compile_variants instructions flags lanes double)
  set(suffix "")
  if (NOT ${double})
    set(suffix f)
  endif ()
  string(TOLOWER "mcor_ahead_${instructions}_${double}" mcor_ahead_name)
  mcor_compile_program(LATTICE ${mcor_ahead_name}_lattice ${instructions} "${flags}"
    "-DMCOR_PROGRAM=0 -DMCOR_LANES=${lanes} -DMCOR_DOUBLE=${double}")
  foreach (entry IN LISTS mcor_ahead_kernels)
    string(REGEX MATCH "ENTRY\\([A-Z0-9_]+, ([a-z0-9_]+), ([0-9.]+), ([0-9.]+), ([01])," ignored "${entry}")
    set(w ${CMAKE_MATCH_1})
    set(support ${CMAKE_MATCH_2})
    set(norm ${CMAKE_MATCH_3})
    set(tensor ${CMAKE_MATCH_4})
    if (NOT mcor_ahead STREQUAL "all" AND NOT w IN_LIST MCOR_AHEAD_USUAL)
      continue ()
    endif ()
    foreach (variant IN ITEMS FIELD.0.0 FIELD.0.1 FIELD.1.0 FIELD.1.1 FIELD.2.0 FIELD.2.1 PROBE.2.0 PROBE.2.1)
      string(REGEX MATCHALL "[A-Z0-9]+" variant "${variant}")
      list(GET variant 0 program)
      list(GET variant 1 field)
      list(GET variant 2 solids)
      list(FIND mcor_programs ${program} number)
      string(TOLOWER "${mcor_ahead_name}_${program}_${w}_${field}_${solids}" name)
      mcor_compile_program(${program} ${name} ${instructions} "${flags}"
        "-DMCOR_PROGRAM=${number} -DMCOR_LANES=${lanes} -DMCOR_DOUBLE=${double} -DMCOR_W=mcor_w_${w} -DMCOR_DW=mcor_dw_${w} -DMCOR_DDW=mcor_ddw_${w} -DMCOR_NORM=${norm}${suffix} -DMCOR_SUPPORT=${support}${suffix} -DMCOR_TENSOR=${tensor} -DMCOR_FIELD=${field} -DMCOR_SOLIDS=${solids}")
    endforeach ()
  endforeach ()
endmacro ()

if (mcor_ahead)
  file(READ "${CMAKE_CURRENT_SOURCE_DIR}/grid/mcor_sph_kernel.h" mcor_ahead_text)
  string(REGEX MATCHALL "ENTRY\\(MCOR_[^)]*\\)" mcor_ahead_kernels "${mcor_ahead_text}")
  foreach (name IN LISTS MCOR_AHEAD_USUAL)
    if (NOT "${mcor_ahead_kernels}" MATCHES ", ${name}, ")
      message(FATAL_ERROR "MCOR_AHEAD_USUAL has '${name}', which is no SPH kernel of grid/mcor_sph_kernel.h.")
    endif ()
  endforeach ()
  foreach (target IN LISTS mcor_ahead_targets)
    string(REPLACE " " ";" target "${target}")
    list(GET target 0 instructions)
    if (NOT instructions IN_LIST MCOR_AHEAD_INSTRUCTIONS)
      continue ()
    endif ()
    list(GET target 1 flags)
    list(GET target 2 lanes)
    mcor_compile_variants(${instructions} ${flags} ${lanes} 0)
    if (mcor_ahead STREQUAL "all")
      mcor_compile_variants(${instructions} ${flags} 8 1)
    endif ()
  endforeach ()
endif ()
file(GENERATE OUTPUT "${CMAKE_CURRENT_BINARY_DIR}/mcor_native_programs.c" CONTENT
"/* Made by KernelsAhead.cmake. */
#include \"mcor_native.h\"
${mcor_ahead_declared}const mcor_native_program mcor_native_programs[] = {
${mcor_ahead_table}  { 0, MCOR_INSTRUCTIONS_BASE, 0, 0, 0 } };
")
set(mcor_ahead_objects ${mcor_ahead_sources})
list(APPEND mcor_ahead_sources "${CMAKE_CURRENT_BINARY_DIR}/mcor_native_programs.c")
