# Compiles one program of OpenCL kernels for the built-in device: an object file with a function that runs
# work-items of each kernel, and the kernels' names and arguments; see mcor_native.h. Run it with cmake -P and
#
#   COMPILER   clang
#   FLAGS      its flags: target, instruction set, optimisation
#   NAME       of the function
#   PREFIX     source of the built-in functions; SOURCES: of the program, in order
#   DEFINES    of the program, as mcor_program_options writes them
#   OUTPUT     the object file; beside it is what it was made of
#   KEPT       folders of such object files: a file that was made of the same sources is copied, not compiled
get_filename_component(folder "${OUTPUT}" DIRECTORY)
file(MAKE_DIRECTORY "${folder}")
separate_arguments(FLAGS UNIX_COMMAND "${FLAGS}")
separate_arguments(DEFINES UNIX_COMMAND "${DEFINES}")
set(opencl -x cl -cl-std=CL1.2 -Xclang -cl-ext=+cl_khr_fp64 -w ${FLAGS})

function (run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE failed ERROR_VARIABLE reason)
  if (failed)
    message(FATAL_ERROR "${NAME} could not be compiled (${failed}):\n${reason}")
  endif ()
endfunction ()

# The preprocessed program. Semicolons would make lists of it.
set(all "")
foreach (source IN LISTS SOURCES)
  string(APPEND all "#include \"${source}\"\n")
endforeach ()
file(WRITE "${OUTPUT}.all.cl" "${all}")
run(${COMPILER} ${opencl} -cl-no-stdinc -D__OPENCL_VERSION__=120 ${DEFINES} -E -P -o "${OUTPUT}.pre.cl"
  "${OUTPUT}.all.cl")
file(READ "${OUTPUT}.pre.cl" text)
string(REPLACE ";" "@semicolon@" text "${text}")
string(REPLACE "[" "@open@" text "${text}")
string(REPLACE "]" "@close@" text "${text}")

# A kernel becomes a function of its work-item's number, and a case that runs it for several. The arguments are
# read once before, because clang must assume that a work-item may write to them.
string(REGEX MATCHALL "__kernel void [a-z0-9_]+\\([^{]*\\)[ \n]*{" kernels "${text}")
set(names "")
set(kinds "")
set(cases "")
set(number 0)
foreach (kernel IN LISTS kernels)
  string(REGEX MATCH "void ([a-z0-9_]+)\\((.*)\\)" ignored "${kernel}")
  set(name "${CMAKE_MATCH_1}")
  string(REGEX REPLACE "[ \n]+" " " parameters "${CMAKE_MATCH_2}")
  string(REPLACE "," ";" parameters "${parameters}")
  set(taken "")
  set(passed "")
  set(i 0)
  foreach (parameter IN LISTS parameters)
    string(STRIP "${parameter}" parameter)
    string(REGEX REPLACE "[a-z0-9_]+$" "" type "${parameter}")
    if (type MATCHES "\\*")
      string(APPEND kinds "b")
    else ()
      string(REPLACE "const " "" type "${type}")
      if (type MATCHES "^(int|uint|float) $" OR (type STREQUAL "real " AND NOT DEFINES MATCHES "MCOR_DOUBLE=1"))
        string(APPEND kinds "4")
      elseif (type MATCHES "^(long|ulong|double|real) $")
        string(APPEND kinds "8")
      else ()
        message(FATAL_ERROR "${name}: a kernel of the built-in device has no argument of the type ${type}")
      endif ()
    endif ()
    string(APPEND taken "      ${type}a${i} = *(${type} __private*)arguments[${i}];\n")
    string(APPEND passed ", a${i}")
    math(EXPR i "${i} + 1")
  endforeach ()
  string(APPEND names "${name};")
  string(APPEND kinds ";")
  string(APPEND cases "    case ${number}:\n    {\n${taken}"
    "      for (size_t i = first; i < last; ++i)\n        ${name}(i${passed});\n      break;\n    }\n")
  math(EXPR number "${number} + 1")
endforeach ()
string(REGEX REPLACE "__kernel void ([a-z0-9_]+)\\(" "void \\1(const size_t mcor_item, " text "${text}")
string(REPLACE "@semicolon@" ";" text "${text}")
string(REPLACE "@open@" "[" text "${text}")
string(REPLACE "@close@" "]" text "${text}")

file(WRITE "${OUTPUT}.cl" "#pragma clang attribute push(__attribute__((internal_linkage)), apply_to = function)
#include \"${PREFIX}\"
${text}
#pragma clang attribute pop
__constant const char ${NAME}_kernels[] = \"${names}\";
__constant const char ${NAME}_arguments[] = \"${kinds}\";
void ${NAME}(unsigned number, __private void* __private const* arguments, size_t first, size_t last);
void ${NAME}(unsigned number, __private void* __private const* arguments, size_t first, size_t last)
{
  switch (number)
  {
${cases}  }
}
")
list(APPEND opencl -ffp-contract=off -fno-math-errno -fPIC -fvisibility=hidden)

# OUTPUT.key, beside the object, tells what the object is made of; so do the keys in KEPT.
run(${COMPILER} ${opencl} -E -P -o "${OUTPUT}.pre.cl" "${OUTPUT}.cl")
file(SHA256 "${OUTPUT}.pre.cl" made_of)
execute_process(COMMAND ${COMPILER} --version OUTPUT_VARIABLE version)
string(SHA256 key "${version} ${opencl} ${made_of}")
get_filename_component(object "${OUTPUT}" NAME)
set(places "${OUTPUT}")
foreach (folder IN LISTS KEPT)
  list(APPEND places "${folder}/${object}")
endforeach ()
foreach (kept IN LISTS places)
  if (EXISTS "${kept}" AND EXISTS "${kept}.key")
    file(READ "${kept}.key" kept_key)
    if (kept_key STREQUAL key)
      if (NOT kept STREQUAL OUTPUT)
        configure_file("${kept}" "${OUTPUT}" COPYONLY)
      endif ()
      file(TOUCH "${OUTPUT}")
      file(WRITE "${OUTPUT}.key" "${key}")
      return ()
    endif ()
  endif ()
endforeach ()
file(REMOVE "${OUTPUT}.key")
run(${COMPILER} ${opencl} -c -o "${OUTPUT}" "${OUTPUT}.cl")
file(WRITE "${OUTPUT}.key" "${key}")
